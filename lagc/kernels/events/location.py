"""Where conditions change: switches, within a step.

Where time alone changes a switch, a step ends there.  Elsewhere what it changes at is enclosed over the step
(R. E. Moore, *Interval Analysis*, 1966), on ever smaller parts of its dense output, where it might; a step
that passes a change is made once more, to end there.  L. F. Shampine, I. Gladwell, R. W. Brankin: Reliable
solution of special event location problems for ODEs, ACM Trans. Math. Software 17 (1991) 11-25.
"""

from __future__ import annotations

from math import fabs, inf, sqrt

from lagc.kernels.dynamics.rhs import rhs_at
from lagc.kernels.events.enclosing import (
    COARSEST,
    NONE,
    dense_of_trial,
    enclose_state,
    enclose_step,
    enclose_time,
    is_known,
    look_at,
)
from lagc.kernels.events.modes import margin
from lagc.kernels.integrators.dispatch import method_at
from lagc.kernels.language.model import fn_enclosure_on, fn_side_rates_on, fn_sides_on, fn_slopes_on
from lagc.kernels.language.records import State, Trial, Work
from lagc.kernels.language.scaling_groups import enlarge
from lagc.kernels.language.sizes import NEDGES, NFREE, NKIND, NMODE, NQ, NTIMED, NV, NX
from lagc.kernels.language.statuses import failed
from lagc.kernels.language.tables import counted, kind
from lagc.kernels.language.tolerances import NEARLY_THERE, SPACING
from lagc.kernels.language.words import Params, Real, Vec, vector

FINEST = 0.00390625  # the shortest that is looked at by its ends
THINNEST = 1e-9  # of a step: what is narrower is not looked for
MOST_LOOKED = 64  # parts that are as short, in a step that stays beside a change
LEAST_SLACK = 2.0  # of what a switch is beyond its change by rounding; more where it is so again in a step,
MOST_SLACK = 4096.0  # but what is beyond ever again is so for another reason
SEVERAL = 8.0  # last places


def margins(p: Params, t: Real, x: Vec[NX], s: State, w: Work) -> None:
    """w.margins, of those switches that the state changes."""
    fn_sides_on(p, t, x, w.modes, w.sides)
    for j in range(NFREE):
        k = NTIMED + j
        w.margins[j] = margin(k, w.sides[k], s.slack[k], w)


def passed(p: Params, t: Real, x: Vec[NX], s: State, w: Work) -> bool:
    """Whether one of them is beyond its change."""
    margins(p, t, x, s, w)
    for j in range(NFREE):
        if w.margins[j] < 0.0:
            return True
    return False


def nearest(p: Params, t: Real, x: Vec[NX], s: State, w: Work) -> Real:
    """The least of these margins, each in what it changes by between two parts of the step, w.spans: their
    units differ."""
    least = inf
    margins(p, t, x, s, w)
    for j in range(NFREE):
        own = w.margins[j] / w.spans[j] if w.spans[j] > 0.0 else w.margins[j]
        if own < least:
            least = own
    return least


def within_mode(k: int, low: Real, high: Real, w: Work) -> bool:
    """Whether a side that is between these changes nothing."""
    if NEDGES > 0:
        if counted[k] > 0:
            return low > w.edges[2 * k] and high < w.edges[2 * k + 1]
    if w.modes[k] == 0.0:
        return low >= 0.0 and high <= 0.0
    return low > 0.0 if w.modes[k] > 0.0 else high < 0.0


def certain(p: Params, s: State, w: Work) -> bool:
    """Whether no switch changes in w.box."""
    fn_enclosure_on(p, w.modes, w.box, w.ends)
    for j in range(NFREE):
        k = NTIMED + j
        low = w.ends[2 * j] + s.slack[k]
        high = w.ends[2 * j + 1] - s.slack[k]
        if not (is_known(w.ends[2 * j], w.ends[2 * j + 1]) and within_mode(k, low, high, w)):
            return False
    return True


def located(p: Params, s: State, method: int, h: Real, left: Real, right: Real, w: Work) -> Real:
    """Where the least margin changes its sign between two parts of the step, to the last place of the time:
    just beyond, with w.crossed.  Regula falsi, every third time halves."""
    low = left
    high = right
    method_at(method, low, s, w.middle)
    margins(p, s.t + low * h, w.middle, s, w)
    w.spans[:] = w.margins
    method_at(method, high, s, w.middle)
    margins(p, s.t + high * h, w.middle, s, w)
    for j in range(NFREE):
        w.spans[j] = fabs(w.spans[j] - w.margins[j])
    above = nearest(p, s.t + high * h, w.middle, s, w)
    method_at(method, low, s, w.middle)
    below = nearest(p, s.t + low * h, w.middle, s, w)
    least = 2.0 * SPACING * (1.0 + fabs(s.t / h))
    turn = 0
    while high - low > least:
        part = 0.5
        if turn % 3 < 2 and below > 0.0:
            part = below / (below - above)
        shortest = 0.5 * least / (high - low)
        if part < shortest:
            part = shortest
        if part > 1.0 - shortest:
            part = 1.0 - shortest
        guess = low + part * (high - low)
        method_at(method, guess, s, w.middle)
        found = nearest(p, s.t + guess * h, w.middle, s, w)
        if found < 0.0:
            high = guess
            above = found
            below *= 0.5
        else:
            low = guess
            below = found
            above *= 0.5
        turn += 1
    method_at(method, high, s, w.middle)
    margins(p, s.t + high * h, w.middle, s, w)
    for i in range(NTIMED):
        w.crossed[i] = 0
    for j in range(NFREE):
        w.crossed[NTIMED + j] = 1 if w.margins[j] < 0.0 else 0
    return high


def first_change(p: Params, s: State, method: int, a: Trial, w: Work) -> Real:
    """The part of the step from s.x to s.y after which a switch changes first; NONE; below zero where that
    cannot be told."""
    enclose_step(s, method, a, w)
    if certain(p, s, w):
        return NONE
    if failed(dense_of_trial(p, s, method, a, w)):
        return -1.0
    looked = 0
    left = 0.0
    width = COARSEST
    w.left_x[:] = s.x
    while left < 1.0:
        right = left + width if left + width < 1.0 else 1.0
        look_at(s, method, a, left, right, w)
        if certain(p, s, w):
            if width < COARSEST:
                width *= 2.0
        elif width > FINEST:
            width *= 0.5
            continue
        elif passed(p, s.t + right * a.h, w.right_x, s, w):
            return located(p, s, method, a.h, left, right, w)
        elif looked < MOST_LOOKED:  # it may be passed twice
            looked += 1
            if width > THINNEST:
                width *= 0.5
                continue
        else:
            width = FINEST
        left = right
        w.left_x[:] = w.right_x
    return NONE


def inward(k: int, direction: Real, w: Work) -> bool:
    """Whether a side moves away from its change, w.turning."""
    rate = w.turning[k] * direction
    if NEDGES > 0:
        if counted[k] > 0:
            above = w.edges[2 * k + 1] - w.sides[k] < w.sides[k] - w.edges[2 * k]
            return rate < 0.0 if above else rate > 0.0
    return rate * w.modes[k] > 0.0


def all_inward(direction: Real, w: Work) -> bool:
    for j in range(NFREE):
        if w.crossed[NTIMED + j] > 0 and not inward(NTIMED + j, direction, w):
            return False
    return True


def only_seem(p: Params, s: State, method: int, part: Real, much: Real, a: Trial, w: Work) -> bool:
    """Whether switches that change after this part of the step, w.crossed, move away from their changes both
    where it begins and there: what is beyond is so by rounding, and from then on that is slack."""
    fn_side_rates_on(p, s.t, s.x, w.modes, s.k[0], w.turning)
    if not all_inward(a.direction, w):
        return False
    method_at(method, part, s, w.middle)
    s.rhs += 1
    if failed(rhs_at(p, s.t + part * a.h, w.middle, w.xdot, w.lam, w)):
        return False
    fn_side_rates_on(p, s.t + part * a.h, w.middle, w.modes, w.xdot, w.turning)
    if not all_inward(a.direction, w):
        return False
    for j in range(NFREE):
        if w.crossed[NTIMED + j] > 0:
            s.slack[NTIMED + j] -= much * w.margins[j]
    return True


def smear(p: Params, s: State, reach: Vec[NX], w: Work) -> None:
    """w.blurs: what last places of time and of states that are as large as here, or as `reach`, are worth in
    the sides that these change."""
    enclose_time(s.t - SPACING * fabs(s.t), s.t + SPACING * fabs(s.t), w)
    for i in range(NQ + NV):
        size = fabs(s.x[i]) if fabs(s.x[i]) > fabs(reach[i]) else fabs(reach[i])
        enclose_state(i, s.x[i], s.x[i], SPACING * size, w)
    fn_enclosure_on(p, w.modes, w.box, w.ends)
    for j in range(NFREE):
        far = w.ends[2 * j + 1] - w.ends[2 * j]
        w.blurs[j] = far if far >= 0.0 and far < inf else 0.0


def still_at_rest(k: int, s: State, w: Work) -> bool:
    """Whether a side that was at rest, w.beside now, has not left its slack."""
    return s.modes[k] == 0.0 and counted[k] == 0 and fabs(w.beside[k]) <= s.slack[k]


def passes(k: int, direction: Real, w: Work) -> bool:
    """Whether a switch changes where dense output says so, by the rate of its side, w.turning, where the step
    has ended: what moves away from its change has not come to it, and what moves back has not left it."""
    if w.modes[k] == 0.0 and counted[k] == 0:
        ahead = w.turning[k] * direction
        return ahead * w.beside[k] >= 0.0 and (w.beside[k] != 0.0 or ahead != 0.0)
    return not inward(k, direction, w)


def draw_tight(p: Params, s: State, w: Work) -> None:
    """Sides that have got away from their changes, by several times their slack, need none any more."""
    fn_sides_on(p, s.t, s.x, w.modes, w.sides)
    for j in range(NFREE):
        k = NTIMED + j
        if margin(k, w.sides[k], 0.0, w) > SEVERAL * s.slack[k]:
            s.slack[k] = 0.0


def slacken(p: Params, s: State, k: int, w: Work) -> None:
    """More slack for a switch that dense output says has changed, and has not: what that was off by, as
    beside what grows from nothing; ever nearer to what last places of sizes in its step are worth, where that
    is more: what the side is to become may be far less."""
    sizes = vector(NKIND)
    for i in range(NKIND):
        sizes[i] = 0.0
    enlarge(s.x, sizes)
    enlarge(w.arrived, sizes)
    for i in range(NQ + NV):
        w.middle[i] = sizes[kind[i]]
    smear(p, s, w.middle, w)
    j = k - NTIMED
    off = fabs(margin(k, w.beside[k], s.slack[k], w)) + fabs(w.margins[j])
    blur = w.blurs[j]
    if off < blur:
        least = s.slack[k] if s.slack[k] > off else off
        off = blur * sqrt(sqrt(least / blur))
    s.slack[k] += SEVERAL * off


def any_passes(p: Params, s: State, direction: Real, w: Work) -> bool:
    """Whether any in w.crossed does; others are taken out."""
    found = False
    for k in range(NMODE):
        if w.crossed[k] > 0:
            if k >= NTIMED:
                goes = passes(k, direction, w)
                if not goes or still_at_rest(k, s, w):
                    slacken(p, s, k, w)
                if not goes:
                    w.crossed[k] = 0
            if w.crossed[k] > 0:
                found = True
    return found


def all_but_changes(p: Params, s: State, direction: Real, w: Work) -> bool:
    """Whether a switch changes within some last places of the time, w.crossed: where the branch ends there,
    as sqrt(x) does at 0, no step gets any nearer."""
    found = False
    time = NEARLY_THERE * SPACING * fabs(s.t)
    fn_sides_on(p, s.t, s.x, w.modes, w.sides)
    fn_side_rates_on(p, s.t, s.x, w.modes, s.k[0], w.turning)
    for k in range(NMODE):
        w.crossed[k] = 0
    for j in range(NFREE):
        i = NTIMED + j
        own = margin(i, w.sides[i], s.slack[i], w)
        if own < time * fabs(w.turning[i]):
            if own > margin(i, w.sides[i] + time * direction * w.turning[i], s.slack[i], w):
                w.crossed[i] = 1
                found = True
    return found


def due(k: int, t: Real, direction: Real, w: Work) -> Real:
    """When time changes this switch, on from t; infinite where it does not."""
    slope = w.slopes[k]
    ahead = slope * direction
    if NEDGES > 0:
        if counted[k] > 0:
            target = w.edges[2 * k + 1] if ahead > 0.0 else w.edges[2 * k]
            return t + (target - w.sides[k]) / slope
    if not w.modes[k] * ahead < 0.0:
        return inf * direction
    return t - w.sides[k] / slope


def next_change(p: Params, s: State, t1: Real, direction: Real, w: Work) -> Real:
    """The time at which time itself changes a switch next, with w.crossed; t1 where that comes before."""
    fn_slopes_on(p, w.modes, w.slopes)
    fn_sides_on(p, s.t, s.x, w.modes, w.sides)
    soon = inf * direction
    first = 0
    for k in range(NMODE):
        w.crossed[k] = 0
    for k in range(NTIMED):
        w.when[k] = due(k, s.t, direction, w)
        if (w.when[k] - soon) * direction < 0.0:
            soon = w.when[k]
            first = k
    if not fabs(soon) < inf:
        return t1
    fn_sides_on(p, soon, s.x, w.modes, w.sides)
    soon = due(first, soon, direction, w)
    near = 8.0 * SPACING * (fabs(soon) + fabs(s.t))
    if (soon - s.t) * direction < 0.0:
        soon = s.t
    if fabs(soon - t1) <= near:
        soon = t1
    if (soon - t1) * direction > 0.0:
        return t1
    for k in range(NTIMED):
        if fabs(w.when[k] - soon) <= near:
            w.crossed[k] = 1
    return soon


def any_due(w: Work) -> bool:
    """Whether time changes a switch where it was found to."""
    for k in range(NTIMED):
        if w.crossed[k] > 0:
            return True
    return False
