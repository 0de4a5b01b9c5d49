"""The two velocities along a surface of a slip that is given as a velocity in space.

A contact at a place with the velocity w has the gap rate n . w: the normal n of the surface follows from the
gradients of gap rate and w by the speeds. The force along the gap is 1/|n| of the normal force.

Two directions along a surface that turns in space are those of T. Duff et al., J. Comput. Graph. Tech. 6,
2017, 1-8. They have no value where n points against the pole: the one of +z and -z that n is nearer to at the
initial state. A plane motion has one slip. It is positive along the x axis or, where it is across this at the
initial state, along y or z.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set

from lagc.diagnostics.faults import Fault, Refused
from lagc.mechanics.formulation.jacobian import gradients
from lagc.mechanics.formulation.states import States
from lagc.mechanics.numeric.samples import samples
from lagc.semantics.model import Contact
from lagc.symbolic.evaluate import evaluate
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import Vector, add, cross, dot, norm, scale, sub
from lagc.symbolic.walk import substitute

Gradient = Mapping[int, Node]

_INDEPENDENT = 1e-12  # part of the square of a velocity that others do not have
_ROUNDOFF = 1e-9  # of a unit vector


def along_surface(states: States, contact: Contact, normal: Gradient) -> tuple[list[Node], Node]:
    """Return the slip of a contact in its components along the surface, and the normal force over that along
    the gap: the slip as it is given, and 1; of a velocity in space its parts across the normal. `normal` is
    the gradient of the rate of the gap. Virtual releases change neither. Raises Refused if the normal is not
    found."""
    given = states.in_speeds(contact.slip)
    if len(given) < 3:
        return given, states.graph.one
    released = [rate for release in states.model.releases for rate in release.rates]
    freed = {states.place_of_v[rate] for rate in released}
    parts = [_without(row, freed) for row in gradients(states.graph, given, states.place_of_v)]
    n = _normal(states, _without(normal, freed), parts)
    if n is None:
        message = f"the velocity of the place of `{contact.label}` does not show the direction of its surface"
        remedy = (
            "give the place where the bodies touch, or write two components along the surface that are "
            "perpendicular to each other: `slip = {der(x), der(y)}`"
        )
        raise Refused([Fault("LAG0235", message, contact.span, remedy=remedy)])
    velocity = (given[0], given[1], given[2])
    directions = _across(states, n)
    found = [dot(direction, velocity) for direction in directions]
    held = substitute(states.graph, found, dict.fromkeys(released, states.graph.zero))
    slips = [k for k in range(2) if not held[k].is_zero]
    if len(slips) == 1 and _is_backward(states, directions[slips[0]]):
        found[slips[0]] = -found[slips[0]]
    return [found[k] for k in slips], norm(n)


def _is_backward(states: States, direction: Vector) -> bool:
    """Return whether the first component of a unit vector, beyond round-off, is negative at the start."""
    fixed = all(x.is_const for x in direction)
    start = {} if fixed else _initial(states)
    values = [] if start is None else evaluate(states.in_speeds(direction), start)
    return next((value < 0.0 for value in values if abs(value) > _ROUNDOFF), False)


def _without(row: Gradient, columns: Set[int]) -> Gradient:
    return {j: node for j, node in row.items() if j not in columns}


def _normal(states: States, normal: Gradient, parts: Sequence[Gradient]) -> Vector | None:
    """Return n with normal = n . parts: an axis of the world, or the shortest one."""
    zero = states.graph.zero
    for k in range(3):
        for sign in (1.0, -1.0):
            x, y, z = (states.graph.const(sign) if i == k else zero for i in range(3))
            if _fits(states, (x, y, z), normal, parts):
                return (x, y, z)
    n = _shortest(states, normal, parts)
    return n if any(not x.is_zero for x in n) and _fits(states, n, normal, parts) else None


def _shortest(states: States, normal: Gradient, parts: Sequence[Gradient]) -> Vector:
    """Return the shortest n with normal = n . parts. The partial velocities of the place, simple ones first,
    are made orthogonal (Gram-Schmidt); those that depend on others at the initial state are left out. Each
    adds the rate of the gap along it."""
    zero, start = states.graph.zero, _initial(states)
    n: Vector = (zero, zero, zero)
    columns = sorted({*normal, *(j for part in parts for j in part)})
    columns.sort(key=lambda j: sum(j in part and not part[j].is_const for part in parts))
    basis: list[tuple[Vector, Node]] = []
    for j in columns:
        x, y, z = (part.get(j, zero) for part in parts)
        move, rate = (x, y, z), normal.get(j, zero)
        for e, rate_along in basis:
            share = dot((x, y, z), e) / dot(e, e)
            move, rate = sub(move, scale(share, e)), rate - share * rate_along
        squares = states.in_speeds([dot(move, move), dot((x, y, z), (x, y, z))])
        left, whole = evaluate(squares, start) if start else (0.0, 1.0)
        if left > _INDEPENDENT * whole:
            basis.append((move, rate))
            n = add(n, scale(rate / dot(move, move), move))
    return n


def _initial(states: States) -> dict[Node, float] | None:
    """Return the initial state, with random speeds; None if it has values outside a domain."""
    return next(samples(states.model, 1, vary=False, spread=0.0), None)


def _fits(states: States, n: Sequence[Node], normal: Gradient, parts: Sequence[Gradient]) -> bool:
    """Return whether normal = n . parts."""
    graph = states.graph
    left = []
    for j in {*normal, *(j for part in parts for j in part)}:
        total = graph.sum([x * part[j] for x, part in zip(n, parts) if j in part])
        left.append(normal.get(j, graph.zero) - total)
    left = [node for node in left if not node.is_zero]
    if any(node.is_const for node in left):
        return False
    if not left:
        return True
    from lagc.mechanics.identities.sampling_domains import anywhere  # loaded where there is a question
    from lagc.mechanics.identities.zero_test import ZeroTest

    return ZeroTest(anywhere(states)).vanish(left) is not None


def _across(states: States, n: Vector) -> tuple[Vector, Vector]:
    """Return two unit vectors across n and each other: one is an axis of the world if n is across one."""
    graph, length = states.graph, norm(n)
    zero, one = graph.zero, graph.one
    for k in (2, 1, 0):
        if n[k].is_zero:
            axis = (one if k == 0 else zero, one if k == 1 else zero, one if k == 2 else zero)
            other = cross(n, axis)
            return (other[0] / length, other[1] / length, other[2] / length), axis
    x, y, z = n[0] / length, n[1] / length, n[2] / length
    start = _initial(states)
    if start is not None and evaluate([states.in_speeds([n[2]])[0]], start)[0] < 0.0:
        x, y, z = -x, -y, -z
    part = -one / (one + z)
    return (one + x * x * part, x * y * part, -x), (x * y * part, one + y * y * part, -y)
