"""The properties of each operator of the expression graph, one row each.

Sums, products and numeric factors are built into `graph` and have no row.  A new function needs a row here,
and its code in C or Python, its identities (`finite_field`) or its notation if they differ from those of
other functions.
"""

import math
from collections.abc import Callable, Iterable, Iterator
from typing import Any, TypeAlias, TypeVar

from lagc.base.records import dataclass
from lagc.symbolic.leaves import Table

Interval: TypeAlias = tuple[float, float]
# (graph, node, arguments) -> d(node)/d(argument) for each; typed Any, since `graph` imports this file.
Slopes: TypeAlias = Callable[..., tuple[Any, ...]]
# (graph, arguments) -> the operator as a choice between two smooth branches.
Sides: TypeAlias = Callable[..., Any]

EVERYWHERE: Interval = (-math.inf, math.inf)
_UP_TO_ONE: Interval = (-1.0, 1.0)
_POSITIVE: Interval = (0.0, math.inf)
_RIGHT: Interval = (-0.5 * math.pi, 0.5 * math.pi)

# Smoothness inside of the domain and at its border.
ENTIRE = "entire"  # analytic for all numbers
POLE = "pole"  # values may differ on both sides of the border
END = "end"  # only derivatives may differ at the border
CORNER, STEP = "corner", "step"  # where the argument is 0, or where two arguments are equal
LOGIC = "logic"  # operates on truth values
FLAT = "flat"  # piecewise constant
CHOICE = "choice"  # selects one of two arguments


def _flat(graph: Any, node: Any, *arguments: Any) -> tuple[Any, ...]:
    return (graph.zero,) * len(arguments)


@dataclass(frozen=True, slots=True)
class Operator:
    """An operator and its properties.

    `value` evaluates floats and raises as `math` does.  `parity` is 1 if f(-x) = f(x), -1 if f(-x) = -f(x),
    else 0. `within` contains all values.  `rising`: f is nondecreasing in all arguments.  `twin`: the
    function whose square and that of f add up to 1.  A `looked_up` operator has a `Table` before its
    arguments.  `weight` is the cost in additions, `cycles` the latency.  The spelling in the model language
    is the name, or `infix`; each target has its own."""

    name: str
    arity: int
    value: Callable[..., float]
    smoothness: str
    slopes: Slopes = _flat
    parity: int = 0
    within: Interval = EVERYWHERE
    rising: bool = False
    sides: Sides | None = None
    twin: str = ""
    truth: bool = False  # the value is a truth value
    looked_up: bool = False
    weight: int = 20
    cycles: int = 60
    infix: str = ""
    c: str = ""
    python: str = ""
    sympy: str = ""
    latex: str = ""


def _sign(x: float) -> float:
    return (x > 0) - (x < 0)


def _power_slopes(graph: Any, node: Any, x: Any, y: Any) -> tuple[Any, ...]:
    dx = graph.mul(y, graph.pow(x, y - 1.0))
    if y.is_const:
        return (dx, graph.zero)
    if graph.is_of_parameters(y):
        x = graph.select(graph.binary("eq", node, graph.zero), graph.one, x)  # the derivative of 0^p = 0 is 0
    return (dx, graph.mul(node, graph.unary("log", x)))


def _angle_slopes(graph: Any, node: Any, y: Any, x: Any) -> tuple[Any, ...]:
    square = x * x + y * y
    return (x / square, -y / square)


def _choice_slopes(graph: Any, condition: Any) -> tuple[Any, ...]:
    one, zero = graph.one, graph.zero
    return (graph.select(condition, one, zero), graph.select(condition, zero, one))


def _compared(graph: Any, x: Any, y: Any) -> Any:
    return graph.binary("lt", x, y)


_ROWS = (
    Operator(
        "sin", 1, math.sin, ENTIRE, lambda g, f, x: (g.cos(x),), parity=-1, within=_UP_TO_ONE, twin="cos",
    ),
    Operator(
        "cos", 1, math.cos, ENTIRE, lambda g, f, x: (-g.sin(x),), parity=1, within=_UP_TO_ONE, twin="sin",
    ),
    Operator("tan", 1, math.tan, POLE, lambda g, f, x: (f * f + 1.0,), parity=-1),
    Operator(
        "asin", 1, math.asin, END, lambda g, f, x: (1.0 / g.sqrt(1.0 - x * x),),
        parity=-1, within=_RIGHT, rising=True, latex=r"\arcsin",
    ),
    Operator(
        "acos", 1, math.acos, END, lambda g, f, x: (-1.0 / g.sqrt(1.0 - x * x),),
        within=(0.0, math.pi), latex=r"\arccos",
    ),
    Operator(
        "atan", 1, math.atan, ENTIRE, lambda g, f, x: (1.0 / (x * x + 1.0),),
        parity=-1, within=_RIGHT, rising=True, latex=r"\arctan",
    ),
    Operator("sinh", 1, math.sinh, ENTIRE, lambda g, f, x: (g.unary("cosh", x),), parity=-1, rising=True),
    Operator(
        "cosh", 1, math.cosh, ENTIRE, lambda g, f, x: (g.unary("sinh", x),), parity=1, within=(1.0, math.inf)
    ),
    Operator(
        "tanh", 1, math.tanh, ENTIRE, lambda g, f, x: (1.0 - f * f,),
        parity=-1, within=_UP_TO_ONE, rising=True,
    ),
    Operator("exp", 1, math.exp, ENTIRE, lambda g, f, x: (f,), within=_POSITIVE, rising=True),
    Operator("log", 1, math.log, END, lambda g, f, x: (1.0 / x,), rising=True, latex=r"\ln"),
    Operator(
        "sqrt", 1, math.sqrt, END, lambda g, f, x: (0.5 / f,),
        within=_POSITIVE, rising=True, weight=4, cycles=18,
    ),
    Operator(
        "abs", 1, math.fabs, CORNER, lambda g, f, x: (g.unary("sign", x),), parity=1, within=_POSITIVE,
        sides=lambda g, x: g.select(_compared(g, g.zero, x), x, -x),
        weight=1, cycles=1, c="fabs", python="fabs", sympy="Abs",
    ),
    Operator("floor", 1, math.floor, STEP, rising=True, weight=1),
    Operator("piece", 1, Table.piece, STEP, rising=True, looked_up=True, c="lagc_piece"),
    Operator("entry", 1, Table.entry, FLAT, looked_up=True, weight=2, cycles=8),
    Operator(
        "sign", 1, _sign, STEP, parity=-1, within=_UP_TO_ONE, rising=True,
        sides=lambda g, x: g.select(_compared(g, g.zero, x), g.one, -g.one),
        weight=1, c="lagc_sign", latex=r"\operatorname{sgn}",
    ),
    Operator(
        "atan2", 2, math.atan2, POLE, _angle_slopes, within=(-math.pi, math.pi),
        latex=r"\operatorname{atan2}",
    ),
    Operator("pow", 2, math.pow, POLE, _power_slopes, sympy="Pow"),
    Operator(
        "min", 2, min, CORNER, lambda g, f, x, y: _choice_slopes(g, g.binary("le", x, y)), rising=True,
        sides=lambda g, x, y: g.select(_compared(g, x, y), x, y),
        weight=1, cycles=4, c="lagc_min", python="minimum", sympy="Min",
    ),
    Operator(
        "max", 2, max, CORNER, lambda g, f, x, y: _choice_slopes(g, g.binary("lt", y, x)), rising=True,
        sides=lambda g, x, y: g.select(_compared(g, x, y), y, x),
        weight=1, cycles=4, c="lagc_max", python="maximum", sympy="Max",
    ),
    Operator(
        "lt", 2, lambda x, y: x < y, STEP, within=(0.0, 1.0), truth=True, weight=1, cycles=4,
        infix="<", sympy="Lt", latex="<",
    ),
    Operator(
        "le", 2, lambda x, y: x <= y, STEP, within=(0.0, 1.0), truth=True, weight=1, cycles=4,
        infix="<=", sympy="Le", latex=r"\le",
    ),
    Operator(
        "eq", 2, lambda x, y: x == y, STEP, within=(0.0, 1.0), truth=True, weight=1, cycles=4,
        infix="==", sympy="Eq", latex="=",
    ),
    Operator(
        "and", 2, lambda x, y: bool(x and y), LOGIC, within=(0.0, 1.0), truth=True, weight=1, cycles=1,
        infix="and", c="&&", python="both", sympy="And", latex=r"\land",
    ),
    Operator(
        "or", 2, lambda x, y: bool(x or y), LOGIC, within=(0.0, 1.0), truth=True, weight=1, cycles=1,
        infix="or", c="||", python="either", sympy="Or", latex=r"\lor",
    ),
    Operator(
        "not", 1, lambda x: not x, LOGIC, within=(0.0, 1.0), truth=True, weight=1, cycles=1,
        c="!", python="inverse", sympy="Not", latex=r"\lnot",
    ),
    Operator(
        "select", 3, lambda c, x, y: x if c else y, CHOICE,
        lambda g, f, c, x, y: (g.zero, *_choice_slopes(g, c)), weight=1, cycles=2, sympy="Piecewise",
    ),
)  # fmt: skip

OPERATORS: dict[str, Operator] = {row.name: row for row in _ROWS}
VALUES = {row.name: row.value for row in _ROWS}
PARITY = {row.name: row.parity for row in _ROWS}
TWINS = {row.name: row.twin for row in _ROWS if row.twin}
INFIX = {row.name: row.infix for row in _ROWS if row.infix}
TRUTHS = frozenset([row.name for row in _ROWS if row.truth])
LOOKED_UP = frozenset([row.name for row in _ROWS if row.looked_up])
COMPARISONS = frozenset([row.name for row in _ROWS if row.truth and row.smoothness == STEP])


def spelling(target: str) -> dict[str, str]:
    """Return the names of operators in "c", "python", "sympy" or "latex"."""
    before = "\\" if target == "latex" else ""
    return {row.name: getattr(row, target) or row.infix or before + row.name for row in _ROWS}


def smooth_as(*kinds: str) -> frozenset[str]:
    """Return the operators whose smoothness is one of `kinds`."""
    return frozenset([row.name for row in _ROWS if row.smoothness in kinds])


Base = TypeVar("Base")


def exchanged(
    monomial: Iterable[tuple[Base, Any]], twin: Callable[[Base, Any], Base | None]
) -> Iterator[tuple[dict[Base, Any], Base]]:
    """Yield, for each factor of `monomial` with a `twin`, the monomial divided by the square of the factor,
    and the twin. This serves c x sin(u)^2 + c x cos(u)^2 = c x, for nodes or for other objects with sines and
    cosines. Exponents are integers or fractions, 0 for a factor that vanished."""
    powers = dict(monomial)
    for base, exponent in powers.items():
        other = twin(base, exponent)
        if other is not None:
            yield {**powers, base: exponent - 2}, other
