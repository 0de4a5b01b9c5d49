"""The sizes of unknowns that conditions tell only together: each of one condition, which it is paired with.

Of all ways to pair conditions with unknowns that may move, that is taken whose product of slopes, times the
usual sizes, is largest.  Along it no round trip makes a size grow, and the sizes are those of Cramer's rule
with the largest term of each sum (S. Gaubert, M. Sharify, *Tropical scaling of polynomial matrices*, 2009).
"""

from __future__ import annotations

from math import fabs, floor, inf

from lagc.kernels.initialization.residuals import SLIGHT, is_blurred, row_begin
from lagc.kernels.initialization.workspace import UNSTATED, StartWork
from lagc.kernels.language.sizes import NE, NJ, NU
from lagc.kernels.language.tables import angle, ends
from lagc.kernels.language.words import Real

FINE = 1024.0  # parts of a logarithm that are whole: sums of such are exact
GROWN = 1.0001  # times: more than what they are rounded by


def logarithm(a: Real) -> Real:
    """To the base 2, of a number that is neither zero nor infinite, in whole parts."""
    power = 0.0
    rest = a
    while rest >= 65536.0:
        rest *= 1.0 / 65536.0
        power += 16.0
    while rest < 1.0 / 65536.0:
        rest *= 65536.0
        power -= 16.0
    while rest >= 2.0:
        rest *= 0.5
        power += 1.0
    while rest < 1.0:
        rest *= 2.0
        power -= 1.0
    t = (rest - 1.0) / (rest + 1.0)
    s = t * t
    series = t * (1.0 + s * (1.0 / 3.0 + s * (0.2 + s / 7.0)))
    return floor(FINE * (power + 2.8853900817779268 * series) + 0.5)


def is_free(k: int, w: StartWork) -> bool:
    """Whether derivative k is by an unknown that is zero so far, and that nobody stated."""
    j = w.column[k]
    steep = 0.0 < fabs(w.J[k]) and fabs(w.J[k]) < inf
    return steep and w.levels[j] == UNSTATED and w.home[j] == 0.0 and not is_blurred(k, w)


def is_uneven(w: StartWork) -> bool:
    """Whether, with the usual sizes w.now, what is known of a condition, or one of its free terms, is a
    thousand times all others together."""
    for i in range(NE):
        largest = w.terms[i]
        rest = 0.0
        first = row_begin(i)
        end = ends[i]
        some = False
        for k in range(first, end):
            if is_free(k, w):
                some = True
                own = fabs(w.J[k]) * w.now[w.column[k]]
                rest += own if own < largest else largest
                largest = own if own > largest else largest
        if some and 0.0 < rest and rest < SLIGHT * largest:
            return True
    return False


def offer(i: int, gain: Real, w: StartWork) -> bool:
    """Of the free unknowns of condition i: whether any is worth more with it, w.moves, from w.values; those
    that were seen are w.columns."""
    found = False
    first = row_begin(i)
    end = ends[i]
    for k in range(first, end):
        j = w.column[k]
        if w.trial_J[k] == inf:
            continue
        if w.marks[j] == 0:
            w.marks[j] = 1
            w.moves[j] = -inf
            w.columns[w.count] = j
            w.count += 1
        if gain + w.trial_J[k] > w.moves[j]:
            w.moves[j] = gain + w.trial_J[k]
            w.values[j] = k
            w.stated[j] = i
            found = True
    return found


def pair(i: int, w: StartWork) -> None:
    """An unknown for condition i, and others for those that have to give theirs away, as the product of all
    is largest: the longest path."""
    w.count = 0
    more = offer(i, 0.0, w)
    while more:
        more = False
        seen = w.count
        for n in range(seen):
            j = w.columns[n]
            r = w.picked[j]
            k = w.solved[r] if r >= 0 else -1
            if k >= 0 and offer(r, w.moves[j] - w.trial_J[k], w):
                more = True
    at = -1
    seen = w.count
    for n in range(seen):
        j = w.columns[n]
        w.marks[j] = 0
        if w.picked[j] < 0 and (at < 0 or w.moves[j] > w.moves[at]):
            at = j
    while at >= 0:
        r = w.stated[at]
        given = w.column[w.solved[r]] if w.solved[r] >= 0 else -1
        w.solved[r] = w.values[at]
        w.picked[at] = r
        at = given


def pair_all(w: StartWork) -> None:
    """w.solved: the derivative of each condition by its unknown, or -1; w.picked: the condition of each
    unknown, or -1."""
    for k in range(NJ):
        w.trial_J[k] = inf
    for j in range(NU):
        w.picked[j] = -1
        w.marks[j] = 0
    for i in range(NE):
        first = row_begin(i)
        end = ends[i]
        for k in range(first, end):
            if is_free(k, w):
                w.trial_J[k] = logarithm(fabs(w.J[k])) + logarithm(w.now[w.column[k]])
        w.solved[i] = -1
        pair(i, w)


def largest_term(i: int, but: int, w: StartWork) -> Real:
    """Of condition i, by the sizes w.moves of what is free, without that of derivative `but`."""
    largest = w.terms[i]
    first = row_begin(i)
    end = ends[i]
    for k in range(first, end):
        if k != but and w.trial_J[k] < inf and fabs(w.J[k]) * w.moves[w.column[k]] > largest:
            largest = fabs(w.J[k]) * w.moves[w.column[k]]
    return largest


def feed(w: StartWork) -> None:
    """w.moves of the unknowns whose w.marks are 0: what makes the term of each as large as the others of its
    condition."""
    for turn in range(NE):
        grown = False
        for i in range(NE):
            k = w.solved[i]
            if k < 0 or w.marks[w.column[k]] == 1:
                continue
            size = largest_term(i, k, w) / fabs(w.J[k])
            if GROWN * w.moves[w.column[k]] < size and size < inf:
                w.moves[w.column[k]] = size
                grown = True
        if not grown:
            return


def allow(w: StartWork) -> None:
    """w.best: the largest sizes of unknowns that make no condition larger than it is; infinite where none
    tells."""
    for j in range(NU):
        w.best[j] = inf
    for i in range(NE):
        largest = largest_term(i, -1, w)
        first = row_begin(i)
        end = ends[i]
        for k in range(first, end):
            if w.trial_J[k] < inf and 0.0 < largest and largest / fabs(w.J[k]) < w.best[w.column[k]]:
                w.best[w.column[k]] = largest / fabs(w.J[k])


def sow(w: StartWork) -> bool:
    """Sizes of what conditions leave at zero: as they allow, of what is paired with none, else of one at a
    time; whether there is any."""
    for turn in range(2):
        found = False
        for j in range(NU):
            if w.marks[j] == 0 and 0.0 < w.best[j] and w.best[j] < inf and (turn == 1 or w.picked[j] < 0):
                w.moves[j] = w.best[j] if w.best[j] < w.now[j] else w.now[j]
                found = True
                if turn == 1:
                    break
        if found:
            return True
    return False


def shrink(w: StartWork) -> None:
    """What was told now, made less together where conditions do not allow it."""
    factor = 1.0
    for j in range(NU):
        if w.marks[j] == 0 and w.best[j] < factor * w.moves[j]:
            factor = w.best[j] / w.moves[j]
    for j in range(NU):
        if w.marks[j] == 0:
            w.moves[j] *= factor


def even_out(w: StartWork) -> None:
    """w.reach of what is zero and was not stated, where the usual sizes w.now make conditions uneven."""
    if not is_uneven(w):
        return
    pair_all(w)
    for j in range(NU):
        w.moves[j] = 0.0
    feed(w)
    while True:
        for j in range(NU):
            w.marks[j] = 1 if w.moves[j] > 0.0 else 0
        allow(w)
        if not sow(w):
            break
        feed(w)
        shrink(w)
    for j in range(NU):
        if w.moves[j] > (SLIGHT if angle[j] == 1 else 0.0):  # turns are of the size of a radian
            w.reach[j] = w.moves[j]
