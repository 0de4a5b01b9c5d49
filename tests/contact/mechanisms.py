"""Random mechanisms and bodies on rough floors: models with parameters, and draws of their values."""

import math
from collections.abc import Callable
from random import Random

GRAVITY = "  Gravity field(g = 9.81 [m/s2], direction = {0, -1, 0});\n"
LINK = "Solid(mass = 1 [kg], inertia = 1/12*1 [kg]*{l}^2*{{1, 1, 1}}, frame = {frame}, com = {com})"
LAW = "friction = mu, restitution = e"

Draw = Callable[[Random], dict[str, float]]


def _law(r: Random, most: float = 1.0) -> dict[str, float]:
    return {"mu": r.choice([0.0, r.uniform(0.0, most)]), "e": r.choice([0.0, r.uniform(0.0, 0.9)])}


def _draw(r: Random, most: float, *names: str) -> dict[str, float]:
    return {name: r.uniform(-most, most) for name in names}


STONE = """  parameter Angle slope, phi0;
  parameter Real static;
  parameter Velocity vx, vy;
  parameter AngularVelocity omega;
  parameter Inertia J;
  parameter Length a[4], b[4];
  coordinate Length x(rate = vx), y(start = 0.8 [m], rate = vy);
  coordinate Angle phi(start = phi0, rate = omega);
  Gravity field(g = 9.81 [m/s2], direction = {sin(slope), -cos(slope), 0});
  frame F = rotate_z(world, phi);
  body stone = Solid(mass = 1 [kg], inertia = J*{1, 1, 1}, frame = F, com = {x, y, 0});
  for i in 1:4 loop
    point p[i] = position(stone) + a[i]*F.x + b[i]*F.y;
    constraint c[i]: p[i].y >= 0 (friction = mu, static = static*mu, restitution = e, slip = der(p[i].x));
  end for;
"""


def _stone(r: Random) -> dict[str, float]:
    """One to four corners; the others are hidden inside."""
    n, turn = r.randint(1, 4), r.uniform(-3.0, 3.0)
    hidden = ((0.03, 0.0), (0.03, 0.01), (-0.02, 0.025), (-0.02, -0.03))
    found = {"slope": r.choice([0.0, r.uniform(0.0, 0.5)]), "static": r.choice([1.0, 1.2]), **_law(r),
             "J": r.uniform(0.02, 0.15), **_draw(r, 3.0, "vx", "phi0"), **_draw(r, 1.0, "vy"),
             **_draw(r, 6.0, "omega")}  # fmt: skip
    for k in range(4):
        far, angle = r.uniform(0.15, 0.5), turn + 2.0 * math.pi * k / n + r.uniform(-0.4, 0.4)
        at = (far * math.cos(angle), far * math.sin(angle)) if k < n else hidden[k]
        found[f"a[{k + 1}]"], found[f"b[{k + 1}]"] = at
    return found


CHAIN = f"""  parameter Length l1, l2, h, w;
  parameter Angle a0, b0;
  parameter AngularVelocity wa, wb;
  coordinate Angle a(start = a0, rate = wa), b(start = b0, rate = wb);
{GRAVITY}  frame A = rotate_z(world, a);
  frame B = rotate_z(world, b);
  point K = -l1*A.y;
  point T = K - l2*B.y;
  body upper = {LINK.format(l="l1", frame="A", com="-l1/2*A.y")};
  body lower = {LINK.format(l="l2", frame="B", com="K - l2/2*B.y")};
  constraint tip: T.y >= -h ({LAW}, slip = der(T.x));
  constraint knee: K.y >= -h ({LAW}, slip = der(K.x));
  constraint wall: T.x <= w ({LAW}, slip = der(T.y));
"""


def _chain(r: Random) -> dict[str, float]:
    """A double pendulum over a floor and beside a wall."""
    l1, l2, a0, b0 = r.uniform(0.4, 1.0), r.uniform(0.3, 1.0), r.uniform(-1.4, 0.3), r.uniform(-1.4, 0.3)
    low = l1 * math.cos(a0) + max(0.0, l2 * math.cos(b0))
    w = l1 * math.sin(a0) + l2 * math.sin(b0) + r.uniform(0.1, 2.0)
    return {"l1": l1, "l2": l2, "a0": a0, "b0": b0, "h": low + r.uniform(0.02, 0.3), "w": w, **_law(r),
            "wa": r.uniform(-1.0, 3.0), "wb": r.uniform(-1.0, 3.0)}  # fmt: skip


WALKER = f"""  parameter Length l1, l2;
  parameter Mass M;
  parameter Angle a0, b0;
  parameter AngularVelocity wa, wb;
  parameter Velocity vx, vy;
  coordinate Length x(rate = vx), y(start = 1.1 [m], rate = vy);
  coordinate Angle a(start = a0, rate = wa), b(start = b0, rate = wb);
{GRAVITY}  frame A = rotate_z(world, a);
  frame B = rotate_z(world, b);
  point H = {{x, y, 0}};
  point P = H - l1*A.y;
  point Q = H - l2*B.y;
  body hip = Particle(mass = M, at = H);
  body one = {LINK.format(l="l1", frame="A", com="H - l1/2*A.y")};
  body two = {LINK.format(l="l2", frame="B", com="H - l2/2*B.y")};
  constraint foot1: P.y >= 0 ({LAW}, slip = der(P.x));
  constraint foot2: Q.y >= 0 ({LAW}, slip = der(Q.x));
  constraint seat: y >= 0 ({LAW}, slip = der(x));
"""


def _walker(r: Random) -> dict[str, float]:
    return {"l1": r.uniform(0.5, 0.9), "l2": r.uniform(0.5, 0.9), "M": r.uniform(0.2, 3.0), **_law(r),
            **_draw(r, 1.0, "a0", "b0", "vx", "vy"), **_draw(r, 2.0, "wa", "wb")}  # fmt: skip


CART = f"""  parameter Length l, wl, wr;
  parameter Mass M, m;
  parameter Angle a0;
  parameter AngularVelocity wa;
  parameter Velocity vx;
  parameter Damping c;
  coordinate Length x(rate = vx);
  coordinate Angle a(start = a0, rate = wa);
{GRAVITY}  body cart = Particle(mass = M, at = {{x, 0, 0}});
  body bob = Particle(mass = m, at = {{x + l*sin(a), -l*cos(a), 0}});
  dissipation d = 1/2*c*der(x)^2;
  constraint right: x <= wr (restitution = e);
  constraint left: x >= -wl (restitution = e);
  constraint post: bob.x <= wr + 0.1 [m] ({LAW}, slip = der(bob.y));
"""


def _cart(r: Random) -> dict[str, float]:
    """A cart with a pendulum between two stops; the pendulum hits a post."""
    return {"l": r.uniform(0.2, 0.8), "wl": r.uniform(0.1, 1.0), "wr": r.uniform(0.1, 1.0), **_law(r),
            "M": r.uniform(0.5, 2.0), "m": r.uniform(0.2, 2.0), "c": r.choice([0.0, r.uniform(0.0, 1.0)]),
            "a0": r.uniform(-1.5, 0.0), **_draw(r, 2.0, "wa", "vx")}  # fmt: skip


BALL = """  parameter Length r, w;
  parameter Angle slope;
  parameter Real k;
  parameter Velocity vx, vy, vz;
  parameter AngularVelocity wx, wy, wz;
  coordinate Length x(rate = vx), y(rate = vy), z(start = r + 0.3 [m], rate = vz);
  coordinate Orientation o(rate = {wx, wy, wz});
  Gravity field(g = 9.81 [m/s2], direction = {sin(slope), 0, -cos(slope)});
  point C = {x, y, z};
  body ball = Solid(mass = 1 [kg], inertia = k*1 [kg]*r^2*{1, 1, 1}, frame = rotate(world, o), com = C);
  constraint floor: z >= r (friction = mu, restitution = e, on = ball, at = C - r*world.z);
  constraint wall: x <= w (friction = mu, restitution = e, on = ball, at = C + r*world.x);
"""


def _ball(r: Random) -> dict[str, float]:
    return {"r": r.uniform(0.03, 0.2), "w": r.uniform(0.3, 3.0), "k": r.uniform(0.1, 0.65), **_law(r),
            "slope": r.choice([0.0, r.uniform(0.0, 0.4)]), **_draw(r, 3.0, "vx", "vy", "vz"),
            **_draw(r, 30.0, "wx", "wy", "wz")}  # fmt: skip


ROPES = f"""  parameter Length l1, l2, h, x0, y0, u0, w0;
  parameter Mass m;
  parameter Velocity vx, vy, vu, vw;
  coordinate Length x(start = x0, rate = vx), y(start = y0, rate = vy);
  coordinate Length u(start = u0, rate = vu), w(start = w0, rate = vw);
{GRAVITY}  body one = Particle(mass = 1 [kg], at = {{x, y, 0}});
  body two = Particle(mass = m, at = {{u, w, 0}});
  constraint rope1: norm(position(one)) <= l1 (restitution = e/2);
  constraint rope2: norm(position(two) - position(one)) <= l2 (restitution = e/2);
  constraint floor1: y >= -h ({LAW}, slip = der(x));
  constraint floor2: w >= -h ({LAW}, slip = der(u));
"""


def _ropes(r: Random) -> dict[str, float]:
    """A weight on a rope from a peg, and one on a rope from the first, over a floor."""
    found = {"l1": r.uniform(0.5, 1.0), "l2": r.uniform(0.4, 0.9), "m": r.uniform(0.3, 2.0), **_law(r),
             **_draw(r, 1.5, "vx", "vy", "vu", "vw")}  # fmt: skip
    x = y = 0.0
    for length, one, other in (("l1", "x0", "y0"), ("l2", "u0", "w0")):
        angle, far = r.uniform(-1.4, 1.4), r.uniform(0.3, 0.99) * found[length]
        x, y = x + far * math.sin(angle), y - far * math.cos(angle)
        found[one], found[other] = x, y
    return {**found, "h": r.uniform(0.05, 0.6) - min(found["y0"], found["w0"])}


CRANK = f"""  parameter Length r, l, s1;
  parameter Angle a0;
  parameter AngularVelocity w0;
  parameter Mass m;
  coordinate Angle a(start = a0, rate = w0), b;
  coordinate Length s(guess = 0.7 [m]), y(start = 0);
{GRAVITY}  frame A = rotate_z(world, a);
  frame B = rotate_z(world, b);
  point P = r*A.x;
  point Q = P + l*B.x;
  body crank = {LINK.format(l="r", frame="A", com="r/2*A.x")};
  body rod = {LINK.format(l="l", frame="B", com="P + l/2*B.x")};
  body slider = Particle(mass = m, at = {{s, y, 0}});
  constraint pin: {{Q.x, Q.y}} = {{s, y}};
  constraint guide: y >= 0 ({LAW}, slip = der(s));
  constraint front: s <= s1 (restitution = e);
  constraint back: s >= 0.2 [m] (restitution = e);
"""


def _crank(r: Random) -> dict[str, float]:
    """A slider crank between two stops; its slider lies on a rough guide."""
    short, long, a0 = r.uniform(0.1, 0.25), r.uniform(0.5, 0.7), r.uniform(0.5, 2.5)
    s0 = short * math.cos(a0) + math.sqrt(long**2 - (short * math.sin(a0)) ** 2)
    return {"r": short, "l": long, "a0": a0, "s1": s0 + r.uniform(0.01, 0.2), "m": r.uniform(0.5, 3.0),
            **_law(r, 0.6), **_draw(r, 6.0, "w0")}  # fmt: skip


TETRAHEDRON = """  parameter Velocity vx, vy, vz;
  parameter AngularVelocity wx, wy, wz;
  coordinate Length x(rate = vx), y(rate = vy), z(start = 0.5 [m], rate = vz);
  coordinate Orientation o(rate = {wx, wy, wz});
  Gravity field;
  frame F = rotate(world, o);
  body box = Solid(mass = 1 [kg], inertia = {0.02, 0.025, 0.03}, frame = F, com = {x, y, z});
  parameter Length a[4] = {0.3, -0.2, -0.2, 0}, b[4] = {0, 0.25, -0.25, 0}, c[4] = {-0.1, -0.1, -0.1, 0.2};
  for i in 1:4 loop
    point p[i] = position(box) + a[i]*F.x + b[i]*F.y + c[i]*F.z;
    constraint foot[i]: p[i].z >= 0 (friction = mu, restitution = e, at = p[i]);
  end for;
"""


def _tetrahedron(r: Random) -> dict[str, float]:
    return {**_law(r, 0.7), **_draw(r, 2.0, "vx", "vy", "vz"), **_draw(r, 4.0, "wx", "wy", "wz")}


FAMILIES: dict[str, tuple[str, Draw]] = {
    "stone": (STONE, _stone), "chain": (CHAIN, _chain), "walker": (WALKER, _walker), "cart": (CART, _cart),
    "ball": (BALL, _ball), "ropes": (ROPES, _ropes), "crank": (CRANK, _crank),
    "tetrahedron": (TETRAHEDRON, _tetrahedron),
}  # fmt: skip


def text_of(family: str) -> str:
    """Return the model of a family."""
    return (f"model M\n  parameter Real mu, e;\n{FAMILIES[family][0]}  output Energy E = energy();\n"
            "  scene thrown\n    simulate(stop = 1.5 [s]);\n  end thrown;\nend M;\n")  # fmt: skip
