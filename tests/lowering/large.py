"""Texts of models of any size n: chains, trees, loops, orientations."""

from lagc.compiler import pipeline
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Source
from lagc.mechanics.formulation.equations import EquationsOfMotion

_LINK = "  parameter Mass m(min = 0) = 1 [kg];\n  parameter Length l(min = 0) = 0.2 [m];\n"
_GRAVITY = "  effect gravity\n    Gravity field(g = 9.81 [m/s2], direction = {0, 0, -1});\n  end gravity;\n"
_LAB = _GRAVITY + "  scene lab uses gravity\n    simulate(stop = 5 [s]);\n  end lab;\n"


def _model(body: str, before: str = "") -> str:
    return f"{before}model Large\n  structural Integer n = 5;\n{_LINK}{body}{_LAB}end Large;\n"


CHAIN = _model("""
  coordinate Angle th[n](each start = 30 [deg]);
  point P[0] = {0, 0, 0};
  for i in 1:n loop
    point P[i] = P[i-1] + l*{sin(th[i]), 0, -cos(th[i])};
    body bob[i] = Particle(mass = m, at = P[i]);
  end for;
""")
WEIGHTED = _model("""
  parameter Mass tip(min = 0) = 1e6 [kg];
  coordinate Angle th[n](each start = 30 [deg]);
  point P[0] = {0, 0, 0};
  for i in 1:n loop
    point P[i] = P[i-1] + l*{sin(th[i]), 0, -cos(th[i])};
    body bob[i] = Particle(mass = m, at = P[i]);
  end for;
  body last = Particle(mass = tip, at = P[n]);
""")
RELATIVE = _model("""
  coordinate Angle q[n](each start = 30 [deg]);
  point P[0] = {0, 0, 0};
  frame F[0] = rotate_y(world, 0);
  for i in 1:n loop
    frame F[i] = rotate_y(F[i-1], q[i]);
    point P[i] = P[i-1] - l*F[i].z;
    body bob[i] = Particle(mass = m, at = P[i]);
  end for;
""")
RODS = _model("""
  coordinate Angle q[n](each start = 30 [deg]);
  point P[0] = {0, 0, 0};
  frame F[0] = rotate_y(world, 0);
  for i in 1:n loop
    frame F[i] = rotate_y(F[i-1], q[i]);
    point P[i] = P[i-1] - l*F[i].z;
    body rod[i] = Solid(mass = m, inertia = m*l^2/12*{1, 1, 0}, frame = F[i], com = P[i-1] - l/2*F[i].z);
  end for;
""")
SPHERICAL = _model("""
  coordinate Angle a[n](each start = 30 [deg]);
  coordinate Angle b[n](each start = 50 [deg]);
  point P[0] = {0, 0, 0};
  for i in 1:n loop
    point P[i] = P[i-1] + l*{sin(a[i])*cos(b[i]), sin(a[i])*sin(b[i]), -cos(a[i])};
    body bob[i] = Particle(mass = m, at = P[i]);
  end for;
""")
_BALL = "model Link\n  coordinate Orientation o;\nend Link;\n\n"
_BALLS = """
  parameter Inertia Ix = 0.09, Iy = 0.08, Iz = 0.004;
  Link k[n];
  point P[0] = {0, 0, 0};
  frame F[0] = rotate_y(world, 0);
  for i in 1:n loop
    frame F[i] = rotate(F[i-1], k[i].o);
    point P[i] = P[i-1] - l*F[i].z;
    body rod[i] = Solid(mass = m, inertia = {Ix, Iy, Iz}, frame = F[i], com = P[i-1] - l/2*F[i].z);
  end for;
"""
BALLS_RELATIVE = _model(_BALLS, _BALL)
BALLS = _model(_BALLS.replace("rotate(F[i-1], k", "rotate(world, k"), _BALL)
TREE = _model("""
  coordinate Angle th[n](each start = 30 [deg]);
  point P[1] = l*{sin(th[1]), 0, -cos(th[1])};
  body root = Particle(mass = m, at = P[1]);
  for i in 1:(n - 1)/2 loop
    point P[2*i] = P[i] + l*{sin(th[2*i]), 0, -cos(th[2*i])};
    body left[i] = Particle(mass = m, at = P[2*i]);
    point P[2*i+1] = P[i] + l*{sin(th[2*i+1]), 0, -cos(th[2*i+1])};
    body right[i] = Particle(mass = m, at = P[2*i+1]);
  end for;
""")
CLOSED = CHAIN.replace("  effect", "  constraint ring: P[n] = {0.1*n*l, 0, 0};\n  effect", 1)
LADDER = _model("""
  coordinate Angle a[n](each start = 30 [deg]);
  coordinate Angle b[n](each start = 40 [deg]);
  point P[0] = {0, 0, 0};
  point Q[0] = {l, 0, 0};
  for i in 1:n loop
    point P[i] = P[i-1] + l*{sin(a[i]), 0, -cos(a[i])};
    body left[i] = Particle(mass = m, at = P[i]);
    point Q[i] = Q[i-1] + l*{sin(b[i]), 0, -cos(b[i])};
    body right[i] = Particle(mass = m, at = Q[i]);
    constraint rung[i]: dot(P[i] - Q[i], P[i] - Q[i]) = l^2;
  end for;
""")
TREES = {
    "chain": CHAIN, "weighted": WEIGHTED, "relative": RELATIVE, "rods": RODS, "spherical": SPHERICAL,
    "balls_relative": BALLS_RELATIVE, "balls": BALLS, "tree": TREE,
}  # fmt: skip
LOOPS = {"closed": CLOSED, "ladder": LADDER}


STRIP = _model("""
  coordinate Length x[2*n+2], z[2*n+2];
  for i in 1:2*n+2 loop
    point P[i] = {x[i], 0, z[i]};
    body node[i] = Particle(mass = m, at = P[i]);
  end for;
  for i in 1:2*n+1 loop
    constraint across[i]: dot(P[i+1] - P[i], P[i+1] - P[i]) = l^2;
  end for;
  for i in 1:2*n loop
    constraint along[i]: dot(P[i+2] - P[i], P[i+2] - P[i]) = l^2;
  end for;
""")

TRAILERS = _model("""
  coordinate Length x, y;
  coordinate Angle th[n](each start = 10 [deg]);
  point P[0] = {x, y, 0};
  for i in 1:n loop
    frame F[i] = rotate_z(world, th[i]);
    point P[i] = P[i-1] - l*F[i].x;
    body box[i] = Solid(mass = m, inertia = m*l^2/12*{0, 0, 1}, frame = F[i], com = P[i] + 0.3*l*F[i].x);
    constraint skid[i]: dot(velocity(P[i]), F[i].y) = 0;
  end for;
  body car = Particle(mass = m, at = P[0]);
""")


def equations(text: str, n: int) -> EquationsOfMotion:
    tree = pipeline.parse(Source("large.lag", text))
    return pipeline.derive(pipeline.resolve(tree, Choice(parameters={"n": n})))
