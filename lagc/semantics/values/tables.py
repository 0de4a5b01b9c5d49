"""Tables that interpolate data: points in the text, or columns of a file."""

import math
import re
from collections.abc import Sequence
from itertools import pairwise

from lagc.base.records import dataclass
from lagc.diagnostics.faults import Span, Wrong
from lagc.diagnostics.suggest import did_you_mean
from lagc.semantics import model as objects
from lagc.semantics.context import Context, Points
from lagc.semantics.names.namespace import Columns, Unfit
from lagc.semantics.names.scope import Array, Scalar, Text, Value, common_dimension, kind, scalar_of
from lagc.semantics.units import NONE, Dimension, UnknownUnit, describe, unit
from lagc.semantics.values.evaluate import Argument
from lagc.symbolic.graph import Node
from lagc.symbolic.interpolants import KINDS, interpolant, key_of

BEYOND = ("hold", "line")


@dataclass(frozen=True, slots=True)
class Column:
    """Numbers in SI with a common dimension, NONE if no unit is given."""

    numbers: Sequence[float]
    dimension: Dimension
    bare: bool


def table(
    context: Context, x: Argument, data: Argument, values: Argument | None,
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
