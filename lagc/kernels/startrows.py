"""The unknowns and conditions of a consistent start: their sizes, and how far a point is from a start.

The unknowns y are q, v, and the rates that were stated though declared speeds replace them.  The
conditions are phi = 0, psi = 0, the `initial` section, rate - value = 0 for those rates, and unit
quaternions.  Each unknown has a level, from UNSTATED to FIXED.
"""

from __future__ import annotations

from math import fabs, inf, sqrt

from lagc.kernels.limits import LEAST_WEIGHT, MOST_WEIGHT, NEARLY
from lagc.kernels.model import fn_conditions
from lagc.kernels.quaternions import square_at
from lagc.kernels.sizes import NCOND, NE, NJ, NPOSITION, NQ, NQUAT, NRATE, NU, NV
from lagc.kernels.startrecords import UNSTATED, StartWork
from lagc.kernels.tables import angle, column, ends, level, quaternion, unit
from lagc.kernels.words import IVec, Params, Real, Size, Vec, present

SLIGHT = 1.0 / 1024.0  # of the weights: the least rows are judged against; of stated values


def row_begin(i: int) -> int:
    """Where the derivatives of condition i begin in J."""
    return ends[i - 1] if i > 0 else 0


def meet(p: Params, t: Real, y: Vec[NU], c: Vec[NE], J: Vec[NJ], sizes: Vec[NE]) -> None:
    """Residuals, derivatives and sizes of the terms of all conditions."""
    if NCOND > 0:
        fn_conditions(p, t, y, c, J, sizes)
    if NRATE > 0:
        for k in range(NRATE):
            c[NCOND - NRATE + k] -= y[NQ + NV + k]
            sizes[NCOND - NRATE + k] += fabs(y[NQ + NV + k])
    if NQUAT > 0:
        for k in range(NQUAT):
            at = quaternion[k]
            first = row_begin(NCOND + k)
            c[NCOND + k] = 0.5 * (square_at(y, at) - 1.0)
            sizes[NCOND + k] = 1.0
            for i in range(4):
                J[first + i] = y[at + i]


def blur(p: Params, t: Real, y: Vec[NU], sizes: Vec[NU], w: StartWork) -> None:
    """w.blurred: 1 for each of the derivatives w.J at y that is rounding: it changes by as much as it is
    where positions, of these `sizes`, change in their last places."""
    w.trial[:] = y
    for i in range(NQ):
        size = fabs(y[i]) if fabs(y[i]) > fabs(sizes[i]) else fabs(sizes[i])
        w.trial[i] += (NEARLY if i % 2 == 0 else -NEARLY) * size
    meet(p, t, w.trial, w.trial_c, w.trial_J, w.trial_sizes)
    for k in range(NJ):
        change = fabs(w.trial_J[k] - w.J[k])
        w.blurred[k] = 1 if 0.0 < fabs(w.J[k]) and fabs(w.J[k]) <= change else 0


def steepen(i: int, w: StartWork) -> None:
    """w.steepest: of each unit the largest derivative of condition i."""
    first = row_begin(i)
    end = ends[i]
    for k in range(first, end):
        w.steepest[unit[column[k]]] = 0.0
    for k in range(first, end):
        slope = fabs(w.J[k])
        if w.steepest[unit[column[k]]] < slope and slope < inf and w.blurred[k] == 0:
            w.steepest[unit[column[k]]] = slope


def stretch(w: StartWork) -> None:
    """w.common, the largest unknown of each unit, and w.reach: what changes a row by the size of its terms,
    of the unknown of its unit that the row depends on most; 0 where there is none."""
    for i in range(NU):
        w.common[i] = 0.0
    for i in range(NU):
        w.reach[i] = 0.0
    for i in range(NU):
        if fabs(w.home[i]) > w.common[unit[i]]:
            w.common[unit[i]] = fabs(w.home[i])
    for i in range(NE):
        if not (0.0 < w.sizes[i] and w.sizes[i] < inf):
            continue
        steepen(i, w)
        first = row_begin(i)
        end = ends[i]
        for k in range(first, end):
            j = column[k]
            slope = w.steepest[unit[j]]
            if slope > 0.0 and (w.reach[j] == 0.0 or w.sizes[i] / slope < w.reach[j]):
                w.reach[j] = w.sizes[i] / slope


def weigh(p: Params, t: Real, largest: Vec[NU], w: StartWork) -> None:
    """The size of each unknown: its own; that of others of its unit; what changes a row by the size of its
    terms, of the unknown of its unit that the row depends on most; that of a parameter of its unit; 1.  And
    the size of the largest of its unit."""
    meet(p, t, w.home, w.c, w.J, w.sizes)
    w.terms[:] = w.sizes
    blur(p, t, w.home, w.home, w)
    stretch(w)
    for i in range(NU):
        common = w.common[unit[i]]
        weight = fabs(w.home[i])
        if w.levels[i] == UNSTATED or weight == 0.0:
            weight = common
        if weight == 0.0:
            weight = w.reach[i]
        if weight == 0.0:
            weight = largest[unit[i]]
        if not (LEAST_WEIGHT < weight and weight < MOST_WEIGHT):
            weight = 1.0
        width = common if common < MOST_WEIGHT else MOST_WEIGHT
        if width < weight:
            width = weight
        if angle[i] == 1 and width > 1.0:
            width = 1.0
        if angle[i] == 1 and weight > 1.0:
            weight = 1.0
        w.weights[i] = weight
        w.widths[i] = width
    if NQUAT > 0:
        for k in range(NQUAT):
            for i in range(4):
                w.weights[quaternion[k] + i] = 1.0
                w.widths[quaternion[k] + i] = 1.0


def weight_of(w: StartWork, i: int) -> Real:
    """How far unknown i moves where others could move instead."""
    return w.weights[i] if w.levels[i] == UNSTATED else w.ease * w.weights[i]


def judge(y: Vec[NU], J: Vec[NJ], sizes: Vec[NE], w: StartWork) -> None:
    """What the residual of each row at y is judged against: its terms, and what the weights change it by, but
    not beyond its terms at the guess, or those of unknowns that are there.  A large coefficient of what is
    zero so far excuses nothing.  Where speeds meet, positions are known to their widths."""
    for i in range(NE):
        total = 0.0
        own = 0.0
        there = 0.0
        posture = 0.0
        first = row_begin(i)
        end = ends[i]
        for k in range(first, end):
            j = column[k]
            slope = fabs(J[k])
            if j < NQ and column[end - 1] >= NQ:
                posture += slope * w.widths[j]
            total += slope * w.weights[j]
            own += slope * fabs(y[j])
            if fabs(y[j]) >= SLIGHT * w.weights[j]:
                there += slope * fabs(y[j])
        slight = SLIGHT * total
        known = w.terms[i] if w.terms[i] > 0.0 else there
        most = known + SLIGHT * (own + posture)
        w.scales[i] = sizes[i] + (most if 0.0 < known and most < slight else slight)


def ratio(value: Real, scale: Real) -> Real:
    if value == 0.0:
        return 0.0
    return fabs(value) / scale if 0.0 < scale and scale < inf else inf


def norm(c: Vec[NE], first: int, end: int, w: StartWork) -> Real:
    """Of the scaled residuals of w.rows[first..end-1]; infinity where one is not a number."""
    total = 0.0
    for k in range(first, end):
        size = ratio(c[w.rows[k]], w.scales[w.rows[k]])
        total += size * size
    return sqrt(total) if total == total else inf


def farthest(p: Params, t: Real, y: Vec[NU], end: int, w: StartWork) -> Real:
    """The largest scaled residual of w.rows[..end-1], infinity where one is not a number."""
    meet(p, t, y, w.c, w.J, w.sizes)
    judge(y, w.J, w.sizes, w)
    w.culprit = -1
    worst = 0.0
    for k in range(end):
        size = ratio(w.c[w.rows[k]], w.scales[w.rows[k]])
        if not size <= worst:
            worst = size if size == size else inf
            w.culprit = w.rows[k]
            if worst == inf:
                break
    return worst


def moving(i: int) -> bool:
    """Whether speeds take part in condition i."""
    first = row_begin(i)
    end = ends[i]
    for k in range(first, end):
        if column[k] >= NQ:
            return True
    return False


def confine(n: Size, w: StartWork) -> None:
    """Look at the n conditions in w.order, those of positions first, and at the unknowns that they hold."""
    if NPOSITION > 0:
        w.is_settled = False
    for i in range(NU):
        w.used[i] = 0
    for i in range(n):
        first = row_begin(w.order[i])
        end = ends[w.order[i]]
        for k in range(first, end):
            w.used[column[k]] = 1
    w.ended = 0
    for i in range(n):
        if not moving(w.order[i]):
            w.rows[w.ended] = w.order[i]
            w.ended += 1
    w.positions = w.ended
    for i in range(n):
        if moving(w.order[i]):
            w.rows[w.ended] = w.order[i]
            w.ended += 1


def arrange(levels: IVec[NU], w: StartWork) -> None:
    """The levels, those of a quaternion as one; all conditions."""
    if present(levels):
        w.levels[:] = levels
    else:
        w.levels[:] = level
    for i in range(NU):
        w.part[i] = 0
    if NQUAT > 0:
        for k in range(NQUAT):
            first = quaternion[k]
            for i in range(1, 4):
                if w.levels[first + i] > w.levels[first]:
                    w.levels[first] = w.levels[first + i]
            for i in range(1, 4):
                w.levels[first + i] = w.levels[first]
                w.part[first + i] = 1
    for i in range(NU):
        w.loose[i] = 1 if w.levels[i] == UNSTATED else 0
    for i in range(NE):
        w.order[i] = i
    confine(NE, w)
    for i in range(NE):
        w.all[i] = w.rows[i]
