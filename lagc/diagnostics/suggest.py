"""Suggestions: the known name that is most like an unknown one, and words of other languages."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from functools import lru_cache
from operator import itemgetter
from typing import NamedTuple

_FOREIGN = {
    "ln": "write `log`, the natural logarithm", "lg": "write `log10`", "log2": "write `log(x)/log(2)`",
    "pow": "write `x^n`", "power_of": "write `x^n`", "arcsin": "write `asin`", "arccos": "write `acos`",
    "arctan": "write `atan`", "arctan2": "write `atan2`", "tg": "write `tan`", "ctg": "write `1/tan(x)`",
    "cot": "write `1/tan(x)`", "sec": "write `1/cos(x)`", "csc": "write `1/sin(x)`",
    "mag": "write `norm`", "magnitude": "write `norm`", "length": "write `norm`, or `size` of an array",
    "len": "write `size`", "inner": "write `dot`", "vector": "write `{x, y, z}`", "unit": "write `normalize`",
    "diff": "write `der(x)` for the time derivative", "ddt": "write `der(x)`", "dot_": "write `der(x)`",
    "deriv": "write `der(x)`", "derivative": "write `der(x)`", "dt": "write `der(x)`",
    "ceiling": "write `ceil`", "round": "write `floor(x + 1/2)`", "fmod": "write `mod`", "rem": "write `mod`",
    "radians": "write the unit of the number: `30 [deg]`",
    "deg2rad": "write the unit of the number: `30 [deg]`",
    "heaviside": "write `if x > 0 then 1 else 0`", "step": "write `if time > 1 [s] then 1 else 0`",
    "Pi": "write `pi`", "PI": "write `pi`", "t": "write `time`",
    "True": "write `true`", "False": "write `false`",
}  # fmt: skip

SYNONYMS = {  # types of other languages -> types
    **dict.fromkeys(("float", "double", "Float", "Double", "real", "Number", "number", "Scalar"), "Real"),
    **dict.fromkeys(("int", "Int", "integer"), "Integer"),
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
}  # fmt: skip

_FOREIGN_TYPES = {
    **dict.fromkeys(("Boolean", "bool", "Bool", "boolean"),
        "declare an `effect` for a choice, `discrete Boolean on(start = true);` for a state that `when` "
        "clauses change, or write `if condition then 1 else 0` for a number"),
    **dict.fromkeys(("String", "string", "str"),
        "there are no text variables; write a text as the description of a declaration"),
    **dict.fromkeys(("Vector", "vector", "Vector3"), "write a vector as an array: `parameter Length r[3];`"),
    "Rotation": "write `Angle`, or `Orientation` for a rotation in space",
    "Quaternion": "write `Orientation`",
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
_COMPONENTS = {  # models of libraries of mechanics -> the declarations to write
    **{name: f"write `joint j = {call};` with two bodies" for name, call in _JOINTS.items()},
    **dict.fromkeys(("Body", "BodyShape", "BodyBox", "BodyCylinder", "PointMass", "RigidBody", "SlidingMass"),
        _PARTICLE),
    **dict.fromkeys(("Fixed", "FixedTranslation"), "write `point P = {0, 0, 1} [m];`"),
    "FixedRotation": "write `frame F = rotate_z(world, 30 [deg]);`",
    "World": "`world` is built in; for gravity write `Gravity field;`",
    "Spring": _SPRING, "Damper": _DAMPER,
    **dict.fromkeys(("SpringDamper", "SpringDamperParallel"), f"{_SPRING}; {_DAMPER}"),
    "WorldForce": "write `force f = {1 [N], 0, 0} at b;`",
    "WorldTorque": "write `torque M = {0, 0, 1 [N.m]} on b;`",
}  # fmt: skip

_ARGUMENTS = {  # names of arguments in other languages -> those that may be meant
    **dict.fromkeys(("m",), ("mass",)),
    **dict.fromkeys(("pos", "position", "r", "r_0", "r_CM", "center", "cm"), ("at", "com")),
    **dict.fromkeys(("I", "J", "moments"), ("inertia",)),
    **dict.fromkeys(("StopTime", "stopTime", "stop_time", "t_end", "tstop", "duration", "end"), ("stop",)),
    **dict.fromkeys(("Tolerance", "tolerance", "tol"), ("accuracy",)),
    **dict.fromkeys(("Interval", "dt"), ("every", "step")), "NumberOfIntervals": ("points",),
    **dict.fromkeys(("initial", "init", "value", "ic"), ("start",)),
    **dict.fromkeys(("v", "velocity", "speed", "der"), ("rate",)),
    **dict.fromkeys(("n", "axis", "dir"), ("direction",)),
}  # fmt: skip

LIBRARIES = ("Modelica", "ModelicaServices", "math", "numpy", "scipy", "sympy", "matplotlib")
NO_LIBRARY = (
    "delete it, since types, functions and `pi` are built in: write `Mass` for `SI.Mass`, `sin` for `np.sin`"
)

AS_JOINT = (
    "write `joint name = Kind(a, b, ...);`, for example `joint j = Revolute(a, b, axis = world.y, at = P);`"
)

LATER = {  # declarations that are not yet supported -> the message, and what to write until then
    "friction": (
        "friction is not yet supported",
        "write it as a force with a known normal force, smooth at rest: "
        "`force rub = -mu*m*g*tanh(der(x)/(1e-3 [m/s]))*world.x at b;`",
    )
}

LONGEST = 64  # characters of a name that is compared
MOST = 2000  # known names that are looked at
NEAREST = 50  # of them, by their letters, that are compared


def closest(name: str, known: Iterable[str]) -> str | None:
    """Return the name in `known` that is most similar to `name`, or None. Letter case and `_` count little:
    `Theta0` finds `theta_0`.  So do parts of a path: `u.damp.c` finds `u.c` before `c`."""
    candidates = tuple(dict.fromkeys(known))[:MOST]
    return _closest(name, candidates) if candidates and len(name) <= LONGEST else None


@lru_cache(maxsize=256)
def _closest(name: str, known: Sequence[str]) -> str | None:
    """Return the closest name; cached, because every scene of a model asks for the same names."""
    import difflib

    plain = _plain(name)
    same = [c for c in known if _plain(c) == plain and c != name]
    if same:
        return same[0]
    parts = name.split(".")
    paths = {c: c.split(".") for c in known}
    pathwise = [c for c, path in paths.items() if _leaves_out(path, parts) or _leaves_out(parts, path)]
    if pathwise:
        return min(pathwise, key=lambda c: abs(len(paths[c]) - len(parts)))
    near = _nearest(name, known)
    found = difflib.get_close_matches(name, near, n=1, cutoff=0.6)
    if found:
        return found[0]
    by_plain = {_plain(c): c for c in reversed(near)}
    found = difflib.get_close_matches(plain, by_plain, n=1, cutoff=0.7)
    return by_plain[found[0]] if found else None


def _nearest(name: str, known: Sequence[str]) -> Sequence[str]:
    """Return the names that share the most letters with `name`, since a full comparison is slow."""
    if len(known) <= NEAREST:
        return known
    letters = set(_plain(name))
    alike = []
    for k, candidate in enumerate(known):
        other = set(_plain(candidate))
        length = abs(len(candidate) - len(name))
        alike.append((-len(letters & other) / (len(letters | other) or 1), length, k))
    return [known[k] for _, _, k in sorted(sorted(alike)[:NEAREST], key=itemgetter(2))]


def _leaves_out(path: Sequence[str], other: Sequence[str]) -> bool:
    """Whether `path` is `other` with some parts left out."""
    left = iter(other)
    return len(path) < len(other) and path[-1] == other[-1] and all(part in left for part in path)


def did_you_mean(name: str, known: Iterable[str]) -> str | None:
    """Return a remedy with the closest name, or None."""
    found = closest(name, known)
    return None if found is None else f"did you mean `{found}`?"


def meant_argument(name: str, known: Collection[str]) -> str | None:
    """Return a remedy with the argument of `known` that is called `name` elsewhere, or that is most alike."""
    meant = next((own for own in _ARGUMENTS.get(name, ()) if own in known), None)
    return did_you_mean(name, known) if meant is None else f"write `{meant}`"


def foreign(name: str) -> str | None:
    """Return a remedy for a function name of another language, or None."""
    return _FOREIGN.get(name)


def foreign_type(name: str) -> str | None:
    """Return a remedy for a type name of another language, or None."""
    return f"write `{SYNONYMS[name]}`" if name in SYNONYMS else _FOREIGN_TYPES.get(name)


def moments(written: Sequence[str], k: int) -> str:
    """Return a remedy for three moments of inertia if number k exceeds the sum of the two others."""
    others = [str(i + 1) for i in range(3) if i != k]
    if all(written[int(i) - 1] == "0" for i in others):
        whole = [written[k] if i == k else f"{written[k]}/2" for i in range(3)]
        return (
            f"the moments {' and '.join(others)} are missing: for a flat body write `inertia = "
            f"{{{', '.join(whole)}}}`"
        )
    return f"make the moments {' and '.join(others)} together at least as large as moment {k + 1}"


def foreign_model(name: str) -> str | None:
    """Return the declarations to write for a model of a library of mechanics, or None."""
    return _COMPONENTS.get(name)


def _plain(name: str) -> str:
    return name.lower().replace("_", "")


OPERATORS: dict[str, str | None] = {
    "**": "^", "!=": "<>", "&&": "and", "||": "or", "&": "and", "|": "or", "!": "not", ":=": "=", ".*": "*",
    "./": "/", ".^": "^",
    "+=": None, "-=": None, "*=": None, "/=": None, "..": ":", "...": None, "%": None,
}  # fmt: skip


class Foreign(NamedTuple):
    """A remedy for a word of another language, and the words to replace it by (None: none; empty: leave it
    out)."""

    remedy: str
    ours: tuple[str, ...] | None = None


_COORDINATE = Foreign("declare unknowns with `coordinate Type name;`", ("coordinate",))
_CONSTANT = Foreign("write `constant`", ("constant",))
_PARAMETER = Foreign("write `parameter`", ("parameter",))
_MODEL = Foreign("write `model`", ("model",))
_FUNCTION = Foreign("write `function name(Type x) = expression;`")
_EQUATION = Foreign(
    "there is no equation section: lagc derives the equations of motion; write an equation that always "
    "holds as `constraint name: left = right;`",
    (),
)
_PREFIX = Foreign("leave it out", ())

FOREIGN: dict[str, Foreign] = {
    "var": _COORDINATE, "let": _COORDINATE, "variable": _COORDINATE, "state": _COORDINATE, "dof": _COORDINATE,
    "const": _CONSTANT, "final": _PREFIX, "param": _PARAMETER, "parameters": _PARAMETER,
    "coordinates": Foreign("write `coordinate`", ("coordinate",)), "class": _MODEL, "block": _MODEL,
    "record": _MODEL, "struct": _MODEL, "module": _MODEL, "system": _MODEL,
    "def": _FUNCTION, "fn": _FUNCTION, "func": _FUNCTION, "lambda": _FUNCTION,
    "equation": _EQUATION, "equations": _EQUATION, "algorithm": _EQUATION, "public": _PREFIX,
    "protected": _PREFIX, "private": _PREFIX, "static": _PREFIX, "inner": _PREFIX, "outer": _PREFIX,
    "replaceable": _PREFIX, "encapsulated": _PREFIX, "redeclare": _PREFIX, "flow": _PREFIX,
    "from": Foreign("write `import package.name;`"),
    "print": Foreign("for a computed quantity write `output Type name = value;`"),
    "return": Foreign("for a computed quantity write `output Type name = value;`"),
    "include": Foreign("write `import`", ("import",)), "using": Foreign("write `import`", ("import",)),
    "connect": Foreign("connect bodies by constraints: `constraint c: position(a) = position(b);`"),
    "while": Foreign("write a loop as `for i in 1:n loop ... end for;`"),
    "if": Foreign("use `if` in an expression: `x = if condition then value else other;`"),
    "assert": Foreign("give bounds where a quantity is declared: `parameter Mass m(min = 0);`"),
    "spring": Foreign("write a spring as a potential: `potential V = 1/2*k*x^2;`"),
    "damper": Foreign("write a damper as a dissipation: `dissipation D = 1/2*c*der(x)^2;`"),
}  # fmt: skip

_UNITS = frozenset({
    "kg", "g", "mg", "t", "m", "mm", "cm", "km", "um", "s", "ms", "us", "min", "h", "d", "rad", "mrad",
    "deg", "rev", "N", "kN", "mN", "J", "kJ", "W", "kW", "Pa", "kPa", "MPa", "GPa", "bar", "Hz", "kHz",
    "A", "V", "C", "K", "T", "Nm", "mol", "rpm", "F", "H", "Ohm", "eV", "l", "L",
})  # fmt: skip


def looks_like_unit(word: str) -> bool:
    """Whether a word looks like a unit, maybe with an exponent: `kg`, `s2`."""
    return word.rstrip("0123456789") in _UNITS
