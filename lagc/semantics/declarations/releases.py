"""Virtual releases: coordinates that a reaction in an output adds to a copy of the model.

The reaction of a perfect constraint is the generalized force that holds the coordinate which its release
adds (J. L. Lagrange, *Mecanique analytique*, 1788, part 1, section 4; C. Lanczos, *The Variational Principles
of Mechanics*, 1970, section V.5). The copy is derived once, for the outputs; it is never integrated.
"""

from __future__ import annotations

from lagc.diagnostics.faults import Span
from lagc.semantics.context import Context
from lagc.semantics.joints.poses import Pose
from lagc.semantics.model import UNSTATED, Coordinate, Frame, ModelObject, Orientation, Release, Statement
from lagc.semantics.names.scope import Entry
from lagc.semantics.time_derivatives import set_quaternion_rate
from lagc.semantics.values.kinematics import oriented
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import Vector, add

ON_BODY = (1.0, 0.0)  # the factors `held`, `pushed`: the force of all constraints
BY_GEOMETRY = (1.0, -1.0)  # the force of what was released, the explicit constraints act as loads
BY_EQUATIONS = (0.0, 1.0)  # the force of the explicit constraints


def release_parameter(context: Context, entry: Entry, symbol: Node, unit: str) -> list[ModelObject]:
    """Return the parameter as a coordinate that does not move."""
    added = _moving(context, entry, symbol, unit)
    force = context.graph.symbol("reaction", symbol.record.owner)
    return [added, Release((force,), (added.rate_symbol,), (), None, *BY_GEOMETRY)]


def release_place(
    context: Context, entry: Entry, place: Vector, factors: tuple[float, float] = ON_BODY
) -> Vector:
    """Return `place` displaced by three coordinates, along the axes of the world."""
    graph = context.graph
    moved = [graph.symbol("coordinate", f"reaction({entry.path}).{axis}") for axis in "xyz"]
    added = [_moving(context, entry, symbol, "m") for symbol in moved]
    forces = [graph.symbol("reaction", entry.path, f"force.{axis}") for axis in "xyz"]
    values = [(symbol, 0.0) for symbol in moved]
    rates = tuple([coordinate.rate_symbol for coordinate in added])
    entry.objects += [*added, Release(tuple(forces), rates, tuple(values), None, *factors)]
    return add(place, (moved[0], moved[1], moved[2]))


def release_frame(
    context: Context, entry: Entry, frame: Frame, factors: tuple[float, float] = ON_BODY
) -> Frame:
    """Return `frame` rotated by an orientation."""
    graph, owner = context.graph, f"reaction({entry.path})"
    w, x, y, z = (graph.symbol("coordinate", owner, part) for part in "wxyz")
    a, b, c = (graph.symbol("rate", owner, axis) for axis in "xyz")
    set_quaternion_rate(context.clock, (w, x, y, z), (a, b, c))
    one, zero = graph.one, graph.zero
    start, held = (one, zero, zero, zero), _unstated(entry.span)
    added = Orientation(owner, (w, x, y, z), (a, b, c), start, (zero, zero, zero), held, (held, held, held),
                        entry.span)  # fmt: skip
    moments = [graph.symbol("reaction", entry.path, f"moment.{axis}") for axis in "xyz"]
    values = tuple(zip((w, x, y, z), (1.0, 0.0, 0.0, 0.0)))
    entry.objects += [added, Release(tuple(moments), (a, b, c), values, frame.axes, *factors)]
    return oriented(context, frame, added)


def release_pose(context: Context, joint: Entry, pose: Pose, sense: float) -> Pose:
    """Return a pose beyond an open joint with all six freedoms; `sense` is -1 if it is that of the first
    body."""
    factors = (sense * BY_GEOMETRY[0], sense * BY_GEOMETRY[1])
    now = release_place(context, joint, pose.now, factors)
    return Pose(release_frame(context, joint, pose.frame, factors), pose.drawn, now)


def release_far_side(context: Context, joint: Entry, pose: Pose, at: Vector) -> Pose:
    """Return the pose of the second body of a joint that closes a loop, free against the body itself."""
    now = release_place(context, joint, pose.attached(at), BY_EQUATIONS)
    return Pose(release_frame(context, joint, pose.frame, BY_EQUATIONS), at, now)


def _moving(context: Context, entry: Entry, symbol: Node, unit: str) -> Coordinate:
    """Return a coordinate with this symbol."""
    graph, name = context.graph, symbol.record.owner
    rate = graph.symbol("rate", name, order=1)
    context.clock.set_rate(symbol, rate)
    context.clock.set_rate(rate, graph.leaf(rate.record.derivative))
    zero, held = graph.zero, _unstated(entry.span)
    return Coordinate(name, symbol, rate, unit, unit, zero, zero, held, held, entry.span)


def _unstated(span: Span) -> Statement:
    return Statement(UNSTATED, span)
