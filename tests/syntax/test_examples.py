"""The models of the language's tour, word for word, and names that others reserve."""

from __future__ import annotations

import keyword

import pytest

from lagc.diagnostics.faults import Source
from lagc.syntax import tree
from lagc.syntax.lalr_tables import tables
from lagc.syntax.parse import parse

SIMPLE_PENDULUM = """
model SimplePendulum "A mass on a massless string"
  parameter Mass m(min = 0) = 1 [kg];
  parameter Length l = 0.5 [m] "string length";

  coordinate Angle theta(start = 60 [deg]) "from the downward vertical";

  body bob = Particle(mass = m, at = l*{sin(theta), 0, -cos(theta)});

  effect gravity
    Gravity field(g = 9.81 [m/s2], direction = {0, 0, -1});
  end gravity;

  effect air "quadratic drag"
    parameter Real[kg/m] k = 1e-3;
    force drag = -k*norm(velocity(bob))*velocity(bob) at bob;
  end air;

  scene vacuum uses gravity;
  scene room uses gravity, air;
  scene workshop uses gravity, air
    parameter l = 0.7 [m];
    start theta = 30 [deg];
    simulate(stop = 20 [s], accuracy = 1e-8);
  end workshop;

  output Energy E = energy();
end SimplePendulum;
"""

STRING_PENDULUM = """
model StringPendulum
  parameter Mass m = 1 [kg];
  parameter Length l = 0.5 [m];
  coordinate Length x(start = 0.5 [m]), z(start = 0);

  body bob = Particle(mass = m, at = {x, 0, z});
  constraint string: norm(position(bob)) = l;       // holonomic: found, not declared

  effect gravity Gravity field; end gravity;
  scene lab uses gravity;

  output Force tension = -reaction(string);         // positive along the gradient of lhs - rhs
end StringPendulum;
"""

CONSTRAINTS = """
model Constraints
constraint knife:   der(x)*sin(phi) = der(y)*cos(phi);          // non-holonomic
constraint hub:     y = h(time);                                // rheonomic
constraint rolling: velocity(wheel, at = contact) = {0, 0, 0};  // three rows
constraint floor:   position(ball).z >= r (restitution = 0.8);  // unilateral
constraint skid:    y = 0 (friction = 0.3, at = ball);          // imperfect: depends on the multiplier
end Constraints;
"""

HEAVY_TOP = """
model HeavyTop
  parameter Mass m = 1 [kg];
  parameter Length d = 0.1 [m];
  parameter Inertia I1 = 2e-3, I3 = 1e-3 [kg.m2];
  coordinate Angle psi, theta(start = 30 [deg]), phi;

  frame A = rotate_z(world, psi);
  frame B = rotate_x(A, theta);
  frame C = rotate_z(B, phi);            // rotate(frame, axis, angle) for any axis
  body top = Solid(mass = m, inertia = {I1, I1, I3}, frame = C, com = d*C.z);
  effect gravity Gravity field; end gravity;
  scene lab uses gravity;
end HeavyTop;

model FourBar
  Solid crank(mass = 1 [kg]), coupler(mass = 1 [kg]), rocker(mass = 1 [kg]);
  joint A = Revolute(world, crank,   axis = world.y, at = {0,0,0});
  joint B = Revolute(crank, coupler, axis = world.y, at = {1,0,0});
  joint C = Revolute(coupler, rocker, axis = world.y, at = {1,0,1});
  joint D = Revolute(rocker, world,  axis = world.y, at = {0,0,1});   // closes a loop: becomes explicit rows
end FourBar;
"""

MARBLE = """
model Marble "A ball that rolls on a turning table"
  parameter Mass m = 1 [kg];
  parameter Length R = 0.05 [m];
  parameter AngularVelocity Omega = 2 [rad/s];
  coordinate Length x(start = 0.3 [m]), y, z(start = 0.05 [m]);
  coordinate Orientation o(rate = {1, 0, 0} [rad/s]);
  frame B = rotate(world, o);
  point G = {x, y, z};
  body ball = Solid(mass = m, inertia = 2/5*m*R^2*{1, 1, 1}, frame = B, com = G);
  constraint touch: z = R;
  constraint roll: velocity(ball, at = G - R*world.z) = Omega*cross(world.z, G - R*world.z);   // two rows
end Marble;
"""

CHAIN = """
model Chain
  structural Integer n = 50;
  parameter Mass m = 1 [kg];
  parameter Length l = 1 [m];
  coordinate Angle th[n](each start = 0.1 [rad]);
  point P[0] = {0, 0, 0};
  for i in 1:n loop
    point P[i] = P[i-1] + l*{sin(th[i]), 0, -cos(th[i])};
    body bob[i] = Particle(mass = m, at = P[i]);
  end for;
end Chain;

model TwoChains
  extends Lab;                     // inherits everything a partial model declares
  Chain a(n = 3), b(n = 4, l = 0.5 [m]);
  potential spring = 1/2*k*norm(position(a.bob[3]) - position(b.bob[4]))^2;
end TwoChains;
"""

ENERGIES = """
model Energies
lagrangian magnetic = q*dot(A(position(p)), velocity(p));   // velocity-dependent potential
dissipation damper  = 1/2*c*der(x)^2;                       // Rayleigh function
end Energies;
"""

TOUR = (SIMPLE_PENDULUM, STRING_PENDULUM, CONSTRAINTS, HEAVY_TOP, MARBLE, CHAIN, ENERGIES)


@pytest.mark.parametrize("text", TOUR)
def test_the_tour_is_read(text: str) -> None:
    assert parse(Source("tour.lag", text)).declarations


def test_what_the_pendulum_declares() -> None:
    (model,) = parse(Source("x", SIMPLE_PENDULUM)).declarations
    assert isinstance(model, tree.ModelDeclaration)
    assert [type(d).__name__ for d in model.body] == [
        "Quantities", "Quantities", "Quantities", "Construct", "Effect", "Effect",
        "Scene", "Scene", "Scene", "Quantities",
    ]  # fmt: skip


# The words that the grammar needs where an operand may stand.
RESERVED = {"if", "not", "true", "false"}
NAMES = sorted(
    {
        *keyword.kwlist,
        *("auto", "break", "case", "char", "const", "default", "do", "double", "enum", "extern", "float"),
        *("goto", "int", "long", "register", "short", "signed", "sizeof", "static", "struct", "switch"),
        *("typedef", "union", "unsigned", "void", "volatile", "t", "q", "x", "I", "E", "N", "main", "self"),
        *("math", "sin", "time", "world", "der", "y_1", "_x", "X9"),
        *tables().keywords,
    }
    - RESERVED
)


@pytest.mark.parametrize("name", NAMES)
def test_names_that_others_reserve_are_legal(name: str) -> None:
    text = (
        f"model {name}\n"
        f"  parameter Length {name}(min = 0) = 1, other = {name} + 1;\n"
        f"  coordinate Angle {name}[3](start = {name}, each {name} = 2);\n"
        f"  body {name} = Particle(mass = {name}, {name} = {name}.{name}[{name}]*{name});\n"
        f"  force {name} = {name}*{{{name}, -{name}, ({name})}} at {name};\n"
        f"  torque {name} = {name}/2 on {name} from {name} unless {name}, {name};\n"
        f"  constraint {name}: {name} = {name};\n"
        f"  for {name} in 1:{name} loop point P[{name}] = {name}; end for;\n"
        f"  effect {name} potential V = if {name} > 1 then {name} else {name}; end {name};\n"
        f"  scene {name} uses {name}, {name} start {name} = {name}; end {name};\n"
        f"  output Real {name} = {name}(1) + 2*{name};\n"
        f"end {name};\n"
    )
    (model,) = parse(Source("x", text)).declarations
    assert isinstance(model, tree.ModelDeclaration) and model.name == name
    assert len(model.body) == 10


@pytest.mark.parametrize("name", sorted(set(NAMES) - {"end", "initial", "when"}))
def test_keywords_are_names_before_signs_of_names(name: str) -> None:
    text = f"model M initial x = 0; {name} = 1; {name}.y = 2; {name}[1] = 3; {name} + 1 = 4; end M;"
    (model,) = parse(Source("x", text)).declarations
    assert isinstance(model, tree.ModelDeclaration)
    (initial,) = model.body
    assert isinstance(initial, tree.Initial) and len(initial.conditions) == 5
