"""Rows that were left out of a run because they depend on others: whether they do, or all but do.

Near a posture where rows lose rank the runtime leaves out those that have next to nothing of their own,
and the motion passes.  A row that keeps a small share of its own all along demands something beyond the
others that the motion then does not meet.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt

from lagc.simulation.error_measure import sizes
from lagc.simulation.system import System, Trajectory, row_gradients

LOOKED_AT = 40  # of the recorded states
ROUNDING = 1e-11  # a share that rows may have by rounding of states and gradients
OWN = 1e-3  # a share that no solve leaves out


def kept_share(system: System, run: Trajectory) -> tuple[int, float] | None:
    """The first row left out that keeps a share of its own at most of the states, and that share:
    the part of its gradient in the speeds, over their sizes, that is at right angles to the others."""
    return own_share(system, run, run.redundant_rows, _looked_at(run))


def spare_rows(system: System, run: Trajectory) -> list[int]:
    """The rows that follow from those before them at most of the states, as `explain` names them: which of
    the rows that depend on each other is left out changes from posture to posture.  Where there are none,
    those that were left out somewhere."""
    shares = _shares(system, run, range(system.nc), _looked_at(run), OWN)
    spare = [row for row, found in enumerate(shares) if _middle(found) < OWN]
    return spare or list(run.redundant_rows)


def own_share(
    system: System, run: Trajectory, asked: Sequence[int], states: Sequence[tuple[float, Sequence[float]]]
) -> tuple[int, float] | None:
    """The same for the rows `asked` at `states`, (t, x)."""
    if not asked or not states:
        return None
    order = [*(i for i in range(system.nc) if i not in asked), *asked]
    shares = _shares(system, run, order, states, ROUNDING)
    for row in asked:
        if ROUNDING < _middle(shares[row]) < OWN:
            return row, _middle(shares[row])
    return None


def _shares(
    system: System,
    run: Trajectory,
    order: Sequence[int],
    states: Sequence[tuple[float, Sequence[float]]],
    least: float,
) -> list[list[float]]:
    """What each row has of its own beside those before it in `order`, at each of the states; a row counts
    as one of those before where that is more than `least`."""
    weights = [0.0] * system.nx
    for group, size in sizes(run, system.interface):
        for i in group:
            weights[i] = size or 1.0
    shares: list[list[float]] = [[] for _ in order]
    for t, x in states:
        rows = _rows(system, t, x, weights)
        basis: list[list[float]] = []
        for i in order:
            rest, share = _remainder(rows[i], basis)
            shares[i].append(share)
            if share > least:
                basis.append(rest)
    return shares


def _looked_at(run: Trajectory) -> list[tuple[float, list[float]]]:
    every = range(len(run.states))[:: -(-len(run.states) // LOOKED_AT) or 1]
    return [(run.times[k], run.states[k]) for k in every]


def _middle(values: Sequence[float]) -> float:
    return sorted(values)[len(values) // 2]


def _rows(system: System, t: float, x: Sequence[float], weights: Sequence[float]) -> list[list[float]]:
    """The gradients of all rows in the sized speeds, as unit vectors; zero where a row vanishes."""
    found = []
    for gradient in row_gradients(system, t, x):
        row = [a * weights[system.nq + j] for j, a in enumerate(gradient)]
        largest = max(map(abs, row), default=0.0)
        length = largest * sqrt(sum((a / largest) ** 2 for a in row)) if largest > 0.0 else 1.0
        found.append([a / length for a in row])
    return found


def _remainder(row: Sequence[float], basis: Sequence[Sequence[float]]) -> tuple[list[float], float]:
    """What of the unit vector `row` is at right angles to `basis`, as a unit vector, and its length."""
    rest = list(row)
    for _ in range(2):
        for other in basis:
            part = sum(a * b for a, b in zip(rest, other))
            rest = [a - part * b for a, b in zip(rest, other)]
    length = sqrt(sum(a * a for a in rest))
    return [a / length for a in rest] if length > 0.0 else rest, length
