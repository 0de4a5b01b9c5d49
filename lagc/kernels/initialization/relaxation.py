"""The choice of the stated values that move."""

from __future__ import annotations

from math import fabs, inf
from typing import Any

from lagc.kernels.initialization.linear_model import find_ways, pivot, table
from lagc.kernels.initialization.multistart import BESIDE, find
from lagc.kernels.initialization.residuals import judge, meet, ratio, row_begin
from lagc.kernels.initialization.workspace import StartWork
from lagc.kernels.language.sizes import NSETS, NU
from lagc.kernels.language.tables import ends
from lagc.kernels.language.tolerances import NEGLIGIBLE, UNMOVED
from lagc.kernels.language.words import IVec, Params, Real, Vec

MOST_SETS = 128.0  # sets of columns whose linear prediction is looked at
EXCHANGES = 10  # of columns, where there are more sets
WIDE = 0.1  # weights: moves up to it are trusted to be linear
BENT = 0.05  # of what is missed: curvature up to which the first prediction is taken


def tries(p: Params, t: Real, w: StartWork) -> bool:
    """Whether there is a start with what is free now, from the guess, beside it, or where one was found."""
    w.work += 1
    if find(p, t, 0, 1, w) or find(p, t, BESIDE, BESIDE + 1, w):
        return True
    return w.other != 0 and w.other != BESIDE and find(p, t, w.other, w.other + 1, w)


def let_one(value: int, loose: int, w: StartWork) -> None:
    """Let a value move or hold it, a quaternion as a whole."""
    w.loose[value] = loose
    i = value + 1
    while i < NU and w.part[i] == 1:
        w.loose[i] = loose
        i += 1


def let_all(values: IVec[Any], n: int, loose: int, w: StartWork) -> None:
    for k in range(n):
        let_one(values[k], loose, w)


def squared_move(i: int, w: StartWork) -> Real:
    """The square of how far the value at i has moved, in proportion to its size."""
    way = (w.y[i] - w.home[i]) / w.weights[i]
    total = way * way
    j = i + 1
    while j < NU and w.part[j] == 1:
        way = (w.y[j] - w.home[j]) / w.weights[j]
        total += way * way
        j += 1
    return total


def moved(n: int, w: StartWork) -> Real:
    """How many of the first n of w.values have moved; in w.total the sum of the squares of their ways."""
    count = 0.0
    w.total = 0.0
    for k in range(n):
        move = squared_move(w.values[k], w)
        if move > UNMOVED:
            count += 1.0
            w.total += move
    return count


def owner(at: int, w: StartWork) -> int:
    """The value that column `at` is of: the first part of a quaternion."""
    i = at
    while w.part[i] == 1:
        i -= 1
    return i


def largest(values: Vec[Any], n: int) -> Real:
    most = 0.0
    for k in range(n):
        if fabs(values[k]) > most:
            most = fabs(values[k])
    return most


def cost(picked: IVec[Any], ways: Vec[Any], k: int, slack: Real, w: StartWork) -> Real:
    """How many values move where the k picked columns do; in w.total the sum of the squares of the moves."""
    least = slack * largest(ways, k)
    count = 0.0
    w.total = 0.0
    for i in range(k):
        w.marks[owner(w.stated[picked[i]], w)] = 0
    for i in range(k):
        if fabs(ways[i]) > least:
            first = owner(w.stated[picked[i]], w)
            if w.marks[first] == 0:
                count += 1.0
            w.marks[first] = 1
            w.total += ways[i] * ways[i]
    return count


def following(k: int, n: int, w: StartWork) -> bool:
    """The next set of k of n in w.picked; False behind the last."""
    last = k - 1
    while last >= 0 and w.picked[last] == n - k + last:
        last -= 1
    if last < 0:
        return False
    w.picked[last] += 1
    for i in range(last + 1, k):
        w.picked[i] = w.picked[i - 1] + 1
    return True


def bend(p: Params, t: Real, y: Vec[NU], to: Vec[NU], w: StartWork) -> Real:
    """How much the conditions bend from y to `to`, as a part of what is missed at y."""
    meet(p, t, y, w.c, w.J, w.sizes, w)
    judge(y, w.J, w.sizes, w)
    missed = 0.0
    bent = 0.0
    rows = w.ended
    for r in range(rows):
        i = w.rows[r]
        value = w.c[i]
        first = row_begin(i)
        end = ends[i]
        for k in range(first, end):
            value += w.J[k] * (to[w.column[k]] - y[w.column[k]])
        size = ratio(w.c[i], w.floors[i], w.scales[i])
        if size > missed:
            missed = size
        size = ratio(value, w.floors[i], w.scales[i])
        if size > bent:
            bent = size
    return bent / missed if missed > 0.0 else 0.0


def rank_set(k: int, found: int, slack: Real, w: StartWork) -> int:
    """Keep w.picked with w.ways among the few sets that move fewest values and least; how many these are."""
    count = cost(w.picked, w.ways, k, slack, w)
    at = found
    while at > 0 and (
        count < w.set_count[at - 1] or (count == w.set_count[at - 1] and w.total < w.set_total[at - 1])
    ):
        at -= 1
    if at == NSETS:
        return found
    kept = found + 1 if found < NSETS else found
    for i in range(kept - 1, at, -1):
        w.set_count[i] = w.set_count[i - 1]
        w.set_total[i] = w.set_total[i - 1]
        for j in range(k):
            w.set_picked[i * NU + j] = w.set_picked[(i - 1) * NU + j]
            w.set_ways[i][j] = w.set_ways[i - 1][j]
    w.set_count[at] = count
    w.set_total[at] = w.total
    for j in range(k):
        w.set_picked[at * NU + j] = w.picked[j]
        w.set_ways[at][j] = w.ways[j]
    return kept


def pick(n: int, k: int, w: StartWork) -> None:
    """w.picked and w.ways: the basis of k of n columns, and its moves."""
    for r in range(k):
        w.picked[r] = w.basis[r]
        w.ways[r] = w.rests[w.solved[r]][n]


def is_basic(j: int, k: int, w: StartWork) -> bool:
    """Whether column j is one of the k of the basis."""
    for r in range(k):
        if w.basis[r] == j:
            return True
    return False


def swapped(i: int, j: int, n: int, k: int, w: StartWork) -> Real:
    """w.step: the moves of the basis of k of n columns where j takes the place of its number i; the
    largest."""
    row = w.rests[w.solved[i]]
    way = row[n] / row[j]
    for r in range(k):
        w.step[r] = w.ways[r] - w.rests[w.solved[r]][j] * way if r != i else way
    return largest(w.step, k)


def exchange(n: int, k: int, slack: Real, w: StartWork) -> bool:
    """Improve the basis of k of n columns by exchanges of one column for another, while that helps and asks
    for no wide move, which the conditions would not be linear for; whether any did."""
    bound = largest(w.ways, k)
    if bound < WIDE:
        bound = WIDE
    helped = False
    count = cost(w.basis, w.ways, k, slack, w)
    total = w.total
    for times in range(EXCHANGES):
        out = -1
        into = -1
        for j in range(n):
            if is_basic(j, k, w):
                continue
            for i in range(k):
                if not fabs(w.rests[w.solved[i]][j]) > 0.01 or not swapped(i, j, n, k, w) <= bound:
                    continue
                before = w.basis[i]
                w.basis[i] = j
                now = cost(w.basis, w.step, k, slack, w)
                w.basis[i] = before
                if now < count or (now == count and w.total < total):
                    count = now
                    total = w.total
                    out = i
                    into = j
        if out < 0:
            return helped
        pivot(w.rests, w.left, n + 1, w.solved[out], into)
        w.basis[out] = into
        helped = True
        pick(n, k, w)
    return helped


def subsets(n: int, count: int) -> Real:
    """How many sets of `count` of n there are."""
    total = 1.0
    for k in range(count):
        total = total * float(n - k) / float(k + 1)
    return total


def candidates(n: int, k: int, slack: Real, w: StartWork) -> int:
    """Sets of k of the n columns that can meet the conditions, as far as they are linear: the few that move
    fewest values and least."""
    found = 0
    if subsets(n, k) > MOST_SETS:
        pick(n, k, w)
        found = rank_set(k, found, slack, w)
        if exchange(n, k, slack, w):
            found = rank_set(k, found, slack, w)
        return found
    for i in range(k):
        w.picked[i] = i
    while True:
        if find_ways(n, k, w):
            found = rank_set(k, found, slack, w)
        if not following(k, n, w):
            return found


def predict(p: Params, t: Real, m: int, slack: Real, w: StartWork) -> int:
    """Candidates of the m columns w.stated, from the conditions as they are linear between the start w.kept
    and w.now; how many they are.  w.rank: of how many columns each is."""
    for i in range(NU):
        w.best[i] = 0.5 * (w.kept[i] + w.now[i])
    rank = table(p, t, w.kept, w.now, m, w)
    w.rank = table(p, t, w.best, w.now, m, w)
    if rank < w.rank:  # rows that follow from others where they hold, not elsewhere
        w.rank = table(p, t, w.kept, w.now, m, w)
    return candidates(m, w.rank, slack, w)


def release(p: Params, t: Real, n: int, picked: int, w: StartWork) -> bool:
    """Whether there is a start where the first of w.picked move; it is kept, with them, in w.held and
    w.best_picked, where fewer of the n values w.values move than in what is there, or they move less."""
    let_all(w.picked, picked, 1, w)
    led = tries(p, t, w)
    let_all(w.picked, picked, 0, w)
    if led:
        count = moved(n, w)
        if count < w.fewest or (count == w.fewest and w.total < w.shortest):
            w.fewest = count
            w.shortest = w.total
            w.freed = picked
            for i in range(picked):
                w.best_picked[i] = w.picked[i]
            w.held[:] = w.y
    return led


def foreseen(place: int, least: Real, whole: bool, w: StartWork) -> int:
    """In w.picked the values that set number `place` moves by more than `least`, or the whole of it; how many
    these are."""
    ways = w.set_ways[place]
    picked = 0
    rank = w.rank
    for i in range(rank):
        if whole or fabs(ways[i]) > least:
            w.picked[picked] = owner(w.stated[w.set_picked[place * NU + i]], w)
            picked += 1
    return picked


def predicted(p: Params, t: Real, n: int, m: int, w: StartWork) -> bool:
    """Free those of the n values of w.values that the conditions, linear between the start and the point
    where the m columns w.stated are as given, ask to move; whether that led to a start."""
    w.now[:] = w.kept
    for i in range(m):
        w.now[w.stated[i]] = w.home[w.stated[i]]
    bent = bend(p, t, w.now, w.kept, w)
    slack = bent if bent < 0.1 else 0.1
    if not slack > NEGLIGIBLE:
        slack = NEGLIGIBLE
    sets = predict(p, t, m, slack, w)
    w.fewest = inf
    w.shortest = inf
    w.freed = 0
    w.held[:] = w.kept
    for place in range(sets):  # what the prediction moves, else the whole basis
        least = slack * largest(w.set_ways[place], w.rank)
        picked = foreseen(place, least, False, w)
        some = picked < w.rank
        sure = some and release(p, t, n, picked, w)
        if not sure:
            led = release(p, t, n, foreseen(place, least, True, w), w)
            sure = led and not some
        if sure and bent <= BENT:
            break
    let_all(w.best_picked, w.freed, 1, w)
    w.y[:] = w.held
    return w.fewest < inf
