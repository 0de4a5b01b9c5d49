"""Independent coordinates and speeds of a constrained system at one state.

The constraints allow changes d(q, v) of the state with

phi_q dq + phi_u du = 0,      psi_q dq + psi_v dv + psi_u du = 0,

and keep the length of quaternions.  Elimination with full pivoting tells which entries depend on the
others.  Entries that change in the motion are chosen as dependent first, so that steady motions have
constant coefficients; among equal ones, the last declared.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from lagc.simulation.linearization.derivatives import Array, Point, pseudo_inverse, rounded

GOOD = 0.3  # of the largest pivot: a pivot that is accepted
SHY = 1e-3  # factor on pivots of entries that do not change in the motion
LEAST = 1e-9  # of a row: smaller entries are round-off, and the row depends on others


class Independent(NamedTuple):
    """d(q, v) = motions @ d(x[indices]) + inputs @ du."""

    indices: list[int]  # into x
    motions: Array  # nx x len(indices), 1 at its own place
    inputs: Array  # nx x number of inputs


def independent(point: Point, changing: Sequence[bool]) -> Independent:
    """Choose the independent entries; `changing` tells which of x change in the motion. Raises
    ArithmeticError if an entry is not finite."""
    interface = point.system.interface
    nq, nv, nh, nc = interface.nq, interface.nv, interface.nh, interface.nc
    rows, given = point.partial("condition", "state"), point.partial("condition", "parameter")
    given = given[:, len(interface.parameters) :]
    norms = np.zeros((len(interface.quaternions), nq))
    for k, first in enumerate(interface.quaternions):
        norms[k, first : first + 4] = point.x[first : first + 4]
    speeds = point.scales[0]
    reach = np.abs(point.partial("qdot", "state")[:, nq:]) @ speeds  # of coordinates when speeds change so
    reach[reach == 0.0] = 1.0
    of_q = np.vstack([norms, rows[:nh, :nq]])
    by_q = np.vstack([np.zeros((len(norms), given.shape[1])), given[:nh]])
    liked = np.where(changing, 1.0, SHY)
    free_q, dq = _solved(of_q, by_q, reach, liked[:nq], len(of_q))
    of_v, psi_q = rows[nh : nh + nc, nq:], rows[nh : nh + nc, :nq]
    right = np.hstack([psi_q @ dq[:, : len(free_q)], psi_q @ dq[:, len(free_q) :] + given[nh : nh + nc]])
    free_v, dv = _solved(of_v, right, speeds, liked[nq:], nh)
    n = len(free_q) + len(free_v)
    motions, inputs = np.zeros((nq + nv, n)), np.zeros((nq + nv, given.shape[1]))
    motions[:nq, : len(free_q)], inputs[:nq] = dq[:, : len(free_q)], dq[:, len(free_q) :]
    motions[nq:, len(free_q) :] = dv[:, : len(free_v)]
    motions[nq:, : len(free_q)] = dv[:, len(free_v) : len(free_v) + len(free_q)]
    inputs[nq:] = dv[:, len(free_v) + len(free_q) :]
    return Independent([*free_q, *(nq + j for j in free_v)], motions, inputs)


def _solved(table: Array, right: Array, scales: Array, liked: Array, first: int) -> tuple[list[int], Array]:
    """Which unknowns of `table` x + `right` y = 0 are free, and x as a matrix on these, then on y. The
    `first` rows choose their pivots before the others."""
    with np.errstate(over="ignore"):
        scaled = table * scales
    if not (np.isfinite(scaled).all() and np.isfinite(table).all() and np.isfinite(right).all()):
        raise ArithmeticError("the derivatives have no finite value there")
    rows, columns = _pivots(scaled, liked, first)
    free = [j for j in range(table.shape[1]) if j not in columns]
    found = np.zeros((table.shape[1], len(free) + right.shape[1]))
    found[free, range(len(free))] = 1.0
    if rows:
        square = table[np.ix_(rows, columns)] * scales[columns]
        sizes = np.abs(square).max(axis=1)
        known = np.hstack([table[np.ix_(rows, free)], right[rows]]) / sizes[:, None]
        inverse = np.linalg.inv(square / sizes[:, None])
        solution = rounded(inverse @ known, np.abs(inverse) @ np.abs(known))
        found[columns] = -scales[columns, None] * solution
    return free, found


def _pivots(table: Array, liked: Array, first: int) -> tuple[list[int], list[int]]:
    """Rows and columns of a square part of full rank."""
    left = table.copy()
    lengths = np.abs(left).max(axis=1, initial=0.0)
    left[lengths > 0.0] /= lengths[lengths > 0.0, None]
    rows: list[int] = []
    columns: list[int] = []
    for group in (range(first), range(first, len(left))):
        waiting = list(group)
        while waiting:
            sizes = np.abs(left[waiting])
            sizes[:, columns] = 0.0
            if sizes.max(initial=0.0) <= LEAST:
                break
            weights = sizes.max(axis=0) * liked
            column = int(np.flatnonzero(weights >= GOOD * weights.max())[-1])
            row = waiting.pop(int(sizes[:, column].argmax()))
            rows.append(row)
            columns.append(column)
            for other in (*waiting, *range(max(group.stop, first), len(left))):
                left[other] -= left[other, column] / left[row, column] * left[row]
    return rows, columns


STEP = 1e-4  # of the sizes: the length of a trial motion along its tangent
AWAY = 0.1  # of the step: larger corrections mean that the motion does not continue
DEPENDENT = 1e-6  # relative distance of constraints that depend on each other
TURNS = 6  # Gauss-Newton steps


def is_higher_order_rigid(point: Point, chosen: Independent, sizes: Array) -> bool:
    """Whether the constraints allow one of the `chosen` motions of coordinates only to first order (R.
    Connelly, W. Whiteley, SIAM J. Discrete Math. 9, 1996)."""
    system = point.system
    nq, nh = system.nq, system.nh
    free = [k for k, i in enumerate(chosen.indices) if i < nq]
    if not nh or len(free) + nh + len(system.quaternions) == nq:  # no row follows from others
        return False
    x = np.array(point.x)
    for k in free:
        direction = chosen.motions[:nq, k]
        direction = STEP * direction / np.abs(direction / sizes[:nq]).max()
        moved = x.copy()
        moved[:nq] += direction
        found = _put_back(point, moved, sizes)
        if found is None or not (np.abs(found - moved)[:nq] <= AWAY * STEP * sizes[:nq]).all():
            return True
    return False


def _put_back(point: Point, x: Array, sizes: Array) -> Array | None:
    """Return x projected onto its constraints by steps of least norm; None if a value is not finite."""
    system = point.system
    nq, nh = system.nq, system.nh
    x = x.copy()
    for _ in range(TURNS):
        rows = Point(system, point.t, x.tolist()).partial("condition", "state")[:nh, :nq] * sizes[:nq]
        residual = np.array(system.position(point.t, x.tolist()))
        norms = np.zeros((len(system.quaternions), nq))
        for k, first in enumerate(system.quaternions):
            part = x[first : first + 4]
            norms[k, first : first + 4] = part * sizes[first : first + 4]
            residual = np.append(residual, (part @ part - 1.0) / 2.0)
        table = np.vstack([rows, norms])
        if not (np.isfinite(table).all() and np.isfinite(residual).all()):
            return None
        length = np.abs(table).max(axis=1)
        length[length == 0.0] = 1.0
        x[:nq] -= sizes[:nq] * (pseudo_inverse(table / length[:, None], DEPENDENT) @ (residual / length))
    return x
