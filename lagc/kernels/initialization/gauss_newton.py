"""The Gauss-Newton method with steps of least norm.

It solves some of the initial equations, w.rows[first..end-1], in some of the unknowns, w.columns.  Lengths of
steps are measured in w.step_scaling.
"""

from math import fabs, floor, inf, sqrt
from typing import Any

from lagc.kernels.initialization.residuals import SLIGHT, row_begin, scale_rows, start_norm, start_residual
from lagc.kernels.initialization.workspace import StartWork
from lagc.kernels.language.vocabulary import *

NEWTON_STEPS = 60
STALLED_STEPS = 8  # the iteration ends if the residual is not halved in this many steps
ROWS_PER_STEP = 8  # equations for each further step: errors may pass from one to the next
LEAST_HALVING = 1.0 / 16384.0  # least fraction of the longest step that is tried
ROUNDS = 8  # reweighted solutions
STATED = 1.0 / 1024.0  # weight of stated values in these, by which unstated ones move first
FULL_TURN = 6.283185307179586


def inner(a: Vec[Any], b: Vec[Any], begin: int, stop: int) -> Real:
    """Return the inner product of a[begin:stop] and b[begin:stop]."""
    total = 0.0
    for j in range(begin, stop):
        total += a[j] * b[j]
    return total


def normalize_row(row: Vec[Any], begin: int, stop: int) -> Real:
    """Make row[begin:stop] a unit vector; return its length, 0 where it is none."""

    largest = 0.0
    for j in range(begin, stop):
        if not fabs(row[j]) <= largest:
            largest = fabs(row[j])
    if not (0.0 < largest and largest < inf):
        return largest
    for j in range(begin, stop):
        row[j] = row[j] / largest  # squares neither overflow nor vanish
    length = sqrt(inner(row, row, begin, stop))
    for j in range(begin, stop):
        row[j] = row[j] / length
    return largest * length


def subtract_projection(w: StartWork, i: int, along: int) -> None:
    """Subtract from row i of w.orthogonal its projection on a unit row; rows are zero outside their range."""
    values = w.orthogonal[i]
    # Overlap of both ranges: an inner product needs no more.
    direction = w.orthogonal[along]
    low = w.first_nonzero[along]
    high = w.end_nonzero[along]
    begin = low if low > w.first_nonzero[i] else w.first_nonzero[i]
    stop = high if high < w.end_nonzero[i] else w.end_nonzero[i]
    factor = inner(values, direction, begin, stop) if begin < stop else 0.0
    if factor == 0.0:
        return
    # The range grows by that of the unit row; new entries were not written before.
    for j in range(low, w.first_nonzero[i]):
        values[j] = 0.0
    for j in range(w.end_nonzero[i], high):
        values[j] = 0.0
    if low < w.first_nonzero[i]:
        w.first_nonzero[i] = low
    if high > w.end_nonzero[i]:
        w.end_nonzero[i] = high
    for j in range(low, high):
        values[j] -= factor * direction[j]


def are_disjoint(w: StartWork, i: int, other: int) -> bool:
    """Return whether the ranges of two rows of w.orthogonal have no column in common."""
    return w.first_nonzero[i] >= w.end_nonzero[other] or w.first_nonzero[other] >= w.end_nonzero[i]


def choose_row(w: StartWork, i: int, m: int) -> bool:
    """Make row i of w.orthogonal a unit vector orthogonal to the chosen ones; return whether it is one."""
    # A second pass of Gram-Schmidt after the row is normalized: two are enough (W. Kahan, B. N. Parlett).
    values = w.orthogonal[i]
    normalize_row(values, w.first_nonzero[i], w.end_nonzero[i])
    for k in range(m):
        if w.remaining[k] == 0.0 and not are_disjoint(w, i, k):
            subtract_projection(w, i, k)  # a second time, for the round-off of the first
    if normalize_row(values, w.first_nonzero[i], w.end_nonzero[i]) == 0.0:
        return False
    # Entries far below round-off at both ends narrow the range again.
    while fabs(values[w.first_nonzero[i]]) <= FADED:
        w.first_nonzero[i] += 1
    while fabs(values[w.end_nonzero[i] - 1]) <= FADED:
        w.end_nonzero[i] -= 1
    return True


def step_along(w: StartWork, i: int) -> bool:
    """Move w.step along row i of w.orthogonal until equation i is met; False if that row is round-off."""
    # The direction is orthogonal to the rows before, so a step along it leaves their equations met: its
    # length follows from the residual of this one.
    direction = w.orthogonal[i]
    begin = w.first_nonzero[i] if w.first_column[i] < w.first_nonzero[i] else w.first_column[i]
    stop = w.end_nonzero[i] if w.end_nonzero[i] < w.end_column[i] else w.end_column[i]
    slope = inner(w.matrix[i], direction, begin, stop) if begin < stop else 0.0
    if slope == 0.0:
        return False
    residual = w.right[i] - inner(w.matrix[i], w.step, w.first_column[i], w.end_column[i])
    for j in range(w.first_nonzero[i], w.end_nonzero[i]):
        w.step[j] += residual / slope * direction[j]
    return True


def least_norm(w: StartWork, m: int, dependent: Real) -> bool:
    """Set w.step to the least-norm solution of the m rows of w.matrix and w.right; False where a number is
    not finite.

    A rank-revealing QR factorization of the transpose, by modified Gram-Schmidt with pivoting, each row twice
    (A. Bjorck, *Numerical Methods for Least Squares Problems*, 1996, section 2.4): the row with the longest
    remainder comes next, relative to the terms of its equation; rows with a remainder below `dependent` of
    their length are dropped."""
    w.work += 1
    for j in range(w.column_count):
        w.step[j] = 0.0
    # Unit rows, so that a remainder is a sine; their lengths, relative to the terms, choose the order.
    for i in range(m):
        length = normalize_row(w.matrix[i], w.first_column[i], w.end_column[i])
        if not (length < inf and fabs(w.right[i]) < inf):
            return False
        w.remaining[i] = -1.0
        if length > SPACING:
            w.remaining[i] = 1.0
            w.lengths[i] = length
            w.right[i] = w.right[i] / length
            w.first_nonzero[i] = w.first_column[i]
            w.end_nonzero[i] = w.end_column[i]
            row = w.matrix[i]
            rest = w.orthogonal[i]
            for j in range(w.first_column[i], w.end_column[i]):
                rest[j] = row[j]
    # The row with the longest remainder next, in the sizes of its terms: QR with column pivoting of the
    # transpose.
    while True:
        best = -1
        longest = 0.0
        for i in range(m):
            size = w.remaining[i] * w.lengths[i] * w.lengths[i]
            if w.remaining[i] > dependent * dependent and size > longest:
                best = i
                longest = size
        if best < 0:
            return True
        w.remaining[best] = -1.0
        if not choose_row(w, best, m) or not step_along(w, best):
            continue
        # Equations that are met stay met: the new direction is orthogonal to theirs.
        w.remaining[best] = 0.0
        for i in range(m):
            if w.remaining[i] > 0.0 and not are_disjoint(w, i, best):
                subtract_projection(w, i, best)
                rest = w.orthogonal[i]
                w.remaining[i] = inner(rest, rest, w.first_nonzero[i], w.end_nonzero[i])


def fill(first: int, end: int, w: StartWork) -> None:
    """Set w.matrix to the scaled Jacobian, w.right to minus the scaled residuals."""
    # The range of columns of each row, from the unknowns that may move.
    for r in range(first, end):
        i = w.rows[r]
        begin = w.column_count
        stop = 0
        for k in range(row_begin(i), ends[i]):
            at = w.column_of[w.column[k]]
            if at >= 0:
                begin = at if at < begin else begin
                stop = at + 1 if at >= stop else stop
        row = w.matrix[r - first]
        for j in range(begin, stop):
            row[j] = 0.0
        # Scaled entries: derivative times size of the unknown over the scale of the equation. Derivatives
        # that are round-off count as zero.
        for k in range(row_begin(i), ends[i]):
            at = w.column_of[w.column[k]]
            if at >= 0 and w.J[k] != 0.0 and w.roundoff[k] == 0:  # a scale is 0 where nothing depends
                row[at] = w.J[k] * w.step_scaling[w.column[k]] / w.row_scaling[i]
        w.first_column[r - first] = begin if begin < stop else 0
        w.end_column[r - first] = stop
        w.right[r - first] = -w.c[i] / w.row_scaling[i] if w.c[i] != 0.0 else 0.0


def set_step(y: Vec[NU], base: Vec[NU], factor: Real, w: StartWork) -> None:
    """Set y, in w.columns, to base plus a fraction of w.step."""
    for k in range(w.column_count):
        i = w.columns[k]
        y[i] = base[i] + factor * w.step[k] * w.step_scaling[i]


def line_search(p: Params, t: Real, first: int, end: int, residual: Real, w: StartWork) -> Real:
    """Move w.y by the first fraction of w.step that reduces the residual; return the new residual, -1 if no
    fraction does.

    The whole step is taken if it all but meets the equations.  Else the first fraction is the longest that
    turns no angle by more than a radian; then its half, and so on."""
    # A full step of an angle of more than a radian is likely to lead to another branch.
    longest = 1.0
    for k in range(w.column_count):
        i = w.columns[k]
        rotation = fabs(w.step[k]) * w.step_scaling[i]
        if angle[i] == 1 and rotation * longest > 1.0:
            longest = 1.0 / rotation
    # The whole step is tried first, and taken if it leaves a thousandth; it need not be the longest one that
    # angles allow.
    factor = 1.0
    w.trial[:] = w.y
    while factor >= LEAST_HALVING * longest:
        set_step(w.trial, w.y, factor, w)
        size = start_residual(p, t, w.trial, first, end, False, w)  # in the scales of w.y, to be comparable
        if size < residual * (1.0 - 0.1 * factor if factor <= longest else 0.001):
            w.y[:] = w.trial
            scale_rows(w.y, w)
            return start_norm(first, end, w)
        # At round-off no fraction will do better.
        if residual <= CLOSE:
            return -1.0
        factor = 0.5 * factor if factor <= longest else longest
    return -1.0


def newton(p: Params, t: Real, first: int, end: int, w: StartWork) -> bool:
    """Gauss-Newton with least-norm steps and line search (P. Deuflhard, *Newton Methods for Nonlinear
    Problems*, 2004, section 4.4) from w.y; return whether w.y meets the equations."""
    if start_residual(p, t, w.y, first, end, True, w) <= CLOSE:
        return True
    # First relative to the full sizes of unknowns, where no residual saturates; once these are met, relative
    # to what equations hold, however little that is.
    w.share = 1.0
    residual = start_residual(p, t, w.y, first, end, True, w)
    mark = residual
    more = (end - first) // ROWS_PER_STEP
    for n in range(NEWTON_STEPS + more):
        if w.share == 1.0 and residual <= CLOSE:
            w.share = SLIGHT
            residual = start_residual(p, t, w.y, first, end, True, w)
            mark = residual
        if not (EXACT < residual and residual < inf):
            break
        # Progress is looked at every few steps: a residual that is not halved in these is stuck.
        if n > 0 and n % (STALLED_STEPS + more) == 0:
            if not residual < 0.5 * mark:
                break
            mark = residual
        # Rows that almost depend on others ask for steps that are too long: they are dropped the second time.
        size = -1.0
        for attempt in range(2):
            fill(first, end, w)
            if not least_norm(w, end - first, FOLLOWING if attempt == 0 else SURELY_FOLLOWING):
                break
            size = line_search(p, t, first, end, residual, w)
            if size >= 0.0:
                break
            start_residual(p, t, w.y, first, end, True, w)
        if size < 0.0:
            break
        residual = size
    w.share = SLIGHT
    start_residual(p, t, w.y, first, end, True, w)
    return w.worst <= ACCEPTED


def distance(w: StartWork) -> Real:
    """Return the distance of w.y from the guess, in the weights of a step."""
    total = 0.0
    for k in range(w.column_count):
        i = w.columns[k]
        move = (w.y[i] - w.guess[i]) / w.step_scaling[i]
        total += move * move
    return sqrt(total)


def draw_back(p: Params, t: Real, first: int, end: int, steps: int, w: StartWork) -> None:
    """Move w.y, a solution, nearer to the guess: to the point of the linearized equations that is nearest to
    it, and from there to a solution, up to `steps` times, as long as that is nearer."""
    # The nearest point of the linearized equations to the guess: J (z - guess) = -c + J (y - guess).
    for n in range(steps):
        w.before[:] = w.y
        far = distance(w)
        fill(first, end, w)
        for r in range(end - first):
            row = w.matrix[r]
            for k in range(w.first_column[r], w.end_column[r]):
                i = w.columns[k]
                w.right[r] += row[k] * (w.y[i] - w.guess[i]) / w.step_scaling[i]
        if not least_norm(w, end - first, FOLLOWING):
            return
        # From there Newton's method again; the point before comes back unless that is nearer.
        set_step(w.y, w.guess, 1.0, w)
        if not (newton(p, t, first, end, w) and distance(w) < far):
            w.y[:] = w.before
            start_residual(p, t, w.y, first, end, True, w)
            return


def tidy(p: Params, t: Real, first: int, end: int, w: StartWork) -> None:
    """Remove whole turns of angles from w.y, then moves that are round-off, each where that is a solution
    too."""
    # Turns first (angles), then traces: moves of less than 1e-6 of a size count as none if the residual
    # stays.
    for trace in range(2):
        w.before[:] = w.y
        residual = w.worst if w.worst > CLOSE else CLOSE
        for k in range(w.column_count):
            i = w.columns[k]
            if trace == 0 and angle[i] == 1:
                w.y[i] -= FULL_TURN * floor((w.y[i] - w.guess[i]) / FULL_TURN + 0.5)
            if trace == 1 and fabs(w.y[i] - w.guess[i]) <= TRACE * w.scaling[i]:
                w.y[i] = w.guess[i]
        start_residual(p, t, w.y, first, end, True, w)
        if not w.worst <= residual:
            w.y[:] = w.before
            start_residual(p, t, w.y, first, end, True, w)


def relax(p: Params, t: Real, level: int, first: int, end: int, w: StartWork) -> None:
    """Move few of the values of a level: repeat the least-norm solution, each value scaled by its last move
    (FOCUSS: I. F. Gorodnitsky, B. D. Rao, *IEEE Trans. Signal Process.* 45, 1997)."""
    # Values of this level are weighted by their last moves: those that moved little get dearer, so that in
    # the end few move. Unstated ones are a thousand times cheaper.
    for n in range(ROUNDS):
        for k in range(w.column_count):
            i = w.columns[k]
            w.step_scaling[i] = w.scaling[i]
            if w.levels[i] == level:
                share = fabs(w.y[i] - w.guess[i]) / w.scaling[i]
                share = 1.0 if share > 1.0 else share
                w.step_scaling[i] = STATED * w.scaling[i] * (share if share > LEAST_SHARE else LEAST_SHARE)
        draw_back(p, t, first, end, 1, w)
