"""Sliding modes: indicators that stay at zero, as the sliding speed of dry friction that sticks.

The vector fields on both sides of the surface z = 0 point to it (A. F. Filippov, Differential Equations
with Discontinuous Righthand Sides, Kluwer 1988). In mode zero, sign(z) is 0; the indicator slides if its
rate vanishes then. Other sliding motions are refused.
"""

from math import fabs

from lagc.kernels.contact.touching import rates_at
from lagc.kernels.events.late_indicators import indicator_rates_at
from lagc.kernels.events.modes import sign_of
from lagc.kernels.language.vocabulary import *

REVERSED_RATE = 1e-9  # of the rate before: a smaller rate back is round-off
SLIDING_RATE = 1e-12  # of the rates on both sides: a smaller rate in mode zero is round-off


def turns_back(k: int, rate: Real, before: Real, direction: Real, w: Work) -> bool:
    """Return whether an indicator that has crossed returns at once, by its rates after and before."""
    # Ahead is the direction in which it crossed; a rate against it, beyond round-off of the rate before,
    # returns.
    ahead = rate * direction
    if has_edges[k] > 0:
        ahead *= sign_of(before * direction)
    else:
        ahead *= w.modes[k]
    return ahead < -REVERSED_RATE * fabs(before)


def time_since_crossing(k: int, direction: Real, w: Work) -> Real:
    """Return the time since an indicator crossed, by its value and rate in the old modes."""
    target = 0.0
    if NEDGES > 0:
        if has_edges[k] > 0:
            target = (
                w.events.old_edges[2 * k + 1]
                if w.events.old_rates[k] * direction > 0.0
                else w.events.old_edges[2 * k]
            )
    return (
        (w.events.old_indicators[k] - target) / w.events.old_rates[k] if w.events.old_rates[k] != 0.0 else 0.0
    )


def update_indicator_rates(p: Params, s: State, w: Work) -> Status:
    """Compute w.events.rates in the modes w.modes."""
    s.rhs += 1
    status = rates_at(p, s.t, s.x, w.xdot, w.lam, w)
    if not failed(status):
        indicator_rates_at(p, s.t, s.x, w.modes, w.xdot, w.events.rates, s, w)
    return status


def first_crossed(w: Work) -> int:
    """Return the first relation in w.events.crossed."""
    first = 0
    while first < NMODE - 1 and w.events.crossed[first] == 0:
        first += 1
    return first


def find_simultaneous(s: State, first: int, direction: Real, w: Work) -> bool:
    """Mark the indicators that reach zero at the same time as this one, within the error of the step, in
    w.events.sliding_candidates. Return whether there are any."""
    # Crossing times by value and rate in the old modes; equal within the error of the event time.
    when = time_since_crossing(first, direction, w)
    near = s.event_time_error + EVENT_TIME_ULPS * SPACING * fabs(s.t)
    found = False
    for j in range(NFREE):
        k = NTIMED + j
        w.events.sliding_candidates[j] = 0
        if has_edges[k] == 0 and w.events.jumped[k] == 0 and w.events.old_rates[k] != 0.0 and k != first:
            if fabs(time_since_crossing(k, direction, w) - when) <= near:
                w.events.sliding_candidates[j] = 1
                found = True
    return found


def set_sliding(p: Params, s: State, first: int, w: Work) -> bool:
    """Set this indicator, and those candidates whose modes change its rate, to mode zero. Return whether
    any candidates remain."""
    # Each candidate enters the sliding set if its mode changes the rate of the first: else it only happens to
    # be zero at the same time.
    w.modes[first] = 0.0
    if failed(update_indicator_rates(p, s, w)):
        return False
    several = False
    for j in range(NFREE):
        k = NTIMED + j
        if w.events.sliding_candidates[j] > 0:
            mode = w.modes[k]
            rate = w.events.rates[first]
            w.modes[k] = 0.0
            if failed(update_indicator_rates(p, s, w)):
                return False
            if fabs(w.events.rates[first] - rate) > SLIDING_RATE * fabs(w.events.old_rates[first]):
                several = True
            else:
                w.events.sliding_candidates[j] = 0
                w.modes[k] = mode
                w.events.rates[first] = rate
    w.events.sliding_candidates[first - NTIMED] = 1
    return several


def is_sliding_consistent(p: Params, s: State, direction: Real, w: Work) -> bool:
    """Return whether the candidates stay at zero in mode zero, and are driven back to zero beyond it."""
    # In mode zero all rates vanish; with each on the side that it came to, all rates point back (Filippov's
    # condition on each surface).
    there = not failed(update_indicator_rates(p, s, w))
    for j in range(NFREE):
        k = NTIMED + j
        if w.events.sliding_candidates[j] > 0:
            if not fabs(w.events.rates[k]) <= SLIDING_RATE * fabs(w.events.old_rates[k]):
                there = False
            w.modes[k] = sign_of(w.events.old_rates[k] * direction)
    there = there and not failed(update_indicator_rates(p, s, w))
    for j in range(NFREE):
        k = NTIMED + j
        if w.events.sliding_candidates[j] > 0:
            if not turns_back(k, w.events.rates[k], w.events.old_rates[k], direction, w):
                there = False
            w.modes[k] = 0.0
    return there


def slide_together(p: Params, s: State, direction: Real, w: Work) -> bool:
    """Return whether several indicators that reach zero together slide there, as joints with dry friction
    do. They are in mode zero then."""
    if NWHEN > 0:
        if w.clauses.act_first:
            return False
    # Only a crossing of the state by itself may begin to slide, and only with others: one alone is tested in
    # `slides`.
    first = first_crossed(w)
    if (
        first < NTIMED
        or has_edges[first] > 0
        or w.events.jumped[first] > 0
        or w.events.old_rates[first] == 0.0
    ):
        return False
    if not find_simultaneous(s, first, direction, w):
        return False
    # The modes are put back if the set does not slide.
    w.events.candidate_modes[:] = w.modes
    if set_sliding(p, s, first, w) and is_sliding_consistent(p, s, direction, w):
        return True
    w.modes[:] = w.events.candidate_modes
    return False


def slides(p: Params, s: State, k: int, rate: Real, before: Real, w: Work) -> bool:
    """Return whether an indicator stays at zero in mode zero, which is set then."""
    if has_edges[k] > 0:
        return False
    mode = w.modes[k]
    w.modes[k] = 0.0
    if not failed(update_indicator_rates(p, s, w)) and fabs(w.events.rates[k]) <= SLIDING_RATE * (
        fabs(rate) + fabs(before)
    ):
        return True
    w.modes[k] = mode
    return False


def set_sliding_slack(s: State, w: Work) -> None:
    """Give an indicator that begins to slide the slack by which it would move within round-off of the
    time."""
    for j in range(NFREE):
        k = NTIMED + j
        if s.modes[k] == 0.0 and s.changed[k] > 0:
            own = EVENT_TIME_ULPS * SPACING * fabs(s.t * w.events.old_rates[k])
            if own > s.slack[k]:
                s.slack[k] = own
