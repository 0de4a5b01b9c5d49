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


def _cone(height: str) -> str:
    head = _PARTICLE.replace("x, y;", "x(start = 1 [m]), y, z;").replace("{x, y, 0}", "{x, y, z}")
    return f"{head}  constraint cone: z = {height};\nend M;\n"


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
        "A declared speed takes the place of a rate in the equations.  The rates are found from the "
        "speeds by solving a linear system, so each speed must be a sum of rates, each multiplied by "
        "something that holds coordinates, parameters and time only.",
        _on_particle("  speed Velocity u = sqrt(der(x)^2 + der(y)^2);\n"),
        _on_particle("  speed Velocity u = 3/5*der(x) + 4/5*der(y);\n"),
    ),
    "LAG0402": Entry(
        "speeds that depend on one another",
        "Declared speeds must be independent combinations of the rates, otherwise the rates cannot be "
        "found from them.",
        _on_particle("  speed Velocity u = der(x) + der(y);\n  speed Velocity w = 2*der(x) + 2*der(y);\n"),
        _on_particle("  speed Velocity u = der(x) + der(y);\n  speed Velocity w = der(x) - der(y);\n"),
    ),
    "LAG0403": Entry(
        "more speeds than rates",
        "There is one generalized speed for each rate of a coordinate (three for an orientation); more "
        "cannot be declared.  A further combination of rates can be an `output`.",
        _on_particle(
            "  speed Velocity u = der(x);\n  speed Velocity w = der(y);\n"
            "  speed Velocity s = der(x) + der(y);\n"
        ),
        _on_particle("  speed Velocity u = der(x) + der(y);\n  speed Velocity w = der(x) - der(y);\n"),
    ),
    "LAG0404": Entry(
        "a mass or an inertia that changes",
        "The laws used here are those of bodies of constant mass; the inertia of a solid is constant in "
        "the axes of its own frame.",
        "model M\n  parameter Mass m = 1 [kg];\n  coordinate Length x;\n"
        "  body p = Particle(mass = m*exp(-time/(1 [s])), at = {x, 0, 0});\nend M;\n",
        "model M\n  parameter Mass m = 1 [kg];\n  coordinate Length x;\n"
        "  body p = Particle(mass = m, at = {x, 0, 0});\nend M;\n",
    ),
    "LAG0406": Entry(
        "a term of the Lagrangian that depends on an input",
        "Lagrange's equations differentiate the Lagrangian's momenta by time, and the time derivative of "
        "an input is not known.",
        _on_particle("  input Mass u;\n  lagrangian extra = u*der(x)*der(y);\n"),
        _on_particle("  lagrangian extra = 1/2*m*der(x)*der(y);\n"),
    ),
    "LAG0407": Entry(
        "a constraint that depends on an input",
        "The accelerations that a constraint allows need the time derivatives of all that it holds, and "
        "those of an input are not known.  A drive is an expression of `time`.",
        _on_particle("  input Length u;\n  constraint drive: x = u;\n"),
        _on_particle("  parameter Length h = 0.1 [m];\n  constraint drive: x = h*sin(time/(1 [s]));\n"),
    ),
    "LAG0408": Entry(
        "a constraint that nothing meets",
        "The two sides differ by a constant, whatever the motion.",
        _on_particle("  constraint c: x + 1 [m] = x;\n"),
        _on_particle("  constraint c: x + 1 [m] = y;\n"),
    ),
    "LAG0409": Entry(
        "a constraint that restricts nothing",
        "The two sides hold no coordinate and no speed, or each of them cancels.  A relation between "
        "parameters is written as the value of one of them.",
        _on_particle("  parameter Length a = 1 [m], b = 1 [m];\n  constraint c: a = b;\n"),
        _on_particle("  parameter Length a = 1 [m];\n  constraint c: x = a;\n"),
    ),
    "LAG0410": Entry(
        "constraints that contradict each other",
        "The constraint restricts a motion that others restrict already, and it can never hold together "
        "with them: on every state tried that meets the others it is violated.",
        _on_particle("  constraint c: x = y;\n  constraint d: x = y + 1 [m];\n"),
        _on_particle("  constraint c: x = y;\n  constraint d: x + y = 1 [m];\n"),
    ),
    "LAG0411": Entry(
        "a force at a point that belongs to no body",
        "A warning.  `force F at P` acts on the point P with the velocity of P itself.  The place where "
        "a disc touches the ground, or where something slides along a rod, is at each time another point "
        "of the body, and that point moves otherwise.  `on body at P` means the point of the body, with "
        "the torque about its centre that this brings; a body of mass 0 at P means the point itself.",
        _on_disc("  force F = 1 [N]*world.x at G - R*world.z;\n"),
        _on_disc("  force F = 1 [N]*world.x on disc at G - R*world.z;\n"),
    ),
    "LAG0412": Entry(
        "a friction that can bring energy",
        "A warning.  What a force does depends on the velocity that it acts on.  A force that opposes one "
        "velocity and acts on a point of another, a torque between two bodies that acts on one of them "
        "only, one that opposes its velocity in some directions and drives it in others, or a dissipation "
        "that falls with the rates in some direction may drive the system where it was meant to brake it.",
        _on_disc("  force F = -2 [kg/s]*velocity(disc) on disc at G - R*world.z;\n"),
        _on_disc("  force F = -2 [kg/s]*velocity(disc, at = G - R*world.z) on disc at G - R*world.z;\n"),
    ),
    "LAG0413": Entry(
        "a constraint whose gradient vanishes where it holds",
        "A constraint acts along its gradient.  `x^2 = 0` or `norm(a - b) = 0` touches zero and does not "
        "cross it: wherever it holds, its gradient vanishes or has no direction: no force can enforce it.  "
        "What is meant is that what is squared vanishes.  `x^2*y = 0` does so where x is zero, on one "
        "of its branches.",
        _on_particle("  constraint c: x^2 = 0;\n"),
        _on_particle("  constraint c: x = 0;\n"),
    ),
    "LAG0421": Entry(
        "a constraint with a kink or a jump",
        "Where a row bends or jumps, in the coordinates or in time, the speeds that it allows jump: that "
        "is an impact, which no equation of motion holds.  Pieces that agree in value and slope where one "
        "follows the other are accepted, and so are conditions on parameters alone.  Forces and potentials "
        "may bend; forces may jump.",
        _on_particle("  constraint c: y = abs(x);\n"),
        _on_particle("  parameter Length e = 0.01 [m];\n  constraint c: y = sqrt(x^2 + e^2);\n"),
    ),
    "LAG0422": Entry(
        "a body whose place has a kink or a jump",
        "The velocity of the body would jump there, as by an impact.  This holds for its centre of mass and "
        "for the frame of a solid, as functions of the coordinates and of time.",
        "model M\n  coordinate Length x;\n  body p = Particle(mass = 1 [kg], at = {x, 0, abs(x)});\nend M;\n",
        "model M\n  coordinate Length x;\n  parameter Length e = 0.01 [m];\n"
        "  body p = Particle(mass = 1 [kg], at = {x, 0, sqrt(x^2 + e^2)});\nend M;\n",
    ),
    "LAG0423": Entry(
        "an energy that jumps",
        "A force is the slope of an energy.  Where the energy jumps there is no finite one, and its slope, "
        "zero on both sides, does not show the step that a motion would have to climb.  An energy may bend, "
        "and it may change with time in any way.  An added kinetic energy must not bend in the rates: "
        "momentum would jump.",
        _on_particle("  potential step = if x > 0 then 1 [J] else 0;\n"),
        _on_particle("  potential ramp = if x > 0 then 1 [N]*x else 0;\n"),
    ),
    "LAG0424": Entry(
        "a declared speed that jumps",
        "A declared speed is a state of the motion.  Where its definition jumps in the coordinates or in "
        "time the state would have to jump, though nothing moves faster.",
        _on_particle("  speed Velocity u = der(x)*sign(y);\n"),
        _on_particle("  speed Velocity u = der(x)*(2 + sin(y/(1 [m])));\n"),
    ),
    "LAG0425": Entry(
        "an energy that jumps on the cut of an angle",
        "`atan2(y, x)` jumps by a turn where `y` passes 0 with `x` below 0.  An energy that jumps with it is "
        "right as long as the motion stays away from there; a run that passes the cut fails, since its "
        "energy is out of balance.  What is the same on both sides, as the square of the angle, may pass.",
        _on_particle("  potential V = 1 [J]*atan2(y, x);\n").replace("Length x,", "Length x(start = 1 [m]),"),
        _on_particle("  potential V = 1 [J]*atan2(y, x)^2;\n").replace(
            "Length x,", "Length x(start = 1 [m]),"
        ),
    ),
    "LAG0426": Entry(
        "a constraint without a gradient at a point",
        "The tip of a cone, and what is like it: the constraint holds there, and has no slope, or another "
        "one in each direction.  Nothing determines a motion that comes through; one that stays away is as "
        "good as any.  A rounded tip, `sqrt(x^2 + y^2 + r^2)`, has a slope everywhere.",
        _cone("sqrt(x^2 + y^2)"),
        _cone("sqrt(x^2 + y^2 + (1 [mm])^2)"),
    ),
    "LAG0427": Entry(
        "a new value of a rate that is no state",
        "Where speeds are declared they are the states, and rates follow from them: `reinit` is about the "
        "speeds.",
        _on_particle("  speed Velocity u = 2*der(x);\n  when x > 1 [m] then reinit(der(x), 0); end when;\n"),
        _on_particle("  speed Velocity u = 2*der(x);\n  when x > 1 [m] then reinit(u, 0); end when;\n"),
    ),
    "LAG0428": Entry(
        "a reaction that is one of many",
        "Rows of which one follows from the others hold the motion together; how they share what that takes "
        "is not determined.  The row that follows is left out, and its reaction is 0.",
        _on_particle(
            "  constraint one: der(x) = 0;\n  constraint two: 2*der(x) = 0;\n"
            "  output Force f = reaction(two);\n"
        ),
        _on_particle("  constraint one: der(x) = 0;\n  output Force f = reaction(one);\n"),
    ),
    "LAG0501": Entry(
        "a coordinate that moves no mass",
        "The acceleration of a coordinate is found from the inertia that moves with it.  Forces or "
        "outputs speak of this one, but no body moves with it, and no constraint ties it to another "
        "that has inertia or gives its rate, as `der(y) = x/T` does.  A coordinate that nothing at all "
        "speaks of is left out, without a fault.",
        f"{_SPRINGS}  potential spring = 1/2*k*(y - x)^2;\nend M;\n",
        f"{_SPRINGS}  body r = Particle(mass = m, at = {{y, 0, 0}});\n"
        "  potential spring = 1/2*k*(y - x)^2;\nend M;\n",
    ),
    "LAG0590": Entry(
        "a number of the equations is too large",
        "A coefficient that came up while the equations were derived exceeds the largest number that "
        "a double can hold, 1.8e308.  Choose units in which the constants of the model are of "
        "moderate size.",
    ),
}
