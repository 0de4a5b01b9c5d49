"""Residuals and Jacobian of the initial equations, and the sizes by which they are measured.

No absolute length, mass or time appears.  Each unknown has a size.  The residual of an equation counts
relative to the sum of the magnitudes of its terms and to its change over the sizes of its unknowns.
"""

from math import fabs, inf, sqrt

from lagc.kernels.arithmetic.quaternions import square_at
from lagc.kernels.initialization.workspace import UNSTATED, StartWork
from lagc.kernels.language.vocabulary import *

SLIGHT = 1.0 / 1024.0  # of the size of an unknown: its share in the scale of a residual; of a radian


def part_begin(i: int) -> int:
    """Return the index of the first partial derivative of equation i, or of a sum behind the equations."""
    return part_ends[i - 1] if i > 0 else 0


def assemble_slopes(J: Vec[NJ]) -> None:
    """Assemble J from partial derivatives by unknowns and shared sums, by the chain rule, last sum first."""
    parts = vector(NPARTS)
    for k in range(NPARTS):
        parts[k] = J[k]
    total = vector(NWHOLE)  # derivatives by all unknowns, then by all sums
    for j in range(NWHOLE):
        total[j] = 0.0
    made = 0
    stretch = 0
    for i in range(NCOND):
        # The equation as it is written: by unknowns and by sums, `last` the last of these.
        first = part_begin(i)
        last = -1
        for k in range(first, part_ends[i]):
            total[part_column[k]] = parts[k]
            if part_column[k] - NU > last:
                last = part_column[k] - NU
        # A sum depends on unknowns and on sums before it, so that backwards each is complete when it is met.
        for n in range(last + 1):
            at = last - n
            slope = total[NU + at]
            total[NU + at] = 0.0
            if slope != 0.0:
                for k in range(part_begin(NCOND + at), part_ends[NCOND + at]):
                    total[part_column[k]] += slope * parts[k]
        while made < ends[i]:
            for j in range(stretch_begins[stretch], stretch_ends[stretch]):
                J[made] = total[j]
                total[j] = 0.0
                made += 1
            stretch += 1


def row_begin(i: int) -> int:
    """Return the index in J of the first derivative of equation i."""
    return ends[i - 1] if i > 0 else 0


def complete_row(i: int, y: Vec[NU], w: StartWork) -> None:
    """Complete equation i where it is that of a stated rate or of a unit quaternion."""
    # Equations behind those of the model: rate - value, then (|e|^2 - 1) / 2 with its gradient e.
    if NRATE > 0:
        k = i - (NCOND - NRATE)
        if k >= 0 and k < NRATE:
            w.c[i] -= y[NQ + NV + k]
            w.term_sizes[i] += fabs(y[NQ + NV + k])
    if NQUAT > 0:
        if i >= NCOND:
            at = quaternion[i - NCOND]
            first = row_begin(i)
            w.c[i] = 0.5 * (square_at(y, at) - 1.0)
            w.term_sizes[i] = 1.0
            for j in range(4):
                w.J[first + j] = y[at + j]


def evaluate(p: Params, t: Real, y: Vec[NU], w: StartWork) -> None:
    """Evaluate residuals, Jacobian and term sizes of all equations."""
    if NCOND > 0:
        fn_conditions(p, t, y, w.c, w.J, w.term_sizes)
    if NSUM > 0:
        assemble_slopes(w.J)
    if NRATE > 0 or NQUAT > 0:
        for i in range(NCOND - NRATE, NE):
            complete_row(i, y, w)


def mark_roundoff(p: Params, t: Real, y: Vec[NU], w: StartWork) -> None:
    """Set w.roundoff: the derivatives by speeds at y that are round-off, as r cos(a) at a quarter turn.  They
    change by their own magnitude where positions change by units in the last place (N. J. Higham, *Accuracy
    and Stability of Numerical Algorithms*, 2002, section 1.10)."""
    # Positions up by four units in the last place: a derivative that changes by as much as it is has no
    # digits.
    w.trial[:] = y
    for i in range(NQ):
        w.trial[i] *= 1.0 + FOUR_ULPS
    evaluate(p, t, w.trial, w)
    w.other_J[:] = w.J
    evaluate(p, t, y, w)
    for k in range(NJ):
        change = fabs(w.J[k] - w.other_J[k])
        w.roundoff[k] = 1 if w.column[k] >= NQ and 0.0 < fabs(w.J[k]) and fabs(w.J[k]) <= change else 0


def scale_rows(y: Vec[NU], w: StartWork) -> None:
    """Set w.row_scaling at y: the terms of each equation, and its change by w.share of its unknowns."""
    # Terms as they are written, plus what a share of its unknowns' sizes would change: an equation with
    # vanishing terms still has a scale.
    for i in range(NE):
        slight = 0.0
        for k in range(row_begin(i), ends[i]):
            j = w.column[k]
            slight += fabs(w.J[k]) * (w.scaling[j] if fabs(y[j]) < w.scaling[j] else fabs(y[j]))
        w.row_scaling[i] = w.term_sizes[i] + w.share * slight


def relative_residual(i: int, w: StartWork) -> Real:
    """Return the residual of equation i relative to its scale; infinite where it is not a number."""
    if w.c[i] == 0.0:
        return 0.0
    size = fabs(w.c[i]) / w.row_scaling[i]
    return size if size < inf else inf


def start_norm(first: int, end: int, w: StartWork) -> Real:
    """Return the norm of the relative residuals of w.rows[first..end-1]; w.worst and w.culprit: the
    largest."""
    w.worst = 0.0
    w.culprit = -1
    total = 0.0
    for r in range(first, end):
        size = relative_residual(w.rows[r], w)
        total += size * size
        if size > w.worst:
            w.worst = size
            w.culprit = w.rows[r]
    return sqrt(total) if w.worst < inf else inf


def start_residual(p: Params, t: Real, y: Vec[NU], first: int, end: int, rescale: bool, w: StartWork) -> Real:
    """Evaluate all equations at y; return the norm of the residuals of w.rows[first..end-1]."""
    evaluate(p, t, y, w)
    if rescale:
        scale_rows(y, w)
    return start_norm(first, end, w)


def grow_sizes(w: StartWork) -> bool:
    """Give unknowns without a size that by which they balance the known terms of an equation, the least that
    any equation implies; return whether there were any."""
    # The least size that any equation implies for an unknown without one: known terms over its derivative.
    for n in range(NU):
        w.trial[n] = inf
    found = False
    for i in range(NE):
        known = w.term_sizes[i]
        for k in range(row_begin(i), ends[i]):
            if w.scaling[w.column[k]] > 0.0:
                known += fabs(w.J[k]) * w.scaling[w.column[k]]
        for k in range(row_begin(i), ends[i]):
            j = w.column[k]
            share = known / fabs(w.J[k]) if w.roundoff[k] == 0 else 0.0
            if w.scaling[j] == 0.0 and LEAST_WEIGHT < share and share < MOST_WEIGHT and share < w.trial[j]:
                w.trial[j] = share
                found = True
    for n in range(NU):
        if w.trial[n] < inf:
            w.scaling[n] = w.trial[n]
    return found


def set_sizes(p: Params, t: Real, largest: Vec[NU], w: StartWork) -> None:
    """Set w.scaling: the size of an unknown is its stated magnitude, else the largest of its unit, else what
    the equations imply, else that of parameters of its unit (`largest`), else 1."""
    # The largest guess of each unit.  One that is not stated may be small by chance, as round-off.
    for i in range(NU):
        w.unit_size[i] = 0.0
    for i in range(NU):
        least = 0.0 if w.levels[i] > UNSTATED else SLIGHT * largest[unit[i]]
        if fabs(w.guess[i]) > w.unit_size[unit[i]] and fabs(w.guess[i]) > least:
            w.unit_size[unit[i]] = fabs(w.guess[i])
    # Stated values have their own size; unstated ones and zeros that of their unit.
    for i in range(NU):
        w.scaling[i] = fabs(w.guess[i])
        if w.levels[i] == UNSTATED or w.guess[i] == 0.0:
            w.scaling[i] = w.unit_size[unit[i]]
    # Sizes pass from equation to equation; then those of a unit without a guess have the largest in common.
    mark_roundoff(p, t, w.guess, w)
    more = True
    while more:
        more = grow_sizes(w)
    for i in range(NU):
        if w.unit_size[unit[i]] == 0.0 and w.scaling[i] > largest[unit[i]]:
            largest[unit[i]] = w.scaling[i]
    for i in range(NU):
        if w.unit_size[unit[i]] == 0.0 and largest[unit[i]] > 0.0:
            w.scaling[i] = largest[unit[i]]
        if not (LEAST_WEIGHT < w.scaling[i] and w.scaling[i] < MOST_WEIGHT):
            w.scaling[i] = 1.0
        # An angle counts as at least a thousandth of a radian, and at most one.
        if angle[i] == 1:
            w.scaling[i] = 1.0 if w.scaling[i] > 1.0 else (w.scaling[i] if w.scaling[i] > SLIGHT else SLIGHT)
    if NQUAT > 0:
        for k in range(NQUAT):
            for i in range(4):
                w.scaling[quaternion[k] + i] = 1.0
