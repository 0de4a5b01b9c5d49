"""The choice of the stated values that move: few of them, by reweighted least-norm solutions.

Where stated values contradict the initial equations, the least-norm solution moves all of them a little.
FOCUSS (I. F. Gorodnitsky, B. D. Rao, IEEE Trans. Signal Process. 45, 1997) repeats it on the linearised
equations, each value scaled by its last move: moves that are not needed vanish.  Then each value that still
moves is put back if a start remains, the least move first.
"""

from __future__ import annotations

from math import fabs, sqrt

from lagc.kernels.initialization.gauss_newton import fill, leads, loosen, move_along, shortest_step, step_home
from lagc.kernels.initialization.least_norm import inner
from lagc.kernels.initialization.multistart import NEAR, SPREADS, find
from lagc.kernels.initialization.residuals import SLIGHT, judge, meet, set_scales
from lagc.kernels.initialization.workspace import UNSTATED, StartWork
from lagc.kernels.language.sizes import NU
from lagc.kernels.language.tolerances import LEAST_SHARE
from lagc.kernels.language.words import Params, Real, Vec

ROUNDS = 8  # reweighted solutions
DETERMINED = 1e-6  # the change of an entry of a projection that is none
FARTHER = 10.0  # times the moves of a start: one that moves more is not better


def set_free(first: int, free: int, w: StartWork) -> None:
    """Free a value or hold it, a quaternion as a whole."""
    w.loose[first] = free
    i = first + 1
    while i < NU and w.part[i] == 1:
        w.loose[i] = free
        i += 1


def share(first: int, y: Vec[NU], w: StartWork) -> Real:
    """The distance of a value from its guess, of a quaternion as a whole, in proportion to its size."""
    move = (y[first] - w.home[first]) / w.weights[first]
    total = move * move
    i = first + 1
    while i < NU and w.part[i] == 1:
        move = (y[i] - w.home[i]) / w.weights[i]
        total += move * move
        i += 1
    return sqrt(total)


def restore(first: int, y: Vec[NU], w: StartWork) -> None:
    """Put a value in y back to its guess, a quaternion as a whole."""
    y[first] = w.home[first]
    i = first + 1
    while i < NU and w.part[i] == 1:
        y[i] = w.home[i]
        i += 1


def reweight(level: int, y: Vec[NU], w: StartWork) -> None:
    """w.scale: of values of a level by their moves in y; lower levels move like unstated values."""
    set_scales(False, w)
    owned = w.owned
    for k in range(owned):
        i = w.own[k]
        if w.levels[i] < level:
            w.scale[i] = w.weights[i]
        if w.levels[i] == level:
            move = fabs(y[i] - w.home[i]) / w.weights[i]
            if move < LEAST_SHARE:
                move = LEAST_SHARE
            w.scale[i] = SLIGHT * w.weights[i] * (move if move < 1.0 else 1.0)


def total_share(n: int, y: Vec[NU], w: StartWork) -> Real:
    """The sum of the moves of the n values w.values, in proportion to their sizes."""
    total = 0.0
    for k in range(n):
        total += share(w.values[k], y, w)
    return total


def farthest_total(n: int, w: StartWork) -> Real:
    """The sum of the moves of the n values w.values beyond which a start is no better than w.y."""
    before = FARTHER * total_share(n, w.y, w)
    return before if before > NEAR else NEAR


def sparsify(p: Params, t: Real, level: int, n: int, w: StartWork) -> None:
    """Move w.y to a start where few of the n values w.values, those of a level, move: the initial equations
    are linear, with the slopes at w.y, in the reweighted solutions."""
    w.held[:] = w.y
    for k in range(ROUNDS):
        reweight(level, w.held, w)
        loosen(0, NU, w)
        if not step_home(p, t, w.y, w.ended, 0, w):
            break
        w.held[:] = w.home
        move_along(w.held, w.home, 1.0, w)
    set_scales(False, w)
    for j in range(n):
        if share(w.values[j], w.held, w) <= LEAST_SHARE:
            set_free(w.values[j], 0, w)
            restore(w.values[j], w.held, w)
    if leads(p, t, w.held, w) and total_share(n, w.held, w) <= farthest_total(n, w):
        w.y[:] = w.held
    else:
        for j in range(n):
            set_free(w.values[j], 1, w)


def hold_unmoved(p: Params, t: Real, n: int, w: StartWork) -> None:
    """Hold those of the n values w.values that moved by next to nothing, if a start remains."""
    w.held[:] = w.y
    some = False
    for k in range(n):
        w.picked[k] = 0
        if w.loose[w.values[k]] == 1 and share(w.values[k], w.y, w) <= LEAST_SHARE:
            w.picked[k] = 1
            some = True
            restore(w.values[k], w.held, w)
            set_free(w.values[k], 0, w)
    if some and leads(p, t, w.held, w):
        w.y[:] = w.held
    elif some:
        for k in range(n):
            if w.picked[k] == 1:
                set_free(w.values[k], 1, w)


def is_determined(first: int, w: StartWork) -> bool:
    """Whether the projection w.step keeps the entries w.moves of a value, of a quaternion as a whole."""
    i = first
    while i < NU and (i == first or w.part[i] == 1):
        if not fabs(w.step[w.places[i]] - w.moves[w.places[i]]) <= DETERMINED:
            return False
        i += 1
    return True


def mark_essential(p: Params, t: Real, n: int, w: StartWork) -> None:
    """w.picked: 1 for each of the n values w.values that is held, or that has to move.

    The initial equations, linearised at w.y, determine a value if its unit vector lies in their row space.
    The projection of a generic vector onto the row space keeps just the entries of such values.
    """
    for j in range(NU):
        w.scale[j] = w.weights[j]
    loosen(0, NU, w)
    meet(p, t, w.y, w.c, w.J, w.sizes, w)
    judge(w.y, w.J, w.sizes, w)
    w.blurs[:] = w.doubted
    rows = w.ended
    fill(0, rows, w)
    count = w.count
    for k in range(count):
        w.moves[k] = 0.0
        if w.levels[w.columns[k]] > UNSTATED:
            w.moves[k] = 1.0 + float(k) / float(count)
    for r in range(rows):
        w.right[r] = inner(w.matrix[r], w.moves, w.begins[r], w.stops[r])
    is_known = shortest_step(w, rows, 1)
    set_scales(False, w)
    for k in range(n):
        i = w.values[k]
        w.picked[k] = 1 if not is_known or w.loose[i] == 0 or is_determined(i, w) else 0


def least_moved(n: int, w: StartWork) -> int:
    """The index of the value of w.values[:n] with the least move that is not picked, or -1."""
    at = -1
    least = 0.0
    for k in range(n):
        move = share(w.values[k], w.y, w)
        if w.picked[k] == 0 and (at < 0 or move < least):
            at = k
            least = move
    return at


def hold_one(p: Params, t: Real, n: int, w: StartWork) -> bool:
    """Hold the value of w.values[:n] without which the others move least; whether a start remains."""
    mark_essential(p, t, n, w)
    before = total_share(n, w.y, w)
    best = -1
    least = farthest_total(n, w)
    at = least_moved(n, w)
    while at >= 0 and not (best >= 0 and least <= 2.0 * before):
        w.picked[at] = 1
        w.now[:] = w.y
        restore(w.values[at], w.now, w)
        set_free(w.values[at], 0, w)
        if leads(p, t, w.now, w) and total_share(n, w.now, w) < least:
            least = total_share(n, w.now, w)
            best = at
            w.held[:] = w.now
        set_free(w.values[at], 1, w)
        at = least_moved(n, w)
    if best < 0:
        return False
    set_free(w.values[best], 0, w)
    w.y[:] = w.held
    return True


def relax(p: Params, t: Real, level: int, w: StartWork) -> None:
    """Hold the values of a level that need not move; all of them move in the start w.y."""
    n = 0
    owned = w.owned
    for k in range(owned):
        i = w.own[k]
        if w.levels[i] == level and w.part[i] == 0:
            w.values[n] = i
            n += 1
    if n == 0:
        return
    sparsify(p, t, level, n, w)
    more = True
    while more:
        hold_unmoved(p, t, n, w)
        more = hold_one(p, t, n, w)
    w.kept[:] = w.y
    if not find(p, t, 0, SPREADS, w):
        w.y[:] = w.kept
