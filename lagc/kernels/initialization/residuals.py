"""The unknowns and conditions of a consistent start, and how far a point is from one.

The unknowns y are q, v, and the rates that were stated though declared speeds replace them.  The
conditions are phi = 0, psi = 0, the `initial` section, rate - value = 0 for those rates, and unit
quaternions.  Each unknown has a level, from UNSTATED to FIXED.
"""

from __future__ import annotations

from math import fabs, inf, sqrt

from lagc.kernels.arithmetic.quaternions import square_at
from lagc.kernels.initialization.startparts import put_together
from lagc.kernels.initialization.workspace import UNSTATED, StartWork
from lagc.kernels.language.model import fn_conditions, fn_conditions_some
from lagc.kernels.language.sizes import (
    NCOND,
    NE,
    NJ,
    NPIECE,
    NQ,
    NQUAT,
    NRATE,
    NSTRETCH,
    NSUM,
    NU,
    NV,
)
from lagc.kernels.language.tables import ends, level, quaternion, row_piece, stretch_begins, stretch_ends
from lagc.kernels.language.tolerances import FOUR_ULPS
from lagc.kernels.language.words import IVec, Params, Real, Size, Vec, present, size

SLIGHT = 1.0 / 1024.0  # of the weights: the least that rows are judged against; how far what is stated moves


def row_begin(i: int) -> int:
    """Where the derivatives of condition i begin in J."""
    return ends[i - 1] if i > 0 else 0


def is_blurred(k: int, w: StartWork) -> bool:
    """Whether a derivative is rounding: it changes by as much as it is where last places do."""
    return 0.0 < fabs(w.J[k]) and fabs(w.J[k]) <= w.blurs[k]


def complete(i: int, y: Vec[NU], c: Vec[NE], J: Vec[NJ], sizes: Vec[NE]) -> None:
    """Of condition i, if it is one of a stated rate or of a unit quaternion, what the model does not tell."""
    if NRATE > 0:
        k = i - (NCOND - NRATE)
        if k >= 0 and k < NRATE:
            c[i] -= y[NQ + NV + k]
            sizes[i] += fabs(y[NQ + NV + k])
    if NQUAT > 0:
        if i >= NCOND:
            at = quaternion[i - NCOND]
            first = row_begin(i)
            c[i] = 0.5 * (square_at(y, at) - 1.0)
            sizes[i] = 1.0
            for j in range(4):
                J[first + j] = y[at + j]


def meet_all(p: Params, t: Real, y: Vec[NU], c: Vec[NE], J: Vec[NJ], sizes: Vec[NE]) -> None:
    """Residuals, derivatives and sizes of the terms of all conditions."""
    if NCOND > 0:
        if NPIECE > 0:
            fn_conditions_some(p, t, y, c, J, sizes, 0, size(NPIECE))
        else:
            fn_conditions(p, t, y, c, J, sizes)
    if NSUM > 0:
        put_together(J)
    if NRATE > 0 or NQUAT > 0:
        for i in range(NCOND - NRATE, NE):
            complete(i, y, c, J, sizes)


def meet(p: Params, t: Real, y: Vec[NU], c: Vec[NE], J: Vec[NJ], sizes: Vec[NE], w: StartWork) -> None:
    """The same of w.rows alone; what belongs to other rows may be of another place."""
    if NPIECE > 0:
        fn_conditions_some(p, t, y, c, J, sizes, w.first_piece, w.end_piece)
        if NRATE > 0 or NQUAT > 0:
            rows = w.ended
            for r in range(rows):
                complete(w.rows[r], y, c, J, sizes)
    else:
        meet_all(p, t, y, c, J, sizes)


def set_scales(even: bool, w: StartWork) -> None:
    """w.scale: how far each unknown moves where others could move instead."""
    for i in range(NU):
        if even:
            w.scale[i] = w.widths[i]
        else:
            w.scale[i] = w.weights[i] if w.levels[i] == UNSTATED else SLIGHT * w.weights[i]


def judge(y: Vec[NU], J: Vec[NJ], sizes: Vec[NE], w: StartWork) -> None:
    """What the residuals of w.rows at y are judged against: w.scales, its terms and what a slight part of how
    large its unknowns may be changes it by: these are not known better.  And what of it is rounding of the
    parameters, and where speeds take part of positions that are held, w.floors."""
    rows = w.ended
    for r in range(rows):
        i = w.rows[r]
        slight = 0.0
        w.floors[i] = w.doubts[i]
        first = row_begin(i)
        end = ends[i]
        for k in range(first, end):
            j = w.column[k]
            size = fabs(y[j])
            if w.loose[j] == 1 and w.reach[j] > size:
                size = w.reach[j]
            slight += fabs(J[k]) * size
            w.floors[i] += w.doubted[k] * fabs(y[j])
            if r >= w.positions and j < NQ and w.loose[j] == 0:
                w.floors[i] += fabs(J[k]) * FOUR_ULPS * w.widths[j]
        w.scales[i] = sizes[i] + SLIGHT * slight


def ratio(value: Real, floor: Real, scale: Real) -> Real:
    """A residual by what it is judged against, as far as it is no rounding."""
    if fabs(value) <= floor:
        return 0.0
    return fabs(value) / scale if 0.0 < scale and scale < inf else inf


def norm(c: Vec[NE], first: int, end: int, w: StartWork) -> Real:
    """Of the scaled residuals of w.rows[first..end-1]; infinity where one is not a number."""
    total = 0.0
    for k in range(first, end):
        i = w.rows[k]
        size = ratio(c[i], w.floors[i], w.scales[i])
        total += size * size
    return sqrt(total) if total == total else inf


def farthest(p: Params, t: Real, y: Vec[NU], end: int, w: StartWork) -> Real:
    """The largest scaled residual of w.rows[..end-1], infinity where one is not a number."""
    meet(p, t, y, w.c, w.J, w.sizes, w)
    judge(y, w.J, w.sizes, w)
    w.culprit = -1
    worst = 0.0
    for k in range(end):
        i = w.rows[k]
        size = ratio(w.c[i], w.floors[i], w.scales[i])
        if not size <= worst:
            worst = size if size == size else inf
            w.culprit = i
            if worst == inf:
                break
    return worst


def moving(i: int, w: StartWork) -> bool:
    """Whether speeds take part in condition i."""
    first = row_begin(i)
    end = ends[i]
    for k in range(first, end):
        if w.column[k] >= NQ:
            return True
    return False


def link(w: StartWork) -> None:
    """The derivatives of w.rows by each unknown: from w.last on by w.before, each with its w.owner."""
    for j in range(NU):
        w.last[j] = -1
    rows = w.ended
    for r in range(rows):
        i = w.rows[r]
        first = row_begin(i)
        end = ends[i]
        for k in range(first, end):
            w.owner[k] = i
            w.before[k] = w.last[w.column[k]]
            w.last[w.column[k]] = k


def queue(i: int, count: int, w: StartWork) -> int:
    """Put the unknowns of condition i into w.line, if they are not; how many are there."""
    w.chosen[i] = 1
    found = count
    first = row_begin(i)
    end = ends[i]
    for k in range(first, end):
        j = w.column[k]
        if w.marks[j] == 0:
            w.marks[j] = 1
            w.line[found] = j
            found += 1
    return found


def line_up_unknowns(w: StartWork) -> None:
    """w.line: the unknowns that the rows hold in the order in which they are met on the way from condition to
    condition, so that those that conditions tie to each other are near (E. Cuthill, J. McKee, 1969)."""
    link(w)
    for j in range(NU):
        w.marks[j] = 0
    for i in range(NE):
        w.chosen[i] = 0
    count = 0
    at = 0
    rows = w.ended
    for r in range(rows):
        if w.chosen[w.rows[r]] == 0:
            count = queue(w.rows[r], count, w)
        while at < count:
            k = w.last[w.line[at]]
            while k >= 0:
                if w.chosen[w.owner[k]] == 0:
                    count = queue(w.owner[k], count, w)
                k = w.before[k]
            at += 1


def find_pieces(w: StartWork) -> None:
    """Those that the rows are of."""
    w.first_piece = size(NPIECE)
    w.end_piece = 0
    rows = w.ended
    for r in range(rows):
        own = row_piece[w.rows[r]]
        if own >= 0 and own < w.first_piece:
            w.first_piece = own
        if own >= w.end_piece:
            w.end_piece = own + 1


def confine(n: Size, w: StartWork) -> None:
    """Look at the n conditions in w.order, those of positions first, and at the unknowns that they hold."""
    for i in range(NU):
        w.marks[i] = 0
    for i in range(n):
        first = row_begin(w.order[i])
        end = ends[w.order[i]]
        for k in range(first, end):
            w.marks[w.column[k]] = 1
    w.owned = 0
    for i in range(NU):
        if w.marks[i] == 1:
            w.own[w.owned] = i
            w.owned += 1
    w.ended = 0
    for i in range(n):
        if not moving(w.order[i], w):
            w.rows[w.ended] = w.order[i]
            w.ended += 1
    w.positions = w.ended
    for i in range(n):
        if moving(w.order[i], w):
            w.rows[w.ended] = w.order[i]
            w.ended += 1
    if NPIECE > 0:
        find_pieces(w)
    line_up_unknowns(w)


def unfold(w: StartWork) -> None:
    """w.column, out of stretches: there may be as many derivatives as pairs of unknowns."""
    n = 0
    for k in range(NSTRETCH):
        for j in range(stretch_begins[k], stretch_ends[k]):
            w.column[n] = j
            n += 1


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
    unfold(w)
    for i in range(NE):
        w.order[i] = i
    confine(NE, w)
    for i in range(NE):
        w.all[i] = w.rows[i]
