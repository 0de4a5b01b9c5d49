"""Mode changes at an event: new modes, sliding, and the first-order correction of the state."""

from math import fabs

from lagc.kernels.contact.touching import rates_at
from lagc.kernels.events.late_indicators import indicator_rates_at, indicators_at, late_span
from lagc.kernels.events.location import (
    confirm_crossings,
    estimate_indicator_roundoff,
    increase_slack,
    is_within_slack,
)
from lagc.kernels.events.modes import accept_modes, propagate_changes, sign_of, step_mode, update_edges
from lagc.kernels.events.sliding import (
    SLIDING_RATE,
    find_simultaneous,
    set_sliding_slack,
    slide_together,
    slides,
    time_since_crossing,
    turns_back,
    update_indicator_rates,
)
from lagc.kernels.events.suspects import is_known
from lagc.kernels.language.vocabulary import *

MOST_CHANGES = 20  # at one time, plus two for each relation

CONTACT_MOTION = 64.0  # units in the last place: a smaller motion over the longest step is round-off


def find_contacts(p: Params, s: State, w: Work) -> None:
    """Mark indicators of clauses in w.clauses.in_contact that would move by no more than round-off of the
    states over the longest step: bodies touch that do not approach each other."""
    # Round-off of states as large as they ever were, not as they are.
    for i in range(NQ + NV):
        w.search.x_part_middle[i] = s.sizes[scaling_group[i]]
    estimate_indicator_roundoff(p, s, w.search.x_part_middle, w)
    # How far the indicator moves over the longest step at its present rate, against its round-off: two bodies
    # in contact keep a gap of zero that only round-off moves.
    for j in range(NFREE):
        k = NTIMED + j
        w.clauses.size_roundoff[j] = w.events.roundoff[j]
        distance = fabs(w.events.rates[k]) * s.longest_step
        if NLATE > 0:
            distance = late_span(k, distance, w)
        near = distance <= CONTACT_MOTION * w.events.roundoff[j] and s.longest_step > 0.0
        known = is_known(w.events.enclosures[2 * j], w.events.enclosures[2 * j + 1])
        w.clauses.in_contact[j] = 1 if near and known and clauses_only[k] > 0 and has_edges[k] == 0 else 0


def drop_contacts(p: Params, s: State, w: Work) -> bool:
    """Remove indicators in contact from w.events.crossed, and return whether any crosses."""
    find_contacts(p, s, w)
    # They get slack instead: the next step does not find them again.
    found = False
    for k in range(NMODE):
        if k >= NTIMED and w.events.crossed[k] > 0:
            if w.clauses.in_contact[k - NTIMED] > 0:
                increase_slack(p, s, k, w)
                w.events.crossed[k] = 0
        if w.events.crossed[k] > 0:
            found = True
    return found


def cancel_grazing(p: Params, s: State, direction: Real, w: Work) -> bool:
    """Put back the modes of indicators that touched their crossings and are turned back there by other
    changes of modes. Return whether there are any."""
    # Clauses that act first decide themselves what turns back.
    found = False
    if NWHEN > 0:
        if w.clauses.act_first:
            return False
    # Only changes of other modes can have turned an indicator back. Relations that clauses alone read change
    # no forces.
    others = 0
    for i in range(NMODE):
        others += w.events.crossed[i]
        if NWHEN > 0:
            if clauses_only[i] > 0:  # it turns none back
                others -= w.events.crossed[i]
    for j in range(NFREE):
        # It reaches its crossing together with others and leaves it by its rate in the new modes: it touched.
        k = NTIMED + j
        touches = w.events.crossed[k] > 0 and w.events.jumped[k] == 0 and others > 1
        if NWHEN > 0:
            if clauses_only[k] > 0:
                touches = w.events.crossed[k] > 0 and w.events.jumped[k] == 0 and others > 0
        if touches and turns_back(k, w.events.rates[k], w.events.old_rates[k], direction, w):
            w.modes[k] = s.modes[k]
            w.events.crossed[k] = 0
            others -= 1
            if NWHEN > 0:
                if clauses_only[k] > 0:
                    others += 1
            found = True
    # Its mode is as before, and so are edges and indicators.
    if found:
        update_edges(w)
        indicators_at(p, s.t, s.x, w.modes, w.events.indicators, s, w)
    return found


def is_first_order(time: Real, s: State) -> bool:
    """Return whether a time is so short that a correction to first order is exact within the tolerance."""
    return fabs(time) <= s.first_order_time + EVENT_TIME_ULPS * SPACING * fabs(s.t)


def correct_state(p: Params, s: State, direction: Real, w: Work) -> None:
    """Correct the state to first order for the time since the first crossing, or until it: the rates
    differ before and after it. This residual time of the location is mostly round-off."""
    # Where the rates differ by `apart`, the state is off by (t - t_crossing) apart: the step went on in the
    # old modes for that time.
    for k in range(NMODE):
        if w.events.crossed[k] > 0:
            since = time_since_crossing(k, direction, w)
            if is_first_order(since, s):
                for i in range(NINT):
                    s.x[i] += since * (w.xdot[i] - w.events.old_state_rates[i])
                indicators_at(p, s.t, s.x, w.modes, w.events.indicators, s, w)
            return


def is_chattering(s: State, w: Work) -> bool:
    """Return whether modes change each other without end at one time."""
    # Events at exactly one time; a time that goes on sets the count to zero.
    if s.t != s.t_changed:
        s.t_changed = s.t
        s.changes_at_time = 0
    s.changes_at_time += 1
    for k in range(NMODE):
        if w.events.crossed[k] > 0:
            w.culprit = k
    return s.changes_at_time > MOST_CHANGES + 2 * NMODE


def cross_edge(k: int, s: State, direction: Real, w: Work) -> None:
    """Move a stepwise relation to its next mode. If its indicator moves away from the nearest edge it
    stays, as a repeated step may lead elsewhere; at a second event at the same time it moves."""
    if NEDGES > 0:
        # The direction of motion and the nearer edge agree, or it is a time event, or a second try.
        up = w.events.old_rates[k] * direction > 0.0
        above = (
            w.events.edges[2 * k + 1] - w.events.indicators_before[k]
            < w.events.indicators_before[k] - w.events.edges[2 * k]
        )
        if k < NTIMED or up == above or s.t == s.t_changed:
            step_mode(k, up, w)


def leave_modes(s: State, direction: Real, w: Work) -> None:
    """Change the modes of the relations in w.events.crossed."""
    for i in range(NMODE):
        # A sign changes to the other one. From zero an indicator goes to the side on which it is, or, within
        # its slack, to where it moves.
        if w.events.crossed[i] > 0:
            if has_edges[i] > 0:
                cross_edge(i, s, direction, w)
            elif w.modes[i] == 0.0:
                away = (
                    w.events.old_rates[i] * direction
                    if is_within_slack(i, s, w)
                    else w.events.indicators_before[i]
                )
                w.modes[i] = sign_of(away)
            else:
                w.modes[i] = -w.modes[i]


def holds_back(direction: Real, w: Work) -> int:
    """Return the first relation in w.events.crossed whose indicator is driven back at once, or -1."""
    for j in range(NFREE):
        k = NTIMED + j
        if w.events.crossed[k] > 0 and w.events.jumped[k] == 0:
            if turns_back(k, w.events.rates[k], w.events.old_rates[k], direction, w):
                return k
    return -1


def cross_together(first: int, s: State, direction: Real, w: Work) -> None:
    """Change the modes of indicators of clauses that reach zero at the same time as this one, within the
    error of the step: a condition may be written with another expression of the same speed."""
    # One speed may be written in two relations: those cross together if their times agree within the error of
    # the step.
    if NFREE > 1:
        if find_simultaneous(s, first, direction, w):
            for j in range(NFREE):
                k = NTIMED + j
                if w.events.sliding_candidates[j] > 0 and w.events.crossed[k] == 0 and clauses_only[k] > 0:
                    if w.modes[k] * w.events.old_rates[k] * direction < 0.0:
                        w.modes[k] = -w.modes[k]


def find_clauses_first(p: Params, s: State, direction: Real, w: Work) -> Status:
    """Set w.clauses.act_first: forces drive an indicator back that crosses, and the crossing makes conditions
    of clauses `when` true. The clauses act on the crossing, before the motion is said to slide or chatter."""
    w.clauses.act_first = False
    # Rates in the new modes: does an indicator return at once?
    status = update_indicator_rates(p, s, w)
    if failed(status):
        return status
    first = holds_back(direction, w)
    if first >= 0:
        # If so, would conditions become true with the crossing? The modes are put back if not.
        w.events.candidate_modes[:] = w.modes
        cross_together(first, s, direction, w)
        fn_holds_on(p, s.t, s.x, w.modes, w.clauses.conditions)
        for k in range(NWHEN):
            if w.clauses.conditions[k] > s.conditions[k]:
                w.clauses.act_first = True
        if w.clauses.act_first:
            indicators_at(p, s.t, s.x, w.modes, w.events.indicators, s, w)
        else:
            w.modes[:] = w.events.candidate_modes
    return status


def slide_along(s: State, direction: Real, w: Work) -> None:
    """Set indicators to mode zero that reach zero together with one that begins to slide, and stay there."""
    if NFREE > 1:
        # Each that has begun to slide takes with it those that reach zero at the same time, and whose rates
        # vanish in the new modes.
        for i in range(NFREE):
            first = NTIMED + i
            if w.events.crossed[first] > 0 and w.modes[first] == 0.0 and s.modes[first] != 0.0:
                if find_simultaneous(s, first, direction, w):
                    for j in range(NFREE):
                        k = NTIMED + j
                        least = SLIDING_RATE * fabs(w.events.old_rates[k])
                        if w.events.sliding_candidates[j] > 0 and fabs(w.events.rates[k]) <= least:
                            w.modes[k] = 0.0


def is_driven_back(p: Params, s: State, direction: Real, w: Work) -> bool:
    """Return whether an indicator that crossed is driven back at once and does not slide; sets w.culprit."""
    if NWHEN > 0:
        if w.clauses.act_first:
            return False
    # Each indicator that crossed by itself (not with others): its rate after points back.
    for j in range(NFREE):
        k = NTIMED + j
        rate = w.events.rates[k]
        if (
            w.events.crossed[k] > 0
            and w.events.jumped[k] == 0
            and turns_back(k, rate, w.events.old_rates[k], direction, w)
        ):
            # An indicator leaves its sliding mode only if it does not return.
            left = s.modes[k] == 0.0 and not is_within_slack(k, s, w)
            if left or not slides(p, s, k, rate, w.events.old_rates[k], w):
                w.culprit = k
                return True
    return False


def change_modes(p: Params, s: State, direction: Real, w: Work) -> Status:
    """Change the modes of the relations in w.events.crossed at (s.t, s.x). Returns CHATTERING, with the
    relation as the culprit, if an indicator is driven back on both sides and does not slide."""
    # Rates, indicators and edges before the change: what crosses is confirmed by these.
    if NEDGES > 0:
        for i in range(NEDGES):
            w.events.old_edges[i] = w.events.edges[i]
    s.rhs += 1
    status = rates_at(p, s.t, s.x, w.events.old_state_rates, w.lam, w)
    if failed(status):
        return status
    indicator_rates_at(p, s.t, s.x, w.modes, w.events.old_state_rates, w.events.rates, s, w)
    indicators_at(p, s.t, s.x, w.modes, w.events.indicators_before, s, w)
    w.events.indicators[:] = w.events.indicators_before
    if NFREE > 0:
        if not confirm_crossings(p, s, direction, w):
            return OK
        if NWHEN > 0:
            if not drop_contacts(p, s, w):
                return OK
    # New modes of what crosses, then of what these move; clauses `when` may act before the motion slides.
    w.events.old_rates[:] = w.events.rates
    leave_modes(s, direction, w)
    propagate_changes(p, s, direction, w.events.old_state_rates, w)
    if NWHEN > 0:
        status = find_clauses_first(p, s, direction, w)
        if failed(status):
            return status
    if NFREE > 1:
        if slide_together(p, s, direction, w):
            update_edges(w)
            indicators_at(p, s.t, s.x, w.modes, w.events.indicators, s, w)
    # By the rates in the new modes an indicator goes on, was only touched, slides, or is driven back.
    status = update_indicator_rates(p, s, w)
    if failed(status):
        return status
    if cancel_grazing(p, s, direction, w):
        status = update_indicator_rates(p, s, w)
        if failed(status):
            return status
    if is_driven_back(p, s, direction, w):
        return CHATTERING
    # From here on the change is accepted: marks of what changed, the state corrected to the time of the
    # crossing, slack of each indicator.
    if NWHEN > 0:
        slide_along(s, direction, w)
    for i in range(NMODE):
        s.changed[i] = 1 if w.modes[i] != s.modes[i] else 0
    correct_state(p, s, direction, w)
    accept_modes(s, w)
    set_sliding_slack(s, w)
    if is_chattering(s, w):
        return CHATTERING
    s.changes += 1
    s.after_event = True
    s.rate_place = ABSENT
    return OK
