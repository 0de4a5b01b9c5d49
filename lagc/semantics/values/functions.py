"""Built-in functions of numbers, vectors and arrays."""

import math
from collections.abc import Callable
from typing import Any, TypeAlias

from lagc.base.records import dataclass
from lagc.diagnostics.faults import Span, Wrong
from lagc.diagnostics.suggest import is_many_radians, many_radians
from lagc.semantics.context import Context
from lagc.semantics.names.scope import (
    Array,
    Indexed,
    Scalar,
    Value,
    constant,
    numbers_of,
    scalar_of,
    shape,
    vector_of,
    vector_value,
)
from lagc.semantics.units import NONE, Dimension, S, describe, raised, si_text, times
from lagc.semantics.values.evaluate import Argument
from lagc.symbolic import vectors
from lagc.symbolic.graph import Node
from lagc.symbolic.operators import END, ENTIRE, OPERATORS, POLE

Apply: TypeAlias = Callable[..., Value]


@dataclass(frozen=True, slots=True)
class Builtin:
    """A built-in function: `apply(context, span of the call, *arguments)`. Arguments are `Argument`, or None
    if left out (after the first `required`).  A last parameter `*` takes any number."""

    parameters: tuple[str, ...]
    required: int
    apply: Apply


RESERVED = ("pre", "initial", "terminal", "sample", "edge", "change")  # reserved for later versions


class Table(dict[str, Builtin]):
    """Built-in functions by name."""

    def enter(self, name: str, *parameters: str, required: int | None = None) -> Callable[[Apply], Apply]:
        """Return a decorator that adds a function to the table under `name`."""

        def decorate(apply: Apply) -> Apply:
            self[name] = Builtin(parameters, len(parameters) if required is None else required, apply)
            return apply

        return decorate


TABLE = Table()


# -- mathematics ----------------------------------------------------------------------------


def _plain(op: str) -> Callable[[Context, Span, Argument], Value]:
    def apply(context: Context, span: Span, x: Argument) -> Value:
        return Scalar(finite_value(context.graph.unary(op, number(x, f"the argument of `{op}`")), span), NONE)

    return apply


for _op, _row in OPERATORS.items():
    if _row.arity == 1 and _row.smoothness in (ENTIRE, POLE, END) and _op != "sqrt":  # sqrt takes dimensions
        TABLE[_op] = Builtin(("x",), 1, _plain(_op))


def number(x: Argument, what: str) -> Node:
    """Return the node of an argument that is a pure number.  Raises Wrong."""
    scalar = scalar_of(x.value, x.span, what)
    if scalar.dimension not in (None, NONE):
        message = f"{what} must be a pure number; this is {describe(scalar.dimension)}"
        raise Wrong("LAG0303", message, x.span, _as_number(x, scalar.dimension))
    return scalar.node


def _as_number(x: Argument, dimension: Dimension | None) -> str:
    """Return a remedy for an argument that is not a pure number."""
    if dimension == S:
        return f"multiply by an angular frequency: write `1 [rad/s]*{x.span.text}`"
    return f"divide by a quantity of the same dimension, such as `1 [{si_text(dimension or NONE)}]`"


def finite_value(node: Node, span: Span) -> Node:
    """Return `node`.  Raises Wrong if it is a function of constants without a finite value."""
    if node.args and all(a.is_const for a in node.args):
        raise Wrong("LAG0309", f"the value of `{node.op}` is not finite here", span)
    return node


@TABLE.enter("log10", "x")
def _log10(context: Context, span: Span, x: Argument) -> Value:
    return Scalar(
        finite_value(context.graph.unary("log", number(x, "the argument of `log10`")), span) / math.log(10.0),
        NONE,
    )


@TABLE.enter("sqrt", "x")
def _sqrt(context: Context, span: Span, x: Argument) -> Value:
    scalar = scalar_of(x.value, x.span, "the argument of `sqrt`")
    dimension: Dimension | None = None
    if scalar.dimension is not None:
        dimension = raised(scalar.dimension, 0.5)
        if dimension is None:
            raise Wrong("LAG0305", f"{describe(scalar.dimension)} has no square root", x.span)
    return Scalar(finite_value(context.graph.sqrt(scalar.node), span), dimension)


@TABLE.enter("abs", "x")
def _abs(context: Context, span: Span, x: Argument) -> Value:
    scalar = scalar_of(x.value, x.span, "the argument of `abs`")
    return Scalar(context.graph.unary("abs", scalar.node), scalar.dimension)


@TABLE.enter("sign", "x")
def _sign(context: Context, span: Span, x: Argument) -> Value:
    node = scalar_of(x.value, x.span, "the argument of `sign`").node
    return Scalar(context.graph.unary("sign", node), NONE)


@TABLE.enter("floor", "x")
def _floor(context: Context, span: Span, x: Argument) -> Value:
    return Scalar(context.graph.unary("floor", number(x, "the argument of `floor`")), NONE)


@TABLE.enter("ceil", "x")
def _ceil(context: Context, span: Span, x: Argument) -> Value:
    return Scalar(-context.graph.unary("floor", -number(x, "the argument of `ceil`")), NONE)


@TABLE.enter("mod", "x", "y")
def _mod(context: Context, span: Span, x: Argument, y: Argument) -> Value:
    a, b = (scalar_of(g.value, g.span, "the argument of `mod`") for g in (x, y))
    dimension = dimension_shared([x, y], "`mod`")
    return Scalar(a.node - b.node * context.graph.unary("floor", a.node / b.node), dimension)


@TABLE.enter("atan2", "y", "x")
def _atan2(context: Context, span: Span, y: Argument, x: Argument) -> Value:
    dimension_shared([y, x], "`atan2`")
    a, b = (scalar_of(g.value, g.span, "the argument of `atan2`") for g in (y, x))
    return Scalar(context.graph.binary("atan2", a.node, b.node), NONE)


def _extreme(op: str) -> Callable[..., Value]:
    def apply(context: Context, span: Span, *given: Argument) -> Value:
        every = [g for g in given if g is not None]
        if len(every) == 1 and isinstance(every[0].value, Array):
            every = [Argument(element, every[0].span) for element in every[0].value.elements]
        if not every:
            raise Wrong("LAG0306", f"`{op}` needs at least one number", span)
        dimension = dimension_shared(every, f"`{op}`")
        nodes = [scalar_of(g.value, g.span, f"the argument of `{op}`").node for g in every]
        result = nodes[0]
        for node in nodes[1:]:
            result = context.graph.binary(op, result, node)
        return Scalar(result, dimension)

    return apply


for _op in ("min", "max"):
    TABLE[_op] = Builtin(("x", "*"), 1, _extreme(_op))


def dimension_shared(given: list[Argument], who: str) -> Dimension | None:
    """Return the common dimension of the arguments.  Raises Wrong."""
    found: tuple[Dimension, Span] | None = None
    for one in given:
        dimension = scalar_of(one.value, one.span, f"an argument of {who}").dimension
        if dimension is None:
            continue
        if found is not None and found[0] != dimension:
            message = (
                f"the arguments of {who} have different dimensions: {describe(found[0])} and "
                f"{describe(dimension)}"
            )
            raise Wrong("LAG0301", message, one.span, related=((found[1], describe(found[0])),))
        found = found or (dimension, one.span)
    return None if found is None else found[0]


# -- vectors and arrays -----------------------------------------------------------------------


def _product(a: Dimension | None, b: Dimension | None) -> Dimension | None:
    return None if a is None or b is None else times(a, b)


@TABLE.enter("dot", "a", "b")
def _dot(context: Context, span: Span, a: Argument, b: Argument) -> Value:
    u, first = numbers_of(a.value, a.span, "the argument of `dot`")
    w, second = numbers_of(b.value, b.span, "the argument of `dot`")
    if len(u) != len(w):
        message = f"`dot` takes two vectors of the same length; these have {len(u)} and {len(w)} elements"
        raise Wrong("LAG0306", message, span)
    return Scalar(vectors.dot(u, w), _product(first, second))


@TABLE.enter("cross", "a", "b")
def _cross(context: Context, span: Span, a: Argument, b: Argument) -> Value:
    u, first = vector_of(a.value, a.span, "the argument of `cross`")
    w, second = vector_of(b.value, b.span, "the argument of `cross`")
    return vector_value(vectors.cross(u, w), _product(first, second))


@TABLE.enter("norm", "a")
def _norm(context: Context, span: Span, a: Argument) -> Value:
    from lagc.semantics.values.frame_vectors import length_of  # where there are some

    vector, dimension = numbers_of(a.value, a.span, "the argument of `norm`")
    length = length_of(context, vector) if len(vector) == 3 else vectors.norm(vector)
    return Scalar(length, dimension)


@TABLE.enter("normalize", "a")
def _normalize(context: Context, span: Span, a: Argument) -> Value:
    from lagc.semantics.values.frame_vectors import unit_vector  # where there are some

    vector, _ = vector_of(a.value, a.span, "the argument of `normalize`")
    return vector_value(unit_vector(context, vector, a.span), NONE)


@TABLE.enter("sum", "a")
def _sum(context: Context, span: Span, a: Argument) -> Value:
    if not isinstance(a.value, Array):
        raise Wrong("LAG0306", "`sum` takes an array", a.span)
    if not a.value.elements:
        return constant(context.graph, 0.0, None)
    first = a.value.elements[0]
    if isinstance(first, Array):  # sum of vectors
        columns = zip(*(element.elements for element in a.value.elements if isinstance(element, Array)))
        return Array(tuple([_sum(context, span, Argument(Array(column), a.span)) for column in columns]))
    given = [Argument(element, a.span) for element in a.value.elements]
    dimension = dimension_shared(given, "`sum`")
    return Scalar(context.graph.sum(scalar_of(g.value, a.span, "an element").node for g in given), dimension)


@TABLE.enter("size", "a", "dimension", required=1)
def _size(context: Context, span: Span, a: Argument, dimension: Argument | None) -> Value:
    """Return the number of elements along a dimension, by default the first."""
    if isinstance(a.value, Indexed):
        places = list(a.value.entry.elements or {})
        sizes = [len({place[k] for place in places}) for k in range(len(places[0]) if places else 1)]
    elif isinstance(a.value, Array):
        sizes = shape(a.value)
    else:
        raise Wrong("LAG0306", "`size` takes an array", a.span)
    if dimension is None:
        return constant(context.graph, float(sizes[0]), NONE)
    which = number(dimension, "the second argument of `size`")
    if not which.is_const or which.value not in range(1, len(sizes) + 1):
        last = len(sizes)
        raise Wrong("LAG0207", f"this array has the dimensions 1 to {last}", dimension.span)
    return constant(context.graph, float(sizes[int(which.value) - 1]), NONE)


def angle_of_turn(context: Context, angle: Argument) -> Node:
    """Return an angle of rotation; a number that looks like degrees gets a warning."""
    node = number(angle, "an angle of rotation")
    if angle.bare and isinstance(node.value, float) and is_many_radians(node.value):
        text, sign = angle.span.text.lstrip("- "), "-" if node.value < 0.0 else ""
        context.warnings[angle.span, angle.span] = many_radians("angle", text, sign, angle.span)
    return node


TABLES = Table()


@TABLES.enter("table", "x", "data", "values", "interpolation", "extrapolation", "over", required=2)
def _table(context: Context, span: Span, *given: Any) -> Value:
    from lagc.semantics.values.tables import table  # where there are some

    return table(context, *given)
