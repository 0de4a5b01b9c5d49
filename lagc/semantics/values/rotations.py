"""Frames turned against other frames, and the angular velocities that go with them.

With R the axes of the parent and L the turn, the new axes are R L; angular velocities are kept in a
frame's own axes, w = L^T w_parent + (what L' brings), so that a turn about a coordinate axis
brings one component.
"""

from __future__ import annotations

from lagc.diagnostics.faults import Span
from lagc.semantics.context import Context
from lagc.semantics.model import Frame, Orientation
from lagc.semantics.names.scope import Value, kind, vector_of
from lagc.semantics.types.refusals import Wrong
from lagc.semantics.values.frame_vectors import direction, in_frame, known_in_frame, still
from lagc.semantics.values.functions import Argument, Table, number
from lagc.semantics.values.kinematics import derivative
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import Matrix, Vector, add, cross, matmul, matvec, scale, transpose

TABLE = Table()


@TABLE.enter("rotate_x", "frame", "angle")
def _rotate_x(context: Context, span: Span, frame: Argument, angle: Argument) -> Value:
    return about_axis(context, frame, 0, angle)


@TABLE.enter("rotate_y", "frame", "angle")
def _rotate_y(context: Context, span: Span, frame: Argument, angle: Argument) -> Value:
    return about_axis(context, frame, 1, angle)


@TABLE.enter("rotate_z", "frame", "angle")
def _rotate_z(context: Context, span: Span, frame: Argument, angle: Argument) -> Value:
    return about_axis(context, frame, 2, angle)


@TABLE.enter("rotate", "frame", "axis", "angle", required=2)
def _rotate(context: Context, span: Span, frame: Argument, axis: Argument, angle: Argument | None) -> Value:
    """`rotate(frame, orientation)` or `rotate(frame, axis, angle)`, the axis in world axes."""
    parent = frame_of(frame)
    if isinstance(axis.value, Orientation):
        if angle is not None:
            raise Wrong("LAG0209", "a turn by an orientation takes no angle", angle.span)
        return _oriented(context, parent, axis.value)
    if angle is None:
        raise Wrong(
            "LAG0210", "`rotate` needs a frame, an axis and an angle; or a frame and an orientation", span
        )
    vector, _ = vector_of(axis.value, axis.span, "the axis of a rotation")
    return _about(context, parent, *direction(context, parent, vector, axis.span), angle, axis.span)


def frame_of(argument: Argument) -> Frame:
    """Raises Wrong where the argument is no frame."""
    if isinstance(argument.value, Frame):
        return argument.value
    raise Wrong("LAG0221", f"one rotates a frame, this is {kind(argument.value)}", argument.span)


def about_axis(context: Context, frame: Argument, k: int, angle: Argument) -> Frame:
    """A turn by an angle about axis k of the frame."""
    return _about_own(context, frame_of(frame), k, 1.0, angle)


def _about_own(context: Context, parent: Frame, k: int, sense: float, angle: Argument) -> Frame:
    node = number(angle, "an angle of rotation is")
    graph = context.graph
    c, s, one, zero = graph.cos(node), sense * graph.sin(node), graph.one, graph.zero
    turns: tuple[Matrix, ...] = (
        ((one, zero, zero), (zero, c, -s), (zero, s, c)),
        ((c, zero, s), (zero, one, zero), (-s, zero, c)),
        ((c, -s, zero), (s, c, zero), (zero, zero, one)),
    )
    rate = sense * derivative(context, node, angle.span)
    spin = (rate if k == 0 else zero, rate if k == 1 else zero, rate if k == 2 else zero)
    return _turned(context, parent, turns[k], spin)


def _turned(context: Context, parent: Frame, turn: Matrix, own: Vector) -> Frame:
    """`own`: what the turn brings to the angular velocity, in the new axes."""
    axes = matmul(parent.axes, turn)
    carried = matvec(transpose(turn), parent.angular_velocity)
    context.turns[axes] = parent.axes, turn
    return _made(context, parent, axes, add(carried, own), add(parent.spin, matvec(axes, own)))


def _made(context: Context, parent: Frame, axes: Matrix, angular_velocity: Vector, spin: Vector) -> Frame:
    found = Frame("", parent.name, axes, angular_velocity, spin, None)
    context.clock.turns(found)
    return found


def _about(context: Context, parent: Frame, axis: Vector, own: Vector, angle: Argument, span: Span) -> Frame:
    """A turn about the unit vector `axis` of the world, which is `own` in the parent's axes."""
    for k in range(3):
        if own[k].is_const and abs(own[k].value) == 1.0 and all(own[j].is_zero for j in range(3) if j != k):
            return _about_own(context, parent, k, own[k].value, angle)
    node = number(angle, "an angle of rotation is")
    rate = derivative(context, node, angle.span)
    if still(context, axis):  # W R, with a turn W of the world that holds the axis
        turn, about = _turn(axis, node), add(parent.angular_velocity, scale(rate, own))
        spin = add(matvec(turn, parent.spin), scale(rate, axis))
        found = _made(context, parent, matmul(turn, parent.axes), about, spin)
    elif still(context, own):
        found = _turned(context, parent, _turn(own, node), scale(rate, own))
    else:
        found = _turned(
            context, parent, _turn(own, node), _spin(context, parent, axis, own, node, rate, span)
        )
    context.components[found.axes, axis] = own  # the turn leaves it
    return found


def _turn(axis: Vector, angle: Node) -> Matrix:
    """Rodrigues' formula, L = c 1 + s [a] + (1 - c) a a^T, for a unit vector a."""
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
    """What a turn L brings to the angular velocity, [w] = L^T L', in the new axes:
    w = angle' a + s a' - (1 - c) a x a', a' in the parent's axes."""
    graph = angle.graph
    known = known_in_frame(context, parent, axis)
    x, y, z = (derivative(context, component, span) for component in known or axis)
    moved = (x, y, z)
    if known is None:
        moved = add(in_frame(context, parent, moved), cross(own, parent.angular_velocity))
    bent = add(scale(graph.sin(angle), moved), scale(graph.cos(angle) - 1.0, cross(own, moved)))
    return add(scale(rate, own), bent)


def _oriented(context: Context, parent: Frame, o: Orientation) -> Frame:
    return _turned(context, parent, quaternion_turn(context, o.symbols), o.rate_symbols)


def quaternion_turn(context: Context, symbols: tuple[Node, Node, Node, Node]) -> Matrix:
    """The rotation matrix of a unit quaternion (w, x, y, z)."""
    w, x, y, z = symbols
    return (
        (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
        (2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)),
        (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)),
    )
