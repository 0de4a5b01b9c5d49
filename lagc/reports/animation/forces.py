"""Forces along a run as arrows: weights, loads and reactions."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from lagc.base.records import dataclass
from lagc.diagnostics.faults import Refused
from lagc.reports.animation.frames import Frames
from lagc.reports.animation.scene import Scene
from lagc.reports.animation.states import Array, values
from lagc.reports.animation.surfaces import Row
from lagc.semantics.model import Coordinate, Force
from lagc.symbolic.walk import symbols

Evaluate = Callable[[Sequence[str], Array, Array], list[Array]]  # of texts at times and states

MOST_WEIGHTS = 40  # bodies
MOST_ROWS = 12  # reactions of one constraint
MOST_JOINTS = 12
MOST_BODIES = 12
LEAST = 1e-8  # of the kinetic energy over the size of the scene: a smaller force is rounding
DEPENDENT = 1e-8  # of the length of a direction: it depends on others
WITHOUT_FORCE = ("Gear", "RackAndPinion", "Distance", "Weld")


@dataclass(frozen=True, slots=True)
class Arrow:
    """A force v (3, n) at p (3, n) over the frames. `kind`: weight, load or reaction."""

    name: str
    kind: str
    p: Array
    v: Array


def arrows(scene: Scene, frames: Frames, evaluate: Evaluate | None = None) -> list[Arrow]:
    """Return the forces of a run; reactions only if `evaluate` gives the values of expressions."""
    found = [*_weights(scene, frames), *_loads(scene, frames)]
    if evaluate is not None:
        found += [*_reactions(scene, frames, evaluate), *_friction(scene, frames, evaluate)]
    return found


def _weights(scene: Scene, frames: Frames) -> Iterator[Arrow]:
    gravity = scene.sample.gravity
    if gravity is not None and len(scene.bodies) <= MOST_WEIGHTS:
        for body in scene.bodies:
            weight = np.repeat((body.mass * gravity)[:, None], len(frames.t), 1)
            yield Arrow(f"weight of {body.name}", "weight", frames.p[body.place], weight)


def _loads(scene: Scene, frames: Frames) -> Iterator[Arrow]:
    given, n = frames.symbol_values, len(frames.t)
    for force in scene.model.actions:
        if isinstance(force, Force) and force.at is not None:
            v = values(force.vector, given, n)
            if np.isfinite(v).all():
                yield Arrow(force.name, "load", values(force.at, given, n), v)


def reaction_texts(scene: Scene) -> dict[str, tuple[str, str]]:
    """Return the expressions of the reactions that can be drawn: text -> what it acts on (row, joint or
    body) and its label or name."""
    model, found = scene.model, {}
    joints = {joint.name for joint in model.joints}
    # Rows that are geometry have a direction; then joints, then the sum of all that holds a particle.
    for contact in model.contacts:
        if contact.unit == "m" and not contact.normals and contact.label in scene.rows.known:
            found[f"reaction({contact.name}){contact.label.removeprefix(contact.name)}"] = (
                "row",
                contact.label,
            )
    for c in model.constraints:
        if c.name in joints or c.actuator:
            continue
        for label, unit in [*zip(c.labels, c.units)][:MOST_ROWS]:
            if unit == "m" and label in scene.rows.known:
                found[f"reaction({c.name}){label.removeprefix(c.name)}"] = ("row", label)
    if len(model.joints) <= MOST_JOINTS:
        for j in model.joints:
            if j.kind not in WITHOUT_FORCE and scene.place_of(j.name, "joint") is not None:
                found[f"reaction({j.name}).force"] = ("joint", j.name)
    ends = {end for joint in model.joints for end in joint.between}
    if len(model.bodies) <= MOST_BODIES:
        for body in model.bodies:
            if body.frame is None and body.name not in ends:
                found[f"reaction({body.name})"] = ("body", body.name)
    return found


def _reactions(scene: Scene, frames: Frames, evaluate: Evaluate) -> Iterator[Arrow]:
    texts = reaction_texts(scene)
    least, drawn = _least_force(scene, frames), set[int]()
    for (kind, name), value in _evaluated(texts, frames, evaluate):
        if kind == "row":
            acting = [("reaction", i, v) for i, v in _of_row(scene, frames, scene.rows.known[name], value)]
            drawn |= {i for _, i, _ in acting}
        else:
            i = scene.place_of(name, kind)
            first = None if i is None else scene.sample.first[i]
            # the reaction of a body is the sum of those of its constraints, which have arrows
            if i is None or first in drawn:
                continue
            load = _load_in(scene, frames, name, value.T) if kind == "body" else np.zeros(value.T.shape)
            acting = [("load", i, load), ("reaction", i, value.T - load)]
        for part, i, v in acting:
            if np.isfinite(v).any() and np.nanmax(np.abs(v)) > least:
                yield Arrow(name, part, frames.p[i], v)


def _load_in(scene: Scene, frames: Frames, name: str, reaction: Array) -> Array:
    """Return the part of the reaction (3, n) of a particle that does virtual work where the particle alone
    moves. Ideal constraints do none (d'Alembert), so it is the force of potentials and forces of
    coordinates."""
    model, given = scene.model, frames.symbol_values
    body = next(body for body in model.bodies if body.name == name)
    # A coordinate on which other bodies or constraints depend transmits their forces.
    others = [other for other in model.bodies if other is not body]
    axes = [row for other in others if other.frame is not None for row in other.frame.axes]
    rows = [*(c.residuals for c in model.constraints), *((c.gap, *c.slip) for c in model.contacts)]
    tied = symbols([node for row in (*(other.position for other in others), *axes, *rows) for node in row])
    own = [c for c in model.coordinates if isinstance(c, Coordinate) and c.symbol not in tied]
    n, directions = len(frames.t), list[Array]()
    for c in own:
        sides = [values(body.velocity, {**given, c.rate_symbol: rate}, n) for rate in (1.0, 0.0)]
        directions.append(sides[0] - sides[1])
    # Projection onto the directions of motion, made orthonormal by Gram and Schmidt; one that vanishes or
    # depends on those before it counts as none.
    along, basis = np.zeros(reaction.shape), list[Array]()
    for direction in directions:
        rest = direction
        for e in basis:
            rest = rest - (e * rest).sum(0) * e
        length, size = ((a * a).sum(0) ** 0.5 for a in (rest, direction))
        moves = length > DEPENDENT * size
        e = np.where(moves, rest / np.where(moves, length, 1.0), 0.0)
        basis.append(e)
        along = along + (e * reaction).sum(0) * e
    return along


def _friction(scene: Scene, frames: Frames, evaluate: Evaluate) -> Iterator[Arrow]:
    """Yield the friction of contacts with a plane: the part along the plane of the force of all constraints
    on a body, where this contact alone holds it."""
    model, given, n = scene.model, frames.symbol_values, len(frames.t)
    if not model.contacts or model.constraints or model.joints or len(scene.bodies) != 1:
        return
    (body,) = scene.bodies
    text = f"reaction({body.name})" if body.frame is None else f"reaction({body.name}).force"
    try:
        (force,) = evaluate([text], frames.t, frames.x)
    except Refused:
        return
    touching = values([contact.state for contact in model.contacts], given, n) != 0.0
    for contact, touches in zip(model.contacts, touching):
        row = scene.rows.known.get(contact.label)
        if row is None or row.kind != "plane" or not contact.slip:
            continue
        if row.places[0] in (body.place, *(i for i, _ in body.attached)):
            v = force.T - np.outer(row.n, force @ np.array(row.n))
            v[:, ~(touches & (touching.sum(axis=0) == 1))] = np.nan
            if np.isfinite(v).any() and np.nanmax(np.abs(v)) > _least_force(scene, frames):
                yield Arrow(f"friction of {contact.label}", "reaction", frames.p[row.places[0]], v)


def _evaluated(
    texts: dict[str, tuple[str, str]], frames: Frames, evaluate: Evaluate
) -> list[tuple[tuple[str, str], Array]]:
    """Return what each reaction acts on, with its values. Reactions of joints and bodies are left out if one
    of them is not known, as where an inertia changes."""
    rows = {text: acts for text, acts in texts.items() if acts[0] == "row"}
    for asked in (texts, rows):
        try:
            return [*zip(asked.values(), evaluate([*asked], frames.t, frames.x))] if asked else []
        except Refused:
            continue
    return []


def _of_row(scene: Scene, frames: Frames, row: Row, multiplier: Array) -> Iterator[tuple[int, Array]]:
    """Yield the places and the forces of a constraint or contact: along the normal of its plane, or along the
    line of its two places on each that moves."""
    if row.kind == "plane":
        yield row.places[0], np.outer(row.n, multiplier * row.slope)
    elif row.kind == "distance":
        a, b = row.places
        line = frames.p[b] - frames.p[a]
        with np.errstate(all="ignore"):
            v = line / np.linalg.norm(line, axis=0) * multiplier * row.slope
        yield from ((i, force) for i, force in ((a, -v), (b, v)) if scene.sample.moves(i))


def _least_force(scene: Scene, frames: Frames) -> float:
    system = frames.run.system
    some = range(0, len(frames.t), max(1, len(frames.t) // 40))
    kinetic: list[Any] = [system.energies(float(frames.t[k]), frames.x[k].tolist())[0] for k in some]
    return LEAST * max(filter(np.isfinite, map(float, kinetic)), default=0.0) / scene.scale
