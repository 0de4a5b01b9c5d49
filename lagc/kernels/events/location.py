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
    LONGEST_PART,
    NO_EVENT,
    enclose_dense_output,
    enclose_state,
    enclose_step,
    enclose_time,
    is_known,
    trial_dense_output,
)
from lagc.kernels.events.modes import margin
from lagc.kernels.integrators.dispatch import method_dense_at
from lagc.kernels.language.model import fn_enclosure_on, fn_indicator_rates_on, fn_indicators_on, fn_slopes_on
from lagc.kernels.language.records import State, Trial, Work
from lagc.kernels.language.scaling_groups import enlarge_sizes
from lagc.kernels.language.sizes import NEDGES, NFREE, NGROUP, NMODE, NQ, NTIMED, NV, NX
from lagc.kernels.language.statuses import failed
from lagc.kernels.language.tables import has_edges, scaling_group
from lagc.kernels.language.tolerances import EVENT_TIME_ULPS, SPACING
from lagc.kernels.language.words import Params, Real, Vec, vector

SHORTEST_PART = 0.00390625  # the shortest that is looked at by its ends
NARROWEST_PART = 1e-9  # of a step: what is narrower is not looked for
MOST_SHORT_PARTS = 64  # parts that are as short, in a step that stays beside a change
LEAST_SLACK = 2.0  # of what a switch is beyond its change by rounding; more where it is so again in a step,
MOST_SLACK = 4096.0  # but what is beyond ever again is so for another reason
SLACK_GROWTH = 8.0  # last places


def update_margins(p: Params, t: Real, x: Vec[NX], s: State, w: Work) -> None:
    """w.margins, of those switches that the state changes."""
    fn_indicators_on(p, t, x, w.modes, w.indicators)
    for j in range(NFREE):
        k = NTIMED + j
        w.margins[j] = margin(k, w.indicators[k], s.slack[k], w)


def any_crossed(p: Params, t: Real, x: Vec[NX], s: State, w: Work) -> bool:
    """Whether one of them is beyond its change."""
    update_margins(p, t, x, s, w)
    for j in range(NFREE):
        if w.margins[j] < 0.0:
            return True
    return False


def smallest_margin(p: Params, t: Real, x: Vec[NX], s: State, w: Work) -> Real:
    """The least of these margins, each in what it changes by between two parts of the step, w.margin_changes: their
    units differ."""
    least = inf
    update_margins(p, t, x, s, w)
    for j in range(NFREE):
        own = w.margins[j] / w.margin_changes[j] if w.margin_changes[j] > 0.0 else w.margins[j]
        if own < least:
            least = own
    return least


def within_mode(k: int, low: Real, high: Real, w: Work) -> bool:
    """Whether a side that is between these changes nothing."""
    if NEDGES > 0:
        if has_edges[k] > 0:
            return low > w.edges[2 * k] and high < w.edges[2 * k + 1]
    if w.modes[k] == 0.0:
        return low >= 0.0 and high <= 0.0
    return low > 0.0 if w.modes[k] > 0.0 else high < 0.0


def excludes_crossings(p: Params, s: State, w: Work) -> bool:
    """Whether no switch changes in w.box."""
    fn_enclosure_on(p, w.modes, w.box, w.enclosures)
    for j in range(NFREE):
        k = NTIMED + j
        low = w.enclosures[2 * j] + s.slack[k]
        high = w.enclosures[2 * j + 1] - s.slack[k]
        if not (is_known(w.enclosures[2 * j], w.enclosures[2 * j + 1]) and within_mode(k, low, high, w)):
            return False
    return True


def locate_crossing(p: Params, s: State, method: int, h: Real, left: Real, right: Real, w: Work) -> Real:
    """Where the least margin changes its sign between two parts of the step, to the last place of the time:
    just beyond, with w.crossed.  Regula falsi, every third time halves."""
    low = left
    high = right
    method_dense_at(method, low, s, w.x_part_middle)
    update_margins(p, s.t + low * h, w.x_part_middle, s, w)
    w.margin_changes[:] = w.margins
    method_dense_at(method, high, s, w.x_part_middle)
    update_margins(p, s.t + high * h, w.x_part_middle, s, w)
    for j in range(NFREE):
        w.margin_changes[j] = fabs(w.margin_changes[j] - w.margins[j])
    above = smallest_margin(p, s.t + high * h, w.x_part_middle, s, w)
    method_dense_at(method, low, s, w.x_part_middle)
    below = smallest_margin(p, s.t + low * h, w.x_part_middle, s, w)
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
        method_dense_at(method, guess, s, w.x_part_middle)
        found = smallest_margin(p, s.t + guess * h, w.x_part_middle, s, w)
        if found < 0.0:
            high = guess
            above = found
            below *= 0.5
        else:
            low = guess
            below = found
            above *= 0.5
        turn += 1
    method_dense_at(method, high, s, w.x_part_middle)
    update_margins(p, s.t + high * h, w.x_part_middle, s, w)
    for i in range(NTIMED):
        w.crossed[i] = 0
    for j in range(NFREE):
        w.crossed[NTIMED + j] = 1 if w.margins[j] < 0.0 else 0
    return high


def first_crossing(p: Params, s: State, method: int, a: Trial, w: Work) -> Real:
    """The part of the step from s.x to s.x_new after which a switch changes first; NO_EVENT; below zero where that
    cannot be told."""
    enclose_step(s, method, a, w)
    if excludes_crossings(p, s, w):
        return NO_EVENT
    if failed(trial_dense_output(p, s, method, a, w)):
        return -1.0
    looked = 0
    left = 0.0
    width = LONGEST_PART
    w.x_part_begin[:] = s.x
    while left < 1.0:
        right = left + width if left + width < 1.0 else 1.0
        enclose_dense_output(s, method, a, left, right, w)
        if excludes_crossings(p, s, w):
            if width < LONGEST_PART:
                width *= 2.0
        elif width > SHORTEST_PART:
            width *= 0.5
            continue
        elif any_crossed(p, s.t + right * a.h, w.x_part_end, s, w):
            return locate_crossing(p, s, method, a.h, left, right, w)
        elif looked < MOST_SHORT_PARTS:  # it may be passed twice
            looked += 1
            if width > NARROWEST_PART:
                width *= 0.5
                continue
        else:
            width = SHORTEST_PART
        left = right
        w.x_part_begin[:] = w.x_part_end
    return NO_EVENT


def moves_away(k: int, direction: Real, w: Work) -> bool:
    """Whether a side moves away from its change, w.indicator_rates."""
    rate = w.indicator_rates[k] * direction
    if NEDGES > 0:
        if has_edges[k] > 0:
            above = w.edges[2 * k + 1] - w.indicators[k] < w.indicators[k] - w.edges[2 * k]
            return rate < 0.0 if above else rate > 0.0
    return rate * w.modes[k] > 0.0


def all_move_away(direction: Real, w: Work) -> bool:
    for j in range(NFREE):
        if w.crossed[NTIMED + j] > 0 and not moves_away(NTIMED + j, direction, w):
            return False
    return True


def crosses_by_roundoff(p: Params, s: State, method: int, part: Real, much: Real, a: Trial, w: Work) -> bool:
    """Whether switches that change after this part of the step, w.crossed, move away from their changes both
    where it begins and there: what is beyond is so by rounding, and from then on that is slack."""
    fn_indicator_rates_on(p, s.t, s.x, w.modes, s.k[0], w.indicator_rates)
    if not all_move_away(a.direction, w):
        return False
    method_dense_at(method, part, s, w.x_part_middle)
    s.rhs += 1
    if failed(rhs_at(p, s.t + part * a.h, w.x_part_middle, w.xdot, w.lam, w)):
        return False
    fn_indicator_rates_on(p, s.t + part * a.h, w.x_part_middle, w.modes, w.xdot, w.indicator_rates)
    if not all_move_away(a.direction, w):
        return False
    for j in range(NFREE):
        if w.crossed[NTIMED + j] > 0:
            s.slack[NTIMED + j] -= much * w.margins[j]
    return True


def estimate_indicator_roundoff(p: Params, s: State, reach: Vec[NX], w: Work) -> None:
    """w.indicator_roundoff: what last places of time and of states that are as large as here, or as `reach`, are worth in
    the sides that these change."""
    enclose_time(s.t - SPACING * fabs(s.t), s.t + SPACING * fabs(s.t), w)
    for i in range(NQ + NV):
        size = fabs(s.x[i]) if fabs(s.x[i]) > fabs(reach[i]) else fabs(reach[i])
        enclose_state(i, s.x[i], s.x[i], SPACING * size, w)
    fn_enclosure_on(p, w.modes, w.box, w.enclosures)
    for j in range(NFREE):
        far = w.enclosures[2 * j + 1] - w.enclosures[2 * j]
        w.indicator_roundoff[j] = far if far >= 0.0 and far < inf else 0.0


def is_still_sliding(k: int, s: State, w: Work) -> bool:
    """Whether a side that was at rest, w.indicators_before now, has not left its slack."""
    return s.modes[k] == 0.0 and has_edges[k] == 0 and fabs(w.indicators_before[k]) <= s.slack[k]


def is_crossing(k: int, direction: Real, w: Work) -> bool:
    """Whether a switch changes where dense output says so, by the rate of its side, w.indicator_rates, where the step
    has ended: what moves away from its change has not come to it, and what moves back has not left it."""
    if w.modes[k] == 0.0 and has_edges[k] == 0:
        ahead = w.indicator_rates[k] * direction
        return ahead * w.indicators_before[k] >= 0.0 and (w.indicators_before[k] != 0.0 or ahead != 0.0)
    return not moves_away(k, direction, w)


def release_slack(p: Params, s: State, w: Work) -> None:
    """Sides that have got away from their changes, by several times their slack, need none any more."""
    fn_indicators_on(p, s.t, s.x, w.modes, w.indicators)
    for j in range(NFREE):
        k = NTIMED + j
        if margin(k, w.indicators[k], 0.0, w) > SLACK_GROWTH * s.slack[k]:
            s.slack[k] = 0.0


def increase_slack(p: Params, s: State, k: int, w: Work) -> None:
    """More slack for a switch that dense output says has changed, and has not: what that was off by, as
    beside what grows from nothing; ever nearer to what last places of sizes in its step are worth, where that
    is more: what the side is to become may be far less."""
    sizes = vector(NGROUP)
    for i in range(NGROUP):
        sizes[i] = 0.0
    enlarge_sizes(s.x, sizes)
    enlarge_sizes(w.x_trial, sizes)
    for i in range(NQ + NV):
        w.x_part_middle[i] = sizes[scaling_group[i]]
    estimate_indicator_roundoff(p, s, w.x_part_middle, w)
    j = k - NTIMED
    off = fabs(margin(k, w.indicators_before[k], s.slack[k], w)) + fabs(w.margins[j])
    blur = w.indicator_roundoff[j]
    if off < blur:
        least = s.slack[k] if s.slack[k] > off else off
        off = blur * sqrt(sqrt(least / blur))
    s.slack[k] += SLACK_GROWTH * off


def confirm_crossings(p: Params, s: State, direction: Real, w: Work) -> bool:
    """Whether any in w.crossed does; others are taken out."""
    found = False
    for k in range(NMODE):
        if w.crossed[k] > 0:
            if k >= NTIMED:
                goes = is_crossing(k, direction, w)
                if not goes or is_still_sliding(k, s, w):
                    increase_slack(p, s, k, w)
                if not goes:
                    w.crossed[k] = 0
            if w.crossed[k] > 0:
                found = True
    return found


def crosses_within_roundoff(p: Params, s: State, direction: Real, w: Work) -> bool:
    """Whether a switch changes within some last places of the time, w.crossed: where the branch ends there,
    as sqrt(x) does at 0, no step gets any nearer."""
    found = False
    time = EVENT_TIME_ULPS * SPACING * fabs(s.t)
    fn_indicators_on(p, s.t, s.x, w.modes, w.indicators)
    fn_indicator_rates_on(p, s.t, s.x, w.modes, s.k[0], w.indicator_rates)
    for k in range(NMODE):
        w.crossed[k] = 0
    for j in range(NFREE):
        i = NTIMED + j
        own = margin(i, w.indicators[i], s.slack[i], w)
        if own < time * fabs(w.indicator_rates[i]):
            if own > margin(i, w.indicators[i] + time * direction * w.indicator_rates[i], s.slack[i], w):
                w.crossed[i] = 1
                found = True
    return found


def crossing_time(k: int, t: Real, direction: Real, w: Work) -> Real:
    """When time changes this switch, on from t; infinite where it does not."""
    slope = w.indicator_slopes[k]
    ahead = slope * direction
    if NEDGES > 0:
        if has_edges[k] > 0:
            target = w.edges[2 * k + 1] if ahead > 0.0 else w.edges[2 * k]
            return t + (target - w.indicators[k]) / slope
    if not w.modes[k] * ahead < 0.0:
        return inf * direction
    return t - w.indicators[k] / slope


def next_time_event(p: Params, s: State, t1: Real, direction: Real, w: Work) -> Real:
    """The time at which time itself changes a switch next, with w.crossed; t1 where that comes before."""
    fn_slopes_on(p, w.modes, w.indicator_slopes)
    fn_indicators_on(p, s.t, s.x, w.modes, w.indicators)
    soon = inf * direction
    first = 0
    for k in range(NMODE):
        w.crossed[k] = 0
    for k in range(NTIMED):
        w.event_times[k] = crossing_time(k, s.t, direction, w)
        if (w.event_times[k] - soon) * direction < 0.0:
            soon = w.event_times[k]
            first = k
    if not fabs(soon) < inf:
        return t1
    fn_indicators_on(p, soon, s.x, w.modes, w.indicators)
    soon = crossing_time(first, soon, direction, w)
    near = 8.0 * SPACING * (fabs(soon) + fabs(s.t))
    if (soon - s.t) * direction < 0.0:
        soon = s.t
    if fabs(soon - t1) <= near:
        soon = t1
    if (soon - t1) * direction > 0.0:
        return t1
    for k in range(NTIMED):
        if fabs(w.event_times[k] - soon) <= near:
            w.crossed[k] = 1
    return soon


def is_time_event_due(w: Work) -> bool:
    """Whether time changes a switch where it was found to."""
    for k in range(NTIMED):
        if w.crossed[k] > 0:
            return True
    return False
