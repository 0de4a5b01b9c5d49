"""Built-in functions of numbers, vectors and arrays, and tables that interpolate data."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import TypeAlias

from lagc.base.records import dataclass
from lagc.diagnostics.faults import Span, Wrong
from lagc.diagnostics.suggest import did_you_mean, is_many_radians, many_radians
from lagc.semantics import model as objects
from lagc.semantics.context import Context, Points
from lagc.semantics.names.namespace import Columns, Unfit
from lagc.semantics.names.scope import (
    Array,
    Indexed,
    Scalar,
    Text,
    Value,
    common_dimension,
    constant,
    kind,
    numbers_of,
    scalar_of,
    shape,
    vector_of,
    vector_value,
)
from lagc.semantics.units import NONE, Dimension, S, UnknownUnit, describe, raised, si_text, times, unit
from lagc.semantics.values.frame_vectors import length_of, unit_vector
from lagc.symbolic import vectors
from lagc.symbolic.graph import Node
from lagc.symbolic.interpolants import KINDS, interpolant, key_of
from lagc.symbolic.operators import END, ENTIRE, OPERATORS, POLE

Apply: TypeAlias = Callable[..., Value]


@dataclass(frozen=True, slots=True)
class Argument:
    """An argument of a call; `bare`: it consists of numbers without units."""

    value: Value
    span: Span
    bare: bool = False


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
    vector, dimension = numbers_of(a.value, a.span, "the argument of `norm`")
    length = length_of(context, vector) if len(vector) == 3 else vectors.norm(vector)
    return Scalar(length, dimension)


@TABLE.enter("normalize", "a")
def _normalize(context: Context, span: Span, a: Argument) -> Value:
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
BEYOND = ("hold", "line")


@dataclass(frozen=True, slots=True)
class Column:
    """Numbers in SI with a common dimension, NONE if no unit is given."""

    numbers: Sequence[float]
    dimension: Dimension
    bare: bool


@TABLES.enter("table", "x", "data", "values", "interpolation", "extrapolation", "over", required=2)
def _table(
    context: Context, span: Span, x: Argument, data: Argument, values: Argument | None,
    interpolation: Argument | None, extrapolation: Argument | None, over: Argument | None,
) -> Value:  # fmt: skip
    """Return the function of x through points. The points are `values` at `data`, pairs `{{x, y}, ...}`, or
    the column `values` of a file over its column `over`."""
    at = scalar_of(x.value, x.span, "the argument of a table")
    kind = _choice(interpolation, tuple(KINDS), "linear")
    beyond = _choice(extrapolation, BEYOND, "line" if kind == "cubic" else "hold")
    name, file = "table", ""
    if isinstance(data.value, Text):
        file = data.value.text
        knots, found, name = _from_file(context, data, values, over)
    elif over:
        raise Wrong("LAG0209", "`over` is only allowed with a file", over.span)
    else:
        knots, found = _from_text(data, values)
    if at.dimension is not None and not knots.bare and knots.dimension != at.dimension:
        message = f"the table has the argument {describe(knots.dimension)}; this is {describe(at.dimension)}"
        raise Wrong("LAG0301", message, x.span, related=((data.span, describe(knots.dimension)),))
    points = knots.numbers, found.numbers
    node = through(context, at.node, *points, kind, beyond == "line", name, data.span, file)
    return Scalar(node, found.dimension, found.bare)


def through(
    context: Context, x: Node, knots: Sequence[float], values: Sequence[float], kind: str, straight: bool,
    name: str, span: Span | None, file: str = "",
) -> Node:  # fmt: skip
    """Return the `interpolant` with a unique name (letters, digits and `_`) from the column of a `file`.
    Raises Wrong."""
    check_order(knots, span)
    key, count, column = key_of(knots, values, kind, straight), 1, name
    own = name = re.sub(r"\W+", "_", name).strip("_") or "table"
    while context.curves.setdefault(own, objects.Table(own, key, file, column if file else "")).key != key:
        count += 1
        own = f"{name}_{count}"
    try:
        return interpolant(x, knots, values, kind, straight, own)
    except (OverflowError, ZeroDivisionError):
        raise Wrong("LAG0314", "the slope of the table between two points is not finite", span) from None


def over_time(context: Context, points: Points, name: str) -> Node:
    """Return the interpolant through `points` of time and value.  Raises Wrong."""
    knots, values, kind = points
    if kind not in KINDS:
        raise Wrong("LAG0307", f"the interpolation is one of {', '.join(KINDS)}, not {kind!r}", None)
    if len(knots) != len(values) or not all(map(math.isfinite, [*knots, *values])):
        message = f"`{name}` needs as many finite values as times"
        raise Wrong("LAG0314", message, None)
    return through(context, context.time, knots, values, kind, kind == "cubic", name, None)


def check_order(knots: Sequence[float], span: Span | None, lines: Sequence[int] = ()) -> None:
    """Raise Wrong if there are fewer than two knots or they do not increase.  `lines` are those of the
    file."""
    if len(knots) < 2:
        raise Wrong("LAG0314", f"a table needs at least two rows; this has {len(knots)}", span)
    for k, (before, here) in enumerate(pairwise(knots), 2):
        if not here > before:
            said = "again" if here == before else f"after {before:g}"
            place = f"line {lines[k - 1]} of the file" if lines else f"row {k}"
            message = f"the argument of a table must increase from row to row: {place} has {here:g} {said}"
            raise Wrong("LAG0314", message, span)


def _choice(given: Argument | None, known: Sequence[str], default: str) -> str:
    if given is None:
        return default
    said = given.value.text if isinstance(given.value, Text) else ""
    if said not in known:
        listed = ", ".join(f'"{word}"' for word in known)
        raise Wrong("LAG0307", f"this must be one of {listed}", given.span, did_you_mean(said, known))
    return said


def _from_text(data: Argument, values: Argument | None) -> tuple[Column, Column]:
    if values is not None:
        knots, found = (_column(_elements(a), a) for a in (data, values))
        if len(knots.numbers) != len(found.numbers):
            counts = f"{len(found.numbers)} values for {len(knots.numbers)} arguments"
            message = f"a table needs one value for each argument; there are {counts}"
            raise Wrong("LAG0314", message, values.span)
        return knots, found
    pairs = [row.elements for row in _elements(data) if isinstance(row, Array)]
    if not pairs or any(len(pair) != 2 for pair in pairs):
        message = "a table takes arrays, `{x1, x2, ...}, {y1, y2, ...}`, pairs, `{{x1, y1}, ...}`, or a file"
        raise Wrong("LAG0306", message, data.span)
    first, second = zip(*pairs)
    return _column(first, data), _column(second, data)


def _elements(a: Argument) -> Sequence[Value]:
    if not isinstance(a.value, Array):
        raise Wrong("LAG0306", f"a table takes arrays or a file; this is {kind(a.value)}", a.span)
    return a.value.elements


def _column(cells: Sequence[Value], given: Argument) -> Column:
    scalars = [scalar_of(cell, given.span, "an entry of a table") for cell in cells]
    if not all(s.node.is_const for s in scalars):
        message = "the values of a table must be fixed; this depends on parameters or on the motion"
        raise Wrong("LAG0208", message, given.span, "multiply the table by the parameter")
    dimension = common_dimension(tuple(scalars), given.span) or NONE
    return Column([s.node.value for s in scalars], dimension, given.bare)


def _from_file(
    context: Context, data: Argument, values: Argument | None, over: Argument | None
) -> tuple[Column, Column, str]:
    """Return the argument column, the value column and its name."""
    assert isinstance(data.value, Text)
    file = context.importer.data(data.value.text, data.span)
    first = 0 if over is None else _place(file, over)
    if values is None:
        others = [k for k in range(len(file.heads)) if k != first]
        if len(others) != 1:
            listed = ", ".join(f"`{name}`" for name, _ in file.heads)
            raise Wrong("LAG0210", f"choose a column; the file has {listed}", data.span)
        second = others[0]
    else:
        second = _place(file, values)
    columns = _column_in_unit(file, first, over or data), _column_in_unit(file, second, values or data)
    check_order(columns[0].numbers, data.span, [line for line, _ in file.rows])
    return (*columns, file.heads[second][0])


def _place(file: Columns, asked: Argument) -> int:
    if not isinstance(asked.value, Text):
        message = f"write the name of a column as a text; this is {kind(asked.value)}"
        raise Wrong("LAG0307", message, asked.span)
    found = file.place(asked.value.text)
    if found is None:
        names = [name for name, _ in file.heads]
        listed = "the columns are " + ", ".join(f"`{name}`" for name in names[:12])
        remedy = did_you_mean(asked.value.text, names) or listed
        raise Wrong("LAG0314", f"the file has no column `{asked.value.text}`", asked.span, remedy)
    return found


def _column_in_unit(file: Columns, k: int, asked: Argument) -> Column:
    name, said = file.heads[k]
    try:
        numbers, meant = file.numbers(k), None if said is None else unit(said)
    except Unfit as error:
        raise Wrong("LAG0314", f"the file {error}", asked.span, error.remedy) from None
    except UnknownUnit as unknown:
        from lagc.semantics.values.unit_hints import spelling_remedy  # where there is a fault

        message, remedy = f"the column `{name}`: {unknown.reason}", spelling_remedy(unknown.text)
        raise Wrong("LAG0304", message, asked.span, remedy) from None
    if meant is None:
        return Column(numbers, NONE, True)
    numbers = [meant.to_si(x) for x in numbers] if meant.factor != 1.0 else numbers
    if not all(map(math.isfinite, numbers)):
        raise Wrong("LAG0309", f"a number of the column `{name}` is too large", asked.span)
    return Column(numbers, meant.dimension, False)
