"""Forces `at P` at points that belong to no body. Warnings only.

Such a force moves with the point P. If P moves relative to the body (the contact of a disc, a sliding point
on a rod), the material point of the body at P has another velocity. Velocities are compared as linear maps of
all speeds, then of the speeds that the constraints allow.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain

from lagc.diagnostics.faults import Fault
from lagc.mechanics.formulation.equations import Row
from lagc.mechanics.formulation.states import States
from lagc.mechanics.lint.velocity_maps import KEPT, LARGEST, Maps, Matrix, Pose, combined, poses
from lagc.semantics.model import Body, Force, Frame
from lagc.symbolic.derivative import tangent
from lagc.symbolic.evaluate import evaluate
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import Vector
from lagc.symbolic.walk import symbols

_MOST = 8  # bodies that a point is compared with


def points_of_their_own(states: States, rows: Sequence[Row]) -> Iterator[Fault]:
    """Yield LAG0411 of forces at points that move relative to the body that they seem to be of, or not."""
    bodies = states.model.bodies
    places = {body.position for body in bodies}
    loads = [x for x in states.model.actions if isinstance(x, Force) and not x.on_body]
    forces = [x for x in loads if x.at and x.at not in places]
    if not forces or len(states.v) > LARGEST:
        return
    moved_by = [(body, _coordinates([*body.position, *_axes(body)])) for body in bodies]
    maps, free = Maps(states), poses(states)
    bound = poses(states, rows) if rows else []
    for force in forces:
        assert force.at is not None
        near = _tied(force.at, moved_by)
        tied = [body for body in near if body.frame is not None]
        if any(_carries(maps, body, force, force.at, at) for at in (free, bound) if at for body in near):
            continue
        if all(not any(map(any, maps.at(force.velocity, pose))) for pose in free):
            yield _unmoved(force, [body for body in bodies if body.frame is not None])
        elif tied and not _is_of_a_link(states, maps, force, force.at, tied, free):
            yield _two_readings(force, tied[0])


def _tied(at: Vector, moved_by: Sequence[tuple[Body, set[Node]]]) -> list[Body]:
    """Return the bodies that move with coordinates of the point, some, the nearest relative first."""
    own = _coordinates(at)
    found = [(len(own - theirs), len(theirs - own), body) for body, theirs in moved_by if own & theirs]
    return [body for _, _, body in sorted(found, key=lambda x: x[:2])][:_MOST]


def _axes(body: Body) -> Iterator[Node]:
    return chain.from_iterable(body.frame.axes if body.frame is not None else ())


def _coordinates(nodes: Sequence[Node]) -> set[Node]:
    return {x for x in symbols(nodes) if x.record.kind == "coordinate"}


def _carries(maps: Maps, body: Body, force: Force, at: Vector, tried: Sequence[Pose]) -> bool:
    """Return whether the point moves like the material point of the body that is there."""
    for pose in tried:
        if body.frame is None:
            arm = _arm(at, body.position, pose)
            if max(map(abs, arm)) > KEPT * max(map(abs, evaluate(at, pose.state))):
                return False
        elif not _turns_about(maps, body.frame, body.position, body.velocity, force, at, pose):
            return False
    return True


def _turns_about(
    maps: Maps, frame: Frame, place: Vector, velocity: Vector, force: Force, at: Vector, pose: Pose
) -> bool:
    """Return whether the point moves as if it were fixed in a frame that moves with a place."""
    turning = _turning(maps, frame, _arm(at, place, pose), pose)
    parts = [maps.at(force.velocity, pose), maps.at(velocity, pose), turning]
    own, carried, turned = (pose.along(part) for part in parts)
    slip = combined([(1.0, own), (-1.0, carried), (-1.0, turned)])
    most = [max(abs(row[j]) for part in (own, carried, turned) for row in part) for j in range(len(own[0]))]
    return not any(abs(x) > KEPT * size for row in slip for x, size in zip(row, most))


def _turning(maps: Maps, frame: Frame, arm: Sequence[float], pose: Pose) -> Matrix:
    """Return the map of the velocity that the spin of a frame brings at the end of an arm."""
    x, y, z = maps.at(frame.spin, pose)
    a, b, c = arm
    return [
        [c * v - b * w for v, w in zip(y, z)],
        [a * w - c * u for u, w in zip(x, z)],
        [b * u - a * v for u, v in zip(x, y)],
    ]


def _arm(at: Vector, place: Vector, pose: Pose) -> list[float]:
    return [a - b for a, b in zip(evaluate(at, pose.state), evaluate(place, pose.state))]


def _is_of_a_link(
    states: States, maps: Maps, force: Force, at: Vector, tied: Sequence[Body], tried: Sequence[Pose]
) -> bool:
    """Return whether the point is fixed in a frame that rotates it about a point of the model: a massless
    link. The frames of a solid beside it (the lean of a rolling disc) are no links."""
    parents = {frame.name: frame.parent for frame in states.model.frames}
    turned_in: set[str] = {"world"}
    for body in tied:
        name = body.frame.name if body.frame is not None else ""
        while name and name not in turned_in:
            turned_in.add(name)
            name = parents.get(name, "")
    zero, model = states.graph.zero, states.model
    origin: Vector = (zero, zero, zero)
    places = dict.fromkeys([origin, *(p.position for p in model.points), *(b.position for b in model.bodies)])
    for place in places:
        x, y, z = tangent(states.graph, place, states.drift)
        for frame in model.frames:
            if frame.name in turned_in:
                continue
            turns = any(any(map(any, _turning(maps, frame, _arm(at, place, p), p))) for p in tried)
            if turns and all(_turns_about(maps, frame, place, (x, y, z), force, at, p) for p in tried):
                return True
    return False


def _two_readings(force: Force, body: Body) -> Fault:
    point = force.target.text if force.target else ""
    return Fault(
        "LAG0411",
        f"`{force.name}` acts on a point that moves relative to `{body.name}`: the velocity of "
        f"`{point}` is not that of the material point of `{body.name}` there",
        force.target,
        ((body.span, "this body"),),
        f"for the material point write `on {body.name} at {point}`; for the point itself, as it is read "
        f"now, give it a body of its own, `body p = Particle(mass = 0, at = {point});`, and write `at p`",
        "warning",
    )


def _unmoved(force: Force, bodies: Sequence[Body]) -> Fault:
    point = force.target.text if force.target else ""
    return Fault(
        "LAG0411",
        f"`{force.name}` acts on a point that no coordinate moves, so it does nothing",
        force.target,
        remedy=f"for the material point of a body that is there write `on {bodies[0].name} at {point}`"
        if bodies
        else "name a point that moves, or leave the force out",
        severity="warning",
    )
