"""The sizes of the unknowns of a consistent start: by what was stated, and from condition to condition."""

from __future__ import annotations

from math import fabs, inf

from lagc.kernels.initialization.residuals import SLIGHT, is_blurred, meet, meet_all, row_begin
from lagc.kernels.initialization.workspace import UNSTATED, StartWork
from lagc.kernels.language.parameters import bind
from lagc.kernels.language.sizes import NE, NJ, NP, NPREPARED, NQ, NQUAT, NU
from lagc.kernels.language.tables import angle, ends, quaternion, unit
from lagc.kernels.language.tolerances import FOUR_ULPS, LEAST_WEIGHT, MOST_WEIGHT
from lagc.kernels.language.words import Params, Real, Vec, params


def shake_parameters(p: Params, way: Real, other: Params) -> None:
    """Parameters changed by four units of their last place, every other one the other way."""
    other[:] = p
    for k in range(NP):
        other[k] *= 1.0 + way if k % 2 == 0 else 1.0 - way
    if NPREPARED > 0:
        bind(other)


def less(change: Real, most: Real) -> Real:
    """The less of two changes; none where it has no value."""
    if not change < inf:
        return 0.0
    return change if change < most else most


def doubt(p: Params, t: Real, w: StartWork) -> None:
    """What last places of the parameters change at the guess: residuals, w.doubts, and derivatives,
    w.doubted; the less of either way, for on one side there may be a jump."""
    for i in range(NE):
        w.doubts[i] = inf if NP > 0 else 0.0
    for k in range(NJ):
        w.doubted[k] = inf if NP > 0 else 0.0
    if NP > 0:
        other = params()
        for turn in range(2):
            shake_parameters(p, FOUR_ULPS if turn == 0 else -FOUR_ULPS, other)
            meet_all(other, t, w.home, w.trial_c, w.trial_J, w.trial_sizes)
            for i in range(NE):
                w.doubts[i] = less(fabs(w.trial_c[i] - w.c[i]), w.doubts[i])
            for k in range(NJ):
                w.doubted[k] = less(fabs(w.trial_J[k] - w.J[k]), w.doubted[k])


def blur(p: Params, t: Real, y: Vec[NU], sizes: Vec[NU], w: StartWork) -> None:
    """w.blurs: how far the derivatives w.J at y change where positions, of these `sizes`, or parameters
    change in their last places."""
    w.trial[:] = y
    for i in range(NQ):
        size = fabs(y[i]) if fabs(y[i]) > fabs(sizes[i]) else fabs(sizes[i])
        w.trial[i] += (FOUR_ULPS if i % 2 == 0 else -FOUR_ULPS) * size
    meet(p, t, w.trial, w.trial_c, w.trial_J, w.trial_sizes, w)
    rows = w.ended
    for r in range(rows):
        first = row_begin(w.rows[r])
        end = ends[w.rows[r]]
        for k in range(first, end):
            change = fabs(w.trial_J[k] - w.J[k])
            w.blurs[k] = change if change > w.doubted[k] else w.doubted[k]


def known_terms(i: int, w: StartWork) -> Real:
    """The sum of the terms of condition i, each as large as it may be, as far as it is known."""
    total = w.terms[i]
    first = row_begin(i)
    end = ends[i]
    for k in range(first, end):
        if w.reach[w.column[k]] < inf:
            total += fabs(w.J[k]) * w.reach[w.column[k]]
    return total


def is_open(k: int, w: StartWork) -> bool:
    """Whether derivative k is by an unknown whose size is not known yet."""
    return w.reach[w.column[k]] == inf and 0.0 < fabs(w.J[k]) and fabs(w.J[k]) < inf and not is_blurred(k, w)


def steepest(i: int, k: int, w: StartWork) -> bool:
    """Whether derivative k of condition i is by an unknown whose size is not known yet, the one of its unit
    that the condition depends on most."""
    if not is_open(k, w):
        return False
    first = row_begin(i)
    end = ends[i]
    for other in range(first, end):
        if (
            unit[w.column[other]] == unit[w.column[k]]
            and is_open(other, w)
            and fabs(w.J[other]) > fabs(w.J[k])
        ):
            return False
    return True


def size_alone(w: StartWork) -> bool:
    """Of each condition with one unknown whose size is not known yet, this: what changes the condition by the
    size of its other terms; whether there are any."""
    found = False
    for i in range(NE):
        at = -1
        count = 0
        first = row_begin(i)
        end = ends[i]
        for k in range(first, end):
            if is_open(k, w):
                at = k
                count += 1
        if count == 1 and w.chosen[i] == 0:
            w.chosen[i] = 1
            size = known_terms(i, w) / fabs(w.J[at])
            if size < inf:
                w.reach[w.column[at]] = size
                found = True
    return found


def size_several(w: StartWork) -> bool:
    """The same of conditions with several: of that of each unit that they depend on most."""
    found = False
    w.moves[:] = w.reach
    for turn in range(2):
        for i in range(NE):
            total = known_terms(i, w)
            if w.chosen[i] == 1 or not (0.0 < total and total < inf):
                continue
            first = row_begin(i)
            end = ends[i]
            for k in range(first, end):
                if steepest(i, k, w):
                    size = total / fabs(w.J[k])
                    if turn == 0 and size < w.moves[w.column[k]]:
                        w.moves[w.column[k]] = size
                        found = True
                    if turn == 1 and size == w.moves[w.column[k]]:
                        w.chosen[i] = 1
    w.reach[:] = w.moves
    return found


def stretch(w: StartWork) -> None:
    """w.reach: the size of each unknown, by what was stated and by the conditions, each of which tells that
    of one; infinite where these do not tell."""
    for i in range(NU):
        w.reach[i] = fabs(w.home[i]) if w.home[i] != 0.0 or w.levels[i] > UNSTATED else inf
    for i in range(NE):
        w.chosen[i] = 0
    for turn in range(2):  # what is stated to be zero at last, where its unit has no size
        while True:
            if not size_alone(w) and not size_several(w):
                break
        for i in range(NU):
            if turn == 0 and w.reach[i] == 0.0 and w.levels[i] > UNSTATED and w.common[unit[i]] == 0.0:
                w.reach[i] = inf
    for i in range(NU):
        if angle[i] == 1 and w.home[i] == 0.0 and w.reach[i] < SLIGHT:  # turns are of the size of a radian
            w.reach[i] = inf


def common_sizes(w: StartWork) -> None:
    """w.common: the largest unknown of each unit."""
    for i in range(NU):
        w.common[i] = 0.0
    for i in range(NU):
        if fabs(w.home[i]) > w.common[unit[i]]:
            w.common[unit[i]] = fabs(w.home[i])


def share_sizes(w: StartWork) -> None:
    """w.common of units of which all is zero: the largest that the conditions tell.  One size for all: steps
    of least norm would go farthest where they do least."""
    for i in range(NU):
        w.now[i] = w.common[i]
    for i in range(NU):
        if w.now[unit[i]] == 0.0 and w.reach[i] < MOST_WEIGHT and w.reach[i] > w.common[unit[i]]:
            w.common[unit[i]] = w.reach[i]


def usual(i: int, largest: Vec[NU], w: StartWork) -> Real:
    """The size of an unknown: its own, where it was stated; that of others of its unit; what the conditions
    allow; that of a parameter of its unit; 1."""
    weight = fabs(w.home[i])
    if w.levels[i] == UNSTATED or weight == 0.0:
        weight = w.common[unit[i]]
    if weight == 0.0 and w.reach[i] < inf:
        weight = w.reach[i]
    if weight == 0.0:
        weight = largest[unit[i]]
    if not (LEAST_WEIGHT < weight and weight < MOST_WEIGHT):
        weight = 1.0
    return weight


def tighten(w: StartWork) -> None:
    """w.reach, of what is zero and was not stated, no larger than the other terms of a condition allow."""
    for i in range(NE):
        at = -1
        largest = 0.0
        first = row_begin(i)
        end = ends[i]
        for k in range(first, end):
            own = fabs(w.J[k]) * w.reach[w.column[k]]
            if own > largest:
                at = k
                largest = own
        if at < 0 or is_blurred(at, w):
            continue
        j = w.column[at]
        total = w.terms[i]
        for k in range(first, end):
            if k != at:
                total += fabs(w.J[k]) * w.reach[w.column[k]]
        if 0.0 < total and total < largest and w.levels[j] == UNSTATED and w.home[j] == 0.0:
            w.reach[j] = total / fabs(w.J[at])


def weigh(p: Params, t: Real, largest: Vec[NU], w: StartWork) -> None:
    """w.weights, the sizes of the unknowns, those that the conditions tell where the usual ones are far
    off; w.reach, by which rows are judged; w.widths, of their units."""
    meet_all(p, t, w.home, w.c, w.J, w.sizes)
    w.terms[:] = w.sizes
    doubt(p, t, w)
    blur(p, t, w.home, w.home, w)
    common_sizes(w)
    stretch(w)
    share_sizes(w)
    for i in range(NU):
        w.now[i] = usual(i, largest, w)
    for i in range(NU):
        weight = usual(i, largest, w)
        width = w.common[unit[i]] if w.common[unit[i]] < MOST_WEIGHT else MOST_WEIGHT
        if width < weight:
            width = weight
        reach = w.reach[i] if w.home[i] == 0.0 and 0.0 < w.reach[i] and w.reach[i] < inf else weight
        if reach < LEAST_WEIGHT:
            reach = LEAST_WEIGHT
        if reach > MOST_WEIGHT:
            reach = MOST_WEIGHT
        if w.levels[i] == UNSTATED and (reach < SLIGHT * weight or weight < SLIGHT * reach):
            weight = reach
            width = reach
        most = 1.0 if angle[i] == 1 else inf
        w.weights[i] = weight if weight < most else most
        w.widths[i] = width if width < most else most
        w.reach[i] = reach if reach < most else most
    tighten(w)
    if NQUAT > 0:
        for k in range(NQUAT):
            for i in range(4):
                w.weights[quaternion[k] + i] = 1.0
                w.widths[quaternion[k] + i] = 1.0
                w.reach[quaternion[k] + i] = 1.0
