"""The way to a start: Gauss-Newton steps of least norm."""

from __future__ import annotations

from math import fabs, floor, inf, sqrt

from lagc.kernels.initialization.least_norm import least_norm
from lagc.kernels.initialization.residuals import (
    farthest,
    is_blurred,
    judge,
    meet,
    norm,
    ratio,
    row_begin,
)
from lagc.kernels.initialization.scaling import blur
from lagc.kernels.initialization.workspace import UNSTATED, StartWork
from lagc.kernels.language.sizes import NE, NQ, NU
from lagc.kernels.language.tables import angle, ends
from lagc.kernels.language.tolerances import ACCEPTED, CLOSE, EXACT, FOLLOWING, SURELY_FOLLOWING
from lagc.kernels.language.words import Params, Real, Size, Vec

NEWTON_STEPS = 60
LATE = 8  # steps in which what is missed halves, or the iteration ends
ALONG = 8  # rows, of which a step straightens one bend after the other: one more
WHOLE = 0.6  # the same, where only the longest step is tried
EXACTLY = 2  # the last turn, at which rows are taken entry by entry
SHORTEST = 1.0 / 16384.0  # part of a step that is tried at last
POLISHED = 4  # steps
OVERSHOT = 2.0  # of what was missed: a step that misses more is too long, whatever part it is
TINIEST = 1e-30  # part of a step, of such a one
HOMEWARD = 20  # steps back towards the guess
TURN = 6.283185307179586


def loosen(first: Size, end: Size, w: StartWork) -> None:
    """w.columns: what is free of the unknowns first..end-1, those near each other that conditions tie."""
    w.count = 0
    owned = w.owned
    for k in range(owned):
        i = w.line[k]
        w.places[i] = -1
        if first <= i and i < end and w.loose[i] == 1:
            w.places[i] = w.count
            w.columns[w.count] = i
            w.count += 1


def find_ends(i: int, r: int, w: StartWork) -> None:
    """w.begins and w.stops of row r: where condition i has places among w.columns."""
    begin = w.count
    stop = 0
    first = row_begin(i)
    end = ends[i]
    for e in range(first, end):
        at = w.places[w.column[e]]
        if at >= 0:
            begin = at if at < begin else begin
            stop = at + 1 if at >= stop else stop
    w.begins[r] = begin if begin < stop else 0
    w.stops[r] = stop


def fill(first: int, end: int, w: StartWork) -> None:
    """w.matrix: the derivatives of w.rows[first..end-1] by w.columns, each times its weight, 0 where it is
    rounding; w.right: what is missed."""
    for k in range(first, end):
        find_ends(w.rows[k], k - first, w)
        row = w.matrix[k - first]
        begin = w.begins[k - first]
        behind = w.stops[k - first]
        for j in range(begin, behind):
            row[j] = 0.0
        begin = row_begin(w.rows[k])
        behind = ends[w.rows[k]]
        for e in range(begin, behind):
            i = w.column[e]
            if w.places[i] >= 0 and not is_blurred(e, w):
                row[w.places[i]] = w.J[e] * w.scale[i]
        w.right[k - first] = -w.c[w.rows[k]]


def move_along(y: Vec[NU], base: Vec[NU], factor: Real, w: StartWork) -> None:
    """Of y what is in w.columns: `base` and a part of w.step."""
    count = w.count
    for k in range(count):
        i = w.columns[k]
        y[i] = base[i] + factor * w.step[k] * w.scale[i]


def put_trial(y: Vec[NU], w: StartWork) -> None:
    """Move y, in w.columns, to w.trial; w.c, w.J and w.sizes of w.rows are those there."""
    count = w.count
    for k in range(count):
        y[w.columns[k]] = w.trial[w.columns[k]]
    rows = w.ended
    for r in range(rows):
        i = w.rows[r]
        w.c[i] = w.trial_c[i]
        w.sizes[i] = w.trial_sizes[i]
        first = row_begin(i)
        end = ends[i]
        for k in range(first, end):
            w.J[k] = w.trial_J[k]
    judge(y, w.J, w.sizes, w)


def longest_part(w: StartWork) -> Real:
    """The part of w.step that turns no angle by more than a radian."""
    factor = 1.0
    count = w.count
    for k in range(count):
        i = w.columns[k]
        turn = fabs(w.step[k]) * w.scale[i]
        if angle[i] == 1 and turn * factor > 1.0:
            factor = 1.0 / turn
    return factor


def try_parts(p: Params, t: Real, y: Vec[NU], first: int, end: int, missed: Real, longest: Real,
              shortest: Real, w: StartWork) -> Real:  # fmt: skip
    """What is missed at w.trial, y and a part of w.step that helps: the whole, where all is linear and whole
    turns are gone, else the longest and its halves down to the shortest; -1 where none does."""
    least = shortest * longest
    factor = 1.0
    size = inf
    w.trial[:] = y
    while least > 0.0 and factor >= (least if w.whole or size < OVERSHOT * missed else TINIEST):
        move_along(w.trial, y, factor, w)
        meet(p, t, w.trial, w.trial_c, w.trial_J, w.trial_sizes, w)
        size = norm(w.trial_c, first, end, w)
        if size < missed * (1.0 - (0.1 * factor if factor <= longest else 0.999)):
            return size
        factor = 0.5 * factor if factor <= longest else longest
    return -1.0


def shortest_step(w: StartWork, m: int, turn: int) -> bool:
    """w.step of the m rows of w.matrix.  What follows from other rows is a part of the length of a row
    that is small, or larger at the second turn, or at the third what is rounding entry by entry."""
    if turn == EXACTLY:
        return least_norm(w, m, w.count, 0.0, FOLLOWING)
    return least_norm(w, m, w.count, FOLLOWING if turn == 0 else SURELY_FOLLOWING, 0.0)


def rough(c: Vec[NE], sizes: Vec[NE], first: int, end: int, w: StartWork) -> Real:
    """The norm of the residuals of w.rows[first..end-1] that something free takes part in, by the terms of
    their rows; what is no more than the rounding of rounding is none, where there were no terms at the
    guess."""
    total = 0.0
    for k in range(first, end):
        i = w.rows[k]
        free = False
        begin = row_begin(i)
        behind = ends[i]
        for e in range(begin, behind):
            free = free or (w.places[w.column[e]] >= 0 and not is_blurred(e, w))
        if free:
            faint = CLOSE * w.scales[i]
            if 0.0 < w.terms[i] and w.terms[i] < faint:
                faint = w.terms[i]
            size = ratio(c[i], w.floors[i], sizes[i] + faint)
            total += size * size
    return sqrt(total)


def polish(p: Params, t: Real, y: Vec[NU], first: int, end: int, w: StartWork) -> None:
    """Steps from where all is met as far as what it may be tells, to where it is by its own terms."""
    missed = rough(w.c, w.sizes, first, end, w)
    for n in range(POLISHED):
        if missed <= CLOSE:
            return
        fill(first, end, w)
        w.work += 1
        if not shortest_step(w, end - first, EXACTLY):
            return
        w.trial[:] = y
        move_along(w.trial, y, 1.0, w)
        meet(p, t, w.trial, w.trial_c, w.trial_J, w.trial_sizes, w)
        left = rough(w.trial_c, w.trial_sizes, first, end, w)
        if not (left < 0.5 * missed and norm(w.trial_c, first, end, w) <= CLOSE):
            return
        missed = left
        put_trial(y, w)


def speeds_alone(w: StartWork) -> bool:
    """Whether w.columns are none of positions."""
    count = w.count
    for k in range(count):
        if w.columns[k] < NQ:
            return False
    return True


def improve(p: Params, t: Real, y: Vec[NU], first: int, end: int, w: StartWork) -> None:
    """Gauss-Newton of least norm on w.rows[first..end-1] in w.columns, with steps that are halved until
    they help."""
    if first == end or w.count == 0:
        return
    meet(p, t, y, w.c, w.J, w.sizes, w)
    judge(y, w.J, w.sizes, w)
    missed = norm(w.c, first, end, w)
    w.blurs[:] = w.doubted
    if missed <= CLOSE:
        polish(p, t, y, first, end, w)
        return
    if speeds_alone(w):  # what is rounding of positions stays so
        blur(p, t, y, w.weights, w)
    left = 1.0
    longest = 1.0
    more = (end - first) // ALONG
    for n in range(NEWTON_STEPS + more):
        if not (EXACT < missed and missed < inf):
            polish(p, t, y, first, end, w)
            return
        if n > 0 and n % (LATE + more) == 0:
            if longest == 1.0 and not left < 0.5:
                return
            left = 1.0
        size = -1.0
        some = False
        for turn in range(3):
            if turn == EXACTLY and not some:
                break
            fill(first, end, w)
            w.work += 1
            if not shortest_step(w, end - first, turn):
                return
            longest = longest_part(w)
            some = some or (turn == 0 and w.left_out > 0)
            shortest = WHOLE if turn == EXACTLY or missed <= CLOSE or w.whole else SHORTEST
            size = try_parts(p, t, y, first, end, missed, longest, shortest, w)
            if size >= 0.0:
                break
        if size < 0.0:
            return
        left *= size / missed
        put_trial(y, w)
        missed = norm(w.c, first, end, w)


def attempt(p: Params, t: Real, y: Vec[NU], w: StartWork) -> None:
    """Positions first, then speeds; all together where that is not enough."""
    loosen(0, NQ, w)
    improve(p, t, y, 0, w.positions, w)
    if not farthest(p, t, y, w.positions, w) <= ACCEPTED:
        return
    loosen(NQ, NU, w)
    improve(p, t, y, w.positions, w.ended, w)
    if farthest(p, t, y, w.ended, w) <= ACCEPTED:
        return
    loosen(0, NU, w)
    improve(p, t, y, 0, w.ended, w)


def leads(p: Params, t: Real, y: Vec[NU], w: StartWork) -> bool:
    """Whether an attempt leads y to a start."""
    attempt(p, t, y, w)
    return farthest(p, t, y, w.ended, w) <= ACCEPTED


def distance(y: Vec[NU], w: StartWork) -> Real:
    """From the guess, in weights."""
    total = 0.0
    owned = w.owned
    for k in range(owned):
        i = w.own[k]
        way = (y[i] - w.home[i]) / w.scale[i]
        total += way * way
    return sqrt(total)


def strayed(y: Vec[NU], w: StartWork) -> Real:
    """How far what nobody stated is from the guess, in weights."""
    total = 0.0
    owned = w.owned
    for k in range(owned):
        i = w.own[k]
        if w.levels[i] == UNSTATED:
            way = (y[i] - w.home[i]) / w.weights[i]
            total += way * way
    return sqrt(total)


def step_home(p: Params, t: Real, y: Vec[NU], end: int, turn: int, w: StartWork) -> bool:
    """w.step: from the guess to the nearest point that meets w.rows[..end-1], linear at y; False where a
    number is not finite."""
    meet(p, t, y, w.c, w.J, w.sizes, w)
    w.blurs[:] = w.doubted
    fill(0, end, w)
    for r in range(end):
        value = w.right[r]
        begin = w.begins[r]
        stop = w.stops[r]
        for k in range(begin, stop):
            i = w.columns[k]
            value += w.matrix[r][k] * ((y[i] - w.home[i]) / w.scale[i])
        w.right[r] = value
    w.work += 1
    return shortest_step(w, end, turn)


def approach(p: Params, t: Real, y: Vec[NU], w: StartWork) -> None:
    """A start between y and the guess, as near to the guess as steps of least norm lead: of the positions
    alone, where speeds from their guess fit."""
    alone = True
    w.turned[:] = w.home
    for i in range(NQ):
        w.turned[i] = y[i]
    if leads(p, t, w.turned, w):
        y[:] = w.turned
    else:
        alone = False
    far = distance(y, w)
    end = w.positions if alone else w.ended
    for n in range(HOMEWARD):
        loosen(0, NQ if alone else NU, w)
        if w.count == 0 or end == 0:
            return
        if not step_home(p, t, y, end, 0, w):
            return
        w.turned[:] = w.home
        move_along(w.turned, w.home, 1.0, w)
        attempt(p, t, w.turned, w)
        near = distance(w.turned, w)
        if not (near < far and farthest(p, t, w.turned, w.ended, w) <= ACCEPTED):
            return
        y[:] = w.turned
        far = near


def unwind(p: Params, t: Real, y: Vec[NU], w: StartWork) -> None:
    """y with angles less than half a turn from their guess, where that is a start too."""
    wound = False
    w.turned[:] = y
    owned = w.owned
    for k in range(owned):
        i = w.own[k]
        if angle[i] == 1:
            turns = floor((y[i] - w.home[i]) / TURN + 0.5)
            if turns != 0.0:
                w.turned[i] = y[i] - TURN * turns
                wound = True
    if wound and leads(p, t, w.turned, w):
        y[:] = w.turned
