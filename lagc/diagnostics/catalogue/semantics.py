"""LAG02xx: names, instances, scenes, effects.  LAG03xx: dimensions, shapes, values."""

from __future__ import annotations

from lagc.diagnostics.catalogue import Entry

_HEAD = "model M\n  coordinate Length x;\n  body b = Particle(mass = 1 [kg], at = {x, 0, 0});\n"


def _body(lines: str) -> str:
    return f"{_HEAD}  {lines}\nend M;\n"


ENTRIES: dict[str, Entry] = {
    "LAG0201": Entry(
        "an unknown name",
        "A name is looked up among loop variables and function arguments, then in the model and what it "
        "extends, then in the file and its imports.  Upper and lower case differ.",
        _body("potential V = 1 [N]*X;"),
        _body("potential V = 1 [N]*x;"),
    ),
    "LAG0202": Entry(
        "a name declared twice",
        "Within a model each name has one meaning, also across the effects that a scene uses together and "
        "across what is inherited.  A declaration in a loop needs a subscript: `point P[i] = ...`.",
        _body("parameter Real k = 1;\n  parameter Real k = 2;"),
        _body("parameter Real k = 1;\n  parameter Real j = 2;"),
    ),
    "LAG0203": Entry(
        "an unknown type or model",
        "The quantity types are listed in the description of the language; others are declared by "
        "`type Name = Real[unit];`.  Models come from the file itself or from an `import`.",
        _body("parameter Lenght l = 1;"),
        _body("parameter Length l = 1;"),
    ),
    "LAG0204": Entry(
        "something that is not a model",
        "Only models can be extended or instantiated.",
        "type T = Real[m];\nmodel M\n  extends T;\n  coordinate Length x;\nend M;\n",
        "partial model T\n  parameter Mass m = 1;\nend T;\nmodel M\n  extends T;\n  coordinate Length x;\n"
        "  body b = Particle(mass = m, at = {x, 0, 0});\nend M;\n",
    ),
    "LAG0205": Entry(
        "a declaration that depends on itself",
        "Values are found one from another in any order, but not in a circle; no model "
        "contains or extends itself.",
        _body("parameter Real k = 2*j;\n  parameter Real j = k/2;"),
        _body("parameter Real k = 2;\n  parameter Real j = k/2;"),
    ),
    "LAG0206": Entry(
        "an unknown part",
        "Frames have the unit vectors x y z, vectors the components x y z, orientations w x y z and rate, "
        "bodies mass, position and (solids) frame, instances what their model declares.",
        _body("potential V = 1 [N]*position(b).w;"),
        _body("potential V = 1 [N]*position(b).x;"),
    ),
    "LAG0207": Entry(
        "a subscript without an element",
        "Elements of arrays are counted from 1; elements such as `point P[0] = ...` have the subscripts they "
        "are declared with.",
        _body("coordinate Length z[2];\n  potential V = 1 [N]*z[3];"),
        _body(
            "coordinate Length z[2];\n  potential V = 1 [N/m]*(z[1]^2 + z[2]^2);\n  body c = "
            "Particle(mass = 1, at = {z[1], z[2], 0});"
        ),
    ),
    "LAG0208": Entry(
        "not a structural integer",
        "Sizes, ranges of loops and subscripts decide which equations there are, so they must be known when "
        "the model is compiled: integers, loop variables, `structural Integer` "
        "parameters and their combinations, of less than 2^53, as larger ones are not held exactly.",
        _body("parameter Real n = 3;\n  coordinate Length z[n];"),
        _body(
            "structural Integer n = 3;\n  coordinate Length z[n];\n  for i in 1:n loop\n    body c[i] = "
            "Particle(mass = 1, at = {0, z[i], 0});\n  end for;"
        ),
    ),
    "LAG0209": Entry(
        "an unknown or superfluous argument",
        "Each kind of declaration, each function and each model has its own arguments; each is given once.",
        _body("coordinate Length y(strat = 1);\n  body c = Particle(mass = 1, at = {0, y, 0});"),
        _body("coordinate Length y(start = 1);\n  body c = Particle(mass = 1, at = {0, y, 0});"),
    ),
    "LAG0210": Entry(
        "a missing argument or value",
        "What has no default must be given.",
        _body("body c = Particle(mass = 1);"),
        _body("body c = Particle(mass = 1, at = {0, x, 0});"),
    ),
    "LAG0211": Entry(
        "a partial model",
        "A `partial` model is a part of others: it can be extended, but neither simulated nor instantiated.",
        "partial model M\n  coordinate Length x;\nend M;\n",
        "partial model L\n  coordinate Length x;\nend L;\nmodel M\n  extends L;\n  body b = "
        "Particle(mass = 1, at = {x, 0, 0});\nend M;\n",
    ),
    "LAG0212": Entry(
        "an unknown effect",
        "Scenes, `requires`, `excludes`, `unless` and the command's `--with` and `--without` name effects "
        "that the model, or an instance within it, declares.",
        _body("scene s uses wind;"),
        _body("effect wind\n    force F = {1 [N], 0, 0} at b;\n  end wind;\n  scene s uses wind;"),
    ),
    "LAG0213": Entry(
        "effects that do not go together",
        "An effect may require others or exclude others; a scene must agree.",
        _body("effect air end air;\n  effect wind requires air; end wind;\n  scene s uses wind;"),
        _body("effect air end air;\n  effect wind requires air; end wind;\n  scene s uses air, wind;"),
    ),
    "LAG0214": Entry(
        "something of an effect that is not used",
        "What an unused effect declares does not exist.  Whoever needs it belongs into the same effect, "
        "or the scene must use the effect.",
        _body("effect air parameter Real k = 1; end air;\n  scene s;\n  potential V = k*1 [N]*x;"),
        _body("effect air\n    parameter Real k = 1;\n    potential V = k*1 [N]*x;\n  end air;\n  scene s;"),
    ),
    "LAG0215": Entry(
        "a model, scene or parameter that is not there",
        "The command, a Python caller or a scene names something that the file does not have.",
        _body("scene s parameter k = 1; end s;"),
        _body("parameter Real k = 2;\n  scene s parameter k = 1; end s;"),
    ),
    "LAG0216": Entry(
        "an import that fails",
        "`import a.b.C;` takes C from the package a.b that is known there, else looks for a.lag, a/b.lag, "
        "a/b/C.lag in the folder of the file and in the folders given; "
        '`import "file.lag";` for that file.  What is imported must be free of faults.',
        "import nowhere.at.all;\nmodel M\n  all a;\n  coordinate Length x;\nend M;\n",
        "",
    ),
    "LAG0217": Entry(
        "an import from outside",
        "No path leads out of the folder of the importing file and of the folders given: a model that is "
        "passed on cannot read other files.",
        'import "../../secret.lag";\nmodel M\n  All a;\n  coordinate Length x;\nend M;\n',
        "",
    ),
    "LAG0218": Entry(
        "a model that is too large",
        "Sizes, loops and depths are bounded, so that no file can hang the compiler.",
        _body("for i in 1:1000000 loop\n    point P[i] = {x, 0, 0};\n  end for;"),
        _body("for i in 1:10 loop\n    point P[i] = {x, 0, 0};\n  end for;"),
    ),
    "LAG0219": Entry(
        "a quantity that is known only once the equations are solved",
        "Accelerations, reactions, energies and powers of the run follow from the motion.  They may be "
        "outputs; given actions and constraints cannot depend on them.",
        _body("force F = -1 [kg]*acceleration(b) at b;"),
        _body("output Acceleration a = acceleration(b).x;"),
    ),
    "LAG0220": Entry(
        "not yet",
        "Part of the language that this version reads but does not build: joints, inequalities, friction.",
        _body("constraint c: x >= 0;"),
        _body("constraint c: x = 0;"),
    ),
    "LAG0221": Entry(
        "the wrong kind of thing",
        "A body is asked for where a number stands, a declaration stands where it does "
        "not belong, and the like.",
        _body("output Force N = reaction(b);"),
        _body("constraint c: x = 0;\n  output Force N = reaction(c);"),
    ),
    "LAG0222": Entry(
        "a model without coordinates",
        "The generalized coordinates are the unknowns of the motion; a model without any has none.",
        "model M\n  parameter Mass m = 1;\nend M;\n",
        "model M\n  parameter Mass m = 1;\n  coordinate Length x;\n  body b = "
        "Particle(mass = m, at = {x, 0, 0});\nend M;\n",
    ),
    "LAG0224": Entry(
        "a start of something that has none",
        "A scene's `start` and the command's `--start` are about a coordinate, `x`, or its rate, `der(x)`.",
        _body("scene s start y = 1; end s;"),
        _body("scene s start x = 1; start der(x) = 2; end s;"),
    ),
    "LAG0225": Entry(
        "a function that calls itself",
        "Functions are written out where they are called, so a function that calls itself would have no end.",
        _body("function f(Real u) = f(u - 1);\n  potential V = 1 [J]*f(3);"),
        _body("function f(Real u) = u - 1;\n  potential V = 1 [N]*x*f(3);"),
    ),
    "LAG0226": Entry(
        "a file of numbers that cannot be read",
        '`table(x, "file.csv", "column")` reads a regular file of UTF-8 text in the folder of the model or '
        "below, of at most 40 MB.",
        _body('force f = {table(time, "nowhere.csv"), 0, 0} at b;'),
        _body("force f = {table(time, {0, 1}, {0, 2} [N]), 0, 0} at b;"),
    ),
    "LAG0227": Entry(
        "what a `when` cannot do",
        "At the moment that its condition becomes true a `when` gives new values to states, "
        '`reinit(x, value)`, ends the run, `terminate("why")`, and names the event, `mark("name")`.  The '
        "condition changes as something passes a value: what is equal to it is so for no time.",
        _body("when x == 1 [m] then terminate(1); end when;"),
        _body('when x > 1 [m] then terminate("far away"); end when;'),
    ),
    "LAG0228": Entry(
        "a new value of what is no state",
        "`reinit` is about a coordinate, its rate, or a declared speed, each of which takes one new value.",
        _body("when x > 1 [m] then reinit(2*x, 0); end when;"),
        _body("when x > 1 [m] then reinit(der(x), -der(x)); end when;"),
    ),
    "LAG0229": Entry(
        "gravity that acts twice on a body",
        "A `Gravity` acts on every body of its model, those of instances too, which may have brought one of "
        "their own.  An effect that one scene leaves out, or a model with the bodies alone, mends it.",
        _body("Gravity here;\n  Gravity there;"),
        _body("Gravity here;"),
    ),
    "LAG0301": Entry(
        "two dimensions where there should be one",
        "The sides of a sum, a comparison or an equality, the branches of an `if` and the components of a "
        "vector have one dimension.  A bare number within an expression has none (0 fits any).",
        _body("potential V = 1 [N]*(x + 2);"),
        _body("potential V = 1 [N]*(x + 2 [m]);"),
    ),
    "LAG0302": Entry(
        "another dimension than was declared",
        "The value of a declaration has the dimension of its type.",
        _body("potential V = 1 [W];"),
        _body("potential V = 1 [N]*x;"),
    ),
    "LAG0303": Entry(
        "a dimension where a number is meant",
        "Sines, exponentials and logarithms are functions of numbers; angles are numbers (1 rad = 1).",
        _body("potential V = 1 [J]*cos(x);"),
        _body("potential V = 1 [J]*cos(x/1 [m]);"),
    ),
    "LAG0304": Entry(
        "an unknown unit",
        "Units are the symbols of the SI with their prefixes and a few others (deg, rpm, "
        "min, h, l, t, bar, eV), "
        "combined by `.` or `*`, `/` and exponents: `kg.m2/s2`, `N.m/rad`, `m^2`.",
        _body("parameter Length l = 1 [meter];"),
        _body("parameter Length l = 1 [m];"),
    ),
    "LAG0305": Entry(
        "a power without a dimension",
        "An exponent is a number without a dimension, and of a quantity with one it is a fixed number.",
        _body("potential V = 1 [J]*2^x;"),
        _body("potential V = 1 [J]*2^(x/1 [m]);"),
    ),
    "LAG0306": Entry(
        "shapes that do not fit",
        "Vectors have three components; sums are between equal shapes; products of "
        "vectors are `dot` and `cross`.",
        _body("potential V = 1 [N/m]*position(b)^2;"),
        _body("potential V = 1 [N/m]*norm(position(b))^2;"),
    ),
    "LAG0307": Entry(
        "a number or a condition is meant",
        "Arithmetic is between numbers and vectors, `if`, `and`, `or` and `not` take conditions.",
        _body("potential V = if x then 1 [J] else 2 [J];"),
        _body("potential V = if x > 0 then 1 [N]*x else -2 [N]*x;"),
    ),
    "LAG0308": Entry(
        "a value out of bounds",
        "A parameter keeps to its `min` and `max`, masses are not negative, principal "
        "moments of inertia obey "
        "the triangle inequality, times are positive.",
        _body("parameter Mass m(min = 0) = -1;"),
        _body("parameter Mass m(min = 0) = 1;"),
    ),
    "LAG0309": Entry(
        "no finite value",
        "A constant expression divides by zero, overflows, or leaves the domain of a function.",
        _body("parameter Real k = sqrt(-1);"),
        _body("parameter Real k = sqrt(2);"),
    ),
    "LAG0311": Entry(
        "something that must not move, or whose motion is not known",
        "Parameters, constants, starts and bounds are made of parameters alone; an input "
        "has no known derivative.",
        _body("parameter Length l = 2*x;"),
        _body("parameter Length l = 2;"),
    ),
    "LAG0313": Entry(
        "a rate where there must be none",
        "Positions, frames and potentials depend on coordinates, parameters and time.  A term of the "
        "Lagrangian that depends on rates is `lagrangian L = ...;`.",
        _body("potential V = 1 [kg]*der(x)^2;"),
        _body("lagrangian L = 1 [kg]*der(x)^2;"),
    ),
    "LAG0314": Entry(
        "data that make no table",
        "What a table is over grows from row to row, in two rows at least, and each has a finite value.  "
        "A file has one line of names, then lines of as many numbers, separated by commas.",
        _body("force f = {table(time, {0, 1, 1}, {0, 2, 3} [N]), 0, 0} at b;"),
        _body("force f = {table(time, {0, 1, 2}, {0, 2, 3} [N]), 0, 0} at b;"),
    ),
}
