"""Faults of names, instances, scenes and effects (LAG02xx), and of dimensions, shapes and values
(LAG03xx)."""

from __future__ import annotations

from lagc.diagnostics.catalogue import Entry

_HEAD = "model M\n  coordinate Length x;\n  body b = Particle(mass = 1 [kg], at = {x, 0, 0});\n"


def _body(lines: str) -> str:
    return f"{_HEAD}  {lines}\nend M;\n"


def _drawn(lines: str) -> str:
    body = "body b = Solid(mass = 1 [kg], inertia = {1, 1, 1} [kg.m2], com = {0, 0, 1} [m]);"
    return f"model M\n  {body}\n  {lines}\nend M;\n"


ENTRIES: dict[str, Entry] = {
    "LAG0201": Entry(
        "an unknown name",
        "A name is looked up among loop variables and function arguments, then in the model and the "
        "models it extends, then in the file and its imports. Upper and lower case differ.",
        _body("potential V = 1 [N]*X;"),
        _body("potential V = 1 [N]*x;"),
    ),
    "LAG0202": Entry(
        "a name that is declared twice",
        "Each name has one meaning in a model. Inherited names, and those of effects that a scene uses "
        "together, count too. Give a declaration in a loop a subscript: `point P[i] = ...`.",
        _body("parameter Real k = 1;\n  parameter Real k = 2;"),
        _body("parameter Real k = 1;\n  parameter Real j = 2;"),
    ),
    "LAG0203": Entry(
        "an unknown type or model",
        "The language reference lists the quantity types. Declare another one with `type Name = "
        "Real[unit];`. Models come from the same file or from an `import`.",
        _body("parameter Lenght l = 1;"),
        _body("parameter Length l = 1;"),
    ),
    "LAG0204": Entry(
        "a name that is not a model",
        "Only models can be extended or instantiated.",
        "type T = Real[m];\nmodel M\n  extends T;\n  coordinate Length x;\nend M;\n",
        "partial model T\n  parameter Mass m = 1;\nend T;\nmodel M\n  extends T;\n  coordinate Length x;\n"
        "  body b = Particle(mass = m, at = {x, 0, 0});\nend M;\n",
    ),
    "LAG0205": Entry(
        "a declaration that depends on itself",
        "Values can be declared in any order, but not in a circle. No model contains or extends itself.",
        _body("parameter Real k = 2*j;\n  parameter Real j = k/2;"),
        _body("parameter Real k = 2;\n  parameter Real j = k/2;"),
    ),
    "LAG0206": Entry(
        "an unknown member",
        "A frame has the unit vectors `x`, `y`, `z`; a vector has the components `x`, `y`, `z`; an "
        "orientation has `w`, `x`, `y`, `z` and `rate`; a body has `mass`, `position` and, if it is a "
        "solid, `frame`; an instance has what its model declares.",
        _body("potential V = 1 [N]*position(b).w;"),
        _body("potential V = 1 [N]*position(b).x;"),
    ),
    "LAG0207": Entry(
        "a subscript that does not exist",
        "Elements of arrays are counted from 1. Declarations with subscripts, such as `point P[0] = ...`, "
        "have the subscripts that were declared.",
        _body("coordinate Length z[2];\n  potential V = 1 [N]*z[3];"),
        _body(
            "coordinate Length z[2];\n  potential V = 1 [N/m]*(z[1]^2 + z[2]^2);\n  body c = "
            "Particle(mass = 1, at = {z[1], z[2], 0});"
        ),
    ),
    "LAG0208": Entry(
        "a value that is not a structural integer",
        "Sizes, loop ranges and subscripts determine which equations exist, so they must be known when "
        "the model is compiled. They are made of integers, loop variables and `structural Integer` "
        "parameters, below 2^53.",
        _body("parameter Real n = 3;\n  coordinate Length z[n];"),
        _body(
            "structural Integer n = 3;\n  coordinate Length z[n];\n  for i in 1:n loop\n    body c[i] = "
            "Particle(mass = 1, at = {0, z[i], 0});\n  end for;"
        ),
    ),
    "LAG0209": Entry(
        "an unknown or repeated argument",
        "Each kind of declaration, each function and each model has its own arguments. Give each argument "
        "once.",
        _body("coordinate Length y(strat = 1);\n  body c = Particle(mass = 1, at = {0, y, 0});"),
        _body("coordinate Length y(start = 1);\n  body c = Particle(mass = 1, at = {0, y, 0});"),
    ),
    "LAG0210": Entry(
        "a missing argument or value",
        "An argument or a quantity without a default needs a value. A model with a placeholder, `body b;`, "
        "is used in another model that gives it: `Drag air(b = bob)`.",
        _body("body c = Particle(mass = 1);"),
        _body("body c = Particle(mass = 1, at = {0, x, 0});"),
    ),
    "LAG0211": Entry(
        "a partial model that is used as a whole",
        "A `partial` model can only be extended. It cannot be simulated or instantiated.",
        "partial model M\n  coordinate Length x;\nend M;\n",
        "partial model L\n  coordinate Length x;\nend L;\nmodel M\n  extends L;\n  body b = "
        "Particle(mass = 1, at = {x, 0, 0});\nend M;\n",
    ),
    "LAG0212": Entry(
        "an unknown effect",
        "Scenes, `requires`, `excludes`, `unless` and the options `--with` and `--without` use names of "
        "effects. The model, or an instance in it, must declare the effect.",
        _body("scene s uses wind;"),
        _body("effect wind\n    force F = {1 [N], 0, 0} at b;\n  end wind;\n  scene s uses wind;"),
    ),
    "LAG0213": Entry(
        "effects that cannot be combined",
        "An effect can require or exclude other effects. Change the `uses` list of the scene to agree "
        "with it.",
        _body("effect air end air;\n  effect wind requires air; end wind;\n  scene s uses wind;"),
        _body("effect air end air;\n  effect wind requires air; end wind;\n  scene s uses air, wind;"),
    ),
    "LAG0214": Entry(
        "a declaration of an effect that is not used",
        "The declarations of an unused effect do not exist. Move the declaration that needs it into the same "
        "effect, or use the effect in the scene.",
        _body(
            "effect air\n    parameter Real k = 1;\n  end air;\n  scene s;\n  scene t uses air;\n"
            "  potential V = k*1 [N]*x;"
        ),
        _body(
            "effect air\n    parameter Real k = 1;\n    potential V = k*1 [N]*x;\n  end air;\n"
            "  scene s uses air;"
        ),
    ),
    "LAG0215": Entry(
        "a model, scene or parameter that does not exist",
        "The command, a Python caller or a scene uses a name that the file does not declare.",
        _body("scene s parameter k = 1; end s;"),
        _body("parameter Real k = 2;\n  scene s parameter k = 1; end s;"),
    ),
    "LAG0216": Entry(
        "an import that fails",
        "`import a.b.C;` takes C from a known package a.b. Otherwise it looks for a.lag, a/b.lag and "
        'a/b/C.lag in the folder of the file and in the given folders. `import "file.lag";` reads that '
        "file. The imported file must have no errors.",
        "import nowhere.at.all;\nmodel M\n  all a;\n  coordinate Length x;\nend M;\n",
        "",
    ),
    "LAG0217": Entry(
        "an import from outside the allowed folders",
        "Imports stay in the folder of the importing file, its subfolders and the given folders, so that "
        "a model from somebody else cannot read your other files.",
        'import "../../secret.lag";\nmodel M\n  All a;\n  coordinate Length x;\nend M;\n',
        "",
    ),
    "LAG0218": Entry(
        "a model that is too large",
        "Sizes, loops and nesting have upper bounds, so that no file can block the compiler.",
        _body("for i in 1:1000000 loop\n    point P[i] = {x, 0, 0};\n  end for;"),
        _body("for i in 1:10 loop\n    point P[i] = {x, 0, 0};\n  end for;"),
    ),
    "LAG0219": Entry(
        "a quantity that is only known after the equations are solved",
        "Accelerations, reactions, energies and powers of the run are results of the motion. Use them in "
        "outputs and in the conditions of `when`. A force or torque may depend on `reaction(c)` of a "
        "constraint with `=`. Constraints and new "
        "values cannot depend on them.",
        _body("force F = -1 [kg]*acceleration(b) at b;"),
        _body("output Acceleration a = acceleration(b).x;"),
    ),
    "LAG0220": Entry(
        "a function that is not yet supported",
        "The message says what to write until then.",
        _body("output Length y = pre(x);"),
        _body("output Length y = x;"),
    ),
    "LAG0221": Entry(
        "the wrong kind of object",
        "For example, a body stands where a number is needed, or a declaration stands in a block where it "
        "does not belong.",
        _body("output Force N = reaction(x);"),
        _body("constraint c: x = 0;\n  output Force N = reaction(c);"),
    ),
    "LAG0222": Entry(
        "a model without coordinates",
        "The generalized coordinates are the unknowns of the motion. A model needs at least one: "
        "`coordinate Length x;`.",
        "model M\n  parameter Mass m = 1;\nend M;\n",
        "model M\n  parameter Mass m = 1;\n  coordinate Length x;\n  body b = "
        "Particle(mass = m, at = {x, 0, 0});\nend M;\n",
    ),
    "LAG0224": Entry(
        "an initial value for something that has none",
        "`start` in a scene and the option `--start` set a coordinate, `x`, or its rate, `der(x)`.",
        _body("scene s start y = 1; end s;"),
        _body("scene s start x = 1; start der(x) = 2; end s;"),
    ),
    "LAG0225": Entry(
        "a function that calls itself",
        "Functions are inlined where they are called, so a function cannot call itself.",
        _body("function f(Real u) = f(u - 1);\n  potential V = 1 [J]*f(3);"),
        _body("function f(Real u) = u - 1;\n  potential V = 1 [N]*x*f(3);"),
    ),
    "LAG0226": Entry(
        "a data file that cannot be read",
        '`table(x, "file.csv", "column")` reads a regular UTF-8 file of at most 40 MB in the folder of '
        "the model or a subfolder.",
        _body('force f = {table(time, "nowhere.csv"), 0, 0} at b;'),
        _body("force f = {table(time, {0, 1}, {0, 2} [N]), 0, 0} at b;"),
    ),
    "LAG0227": Entry(
        "an action that `when` does not support",
        "When its condition becomes true, a `when` clause sets states with `reinit(x, value)`, ends the "
        'run with `terminate("why")`, or names the event with `mark("name")`. The condition compares with '
        "`<` or `>`: a continuous motion is equal to a value only for an instant.",
        _body("when x == 1 [m] then terminate(1); end when;"),
        _body('when x > 1 [m] then terminate("far away"); end when;'),
    ),
    "LAG0228": Entry(
        "a new value for something that is not a state",
        "`reinit` sets a coordinate, its rate, a declared speed or a discrete variable. Each of them gets "
        "one new value.",
        _body("when x > 1 [m] then reinit(2*x, 0); end when;"),
        _body("when x > 1 [m] then reinit(der(x), -der(x)); end when;"),
    ),
    "LAG0229": Entry(
        "gravity that acts twice on a body",
        "A `Gravity` acts on every body of its model, including the bodies of instances, whose model may "
        "declare gravity too. Declare it once, or put it into an effect that the scene can leave out.",
        _body("Gravity here;\n  Gravity there;"),
        _body("Gravity here;"),
    ),
    "LAG0230": Entry(
        "an effect that no scene uses",
        "The declarations of an effect count only in a scene that uses it: `scene lab uses gravity;`. A "
        "model without scenes runs without its effects. `--with gravity` adds an effect to one run.",
        _body("effect gravity\n    Gravity field;\n  end gravity;\n  scene lab;"),
        _body("effect gravity\n    Gravity field;\n  end gravity;\n  scene lab uses gravity;"),
    ),
    "LAG0231": Entry(
        "an annotation",
        "An annotation is read, since Modelica has it, but it changes nothing. The settings of "
        "`experiment` stand in a scene: `simulate(stop = 10 [s]);`.",
        _body("annotation(experiment(StopTime = 10));"),
        _body("scene lab simulate(stop = 10 [s]); end lab;"),
    ),
    "LAG0232": Entry(
        "a constraint with a discrete variable",
        "A discrete variable jumps. A constraint, an initial equation or the definition of a speed that "
        "depends on it would be violated at the jump. Use discrete variables in forces, laws, potentials and "
        "conditions.",
        _body("discrete Length far(start = 1 [m]);\n  constraint c: der(x) = far/(1 [s]);"),
        _body("discrete Length far(start = 1 [m]);\n  potential spring = (1 [N/m])*(x - far)^2;"),
    ),
    "LAG0233": Entry(
        "a joint that cannot be used this way",
        "A joint ties two bodies, or a body to `world`. Joints that lead to `world` place all of them. A "
        "joint between bodies that others place closes a loop: it has equations instead of coordinates.",
        _drawn("joint j = Revolute(b, b, axis = world.y, at = {0, 0, 0});"),
        _drawn("joint j = Revolute(world, b, axis = world.y, at = {0, 0, 0});"),
    ),
    "LAG0234": Entry(
        "a joint of something that moves by itself",
        "Joints place bodies that are drawn in one configuration, with numbers and parameters. The "
        "coordinates of the joints move the bodies. Do not give a body of a joint coordinates of its own.",
        _drawn(
            "coordinate Angle a;\n  joint j = Revolute(world, b, axis = world.y, at = {a*(1 [m]), 0, 0});"
        ),
        _drawn("joint j = Revolute(world, b, axis = world.y, at = {0, 0, 0});"),
    ),
    "LAG0235": Entry(
        "a one-sided constraint that bounds no position, or friction that is not given in full",
        "`constraint c: a >= b (restitution = e);` bounds an expression of coordinates, parameters and "
        "time. The restitution is from 0 to 1. Friction has a coefficient from 0, and a `slip` or a place "
        "`at`; that of a `Revolute` joint a `radius`.",
        _body("constraint c: 1 [m] <= 0;"),
        _body("constraint c: x <= 0;"),
    ),
    "LAG0301": Entry(
        "different dimensions where one is needed",
        "The two sides of a sum, a comparison or an equation, the branches of an `if`, and the components "
        "of a vector have the same dimension. A number without a unit inside an expression is "
        "dimensionless; 0 fits any dimension.",
        _body("potential V = 1 [N]*(x + 2);"),
        _body("potential V = 1 [N]*(x + 2 [m]);"),
    ),
    "LAG0302": Entry(
        "a dimension that differs from the declared one",
        "The value of a declaration has the dimension of its type.",
        _body("potential V = 1 [W];"),
        _body("potential V = 1 [N]*x;"),
    ),
    "LAG0303": Entry(
        "a dimension where a pure number is needed",
        "Trigonometric functions, exponentials and logarithms take pure numbers. Angles are pure numbers "
        "(1 rad = 1).",
        _body("potential V = 1 [J]*cos(x);"),
        _body("potential V = 1 [J]*cos(x/1 [m]);"),
    ),
    "LAG0304": Entry(
        "an unknown unit",
        "Units are the SI symbols with prefixes, and deg, rpm, min, h, l, t, bar, eV and some others. "
        "Combine them with `.` or `*`, `/` and exponents: `kg.m2/s2`, `N.m/rad`, `m^2`.",
        _body("parameter Length l = 1 [meter];"),
        _body("parameter Length l = 1 [m];"),
    ),
    "LAG0305": Entry(
        "an exponent that gives no dimension",
        "An exponent is a pure number. For a base with a dimension it is a fixed number.",
        _body("potential V = 1 [J]*2^x;"),
        _body("potential V = 1 [J]*2^(x/1 [m]);"),
    ),
    "LAG0306": Entry(
        "shapes that do not match",
        "Vectors have three components. Sums need two values of the same shape. Products of vectors are "
        "`dot(a, b)` and `cross(a, b)`.",
        _body("potential V = 1 [N/m]*position(b)^2;"),
        _body("potential V = 1 [N/m]*norm(position(b))^2;"),
    ),
    "LAG0307": Entry(
        "a value of the wrong kind",
        "Arithmetic takes numbers and vectors; `if`, `and`, `or` and `not` take conditions.",
        _body("potential V = if x then 1 [J] else 2 [J];"),
        _body("potential V = if x > 0 then 1 [N]*x else -2 [N]*x;"),
    ),
    "LAG0308": Entry(
        "a value that is out of bounds",
        "A parameter stays within its `min` and `max`, masses are not negative, principal moments of "
        "inertia satisfy the triangle inequality, and times are positive.",
        _body("parameter Mass m(min = 0) = -1;"),
        _body("parameter Mass m(min = 0) = 1;"),
    ),
    "LAG0309": Entry(
        "a value that is not finite",
        "A constant expression divides by zero, overflows, or leaves the domain of a function.",
        _body("parameter Real k = sqrt(-1);"),
        _body("parameter Real k = sqrt(2);"),
    ),
    "LAG0311": Entry(
        "a value that must not depend on the motion, or an unknown derivative",
        "Parameters, constants, initial values and bounds depend only on parameters. The time derivative "
        "of an input is unknown.",
        _body("parameter Length l = 2*x;"),
        _body("parameter Length l = 2;"),
    ),
    "LAG0313": Entry(
        "a rate where none is allowed",
        "Positions, frames and potentials depend on coordinates, parameters and time. Write a term of the "
        "Lagrangian that depends on rates as `lagrangian L = ...;`.",
        _body("potential V = 1 [kg]*der(x)^2;"),
        _body("lagrangian L = 1 [kg]*der(x)^2;"),
    ),
    "LAG0314": Entry(
        "data that do not form a table",
        "A table has at least two rows, its argument increases from row to row, and every value is "
        "finite. A data file has one line of names, then lines with as many numbers, separated by commas.",
        _body("force f = {table(time, {0, 1, 1}, {0, 2, 3} [N]), 0, 0} at b;"),
        _body("force f = {table(time, {0, 1, 2}, {0, 2, 3} [N]), 0, 0} at b;"),
    ),
}
