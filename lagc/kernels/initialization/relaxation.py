"""The choice of the stated values that move: few of them, by reweighted least-norm solutions.

Where stated values contradict the initial equations, the least-norm solution moves all of them a little.
FOCUSS (I. F. Gorodnitsky, B. D. Rao, IEEE Trans. Signal Process. 45, 1997) repeats it on the linearised
equations, each value scaled by its last move: moves that are not needed vanish.  Then each value that still
moves is put back if a start remains, the least move first.
"""

from math import fabs, sqrt

from lagc.kernels.initialization.gauss_newton import (
    fill,
    leads_to_start,
    move_along,
    select_columns,
    solve_step,
    step_to_guess,
)
from lagc.kernels.initialization.least_norm import inner
from lagc.kernels.initialization.multistart import NEAR, SPREADS, multistart
from lagc.kernels.initialization.residuals import SLIGHT, evaluate_rows, scale_rows, set_scales
from lagc.kernels.initialization.workspace import UNSTATED, StartWork
from lagc.kernels.language.vocabulary import *

ROUNDS = 8  # reweighted solutions
DETERMINED = 1e-6  # the change of an entry of a projection that is none
FARTHER = 10.0  # times the moves of a start: one that moves more is not better


def set_free(first: int, free: int, w: StartWork) -> None:
    """Free or hold a value, a quaternion as a whole."""
    w.free[first] = free
    i = first + 1
    while i < NU and w.part[i] == 1:
        w.free[i] = free
        i += 1


def share(first: int, y: Vec[NU], w: StartWork) -> Real:
    """The distance of a value from its guess, of a quaternion as a whole, in proportion to its size."""
    move = (y[first] - w.guess[first]) / w.scaling[first]
    total = move * move
    i = first + 1
    while i < NU and w.part[i] == 1:
        move = (y[i] - w.guess[i]) / w.scaling[i]
        total += move * move
        i += 1
    return sqrt(total)


def restore(first: int, y: Vec[NU], w: StartWork) -> None:
    """Put a value in y back to its guess, a quaternion as a whole."""
    y[first] = w.guess[first]
    i = first + 1
    while i < NU and w.part[i] == 1:
        y[i] = w.guess[i]
        i += 1


def reweight(level: int, y: Vec[NU], w: StartWork) -> None:
    """w.step_scaling: of values of a level by their moves in y; lower levels move like unstated values."""
    set_scales(False, w)
    for k in range(w.unknown_count):
        i = w.unknowns[k]
        if w.levels[i] < level:
            w.step_scaling[i] = w.scaling[i]
        if w.levels[i] == level:
            move = fabs(y[i] - w.guess[i]) / w.scaling[i]
            if move < LEAST_SHARE:
                move = LEAST_SHARE
            w.step_scaling[i] = SLIGHT * w.scaling[i] * (move if move < 1.0 else 1.0)


def total_share(n: int, y: Vec[NU], w: StartWork) -> Real:
    """The sum of the moves of the n values w.candidates, in proportion to their sizes."""
    total = 0.0
    for k in range(n):
        total += share(w.candidates[k], y, w)
    return total


def farthest_total(n: int, w: StartWork) -> Real:
    """The sum of the moves of the n values w.candidates beyond which a start is no better than w.y."""
    before = FARTHER * total_share(n, w.y, w)
    return before if before > NEAR else NEAR


def sparsify(p: Params, t: Real, level: int, n: int, w: StartWork) -> None:
    """Move w.y to a start where few of the n values w.candidates, those of a level, move: the initial
    equations are linear, with the slopes at w.y, in the reweighted solutions."""
    w.restored[:] = w.y
    for k in range(ROUNDS):
        reweight(level, w.restored, w)
        select_columns(0, NU, w)
        if not step_to_guess(p, t, w.y, w.row_count, 0, w):
            break
        w.restored[:] = w.guess
        move_along(w.restored, w.guess, 1.0, w)
    set_scales(False, w)
    for j in range(n):
        if share(w.candidates[j], w.restored, w) <= LEAST_SHARE:
            set_free(w.candidates[j], 0, w)
            restore(w.candidates[j], w.restored, w)
    if leads_to_start(p, t, w.restored, w) and total_share(n, w.restored, w) <= farthest_total(n, w):
        w.y[:] = w.restored
    else:
        for j in range(n):
            set_free(w.candidates[j], 1, w)


def hold_unmoved(p: Params, t: Real, n: int, w: StartWork) -> None:
    """Hold those of the n values w.candidates that moved by next to nothing, if a start remains."""
    w.restored[:] = w.y
    some = False
    for k in range(n):
        w.picked[k] = 0
        if w.free[w.candidates[k]] == 1 and share(w.candidates[k], w.y, w) <= LEAST_SHARE:
            w.picked[k] = 1
            some = True
            restore(w.candidates[k], w.restored, w)
            set_free(w.candidates[k], 0, w)
    if some and leads_to_start(p, t, w.restored, w):
        w.y[:] = w.restored
    elif some:
        for k in range(n):
            if w.picked[k] == 1:
                set_free(w.candidates[k], 1, w)


def is_determined(first: int, w: StartWork) -> bool:
    """Whether the projection w.step keeps the entries w.moves of a value, of a quaternion as a whole."""
    i = first
    while i < NU and (i == first or w.part[i] == 1):
        if not fabs(w.step[w.column_of[i]] - w.moves[w.column_of[i]]) <= DETERMINED:
            return False
        i += 1
    return True


def mark_essential(p: Params, t: Real, n: int, w: StartWork) -> None:
    """w.picked: 1 for each of the n values w.candidates that is held, or that has to move. The initial
    equations, linearised at w.y, determine a value if its unit vector lies in their row space. The
    projection of a generic vector onto the row space keeps just the entries of such values."""
    for j in range(NU):
        w.step_scaling[j] = w.scaling[j]
    select_columns(0, NU, w)
    evaluate_rows(p, t, w.y, w.c, w.J, w.term_sizes, w)
    scale_rows(w.y, w.J, w.term_sizes, w)
    w.entry_roundoff[:] = w.slope_roundoff
    rows = w.row_count
    fill(0, rows, w)
    count = w.column_count
    for k in range(count):
        w.moves[k] = 0.0
        if w.levels[w.columns[k]] > UNSTATED:
            w.moves[k] = 1.0 + float(k) / float(count)
    for r in range(rows):
        w.right[r] = inner(w.matrix[r], w.moves, w.first_column[r], w.end_column[r])
    is_known = solve_step(w, rows, 1)
    set_scales(False, w)
    for k in range(n):
        i = w.candidates[k]
        w.picked[k] = 1 if not is_known or w.free[i] == 0 or is_determined(i, w) else 0


def least_moved(n: int, w: StartWork) -> int:
    """The index of the value of w.candidates[:n] with the least move that is not picked, or -1."""
    at = -1
    least = 0.0
    for k in range(n):
        move = share(w.candidates[k], w.y, w)
        if w.picked[k] == 0 and (at < 0 or move < least):
            at = k
            least = move
    return at


def hold_one(p: Params, t: Real, n: int, w: StartWork) -> bool:
    """Hold the value of w.candidates[:n] without which the others move least; whether a start remains."""
    mark_essential(p, t, n, w)
    before = total_share(n, w.y, w)
    best = -1
    least = farthest_total(n, w)
    at = least_moved(n, w)
    while at >= 0 and not (best >= 0 and least <= 2.0 * before):
        w.picked[at] = 1
        w.begin[:] = w.y
        restore(w.candidates[at], w.begin, w)
        set_free(w.candidates[at], 0, w)
        if leads_to_start(p, t, w.begin, w) and total_share(n, w.begin, w) < least:
            least = total_share(n, w.begin, w)
            best = at
            w.restored[:] = w.begin
        set_free(w.candidates[at], 1, w)
        at = least_moved(n, w)
    if best < 0:
        return False
    set_free(w.candidates[best], 0, w)
    w.y[:] = w.restored
    return True


def relax(p: Params, t: Real, level: int, w: StartWork) -> None:
    """Hold the values of a level that need not move; all of them move in the start w.y."""
    n = 0
    for k in range(w.unknown_count):
        i = w.unknowns[k]
        if w.levels[i] == level and w.part[i] == 0:
            w.candidates[n] = i
            n += 1
    if n == 0:
        return
    sparsify(p, t, level, n, w)
    more = True
    while more:
        hold_unmoved(p, t, n, w)
        more = hold_one(p, t, n, w)
    w.saved[:] = w.y
    if not multistart(p, t, 0, SPREADS, w):
        w.y[:] = w.saved
