"""Dissipations that can bring energy: warnings, the equations stay as written.

A Rayleigh function that is quadratic in the rates takes energy from every motion if its form is nowhere
negative, whatever its linear part as long as that is the drive of a damper that moves,
1/2 c (v - u)^2: then it lies in the range of the form.  Both are decided by elimination, at random
positions with the parameters' values.  Of any other function the power is asked at random motions of
many sizes.  Where rows restrict the motion, only what they allow counts.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

from lagc.diagnostics.faults import Fault, Span
from lagc.mechanics.formulation.equations import Contribution, Row
from lagc.mechanics.formulation.states import States
from lagc.mechanics.identities.constraint_manifold import jacobian, scales
from lagc.mechanics.lint.random_motions import KEPT, Motion, random_motions
from lagc.mechanics.numeric.cancellation import VANISHES, magnitudes
from lagc.mechanics.numeric.dense_linear import Span as Spanned
from lagc.symbolic.derivative import gradient
from lagc.symbolic.evaluate import evaluate
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import depends, reachable, symbols

_LARGEST = 60  # speeds beyond which a form is not looked at
_SIZES = tuple([10.0**k for k in range(-4, 5)])  # of the speeds, beside those of the motions
_EACH = 16  # motions from a place
_POLYNOMIAL = ("symbol", "add", "scale", "mul")
_LARGE = 1e3  # from which on a drive is no more felt

Matrix = list[list[float]]


def feeding_dissipations(
    states: States, rows: Sequence[Row], contributions: Sequence[Contribution]
) -> Iterator[Fault]:
    """LAG0412 of dissipations that bring energy in a motion."""
    spans: Mapping[str, Span] = {x.name: x.span for x in states.model.actions}
    for c in contributions:
        if c.kind != "dissipation" or not c.forces or len(states.v) > _LARGEST:
            continue
        if _feeds(states, (), c) and (not rows or _feeds(states, rows, c)):
            yield Fault(
                "LAG0412",
                f"the dissipation `{c.name}` can bring energy into the system: there are motions along "
                "which its force points",
                spans.get(c.name),
                remedy="a dissipation grows with the rates in every direction, such as `1/2*c*der(x)^2` "
                "with c > 0, or `1/2*c*(der(x) - der(y))^2`; what drives is written as a force",
                severity="warning",
            )


def takes(states: States, c: Contribution, places: Sequence[Motion]) -> bool | None:
    """Whether what the speeds bring of a load takes energy from every motion, with constraints or
    without, at the `places`; None where it is not linear in the speeds."""
    forms = _forms(states, c) if len(states.v) <= _LARGEST else None
    if forms is None:
        return None
    matrices = [_matrix(states, c, forms, motion) for motion in places]
    return bool(matrices) and all(_has_minimum(matrix, [0.0] * len(matrix)) for matrix in matrices)


def _feeds(states: States, rows: Sequence[Row], c: Contribution) -> bool:
    forms = _forms(states, c)
    motions = random_motions(states, rows, each=_EACH if forms is None else 1, vary=False)
    if forms is None:
        return any(_is_fed(states, c, motion) for motion in motions)
    return any(_is_indefinite(states, rows, c, forms, motion) for motion in motions)


# -- what is linear in the speeds -------------------------------------------------------------------


def _forms(states: States, c: Contribution) -> list[dict[Node, Node]] | None:
    """The slopes of the forces, less their sign; None where these depend on the speeds."""
    graph, forces = states.graph, list(c.forces.values())
    if any(x.op not in _POLYNOMIAL for x in depends(reachable(forces), states.v)):
        return None
    columns = [v for v in states.v if v in symbols(forces)]
    forms = [gradient(graph, {force: -graph.one}, columns) for force in forces]
    return None if depends([x for form in forms for x in form.values()], states.v) else forms


def _matrix(states: States, c: Contribution, forms: Sequence[Mapping[Node, Node]], motion: Motion) -> Matrix:
    """The form of the power, symmetric, over all speeds."""
    place = {v: k for k, v in enumerate(states.v)}
    values = iter(magnitudes([x for form in forms for x in form.values()], motion.rest))
    matrix = [[0.0] * len(place) for _ in place]
    for j, form in zip(c.forces, forms):
        for v, (x, size) in zip(form, values):
            if abs(x) > VANISHES * size:
                matrix[j][place[v]] += x / 2
                matrix[place[v]][j] += x / 2
    return matrix


def _is_indefinite(
    states: States,
    rows: Sequence[Row],
    c: Contribution,
    forms: Sequence[Mapping[Node, Node]],
    motion: Motion,
) -> bool:
    """Whether the form is negative along a motion, or has no minimum."""
    matrix, force = _matrix(states, c, forms, motion), [0.0] * len(states.v)
    for j, (x, size) in zip(c.forces, magnitudes(list(c.forces.values()), motion.rest)):
        force[j] = x if abs(x) > VANISHES * size else 0.0
    if not rows:
        return not _has_minimum(matrix, force)
    sizes = [scales(states)[v] for v in states.v]
    held = Spanned(jacobian([row for row in rows if row.linear], sizes, motion.state))
    allowed = []
    for j in range(len(sizes)):
        e = held.remainder([float(i == j) for i in range(len(sizes))])
        allowed.append([x * size for x, size in zip(e, sizes)])
    projected = [[_power(matrix, a, b) for b in allowed] for a in allowed]
    reach = max(abs(x) for row in projected for x in row)
    push = [sum(f * x for f, x in zip(force, a)) for a in allowed]
    most = max(map(abs, push))
    return not _has_minimum(
        [[x if abs(x) > KEPT * reach else 0.0 for x in row] for row in projected],
        [x if abs(x) > KEPT * most else 0.0 for x in push],
    )


def _power(matrix: Matrix, a: Sequence[float], b: Sequence[float]) -> float:
    return sum(x * sum(m * y for m, y in zip(row, b)) for x, row in zip(a, matrix))


def _has_minimum(matrix: Matrix, force: Sequence[float]) -> bool:
    """Whether 1/2 v.matrix v - force.v is bounded below: by elimination, the largest pivot first."""
    n = len(force)
    diagonal = [matrix[i][i] for i in range(n)]
    for i in range(n):
        if diagonal[i] < 0.0 or (diagonal[i] == 0.0 and (any(matrix[i]) or force[i])):
            return False
    kept = [i for i in range(n) if diagonal[i] > 0.0]
    unit = {i: 1.0 / math.sqrt(diagonal[i]) for i in kept}
    left = {i: {j: matrix[i][j] * unit[i] * unit[j] for j in kept} for i in kept}
    push = {i: force[i] * unit[i] for i in kept}
    most = max(map(abs, push.values()), default=0.0)
    while left:
        k = max(left, key=lambda i: left[i][i])
        pivot = left[k][k]
        if pivot <= KEPT:
            break
        base, at = left.pop(k), push.pop(k)
        for i, row in left.items():
            factor = row.pop(k) / pivot
            for j in row:
                row[j] -= factor * base[j]
            push[i] -= factor * at
    flat = all(abs(x) <= KEPT for row in left.values() for x in row.values())
    return flat and all(abs(x) <= KEPT * most for x in push.values())


# -- any other function -----------------------------------------------------------------------------


def _is_fed(states: States, c: Contribution, motion: Motion) -> bool:
    """Whether the force does work on the motion in some size of it; where it acts at rest already, as
    that of a damper that moves does, in those in which that is no more felt."""
    columns, forces = [states.v[j] for j in c.forces], list(c.forces.values())
    moved = [motion.state[v] - motion.rest[v] for v in columns]
    at_rest = evaluate(forces, motion.rest)
    if not all(map(math.isfinite, at_rest)):
        both = [evaluate(forces, state) for state in motion.near]
        at_rest = [(a + b) / 2 for a, b in zip(*both)]
    found = []
    for size in _SIZES:
        speeds = {v: motion.rest[v] + size * (motion.state[v] - motion.rest[v]) for v in states.v}
        at = {x: value for x, value in motion.state.items() if x.op == "symbol"}
        force = evaluate(forces, {**at, **speeds})
        reach = sum(abs(f * d) for f, d in zip(force, moved))
        fed = sum(f * d for f, d in zip(force, moved)) > KEPT * reach
        driven = any(abs(r) > KEPT * abs(f) for r, f in zip(at_rest, force))
        found.append((size, fed, driven))
    if any(driven for _, _, driven in found):
        return all(fed for size, fed, _ in found if size >= _LARGE)
    return any(fed for _, fed, _ in found)
