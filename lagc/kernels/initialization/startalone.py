"""Conditions in which one unknown is left: where its residual changes its sign, however far away."""

from __future__ import annotations

from math import fabs

from lagc.kernels.initialization.residuals import judge, meet, ratio, row_begin
from lagc.kernels.initialization.workspace import UNSTATED, Place, StartWork
from lagc.kernels.language.sizes import NU
from lagc.kernels.language.tables import ends
from lagc.kernels.language.tolerances import ACCEPTED
from lagc.kernels.language.words import Params, Real, Vec

RUNGS = 12  # looked at on either side of 0, up and down from the size of an unknown
CURVED = 6  # halvings of an interval: what is left of a curve bends one way
HALVINGS = 60  # of an interval, or until no number is left in it; most are steps of Newton


def put(at: Place, there: Place) -> None:
    at.value = there.value
    at.residual = there.residual
    at.slope = there.slope


def look(p: Params, t: Real, y: Vec[NU], i: int, j: int, value: Real, at: Place, w: StartWork) -> None:
    """Condition i where unknown j in y is at `value`."""
    y[j] = value
    meet(p, t, y, w.c, w.J, w.sizes, w)
    at.value = value
    at.residual = w.c[i]
    at.slope = 0.0
    first = row_begin(i)
    end = ends[i]
    for k in range(first, end):
        if w.column[k] == j:
            at.slope = w.J[k]


def rung(k: int, size: Real) -> Real:
    """Number k of a ladder that is 0 at 0, +-size at +-(RUNGS + 1), and ever wider away from there."""
    if k == 0:
        return 0.0
    steps = (-k if k < 0 else k) - RUNGS - 1
    away = -steps if steps < 0 else steps
    factor = 1.0 if k > 0 else -1.0
    for n in range(away * (away + 1) // 2):
        factor *= 2.0 if steps > 0 else 0.5
    return size * factor


def opposite(a: Place, b: Place) -> bool:
    """Whether the residuals have opposite signs."""
    return (a.residual < 0.0 and 0.0 <= b.residual) or (b.residual <= 0.0 and 0.0 < a.residual)


def falls(a: Place, b: Place) -> bool:
    """Whether the residual falls, in its absolute value, from a towards b."""
    return a.residual * (b.value - a.value) * a.slope < 0.0


def hides(a: Place, b: Place) -> bool:
    """Whether residuals of the same sign may change it twice between: they fall from both sides, or from one
    to where they are larger."""
    one = fabs(a.residual)
    other = fabs(b.residual)
    if falls(a, b):
        return falls(b, a) or other > one
    return falls(b, a) and one > other


def apart(a: Place, b: Place) -> bool:
    """Whether the tangents at two places, from both of which the residuals fall, meet before they are zero:
    no curve that bends one way is zero between."""
    if not (falls(a, b) and falls(b, a)):
        return False
    one = a.residual / a.slope
    other = b.residual / b.slope
    return fabs(one) + fabs(other) > fabs(b.value - a.value)


def closer(a: Place, b: Place, at: Place, before: Real) -> Real:
    """Where the tangent at one of two places is zero, if that is between them and less than half as far away
    as the step `before` went; else in the middle."""
    there = at.value - at.residual / at.slope if at.slope != 0.0 else at.value + before
    if there == at.value:
        return there
    inside = (a.value < there and there < b.value) or (b.value < there and there < a.value)
    if inside and fabs(there - at.value) < 0.5 * fabs(before):
        return there
    return 0.5 * (a.value + b.value)


def halve(p: Params, t: Real, y: Vec[NU], i: int, j: int, one: Place, other: Place, w: StartWork) -> bool:
    """Move y to where the residual changes its sign between two places; False where it jumps there."""
    a = Place()
    put(a, one)
    b = Place()
    put(b, other)
    middle = Place()
    put(middle, b)
    before = b.value - a.value
    for n in range(HALVINGS):
        value = closer(a, b, middle, before)
        if value == a.value or value == b.value:
            break
        before = value - middle.value
        look(p, t, y, i, j, value, middle, w)
        if opposite(a, middle):
            put(b, middle)
        else:
            put(a, middle)
    if fabs(a.residual) < fabs(b.residual):
        put(b, a)
    y[j] = b.value
    least = fabs(one.residual) if fabs(one.residual) < fabs(other.residual) else fabs(other.residual)
    return fabs(b.residual) <= least


def meet_between(
    p: Params, t: Real, y: Vec[NU], i: int, j: int, one: Place, other: Place, w: StartWork
) -> bool:
    """Move y to where the condition holds between two places, if it is found to."""
    a = Place()
    put(a, one)
    b = Place()
    put(b, other)
    middle = Place()
    for n in range(HALVINGS):
        if opposite(a, b):
            return halve(p, t, y, i, j, a, b, w)
        if not hides(a, b) or (n >= CURVED and apart(a, b)):
            return False
        look(p, t, y, i, j, 0.5 * (a.value + b.value), middle, w)
        if opposite(a, middle):
            return halve(p, t, y, i, j, a, middle, w) or halve(p, t, y, i, j, middle, b, w)
        if hides(a, middle):
            put(b, middle)
        else:
            put(a, middle)
    return False


def climb(
    p: Params, t: Real, y: Vec[NU], i: int, j: int, k: int, size: Real, end: Place, w: StartWork
) -> bool:
    """From one end of what was seen to rung k; whether the condition holds between."""
    if k > 2 * RUNGS + 1 or -k > 2 * RUNGS + 1:
        return False
    there = Place()
    look(p, t, y, i, j, rung(k, size), there, w)
    if meet_between(p, t, y, i, j, end, there, w):
        return True
    put(end, there)
    return False


def meet_alone(p: Params, t: Real, y: Vec[NU], i: int, j: int, w: StartWork) -> None:
    """Move unknown j in y to where condition i holds, found upwards and downwards by turns."""
    home = y[j]
    up = Place()
    down = Place()
    look(p, t, y, i, j, home, up, w)
    put(down, up)
    judge(y, w.J, w.sizes, w)
    if ratio(w.c[i], w.floors[i], w.scales[i]) <= ACCEPTED:
        return
    size = fabs(home) if home != 0.0 else w.weights[j]
    middle = 0
    if home != 0.0:
        middle = RUNGS + 1 if home > 0.0 else -RUNGS - 1
    for k in range(1, 3 * RUNGS + 3):
        if climb(p, t, y, i, j, middle + k, size, up, w):
            return
        if climb(p, t, y, i, j, middle - k, size, down, w):
            return
    y[j] = home


def left_alone(i: int, w: StartWork) -> int:
    """The only unknown in condition i that is marked, or -1."""
    alone = -1
    first = row_begin(i)
    end = ends[i]
    for k in range(first, end):
        if w.marks[w.column[k]] == 1:
            if alone >= 0:
                return -1
            alone = w.column[k]
    return alone


def settle(p: Params, t: Real, w: StartWork) -> None:
    """w.settled: the guess, where unknowns that nobody stated meet, one after the other, the conditions of
    positions in which no other is left."""
    w.settled[:] = w.home
    owned = w.owned
    for k in range(owned):
        i = w.own[k]
        w.marks[i] = 1 if w.levels[i] == UNSTATED else 0
    end = w.positions
    changed = True
    while changed:
        changed = False
        for r in range(end):
            alone = left_alone(w.rows[r], w)
            if alone >= 0:
                w.marks[alone] = 0
                changed = True
                meet_alone(p, t, w.settled, w.rows[r], alone, w)
