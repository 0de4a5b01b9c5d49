"""Mass matrix and bias forces of the bodies, by the principle of virtual power.

For every admissible virtual motion v*, the power of the quantities of acceleration is
sum of m a_C . v_C* + (I w' + w x I w) . w*  (angular terms in the body's axes), hence with
the partial velocities d(v_C)/d(v_j) and d(w)/d(v_j)

    M_ij = sum of m dv_C/dv_i . dv_C/dv_j + dw/dv_i . I dw/dv_j
    h_j  = sum of m a_0 . dv_C/dv_j + (I w'_0 + w x I w) . dw/dv_j

where a_0, w'_0 are the accelerations that are left when v' = 0.  The sums over the bodies are
reverse sweeps over the graph of the velocities, so a chain of n links costs O(n^2) nodes, and
prefix sums along it are shared.  Kane & Levinson, *Dynamics: Theory and Applications*, 1985, ch. 4.
"""

from __future__ import annotations

from collections.abc import Sequence

from lagc.diagnostics.faults import Fault, Refused
from lagc.expr.derivative import gradient, tangent
from lagc.expr.graph import Node
from lagc.expr.vectors import Matrix, Vector, add, cross, matvec, scale
from lagc.expr.walk import depends, linked
from lagc.meaning.model import Body
from lagc.mechanics.states import States, seeds
from lagc.records import dataclass


@dataclass(frozen=True, slots=True)
class Moving:
    """The velocity of a centre of mass, or an angular velocity in body axes, and its inertia."""

    body: Body
    velocity: Vector  # in v
    at_rest: Vector  # what is left of it when every rate is zero: the drive's share
    explicit: Vector  # its derivative by t alone, coordinates and rates held
    mass: Node | Matrix

    def momentum(self, velocity: Vector) -> Vector:
        """The linear or angular momentum that goes with `velocity`."""
        if isinstance(self.mass, tuple):
            return matvec(self.mass, velocity)
        return scale(self.mass, velocity)


def moving_parts(states: States) -> list[Moving]:
    """Every velocity that carries inertia.

    Raises Refused: LAG0404 a mass or an inertia that changes with the motion.
    """
    bodies = states.model.bodies
    _check(states, bodies)
    raw: list[Vector] = []
    masses: list[tuple[Body, Node | Matrix]] = []
    for body in bodies:
        if not body.mass.is_zero:
            raw.append(body.velocity)
            masses.append((body, body.mass))
        if body.frame is not None and body.inertia is not None:
            raw.append(body.frame.angular_velocity)
            masses.append((body, body.inertia))
    flat = [x for vector in raw for x in vector]
    by_time = tangent(states.graph, flat, {states.model.time: states.graph.one})
    moved = _triples(states.in_speeds([*flat, *by_time]))
    still = _triples(states.at_rest(flat))
    return [
        Moving(body, v, r, e, mass) for (body, mass), v, r, e in zip(masses, moved, still, moved[len(raw) :])
    ]


def _triples(flat: Sequence[Node]) -> list[Vector]:
    return [(flat[k], flat[k + 1], flat[k + 2]) for k in range(0, len(flat), 3)]


def mass_matrix(states: States, parts: Sequence[Moving]) -> dict[tuple[int, int], Node]:
    """M_ij with i >= j, zeros left out."""
    graph = states.graph
    flat = [x for part in parts for x in part.velocity]
    moving = depends(flat, states.v)
    arguments = {node: [a for a in node.args if a in moving] for node in moving}
    users: dict[Node, list[Node]] = {node: [] for node in moving}
    for node, below in arguments.items():
        for a in below:
            users[a].append(node)
    carried: dict[Node, list[int]] = {}
    for k, part in enumerate(parts):
        for node in part.velocity:
            carried.setdefault(node, []).append(k)
    index = {v: i for i, v in enumerate(states.v)}
    matrix: dict[tuple[int, int], Node] = {}
    for i, speed in enumerate(states.v):
        # Only what this speed changes, and what that depends on, is looked at.
        changed = linked([speed], users) if speed in moving else []
        driven = [parts[k] for k in sorted({k for node in changed for k in carried.get(node, ())})]
        partial = tangent(graph, [x for part in driven for x in part.velocity], {speed: graph.one}, changed)
        pairs: list[tuple[Node, Node]] = []
        for part, rate in zip(driven, _triples(partial)):
            if not all(x.is_zero for x in rate):
                pairs.extend(zip(part.velocity, part.momentum(rate)))
        within = linked([node for node, _ in pairs if node in moving], arguments)
        wrt = [node for node in within if index.get(node, i + 1) <= i]
        row = gradient(graph, seeds(graph, pairs), sorted(wrt, key=index.__getitem__), within)
        matrix.update(((i, index[v]), node) for v, node in row.items())
    return matrix


def bias_forces(states: States, parts: Sequence[Moving]) -> dict[int, Node]:
    """h_j, zeros left out."""
    graph = states.graph
    flat = [x for part in parts for x in part.velocity]
    accelerations = _triples(tangent(graph, flat, states.drift))
    pairs: list[tuple[Node, Node]] = []
    for part, acceleration in zip(parts, accelerations):
        weight = part.momentum(acceleration)
        if isinstance(part.mass, tuple):
            weight = add(weight, cross(part.velocity, part.momentum(part.velocity)))
        pairs.extend(zip(part.velocity, weight))
    return states.to_speeds(seeds(graph, pairs))


def _check(states: States, bodies: Sequence[Body]) -> None:
    model = states.model
    inputs = [given.symbol for given in model.inputs]
    motion = [*states.q, *states.rates, *states.v, model.time, *inputs]
    changing = depends([x for body in bodies for x in _inertia_nodes(body)], motion)
    faults = [_changing(body) for body in bodies if not changing.isdisjoint(_inertia_nodes(body))]
    if faults:
        raise Refused(faults)


def _inertia_nodes(body: Body) -> list[Node]:
    return [body.mass, *(x for row in body.inertia or () for x in row)]


def _changing(body: Body) -> Fault:
    return Fault(
        "LAG0404",
        f"the mass or the inertia of `{body.name}` changes with the motion or with an input",
        body.span,
        remedy="make it an expression of parameters (inertia in the axes of the body's own frame)",
    )
