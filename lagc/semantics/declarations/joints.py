"""Declarations of joints: the members of an open one, the equations of one that closes a loop; friction.

Dry friction acts at the pin of a `Revolute` joint, and along the axis of a `Prismatic` one.  The normal force
is the force of the joint across its axis.  That of an open joint is a reaction by virtual release, that of
one that closes a loop has the multipliers of its equations as components.
"""

from collections.abc import Callable

from lagc.diagnostics.faults import Poisoned, Span, Wrong
from lagc.semantics import model as objects
from lagc.semantics.context import Context
from lagc.semantics.declarations.contacts import coefficients
from lagc.semantics.joints import ABOUT_Z, ABOUT_Z_AND_X, NO_TURN, TWO_PI, Joint, Pair, Pose, linkage_of
from lagc.semantics.model import Constraint
from lagc.semantics.names.scope import Entry, Reference, Scalar, Value
from lagc.semantics.units import NONE, M, S, over
from lagc.semantics.values.kinematics import SPEED, derivative
from lagc.symbolic.graph import Node
from lagc.symbolic.leaves import derived
from lagc.symbolic.vectors import Vector, add, cross, dot, norm, scale, sub

Row = tuple[Node, str]  # residual and its unit


def declare_joint(context: Context, entry: Entry) -> Value:
    """Declare the coordinates of an open joint, or the equations of one that closes a loop.  Raises Wrong."""
    linkage = linkage_of(context, entry)
    joint = linkage.joints.get(entry)
    if joint is None:
        raise Poisoned
    # An open joint places the body behind it and brings its coordinates.
    if isinstance(joint.kind, Pair) and not linkage.closes(joint):
        for body in joint.ends:
            linkage.pose(body)
        for inner in entry.inner:
            joint.coordinate(inner.name)
        entry.objects.append(_joint_object(joint, tuple([inner.path for inner in entry.inner]), 0))
        a, b = (linkage.pose(end) for end in joint.ends)
        entry.objects += _friction(context, joint, a, b, False)
        return Reference(entry)
    if any(end in linkage.unplaced for end in joint.ends):
        raise Poisoned  # reported
    for inner in entry.inner:
        _refuse_coordinate(context, entry, inner)
    # A joint that closes a loop brings equations; those that always hold are left out.
    rough: list[objects.Contact] = []
    if joint.name in _OF_JOINTS:
        rows = _OF_JOINTS[joint.name](context, joint)
    else:
        a, b = (linkage.pose(end) for end in joint.ends)
        if entry.path in context.released:
            from lagc.semantics.joints import release_far_side

            b = release_far_side(context, entry, b, joint.point("at"))
        rows = _ROWS.get(joint.name, _pair)(context, joint, a, b)
        rough = _friction(context, joint, a, b, True)
    # Single equations keep the name of the joint; several have subscripts, also where one of them always
    # holds.
    entry.size = None if joint.name in _SINGLE else len(rows)
    labels = [entry.path if entry.size is None else f"{entry.path}[{k + 1}]" for k in range(len(rows))]
    kept = [(label, *row) for label, row in zip(labels, rows) if not row[0].is_zero]
    names, residuals, units = zip(*kept) if kept else ((), (), ())
    call = joint.call
    own = Constraint(entry.path, names, residuals, units, entry.span, call, call, entry.effect)
    entry.objects[:0] = [own, _joint_object(joint, (), len(kept)), *rough]
    return Reference(entry)


def _friction(context: Context, joint: Joint, a: Pose, b: Pose, closes: bool) -> list[objects.Contact]:
    """Return the friction of a joint, if it has any."""
    if "friction" in joint.written:
        return [rub(context, joint, a, b, closes)]
    for name in ("static", "radius"):
        if name in joint.written and isinstance(joint.kind, Pair):
            remedy = "write the coefficient of friction: `friction = 0.1`"
            raise Wrong("LAG0235", f"`{name}` needs `friction` beside it", joint.span(name), remedy)
    return []


def _joint_object(joint: Joint, coordinates: tuple[str, ...], equations: int) -> objects.Joint:
    ends = ["world" if end is None else end.path for end in joint.ends]
    place = (None,) * 4 if joint.name in _OF_JOINTS else _place(joint, bool(coordinates))
    return objects.Joint(
        joint.entry.path, joint.name, (ends[0], ends[1]), coordinates, equations, joint.entry.span, *place
    )


def _place(joint: Joint, is_open: bool) -> tuple[Vector | None, ...]:
    """Return the place of a joint, its axis, the other end of a `Distance` and the point of its moment, in
    world axes. The point of an open joint moves with the second body, that of one that closes a loop with the
    first."""
    linkage = linkage_of(joint.context, joint.entry)
    a, b = (linkage.pose(end) for end in joint.ends)
    far = joint.name == "Distance"
    pose = a if far or not is_open else b
    at = pose.place_of(joint.point("at")) if "at" in joint.written else b.now
    axis = a.direction_of(joint.direction("axis")) if "axis" in joint.written else None
    return at, axis, b.place_of(joint.point("to")) if far else None, b.place_of(joint.point("at"))


def _refuse_coordinate(context: Context, entry: Entry, inner: Entry) -> None:
    """A joint that closes a loop has no coordinates: mark them, and refuse what is given to them."""
    inner.state = "poisoned"
    for modifier in inner.modifiers:
        for argument in modifier.argument.arguments:
            context.report(_no_coordinates(entry, argument.span))
    for name in (inner.path, derived(inner.path)):
        given = context.give(context.starts, name)
        if given is not None:
            context.report(_no_coordinates(entry, given.span or entry.span))


def _no_coordinates(entry: Entry, span: Span) -> Wrong:
    remedy = "give the initial value to a joint before it, or declare this joint before the others"
    return Wrong("LAG0233", f"`{entry.path}` closes a loop, so it has no coordinates", span, remedy)


# Directions of a and b that stay perpendicular.
_SQUARE = {NO_TURN: ("yz", "zx", "xy"), ABOUT_Z: ("xz", "yz"), ABOUT_Z_AND_X: ("zx",)}


def _pair(context: Context, joint: Joint, a: Pose, b: Pose) -> list[Row]:
    """Return the slides and turns of b against a that a pair does not allow."""
    kind, at = joint.kind, joint.point("at")
    assert isinstance(kind, Pair)
    drawn = joint.axes()
    one, other = ({axis: pose.direction_of(e) for axis, e in drawn.items()} for pose in (a, b))
    apart = sub(b.place_of(at), a.place_of(at))
    held = [axis for axis in "xyz" if axis not in kind.slides and not (kind.helical and axis == "z")]
    rows = [(dot(one[axis], apart), "m") for axis in held]
    rows += [(dot(one[pair[0]], other[pair[1]]), "") for pair in _SQUARE.get(kind.turns, ())]
    if kind.helical:  # the sine of the turn that the advance means, less the turn
        turn = TWO_PI * dot(one["z"], apart) / joint.number("pitch", M)
        sine, cosine = context.graph.sin(turn), context.graph.cos(turn)
        rows.append((sine * dot(one["x"], other["x"]) - cosine * dot(one["y"], other["x"]), ""))
    return rows


def _distance(context: Context, joint: Joint, a: Pose, b: Pose) -> list[Row]:
    """Return a massless rod between a point of each body, as long as it is drawn."""
    at, to = joint.point("at"), joint.point("to")
    length = norm(sub(to, at))
    if length.is_zero:
        raise Wrong(
            "LAG0233", "the two points are drawn at one place", joint.span("to"), "write `Spherical(...)`"
        )
    return [(norm(sub(b.place_of(to), a.place_of(at))) - length, "m")]


def _rolling(context: Context, joint: Joint, a: Pose, b: Pose) -> list[Row]:
    """Return a ball, or a disc with an axis, that rolls without slipping on a plane of a."""
    graph, at = context.graph, joint.point("at")
    normal, radius = a.direction_of(joint.direction("normal")), joint.number("radius", M)
    centre, foot = b.place_of(at), a.place_of(at)
    down, drawn = normal, graph.one
    if "axis" in joint.written:
        axis, flat = joint.direction("axis"), joint.direction("normal")
        moved = b.direction_of(axis)
        across = sub(normal, scale(dot(normal, moved), moved))
        drawn = norm(sub(flat, scale(dot(flat, axis), axis)))
        down = scale(graph.one / norm(across), across)
    # A disc touches where its plane goes down steepest: `down` is the part of the normal across its axis.
    # `rise` is how much lower its centre is than in the drawing.
    rise = dot(normal, down) - drawn
    contact = sub(centre, scale(radius, down))

    def velocity(pose: Pose, point: Vector) -> Vector:
        x, y, z = (derivative(context, node, joint.call.span) for node in point)
        return add((x, y, z), cross(pose.frame.spin, sub(contact, point)))

    slip = sub(velocity(b, centre), velocity(a, foot))
    # The height of the centre, then the slip along two directions of the plane, which are velocities.
    first = joint.across(joint.direction("normal"))
    one = a.direction_of(first)
    return [
        (dot(normal, sub(centre, foot)) - radius * rise, "m"),
        (dot(one, slip), "m/s"),
        (dot(cross(normal, one), slip), "m/s"),
    ]


def _members(context: Context, joint: Joint, names: tuple[str, str]) -> list[Node]:
    found: list[Node] = []
    for end, name, argument in zip(joint.ends, names, ("a", "b")):
        assert end is not None
        context.value(end, joint.span(argument))
        value = end.parts.get(name)
        if not isinstance(value, Scalar):
            message = f"`{end.path}` has no coordinate `{name}`"
            raise Wrong("LAG0233", message, joint.span(argument), "name an open joint that has it")
        found.append(value.node)
    return found


def _gear(context: Context, joint: Joint) -> list[Row]:
    a, b = _members(context, joint, ("angle", "angle"))
    return [(a - joint.number("ratio", NONE) * b, "")]


def _rack(context: Context, joint: Joint) -> list[Row]:
    turn, slide = _members(context, joint, ("angle", "slide"))
    return [(slide - joint.number("radius", M) * turn, "m")]


_OF_JOINTS: dict[str, Callable[[Context, Joint], list[Row]]] = {"Gear": _gear, "RackAndPinion": _rack}
_ROWS: dict[str, Callable[[Context, Joint, Pose, Pose], list[Row]]] = {
    "Distance": _distance,
    "Rolling": _rolling,
}
_SINGLE = ("Distance", *_OF_JOINTS)


def rub(context: Context, joint: Joint, a: Pose, b: Pose, closes: bool) -> objects.Contact:
    """Return the friction of a joint between bodies at `a` and `b` as a contact that always touches. Raises
    Wrong."""
    entry, turns = joint.entry, joint.name == "Revolute"
    if turns and "radius" not in joint.written:
        message, remedy = "the friction of a pin needs its `radius` beside it", "add `radius = 5e-3 [m]`"
        raise Wrong("LAG0235", message, joint.span("friction"), remedy)
    slip = _slip(context, joint, a, b, closes)
    friction, static = coefficients(context, entry, joint.written, (slip,), over(NONE, S) if turns else SPEED)
    if turns:
        radius = joint.number("radius", M)
        if radius.is_const and radius.value < 0.0:
            message = f"the radius of a pin is not negative: {radius.value:g} m"
            raise Wrong("LAG0235", message, joint.span("radius"), "write the radius without its sign")
        friction, static = friction * radius, None if static is None else static * radius
    symbol = context.graph.symbol("discrete", entry.path)
    context.clock.set_rate(symbol, context.graph.zero)
    zero = context.graph.zero
    return objects.Contact(
        entry.path, entry.path, zero, "", symbol, zero, entry.span, entry.effect, (slip,), friction, static,
        normals=_across(context, joint, a, closes),
    )  # fmt: skip


def _slip(context: Context, joint: Joint, a: Pose, b: Pose, closes: bool) -> Node:
    """Return the rate of the only motion that the joint allows."""
    if not closes:
        value = joint.entry.parts["angle" if joint.name == "Revolute" else "slide"]
        assert isinstance(value, Scalar)
        return derivative(context, value.node, joint.call.span)
    axis = a.direction_of(joint.axes()["z"])
    if joint.name == "Revolute":
        return dot(axis, sub(b.frame.spin, a.frame.spin))
    at = joint.point("at")
    return derivative(context, dot(axis, sub(b.place_of(at), a.place_of(at))), joint.call.span)


def _across(context: Context, joint: Joint, a: Pose, closes: bool) -> tuple[Node, ...]:
    """Return the two components of the force of the joint across its axis."""
    path, graph = joint.entry.path, context.graph
    if closes:
        return tuple([graph.symbol("multiplier", f"{path}[{k + 1}]") for k in range(2)])
    context.held.add(path)
    x, y, z = (graph.symbol("reaction", path, f"force.{axis}") for axis in "xyz")
    force: Vector = (x, y, z)
    drawn = joint.axes()
    return dot(a.direction_of(drawn["x"]), force), dot(a.direction_of(drawn["y"]), force)
