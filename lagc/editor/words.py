"""The words of the language, from the tables of the compiler."""

from functools import cache

from lagc.base.run_options import RUN_OPTIONS
from lagc.semantics.declarations.bodies import GRAVITY_PARAMETERS, PARAMETERS
from lagc.semantics.declarations.contacts import ARGUMENTS
from lagc.semantics.declarations.events import ACTIONS as ACTIONS
from lagc.semantics.declarations.figures import PARAMETERS as FIGURES
from lagc.semantics.declarations.quantities import ATTRIBUTES
from lagc.semantics.joints import KINDS
from lagc.semantics.units import CONSTANTS, SYMBOLS, TYPES
from lagc.semantics.values.calls import builtins
from lagc.syntax.lalr_tables import tables

Call = tuple[tuple[str, ...], int]  # the parameters, and how many of them are required

FUNCTIONS: dict[str, Call] = {name: (b.parameters, b.required) for name, b in builtins().items()}
MADE: dict[str, dict[str, Call]] = {  # by the keyword of their declaration
    "body": dict(PARAMETERS),
    "joint": {name: (kind.parameters, kind.required) for name, kind in KINDS.items()},
    "draw": {name: (parameters, len(parameters)) for name, parameters in FIGURES.items()},
    "": {"Gravity": (GRAVITY_PARAMETERS, 0)},
}
THINGS: dict[str, Call] = {name: call for calls in MADE.values() for name, call in calls.items()}
NAMED_VALUES = (*CONSTANTS, "time", "world")
_USUAL = (
    "m", "mm", "cm", "km", "kg", "g", "s", "ms", "min", "h", "rad", "deg", "rev", "rpm", "rad/s", "deg/s",
    "m/s", "m/s2", "N", "kN", "N.m", "N/m", "N.s/m", "N.m/rad", "J", "W", "Pa", "Hz", "kg.m2", "kg/m",
    "kg/m3", "1",
)  # fmt: skip
UNITS = tuple(dict.fromkeys((*_USUAL, *SYMBOLS)))


@cache
def keywords() -> tuple[str, ...]:
    return tuple(sorted(tables().keywords))


def types() -> dict[str, str]:
    """Return the quantity types with their units."""
    return {name: known.unit for name, known in TYPES.items()} | {"Orientation": "", "Boolean": ""}


def shown(name: str, call: Call) -> str:
    """Return a call with its parameters; those that may be left out stand in brackets."""
    parameters, required = call
    return f"{name}({', '.join(p if k < required else f'[{p}]' for k, p in enumerate(parameters))})"


def arguments(name: str, keyword: str) -> tuple[str, ...]:
    """Return the names of the arguments in the parentheses behind `name`, in a declaration that begins with
    `keyword`."""
    known = THINGS.get(name) or FUNCTIONS.get(name)
    if known is not None:
        return tuple(p for p in known[0] if p != "*")
    if keyword == "simulate":
        return tuple(RUN_OPTIONS)
    return ARGUMENTS if keyword == "constraint" else ATTRIBUTES.get(keyword, ())
