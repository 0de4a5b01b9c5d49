"""Words of other languages, and what to write instead: one table for each place in a text.

An entry with a backquote is a sentence, an empty one means that the word is left out, any other is the text
to write.  In `CALLS`, `{0}` and `{1}` are the arguments of the call, `{all}` is the list of them.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

LEAVE_OUT = ""

# -- characters and operators ------------------------------------------------------------------

SIGNS = {  # characters that are typed or pasted instead of a sign of the language
    "−": "-", "–": "-", "—": "-", "·": "*", "×": "*", "⋅": "*", "∙": "*", "÷": "/",
    "∕": "/", "≤": "<=", "≥": ">=", "≠": "<>", "；": ";", "，": ",", "：": ":",
}  # fmt: skip
CHARACTERS = {
    "°": "write the unit in brackets: `30 [deg]`",
    **dict.fromkeys("“”„", '`"` is straight: write texts as "..."'),
    **dict.fromkeys("'`", 'write texts between double quotes, `"..."`'),
    "#": "comments begin with `//`", "?": "write `if condition then value else other`", "√": "sqrt(...)",
    "½": "1/2", "∞": "`min` and `max` without a bound are left out",
    "∫": "write the integrand as the rate of a coordinate without mass: `constraint c: der(I) = ...;`",
    "∂": "write the derivative in time as `der(x)`", "\ufeff": LEAVE_OUT, "$": LEAVE_OUT, "~": "not",
    "@": "for the product of two vectors write `dot(a, b)`",
}  # fmt: skip
_GREEK_NAMES = """
    alpha beta gamma delta epsilon zeta eta theta theta iota kappa lambda mu mu nu xi omicron pi rho
    sigma sigma tau upsilon phi phi chi psi omega Gamma Delta Theta Lambda Xi Pi Sigma Phi Psi Omega
"""
GREEK = dict(zip("αβγδεζηθϑικλμµνξοπρσςτυφϕχψωΓΔΘΛΞΠΣΦΨΩ", _GREEK_NAMES.split()))
LATEX = {  # `\name` -> the text to write; {0} and {1} are what follows in braces
    "frac": "({0})/({1})", "dfrac": "({0})/({1})", "tfrac": "({0})/({1})", "sqrt": "sqrt({0})",
    "dot": "der({0})", "ddot": "der(der({0}))", "cdot": "*", "times": "*", "left": "", "right": "",
    "vec": "{0}", "mathbf": "{0}", "mathrm": "{0}", "text": "{0}", "bar": "{0}", "hat": "normalize({0})",
    "ln": "log", "arcsin": "asin", "arccos": "acos", "arctan": "atan", "le": "<=", "leq": "<=", "ge": ">=",
    "geq": ">=", "ne": "<>", "neq": "<>", "varphi": "phi", "vartheta": "theta", "varepsilon": "epsilon",
}  # fmt: skip

OPERATORS = {  # signs of other languages; the empty ones depend on the place
    "**": "^", "!=": "<>", "~=": "<>", "&&": "and", "||": "or", "&": "and", "|": "or", "!": "not",
    ":=": "=", ".*": "*", "./": "/", ".^": "^", "..": ":", "...": LEAVE_OUT, "%": "",
    "+=": "", "-=": "", "*=": "", "/=": "", "=>": "=", "->": "=",
}  # fmt: skip

# -- the first word of a declaration -----------------------------------------------------------

_COMPUTED = "for a computed quantity write `output Type name = value;`"
_RUN = "`lagc sim` runs the model: write `scene lab simulate(stop = 10); end lab;`"
KEYWORDS: dict[str, str] = {
    **dict.fromkeys(("var", "let", "variable", "state", "dof", "unknown", "coordinates", "gencoord"),
        "coordinate"),
    "const": "constant", **dict.fromkeys(("param", "parameters", "params"), "parameter"),
    **dict.fromkeys(("class", "block", "record", "struct", "module", "system", "object"), "model"),
    **dict.fromkeys(("def", "fn", "func", "lambda"), "write `function name(Type x) = expression;`"),
    **dict.fromkeys(("equation", "equations", "algorithm"),
        "there is no equation section: lagc derives the equations of motion; write an equation that always "
        "holds as `constraint name: left = right;`"),
    **dict.fromkeys(("final", "public", "protected", "private", "static", "inner", "outer", "replaceable",
        "encapsulated", "redeclare", "flow", "global", "stream"), LEAVE_OUT),
    "from": "write `import package.name;`", **dict.fromkeys(("include", "using", "#include"), "import"),
    **dict.fromkeys(("print", "return", "printf", "disp", "observe", "measure"), _COMPUTED),
    **dict.fromkeys(("plot", "simulate_model", "run", "solve"), _RUN),
    "connect": "connect bodies by constraints: `constraint c: position(a) = position(b);`",
    "while": "write a loop as `for i in 1:n loop ... end for;`",
    "if": "use `if` in an expression: `x = if condition then value else other;`",
    "assert": "give bounds where a quantity is declared: `parameter Mass m(min = 0);`",
    "spring": "write a spring as a potential: `potential V = 1/2*k*x^2;`",
    "damper": "write a damper as a dissipation: `dissipation D = 1/2*c*der(x)^2;`",
    **dict.fromkeys(("friction", "contact"), "friction belongs to a constraint, `(friction = 0.3, at = b)` "
        "in `constraint floor: b.z >= 0 [m] (friction = 0.3, at = b);`"),
    "moment": "torque", "particle": "body",
    "gravity": "write `Gravity field;`", "event": "write `when condition then ... end when;`",
}  # fmt: skip
RUNS = frozenset({"ode45", "ode15s", "ode23", "odeint", "solve_ivp", "dsolve", "NDSolve", "lsode"})

_STOP = 'terminate("why")'
ACTIONS: dict[str, str] = {  # of a `when` clause
    **dict.fromkeys(("print", "printf", "display", "log", "event"), 'mark("name")'),
    **dict.fromkeys(("stop", "halt", "quit", "exit", "error", "assert", "abort"), _STOP),
    **dict.fromkeys(("set", "assign", "reset"), "reinit(x, value)"),
}

# -- names that are called, and names that are not ---------------------------------------------

_CHOICE, _STEP = "if {0} then {1} else {2}", "if {0} > 0 then 1 else 0"
_MOMENT = "leave it out: a `when` clause acts at the moment when its condition becomes true"
_NOISE = "a run has no random numbers: declare `input Real noise;` and give it values over time"
CALLS: dict[str, str] = {
    **dict.fromkeys(("ln", "Log"), "log({0})"), **dict.fromkeys(("lg", "Log10"), "log10({0})"),
    "log2": "log({0})/log(2)", **dict.fromkeys(("pow", "power_of", "Pow"), "({0})^({1})"),
    **dict.fromkeys(("sqr", "square"), "({0})^2"), "cbrt": "({0})^(1/3)",
    **{f"{arc}{f}": f"a{f}({{0}})" for f in ("sin", "cos", "tan") for arc in ("arc", "ar")},
    **{f"{f}d": f"{f}(({{0}})*1 [deg])" for f in ("sin", "cos", "tan")},
    **{f"a{f}d": f"write `a{f}(x)`, in rad: `a{f}(x)/(1 [deg])` is the number of degrees"
       for f in ("sin", "cos", "tan")},
    "atan2d": "write `atan2(y, x)`, in rad: `atan2(y, x)/(1 [deg])` is the number of degrees",
    **dict.fromkeys(("arctan2", "Atan2", "ArcTan2"), "atan2({0}, {1})"),
    "tg": "tan({0})", **dict.fromkeys(("ctg", "cot"), "1/tan({0})"), "sec": "1/cos({0})",
    "csc": "1/sin({0})", "sh": "sinh({0})", "ch": "cosh({0})", "th": "tanh({0})",
    **dict.fromkeys(("deg2rad", "radians"), "({0})*1 [deg]"),
    **dict.fromkeys(("rad2deg", "degrees"), "({0})/(1 [deg])"),
    **dict.fromkeys(("fabs", "Abs"), "abs({0})"), **dict.fromkeys(("sgn", "signum"), "sign({0})"),
    **dict.fromkeys(("mag", "magnitude", "vecnorm"), "norm({0})"),
    "hypot": "sqrt(({0})^2 + ({1})^2)", **dict.fromkeys(("len", "numel"), "size({0})"),
    "length": "write `norm(v)` for the length of a vector, `size(x)` for the number of elements of an array",
    "inner": "dot({0}, {1})", **dict.fromkeys(("unit", "unit_vector", "unitvector"), "normalize({0})"),
    **dict.fromkeys(("vector", "vec", "array", "Matrix", "vector3"), "{{{all}}}"),
    **dict.fromkeys(("diff", "ddt", "dot_", "deriv", "derivative", "Derivative", "dt", "D", "d", "Dt"),
        "der({0})"),
    **dict.fromkeys(("ceiling", "Ceiling"), "ceil({0})"), "round": "floor({0} + 1/2)",
    **dict.fromkeys(("fmod", "rem", "modulo"), "mod({0}, {1})"),
    **dict.fromkeys(("fix", "trunc", "int"), "if {0} > 0 then floor({0}) else ceil({0})"),
    **dict.fromkeys(("heaviside", "Heaviside", "step", "unitstep"), _STEP),
    **dict.fromkeys(("piecewise", "where", "ifelse", "iif", "ite", "cond", "select", "IF"), _CHOICE),
    **dict.fromkeys(("clip", "clamp", "saturate", "limit"), "min(max({0}, {1}), {2})"),
    "smooth": "{1}", **dict.fromkeys(("noEvent", "homotopy"), "{0}"),
    **dict.fromkeys(("random", "rand", "randn", "uniform", "normal", "noise"), _NOISE),
    **dict.fromkeys(("tension", "Tension"), "write `reaction(c)`, the force of a constraint `c`"),
    **dict.fromkeys(("Force", "Torque"), "{0}"),
    **dict.fromkeys(("distance", "dist"), "norm(position({0}) - position({1}))"),
    **dict.fromkeys(("vel", "Velocity"), "velocity({0})"), "speed": "norm(velocity({0}))",
    **dict.fromkeys(("pos", "Position"), "position({0})"), "acc": "acceleration({0})",
    **dict.fromkeys(("kinetic_energy", "kineticEnergy"), "kinetic({0})"),
    **dict.fromkeys(("potential_energy", "potentialEnergy"), "potential({0})"),
    **dict.fromkeys(("total_energy", "totalEnergy"), "energy({all})"),
    **{f"rot{axis}": f"rotate_{axis}(world, {{0}})" for axis in "xyz"},
    **dict.fromkeys(("integrate", "integral", "Integrate"), "declare `coordinate Real I;` and "
        "`constraint c: der(I) = ...;` with the integrand"),
    **dict.fromkeys(("interp1", "interp", "lookup", "spline"), "write `table(x, {{x1, y1}, {x2, y2}})`"),
    "pre": "leave it out: the names in `reinit(x, value)` already mean the values before the event",
    "edge": _MOMENT, "change": _MOMENT,
    "initial": "write what holds at the initial time after `initial`, in the model",
    "terminal": "write `terminate(...)` in a `when` clause, or `simulate(stop = ...)` in a scene",
    "sample": "for what happens each period T, declare `discrete Time next(start = T);` and write "
              "`when time >= next then ... reinit(next, next + T); end when;`; for values at given times "
              "write `table(time, ..., interpolation = \"held\")`",
}  # fmt: skip
SURPLUS = {  # calls of functions of the language with more arguments than they take
    "der": "der({0})", "atan": "atan2({0}, {1})", "norm": "norm({{{all}}})",
    "normalize": "normalize({{{all}}})", "log": "log({0})/log({1})", "abs": "norm({{{all}}})",
}  # fmt: skip
NAMES: dict[str, str] = {
    **dict.fromkeys(("Pi", "PI"), "pi"), **dict.fromkeys(("t", "Time", "TIME"), "time"),
    **dict.fromkeys(("True", "TRUE"), "true"), **dict.fromkeys(("False", "FALSE"), "false"),
    **dict.fromkeys(("inf", "Inf", "Infinity", "infinity", "oo"), "leave out the bound: without `min` and "
        "`max` there is none"),
    **dict.fromkeys(("ground", "Ground", "World", "inertial"), "world"),
    **dict.fromkeys(("origin", "Origin"), "{0, 0, 0}"),
    **{f"{e}{axis}": f"world.{axis}" for e in ("e", "e_", "u", "u_", "n_") for axis in "xyz"},
    "down": "-world.z", "up": "world.z", "KE": "kinetic()", "PE": "potential()",
    **dict.fromkeys(("None", "null", "NULL", "NaN", "nan"), LEAVE_OUT),
    **{f"{axis}_hat": f"world.{axis}" for axis in "xyz"},
    **dict(zip(("i_hat", "j_hat", "k_hat"), ("world.x", "world.y", "world.z"))),
    **dict.fromkeys(("rad", "radian"), "1 [rad]"), **dict.fromkeys(("deg", "degree", "degrees"), "1 [deg]"),
}  # fmt: skip

# -- types and models --------------------------------------------------------------------------

TYPES: dict[str, str] = {
    **dict.fromkeys(("float", "double", "Float", "Double", "real", "Number", "number", "Scalar"), "Real"),
    **dict.fromkeys(("int", "Int", "integer"), "Integer"),
    **{name.lower(): name for name in ("Mass", "Length", "Angle", "Velocity", "Acceleration", "Inertia",
        "Energy", "Power", "Stiffness", "Damping", "Frequency", "Density", "Pressure")},
    **dict.fromkeys(("Speed", "LinearVelocity"), "Velocity"),
    **dict.fromkeys(("Position", "Distance", "Displacement", "Radius", "Height", "Diameter", "Thickness"),
        "Length"),
    **dict.fromkeys(("Weight", "Tension"), "Force"),
    **dict.fromkeys(("MomentOfInertia", "InertiaMoment"), "Inertia"),
    **dict.fromkeys(("Moment", "Couple"), "Torque"),
    **dict.fromkeys(("Work", "Heat"), "Energy"),
    "TranslationalSpringConstant": "Stiffness", "RotationalSpringConstant": "RotationalStiffness",
    "TranslationalDampingConstant": "Damping", "RotationalDampingConstant": "RotationalDamping",
    "AngularFrequency": "AngularVelocity", "ElectricCharge": "Charge", "ElectricCurrent": "Current",
    "ElectricPotential": "Voltage",
    **dict.fromkeys(("Boolean", "bool", "Bool", "boolean"),
        "declare an `effect` for a choice, `discrete Boolean on(start = true);` for a state that `when` "
        "clauses change, or write `if condition then 1 else 0` for a number"),
    **dict.fromkeys(("String", "string", "str"),
        "there are no text variables; write a text as the description of a declaration: `model M \"text\"`"),
    **dict.fromkeys(("Vector", "vector", "Vector3"), "write a vector as an array: `parameter Length r[3];`"),
    "Rotation": "write `Angle`, or `Orientation` for a rotation in space",
    "Quaternion": "Orientation",
}  # fmt: skip
_JOINTS = {
    **dict.fromkeys(("Revolute", "Hinge", "Joint"), "Revolute(a, b, axis = world.y, at = P)"),
    **dict.fromkeys(("Prismatic", "Slider"), "Prismatic(a, b, axis = world.x)"),
    "Cylindrical": "Cylindrical(a, b, axis = world.x, at = P)",
    "Universal": "Universal(a, b, axis = world.x, at = P, along = world.y)",
    "Spherical": "Spherical(a, b, at = P)",
    "FreeMotion": "Free(world, b)",
}
_PARTICLE = "write `body b = Particle(mass = m, at = {x, y, z});`, or `Solid(...)` for a body that turns"
_SPRING = "write a spring as a potential: `potential V = 1/2*k*(norm(position(b)) - l)^2;`"
_DAMPER = "write a damper as a dissipation: `dissipation D = 1/2*c*der(x)^2;`"
MODELS = {  # models of libraries of mechanics
    **{name: f"write `joint j = {call};` with two bodies" for name, call in _JOINTS.items()},
    **dict.fromkeys(("Body", "BodyShape", "BodyBox", "BodyCylinder", "PointMass", "RigidBody", "SlidingMass"),
        _PARTICLE),
    **dict.fromkeys(("Fixed", "FixedTranslation"), "point P = {0, 0, 1} [m];"),
    "FixedRotation": "frame F = rotate_z(world, 30 [deg]);",
    "World": "`world` is built in; for gravity write `Gravity field;`",
    "Spring": _SPRING, "Damper": _DAMPER,
    **dict.fromkeys(("SpringDamper", "SpringDamperParallel"), f"{_SPRING}; {_DAMPER}"),
    "WorldForce": "force f = {1 [N], 0, 0} at b;",
    "WorldTorque": "torque M = {0, 0, 1 [N.m]} on b;",
}  # fmt: skip
AS_JOINT = (
    "write `joint name = Kind(a, b, ...);`, for example `joint j = Revolute(a, b, axis = world.y, at = P);`"
)

LIBRARIES = ("Modelica", "ModelicaServices", "math", "numpy", "scipy", "sympy", "matplotlib")
NO_LIBRARY = (
    "delete it, since types, functions and `pi` are built in: write `Mass` for `SI.Mass`, `sin` for `np.sin`"
)

# -- names of arguments and attributes ---------------------------------------------------------

ARGUMENTS: dict[str, tuple[str, ...]] = {  # -> those that may be meant; none: it is left out
    "m": ("mass",), **dict.fromkeys(("pos", "position", "r", "r_0", "r_CM", "center", "cm"), ("at", "com")),
    **dict.fromkeys(("I", "J", "moments"), ("inertia",)),
    **dict.fromkeys(("StopTime", "stopTime", "stop_time", "t_end", "tstop", "duration", "end"), ("stop",)),
    **dict.fromkeys(("Tolerance", "tolerance", "tol"), ("accuracy",)),
    **dict.fromkeys(("Interval", "dt"), ("every", "step")), "NumberOfIntervals": ("points",),
    **dict.fromkeys(("initial", "init", "value", "ic"), ("start",)),
    **dict.fromkeys(("v", "velocity", "speed", "der"), ("rate",)),
    **dict.fromkeys(("n", "axis", "dir"), ("direction",)),
    **dict.fromkeys(("quantity", "nominal", "stateSelect", "final"), ()),
}  # fmt: skip

# -- units -------------------------------------------------------------------------------------

UNIT_WORDS: dict[str, str] = {
    **dict.fromkeys(("gram", "gramme", "gm"), "g"), **dict.fromkeys(("kilo", "kilogramme"), "kg"),
    **dict.fromkeys(("meter", "metre"), "m"), **dict.fromkeys(("second", "sec"), "s"),
    "minute": "min", **dict.fromkeys(("hour", "hr"), "h"), "tonne": "t",
    "radian": "rad",
    **dict.fromkeys(("degree", "°", "º"), "deg"), **dict.fromkeys(("revolution", "turn"), "rev"),
    "newton": "N", "joule": "J", "watt": "W", "pascal": "Pa", "hertz": "Hz", "kelvin": "K", "volt": "V",
    **dict.fromkeys(("ampere", "amp"), "A"), **dict.fromkeys(("ohm", "Ω"), "Ohm"), "coulomb": "C",
    "farad": "F", "henry": "H", "tesla": "T", "weber": "Wb", "mole": "mol", "candela": "cd",
    **dict.fromkeys(("liter", "litre"), "L"), **dict.fromkeys(("foot", "feet"), "ft"), "in": "inch",
    **dict.fromkeys(("pound", "lbm"), "lb"), "percent": "%", **dict.fromkeys(("kmh", "kph"), "km/h"),
    "rps": "rev/s", "micron": "um", "AU": "au",
}  # fmt: skip
UNIT_VALUES = {
    **dict.fromkeys(("kgf", "kp"), "9.80665 [N]"), "lbf": "4.448222 [N]", "mph": "0.44704 [m/s]",
    **dict.fromkeys(("kn", "kt", "knot", "knots"), "0.5144444 [m/s]"), "hp": "745.6999 [W]",
    "PS": "735.49875 [W]", "psi": "6894.757 [Pa]", "atm": "101325 [Pa]", "cal": "4.184 [J]",
    "kcal": "4184 [J]", "Wh": "3600 [J]", "kWh": "3.6e6 [J]", "mile": "1609.344 [m]", "yd": "0.9144 [m]",
    "oz": "0.02834952 [kg]", "week": "7 [d]", "year": "365.25 [d]", "grad": "0.9 [deg]", "turns": "1 [rev]",
    **dict.fromkeys(("°C", "degC", "deg C", "° C", "Celsius", "celsius"),
        "write kelvins: 20 °C are `293.15 [K]`, and a difference of 1 °C is `1 [K]`"),
    **dict.fromkeys(("ton", "tons"),
        "write `[t]` for 1000 kg; a US ton is `907.18474 [kg]`, a British one `1016.0469 [kg]`"),
}  # fmt: skip
UNIT_PREFIXES = {"kilo": "k", "milli": "m", "centi": "c", "micro": "u", "mega": "M", "giga": "G", "nano": "n"}
_UNITS = frozenset({
    "kg", "g", "mg", "t", "m", "mm", "cm", "km", "um", "s", "ms", "us", "min", "h", "d", "rad", "mrad",
    "deg", "rev", "N", "kN", "mN", "J", "kJ", "W", "kW", "Pa", "kPa", "MPa", "GPa", "bar", "Hz", "kHz",
    "A", "V", "C", "K", "T", "Nm", "mol", "rpm", "F", "H", "Ohm", "eV", "l", "L",
})  # fmt: skip


def unit_symbol(word: str) -> str:
    """Return the symbol of a unit that is written as a word, `deg` for `Degrees`, or the word itself."""
    return UNIT_WORDS.get(word) or UNIT_WORDS.get(word.lower().rstrip("s"), word)


def looks_like_unit(word: str) -> bool:
    """Whether a word looks like a unit, maybe with an exponent: `kg`, `s2`, `degrees`."""
    word = word.rstrip("0123456789")
    return word in _UNITS or unit_symbol(word) != word


# -- remedies ----------------------------------------------------------------------------------

_PLAIN = re.compile(r"(?<![\w])\(([\w.]+(?:\([^()]*\)|\[[^\[\]]*\])?)\)")  # parentheses around one operand
_LONGEST = 80  # characters of a remedy's line


def remedy_of(entry: str) -> str:
    """Return the remedy of a table's entry."""
    return entry if "`" in entry else f"write `{entry}`" if entry else "leave it out"


def remedy_of_word(table: Mapping[str, str], name: str) -> str | None:
    """Return the remedy for a word in one of the tables, or None."""
    entry = table.get(name)
    return None if entry is None else remedy_of(entry)


def fill_template(template: str, arguments: Sequence[str]) -> str:
    """Return a template with its arguments; superfluous parentheses are left out.  Raises IndexError."""
    text = _PLAIN.sub(r"\1", template.format(*arguments, all=", ".join(arguments)))
    return re.sub(r"([\d.])\*1 \[", r"\1 [", text)


def foreign_call(name: str, arguments: Sequence[str] = ()) -> str | None:
    """Return the remedy for a call of a function of another language, or None: `sin(30 [deg])` for
    `sind(30)`."""
    template = CALLS.get(name)
    if template is None or "`" in template:
        return template
    try:
        line = fill_template(template, arguments)
    except IndexError:
        line = "\n"
    shown = len(line) <= _LONGEST and "\n" not in line
    return f"write `{line if shown else fill_template(template, 'xyz')}`"


def remedy_of_surplus(name: str, arguments: Sequence[str]) -> str | None:
    """Return the remedy for a call with too many arguments, or None: `der(der(x))` for `der(x, 2)`."""
    template = "der(der({0}))" if name == "der" and arguments[1] == "2" else SURPLUS.get(name)
    return template and f"write `{fill_template(template, arguments)}`"


def keeps_argument(name: str, k: int) -> bool:
    """Whether argument number k of a call is written in its remedy: not the `t` of `diff(x, t)`."""
    template = CALLS.get(name, "`")
    return "`" in template or f"{{{k}}}" in template or "{all}" in template
