"""Faults of mechanics (LAG04xx) and of the preparation of the equations (LAG05xx)."""

from __future__ import annotations

from lagc.diagnostics.catalogue import Entry

_PARTICLE = """\
model M
  parameter Mass m = 1 [kg];
  coordinate Length x, y;
  body p = Particle(mass = m, at = {x, y, 0});
"""


def _on_particle(lines: str) -> str:
    return f"{_PARTICLE}{lines}end M;\n"


_DISC = """\
model M
  parameter Mass m = 1 [kg];
  parameter Length R = 0.1 [m];
  coordinate Length x;
  coordinate Angle phi;
  frame B = rotate_y(world, phi);
  point G = {x, 0, R};
  body disc = Solid(mass = m, inertia = m*R^2*{1/4, 1/2, 1/4}, frame = B, com = G);
"""


def _on_disc(lines: str) -> str:
    return f"{_DISC}{lines}end M;\n"


_SPRINGS = """\
model M
  parameter Mass m = 1 [kg];
  parameter Stiffness k = 10 [N/m];
  coordinate Length x, y;
  body p = Particle(mass = m, at = {x, 0, 0});
"""

ENTRIES: dict[str, Entry] = {
    "LAG0401": Entry(
        "a speed that is not linear in the rates",
        "lagc solves a linear system for the rates, given the declared speeds. A speed is therefore a sum "
        "of rates, each multiplied by an expression of coordinates, parameters and time.",
        _on_particle("  speed Velocity u = sqrt(der(x)^2 + der(y)^2);\n"),
        _on_particle("  speed Velocity u = 3/5*der(x) + 4/5*der(y);\n"),
    ),
    "LAG0402": Entry(
        "declared speeds that are linearly dependent",
        "The rates follow from the declared speeds only if the speeds are linearly independent "
        "combinations of the rates.",
        _on_particle("  speed Velocity u = der(x) + der(y);\n  speed Velocity w = 2*der(x) + 2*der(y);\n"),
        _on_particle("  speed Velocity u = der(x) + der(y);\n  speed Velocity w = der(x) - der(y);\n"),
    ),
    "LAG0403": Entry(
        "more speeds than rates",
        "There is one generalized speed for each rate of a coordinate (three for an orientation). Declare "
        "a further combination of rates as an `output`.",
        _on_particle(
            "  speed Velocity u = der(x);\n  speed Velocity w = der(y);\n"
            "  speed Velocity s = der(x) + der(y);\n"
        ),
        _on_particle("  speed Velocity u = der(x) + der(y);\n  speed Velocity w = der(x) - der(y);\n"),
    ),
    "LAG0404": Entry(
        "a mass or an inertia that changes",
        "Bodies have constant mass, and the inertia of a solid is constant in the axes of its own frame.",
        "model M\n  parameter Mass m = 1 [kg];\n  coordinate Length x;\n"
        "  body p = Particle(mass = m*exp(-time/(1 [s])), at = {x, 0, 0});\nend M;\n",
        "model M\n  parameter Mass m = 1 [kg];\n  coordinate Length x;\n"
        "  body p = Particle(mass = m, at = {x, 0, 0});\nend M;\n",
    ),
    "LAG0406": Entry(
        "a term of the Lagrangian that depends on an input",
        "Lagrange's equations contain the time derivative of the momenta, and the time derivative of an "
        "input is unknown. Use a `force`, or an expression of `time` instead of the input.",
        _on_particle("  input Mass u;\n  lagrangian extra = u*der(x)*der(y);\n"),
        _on_particle("  lagrangian extra = 1/2*m*der(x)*der(y);\n"),
    ),
    "LAG0407": Entry(
        "a constraint that depends on an input",
        "The constraint is differentiated twice with respect to time, and the derivatives of an input are "
        "unknown. Write a prescribed motion as an expression of `time`.",
        _on_particle("  input Length u;\n  constraint drive: x = u;\n"),
        _on_particle("  parameter Length h = 0.1 [m];\n  constraint drive: x = h*sin(time/(1 [s]));\n"),
    ),
    "LAG0408": Entry(
        "a constraint that cannot be satisfied",
        "The two sides differ by a constant, whatever the motion.",
        _on_particle("  constraint c: x + 1 [m] = x;\n"),
        _on_particle("  constraint c: x + 1 [m] = y;\n"),
    ),
    "LAG0409": Entry(
        "a constraint that restricts nothing",
        "The two sides contain no coordinate and no speed, or these cancel. Write a relation between "
        "parameters as the value of one of them.",
        _on_particle("  parameter Length a = 1 [m], b = 1 [m];\n  constraint c: a = b;\n"),
        _on_particle("  parameter Length a = 1 [m];\n  constraint c: x = a;\n"),
    ),
    "LAG0412": Entry(
        "a friction force that can add energy",
        "This is a warning. The power of a force depends on the velocity of the point it acts on. The "
        "force may oppose one velocity, `velocity(...)` in its expression, and act on a point with another "
        "one; a torque between two bodies may act on one of them only. Let the force oppose the velocity of "
        "the point that it acts on.",
        _on_disc("  force F = -2 [kg/s]*velocity(disc) on disc at G - R*world.z;\n"),
        _on_disc("  force F = -2 [kg/s]*velocity(disc, at = G - R*world.z) on disc at G - R*world.z;\n"),
    ),
    "LAG0413": Entry(
        "a constraint whose gradient vanishes where it holds",
        "A constraint force acts along the gradient of the constraint. `x^2 = 0` or `norm(a - b) = 0` "
        "touches zero without crossing it, so its gradient vanishes or has no direction wherever it "
        "holds, and no force can enforce it. Write `x = 0` or `a = b`. In `x^2*y = 0` this happens on the "
        "branch x = 0 only, which is a warning.",
        _on_particle("  constraint c: x^2 = 0;\n"),
        _on_particle("  constraint c: x = 0;\n"),
    ),
    "LAG0421": Entry(
        "a constraint with a kink or a jump",
        "This is a warning. Where a constraint of positions has a kink or a jump in the coordinates or in "
        "time, the velocities would jump, as in an impact. A run that gets there stops. Use a smooth "
        "constraint: branches may meet if values and slopes agree, "
        "and conditions on parameters are allowed. Forces may jump, and potentials may have kinks.",
        _on_particle("  constraint c: y = abs(x);\n"),
        _on_particle("  parameter Length e = 0.01 [m];\n  constraint c: y = sqrt(x^2 + e^2);\n"),
    ),
    "LAG0422": Entry(
        "a body whose position has a kink or a jump",
        "This is a warning. The velocity of the body would jump there, as in an impact. A run that gets "
        "there stops. The position is that of the center "
        "of mass and the frame of a solid, as functions of the coordinates and of time.",
        "model M\n  coordinate Length x;\n  body p = Particle(mass = 1 [kg], at = {x, 0, abs(x)});\nend M;\n",
        "model M\n  coordinate Length x;\n  parameter Length e = 0.01 [m];\n"
        "  body p = Particle(mass = 1 [kg], at = {x, 0, sqrt(x^2 + e^2)});\nend M;\n",
    ),
    "LAG0423": Entry(
        "an energy that jumps",
        "This is a warning. A force is the gradient of an energy, and a jump of the energy has none. A run "
        "that gets there stops. An energy may have "
        "kinks, and may change with time in any way. An added kinetic energy must not have kinks in the "
        "rates, because the momentum would jump.",
        _on_particle("  potential step = if x > 0 then 1 [J] else 0;\n"),
        _on_particle("  potential ramp = if x > 0 then 1 [N]*x else 0;\n"),
    ),
    "LAG0424": Entry(
        "a declared speed that jumps",
        "This is a warning. A declared speed is a state of the motion. Where its definition jumps in the "
        "coordinates or in time, the state would have to jump although no body does. A run that gets "
        "there stops.",
        _on_particle("  speed Velocity u = der(x)*sign(y + 1 [m]);\n"),
        _on_particle("  speed Velocity u = der(x)*(2 + sin(y/(1 [m])));\n"),
    ),
    "LAG0427": Entry(
        "a new value for a rate that is not a state",
        "Declared speeds are the states, and rates follow from them. Use `reinit` on the speeds.",
        _on_particle("  speed Velocity u = 2*der(x);\n  when x > 1 [m] then reinit(der(x), 0); end when;\n"),
        _on_particle("  speed Velocity u = 2*der(x);\n  when x > 1 [m] then reinit(u, 0); end when;\n"),
    ),
    "LAG0428": Entry(
        "a reaction that is not unique",
        "One of these constraint equations follows from the others, so the way in which they share the "
        "reaction is not determined. The dependent equation is left out, and its reaction is 0.",
        _on_particle(
            "  constraint one: der(x) = 0;\n  constraint two: 2*der(x) = 0;\n"
            "  output Force f = reaction(two);\n"
        ),
        _on_particle("  constraint one: der(x) = 0;\n  output Force f = reaction(one);\n"),
    ),
    "LAG0429": Entry(
        "a system that nothing moves",
        "No force, energy, constraint or initial rate sets any coordinate in motion: all keep their initial "
        "values. A force or an effect such as gravity may be missing.",
        "model M\n  coordinate Length x;\n  body p = Particle(mass = 1 [kg], at = {x, 0, 0});\nend M;\n",
        "model M\n  coordinate Length x(rate = 1 [m/s]);\n"
        "  body p = Particle(mass = 1 [kg], at = {x, 0, 0});\nend M;\n",
    ),
    "LAG0431": Entry(
        "a load of a reaction that is not a multiplier of its own",
        "A force or torque may depend on `reaction(c)` if `c` is a one-sided constraint, or an equation that "
        "no other one implies. Dry friction needs such an equation too. Beside dry friction of constraints "
        "with `=` and of joints, loads depend on no reaction, and no actuator holds a constraint.",
        _on_particle(
            "  constraint rail: x = 0;\n  constraint again: 2*der(x) = 0;\n"
            "  force F = {0, -0.1*reaction(again), 0} at p;\n"
        ),
        _on_particle("  constraint rail: x = 0;\n  force F = {0, -0.1*reaction(rail), 0} at p;\n"),
    ),
    "LAG0433": Entry(
        "friction along a slip that constraints hold",
        "This is a warning. The constraints of the model hold the slip of this contact at zero. It never "
        "slips, and its friction changes nothing.",
        _on_particle("  constraint rail: x = 0 (friction = 0.3, slip = der(x));\n"),
        _on_particle("  constraint rail: x = 0 (friction = 0.3, slip = der(y));\n"),
    ),
    "LAG0434": Entry(
        "gravity of a negative magnitude",
        "This is a warning. `g` is a magnitude along the `direction`, which is -world.z unless it is given: "
        "a negative one pulls upwards.",
        _on_particle("  Gravity field(g = -9.81);\n"),
        _on_particle("  Gravity field(g = 9.81);\n"),
    ),
    "LAG0435": Entry(
        "a weight that counts twice",
        "This is a warning. `Gravity` acts on all bodies. A potential that changes as the weight of one of "
        "them, or of all, at each configuration doubles it.",
        "model M\n  parameter Mass m = 2 [kg];\n  coordinate Length z;\n"
        "  body p = Particle(mass = m, at = {0, 0, z});\n  Gravity field;\n"
        "  potential weight = m*9.81 [m/s2]*z;\nend M;\n",
        "model M\n  parameter Mass m = 2 [kg];\n  coordinate Length z;\n"
        "  body p = Particle(mass = m, at = {0, 0, z});\n  Gravity field;\nend M;\n",
    ),
    "LAG0430": Entry(
        "a reaction of a parameter that changes an inertia",
        "`reaction(l)` is the force that holds the parameter `l`. If a mass or an inertia depends on `l`, "
        "this force depends on how its matter would move. Give the inertia a parameter of its own.",
        "model M\n  parameter Mass m = 1 [kg];\n  parameter Length l = 1 [m];\n  coordinate Angle a;\n"
        "  frame B = rotate_y(world, a);\n"
        "  body rod = Solid(mass = m, inertia = m*l^2/12*{1, 1, 0}, frame = B, com = -l/2*B.z);\n"
        "  output Force T = -reaction(l);\nend M;\n",
        "model M\n  parameter Mass m = 1 [kg];\n  parameter Length l = 1 [m];\n"
        "  parameter Inertia J = 0.083 [kg.m2];\n  coordinate Angle a;\n  frame B = rotate_y(world, a);\n"
        "  body rod = Solid(mass = m, inertia = J*{1, 1, 0}, frame = B, com = -l/2*B.z);\n"
        "  output Force T = -reaction(l);\nend M;\n",
    ),
    "LAG0501": Entry(
        "a coordinate without inertia",
        "Forces or outputs depend on this coordinate, but no body moves with it, and no constraint ties "
        "it to a coordinate with inertia or prescribes its rate, as `der(y) = x/T` does. Add a body or a "
        "constraint. A coordinate that nothing depends on is left out without an error.",
        f"{_SPRINGS}  potential spring = 1/2*k*(y - x)^2;\nend M;\n",
        f"{_SPRINGS}  body r = Particle(mass = m, at = {{y, 0, 0}});\n"
        "  potential spring = 1/2*k*(y - x)^2;\nend M;\n",
    ),
    "LAG0590": Entry(
        "a coefficient that is too large",
        "A coefficient in the derived equations exceeds 1.8e308, the largest double. Choose units in "
        "which the constants of the model have moderate values.",
    ),
    "LAG0591": Entry(
        "a motion without a Taylor series",
        "The method `taylor` needs a recurrence for the derivatives of each function in the equations. There "
        "is none for a power whose exponent varies, or for a choice that changes within a step. Equations of "
        "large dense systems, which a loop solves, have none either. All other methods can be taken.",
    ),
}
