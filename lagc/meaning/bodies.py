"""What carries inertia: particles and solids; and gravity, which acts on all of them."""

from __future__ import annotations

from lagc.diagnostics.faults import Span
from lagc.expr.graph import Node
from lagc.expr.vectors import dot
from lagc.frontend import tree
from lagc.meaning import model as nouns
from lagc.meaning.calls import match
from lagc.meaning.clock import LATE, VELOCITY
from lagc.meaning.context import Context
from lagc.meaning.evaluate import each, evaluate, evaluate_as
from lagc.meaning.functions import Argument, unit_vector
from lagc.meaning.motion import velocity_of
from lagc.meaning.quantities import given_scalar
from lagc.meaning.scope import Entry, Environment
from lagc.meaning.units import KG, NONE, Dimension, M, S, dimension, over
from lagc.meaning.values import Array, Scalar, Thing, Value, Wrong, expect, flat, kind, scalar_of, vector_of

INERTIA = dimension(kg=1, m=2)
GRAVITY = over(M, (0, 0, 2 * S[2], 0, 0, 0, 0))
STANDARD = 9.81  # m/s2, where a model says nothing else

_PARAMETERS = {
    "Particle": (("mass", "at"), 2),
    "Solid": (("mass", "inertia", "frame", "com", "at"), 3),
}


def declare_body(context: Context, entry: Entry) -> Value:
    """A particle or a solid.  Raises Wrong."""
    call = _call_of(entry)
    if not isinstance(call.function, tree.Name) or call.function.name not in _PARAMETERS:
        raise Wrong("LAG0221", "a body is a `Particle(...)` or a `Solid(...)`", call.function.span)
    name = call.function.name
    parameters, required = _PARAMETERS[name]
    written = dict(zip(parameters, match(call, parameters, required, f"`{name}`")))
    own = {**written, **_modified(entry, parameters)}
    reader = _Reader(context, entry.environment, own)
    if name == "Particle":
        jobs = each(context, [lambda: reader.scalar("mass", KG), lambda: reader.place("at")])
        mass, position = jobs
        return _body(context, entry, mass, position, None, None)  # type: ignore[arg-type]
    if own["com"] is None and own["at"] is None:
        raise Wrong("LAG0210", "`Solid` needs the argument `com`, its centre of mass", call.span,
                    "write `com = {0, 0, 0}` where that is the origin")  # fmt: skip
    if own["com"] is not None and own["at"] is not None:
        raise Wrong("LAG0209", "`com` and `at` are the same, give one", own["at"].span)
    mass, position, frame, inertia = each(context, [
        lambda: reader.scalar("mass", KG), lambda: reader.place("com" if own["com"] is not None else "at"),
        lambda: reader.frame("frame"), lambda: reader.inertia("inertia"),
    ])  # fmt: skip
    return _body(context, entry, mass, position, frame, inertia)  # type: ignore[arg-type]


def _call_of(entry: Entry) -> tree.Call:
    source = entry.source
    if isinstance(source, tree.Declarator):  # `Solid crank(mass = ...)`
        assert isinstance(entry.declaration, tree.Instance)
        name = entry.declaration.type
        if source.value is not None:
            raise Wrong("LAG0209", f"`{entry.name}` takes its data in parentheses", source.value.span)
        return tree.Call(tree.Name(name.path[0], name.span), source.arguments, source.span)
    assert isinstance(source, tree.Construct)
    if not isinstance(source.value, tree.Call):
        raise Wrong("LAG0221", "a body is a `Particle(...)` or a `Solid(...)`", source.value.span)
    return source.value


def _modified(entry: Entry, parameters: tuple[str, ...]) -> dict[str, tree.Expression]:
    for modifier in entry.modifiers:
        raise Wrong("LAG0209", f"the body `{entry.name}` cannot be modified from outside", modifier.argument.span,
                    "modify the parameters that it is made of")  # fmt: skip
    return {}


class _Reader:
    """The arguments of a body, read one by one."""

    def __init__(self, context: Context, environment: Environment, written: dict[str, tree.Expression | None]):
        self.context = context
        self.environment = environment
        self.written = written

    def _expression(self, name: str) -> tree.Expression:
        expression = self.written[name]
        assert expression is not None
        return expression

    def scalar(self, name: str, meant: Dimension) -> Node:
        expression = self._expression(name)
        value = scalar_of(evaluate_as(self.context, expression, self.environment, meant), expression.span, f"`{name}`")
        expect(value.dimension, meant, expression.span, f"`{name}`")
        if value.node.is_const and value.node.value < 0:  # type: ignore[operator]
            raise Wrong("LAG0308", f"`{name}` is negative", expression.span)
        return value.node

    def place(self, name: str) -> Argument:
        expression = self._expression(name)
        value = evaluate_as(self.context, expression, self.environment, M)
        vector, found = vector_of(value, expression.span, f"`{name}`")
        expect(found, M, expression.span, f"`{name}`")
        for node in vector:
            if self.context.clock.mask(node) & (LATE | VELOCITY):
                raise Wrong("LAG0313", "a position depends on no rate", expression.span)
        return Argument(value, expression.span)

    def frame(self, name: str) -> nouns.Frame:
        expression = self._expression(name)
        value = evaluate(self.context, expression, self.environment)
        if not isinstance(value, nouns.Frame):
            raise Wrong("LAG0221", f"`{name}` is a frame, this is {kind(value)}", expression.span)
        return value

    def inertia(self, name: str) -> nouns.Matrix:
        expression = self._expression(name)
        value = evaluate_as(self.context, expression, self.environment, INERTIA)
        for scalar in flat(value, expression.span, "an inertia"):
            expect(scalar.dimension, INERTIA, expression.span, "an inertia")
        return _matrix(self.context, value, expression.span)


def _matrix(context: Context, value: Value, span: Span) -> nouns.Matrix:
    """Principal moments {I1, I2, I3}, or a symmetric matrix by rows."""
    zero = context.graph.zero
    rows = value.elements if isinstance(value, Array) else ()
    if len(rows) == 3 and all(isinstance(r, Scalar) for r in rows):
        a, b, c = [r.node for r in rows if isinstance(r, Scalar)]
        _check_principal(a, b, c, span)
        return ((a, zero, zero), (zero, b, zero), (zero, zero, c))
    if len(rows) == 3 and all(isinstance(r, Array) and len(r.elements) == 3 for r in rows):
        (a, d, e), (f, b, g), (h, i, c) = (vector_of(row, span, "a row of the inertia")[0] for row in rows)
        if (d, e, g) != (f, h, i):
            raise Wrong("LAG0306", "an inertia matrix is symmetric, this one is not", span)
        return ((a, d, e), (d, b, g), (e, g, c))
    raise Wrong("LAG0306", "an inertia is {I1, I2, I3} or a matrix of 3 x 3", span)


def _check_principal(a: Node, b: Node, c: Node, span: Span) -> None:
    if a.is_const and b.is_const and c.is_const:
        values = sorted(float(x.value) for x in (a, b, c))  # type: ignore[arg-type]
        if values[0] < 0 or values[2] > (values[0] + values[1]) * (1 + 1e-9):
            raise Wrong("LAG0308", "no body has these moments of inertia: each is at most the sum of the others", span)


def _body(
    context: Context, entry: Entry, mass: Node, place: Argument, frame: nouns.Frame | None, inertia: nouns.Matrix | None
) -> Value:
    position, _ = vector_of(place.value, place.span, "a position")
    body = nouns.Body(entry.path, mass, position, velocity_of(context, place, None), frame, inertia, entry.span, entry.effect)
    entry.nouns.append(body)
    return body


def declare_gravity(context: Context, entry: Entry) -> Value:
    """`Gravity field(g = ..., direction = ...)`: V = -m g d . r for every body of the instance it is
    declared in and of the instances within.  Its strength is the parameter `field.g`."""
    source = entry.source
    assert isinstance(source, tree.Declarator)
    call = tree.Call(tree.Name("Gravity", source.name_span), source.arguments, source.span)
    strength, way = match(call, ("g", "direction"), 0, "`Gravity`")
    if entry.modifiers:
        raise Wrong("LAG0209", f"`{entry.name}` cannot be modified from outside", entry.modifiers[0].argument.span)
    g = _strength(context, entry, strength)
    graph = context.graph
    direction: nouns.Vector = (graph.zero, graph.zero, graph.const(-1.0))
    if way is not None:
        vector, found = vector_of(evaluate(context, way, entry.environment), way.span, "a direction")
        expect(found, NONE, way.span, "a direction")
        direction = unit_vector(vector, way.span)
    total = graph.zero
    for other in entry.environment.instance.in_order():
        if other.kind == "body" and other.elements is None:
            body = context.value(other, other.span)
            assert isinstance(body, nouns.Body)
            total = total - body.mass * g * dot(direction, body.position)
    entry.nouns.append(nouns.Potential(entry.path, total, entry.span, entry.effect))
    return Thing(entry)


def _strength(context: Context, entry: Entry, written: tree.Expression | None) -> Node:
    name = f"{entry.path}.g"
    given = context.give(context.parameters, name)
    value: Scalar
    if given is not None:
        value = given_scalar(context, given, GRAVITY, f"`{name}`")
    elif written is not None:
        value = scalar_of(evaluate_as(context, written, entry.environment, GRAVITY), written.span, "`g`")
        expect(value.dimension, GRAVITY, written.span, "`g`")
    else:
        value = Scalar(context.graph.const(STANDARD), GRAVITY)
    if not value.node.is_const:
        return value.node
    symbol = context.graph.symbol("parameter", name)
    number = value.node.value
    assert isinstance(number, float)
    entry.nouns.append(nouns.Parameter(
        name, symbol, "m/s2", "m/s2", number, float("-inf"), float("inf"), entry.span, "acceleration of gravity"))  # fmt: skip
    return symbol
