"""What an expression of a model can be, and the faults of evaluating one."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, TypeAlias

from lagc.base.records import dataclass
from lagc.diagnostics.faults import Fault, Span
from lagc.semantics.model import Body, Frame, Orientation
from lagc.semantics.types.types import describe
from lagc.semantics.types.units import NONE, Dimension, M, over, si_text
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.vectors import Vector

if TYPE_CHECKING:
    from lagc.semantics.names.scope import Entry, Instance


@dataclass(frozen=True, slots=True)
class Scalar:
    """A number with a dimension; `dimension` None is that of 0, which fits all.  `bare`: it is made of data
    without a unit."""

    node: Node
    dimension: Dimension | None
    bare: bool = False


@dataclass(frozen=True, slots=True)
class Array:
    """Elements 1..n; three scalars are a vector in world axes, three vectors a matrix by rows."""

    elements: tuple[Value, ...]


@dataclass(frozen=True, slots=True)
class Truth:
    """A condition."""

    node: Node


@dataclass(frozen=True, slots=True)
class Text:
    text: str


@dataclass(frozen=True, slots=True)
class Indexed:
    """Things that were declared with subscripts: `point P[0] = ...; body b[i] = ...`."""

    entry: Entry


@dataclass(frozen=True, slots=True)
class Thing:
    """A declaration that is no quantity: a constraint, a force, an effect, ..."""

    entry: Entry


@dataclass(frozen=True, slots=True)
class Part:
    """An instance of a model."""

    instance: Instance


Value: TypeAlias = Scalar | Array | Truth | Text | Indexed | Thing | Part | Body | Frame | Orientation

_KINDS: dict[type, str] = {
    Scalar: "a number", Array: "an array", Truth: "a condition", Text: "a text",
    Indexed: "an array of things",
    Part: "an instance of a model", Body: "a body", Frame: "a frame", Orientation: "an orientation",
}  # fmt: skip


_NUMBER = re.compile(r"(?<![\w.\[^])(?!0(?![\d.]))\d")  # but 0, subscripts and exponents, which take no unit
_AS_NUMBER = "write `if condition then 1 else 0`"


def kind(value: Value) -> str:
    """In words, for messages."""
    if isinstance(value, Thing):
        return f"a {value.entry.kind}"
    if isinstance(value, Array) and len(value.elements) == 3 and isinstance(value.elements[0], Scalar):
        return "a vector"
    return _KINDS[type(value)]


class Wrong(Exception):
    """Evaluation stops here with a fault."""

    def __init__(
        self, code: str, message: str, span: Span | None, remedy: str | None = None,
        related: tuple[tuple[Span, str], ...] = (),
    ):  # fmt: skip
        self.fault = Fault(code, message, span, related, remedy)
        super().__init__(message)


class Poisoned(Exception):
    """Evaluation stops here because of a fault that has been reported already."""


def vector_of(value: Value, span: Span, what: str) -> tuple[Vector, Dimension | None]:
    """The three components (world axes) and their dimension.  Raises Wrong."""
    if isinstance(value, Body):
        return value.position, M
    if isinstance(value, Array) and len(value.elements) == 3:
        a, b, c = value.elements
        if isinstance(a, Scalar) and isinstance(b, Scalar) and isinstance(c, Scalar):
            return (a.node, b.node, c.node), common_dimension((a, b, c), span)
    size = f" of {len(value.elements)} elements" if isinstance(value, Array) else ""
    raise Wrong("LAG0306", f"{what} is a vector {{x, y, z}}, this is {kind(value)}{size}", span)


def numbers_of(value: Value, span: Span, what: str) -> tuple[tuple[Node, ...], Dimension | None]:
    """The components of a vector, or the elements of an array, one at least, and their dimension.
    Raises Wrong."""
    if isinstance(value, Array) and len(value.elements) != 3:
        scalars = tuple([x for x in value.elements if isinstance(x, Scalar)])
        if scalars and len(scalars) == len(value.elements):
            return tuple([x.node for x in scalars]), common_dimension(scalars, span)
    return vector_of(value, span, what)


def common_dimension(scalars: tuple[Scalar, ...], span: Span) -> Dimension | None:
    """The one dimension of all.  Raises Wrong."""
    found: Dimension | None = None
    for scalar in scalars:
        if scalar.dimension is None:
            continue
        if found is not None and found != scalar.dimension:
            message = (
                f"the components differ in dimension: {describe(found)} and {describe(scalar.dimension)}"
            )
            raise Wrong("LAG0301", message, span)
        found = scalar.dimension
    return found


def scalar_of(value: Value, span: Span, what: str) -> Scalar:
    if isinstance(value, Scalar):
        return value
    remedy = _AS_NUMBER if isinstance(value, Truth) else None
    raise Wrong("LAG0307", f"{what} is a number, this is {kind(value)}", span, remedy)


def expect(
    dimension: Dimension | None, wanted: Dimension, span: Span | None, what: str, named: str | None = None
) -> None:
    """Raises Wrong where `what` has another dimension than it should, which messages call `named`."""
    if dimension is not None and dimension != wanted:
        message = f"{what} is {named or describe(wanted)}, this is {describe(dimension)}"
        raise Wrong("LAG0302", message, span, _to_fit(wanted, dimension, span))


def _to_fit(wanted: Dimension, found: Dimension, span: Span | None) -> str:
    """What to write where something of dimension `found` stands."""
    unit = f"[{si_text(wanted)}]"
    written = span.source.text[span.start : span.end] if span else ""
    plain = re.sub(r'"[^"]*"', '""', written)  # names of files and columns are no numbers
    if found == NONE and written.startswith("{") and written.endswith("}") and "table(" not in plain:
        return f"give all of it a unit behind the braces: `{{...}} {unit}`"
    if found == NONE and (not span or _NUMBER.search(plain)):
        return f"give a number in it its unit, such as `1 {unit}`"
    if found == NONE and "table(" in plain and '""' in plain:
        return f"give the columns their unit in the first line of the file, as `u {unit}`"
    literal = re.fullmatch(r"[-+.\w]+\s*(\[[^\]]*\])", written)
    if literal is None:
        return f"a factor in `[{si_text(over(wanted, found))}]` is missing in it"
    if wanted == NONE:
        return f"leave out `{literal[1]}`"
    return f"write `{unit}` in place of `{literal[1]}`"


def flat(value: Value, span: Span, what: str) -> list[Scalar]:
    """All scalars of a number or an array of numbers, rows first."""
    if isinstance(value, Scalar):
        return [value]
    if isinstance(value, Array):
        return [s for element in value.elements for s in flat(element, span, what)]
    remedy = _AS_NUMBER if isinstance(value, Truth) else None
    raise Wrong("LAG0307", f"{what} is a number or an array of numbers, this is {kind(value)}", span, remedy)


def shape(value: Value) -> list[int]:
    """The sizes of an array, rows first; [] for a number."""
    found: list[int] = []
    while isinstance(value, Array):
        found.append(len(value.elements))
        if not value.elements:
            break
        value = value.elements[0]
    return found


def vector_value(vector: Vector, dimension: Dimension | None) -> Array:
    return Array(tuple(Scalar(node, None if node.is_zero else dimension) for node in vector))


def constant(graph: Graph, value: float, dimension: Dimension | None) -> Scalar:
    return Scalar(graph.const(value), None if value == 0 else dimension)
