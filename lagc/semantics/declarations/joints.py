"""Declarations of joints: the members of an open one, the equations of one that closes a loop; friction.

Dry friction opposes the slip of the surface at the radius of a pin or a sleeve, of a point along its line or
plane, and of a thread.  The normal force is that of the joint across its axis, along the normal of its plane,
or on the flanks of the thread.  That of an open joint is a reaction by virtual release, that of one that
closes a loop has the multipliers of its equations as components.
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
    entry, graph, kind = joint.entry, context.graph, joint.kind
    assert isinstance(kind, Pair)
    radius = _radius(joint) if "radius" in kind.parameters else graph.one
    slips = _rates(context, joint, a, b, closes)
    # A surface at the radius r slips with r w around the axis, beside its slide along it; a thread along its
    # helix.
    if joint.name == "Cylindrical":
        slips = (slips[0], radius * slips[1])
    if kind.helical:
        slips, normals = _thread(context, joint, radius, slips, a, closes)
    else:
        normals = _normals(context, joint, a, b, closes)
    # The friction of a pin is a torque on its turn.
    pin = joint.name == "Revolute"
    friction, static = coefficients(context, entry, joint.written, slips, over(NONE, S) if pin else SPEED)
    if pin:
        friction, static = friction * radius, None if static is None else static * radius
    symbol, zero = graph.symbol("discrete", entry.path), graph.zero
    context.clock.set_rate(symbol, zero)
    return objects.Contact(
        entry.path, entry.path, zero, "", symbol, zero, entry.span, entry.effect, slips, friction, static,
        normals=normals,
    )  # fmt: skip


def _radius(joint: Joint) -> Node:
    """Return the radius of the surface that rubs: of a pin, or the mean one of a thread."""
    what = "thread" if joint.name == "Screw" else "pin"
    if "radius" not in joint.written:
        message, remedy = f"the friction of a {what} needs its `radius` beside it", "add `radius = 5e-3 [m]`"
        raise Wrong("LAG0235", message, joint.span("friction"), remedy)
    radius = joint.number("radius", M)
    if radius.is_const and radius.value < 0.0:
        message = f"the radius of a {what} is not negative: {radius.value:g} m"
        raise Wrong("LAG0235", message, joint.span("radius"), "write the radius without its sign")
    if radius.is_zero and joint.name != "Revolute":
        remedy = "write the radius at which the surfaces touch"
        raise Wrong("LAG0235", f"the radius of a {what} is not 0", joint.span("radius"), remedy)
    return radius


def _rates(context: Context, joint: Joint, a: Pose, b: Pose, closes: bool) -> tuple[Node, ...]:
    """Return the rates of the slides that the joint allows, then that of its turn about an axis."""
    kind, span = joint.kind, joint.call.span
    assert isinstance(kind, Pair)
    if not closes:
        values = [joint.entry.parts[name] for name in (*kind.slides.values(), *kind.angles)]
        return tuple([derivative(context, value.node, span) for value in values if isinstance(value, Scalar)])
    axes = {axis: a.direction_of(e) for axis, e in joint.axes().items()}
    at = joint.point("at")
    apart = sub(b.place_of(at), a.place_of(at))
    rates = [
        derivative(context, dot(axes[axis], apart), span) for axis in (*kind.slides, *"z" * kind.helical)
    ]
    return (*rates, *[dot(axes["z"], sub(b.frame.spin, a.frame.spin))] * len(kind.angles))


def _normals(context: Context, joint: Joint, a: Pose, b: Pose, closes: bool) -> tuple[Node, ...]:
    """Return the components of the force of the joint across its axis, or along the normal of its plane."""
    path, graph, kind = joint.entry.path, context.graph, joint.kind
    assert isinstance(kind, Pair)
    across = "z" if "x" in kind.slides else "xy"
    if closes:
        return tuple([graph.symbol("multiplier", f"{path}[{k + 1}]") for k in range(len(across))])
    context.held.add(path)
    x, y, z = (graph.symbol("reaction", path, f"force.{axis}") for axis in "xyz")
    # Line and plane belong to the body from which the joint places the other one.
    first = joint.ends[0]
    pose = b if first and linkage_of(context, joint.entry).placing.get(first) is joint else a
    drawn = joint.axes()
    return tuple([dot(pose.direction_of(drawn[axis]), (x, y, z)) for axis in across])


def _thread(
    context: Context, joint: Joint, radius: Node, rates: tuple[Node, ...], a: Pose, closes: bool
) -> tuple[tuple[Node, ...], tuple[Node, ...]]:
    """Return the slip of a square thread along its helix at the mean radius, and the force that presses its
    flanks (J. E. Shigley, *Mechanical Engineering Design*, mechanics of power screws)."""
    graph, path = context.graph, joint.entry.path
    # The tangent of the lead angle l is the advance of a turn over its way around: the helix has the
    # direction (cos l, sin l) around and along the axis, and the flank the normal (-sin l, cos l).
    rise = joint.number("pitch", M) / (TWO_PI * radius)
    cosine = graph.one / graph.sqrt(graph.one + rise * rise)
    sine = rise * cosine
    if closes:
        # The last equation has the gradient 2 pi/pitch along the axis, and friction is no part of its force.
        slip = sine * rates[0] + cosine * radius * rates[1]
        return (slip,), (graph.symbol("multiplier", f"{path}[5]") / (radius * sine),)
    # The force and the moment of the joint hold friction, which has no part along the normal of the flank.
    context.held.add(path)
    axis = a.direction_of(joint.direction("axis"))
    force, moment = (
        dot(axis, tuple([graph.symbol("reaction", path, f"{part}.{e}") for e in "xyz"]))
        for part in ("force", "moment")
    )
    return (radius / cosine * rates[0],), (cosine * force - sine * moment / radius,)
