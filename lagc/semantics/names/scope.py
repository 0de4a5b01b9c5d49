"""Scopes of a model and the values of its expressions.

An `Instance` holds each declaration under its full name as an `Entry`.  An `Environment` is where a name is
looked up.  A `Modifier` changes a declaration from outside.  Instantiation evaluates only loop ranges and
array sizes.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, TypeAlias

from lagc.base.records import dataclass, field
from lagc.diagnostics.faults import Span, Wrong
from lagc.semantics.model import Body, Frame, Orientation
from lagc.semantics.names.namespace import Namespace
from lagc.semantics.units import NONE, Dimension, M, describe, over, si_text
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.vectors import Vector
from lagc.syntax import tree

if TYPE_CHECKING:
    from lagc.semantics import model as objects

LARGEST = 200_000  # declarations, with loops and arrays expanded
DEEPEST = 64  # nesting of instances
LONGEST_SHOWN = 40  # characters of an expression that a remedy repeats


@dataclass(frozen=True, slots=True)
class Environment:
    """The place where names are looked up: bindings (loop variables, function arguments), then the instance,
    then the namespace."""

    instance: Instance
    space: Namespace
    bindings: dict[str, Value] = field(default_factory=dict)

    def bind(self, names: dict[str, Value]) -> Environment:
        return Environment(self.instance, self.space, {**self.bindings, **names})


@dataclass(frozen=True, slots=True)
class Modifier:
    """An argument that changes a declaration from outside, evaluated where it was written. `index` selects
    one element of it, for arrays of instances."""

    argument: tree.Argument
    environment: Environment
    index: tuple[int, ...] = ()


Modifiers: TypeAlias = dict[str, list[Modifier]]  # the first of a list wins

Source: TypeAlias = (
    tree.Declarator
    | tree.Construct
    | tree.Placeholder
    | tree.Load
    | tree.Constraint
    | tree.FunctionDeclaration
    | tree.TypeDeclaration
    | tree.Effect
)


class Entry:
    """One declared name of an instance."""

    __slots__ = (
        "declaration", "effect", "elements", "environment", "inner", "kind", "modifiers", "name", "objects",
        "parts", "path", "size", "source", "state", "subscript", "value",
    )  # fmt: skip

    def __init__(
        self, kind: str, name: str, declaration: tree.Declaration, source: Source,
        environment: Environment, effect: str | None,
    ):  # fmt: skip
        self.kind = kind
        self.name = name
        self.path = environment.instance.path + name
        self.declaration = declaration
        self.source = source
        self.environment = environment
        self.effect = effect
        self.modifiers: list[Modifier] = []
        self.elements: dict[tuple[int, ...], Entry] | None = None
        self.subscript: tuple[int, ...] = ()
        self.inner: list[Entry] = []  # coordinates of a joint
        self.size: int | None = None  # number of components of a vector constraint
        self.state = "new"  # running, done, poisoned
        self.value: Value | None = None
        self.objects: list[objects.ModelObject] = []
        self.parts: dict[str, Value] = {}  # members, such as the strength `g` of gravity

    @property
    def span(self) -> Span:
        return self.source.name_span

    def member(self, subscript: tuple[int, ...]) -> str:
        """Return the full name of an element, or of the whole if there is no subscript."""
        return self.path + (f"[{','.join(str(n) for n in subscript)}]" if subscript else "")


Item: TypeAlias = "Entry | list[Item]"


class Instance:
    """A model with the declarations that the chosen scene keeps."""

    def __init__(
        self, path: str, declaration: tree.ModelDeclaration, parent: Instance | None, depth: int = 0
    ):
        self.path = path  # "" or "a.b[2]."
        self.declaration = declaration
        self.parent = parent
        self.depth = depth
        self.entries: dict[str, Entry] = {}
        self.items: list[Item] = []  # in order of declaration
        self.effects: dict[str, tree.Effect] = {}
        self.unused: dict[str, str] = {}  # name of a missing declaration -> reason
        self.conditions: list[tuple[tree.Condition, Environment]] = []

    def in_order(self) -> list[Entry]:
        """Return all entries in order of declaration, with array elements and nested instances at their
        places."""
        found: list[Entry] = []
        stack: list[Item] = [self.items]
        while stack:
            item = stack.pop()
            if isinstance(item, list):
                stack.extend(reversed(item))
            else:
                found.append(item)
        return found


# model (by identity) -> its base models, with the modifiers it gives them
Extended: TypeAlias = dict[int, list[tuple[tree.ModelDeclaration, Modifiers]]]


def modifiers_of(arguments: Iterable[tree.Argument], environment: Environment) -> Modifiers:
    """Return the arguments of an instance or of `extends`, by name.  Raises Wrong."""
    found: Modifiers = {}
    for argument in map(_as_modification, arguments):
        if argument.name is None:
            raise Wrong("LAG0209", "an argument of a model needs a name: `name = value`", argument.span)
        if argument.name in found:
            raise Wrong("LAG0209", f"`{argument.name}` is given twice", argument.span)
        found[argument.name] = [Modifier(argument, environment)]
    return found


def _as_modification(argument: tree.Argument) -> tree.Argument:
    """Return `a(m = 5)`, which parses as a call, as a modification of the members of `a`."""
    call = argument.value
    if argument.name is None and isinstance(call, tree.Call) and isinstance(call.function, tree.Name):
        name = call.function
        return tree.Argument(name.name, name.span, None, argument.span, argument.each, call.arguments)
    return argument


def outermost_first(model: tree.ModelDeclaration, extended: Extended) -> Iterator[tuple[str, Modifier]]:
    """Yield all modifiers that a model and its base models give to their own base models. Modifiers of a
    model come before those of its bases; otherwise the order of the text is kept."""
    done: set[int] = set()
    order: list[int] = []  # the innermost first, in reverse order of the text

    def visit(key: int) -> None:
        if key not in done:
            done.add(key)
            for base, _ in reversed(extended.get(key, [])):
                visit(id(base))
            order.append(key)

    visit(id(model))
    for key in reversed(order):
        for _, modifiers in extended.get(key, []):
            for name, given in modifiers.items():
                yield from ((name, modifier) for modifier in given)


def subscripts(sizes: list[int], span: Span) -> list[tuple[int, ...]]:
    """Return (1, 1), (1, 2) ... for an array of these sizes.  Raises Wrong."""
    found: list[tuple[int, ...]] = [()]
    for size in sizes:
        if size < 0:
            raise Wrong("LAG0207", f"the size of an array is negative: {size}", span)
        if len(found) * size > LARGEST:
            raise Wrong("LAG0218", f"the array has more than {LARGEST} elements", span)
        found = [(*before, n) for before in found for n in range(1, size + 1)]
    return found


@dataclass(frozen=True, slots=True)
class Scalar:
    """A number with a dimension (None for 0, which fits any).  `bare`: it comes from data without a unit."""

    node: Node
    dimension: Dimension | None
    bare: bool = False


@dataclass(frozen=True, slots=True)
class Array:
    """Elements 1..n; three scalars are a vector in world axes, three vectors a matrix by rows."""

    elements: tuple[Value, ...]


@dataclass(frozen=True, slots=True)
class Wrench:
    """A force and its moment, vectors in world axes."""

    force: Array
    moment: Array


@dataclass(frozen=True, slots=True)
class Truth:
    node: Node


@dataclass(frozen=True, slots=True)
class Text:
    text: str


@dataclass(frozen=True, slots=True)
class Indexed:
    """Declarations with subscripts: `point P[0] = ...; body b[i] = ...`."""

    entry: Entry


@dataclass(frozen=True, slots=True)
class Reference:
    """A declaration that is not a quantity: a constraint, a force, an effect, ..."""

    entry: Entry


@dataclass(frozen=True, slots=True)
class Part:
    """An instance of a model."""

    instance: Instance


Value: TypeAlias = (
    Scalar | Array | Wrench | Truth | Text | Indexed | Reference | Part | Body | Frame | Orientation
)

_KINDS: dict[type, str] = {
    Scalar: "a number", Array: "an array", Wrench: "a force with its moment",
    Truth: "a condition", Text: "a text", Indexed: "an array of things",
    Part: "an instance of a model", Body: "a body", Frame: "a frame", Orientation: "an orientation",
}  # fmt: skip


_NUMBER = re.compile(r"(?<![\w.\[^])(?!0(?![\d.]))\d")  # not 0, subscripts or exponents, which have no unit
_AS_NUMBER = "write `if condition then 1 else 0`"


def kind(value: Value) -> str:
    """Return the kind of a value in words, for messages."""
    if isinstance(value, Reference):
        return f"a {value.entry.kind}"
    if isinstance(value, Array) and len(value.elements) == 3 and isinstance(value.elements[0], Scalar):
        return "a vector"
    return _KINDS[type(value)]


def vector_of(
    value: Value, span: Span, what: str, along: str | None = None
) -> tuple[Vector, Dimension | None]:
    """Return the three components (world axes) and their dimension.  Raises Wrong, for a number with the
    remedy `along`."""
    if isinstance(value, Body):
        return value.position, M
    if isinstance(value, Array) and len(value.elements) == 3:
        a, b, c = value.elements
        if isinstance(a, Scalar) and isinstance(b, Scalar) and isinstance(c, Scalar):
            return (a.node, b.node, c.node), common_dimension((a, b, c), span)
    size = f" of {len(value.elements)} elements" if isinstance(value, Array) else ""
    remedy = None
    if isinstance(value, Scalar) and len(span.text) <= LONGEST_SHOWN and "\n" not in span.text:
        remedy = along or f"for a vector along x write `{{{span.text}, 0, 0}}`"
    elif isinstance(value, Array) and len(value.elements) == 2 and len(span.text) <= LONGEST_SHOWN:
        whole = span.text.startswith("{") and span.text.endswith("}")
        remedy = f"a vector has three components: write `{span.text[:-1]}, 0}}`" if whole else None
    elif isinstance(value, Wrench) and len(span.text) <= LONGEST_SHOWN:
        remedy = f"write `{span.text}.force` or `{span.text}.moment`"
    raise Wrong("LAG0306", f"{what} must be a vector {{x, y, z}}; this is {kind(value)}{size}", span, remedy)


def numbers_of(value: Value, span: Span, what: str) -> tuple[tuple[Node, ...], Dimension | None]:
    """Return the components of a vector or the elements of a non-empty array, and their dimension.  Raises
    Wrong."""
    if isinstance(value, Array) and len(value.elements) != 3:
        scalars = tuple([x for x in value.elements if isinstance(x, Scalar)])
        if scalars and len(scalars) == len(value.elements):
            return tuple([x.node for x in scalars]), common_dimension(scalars, span)
    return vector_of(value, span, what)


def common_dimension(scalars: tuple[Scalar, ...], span: Span) -> Dimension | None:
    """Return the common dimension of `scalars`.  Raises Wrong if they differ."""
    found: Dimension | None = None
    for scalar in scalars:
        if scalar.dimension is None:
            continue
        if found is not None and found != scalar.dimension:
            one, other = describe(found), describe(scalar.dimension)
            message = f"the components have different dimensions: {one} and {other}"
            raise Wrong("LAG0301", message, span)
        found = scalar.dimension
    return found


def scalar_of(value: Value, span: Span, what: str) -> Scalar:
    if isinstance(value, Scalar):
        return value
    remedy = _AS_NUMBER if isinstance(value, Truth) else None
    raise Wrong("LAG0307", f"{what} must be a number; this is {kind(value)}", span, remedy)


def expect(
    dimension: Dimension | None, wanted: Dimension, span: Span | None, what: str, named: str | None = None
) -> None:
    """Raise Wrong if `what` has another dimension than `wanted`; `named` is its name in the message."""
    if dimension is not None and dimension != wanted:
        message = f"{what} must be {named or describe(wanted)}; this is {describe(dimension)}"
        raise Wrong("LAG0302", message, span, _to_fit(wanted, dimension, span))


def scalar_in(dimension: Dimension, value: Value, span: Span, what: str) -> Node:
    """Return the node of a number of this dimension.  Raises Wrong."""
    scalar = scalar_of(value, span, what)
    expect(scalar.dimension, dimension, span, what)
    return scalar.node


def vector_in(dimension: Dimension, value: Value, span: Span, what: str, role: str | None = None) -> Vector:
    """Return the components of a vector of this dimension; `role` is its name if the dimension is another.
    Raises Wrong."""
    vector, found = vector_of(value, span, what)
    expect(found, dimension, span, role or what)
    return vector


def _to_fit(wanted: Dimension, found: Dimension, span: Span | None) -> str:
    """Return a remedy for a value of dimension `found`."""
    unit = f"[{si_text(wanted)}]"
    written = span.source.text[span.start : span.end] if span else ""
    plain = re.sub(r'"[^"]*"', '""', written)  # without names of files and columns
    if found == NONE and written.startswith("{") and written.endswith("}") and "table(" not in plain:
        return f"write a unit after the braces: `{{...}} {unit}`"
    if found == NONE and (not span or _NUMBER.search(plain)):
        return f"give a number in it a unit, such as `1 {unit}`"
    if found == NONE and "table(" in plain and '""' in plain:
        return f"write the unit of each column in the first line of the file: `u {unit}`"
    literal = re.fullmatch(r"[-+.\w]+\s*(\[[^\]]*\])", written)
    if literal is None:
        return f"a factor with the unit `[{si_text(over(wanted, found))}]` is missing"
    if wanted == NONE:
        return f"leave out `{literal[1]}`"
    return f"write `{unit}` instead of `{literal[1]}`"


def flat(value: Value, span: Span, what: str) -> list[Scalar]:
    """Return all scalars of a number or an array of numbers, rows first."""
    if isinstance(value, Scalar):
        return [value]
    if isinstance(value, Array):
        return [s for element in value.elements for s in flat(element, span, what)]
    remedy = _AS_NUMBER if isinstance(value, Truth) else None
    if isinstance(value, Wrench):
        remedy = f"write `{span.text}.force` or `{span.text}.moment`"
    raise Wrong(
        "LAG0307", f"{what} must be a number or an array of numbers; this is {kind(value)}", span, remedy
    )


def shape(value: Value) -> list[int]:
    """Return the sizes of an array, rows first; [] for a number."""
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


_SUBSCRIPT = re.compile(r"\[[^]]*\]")


@dataclass(frozen=True, slots=True)
class Uses:
    """The effects in use: those of the scene, and those that the run adds and removes. An effect is named by
    its path, `cars[2].drag`, by `cars.drag` for all elements of an array, or by `drag` for all instances.
    The run overrides the scene, and a path overrides a shorter name."""

    named: frozenset[str] = frozenset()
    added: frozenset[str] = frozenset()
    removed: frozenset[str] = frozenset()

    @property
    def mentioned(self) -> frozenset[str]:
        return self.named | self.added | self.removed

    def has(self, path: str) -> bool:
        for key in keys(path):
            if key in self.removed:
                return False
            if key in self.added:
                return True
        return not self.named.isdisjoint(keys(path))

    def has_beside(self, place: str, name: str) -> bool:
        """Return whether the effect `name` of the instance at `place`, or of all instances, is in use."""
        return self.has(place + name) or ("." in name and self.has(name))


def keys(path: str) -> Iterator[str]:
    """Yield the names of an effect, the most specific first."""
    yield path
    yield without_subscripts(path)
    yield path.rpartition(".")[2]


def without_subscripts(path: str) -> str:
    """Return a path without subscripts, which names all elements of arrays."""
    return _SUBSCRIPT.sub("", path)
