"""Motions that constraints allow at a posture to first order, and no further: where rows depend on each other
that do not beside it, as those of a panel of crossed rods in its plane.  Linear equations take them for
motions."""

from __future__ import annotations

import numpy as np

from lagc.simulation.linearization.derivatives import Array, Point
from lagc.simulation.linearization.independent_states import Independent

STEP = 1e-4  # of the sizes: a motion bends away from its tangent by as little of that, or does not go on
AWAY = 0.1  # of the step, by which it is left where the motion does not go on
DEPENDENT = 1e-6  # rows as near as that to others beside the posture follow from them; STEP is not so near
TURNS = 6  # of Gauss and Newton


def is_halted(point: Point, chosen: Independent, sizes: Array) -> bool:
    """Whether that is so of one of the `chosen` motions of coordinates, as `sizes` measure them."""
    system = point.system
    nq, nh = system.nq, system.nh
    free = [k for k, i in enumerate(chosen.indices) if i < nq]
    if not nh or len(free) + nh + len(system.quaternions) == nq:  # no row follows from others
        return False
    x = np.array(point.x)
    for k in free:
        way = chosen.motions[:nq, k]
        way = STEP * way / np.abs(way / sizes[:nq]).max()
        moved = x.copy()
        moved[:nq] += way
        found = _put_back(point, moved, sizes)
        if found is None or not (np.abs(found - moved)[:nq] <= AWAY * STEP * sizes[:nq]).all():
            return True
    return False


def _put_back(point: Point, x: Array, sizes: Array) -> Array | None:
    """x on its constraints, by steps of least norm; None where there are no numbers."""
    system = point.system
    nq, nh = system.nq, system.nh
    x = x.copy()
    for _ in range(TURNS):
        rows = Point(system, point.t, x.tolist()).partial("condition", "state")[:nh, :nq] * sizes[:nq]
        missed = np.array(system.position(point.t, x.tolist()))
        norms = np.zeros((len(system.quaternions), nq))
        for k, first in enumerate(system.quaternions):
            part = x[first : first + 4]
            norms[k, first : first + 4] = part * sizes[first : first + 4]
            missed = np.append(missed, (part @ part - 1.0) / 2.0)
        table = np.vstack([rows, norms])
        if not (np.isfinite(table).all() and np.isfinite(missed).all()):
            return None
        length = np.abs(table).max(axis=1)
        length[length == 0.0] = 1.0
        x[:nq] -= sizes[:nq] * (np.linalg.pinv(table / length[:, None], rcond=DEPENDENT) @ (missed / length))
    return x
