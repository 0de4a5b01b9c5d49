"""Inertia and bias forces of the bodies, by the principle of virtual power.

For every admissible virtual motion v*, the inertia has the virtual power sum of m a_C . v_C* + (I w' + w x I
w) . w* (angular terms in the body's axes). With the partial velocities d(v_C)/d(v_j) and d(w)/d(v_j):

    M_ij = sum of m dv_C/dv_i . dv_C/dv_j + dw/dv_i . I dw/dv_j    (see `mass_matrix`)
    h_j  = sum of m a_0 . dv_C/dv_j + (I w'_0 + w x I w) . dw/dv_j

with the accelerations a_0, w'_0 at v' = 0. The sums over the bodies are reverse sweeps over the graph of the
velocities, so prefix sums along a chain are shared. Kane, Levinson, *Dynamics: Theory and Applications*,
1985, ch. 4.
"""

from collections.abc import Sequence

from lagc.diagnostics.faults import Fault, Refused
from lagc.mechanics.formulation.equations import Moving, triples
from lagc.mechanics.formulation.states import States
from lagc.semantics.model import Body
from lagc.symbolic.derivative import seeds, tangent
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import Matrix, Vector, add, cross
from lagc.symbolic.walk import depends


def moving_parts(states: States) -> list[Moving]:
    """Return all velocities that carry inertia. Raises Refused: LAG0404 a mass or an inertia that changes
    with the motion."""
    bodies = states.model.bodies
    _check(states, bodies)
    # A point mass and a rotating frame each carry inertia; massless points and frames carry none.
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
    # Velocities: in speeds, their change with time alone, and at rest (which drives impose).
    by_time = tangent(states.graph, flat, {states.model.time: states.graph.one})
    moved = triples(states.in_speeds([*flat, *by_time]))
    at_rest = triples(states.at_rest(flat))
    return [
        Moving(body, v, r, e, mass)
        for (body, mass), v, r, e in zip(masses, moved, at_rest, moved[len(raw) :])
    ]


def inertial_loads(states: States, parts: Sequence[Moving]) -> dict[Node, Node]:
    """Return pairs of a weight and a velocity whose products sum to the virtual power of the inertia at v' =
    0."""
    graph = states.graph
    flat = [x for part in parts for x in part.velocity]
    # Accelerations with v' = 0: d(velocity)/dt with the speeds held.
    accelerations = triples(tangent(graph, flat, states.drift))
    pairs: list[tuple[Node, Node]] = []
    for part, acceleration in zip(parts, accelerations):
        weight = part.momentum(acceleration)
        if isinstance(part.mass, tuple):
            # Euler's equation in body axes: I w' + w x I w.
            weight = add(weight, cross(part.velocity, part.momentum(part.velocity)))
        pairs.extend(zip(part.velocity, weight))
    return seeds(graph, pairs)


def _check(states: States, bodies: Sequence[Body]) -> None:
    model = states.model
    motion = [*states.q, *states.rates, *states.v, model.time, *model.undetermined]
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
