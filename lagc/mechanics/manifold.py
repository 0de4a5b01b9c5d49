"""States that meet the rows: a sampled state moved onto phi = 0, then its speeds onto rate = 0.

Gauss-Newton with steps of least norm.  Used at compile time for questions of consistency only;
a start of the motion is found elsewhere, with the user's guesses held as far as possible.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from lagc.expr.derivative import gradient
from lagc.expr.evaluate import evaluate
from lagc.expr.graph import Node
from lagc.mechanics.equations import Row
from lagc.mechanics.linear import solve
from lagc.mechanics.states import States

_ITERATIONS = 40
_CONVERGED = 1e-12


def onto(states: States, rows: Sequence[Row], state: Mapping[Node, float]) -> dict[Node, float] | None:
    """`state` moved onto `rows`, which must be independent; None where that fails."""
    graph = states.graph
    moved = dict(state)
    norms = [graph.sum(states.q[i + k] ** 2 for k in range(4)) - 1.0 for i in states.quaternions]
    positions = [*(row.residual for row in rows if row.kind == "holonomic"), *norms]
    if not _solve(positions, [gradient(graph, {x: graph.one}, states.q) for x in positions], moved):
        return None
    slopes = [{states.v[j]: node for j, node in row.jacobian.items()} for row in rows]
    if not _solve([row.rate for row in rows], slopes, moved):
        return None
    return moved


def _solve(
    residuals: Sequence[Node], slopes: Sequence[Mapping[Node, Node]], state: dict[Node, float]
) -> bool:
    flat = [*residuals, *(node for slope in slopes for node in slope.values())]
    for _ in range(_ITERATIONS):
        values = evaluate(flat, state)
        if not all(map(math.isfinite, values)):
            return False
        entries = iter(values[len(residuals) :])
        matrix = [{x: next(entries) for x in slope} for slope in slopes]
        sizes = [max((abs(e) for e in row.values()), default=0.0) or 1.0 for row in matrix]
        if all(abs(r) <= _CONVERGED * size for r, size in zip(values, sizes)):
            return True
        step = least_norm(matrix, [-r for r in values[: len(residuals)]])
        if step is None:
            return False
        for x, d in step.items():
            state[x] += d
    return False


def least_norm(matrix: Sequence[Mapping[Node, float]], right: Sequence[float]) -> dict[Node, float] | None:
    """x of least norm with matrix x = right, x = A^T (A A^T)^-1 right; None where A has no full rank."""
    products = [[sum(e * b[x] for x, e in a.items() if x in b) for b in matrix] for a in matrix]
    y = solve(products, right)
    if y is None:
        return None
    step: dict[Node, float] = {}
    for row, weight in zip(matrix, y):
        for x, e in row.items():
            step[x] = step.get(x, 0.0) + weight * e
    return step
