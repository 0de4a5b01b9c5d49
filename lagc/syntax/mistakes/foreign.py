"""Words and signs of other languages, and what stands for them here."""

from __future__ import annotations

from lagc.base.records import dataclass

OPERATORS: dict[str, str | None] = {
    "**": "^", "!=": "<>", "&&": "and", "||": "or", "&": "and", "|": "or", "!": "not", ":=": "=", ".*": "*",
    "./": "/", ".^": "^",
    "+=": None, "-=": None, "*=": None, "/=": None, "..": ":", "...": None, "%": None,
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Foreign:
    """How to say it here, and the words to put in its place where that is all (none: leave it out)."""

    remedy: str
    ours: tuple[str, ...] | None = None


_COORDINATE = Foreign("unknowns are declared with `coordinate Type name;`", ("coordinate",))
_CONSTANT = Foreign("write `constant`", ("constant",))
_PARAMETER = Foreign("write `parameter`", ("parameter",))
_MODEL = Foreign("write `model`", ("model",))
_FUNCTION = Foreign("write `function name(Type x) = expression;`")
_EQUATION = Foreign(
    "the equations of motion are derived; a law that holds is a `constraint name: left = right;`", ()
)
_PREFIX = Foreign("leave it out", ())
_TYPE = Foreign(
    "a quantity is declared with its kind: `parameter Length l = 1 [m];`, `coordinate Angle theta;`"
)

FOREIGN: dict[str, Foreign] = {
    "var": _COORDINATE, "let": _COORDINATE, "variable": _COORDINATE, "state": _COORDINATE, "dof": _COORDINATE,
    "const": _CONSTANT, "final": _PREFIX, "param": _PARAMETER, "parameters": _PARAMETER,
    "coordinates": Foreign("write `coordinate`", ("coordinate",)), "class": _MODEL, "block": _MODEL,
    "record": _MODEL, "struct": _MODEL, "module": _MODEL, "system": _MODEL,
    "def": _FUNCTION, "fn": _FUNCTION, "func": _FUNCTION, "lambda": _FUNCTION,
    "equation": _EQUATION, "equations": _EQUATION, "algorithm": _EQUATION, "public": _PREFIX,
    "protected": _PREFIX, "private": _PREFIX, "static": _PREFIX, "inner": _PREFIX, "outer": _PREFIX,
    "replaceable": _PREFIX, "encapsulated": _PREFIX, "discrete": _PREFIX, "flow": _PREFIX,
    "real": _TYPE, "integer": _TYPE, "boolean": _TYPE, "double": _TYPE, "float": _TYPE, "int": _TYPE,
    "include": Foreign("write `import`", ("import",)), "using": Foreign("write `import`", ("import",)),
    "connect": Foreign("bodies are connected by joints: `joint j = Revolute(a, b, axis = ..., at = ...);`"),
    "while": Foreign("loops are `for i in 1:n loop ... end for;`"),
    "if": Foreign("`if` stands in expressions: `x = if condition then value else other;`"),
    "assert": Foreign("bounds are said where a quantity is declared: `parameter Mass m(min = 0);`"),
    "spring": Foreign("a spring is a potential: `potential V = 1/2*k*x^2;`"),
    "damper": Foreign("a damper is a dissipation: `dissipation D = 1/2*c*der(x)^2;`"),
}  # fmt: skip

_UNITS = frozenset({
    "kg", "g", "mg", "t", "m", "mm", "cm", "km", "um", "s", "ms", "us", "min", "h", "d", "rad", "mrad",
    "deg", "rev", "N", "kN", "mN", "J", "kJ", "W", "kW", "Pa", "kPa", "MPa", "GPa", "bar", "Hz", "kHz",
    "A", "V", "C", "K", "T", "Nm", "mol", "rpm", "F", "H", "Ohm", "eV", "l", "L",
})  # fmt: skip


def looks_like_unit(word: str) -> bool:
    """Is this a unit, maybe with an exponent: `kg`, `s2`?"""
    return word.rstrip("0123456789") in _UNITS
