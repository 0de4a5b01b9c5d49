"""Functions of motion: positions, velocities, time derivatives, rotations, and quantities of the run."""

from collections.abc import Callable

from lagc.diagnostics.faults import Span, Wrong
from lagc.semantics.context import BIT, LATE, VELOCITY, Context
from lagc.semantics.model import (
    Body,
    Constraint,
    Contact,
    Discrete,
    Force,
    Frame,
    Joint,
    Lagrangian,
    Orientation,
    Potential,
    Torque,
)
from lagc.semantics.names.scope import (
    Array,
    Entry,
    Reference,
    Scalar,
    Value,
    Wrench,
    kind,
    scalar_of,
    vector_in,
    vector_of,
    vector_value,
)
from lagc.semantics.units import (
    ENERGY,
    FORCE,
    KG,
    NONE,
    POWER,
    Dimension,
    M,
    S,
    dimension,
    over,
    si_text,
    times,
)
from lagc.semantics.units import unit as unit_of
from lagc.semantics.values.evaluate import Argument
from lagc.semantics.values.frame_vectors import direction, in_frame, is_constant, known_in_frame
from lagc.semantics.values.functions import Table, angle_of_turn
from lagc.symbolic import vectors
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import Matrix, Vector, add, cross, matmul, matvec, scale, transpose

TABLE = Table()

SPEED = over(M, S)
TURN = over(NONE, S)
MOMENTUM = times(KG, SPEED)
ANGULAR_MOMENTUM = dimension(kg=1, m=2, s=-1)


def derivative(context: Context, node: Node, span: Span) -> Node:
    """Return d(node)/dt.  Raises Wrong if it is unknown."""
    mask = context.clock.mask(node)
    if mask & BIT["input"]:
        message = "the time derivative of an input is not known"
        remedy = "write it as an expression of `time` instead of an input"
        raise Wrong("LAG0311", message, span, remedy)
    if mask & LATE:
        what = "an acceleration, a reaction or an energy of the run"
        raise Wrong("LAG0219", f"the time derivative of {what} is not known", span)
    return context.clock.derivative(node)


@TABLE.enter("der", "x")
def _der(context: Context, span: Span, x: Argument) -> Value:
    def rate_of(value: Value) -> Value:
        if isinstance(value, Array):
            return Array(tuple([rate_of(element) for element in value.elements]))
        if not isinstance(value, Scalar):
            raise Wrong("LAG0307", f"`der` takes a number or a vector; this is {kind(value)}", x.span)
        found = derivative(context, value.node, x.span)
        return Scalar(found, None if value.dimension is None else over(value.dimension, S))

    return rate_of(x.value)


@TABLE.enter("attached", "body", "drawn")
def _drawn_place(context: Context, span: Span, body: Argument, drawn: Argument) -> Value:
    """Return the place of the point of a body that is drawn at `drawn`; joints place the body."""
    pose = context.poses.get(body.value.name) if isinstance(body.value, Body) else None
    if pose is None:
        remedy = "of a body with a frame F write the point itself: `position(b) + s*F.x`"
        raise Wrong("LAG0221", "`attached` takes a body that a joint places", body.span, remedy)
    place = vector_in(M, drawn.value, drawn.span, "a point")
    return vector_value(pose(place), M)


@TABLE.enter("position", "of")
def _position(context: Context, span: Span, of: Argument) -> Value:
    vector = vector_in(M, of.value, of.span, "the argument of `position`", "a position")
    return vector_value(vector, M)


def velocity_of(context: Context, of: Argument, at: Argument | None) -> vectors.Vector:
    """Return the velocity of a point or a center of mass; with `at`, that of the body's material point
    there."""
    if at is not None:
        return material_velocity(context, of, at)
    if isinstance(of.value, Body):
        return of.value.velocity
    vector = vector_in(M, of.value, of.span, "the argument of `velocity`", "a position")
    x, y, z = (derivative(context, node, of.span) for node in vector)
    return (x, y, z)


def material_velocity(context: Context, of: Argument, at: Argument) -> vectors.Vector:
    """Return the velocity v + w x r of the material point of a body at a place.  A particle has only its own
    place."""
    body = of.value
    if not isinstance(body, Body):
        has = ", which has no place" if isinstance(body, Frame) else ""
        raise Wrong("LAG0221", f"`at` needs a body; this is {kind(body)}{has}", of.span)
    place = vector_in(M, at.value, at.span, "a point")
    if body.frame is not None:
        arm = vectors.sub(place, body.position)
        return vectors.add(body.velocity, vectors.cross(body.frame.spin, arm))
    if place != body.position:
        message = f"`{body.name}` is a particle and is not at this point"
        remedy = f"write `at {body.name}`, or declare it as a `Solid`"
        related = ((body.span, "declared here"),)
        raise Wrong("LAG0221", message, at.span, remedy, related)
    return body.velocity


@TABLE.enter("velocity", "of", "at", required=1)
def _velocity(context: Context, span: Span, of: Argument, at: Argument | None) -> Value:
    found = velocity_of(context, of, at)
    context.mentioned_velocities.append((found, span))
    return vector_value(found, SPEED)


@TABLE.enter("acceleration", "of")
def _acceleration(context: Context, span: Span, of: Argument) -> Value:
    x, y, z = (derivative(context, node, of.span) for node in velocity_of(context, of, None))
    return vector_value((x, y, z), over(SPEED, S))


@TABLE.enter("angular_velocity", "of")
def _angular_velocity(context: Context, span: Span, of: Argument) -> Value:
    frame = of.value.frame if isinstance(of.value, Body) else of.value
    if not isinstance(frame, Frame):
        raise Wrong(
            "LAG0221", f"`angular_velocity` takes a frame or a solid; this is {kind(of.value)}", of.span
        )
    context.mentioned_velocities.append((frame.spin, span))
    return vector_value(frame.spin, TURN)


# -- quantities that only a run knows ------------------------------------------------------------


def _quantity(context: Context, kind: str, meant: Dimension, owner: str = "", component: str = "") -> Scalar:
    return Scalar(context.graph.symbol(kind, owner, component), meant)


def _quantities(context: Context, kind: str, meant: Dimension) -> Value:
    return Array(tuple([_quantity(context, kind, meant, component=axis) for axis in "xyz"]))


@TABLE.enter("energy")
def _energy(context: Context, span: Span) -> Value:
    return _quantity(context, "energy", ENERGY)


@TABLE.enter("kinetic", "of", required=0)
def _kinetic(context: Context, span: Span, of: Argument | None) -> Value:
    if of is None:
        return _quantity(context, "kinetic", ENERGY)
    body = of.value
    if not isinstance(body, Body):
        raise Wrong("LAG0221", f"`kinetic` takes a body; this is {kind(body)}", of.span)
    return Scalar(body.kinetic_energy, ENERGY)


@TABLE.enter("potential", "of", required=0)
def _potential(context: Context, span: Span, of: Argument | None) -> Value:
    if of is None:
        return _quantity(context, "potential", ENERGY)
    objects = of.value.entry.objects if isinstance(of.value, Reference) else []
    energies = [item.energy for item in objects if isinstance(item, Potential)]
    if not energies:
        raise Wrong("LAG0221", f"`potential` takes a potential; this is {kind(of.value)}", of.span)
    return Scalar(context.graph.sum(energies), ENERGY)


@TABLE.enter("momentum", "of", required=0)
def _momentum(context: Context, span: Span, of: Argument | None) -> Value:
    if of is None:
        return _quantities(context, "momentum", MOMENTUM)
    if isinstance(of.value, Body):
        return vector_value(vectors.scale(of.value.mass, of.value.velocity), MOMENTUM)
    scalar = scalar_of(of.value, of.span, "the argument of `momentum`")
    name, meant = _coordinate(scalar, of, "`momentum` takes a coordinate or a body; this is neither")
    return _quantity(context, "momentum", over(times(ENERGY, S), meant), name)


def _coordinate(scalar: Scalar, of: Argument, message: str) -> tuple[str, Dimension]:
    """Return the name and the dimension of a scalar coordinate.  Raises Wrong."""
    symbol = scalar.node.record if scalar.node.op == "symbol" else None
    if symbol is None or symbol.kind != "coordinate" or symbol.component or scalar.dimension is None:
        raise Wrong("LAG0221", message, of.span)
    return symbol.owner, scalar.dimension


@TABLE.enter("angular_momentum", "of", required=0)
def _angular_momentum(context: Context, span: Span, of: Argument | None) -> Value:
    if of is None:
        return _quantities(context, "angular_momentum", ANGULAR_MOMENTUM)
    body = of.value
    if not isinstance(body, Body):
        raise Wrong("LAG0221", f"`angular_momentum` takes a body; this is {kind(body)}", of.span)
    total = vectors.cross(body.position, vectors.scale(body.mass, body.velocity))
    if body.frame is not None and body.inertia is not None:
        spin = vectors.matvec(body.inertia, body.frame.angular_velocity)
        total = vectors.add(total, vectors.matvec(body.frame.axes, spin))
    return vector_value(total, ANGULAR_MOMENTUM)


@TABLE.enter("power", "of")
def _power(context: Context, span: Span, of: Argument) -> Value:
    if not isinstance(of.value, Reference) or of.value.entry.kind not in _ACTIONS:
        message = f"`power` takes a force, torque, potential or dissipation; this is {kind(of.value)}"
        raise Wrong("LAG0221", message, of.span)
    return _quantity(context, "power", POWER, of.value.entry.path)


_ACTIONS = ("force", "torque", "dissipation", "potential", "gravity", "lagrangian")


@TABLE.enter("generalized_force", "of", "along")
def _generalized_force(context: Context, span: Span, of: Argument, along: Argument) -> Value:
    """Return Q_j of an action: its virtual power for a virtual rate 1 of a coordinate."""
    entry = of.value.entry if isinstance(of.value, Reference) else None
    if entry is None or entry.kind not in _ACTIONS:
        what = "a force, torque, potential or dissipation"
        raise Wrong("LAG0221", f"`generalized_force` takes {what}; this is {kind(of.value)}", of.span)
    for term in entry.objects:
        if isinstance(term, Lagrangian) and context.clock.mask(term.function) & VELOCITY:
            message = f"`{entry.path}` depends on rates: its share is inertial, it has no generalized force"
            raise Wrong("LAG0221", message, of.span)
    scalar = scalar_of(along.value, along.span, "the second argument of `generalized_force`")
    name, meant = _coordinate(scalar, along, "`generalized_force` takes a coordinate as its second argument")
    return _quantity(context, "generalized_force", over(ENERGY, meant), entry.path, name)


@TABLE.enter("torsor", "of", "at")
def _torsor(context: Context, span: Span, of: Argument, at: Argument) -> Value:
    """Return the force of a joint, a body's constraints or a load, with its moment about a point."""
    place = vector_in(M, at.value, at.span, "the point of a torsor")
    entry = of.value.entry if isinstance(of.value, Reference) else None
    load = entry.objects[0] if entry is not None and entry.objects else None
    zero = context.graph.zero
    if isinstance(load, Torque):
        return Wrench(vector_value((zero, zero, zero), FORCE), vector_value(load.vector, ENERGY))
    if isinstance(load, Force) and load.at is not None:
        force, moment, centre = load.vector, (zero, zero, zero), load.at
    elif isinstance(of.value, Body) or (entry is not None and entry.kind == "joint"):
        reaction = _reaction(context, span, of)
        if isinstance(reaction, Scalar):
            message = "the reaction of this joint is a number, its multiplier; it has no torsor"
            raise Wrong("LAG0221", message, of.span, f"write `reaction({of.span.text})`")
        whole = reaction if isinstance(reaction, Wrench) else None
        force, _ = vector_of(whole.force if whole else reaction, of.span, "a reaction")
        moment = vector_of(whole.moment, of.span, "a moment")[0] if whole else (zero, zero, zero)
        places = [x.about for x in entry.objects if isinstance(x, Joint)] if entry is not None else []
        centre = of.value.position if isinstance(of.value, Body) else places[0] or place
    else:
        message = f"`torsor` takes a joint, a body, a force or a torque; this is {kind(of.value)}"
        raise Wrong("LAG0221", message, of.span)
    moment = add(moment, cross(vectors.sub(centre, place), force))
    return Wrench(vector_value(force, FORCE), vector_value(moment, ENERGY))


@TABLE.enter("reaction", "of")
def _reaction(context: Context, span: Span, of: Argument) -> Value:
    """Return the multipliers of a constraint, 0 for components that are identically zero; the force of a
    joint on its second body with its moment; the force that holds a parameter; or the force of all
    constraints on a body, for a solid with its moment."""
    if isinstance(of.value, Body):
        return _reaction_on(context, of.value)
    if isinstance(of.value, Scalar) and of.value.node.op == "symbol":
        symbol = of.value.node.record
        if symbol.kind == "parameter":
            context.held.add(symbol.owner)
            return _quantity(context, "reaction", over(ENERGY, of.value.dimension or NONE), symbol.owner)
    entry = of.value.entry if isinstance(of.value, Reference) else None
    # A joint of one equation has one force, as a constraint; any other one has a force and a moment.
    if entry is not None and entry.kind == "joint":
        single = entry.size is None and entry.objects and isinstance(entry.objects[0], Constraint)
        if not single:
            return _wrench(context, entry.path)
    if entry is None or entry.kind not in ("constraint", "joint") or not entry.objects:
        message = f"`reaction` takes a constraint, a joint, a body or a parameter; this is {kind(of.value)}"
        remedy = "write what holds it as `constraint c: left = right;`, then `reaction(c)`"
        raise Wrong("LAG0221", message, of.span, remedy)
    row = entry.objects[0]
    if isinstance(row, Contact):
        return _of_contacts(context, entry)
    assert isinstance(row, Constraint)
    found: dict[str, Scalar] = {}
    # A multiplier times a residual is an energy, times a residual of velocities a power.
    for label, unit, residual in zip(row.labels, row.units, row.residuals):
        work = POWER if context.clock.mask(residual) & VELOCITY else ENERGY
        meant = NONE if row.actuator else over(work, unit_of(unit or "1").dimension)
        found[label] = Scalar(context.graph.symbol("multiplier", label), meant)
    size = entry.size
    if size is None:
        return found.get(row.name, Scalar(context.graph.zero, None))
    none = Scalar(context.graph.zero, None)
    return Array(tuple([found.get(f"{row.name}[{k + 1}]", none) for k in range(size)]))


def _of_contacts(context: Context, entry: Entry) -> Value:
    """Return the forces of contacts, positive where they push their gaps open."""
    graph, contacts = context.graph, [c for c in entry.objects if isinstance(c, Contact)]
    found = [Scalar(graph.symbol("multiplier", c.label), _push(c)) for c in contacts]
    return found[0] if entry.size is None else Array(tuple(found))


def _push(contact: Contact) -> Dimension:
    """Return the dimension of the force of a contact."""
    return over(POWER if contact.bounds_rate else ENERGY, unit_of(contact.unit or "1").dimension)


@TABLE.enter("impulse", "of")
def _impulse(context: Context, span: Span, of: Argument) -> Value:
    """Return the normal impulse of the last impact of a contact, 0 before the first: a discrete variable."""
    entry = of.value.entry if isinstance(of.value, Reference) else None
    contacts = [] if entry is None else [c for c in entry.objects if isinstance(c, Contact) and not c.normals]
    if entry is None or not contacts:
        message = f"`impulse` takes a one-sided constraint; this is {kind(of.value)}"
        remedy = "declare it: `constraint floor: ball.z >= 0;`, then `impulse(floor)`"
        raise Wrong("LAG0221", message, of.span, remedy)
    found: list[Value] = []
    for contact in contacts:
        meant = times(_push(contact), S)
        symbol = context.graph.symbol("discrete", f"impulse({contact.label})")
        context.clock.set_rate(symbol, context.graph.zero)
        unit, name = si_text(meant), symbol.record.owner
        context.impulses[name] = Discrete(name, symbol, unit, unit, context.graph.zero, False, contact.span)
        found.append(Scalar(symbol, meant))
    return found[0] if entry.size is None else Array(tuple(found))


def _reaction_on(context: Context, body: Body) -> Value:
    """Return the force of all constraints on a body; for a solid with the moment about its centre of
    mass."""
    found = _wrench(context, body.name)
    return found.force if body.frame is None else found


def _wrench(context: Context, owner: str) -> Wrench:
    context.held.add(owner)

    def vector(part: str, meant: Dimension) -> Array:
        parts = [_quantity(context, "reaction", meant, owner, f"{part}.{axis}") for axis in "xyz"]
        return Array(tuple(parts))

    return Wrench(vector("force", over(ENERGY, M)), vector("moment", ENERGY))


# -- rotations of frames ------------------------------------------------------------


def _rotation_about(k: int) -> Callable[[Context, Span, Argument, Argument], Value]:
    return lambda context, span, frame, angle: _about_own(context, frame_of(frame), k, 1.0, angle)


for _k, _axis in enumerate("xyz"):
    TABLE.enter(f"rotate_{_axis}", "frame", "angle")(_rotation_about(_k))


@TABLE.enter("rotate", "frame", "axis", "angle", required=2)
def _rotate(context: Context, span: Span, frame: Argument, axis: Argument, angle: Argument | None) -> Value:
    """Return `rotate(frame, orientation)` or `rotate(frame, axis, angle)`, with the axis in world axes."""
    parent = frame_of(frame)
    if isinstance(axis.value, Orientation):
        if angle is not None:
            raise Wrong("LAG0209", "a rotation by an orientation takes no angle", angle.span)
        return turned_frame(context, parent, axis.value)
    if angle is None:
        about_z = f"for a rotation about the axis z write `rotate_z(world, {axis.span.text})`"
        message = "`rotate` takes a frame, an axis and an angle, or a frame and an orientation"
        raise Wrong("LAG0210", message, span, about_z if isinstance(axis.value, Scalar) else None)
    if isinstance(axis.value, Scalar) and not isinstance(angle.value, Scalar):
        remedy = f"write the axis first: `rotate({frame.span.text}, {angle.span.text}, {axis.span.text})`"
        raise Wrong("LAG0306", "the axis of a rotation must be a vector {x, y, z}", axis.span, remedy)
    vector, _ = vector_of(axis.value, axis.span, "the axis of a rotation")
    return _rotated_about(context, parent, *direction(context, parent, vector, axis.span), angle, axis.span)


def frame_of(argument: Argument) -> Frame:
    """Return the frame of an argument.  Raises Wrong if it is not a frame."""
    if isinstance(argument.value, Frame):
        return argument.value
    message = f"a rotation starts from a frame; this is {kind(argument.value)}"
    raise Wrong("LAG0221", message, argument.span, "write the frame first: `rotate_z(world, angle)`")


def _about_own(context: Context, parent: Frame, k: int, sense: float, angle: Argument) -> Frame:
    node = angle_of_turn(context, angle)
    graph = context.graph
    c, s, one, zero = graph.cos(node), sense * graph.sin(node), graph.one, graph.zero
    turns: tuple[Matrix, ...] = (
        ((one, zero, zero), (zero, c, -s), (zero, s, c)),
        ((c, zero, s), (zero, one, zero), (-s, zero, c)),
        ((c, -s, zero), (s, c, zero), (zero, zero, one)),
    )
    rate = sense * derivative(context, node, angle.span)
    spin = (rate if k == 0 else zero, rate if k == 1 else zero, rate if k == 2 else zero)
    return _turned_frame(context, parent, turns[k], spin)


def _turned_frame(context: Context, parent: Frame, turn: Matrix, own: Vector) -> Frame:
    """Return a rotated frame; `own` is the added angular velocity in the new axes."""
    axes = matmul(parent.axes, turn)
    carried = matvec(transpose(turn), parent.angular_velocity)
    context.turns[axes] = parent.axes, turn
    return _new_frame(context, parent, axes, add(carried, own), add(parent.spin, matvec(axes, own)))


def _new_frame(
    context: Context, parent: Frame, axes: Matrix, angular_velocity: Vector, spin: Vector
) -> Frame:
    found = Frame("", parent.name, axes, angular_velocity, spin, None)
    context.clock.add_frame(found)
    return found


def _rotated_about(
    context: Context, parent: Frame, axis: Vector, own: Vector, angle: Argument, span: Span
) -> Frame:
    """Return a frame rotated about the unit vector `axis` (world axes), which is `own` in the parent's
    axes."""
    for k in range(3):
        if own[k].is_const and abs(own[k].value) == 1.0 and all(own[j].is_zero for j in range(3) if j != k):
            return _about_own(context, parent, k, own[k].value, angle)
    node = angle_of_turn(context, angle)
    rate = derivative(context, node, angle.span)
    if is_constant(context, axis):  # W R, with a rotation W about the fixed axis
        turn, about = _turn(axis, node), add(parent.angular_velocity, scale(rate, own))
        spin = add(matvec(turn, parent.spin), scale(rate, axis))
        found = _new_frame(context, parent, matmul(turn, parent.axes), about, spin)
    elif is_constant(context, own):
        found = _turned_frame(context, parent, _turn(own, node), scale(rate, own))
    else:
        found = _turned_frame(
            context, parent, _turn(own, node), _spin(context, parent, axis, own, node, rate, span)
        )
    context.components[found.axes, axis] = own  # the rotation does not change the axis
    return found


def turned_by(context: Context, frame: Frame, turn: Matrix) -> Frame:
    """Return `frame` rotated by a constant rotation."""
    zero = context.graph.zero
    return frame if turn == context.world.axes else _turned_frame(context, frame, turn, (zero, zero, zero))


def turned_about(context: Context, parent: Frame, own: Vector, angle: Node, span: Span) -> Frame:
    """Return a frame rotated about the unit vector `own` in the axes of its parent."""
    axis = matvec(parent.axes, own)
    return _rotated_about(context, parent, axis, own, Argument(Scalar(angle, NONE), span), span)


def _turn(axis: Vector, angle: Node) -> Matrix:
    """Return the rotation matrix L = c 1 + s [a] + (1 - c) a a^T for a unit vector a (Rodrigues' formula)."""
    graph = angle.graph
    c, s = graph.cos(angle), graph.sin(angle)
    x, y, z = axis
    skew: Matrix = ((graph.zero, -z, y), (z, graph.zero, -x), (-y, x, graph.zero))
    rows: list[Vector] = []
    for i in range(3):
        row = [
            (1.0 - c) * axis[i] * axis[j] + s * skew[i][j] + (c if i == j else graph.zero) for j in range(3)
        ]
        rows.append((row[0], row[1], row[2]))
    return (rows[0], rows[1], rows[2])


def _spin(
    context: Context, parent: Frame, axis: Vector, own: Vector, angle: Node, rate: Node, span: Span
) -> Vector:
    """Return the angular velocity that a rotation L adds, [w] = L^T L', in the new axes. w = angle' a + s a'
    - (1 - c) a x a', with a' in the parent's axes."""
    graph = angle.graph
    known = known_in_frame(context, parent, axis)
    x, y, z = (derivative(context, component, span) for component in known or axis)
    moved = (x, y, z)
    if known is None:
        moved = add(in_frame(context, parent, moved), cross(own, parent.angular_velocity))
    second_order = add(scale(graph.sin(angle), moved), scale(graph.cos(angle) - 1.0, cross(own, moved)))
    return add(scale(rate, own), second_order)


def turned_frame(context: Context, parent: Frame, o: Orientation) -> Frame:
    """Return a frame that is rotated by an orientation."""
    return _turned_frame(context, parent, quaternion_turn(context, o.symbols), o.rate_symbols)


def quaternion_turn(context: Context, symbols: tuple[Node, Node, Node, Node]) -> Matrix:
    """Return the rotation matrix of a unit quaternion (w, x, y, z)."""
    w, x, y, z = symbols
    return (
        (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
        (2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)),
        (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)),
    )
