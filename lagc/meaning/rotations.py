"""Frames turned against other frames, and the angular velocities that go with them.

With R the axes of the parent and L the turn, the new axes are R L; angular velocities are kept in a
frame's own axes, w = L^T w_parent + (what L' brings), so that a turn about a coordinate axis
brings one component.
"""

from __future__ import annotations

from lagc.diagnostics.faults import Span
from lagc.expr.graph import Node
from lagc.expr.vectors import Matrix, Vector, add, dot, matmul, matvec, scale, transpose
from lagc.meaning.context import Context
from lagc.meaning.functions import Argument, Table, number, unit_vector
from lagc.meaning.model import Frame, Orientation
from lagc.meaning.motion import derivative
from lagc.meaning.values import Value, Wrong, kind, vector_of

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
    own = _in_frame(parent, vector)
    for k in range(3):
        if own[k].is_const and own[k].value == 1.0 and all(own[j].is_zero for j in range(3) if j != k):
            return about_axis(context, frame, k, angle)
    return _about(context, parent, unit_vector(own, axis.span), angle)


def frame_of(argument: Argument) -> Frame:
    """Raises Wrong where the argument is no frame."""
    if isinstance(argument.value, Frame):
        return argument.value
    raise Wrong("LAG0221", f"one rotates a frame, this is {kind(argument.value)}", argument.span)


def _in_frame(frame: Frame, vector: Vector) -> Vector:
    """A world vector in the frame's axes; a unit vector of the frame is found as such."""
    columns = transpose(frame.axes)
    one, zero = vector[0].graph.one, vector[0].graph.zero
    if vector in columns:
        k = columns.index(vector)
        return (one if k == 0 else zero, one if k == 1 else zero, one if k == 2 else zero)
    return (dot(columns[0], vector), dot(columns[1], vector), dot(columns[2], vector))


def about_axis(context: Context, frame: Argument, k: int, angle: Argument) -> Frame:
    """A turn by an angle about axis k of the frame."""
    parent, node = frame_of(frame), number(angle, "an angle of rotation is")
    graph = context.graph
    c, s, one, zero = graph.cos(node), graph.sin(node), graph.one, graph.zero
    turns: tuple[Matrix, ...] = (
        ((one, zero, zero), (zero, c, -s), (zero, s, c)),
        ((c, zero, s), (zero, one, zero), (-s, zero, c)),
        ((c, -s, zero), (s, c, zero), (zero, zero, one)),
    )
    rate = derivative(context, node, angle.span)
    spin = (rate if k == 0 else zero, rate if k == 1 else zero, rate if k == 2 else zero)
    return _turned(context, parent, turns[k], spin)


def _turned(context: Context, parent: Frame, turn: Matrix, own: Vector) -> Frame:
    """`own`: what the turn brings to the angular velocity, in the new axes."""
    axes = matmul(parent.axes, turn)
    carried = matvec(transpose(turn), parent.angular_velocity)
    found = Frame("", parent.name, axes, add(carried, own), add(parent.spin, matvec(axes, own)), None)
    context.clock.turns(found)
    return found


def _about(context: Context, parent: Frame, axis: Vector, angle: Argument) -> Frame:
    """Rodrigues' formula, L = c 1 + s [a] + (1 - c) a a^T, for a unit vector a in the parent's axes."""
    node = number(angle, "an angle of rotation is")
    graph = context.graph
    c, s = graph.cos(node), graph.sin(node)
    x, y, z = axis
    skew: Matrix = ((graph.zero, -z, y), (z, graph.zero, -x), (-y, x, graph.zero))
    rows: list[Vector] = []
    for i in range(3):
        row = [
            (1.0 - c) * axis[i] * axis[j] + s * skew[i][j] + (c if i == j else graph.zero) for j in range(3)
        ]
        rows.append((row[0], row[1], row[2]))
    turn: Matrix = (rows[0], rows[1], rows[2])
    rates = [derivative(context, component, angle.span) for component in axis]
    if all(rate.is_zero for rate in rates):
        return _turned(context, parent, turn, scale(derivative(context, node, angle.span), axis))
    return _turned(context, parent, turn, _spin(context, turn, angle.span))


def _spin(context: Context, turn: Matrix, span: Span) -> Vector:
    """The angular velocity of a turn in its own axes: L^T L' = [w]."""
    columns = transpose(turn)

    def rate(k: int) -> Vector:
        a, b, c = (derivative(context, node, span) for node in columns[k])
        return (a, b, c)

    return (dot(columns[2], rate(1)), dot(columns[0], rate(2)), dot(columns[1], rate(0)))


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
