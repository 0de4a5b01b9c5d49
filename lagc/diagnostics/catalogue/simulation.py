"""Faults of runs (LAG06xx): requests, initialization, simulation and linearization."""

from __future__ import annotations

from lagc.diagnostics.catalogue import Entry

ENTRIES: dict[str, Entry] = {
    "LAG0601": Entry(
        "a run that uses an unknown parameter or input",
        "`-p NAME=...` uses the name of a parameter or input as declared in the model, with the instance "
        "before it if there is one: `a.bob.m`. `lagc explain FILE` lists the names.",
    ),
    "LAG0602": Entry(
        "a value that is out of bounds or not finite",
        "The bounds are the `min` and `max` of the declaration.",
    ),
    "LAG0603": Entry(
        "a parameter without a value",
        "The declaration, the scene and the run give no value. Add one with `-p NAME=VALUE`.",
    ),
    "LAG0604": Entry(
        "run options that are not valid",
        "Times and tolerances are positive and finite. `--accuracy` chooses the method and the tolerance, "
        "so it excludes `--method`, `--rtol`, `--atol` and `--step`. A fixed step has no tolerance. "
        "`--every` and `--points` exclude each other.",
    ),
    "LAG0605": Entry(
        "a value with the wrong unit",
        "The unit in brackets must have the dimension of the parameter or initial value: `-p 'l=70[cm]'` "
        "for a length. A number without a unit is in SI units.",
    ),
    "LAG0606": Entry(
        "a name that is no state, or no output",
        "`--start NAME=...` sets a coordinate (`theta`), its rate (`der(theta)`) or a declared `speed`. "
        "`--outputs` takes the names of outputs, coordinates and speeds.",
    ),
    "LAG0607": Entry(
        "a parameter that is compiled into the model",
        "Structural parameters, and parameters whose value depends on others, are part of the code. Set "
        "them with `model.compile(parameters=...)`, before `bind`, `simulate` or `rhs`.",
    ),
    "LAG0608": Entry(
        "a guess for an initial value that does not move",
        "`--guess NAME=...` says where to search for a value that is not stated. A value with "
        "`fixed = true`, or with `--start`, is not searched for.",
    ),
    "LAG0610": Entry(
        "an initialization that found no solution",
        "The constraints, their time derivatives, the `initial` section and the fixed values (`fixed`, "
        "`startFixed`, `rateFixed`) have no common solution that is found from the given guesses. The "
        "named equations contradict each other, and any one of them can be removed. If a solution should "
        "exist, give guesses closer to it.",
    ),
    "LAG0611": Entry(
        "an initial value that is not finite",
        "The expression after `start =` or `rate =` divides by zero, or takes the root or the logarithm "
        "of a negative number, for the parameters of this run.",
    ),
    "LAG0612": Entry(
        "a mass matrix that is singular at the initial state",
        "A speed has no inertia: a mass or a moment of inertia is zero, or the initial configuration is "
        "singular for the chosen coordinates, as the longitude at a pole. Add inertia, start in another "
        "configuration, or choose other coordinates.",
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
        "equations that have no finite value at the initial state",
        "An expression divides by zero, or takes the root or the logarithm of a negative number, for the "
        "initial values and parameters of this run. The message shows the expression and the values in it.",
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
        "constraints that contradict each other at the initial state",
        "The initial state satisfies the constraints and their first time derivatives, but no "
        "acceleration satisfies their second derivatives: in this configuration the constraint equations are "
        "dependent and contradictory. Remove one of them, or start in another configuration.",
    ),
    "LAG0615": Entry(
        "a negative kinetic energy",
        "Some velocity has a negative kinetic energy, because of a `kinetic` or `lagrangian` term or an "
        "inertia matrix that no body can have. The system would accelerate against its forces without "
        "limit. Correct that term.",
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
        "an output that is not finite at the initial state",
        "The output divides by zero, or takes the root or the logarithm of a negative number. The motion "
        "is not affected; the first recorded value is `inf` or `nan`.",
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
        "a computed parameter that is out of bounds",
        "A parameter that is computed from others leaves the `min` or `max` of its declaration for the "
        "values of this run, or a mass or a moment of inertia is negative, or a moment of inertia exceeds "
        "the sum of the two others.",
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
        "an angle that looks like degrees",
        "A number without a unit that is given to an angle is in radians.",
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
    "LAG0619": Entry(
        "an angular velocity in hertz",
        "The hertz is 1/s, and an angular velocity of 1/s is 1 rad/s: a frequency needs the factor 2*pi.",
        """
model Mixer
  parameter AngularVelocity w = 50 [Hz];
  coordinate Length x;
  body b = Particle(mass = 1, at = {x, 0, 0});
  force f = sin(w*time)*1 [N]*world.x at b;
end Mixer;
""",
        """
model Mixer
  parameter AngularVelocity w = 2*pi*50 [Hz];
  coordinate Length x;
  body b = Particle(mass = 1, at = {x, 0, 0});
  force f = sin(w*time)*1 [N]*world.x at b;
end Mixer;
""",
    ),
    "LAG0620": Entry(
        "a failed simulation",
        "The run ended early, or did not reach the requested accuracy. The message says where and why. "
        "The results up to that time are printed, written and plotted as requested; the exit code is 3.",
    ),
    "LAG0621": Entry(
        "a linearization that failed",
        "No equilibrium was found, the motion does not reach the requested time, or the derivatives are "
        "not finite there; the exit code is 3.",
    ),
    "LAG0622": Entry(
        "sensitivities of a model with discrete variables",
        "A `when` clause changes a discrete variable at once, and the derivatives of such jumps are not "
        "computed. A motion without discrete variables has sensitivities, also across `when` clauses that "
        "change coordinates and speeds.",
    ),
    "LAG0623": Entry(
        "a question that does not combine with contacts, dry friction or loads of reactions",
        "Derivatives, implicit methods and methods by power series do not follow one-sided constraints and "
        "dry friction yet. Linear models and sensitivities do not follow dry friction of constraints with "
        "`=` and of joints yet; sensitivities do not follow loads of reactions and contacts that slide.",
    ),
    "LAG0625": Entry(
        "an actuator that cannot hold its constraint",
        "A constraint with `by = motor` needs a motor that changes its acceleration. At the initial state it "
        "does not: as a force on a cart does not move the bob of a pendulum that hangs below it. Hold a "
        "quantity that the actuator accelerates, or begin in another configuration.",
    ),
    "LAG0624": Entry(
        "a start beyond the bound of a one-sided constraint",
        "Its gap is negative at the initial state, by the depth in the message. Give initial values with a "
        "gap that is zero or positive.",
    ),
}
