"""Forces `at P` whose point is none of a body: warnings, the equations stay as written.

Such a force moves with the point P itself.  Where P is no point of a body at rest relative to it
(where a disc touches the ground, where something slides along a rod), the material point of the
body that is there has another velocity.  Velocities are compared at random motions, first of the
bare coordinates, then of those that the constraints allow.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain

from lagc.diagnostics.faults import Fault
from lagc.mechanics.formulation.equations import Row
from lagc.mechanics.formulation.states import States
from lagc.mechanics.lint.random_motions import (
    KEPT,
    Motion,
    Numbers,
    State,
    length,
    random_motions,
    turned,
    values,
)
from lagc.semantics.model import Body, Force, Frame
from lagc.symbolic.derivative import tangent
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import Vector, cross, sub
from lagc.symbolic.walk import symbols

_EACH = 2  # motions from a place
_MOST = 8  # bodies that a point is compared with


def points_of_their_own(states: States, rows: Sequence[Row]) -> Iterator[Fault]:
    """LAG0411 of forces at points that move relative to the body that they seem to be of, or not at all."""
    bodies = states.model.bodies
    places = {body.position for body in bodies}
    forces = [x for x in states.model.actions if isinstance(x, Force) and x.at and x.at not in places]
    if not forces:
        return
    moved_by = [(body, _coordinates([*body.position, *_axes(body)])) for body in bodies]
    free = list(random_motions(states, each=_EACH))
    for force in forces:
        assert force.at is not None
        fault = _own_point(states, rows, force, force.at, _tied(force.at, moved_by), free)
        if fault is not None:
            yield fault


def _own_point(
    states: States,
    rows: Sequence[Row],
    force: Force,
    at: Vector,
    near: Sequence[Body],
    free: Sequence[Motion],
) -> Fault | None:
    tied = [body for body in near if body.frame is not None]
    if any(_carries(body, force, at, free) for body in near):
        return None
    if rows and near:
        bound = list(random_motions(states, rows, each=_EACH))
        if any(_carries(body, force, at, bound) for body in near):
            return None
    if all(length(m.change(lambda s: values(force.velocity, s))) == 0.0 for m in free):
        return _unmoved(force, [body for body in states.model.bodies if body.frame is not None])
    if not tied or _is_of_a_link(states, force, at, tied, free):
        return None
    return _two_readings(force, tied[0])


def _tied(at: Vector, moved_by: Sequence[tuple[Body, set[Node]]]) -> list[Body]:
    """The bodies that move with coordinates of the point, some, the nearest relative first."""
    own = _coordinates(at)
    found = [(len(own - theirs), len(theirs - own), body) for body, theirs in moved_by if own & theirs]
    return [body for _, _, body in sorted(found, key=lambda x: x[:2])][:_MOST]


def _axes(body: Body) -> Iterator[Node]:
    return chain.from_iterable(body.frame.axes if body.frame is not None else ())


def _coordinates(nodes: Sequence[Node]) -> set[Node]:
    return {x for x in symbols(nodes) if x.record.kind == "coordinate"}


def _carries(body: Body, force: Force, at: Vector, motions: Sequence[Motion]) -> bool:
    """Whether the point moves like the material point of the body that is there."""

    def slip(state: State) -> Numbers:
        return sub(values(force.velocity, state), _material(body, at, state))

    if body.frame is None:
        return all(_vanishes(sub(values(at, m.state), values(body.position, m.state)),
                             length(values(at, m.state))) for m in motions)  # fmt: skip
    return bool(motions) and all(
        _vanishes(
            m.change(slip), length(_material(body, at, m.state)) + length(values(force.velocity, m.state))
        )
        for m in motions
    )


def _material(body: Body, at: Vector, state: State) -> Numbers:
    velocity = values(body.velocity, state)
    if body.frame is None:
        return velocity
    arm = sub(values(at, state), values(body.position, state))
    return sub(velocity, cross(arm, turned(body.frame, values(body.frame.angular_velocity, state), state)))


def _vanishes(x: Numbers, size: float) -> bool:
    return not length(x) > KEPT * size


def _is_of_a_link(
    states: States, force: Force, at: Vector, tied: Sequence[Body], motions: Sequence[Motion]
) -> bool:
    """Whether the point is fixed in a frame that turns it about a point of the model: on a link without
    mass.  The frames that a solid beside it turns in (the lean of a rolling disc) are no links."""
    parents = {frame.name: frame.parent for frame in states.model.frames}
    turned_in: set[str] = {"world"}
    for body in tied:
        name = body.frame.name if body.frame is not None else ""
        while name and name not in turned_in:
            turned_in.add(name)
            name = parents.get(name, "")
    graph, model = states.graph, states.model
    nodes = [(graph.zero,) * 3, *(p.position for p in model.points), *(b.position for b in model.bodies)]
    hinges = [(place, tangent(graph, place, states.drift)) for place in dict.fromkeys(nodes)]
    return any(
        _turns_about(frame, place, velocity, force, at, motions)
        for frame in model.frames
        if frame.name not in turned_in
        for place, velocity in hinges
    )


def _turns_about(
    frame: Frame,
    place: Sequence[Node],
    velocity: Sequence[Node],
    force: Force,
    at: Vector,
    motions: Sequence[Motion],
) -> bool:
    def turn(state: State) -> Numbers:
        arm = sub(values(at, state), values(place, state))
        return cross(turned(frame, values(frame.angular_velocity, state), state), arm)

    def slip(state: State) -> Numbers:
        relative = sub(values(force.velocity, state), values(velocity, state))
        return sub(relative, turn(state))

    sizes = [length(values(force.velocity, m.state)) for m in motions]
    return all(_vanishes(m.change(slip), size) for m, size in zip(motions, sizes)) and not all(
        _vanishes(m.change(turn), size) for m, size in zip(motions, sizes)
    )


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
