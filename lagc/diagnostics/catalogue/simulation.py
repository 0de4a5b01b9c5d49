"""Faults of runs (LAG06xx): requests that make no sense, starts that do not exist, runs that end early."""

from __future__ import annotations

from lagc.diagnostics.catalogue import Entry

ENTRIES: dict[str, Entry] = {
    "LAG0601": Entry(
        "a run names something that the model does not have",
        "`-p NAME=...` names a parameter or input, by the name that the model file declares, with the "
        "instance before it where there is one: `a.bob.m`.  `lagc explain FILE` lists them.",
    ),
    "LAG0602": Entry(
        "a given value is outside its bounds, or not a finite number",
        "The bounds are the `min` and `max` of the parameter's declaration.",
    ),
    "LAG0603": Entry(
        "a parameter has no value",
        "It was declared without one, and neither the scene nor the run gives it: say `-p NAME=VALUE`.",
    ),
    "LAG0604": Entry(
        "what is asked of the run makes no sense",
        "Times and tolerances are positive and finite; `--accuracy` chooses method and tolerance, so that "
        "it stands without `--method`, `--rtol`, `--atol` and `--step`; a fixed step has no tolerance; "
        "`--every` and `--points` are two ways to say one thing.",
    ),
    "LAG0605": Entry(
        "a given value has the wrong unit",
        "The unit in brackets must be one of the quantity that the parameter or start value is: "
        "`-p 'l=70[cm]'` for a length.  Without brackets the number is in the SI unit.",
    ),
    "LAG0606": Entry(
        "a start value is given for something that does not start",
        "`--start NAME=...` names a coordinate (`theta`) or a speed (`der(theta)`, or the name of a "
        "declared `speed`).",
    ),
    "LAG0607": Entry(
        "a run gives a parameter that is built into the compiled model",
        "Structural parameters, and those whose value depends on others, are a part of the code: they are "
        "given to `model.compile(parameters=...)`, before `bind`, `simulate` or `rhs`.",
    ),
    "LAG0610": Entry(
        "no start was found that meets all conditions",
        "The constraints, their rates, the `initial` section and the values that are fixed (`fixed`, "
        "`startFixed`, `rateFixed`) have no common solution that is found from the start values.  Those that "
        "are named have none together, and any fewer have.  Let one of them go where they contradict each "
        "other; where there should be a solution, begin nearer to it.",
    ),
    "LAG0611": Entry(
        "a start value is not a finite number",
        "The expression after `start =` or `rate =` divides by zero, or takes the root or logarithm of a "
        "negative number, for the parameters of this run.",
    ),
    "LAG0612": Entry(
        "the mass matrix is singular at the start",
        "Nothing has inertia along a speed: a mass or an inertia is zero for the parameters of this run, or "
        "the start is a posture in which a coordinate moves nothing, as the longitude at a pole.  Give it "
        "inertia, begin in another posture, or choose coordinates that have no such posture there.",
        """
model Bob
  parameter Mass m = 0;
  coordinate Length x(start = 1);
  body bob = Particle(mass = m, at = {x, 0, 0});
  potential spring = 1[N/m]*x^2;
end Bob;
""",
        """
model Bob
  parameter Mass m = 2;
  coordinate Length x(start = 1);
  body bob = Particle(mass = m, at = {x, 0, 0});
  potential spring = 1[N/m]*x^2;
end Bob;
""",
    ),
    "LAG0613": Entry(
        "the equations have no finite value at the start",
        "An expression divides by zero there, or takes the root or logarithm of a negative number, for the "
        "start values and parameters of this run.  It is named with the values of what it is made of.",
        """
model Bead
  coordinate Length x(start = 0);
  body bead = Particle(mass = 1[kg], at = {x, 0, 0});
  potential V = 1[N.m2]/x;
end Bead;
""",
        """
model Bead
  coordinate Length x(start = 1);
  body bead = Particle(mass = 1[kg], at = {x, 0, 0});
  potential V = 1[N.m2]/x;
end Bead;
""",
    ),
    "LAG0614": Entry(
        "constraints contradict each other at the start",
        "The start meets the constraints and their rates, but no acceleration goes on meeting them: "
        "in this posture what they ask for depends on each other, and differs.  Let one of them go, or begin "
        "in another posture.",
    ),
    "LAG0615": Entry(
        "kinetic energy is negative",
        "Some motion has less kinetic energy than rest: a term of `kinetic` or `lagrangian`, or a matrix of "
        "inertia that no body has.  Forces would drive it the wrong way, and without end.",
        """
model Bob
  coordinate Length x(rate = 1), y;
  body bob = Particle(mass = 1, at = {x, y, 0});
  kinetic added = -1[kg]*der(y)^2;
end Bob;
""",
        """
model Bob
  coordinate Length x(rate = 1), y;
  body bob = Particle(mass = 1, at = {x, y, 0});
  kinetic added = 1[kg]*der(y)^2;
end Bob;
""",
    ),
    "LAG0616": Entry(
        "an output has no finite value at the start",
        "It divides by zero there, or takes the root or logarithm of a negative number.  It does not change "
        "the motion; its first recorded value is `inf` or `nan`.",
        """
model Bob
  coordinate Length x(rate = 1);
  body bob = Particle(mass = 1, at = {x, 0, 0});
  output Real ratio = 1[m]/x;
end Bob;
""",
        """
model Bob
  coordinate Length x(start = 1, rate = 1);
  body bob = Particle(mass = 1, at = {x, 0, 0});
  output Real ratio = 1[m]/x;
end Bob;
""",
    ),
    "LAG0617": Entry(
        "a value made of parameters is out of its bounds",
        "The value of a parameter is computed from others and leaves the `min` or `max` of its declaration, "
        "for the values of this run; or a mass or a moment of inertia is negative, or a moment is more "
        "than the two others together.",
        """
model Bob
  parameter Mass total = 1, fuel = 2;
  coordinate Length x;
  body bob = Particle(mass = total - fuel, at = {x, 0, 0});
end Bob;
""",
        """
model Bob
  parameter Mass total = 2, fuel = 1;
  coordinate Length x;
  body bob = Particle(mass = total - fuel, at = {x, 0, 0});
end Bob;
""",
    ),
    "LAG0618": Entry(
        "an angle of many whole radians",
        "A number without a unit that is given to an angle is in radians; this one looks like degrees.",
        """
model Pendulum
  coordinate Angle theta(start = 30);
  body bob = Particle(mass = 1, at = {sin(theta)*1 [m], 0, -cos(theta)*1 [m]});
end Pendulum;
""",
        """
model Pendulum
  coordinate Angle theta(start = 30 [deg]);
  body bob = Particle(mass = 1, at = {sin(theta)*1 [m], 0, -cos(theta)*1 [m]});
end Pendulum;
""",
    ),
    "LAG0620": Entry(
        "the simulation failed",
        "It ended before its time, or did not reach the accuracy asked; the message says where and why.  "
        "What was computed until then is printed, written and drawn as asked; the exit code is 3.",
    ),
    "LAG0621": Entry(
        "there is no linear model",
        "No equilibrium was found, the motion does not get to the time asked, or derivatives have no finite "
        "value there; the exit code is 3.",
    ),
}
