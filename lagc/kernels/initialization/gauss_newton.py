"""Gauss-Newton iteration with least-norm steps."""

from math import fabs, floor, inf, sqrt

from lagc.kernels.initialization.least_norm import least_norm
from lagc.kernels.initialization.residuals import (
    evaluate_rows,
    is_roundoff,
    largest_residual,
    relative_residual,
    residual_norm,
    row_begin,
    scale_rows,
)
from lagc.kernels.initialization.scaling import estimate_slope_roundoff
from lagc.kernels.initialization.workspace import UNSTATED, StartWork
from lagc.kernels.language.vocabulary import *

NEWTON_STEPS = 60
STALLED_STEPS = 8  # the iteration ends if the residual is not halved in this many steps
ROWS_PER_STEP = 8  # equations for each further step: errors may pass from one to the next
FULL_STEP = 0.6  # least fraction of the longest step, where no halving is tried
ENTRYWISE = 2  # number of the last trial: round-off is removed entry by entry
LEAST_HALVING = 1.0 / 16384.0  # least fraction of the longest step that is tried
POLISH_STEPS = 4
OVERSHOOT = 2.0  # ratio of residuals: a step that increases the residual more is too long
LEAST_FRACTION = 1e-30  # least fraction of a step that is too long
PULL_STEPS = 20  # steps towards the guess
FULL_TURN = 6.283185307179586


def select_columns(first: Size, end: Size, w: StartWork) -> None:
    """Set w.columns: the free unknowns first..end-1, coupled ones side by side."""
    w.column_count = 0
    for k in range(w.unknown_count):
        i = w.ordered[k]
        w.column_of[i] = -1
        if first <= i and i < end and w.free[i] == 1:
            w.column_of[i] = w.column_count
            w.columns[w.column_count] = i
            w.column_count += 1


def find_row_range(i: int, r: int, w: StartWork) -> None:
    """Set w.first_column and w.end_column of row r, which holds equation i."""
    begin = w.column_count
    stop = 0
    for e in range(row_begin(i), ends[i]):
        at = w.column_of[w.column[e]]
        if at >= 0:
            begin = at if at < begin else begin
            stop = at + 1 if at >= stop else stop
    w.first_column[r] = begin if begin < stop else 0
    w.end_column[r] = stop


def fill(first: int, end: int, w: StartWork) -> None:
    """Set w.matrix to the scaled Jacobian of w.rows[first..end-1] in w.columns, without entries that are
    round-off, and w.right to minus the residuals."""
    for k in range(first, end):
        find_row_range(w.rows[k], k - first, w)
        row = w.matrix[k - first]
        for j in range(w.first_column[k - first], w.end_column[k - first]):
            row[j] = 0.0
        for e in range(row_begin(w.rows[k]), ends[w.rows[k]]):
            i = w.column[e]
            if w.column_of[i] >= 0 and not is_roundoff(e, w):
                row[w.column_of[i]] = w.J[e] * w.step_scaling[i]
        w.right[k - first] = -w.c[w.rows[k]]


def move_along(y: Vec[NU], base: Vec[NU], factor: Real, w: StartWork) -> None:
    """Set y, in w.columns, to base plus a fraction of w.step."""
    for k in range(w.column_count):
        i = w.columns[k]
        y[i] = base[i] + factor * w.step[k] * w.step_scaling[i]


def accept_trial(y: Vec[NU], w: StartWork) -> None:
    """Accept w.trial as y, with its residuals and Jacobian."""
    for k in range(w.column_count):
        y[w.columns[k]] = w.trial[w.columns[k]]
    for r in range(w.row_count):
        i = w.rows[r]
        w.c[i] = w.trial_c[i]
        w.term_sizes[i] = w.trial_term_sizes[i]
        for k in range(row_begin(i), ends[i]):
            w.J[k] = w.trial_J[k]
    scale_rows(y, w.J, w.term_sizes, w)


def largest_fraction(w: StartWork) -> Real:
    """The largest fraction of w.step that turns no angle by more than a radian."""
    factor = 1.0
    for k in range(w.column_count):
        i = w.columns[k]
        rotation = fabs(w.step[k]) * w.step_scaling[i]
        if angle[i] == 1 and rotation * factor > 1.0:
            factor = 1.0 / rotation
    return factor


def line_search(p: Params, t: Real, y: Vec[NU], first: int, end: int, residual: Real, longest: Real,
              shortest: Real, w: StartWork) -> Real:  # fmt: skip
    """Return the residual at w.trial, which is y plus the first fraction of w.step that reduces it: 1, then
    `longest`, its half and so on down to `shortest` of it. -1 if none does."""
    least = shortest * longest
    factor = 1.0
    size = inf
    w.trial[:] = y
    while least > 0.0 and factor >= (
        least if w.full_steps or size < OVERSHOOT * residual else LEAST_FRACTION
    ):
        move_along(w.trial, y, factor, w)
        evaluate_rows(p, t, w.trial, w.trial_c, w.trial_J, w.trial_term_sizes, w)
        size = residual_norm(w.trial_c, first, end, w)
        if size < residual * (1.0 - (0.1 * factor if factor <= longest else 0.999)):
            return size
        factor = 0.5 * factor if factor <= longest else longest
    return -1.0


def solve_step(w: StartWork, m: int, trial_number: int) -> bool:
    """Set w.step to the least-norm solution of the m rows of w.matrix.  Rows count as dependent below a
    threshold, which is larger in the second trial; in the third, round-off is removed entry by entry."""
    if trial_number == ENTRYWISE:
        return least_norm(w, m, w.column_count, 0.0, FOLLOWING)
    return least_norm(w, m, w.column_count, FOLLOWING if trial_number == 0 else SURELY_FOLLOWING, 0.0)


def unscaled_norm(c: Vec[NE], sizes: Vec[NE], first: int, end: int, w: StartWork) -> Real:
    """The norm of residuals relative to their own terms, of the rows that contain free unknowns."""
    total = 0.0
    for k in range(first, end):
        i = w.rows[k]
        free = False
        for e in range(row_begin(i), ends[i]):
            free = free or (w.column_of[w.column[e]] >= 0 and not is_roundoff(e, w))
        if free:
            faint = CLOSE * w.row_scaling[i]
            if 0.0 < w.guess_term_sizes[i] and w.guess_term_sizes[i] < faint:
                faint = w.guess_term_sizes[i]
            size = relative_residual(c[i], w.roundoff[i], sizes[i] + faint)
            total += size * size
    return sqrt(total)


def polish(p: Params, t: Real, y: Vec[NU], first: int, end: int, w: StartWork) -> None:
    """Take steps that reduce residuals relative to their own terms, if all scaled residuals vanish."""
    residual = unscaled_norm(w.c, w.term_sizes, first, end, w)
    for n in range(POLISH_STEPS):
        if residual <= CLOSE:
            return
        fill(first, end, w)
        w.work += 1
        if not solve_step(w, end - first, ENTRYWISE):
            return
        w.trial[:] = y
        move_along(w.trial, y, 1.0, w)
        evaluate_rows(p, t, w.trial, w.trial_c, w.trial_J, w.trial_term_sizes, w)
        left = unscaled_norm(w.trial_c, w.trial_term_sizes, first, end, w)
        if not (left < 0.5 * residual and residual_norm(w.trial_c, first, end, w) <= CLOSE):
            return
        residual = left
        accept_trial(y, w)


def only_speeds(w: StartWork) -> bool:
    """Whether no coordinate is among w.columns."""
    for k in range(w.column_count):
        if w.columns[k] < NQ:
            return False
    return True


def iterate(p: Params, t: Real, y: Vec[NU], first: int, end: int, w: StartWork) -> None:
    """Gauss-Newton with least-norm steps on w.rows[first..end-1] in w.columns, with line search (P.
    Deuflhard, *Newton Methods for Nonlinear Problems*, 2004, section 4.4)."""
    if first == end or w.column_count == 0:
        return
    evaluate_rows(p, t, y, w.c, w.J, w.term_sizes, w)
    scale_rows(y, w.J, w.term_sizes, w)
    residual = residual_norm(w.c, first, end, w)
    w.entry_roundoff[:] = w.slope_roundoff
    if residual <= CLOSE:
        polish(p, t, y, first, end, w)
        return
    if only_speeds(w):  # the round-off of positions stays the same
        estimate_slope_roundoff(p, t, y, w.scaling, w)
    left = 1.0
    longest = 1.0
    more = (end - first) // ROWS_PER_STEP
    for n in range(NEWTON_STEPS + more):
        if not (EXACT < residual and residual < inf):
            polish(p, t, y, first, end, w)
            return
        if n > 0 and n % (STALLED_STEPS + more) == 0:
            if longest == 1.0 and not left < 0.5:
                return
            left = 1.0
        size = -1.0
        rows_dropped = False
        for trial_number in range(3):
            if trial_number == ENTRYWISE and not rows_dropped:
                break
            fill(first, end, w)
            w.work += 1
            if not solve_step(w, end - first, trial_number):
                return
            longest = largest_fraction(w)
            rows_dropped = rows_dropped or (trial_number == 0 and w.dropped_rows > 0)
            shortest = (
                FULL_STEP if trial_number == ENTRYWISE or residual <= CLOSE or w.full_steps else LEAST_HALVING
            )
            size = line_search(p, t, y, first, end, residual, longest, shortest, w)
            if size >= 0.0:
                break
        if size < 0.0:
            return
        left *= size / residual
        accept_trial(y, w)
        residual = residual_norm(w.c, first, end, w)


def attempt(p: Params, t: Real, y: Vec[NU], w: StartWork) -> None:
    """Solve for positions, then for speeds; for all together if that is not enough."""
    select_columns(0, NQ, w)
    iterate(p, t, y, 0, w.position_rows, w)
    if not largest_residual(p, t, y, w.position_rows, w) <= ACCEPTED:
        return
    select_columns(NQ, NU, w)
    iterate(p, t, y, w.position_rows, w.row_count, w)
    if largest_residual(p, t, y, w.row_count, w) <= ACCEPTED:
        return
    select_columns(0, NU, w)
    iterate(p, t, y, 0, w.row_count, w)


def leads_to_start(p: Params, t: Real, y: Vec[NU], w: StartWork) -> bool:
    """Attempt from y; return whether it reaches a start."""
    attempt(p, t, y, w)
    return largest_residual(p, t, y, w.row_count, w) <= ACCEPTED


def distance(y: Vec[NU], w: StartWork) -> Real:
    """The scaled distance of y from the guess."""
    total = 0.0
    for k in range(w.unknown_count):
        i = w.unknowns[k]
        move = (y[i] - w.guess[i]) / w.step_scaling[i]
        total += move * move
    return sqrt(total)


def unstated_distance(y: Vec[NU], w: StartWork) -> Real:
    """The scaled distance of the unstated values from the guess."""
    total = 0.0
    for k in range(w.unknown_count):
        i = w.unknowns[k]
        if w.levels[i] == UNSTATED:
            move = (y[i] - w.guess[i]) / w.scaling[i]
            total += move * move
    return sqrt(total)


def step_to_guess(p: Params, t: Real, y: Vec[NU], end: int, trial_number: int, w: StartWork) -> bool:
    """Set w.step: from the guess to the nearest point that meets the equations linearised at y; False where a
    number is not finite."""
    evaluate_rows(p, t, y, w.c, w.J, w.term_sizes, w)
    w.entry_roundoff[:] = w.slope_roundoff
    fill(0, end, w)
    for r in range(end):
        value = w.right[r]
        for k in range(w.first_column[r], w.end_column[r]):
            i = w.columns[k]
            value += w.matrix[r][k] * ((y[i] - w.guess[i]) / w.step_scaling[i])
        w.right[r] = value
    w.work += 1
    return solve_step(w, end, trial_number)


def pull_to_guess(p: Params, t: Real, y: Vec[NU], w: StartWork) -> None:
    """Move y to a start nearer to the guess, as far as least-norm steps lead; positions alone, if the
    guessed speeds allow it."""
    alone = True
    w.tried[:] = w.guess
    for i in range(NQ):
        w.tried[i] = y[i]
    if leads_to_start(p, t, w.tried, w):
        y[:] = w.tried
    else:
        alone = False
    distance_before = distance(y, w)
    end = w.position_rows if alone else w.row_count
    for n in range(PULL_STEPS):
        select_columns(0, NQ if alone else NU, w)
        if w.column_count == 0 or end == 0:
            return
        if not step_to_guess(p, t, y, end, 0, w):
            return
        w.tried[:] = w.guess
        move_along(w.tried, w.guess, 1.0, w)
        attempt(p, t, w.tried, w)
        distance_now = distance(w.tried, w)
        if not (
            distance_now < distance_before and largest_residual(p, t, w.tried, w.row_count, w) <= ACCEPTED
        ):
            return
        y[:] = w.tried
        distance_before = distance_now


def remove_turns(p: Params, t: Real, y: Vec[NU], w: StartWork) -> None:
    """Remove whole turns of angles in y, where that is a start too."""
    has_turns = False
    w.tried[:] = y
    for k in range(w.unknown_count):
        i = w.unknowns[k]
        if angle[i] == 1:
            turns = floor((y[i] - w.guess[i]) / FULL_TURN + 0.5)
            if turns != 0.0:
                w.tried[i] = y[i] - FULL_TURN * turns
                has_turns = True
    if has_turns and leads_to_start(p, t, w.tried, w):
        y[:] = w.tried
