"""What a consistent start changes by with parameters and stated values: dx0/dtheta.

Stated values change as they are stated, and c(y, p) = 0 tells the rest: c_y dy + c_p dp = 0, by the shortest
way in the sizes of the unknowns y = (q, v, stated rates).  Which of them moves, the search for the start
tells, made once more beside.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from lagc.run.conditions import RUN, Consistency
from lagc.run.consistency import conditions_of
from lagc.run.derivatives import DEPENDENT, Array, Point
from lagc.run.problem import OK
from lagc.run.start import names
from lagc.run.varied import Direction

if TYPE_CHECKING:
    from lagc.run.backends.numpy import NumpySystem

BESIDE = 1e-4  # of a value: how far beside the search is made
MET = 1e-6  # of the terms of a condition, to first order


def start_slopes(
    system: NumpySystem, x0: Sequence[float], given: Mapping[str, float], directions: Sequence[Direction]
) -> Array:
    """(nq + nv, directions) at the start x0, which was found where the run states `given`.  Raises
    ArithmeticError where there is no derivative."""
    interface, n = system.interface, system.nq + system.nv
    point = Point(system, 0.0, x0[:n], [0.0] * system.nv, [0.0] * system.nc)
    stated = [i for i, name in enumerate(names(system)) if name in given]
    found = np.zeros((n + len(interface.rate_names), len(directions)))
    for k, d in enumerate(directions):
        if d.parameter is not None:
            found[:, k] = point.partial("start", "parameter")[:, d.parameter]
            found[stated, k] = 0.0
        elif d.state is not None:
            found[d.state, k] = 1.0
    if not np.isfinite(found).all():
        raise ArithmeticError("the start values have no finite derivatives")
    if not interface.needs_consistency:
        return found
    for k, d in enumerate(directions):
        found[:, k] = _consistent(point, d, given, found[:, k])
    return found[:n]


def _consistent(point: Point, d: Direction, given: Mapping[str, float], own: Array) -> Array:
    """The change of the unknowns where stated values alone would change by `own`."""
    system, n = point.system, len(point.x)
    slopes = np.zeros((len(point.value("condition")) + len(system.quaternions), len(own)))
    missed = np.zeros(len(slopes))
    rows = len(point.value("condition"))
    slopes[:rows, :n] = point.partial("condition", "state")
    for k in range(len(own) - n):
        slopes[rows - (len(own) - n) + k, n + k] = -1.0
    for k, first in enumerate(system.quaternions):
        q = np.array(point.x[first : first + 4])
        slopes[rows + k, first : first + 4] = q
        own[first : first + 4] -= q * (q @ own[first : first + 4])
    if d.parameter is not None:
        missed[:rows] = point.partial("condition", "parameter")[:, d.parameter]
    if not (np.isfinite(slopes).all() and np.isfinite(missed).all()):
        raise ArithmeticError("the conditions of the start have no finite derivatives")
    free, weights = _beside(system, d, given)
    terms = np.abs(missed) + np.abs(slopes) @ np.abs(own)
    missed = missed + slopes @ own
    table = slopes[:, free] * weights[free]
    lengths = np.abs(table).max(axis=1, initial=0.0)
    scale = 1.0 / np.where(lengths > 0.0, lengths, 1.0)
    way = np.linalg.lstsq(table * scale[:, None], -missed * scale, rcond=DEPENDENT)[0]
    left = np.abs(table @ way + missed)
    rounding = DEPENDENT * np.abs(table).sum(axis=1) * np.abs(way).max(initial=0.0)
    if (left > MET * (terms + np.abs(table) @ np.abs(way)) + rounding).any():
        raise ArithmeticError(f"the start has no derivative by `{d.name}`: none beside meets the conditions")
    own[free] += weights[free] * way
    return own


def _beside(system: NumpySystem, d: Direction, given: Mapping[str, float]) -> tuple[list[int], Array]:
    """Which unknowns move where the direction goes on a little, and the sizes of all."""
    values, states, known = list(system.parameters), dict(given), names(system)
    if d.parameter is not None:
        values[d.parameter] += BESIDE * (abs(values[d.parameter]) or 1.0)
    beside = system.model.bind(values)
    guess = beside.start()
    if d.state is not None:
        here = states.get(known[d.state], guess[d.state])
        states[known[d.state]] = here + BESIDE * (abs(here) or 1.0)
    levels = list(system.interface.start_levels)
    for i, name in enumerate(known):
        if name in states:
            guess[i], levels[i] = states[name], max(levels[i], RUN)
    search = Consistency(conditions_of(beside), 0.0, guess, levels)
    if search.run() != OK:
        raise ArithmeticError(f"there is no start beside, by `{d.name}`")
    if d.state is not None and search.free[d.state]:
        raise ArithmeticError(f"`{d.name}` cannot be stated: conditions tell what it is")
    return [i for i, moves in enumerate(search.free) if moves], np.array(search.weights)
