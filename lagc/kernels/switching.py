"""Switches: conditions that a motion changes.

A step is made on one branch, that of the modes it begins with.  Where time alone changes a switch, a step
ends there.  Elsewhere what it changes at is enclosed over the step (R. E. Moore, *Interval Analysis*, 1966),
on ever smaller parts of its dense output, where it might; a step that passes a change is made once more, to
end there.  L. F. Shampine, I. Gladwell, R. W. Brankin: Reliable solution of special event location problems
for ODEs, ACM Trans. Math. Software 17 (1991) 11-25.
"""

from __future__ import annotations

from math import fabs, inf

from lagc.kernels.enclosing import COARSEST, NONE, dense_of_trial, enclose_part, enclose_step
from lagc.kernels.limits import SPACING
from lagc.kernels.method import last, method_at
from lagc.kernels.model import (
    fn_edges_on,
    fn_enclosure_on,
    fn_modes,
    fn_own_on,
    fn_side_rates_on,
    fn_sides_on,
    fn_slopes_on,
)
from lagc.kernels.records import NOWHERE, State, Trial, Work
from lagc.kernels.rhs import rhs_at
from lagc.kernels.sizes import NEDGES, NFREE, NMODE, NTIMED, NX
from lagc.kernels.statuses import CHATTERING, OK, failed
from lagc.kernels.tables import counted
from lagc.kernels.words import Params, Real, Status, Vec

FINEST = 0.00390625  # the shortest that is looked at by its ends
THINNEST = 1e-9  # the shortest
MOST_LOOKED = 64  # parts that are as short, in a step that stays beside a change
MANY_TIMES = 1e5
MOST_AT_ONCE = 20  # changes at one time, and two for each switch
LITTLE = 1e-6  # of a step
NEARLY_THERE = 100.0  # last places of the time
TURNED = 1e-9  # of a rate: more than that back to where it came from is no rounding
STILL = 1e-12  # of the rates on both sides: less than that is rest between them


def sign_of(a: Real) -> Real:
    if a > 0.0:
        return 1.0
    return -1.0 if a < 0.0 else 0.0


def take(w: Work) -> None:
    """What goes with the modes."""
    if NEDGES > 0:
        fn_edges_on(w.modes, w.edges)


def margin(k: int, side: Real, slack: Real, w: Work) -> Real:
    """How far a side is from where its switch changes, below zero beyond it."""
    if NEDGES > 0:
        if counted[k] > 0:
            low = side - w.edges[2 * k]
            high = w.edges[2 * k + 1] - side
            return slack + (low if low < high else high)
    mode = w.modes[k]
    return slack + (mode * side if mode != 0.0 else -fabs(side))


def nearest(p: Params, t: Real, x: Vec[NX], s: State, w: Work) -> Real:
    """The least margin of those switches that the state changes."""
    least = inf
    fn_sides_on(p, t, x, w.modes, w.sides)
    for j in range(NFREE):
        k = NTIMED + j
        own = margin(k, w.sides[k], s.slack[k], w)
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
        known = w.ends[2 * j] <= w.ends[2 * j + 1]
        if not (known and within_mode(k, low, high, w)):
            return False
    return True


def located(p: Params, s: State, method: int, h: Real, left: Real, right: Real, w: Work) -> Real:
    """Where the least margin changes its sign between two parts of the step, to the last place of the time:
    just beyond, with w.crossed.  Regula falsi, every third time halves."""
    low = left
    high = right
    method_at(method, low, s, w.middle)
    below = nearest(p, s.t + low * h, w.middle, s, w)
    method_at(method, high, s, w.middle)
    above = nearest(p, s.t + high * h, w.middle, s, w)
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
    nearest(p, s.t + high * h, w.middle, s, w)
    for i in range(NTIMED):
        w.crossed[i] = 0
    for j in range(NFREE):
        k = NTIMED + j
        w.crossed[k] = 1 if margin(k, w.sides[k], s.slack[k], w) < 0.0 else 0
    return high


def first_change(p: Params, s: State, method: int, a: Trial, w: Work) -> Real:
    """The part of the step from s.x to s.y after which a switch changes first; NONE; below zero where that
    cannot be told."""
    enclose_step(s, a, s.k[last(method)], w)
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
        method_at(method, right, s, w.right_x)
        method_at(method, 0.5 * (left + right), s, w.middle)
        enclose_part(s.t, a.h, left, right, w)
        if certain(p, s, w):
            if width < COARSEST:
                width *= 2.0
        elif width > FINEST:
            width *= 0.5
            continue
        elif nearest(p, s.t + right * a.h, w.right_x, s, w) < 0.0:
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


def nudge_mode(k: int, direction: Real, w: Work, t: Real) -> None:
    """A side that has come to an edge of its mode, but for rounding, is where it goes."""
    ahead = w.turning[k] * direction
    near = 16.0 * SPACING * (fabs(w.sides[k]) + fabs(w.left_sides[k]) + fabs(t * w.turning[k]))
    if NEDGES > 0:
        if counted[k] > 0:
            if ahead > 0.0 and w.edges[2 * k + 1] - w.sides[k] <= near:
                w.modes[k] += 1.0
            elif ahead < 0.0 and w.sides[k] - w.edges[2 * k] <= near:
                w.modes[k] -= 1.0
            return
    if fabs(w.sides[k]) <= near and ahead != 0.0:
        w.modes[k] = sign_of(ahead)


def adopt_modes(p: Params, s: State, w: Work) -> None:
    """Sides that are others than w.beside take the modes that they tell, w.jumped."""
    for k in range(NMODE):
        w.jumped[k] = 0
    for turn in range(NMODE):
        done = True
        fn_sides_on(p, s.t, s.x, w.modes, w.sides)
        fn_own_on(p, s.t, s.x, w.modes, w.own_modes)
        for k in range(NMODE):
            if w.sides[k] != w.beside[k]:
                w.jumped[k] = 1
                if w.own_modes[k] != w.modes[k]:
                    w.modes[k] = w.own_modes[k]
                    done = False
        w.beside[:] = w.sides
        if done:
            break
    take(w)


def spread_changes(p: Params, s: State, direction: Real, rates: Vec[NX], w: Work) -> None:
    """Sides that depend on modes that have changed may jump, and are on another side of theirs then: those
    that were at their change too.  w.beside are those before; `rates` of the state there."""
    w.left_sides[:] = w.beside
    adopt_modes(p, s, w)
    fn_side_rates_on(p, s.t, s.x, w.modes, rates, w.turning)
    for k in range(NMODE):
        if w.jumped[k] > 0:
            nudge_mode(k, direction, w, s.t)
    take(w)


def keep_branch(s: State, w: Work) -> None:
    """The branch that was found; what a side is beyond its change, as it is where that was located, is none
    of another."""
    s.modes[:] = w.modes
    for k in range(NMODE):
        beyond = -margin(k, w.sides[k], 0.0, w)
        s.slack[k] = beyond if beyond > 0.0 else 0.0


def at_its_beginning(k: int, w: Work) -> bool:
    """Whether a side is at the lower edge of its mode."""
    if NEDGES > 0:
        return w.beside[k] == w.edges[2 * k]
    return False


def choose_branch(p: Params, s: State, direction: Real, w: Work) -> Status:
    """The branch on from a state of which nothing else is known, and the rates there."""
    fn_modes(p, s.t, s.x, w.modes)
    take(w)
    status = rhs_at(p, s.t, s.x, s.k[0], w.lam, w)
    s.rhs += 1
    if failed(status):
        return status
    fn_sides_on(p, s.t, s.x, w.modes, w.beside)
    fn_side_rates_on(p, s.t, s.x, w.modes, s.k[0], w.turning)
    changed = False
    for k in range(NMODE):
        ahead = sign_of(w.turning[k] * direction)
        w.crossed[k] = 0
        if counted[k] > 0:
            if at_its_beginning(k, w) and ahead < 0.0:
                w.modes[k] -= 1.0
                w.crossed[k] = 1
        elif w.modes[k] == 0.0 and ahead != 0.0:
            w.modes[k] = ahead
            w.crossed[k] = 1
        if w.crossed[k] > 0:
            changed = True
    w.sides[:] = w.beside
    if changed:
        spread_changes(p, s, direction, s.k[0], w)
        status = rhs_at(p, s.t, s.x, s.k[0], w.lam, w)
        s.rhs += 1
    keep_branch(s, w)
    return status


def turns_back(k: int, rate: Real, before: Real, direction: Real, w: Work) -> bool:
    """Whether a switch that has changed goes back at once, by its rates now and before."""
    ahead = rate * direction
    if counted[k] > 0:
        ahead *= sign_of(before * direction)
    else:
        ahead *= w.modes[k]
    return ahead < -TURNED * fabs(before)


def stays(p: Params, s: State, direction: Real, w: Work) -> bool:
    """Whether switches that only touched their change, as another turned them back there, are put back."""
    found = False
    others = 0
    for i in range(NMODE):
        others += w.crossed[i]
    for j in range(NFREE):
        k = NTIMED + j
        touches = w.crossed[k] > 0 and w.jumped[k] == 0 and others > 1
        if touches and turns_back(k, w.turning[k], w.before[k], direction, w):
            w.modes[k] = s.modes[k]
            w.crossed[k] = 0
            others -= 1
            found = True
    if found:
        take(w)
        fn_sides_on(p, s.t, s.x, w.modes, w.sides)
    return found


def rests(p: Params, s: State, k: int, rate: Real, before: Real, w: Work) -> bool:
    """Whether the side stays at zero, where its mode is zero."""
    if counted[k] > 0:
        return False
    mode = w.modes[k]
    w.modes[k] = 0.0
    s.rhs += 1
    if not failed(rhs_at(p, s.t, s.x, w.xdot, w.lam, w)):
        fn_side_rates_on(p, s.t, s.x, w.modes, w.xdot, w.turning)
        if fabs(w.turning[k]) <= STILL * (fabs(rate) + fabs(before)):
            return True
    w.modes[k] = mode
    return False


def late(k: int, direction: Real, w: Work) -> Real:
    """The time since this switch changed, by what its side was before."""
    target = 0.0
    if NEDGES > 0:
        if counted[k] > 0:
            target = w.left_edges[2 * k + 1] if w.before[k] * direction > 0.0 else w.left_edges[2 * k]
    return (w.left_sides[k] - target) / w.before[k] if w.before[k] != 0.0 else 0.0


def is_little(time: Real, s: State) -> bool:
    """Of a step, or last places of the time."""
    return fabs(time) <= LITTLE * fabs(s.h_old) + NEARLY_THERE * SPACING * fabs(s.t)


def put_right(p: Params, s: State, direction: Real, w: Work) -> None:
    """The state, for the time since the first of the switches in w.crossed changed, or until it does: what is
    left of a step that ends there, which rounding is for the most part, as times have last places."""
    for k in range(NMODE):
        if w.crossed[k] > 0:
            since = late(k, direction, w)
            if is_little(since, s):
                for i in range(NX):
                    apart = w.xdot[i] - w.left_rates[i]
                    s.x[i] += since * apart
                    if k < NTIMED:
                        s.jolts[i] += SPACING * fabs(s.t * apart)
                fn_sides_on(p, s.t, s.x, w.modes, w.sides)
            return


def follow_up(s: State, w: Work) -> None:
    """Changes that follow each other ever sooner, as bounces do, are not stepped over: the next step is no
    longer than many times what lies between the last two."""
    since = fabs(s.t - s.t_changed)
    for j in range(NFREE):
        if w.crossed[NTIMED + j] > 0 and since > 0.0 and s.h > MANY_TIMES * since:
            s.h = MANY_TIMES * since


def to_and_fro(s: State, w: Work) -> bool:
    """Whether switches change each other at one time without end."""
    if s.t != s.t_changed:
        s.t_changed = s.t
        s.changes_here = 0
    s.changes_here += 1
    for k in range(NMODE):
        if w.crossed[k] > 0:
            w.culprit = k
    return s.changes_here > MOST_AT_ONCE + 2 * NMODE


def change(p: Params, s: State, direction: Real, w: Work) -> Status:
    """The switches in w.crossed change at (s.t, s.x)."""
    fn_sides_on(p, s.t, s.x, w.modes, w.beside)
    if NEDGES > 0:
        for i in range(NEDGES):
            w.left_edges[i] = w.edges[i]
    s.rhs += 1
    status = rhs_at(p, s.t, s.x, w.left_rates, w.lam, w)
    if failed(status):
        return status
    fn_side_rates_on(p, s.t, s.x, w.modes, w.left_rates, w.before)
    for i in range(NMODE):
        if w.crossed[i] > 0:
            if counted[i] > 0:
                w.modes[i] += 1.0 if w.before[i] * direction > 0.0 else -1.0
            elif w.modes[i] == 0.0:
                w.modes[i] = sign_of(w.beside[i])
            else:
                w.modes[i] = -w.modes[i]
    spread_changes(p, s, direction, w.left_rates, w)
    s.rhs += 1
    status = rhs_at(p, s.t, s.x, w.xdot, w.lam, w)
    if failed(status):
        return status
    fn_side_rates_on(p, s.t, s.x, w.modes, w.xdot, w.turning)
    if stays(p, s, direction, w):
        s.rhs += 1
        status = rhs_at(p, s.t, s.x, w.xdot, w.lam, w)
        if failed(status):
            return status
        fn_side_rates_on(p, s.t, s.x, w.modes, w.xdot, w.turning)
    for j in range(NFREE):
        k = NTIMED + j
        rate = w.turning[k]
        if w.crossed[k] > 0 and w.jumped[k] == 0 and turns_back(k, rate, w.before[k], direction, w):
            # From rest it goes only where it does not come back.
            if s.modes[k] == 0.0 or not rests(p, s, k, rate, w.before[k], w):
                w.culprit = k
                return CHATTERING
    for i in range(NMODE):
        s.changed[i] = 1 if w.modes[i] != s.modes[i] else 0
    put_right(p, s, direction, w)
    keep_branch(s, w)
    follow_up(s, w)
    if to_and_fro(s, w):
        return CHATTERING
    s.changes += 1
    s.fresh = True
    s.rate = NOWHERE
    return OK
