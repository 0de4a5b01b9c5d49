"""Event location: zero crossings of event indicators within a step.

A step ends where a relation of time alone changes. Indicators that depend on the state are enclosed over
the step by interval arithmetic (R. E. Moore, Interval Analysis, Prentice-Hall 1966), on ever smaller parts
of its dense output while the enclosure contains zero. A step with a crossing is repeated so that it ends
there: L. F. Shampine, I. Gladwell, R. W. Brankin, Reliable solution of special event location problems for
ODEs, ACM Trans. Math. Software 17 (1991) 11-25.
"""

from math import fabs, inf, sqrt

from lagc.kernels.contact.indicators import force_crosses, force_range, indicate_forces, spare_contacts
from lagc.kernels.contact.touching import forget_forces, rates_at
from lagc.kernels.events.late_indicators import (
    add_late_range,
    estimate_late_roundoff,
    forget_late_range,
    indicator_rates_at,
    indicators_at,
    sample_late_step,
)
from lagc.kernels.events.modes import margin
from lagc.kernels.events.suspects import find_suspects, suspect, suspect_all, watch_all
from lagc.kernels.integrators.dispatch import (
    end_rate_row,
    method_dense_at,
    method_dense_output,
    method_stage_deviation,
    method_watched_at,
)
from lagc.kernels.language.vocabulary import *

LONGEST_PART = 0.125  # of a step: length of the longest part that is enclosed at once
ENCLOSURE_MARGIN = 0.25  # of the hull of the cubic over a step: what is added to it
NO_EVENT = 2.0  # a part behind the end of the step
SHORTEST_PART = 0.00390625  # length below which a part is tested by the values at its ends
NARROWEST_PART = 1e-9  # length below which two crossings are not told apart
MOST_SHORT_PARTS = 64  # shorter parts in one step, which may stay beside a crossing
LEAST_SLACK = 2.0  # slack over the distance beyond a crossing by round-off; it doubles in each repetition
MOST_SLACK = 4096.0  # up to this; then the crossing is taken for a true one
GROWTH_OF_SHORT = 8.0  # from such a part to the next one, behind a beginning at zero
SLACK_GROWTH = 8.0  # units in the last place


def enclose_time(t0: Real, t1: Real, w: Work) -> None:
    """Set the ends of the time in w.search.box."""
    w.search.box[0] = t0 if t0 < t1 else t1
    w.search.box[NQ + NV + 1] = t1 if t0 < t1 else t0


def enclose_state(i: int, low: Real, high: Real, more: Real, w: Work) -> None:
    """Set the ends of state i in w.search.box to [low - more, high + more]."""
    w.search.box[1 + i] = low - more
    w.search.box[NQ + NV + 2 + i] = high + more


def enclose_step(s: State, method: int, a: Trial, w: Work) -> None:
    """Set w.search.box to an estimate of the range of the step from s.x to s.x_new, of the states that bounds
    depend on. It is the hull of the control points of the cubic through both ends, widened by a quarter and
    by |h| times the largest deviation of a stage from this cubic."""
    # The cubic x(c) with x, h x' of both ends lies in the hull of its Bezier control points x0, x0 + h x0' /
    # 3, x1 - h x1' / 3, x1.
    enclose_time(s.t, a.t_new, w)
    for n in range(NENCLOSED):
        i = enclosed_state[n]
        low = s.x[i]
        high = low
        for j in range(3):
            if j == 0:
                value = s.x_new[i]
            elif j == 1:
                value = s.x[i] + a.h * s.k[0][i] / 3.0
            else:
                value = s.x_new[i] - a.h * s.k[end_rate_row(method)][i] / 3.0
            if value < low:
                low = value
            if value > high:
                high = value
        # Two margins: a quarter of the hull, and the most by which a stage's rate deviates from the cubic's
        # slope, over the step.
        deviation = fabs(a.h) * method_stage_deviation(method, i, a.h, s)
        enclose_state(i, low, high, ENCLOSURE_MARGIN * (high - low) + deviation, w)


def enclose_part(t: Real, h: Real, left: Real, right: Real, w: Work) -> None:
    """Set w.search.box to an estimate of the range of a part of a step: the hull of its ends and middle,
    widened by a quarter of their second difference, which is twice as wide as a parabola needs."""
    enclose_time(t + left * h, t + right * h, w)
    # The parabola through begin, middle and end leaves the hull of these by at most an eighth of the second
    # difference.
    for n in range(w.search.watching):
        i = w.search.watched[n]
        low = w.search.x_part_begin[i]
        high = low
        if w.search.x_part_middle[i] < low:
            low = w.search.x_part_middle[i]
        if w.search.x_part_middle[i] > high:
            high = w.search.x_part_middle[i]
        if w.search.x_part_end[i] < low:
            low = w.search.x_part_end[i]
        if w.search.x_part_end[i] > high:
            high = w.search.x_part_end[i]
        enclose_state(
            i,
            low,
            high,
            0.25 * fabs(w.search.x_part_begin[i] - 2.0 * w.search.x_part_middle[i] + w.search.x_part_end[i]),
            w,
        )


def enclose_dense_output(s: State, method: int, a: Trial, left: Real, right: Real, w: Work) -> None:
    """Set w.search.box for a part of a step by its dense output. w.search.x_part_begin is known."""
    method_watched_at(method, right, s, w.search.x_part_end, w)
    method_watched_at(method, 0.5 * (left + right), s, w.search.x_part_middle, w)
    enclose_part(s.t, a.h, left, right, w)


def trial_dense_output(p: Params, s: State, method: int, a: Trial, w: Work) -> Status:
    """Compute the coefficients of the dense output of the step from s.x to s.x_new."""
    # The method may use s.x_new as workspace: the end of the step is restored.
    w.search.x_trial[:] = s.x_new
    status = method_dense_output(method, p, s.t, s.x, w.search.x_trial, a.h, s, w)
    s.x_new[:] = w.search.x_trial
    s.dense_place = ABSENT
    return status


def update_margins(p: Params, t: Real, x: Vec[NX], s: State, w: Work) -> None:
    """Compute w.events.margins of suspected indicators."""
    indicators_at(p, t, x, w.modes, w.events.indicators, s, w)
    if NCON > 0:
        if w.events.seeks_forces:
            indicate_forces(p, t, x, w)
    for n in range(w.events.suspects):
        j = w.events.suspect[n]
        k = NTIMED + j
        w.events.margins[j] = margin(k, w.events.indicators[k], s.slack[k], w)


def any_crossed(p: Params, t: Real, x: Vec[NX], s: State, w: Work) -> bool:
    """Return whether a suspected indicator is beyond its crossing."""
    update_margins(p, t, x, s, w)
    for n in range(w.events.suspects):
        if w.events.margins[w.events.suspect[n]] < 0.0:
            return True
    return False


def smallest_margin(p: Params, t: Real, x: Vec[NX], s: State, w: Work) -> Real:
    """Return the smallest margin. Each is divided by its change over the part of the step,
    w.events.margin_changes, as the indicators have different units."""
    # Margins over their change in this part: which indicator crosses first is a question of time.
    least = inf
    update_margins(p, t, x, s, w)
    for n in range(w.events.suspects):
        j = w.events.suspect[n]
        own = (
            w.events.margins[j] / w.events.margin_changes[j]
            if w.events.margin_changes[j] > 0.0
            else w.events.margins[j]
        )
        if own < least:
            least = own
    return least


def update_all_margins(p: Params, t: Real, x: Vec[NX], s: State, w: Work) -> None:
    """Compute w.events.margins of all indicators that depend on the state."""
    suspect_all(w)
    update_margins(p, t, x, s, w)


def update_margin_changes(
    p: Params, s: State, method: int, h: Real, left: Real, right: Real, w: Work
) -> None:
    """Compute w.events.margin_changes, what the margins of suspected indicators change over a part of the
    step."""
    method_watched_at(method, left, s, w.search.x_part_middle, w)
    update_margins(p, s.t + left * h, w.search.x_part_middle, s, w)
    w.events.margin_changes[:] = w.events.margins
    method_watched_at(method, right, s, w.search.x_part_middle, w)
    update_margins(p, s.t + right * h, w.search.x_part_middle, s, w)
    for n in range(w.events.suspects):
        j = w.events.suspect[n]
        w.events.margin_changes[j] = fabs(w.events.margin_changes[j] - w.events.margins[j])


def locate_crossing(p: Params, s: State, method: int, h: Real, left: Real, right: Real, w: Work) -> Real:
    """Return the part of the step where the smallest margin changes sign, to one unit in the last place of
    the time and just beyond the crossing, with w.events.crossed. Illinois method (M. Dowell, P. Jarratt, BIT
    11 (1971) 168-174); each third iteration bisects."""
    # Of one block all indicators may cross at once; those of other blocks are known to stay in their modes.
    if not NAPART > 0:
        suspect_all(w)
        watch_all(w)
    # Margins of several indicators are compared by what each changes over the part.
    low = left
    high = right
    update_margin_changes(p, s, method, h, low, high, w)
    above = smallest_margin(p, s.t + high * h, w.search.x_part_middle, s, w)
    method_watched_at(method, low, s, w.search.x_part_middle, w)
    below = smallest_margin(p, s.t + low * h, w.search.x_part_middle, s, w)
    # An end that stays for a second time halves its value, so that the secant does not keep to one side.
    least = 2.0 * SPACING * (1.0 + fabs(s.t / h))
    turn = 0
    stays = 0  # 1: the last turn has replaced `high`, -1: `low`
    while high - low > least:
        # Regula falsi on two of three turns, and never nearer to an end than half of the least distance: so
        # both ends close in.
        part = 0.5
        if turn % 3 < 2 and below > 0.0:
            part = below / (below - above)
        shortest = 0.5 * least / (high - low)
        if part < shortest:
            part = shortest
        if part > 1.0 - shortest:
            part = 1.0 - shortest
        guess = low + part * (high - low)
        method_watched_at(method, guess, s, w.search.x_part_middle, w)
        found = smallest_margin(p, s.t + guess * h, w.search.x_part_middle, s, w)
        # The new end replaces the one of its sign; `high` is always beyond the crossing.
        if found < 0.0:
            high = guess
            above = found
            if stays > 0:
                below *= 0.5
            stays = 1
        else:
            low = guess
            below = found
            if stays < 0:
                above *= 0.5
            stays = -1
        turn += 1
    # All that are beyond at the end found cross together there.
    method_watched_at(method, high, s, w.search.x_part_middle, w)
    update_margins(p, s.t + high * h, w.search.x_part_middle, s, w)
    for k in range(NMODE):
        w.events.crossed[k] = 0
    for n in range(w.events.suspects):
        if w.events.margins[w.events.suspect[n]] < 0.0:
            w.events.crossed[NTIMED + w.events.suspect[n]] = 1
    return high


def begin_parts(most: int, s: State, w: Work) -> None:
    """Suspect the first indicators of w.events.suspect, and begin the parts of a step at s.x: discrete
    variables do not change in it."""
    suspect(most, s, w)
    w.search.x_part_begin[:] = s.x
    w.search.x_part_middle[:] = s.x
    w.search.x_part_end[:] = s.x


def sample_part(p: Params, s: State, a: Trial, left: Real, right: Real, w: Work) -> None:
    """Set the ranges of sampled indicators to those on a part of a step: ranges of longer parts would be
    wider than needed."""
    if NLATE > 0:
        forget_late_range(w)
        add_late_range(p, s.t + left * a.h, w.search.x_part_begin, s, w)
        add_late_range(p, s.t + 0.5 * (left + right) * a.h, w.search.x_part_middle, s, w)
        add_late_range(p, s.t + right * a.h, w.search.x_part_end, s, w)
    if NCON > 0:
        if w.events.seeks_forces:
            forget_forces(w)
            force_range(p, s.t + left * a.h, w.search.x_part_begin, w)
            force_range(p, s.t + 0.5 * (left + right) * a.h, w.search.x_part_middle, w)
            force_range(p, s.t + right * a.h, w.search.x_part_end, w)


def suspect_in_step(p: Params, s: State, method: int, a: Trial, w: Work) -> int:
    """Put the indicators that may cross in the step from s.x to s.x_new first in w.events.suspect; return how
    many these are."""
    enclose_step(s, method, a, w)
    # Indicators that need a solve are sampled on the cubic of the step.
    if NLATE > 0:
        sample_late_step(p, s, method, a, w)
    if NCON > 0:
        force_range(p, s.t, s.x, w)
    suspect_all(w)
    return find_suspects(p, s, w)


def first_crossing(p: Params, s: State, method: int, a: Trial, w: Work) -> Real:
    """Return the part of the step from s.x to s.x_new after which the first indicator crosses, NO_EVENT,
    or a negative number if the dense output failed."""
    # The cheap test on the whole step; nearly all steps end here.
    most = suspect_in_step(p, s, method, a, w)
    if most == 0:
        return NO_EVENT
    if failed(trial_dense_output(p, s, method, a, w)):
        return -1.0
    # Parts of the dense output from left to right: a part that cannot exclude a crossing is halved; one that
    # does is followed by its other half, and behind that, `fence`, by a longer one. So the first crossing is
    # found. Of several blocks, what a part has excluded is not looked at within it: up to `narrow`, the end
    # of the next parts, the first of w.events.suspect alone may cross.
    looked = 0
    left = 0.0
    width = LONGEST_PART
    fence = 0.0
    narrow = 1.0
    begin_parts(most, s, w)
    while left < 1.0:
        if NAPART > 0:
            if left >= narrow:
                suspect(most, s, w)
                narrow = 1.0
                method_watched_at(method, left, s, w.search.x_part_begin, w)
        right = left + width if left + width < narrow else narrow
        enclose_dense_output(s, method, a, left, right, w)
        sample_part(p, s, a, left, right, w)
        found = find_suspects(p, s, w)
        if found == 0:
            if width < LONGEST_PART and right >= fence:
                width *= 2.0 if width >= SHORTEST_PART else GROWTH_OF_SHORT
        elif width > SHORTEST_PART:
            fence = right
            if NAPART > 0:
                if found < w.events.suspects:
                    suspect(found, s, w)
                    narrow = right
            width *= 0.5
            continue
        # At 1/256 of the step: a crossing is located if an indicator is beyond at the end of the part; else
        # it may have crossed twice, and a limited number of parts is halved on to 1e-9. At the beginning
        # it is rather a gap that leaves zero: its bounds exclude that in parts of 1e-8, which then grow.
        elif any_crossed(p, s.t + right * a.h, w.search.x_part_end, s, w):
            return locate_crossing(p, s, method, a.h, left, right, w)
        elif looked < MOST_SHORT_PARTS:  # it may be crossed twice
            looked += 1
            if width > NARROWEST_PART:
                fence = right if left > 0.0 else 0.0
                width *= 0.5 if left > 0.0 else 1.0 / GROWTH_OF_SHORT
                continue
        else:
            width = SHORTEST_PART
        left = right
        w.search.x_part_begin[:] = w.search.x_part_end
    return NO_EVENT


def moves_away(k: int, direction: Real, w: Work) -> bool:
    """Return whether an indicator moves away from its crossing, by w.events.rates."""
    # Of a stepwise relation the nearer edge counts.
    rate = w.events.rates[k] * direction
    if NEDGES > 0:
        if has_edges[k] > 0:
            above = (
                w.events.edges[2 * k + 1] - w.events.indicators[k]
                < w.events.indicators[k] - w.events.edges[2 * k]
            )
            return rate < 0.0 if above else rate > 0.0
    return rate * w.modes[k] > 0.0


def all_move_away(direction: Real, w: Work) -> bool:
    """Return whether all indicators in w.events.crossed do so."""
    for j in range(NFREE):
        if w.events.crossed[NTIMED + j] > 0 and not moves_away(NTIMED + j, direction, w):
            return False
    return True


def crosses_by_roundoff(
    p: Params, s: State, method: int, part: Real, factor: Real, a: Trial, w: Work
) -> bool:
    """Return whether the indicators in w.events.crossed move away from their crossings both at the beginning
    of the step and after this part. They are beyond by round-off then, and `factor` times this is added to
    their slack."""
    # Forces of contacts have slack of their own, in `set_contact_slack`.
    if NCON > 0:
        if force_crosses(s, w):
            return False
    # At the beginning: an indicator that is beyond, and moves back into its mode, has not crossed.
    indicator_rates_at(p, s.t, s.x, w.modes, s.k[0], w.events.rates, s, w)
    if not all_move_away(a.direction, w):
        return False
    # And at the crossing: it must move away there too, else it came back for another crossing.
    method_dense_at(method, part, s, w.search.x_part_middle)
    s.rhs += 1
    if failed(rates_at(p, s.t + part * a.h, w.search.x_part_middle, w.xdot, w.lam, w)):
        return False
    indicator_rates_at(p, s.t + part * a.h, w.search.x_part_middle, w.modes, w.xdot, w.events.rates, s, w)
    if not all_move_away(a.direction, w):
        return False
    # The slack shifts the crossing by twice (then 4 times ...) the distance beyond: the next search does not
    # find it again.
    for j in range(NFREE):
        if w.events.crossed[NTIMED + j] > 0:
            s.slack[NTIMED + j] -= factor * w.events.margins[j]
    return True


def estimate_indicator_roundoff(p: Params, s: State, reach: Vec[NX], w: Work) -> None:
    """Compute w.events.roundoff: the change of each indicator of the state by one unit in the last
    place of the time and of states as large as here, or as `reach`."""
    # A box of one unit in the last place about (t, x): its enclosure is what round-off of time and states
    # makes of each indicator.
    enclose_time(s.t - SPACING * fabs(s.t), s.t + SPACING * fabs(s.t), w)
    for n in range(NENCLOSED):
        i = enclosed_state[n]
        size = fabs(s.x[i]) if fabs(s.x[i]) > fabs(reach[i]) else fabs(reach[i])
        enclose_state(i, s.x[i], s.x[i], SPACING * size, w)
    fn_enclosure_on(p, w.modes, w.search.box, w.events.enclosures)
    for j in range(NFREE):
        far = w.events.enclosures[2 * j + 1] - w.events.enclosures[2 * j]
        w.events.roundoff[j] = far if far >= 0.0 and far < inf else 0.0
    if NLATE > 0:
        estimate_late_roundoff(p, s, reach, w)


def is_within_slack(k: int, s: State, w: Work) -> bool:
    """Return whether an indicator in sliding mode, w.events.indicators_before, is within its slack."""
    return s.modes[k] == 0.0 and has_edges[k] == 0 and fabs(w.events.indicators_before[k]) <= s.slack[k]


def is_crossing(k: int, direction: Real, w: Work) -> bool:
    """Return whether an indicator that crosses in the dense output crosses at the end of the step, by its
    rate there. One that moves away has not reached its crossing; one that moves back has not left it."""
    # In sliding mode (0), a crossing leaves zero on the side on which it is: the rate must point there.
    if w.modes[k] == 0.0 and has_edges[k] == 0:
        ahead = w.events.rates[k] * direction
        return ahead * w.events.indicators_before[k] >= 0.0 and (
            w.events.indicators_before[k] != 0.0 or ahead != 0.0
        )
    return not moves_away(k, direction, w)


def has_slack(s: State) -> bool:
    """Return whether any indicator that depends on the state has slack."""
    for k in range(NTIMED, NMODE):
        if s.slack[k] != 0.0:
            return True
    return False


def release_slack(p: Params, s: State, w: Work) -> None:
    """Set the slack of an indicator to 0 once its margin is several times the slack."""
    if not has_slack(s):
        return
    # At the state of the beginning; contacts that touch are not watched by gaps.
    indicators_at(p, s.t, s.x, w.modes, w.events.indicators, s, w)
    if NCON > 0:
        spare_contacts(s, w)
    for j in range(NFREE):
        k = NTIMED + j
        if margin(k, w.events.indicators[k], 0.0, w) > SLACK_GROWTH * s.slack[k]:
            s.slack[k] = 0.0


def increase_slack(p: Params, s: State, k: int, w: Work) -> None:
    """Increase the slack of an indicator that crosses in the dense output, but not at the end of the step.
    The increase is the distance to the crossing; if the round-off of the indicator over the step is
    larger, it approaches this round-off from call to call."""
    # Round-off by the larger of both ends in each scaling group.
    sizes = vector(NGROUP)
    for i in range(NGROUP):
        sizes[i] = 0.0
    enlarge_sizes(s.x, sizes)
    enlarge_sizes(w.search.x_trial, sizes)
    for i in range(NQ + NV):
        w.search.x_part_middle[i] = sizes[scaling_group[i]]
    estimate_indicator_roundoff(p, s, w.search.x_part_middle, w)
    # The distance between end of step and dense output, or nearer to the round-off if that is larger: it
    # grows to it by fourth roots, so that one call does not overdo it.
    j = k - NTIMED
    off = fabs(margin(k, w.events.indicators_before[k], s.slack[k], w)) + fabs(w.events.margins[j])
    roundoff = w.events.roundoff[j]
    if off < roundoff:
        least = s.slack[k] if s.slack[k] > off else off
        off = roundoff * sqrt(sqrt(least / roundoff))
    s.slack[k] += SLACK_GROWTH * off


def confirm_crossings(p: Params, s: State, direction: Real, w: Work) -> bool:
    """Remove indicators from w.events.crossed that do not cross, and return whether any does."""
    # Time events are exact; the others must also cross at the end of the step, where the state is that of the
    # method and not of its dense output.
    found = False
    for k in range(NMODE):
        if w.events.crossed[k] > 0:
            if k >= NTIMED:
                crosses = is_crossing(k, direction, w)
                if not crosses or is_within_slack(k, s, w):
                    increase_slack(p, s, k, w)
                if not crosses:
                    w.events.crossed[k] = 0
            if w.events.crossed[k] > 0:
                found = True
    return found


def crosses_within_roundoff(p: Params, s: State, direction: Real, w: Work) -> bool:
    """Return whether an indicator crosses within round-off of the time, with w.events.crossed. No step gets
    nearer if the equations end at the crossing, as sqrt(x) at 0."""
    found = False
    # The time within which a linear extrapolation reaches the crossing, by the rate at the beginning.
    time = EVENT_TIME_ULPS * SPACING * fabs(s.t)
    indicators_at(p, s.t, s.x, w.modes, w.events.indicators, s, w)
    indicator_rates_at(p, s.t, s.x, w.modes, s.k[0], w.events.rates, s, w)
    if NCON > 0:
        spare_contacts(s, w)
    for k in range(NMODE):
        w.events.crossed[k] = 0
    for j in range(NFREE):
        i = NTIMED + j
        own = margin(i, w.events.indicators[i], s.slack[i], w)
        # It is near, and nearer at the end of that time: it moves to the crossing.
        if own < time * fabs(w.events.rates[i]):
            if own > margin(i, w.events.indicators[i] + time * direction * w.events.rates[i], s.slack[i], w):
                w.events.crossed[i] = 1
                found = True
    return found


def crossing_time(k: int, t: Real, direction: Real, w: Work) -> Real:
    """Return the time after t at which a relation of time alone changes, or infinity."""
    # z is linear in t: z(t + d) = z + slope d. Stepwise relations have the next edge as their target, signs
    # have 0.
    slope = w.events.slopes[k]
    ahead = slope * direction
    if NEDGES > 0:
        if has_edges[k] > 0:
            target = w.events.edges[2 * k + 1] if ahead > 0.0 else w.events.edges[2 * k]
            return t + (target - w.events.indicators[k]) / slope
    if not w.modes[k] * ahead < 0.0:
        return inf * direction
    return t - w.events.indicators[k] / slope


def next_time_event(p: Params, s: State, t1: Real, direction: Real, w: Work) -> Real:
    """Return the next time at which a relation of time alone changes, with w.events.crossed, or t1 if that
    comes first."""
    # Slopes and values at the present time give each relation its time.
    fn_slopes_on(p, w.modes, w.events.slopes)
    fn_indicators_on(p, s.t, s.x, w.modes, w.events.indicators)
    earliest = inf * direction
    first = 0
    for k in range(NMODE):
        w.events.crossed[k] = 0
    for k in range(NTIMED):
        w.events.times[k] = crossing_time(k, s.t, direction, w)
        if (w.events.times[k] - earliest) * direction < 0.0:
            earliest = w.events.times[k]
            first = k
    if not fabs(earliest) < inf:
        return t1
    # Once more from there: far from zero a time is known to its round-off there, not here.
    fn_indicators_on(p, earliest, s.x, w.modes, w.events.indicators)
    earliest = crossing_time(first, earliest, direction, w)
    near = 8.0 * SPACING * (fabs(earliest) + fabs(s.t))
    # A time that round-off puts into the past is now; one that round-off puts beside t1 is t1.
    if (earliest - s.t) * direction < 0.0:
        earliest = s.t
    if fabs(earliest - t1) <= near:
        earliest = t1
    if (earliest - t1) * direction > 0.0:
        return t1
    # Relations that change at one time do so together, with those that the caller of `event` is late for.
    for k in range(NTIMED):
        if (w.events.times[k] - earliest) * direction <= near:
            w.events.crossed[k] = 1
    return earliest


def is_time_event_due(w: Work) -> bool:
    """Return whether w.events.crossed holds a relation of time alone."""
    for k in range(NTIMED):
        if w.events.crossed[k] > 0:
            return True
    return False
