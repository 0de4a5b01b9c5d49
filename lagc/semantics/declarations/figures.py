"""Declarations of figures, which are drawn in animations and are part of no equation."""

from collections.abc import Sequence

from lagc.diagnostics.faults import Wrong
from lagc.diagnostics.suggest import did_you_mean
from lagc.semantics import model as objects
from lagc.semantics.context import MOVING, Context
from lagc.semantics.declarations.actions import refuse_late
from lagc.semantics.declarations.attributes import no_modifiers, no_rates
from lagc.semantics.names.scope import Array, Entry, Reference, Value, expect, flat, kind, vector_in
from lagc.semantics.units import NONE, M
from lagc.semantics.values.calls import match
from lagc.semantics.values.evaluate import Argument, each, evaluate_as
from lagc.semantics.values.frame_vectors import unit_vector
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import Vector
from lagc.syntax import tree

_SIZES = {"radius": 1, "length": 1, "size": 3}  # numbers of each argument
PARAMETERS = {
    "Ball": ("on", "radius"),
    "Box": ("on", "size"),
    "Cylinder": ("on", "axis", "radius", "length"),
    "Ring": ("on", "axis", "radius"),
    "Plane": ("on", "axis"),
    "Line": ("*",),  # its points
    "Coil": ("*",),
}


def declare_figure(context: Context, entry: Entry) -> Value:
    """Declare `draw wheel = Cylinder(on = disc, axis = disc_frame.y, radius = r, length = 2 [cm]);`.  Raises
    Wrong."""
    no_modifiers(entry)
    assert isinstance(entry.source, tree.Construct)
    call = entry.source.value
    name = call.function.span.text if isinstance(call, tree.Call) else ""
    if not isinstance(call, tree.Call) or name not in PARAMETERS:
        remedy = did_you_mean(name, PARAMETERS)
        message = f"a figure is one of {', '.join(f'`{each}`' for each in PARAMETERS)}"
        raise Wrong("LAG0221", message, entry.source.value.span, remedy)
    parameters = PARAMETERS[name]
    written = match(context, call, parameters, len(parameters), f"`{name}`")

    def argument_of(k: int) -> Argument:
        expression = written[k]
        assert expression is not None
        meant = NONE if parameters[min(k, len(parameters) - 1)] == "axis" else M
        return Argument(evaluate_as(context, expression, entry.environment, meant), expression.span)

    # All arguments are evaluated, so that all their faults are reported, before any is looked at.
    values = each(context, argument_of, range(len(written)))
    given = dict(zip(parameters, values))
    body, points = (
        _through(context, values, call) if "*" in parameters else _place(context, name, given["on"])
    )
    axis = _axis(context, given["axis"]) if "axis" in given else None
    sizes = [x for part in parameters if part in _SIZES for x in _lengths(context, part, given[part])]
    if name == "Plane":
        for node in (*points[0], *(axis or ())):
            _at_rest(context, node, entry.source.value, "a plane that is drawn")
    figure = objects.Figure(entry.path, name, body, points, axis, tuple(sizes), entry.span, entry.effect)
    entry.objects.append(figure)
    return Reference(entry)


def _through(context: Context, values: Sequence[Argument], call: tree.Call) -> tuple[str, tuple[Vector, ...]]:
    """Return "" and the points of a line, each a body, a point, or an array of points."""
    points: list[Vector] = []
    for given in values:
        several = isinstance(given.value, Array) and isinstance(given.value.elements[0], Array)
        elements = given.value.elements if several and isinstance(given.value, Array) else (given.value,)
        points += [_point(context, Argument(value, given.span)) for value in elements]
    if len(points) < 2:
        remedy = "write them in a row: `Line(A, B)`"
        raise Wrong("LAG0210", "a line leads through two points or more", call.span, remedy)
    return "", tuple(points)


def _place(context: Context, name: str, on: Argument) -> tuple[str, tuple[Vector, ...]]:
    """Return the body that carries a figure, "" if it stands at a point, and its place."""
    body = on.value if isinstance(on.value, objects.Body) else None
    if name == "Box" and (body is None or body.frame is None):
        raise Wrong("LAG0221", f"a box turns with a solid; this is {kind(on.value)}", on.span)
    return body.name if body is not None and name != "Plane" else "", (_point(context, on),)


def _point(context: Context, given: Argument) -> Vector:
    vector = vector_in(M, given.value, given.span, "a point")
    for node in vector:
        no_rates(context, node, given.span, "a point")
        refuse_late(context, node, given.span, "a point")
    return vector


def _axis(context: Context, given: Argument) -> Vector:
    vector = vector_in(NONE, given.value, given.span, "an axis")
    for node in vector:
        no_rates(context, node, given.span, "an axis")
        refuse_late(context, node, given.span, "an axis")
    return unit_vector(context, vector, given.span)


def _lengths(context: Context, name: str, given: Argument) -> list[Node]:
    """Return the lengths of an argument, which are fixed numbers or depend on parameters."""
    found = flat(given.value, given.span, f"`{name}`")
    if len(found) != _SIZES[name]:
        message = f"`{name}` takes {_SIZES[name]} lengths; {len(found)} are given"
        raise Wrong("LAG0221", message, given.span, "write `size = {0.1, 0.2, 0.3} [m]`")
    for scalar in found:
        expect(scalar.dimension, M, given.span, f"`{name}`")
        _at_rest(context, scalar.node, given, f"`{name}`")
    return [scalar.node for scalar in found]


def _at_rest(context: Context, node: Node, given: Argument | tree.Expression, what: str) -> None:
    if context.clock.mask(node) & MOVING:
        raise Wrong("LAG0313", f"{what} must not change with time", given.span)
    refuse_late(context, node, given.span, what)
