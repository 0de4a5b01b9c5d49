"""Declarations of particles, solids and gravity."""

import math
from collections.abc import Callable, Sequence
from typing import Any

from lagc.diagnostics.faults import Fault, Poisoned, Span, Wrong
from lagc.diagnostics.suggest import did_you_mean, moments, remedy_of_word
from lagc.semantics import model as objects
from lagc.semantics.context import LATE, VELOCITY, Context
from lagc.semantics.declarations.attributes import given_scalar, no_modifiers
from lagc.semantics.names.scope import (
    Array,
    Entry,
    Reference,
    Scalar,
    Text,
    Value,
    expect,
    flat,
    kind,
    scalar_in,
    vector_in,
    vector_of,
    vector_value,
)
from lagc.semantics.units import KG, NONE, M, S, dimension, over
from lagc.semantics.values.calls import look_at_arguments, match
from lagc.semantics.values.evaluate import Argument, each, evaluate, evaluate_as
from lagc.semantics.values.unit_hints import is_bare
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import Matrix, Vector, dot
from lagc.syntax import tree

INERTIA = dimension(kg=1, m=2)
GRAVITY = over(M, (0, 0, 2 * S[2], 0, 0, 0, 0))
NO_BODY = "a body must be a `Particle(...)` or a `Solid(...)`"
STANDARD = 9.81  # m/s2, the default

_SAME = 12  # decimal digits that equal directions share
_DIMENSIONS = {"mass": KG, "at": M, "com": M, "inertia": INERTIA, "frame": NONE}
PARAMETERS = {"Particle": (("mass", "at"), 2), "Solid": (("mass", "inertia", "frame", "com", "at"), 2)}
GRAVITY_PARAMETERS = ("g", "direction")


def declare_body(context: Context, entry: Entry) -> Value:
    """Declare a particle or a solid.  Raises Wrong."""
    no_modifiers(entry)
    call = _call_of(entry)
    name = call.function.name if isinstance(call.function, tree.Name) else ""
    if name not in PARAMETERS:
        look_at_arguments(context, call, entry.environment)
        remedy = did_you_mean(name, PARAMETERS) or remedy_of_word("models", name)
        raise Wrong("LAG0221", NO_BODY, call.function.span, remedy)
    given = _arguments(context, entry, call, name)
    if name == "Solid" and "frame" not in given:
        given["frame"] = _drawn_frame(context, entry, call)
    place = given.get("com") or given.get("at")
    if place is None:
        remedy = "for example, write `com = {0, 0, 0}`"
        raise Wrong("LAG0210", "`Solid` needs the argument `com`, its center of mass", call.span, remedy)
    if "com" in given and "at" in given:
        raise Wrong("LAG0209", "`com` and `at` mean the same; give only one of them", given["at"].span)
    found: dict[str, Any] = dict(each(context, lambda part: (part, _READ[part](context, given[part])), given))
    mass, position = found["mass"], found.get("com") or found["at"]
    frame, inertia = found.get("frame"), found.get("inertia")
    if context.has_joints:
        position, frame = _place_by_joints(context, entry, position, frame)
        place = Argument(vector_value(position, M), place.span)
    if entry.path in context.released:
        from lagc.semantics.joints import release_frame, release_place

        position = release_place(context, entry, position)
        frame = frame and release_frame(context, entry, frame)
        place = Argument(vector_value(position, M), place.span)
    # Loaded here, because a model with a fault in a position needs no motion.
    from lagc.semantics.values.kinematics import velocity_of

    velocity = velocity_of(context, place, None)
    body = objects.Body(entry.path, mass, position, velocity, frame, inertia, entry.span, entry.effect)
    entry.objects.append(body)
    return body


def _drawn_frame(context: Context, entry: Entry, call: tree.Call) -> Argument:
    """Return the frame of a solid without one: the axes of the drawing, if a joint places it."""
    if context.has_joints:
        from lagc.semantics.joints import linkage_of

        linkage = linkage_of(context, entry)
        if entry in linkage.placing:
            return Argument(context.world, call.span)
        if linkage.has_faults or entry in linkage.unplaced:
            raise Poisoned  # reported
    remedy = (
        "for a solid that does not turn write `frame = world`; else declare `frame F = rotate_y(world, "
        "theta);`, or tie the solid by a joint"
    )
    raise Wrong("LAG0210", "`Solid` needs the argument `frame`, or a joint that places it", call.span, remedy)


def _place_by_joints(
    context: Context, entry: Entry, position: Vector, frame: objects.Frame | None
) -> tuple[Vector, objects.Frame | None]:
    """Return the position and the frame of a body that joints may place.  Raises Wrong."""
    from lagc.semantics.joints import linkage_of
    from lagc.semantics.values.frame_vectors import is_constant
    from lagc.semantics.values.kinematics import turned_by

    linkage = linkage_of(context, entry)
    if entry in linkage.roots:
        context.poses[entry.path] = lambda drawn: linkage.pose(entry).place_of(drawn)
    if entry not in linkage.placing:
        return position, frame
    if not is_constant(context, [*position, *(x for row in frame.axes for x in row)] if frame else position):
        joint = linkage.placing[entry].entry
        message = (
            f"`{entry.path}` moves by coordinates of its own, and the joint `{joint.path}` places it too"
        )
        remedy = "draw the body in one configuration; its joints bring the coordinates"
        related = ((joint.span, "the joint"),)
        raise Wrong("LAG0234", message, entry.span, remedy, related)
    pose = linkage.pose(entry)
    context.poses[entry.path] = pose.place_of
    return pose.place_of(position), frame and turned_by(context, pose.frame, frame.axes)


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
        raise Wrong("LAG0221", NO_BODY, source.value.span)
    return source.value


def _arguments(context: Context, entry: Entry, call: tree.Call, name: str) -> dict[str, Argument]:
    """Return the arguments by parameter name; the faults of all of them are reported."""
    parameters, required = PARAMETERS[name]
    written = dict(zip(parameters, match(context, call, parameters, required, f"`{name}`")))

    def argument_of(parameter: str) -> tuple[str, Argument]:
        expression = written[parameter]
        assert expression is not None
        value = evaluate_as(context, expression, entry.environment, _DIMENSIONS[parameter])
        return parameter, Argument(value, expression.span)

    return dict(each(context, argument_of, [p for p in parameters if written[p] is not None]))


def _mass(_: Context, given: Argument) -> Node:
    mass = scalar_in(KG, given.value, given.span, "`mass`")
    if mass.is_const and mass.value < 0:
        raise Wrong("LAG0308", "a mass must not be negative", given.span)
    return mass


def _place(context: Context, given: Argument) -> Vector:
    vector = vector_in(M, given.value, given.span, "the position of a body")
    for node in vector:
        if context.clock.mask(node) & (LATE | VELOCITY):
            raise Wrong("LAG0313", "the position of a body must not depend on a rate", given.span)
    return vector


def _frame(_: Context, given: Argument) -> objects.Frame:
    if not isinstance(given.value, objects.Frame):
        raise Wrong("LAG0221", f"`frame` must be a frame; this is {kind(given.value)}", given.span)
    return given.value


def _inertia(context: Context, given: Argument) -> Matrix:
    for scalar in flat(given.value, given.span, "an inertia"):
        expect(scalar.dimension, INERTIA, given.span, "an inertia")
    return _matrix(context, given.value, given.span)


_READ: dict[str, Callable[[Context, Argument], object]] = {
    "mass": _mass, "at": _place, "com": _place, "frame": _frame, "inertia": _inertia,
}  # fmt: skip


def _matrix(context: Context, value: Value, span: Span) -> Matrix:
    """Return the inertia matrix for principal moments {I1, I2, I3} or a symmetric matrix by rows.  Raises
    Wrong."""
    zero = context.graph.zero
    rows = value.elements if isinstance(value, Array) else ()
    if len(rows) == 3 and all(isinstance(r, Scalar) for r in rows):
        a, b, c = [r.node for r in rows if isinstance(r, Scalar)]
        _check_principal(a, b, c, span)
        return ((a, zero, zero), (zero, b, zero), (zero, zero, c))
    if len(rows) == 3 and all(isinstance(r, Array) and len(r.elements) == 3 for r in rows):
        (a, d, e), (f, b, g), (h, i, c) = (vector_of(row, span, "a row of the inertia")[0] for row in rows)
        if (d, e, g) != (f, h, i):
            raise Wrong("LAG0306", "an inertia matrix must be symmetric", span)
        _check_matrix([a, b, c], [d, e, g], span)
        return ((a, d, e), (d, b, g), (e, g, c))
    remedy = None
    if isinstance(value, Scalar):
        number, _, unit = span.text.partition("[")
        same = ", ".join([number.strip()] * 3)
        remedy = f"with three equal moments write `{{{same}}}{' [' + unit if unit else ''}`"
    raise Wrong("LAG0306", "an inertia is {I1, I2, I3} or a symmetric 3 x 3 matrix", span, remedy)


def _check_principal(a: Node, b: Node, c: Node, span: Span) -> None:
    if a.is_const and b.is_const and c.is_const:
        values = [float(x.value) for x in (a, b, c)]
        largest = max(values)
        if min(values) < 0 or largest > (sum(values) - largest) * (1 + 1e-9):
            shown = [f"{x:.15g} [kg.m2]" if x else "0" for x in values]
            remedy = None if min(values) < 0 else moments(shown, values.index(largest))
            bounds = "non-negative and at most the sum of the two others"
            raise Wrong("LAG0308", f"each principal moment of inertia must be {bounds}", span, remedy)


def _check_matrix(diagonal: Sequence[Node], others: Sequence[Node], span: Span) -> None:
    """Raise Wrong if no body has the principal moments of a constant matrix: its eigenvalues, by O. K. Smith,
    Communications of the ACM 4 (1961) 168."""
    if not all(node.is_const for node in (*diagonal, *others)):
        return
    (a, b, c), (d, e, g) = ([float(x.value or 0.0) for x in nodes] for nodes in (diagonal, others))
    mean = (a + b + c) / 3.0
    a, b, c = a - mean, b - mean, c - mean
    size = math.sqrt((a * a + b * b + c * c + 2.0 * (d * d + e * e + g * g)) / 6.0)
    determinant = a * (b * c - g * g) - d * (d * c - g * e) + e * (d * g - b * e)
    half = determinant / size / size / size / 2.0 if size else 0.0
    turn = math.acos(max(-1.0, min(1.0, half))) / 3.0
    values = [mean + 2.0 * size * math.cos(turn + k * math.tau / 3.0) for k in (1, 2, 0)]  # rising
    if values[2] > (values[0] + values[1]) * (1 + 1e-9):
        shown = ", ".join([f"{value:.4g}" for value in values])
        message = (
            f"no body has this inertia matrix: its principal moments are {shown} kg.m2, and each must be "
            "non-negative and at most the sum of the two others"
        )
        raise Wrong("LAG0308", message, span)


def declare_gravity(context: Context, entry: Entry) -> Value:
    """Declare `Gravity field(g = ..., direction = ...)`. Its potential is V = -sum of m g d . r over the
    bodies of the instance and of nested instances.  Its strength is the parameter `field.g`."""
    source = entry.source
    assert isinstance(source, tree.Declarator)
    # `Gravity` has its data in parentheses, as a call; it may be changed by a run, not by modifiers.
    call = tree.Call(tree.Name("Gravity", source.name_span), source.arguments, source.span)
    if source.value is not None:
        remedy = f"write `Gravity {entry.name}(g = {source.value.span.text});`"
        raise Wrong("LAG0209", f"`{entry.name}` takes its data in parentheses", source.value.span, remedy)
    strength, written_direction = match(context, call, GRAVITY_PARAMETERS, 0, "`Gravity`")
    if entry.modifiers:
        raise Wrong(
            "LAG0209", f"`{entry.name}` cannot be changed from outside", entry.modifiers[0].argument.span
        )
    # The strength is a parameter of its own, which a run can change.
    g = _strength(context, entry, strength)
    entry.parts["g"] = Scalar(g, GRAVITY)
    graph = context.graph
    # The direction is that of a weight; by default it points down.
    direction: Vector = (graph.zero, graph.zero, graph.const(-1.0))
    if written_direction is not None:
        written = evaluate(context, written_direction, entry.environment)
        if isinstance(written, Text) and written.text[-1:] in ("x", "y", "z"):
            remedy = f"for gravity along the negative axis write `direction = -world.{written.text[-1]}`"
            message = "a direction must be a vector {x, y, z}; this is a text"
            raise Wrong("LAG0306", message, written_direction.span, remedy)
        from lagc.semantics.values.frame_vectors import unit_vector

        vector = vector_in(NONE, written, written_direction.span, "a direction")
        direction = unit_vector(context, vector, written_direction.span)
    if strength is not None and direction == (graph.zero, graph.zero, graph.const(-1.0)):
        _look_at_sign(context, entry, strength)
    # V = -sum of m g d . r over the bodies of this instance and of those in it.
    total = graph.zero
    for other in entry.environment.instance.in_order():
        if other.kind == "body" and other.elements is None:
            body = context.value(other, other.span)
            assert isinstance(body, objects.Body)
            total = total - body.mass * g * dot(direction, body.position)
            _note_field(context, entry, other, direction)
    field = objects.Potential(entry.path, total, entry.span, entry.effect, (g, direction))
    entry.objects.append(field)
    return Reference(entry)


def _look_at_sign(context: Context, entry: Entry, strength: tree.Expression) -> None:
    """Warn of a negative number for the magnitude of gravity along -world.z."""
    number = strength.value if isinstance(strength, tree.Quantity) else strength
    if isinstance(number, tree.Unary) and number.op == "-" and is_bare(number.operand, units=True):
        message = f"`{entry.name}` pulls upwards: `g` is the magnitude along -world.z"
        remedy = f"write `g = {strength.span.text.lstrip('- ')}`, or `direction = world.z` if up is meant"
        fault = Fault("LAG0434", message, strength.span, remedy=remedy, severity="warning")
        context.warnings[strength.span, strength.span] = fault


def _note_field(context: Context, entry: Entry, body: Entry, direction: Vector) -> None:
    """Warn if another gravity acts on the same body in the same direction, up to round-off."""
    rounded = tuple([round(x.value, _SAME) if x.op == "const" else x for x in direction])
    first = context.fields.setdefault((body.path, rounded), entry)
    pair = (first.span, entry.span)
    if first is not entry and pair not in context.warnings:
        context.warnings[pair] = _declared_twice(first, entry, body)


def _declared_twice(first: Entry, entry: Entry, body: Entry) -> Fault:
    message = f"`{first.path}` and `{entry.path}` both act on `{body.path}` in the same direction"
    remedy = "gravity acts on all bodies, including those of instances: remove one of the two"
    return Fault("LAG0229", message, entry.span, remedy=remedy, severity="warning")


def _of_vector(written: tree.Expression) -> str:
    """Return a remedy for a vector `g`, `{0, 0, -9.81}`."""
    if isinstance(written, tree.Quantity):
        unit, written = f" [{written.unit.text}]", written.value
    else:
        unit = ""
    parts = [part.span.text for part in written.elements] if isinstance(written, tree.Vector) else []
    strong = [part for part in parts if part not in ("0", "0.0")]
    if len(strong) != 1:
        return "write its magnitude as `g = 9.81` and its direction as `direction = {0, 0, -1}`"
    unit_vector = ["0" if x != strong[0] else "-1" if x.startswith("-") else "1" for x in parts]
    return f"write `g = {strong[0].lstrip('-')}{unit}, direction = {{{', '.join(unit_vector)}}}`"


def _strength(context: Context, entry: Entry, written: tree.Expression | None) -> Node:
    name = f"{entry.path}.g"
    given = context.give(context.parameters, name)
    if given is not None:
        value = given_scalar(context, given, GRAVITY, f"`{name}`").node
    elif written is not None:
        found = evaluate_as(context, written, entry.environment, GRAVITY)
        if isinstance(found, Array):
            remedy = _of_vector(written)
            raise Wrong("LAG0307", "`g` must be a number; this is a vector", written.span, remedy)
        value = scalar_in(GRAVITY, found, written.span, "`g`")
    else:
        value = context.graph.const(STANDARD)
    if not value.is_const:
        return value
    symbol = context.graph.symbol("parameter", name)
    if name in context.released:  # an output asks for its reaction
        from lagc.semantics.joints import release_parameter

        entry.objects += release_parameter(context, entry, symbol, "m/s2")
    bounds, about = (-math.inf, math.inf), "acceleration of gravity"
    parameter = objects.Parameter(name, symbol, "m/s2", "m/s2", value.value, *bounds, entry.span, about)
    entry.objects.append(parameter)
    return symbol
