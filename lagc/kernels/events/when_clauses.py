"""Clauses `when`: actions at the time at which a condition becomes true.

Clauses that are triggered at the same time act in their order, each on the state that the one before has
left. Conditions that this makes true trigger more clauses.
"""

from math import fabs, inf

from lagc.kernels.constraints.projection import project
from lagc.kernels.contact.settle import settle_jump
from lagc.kernels.contact.touching import rates_at
from lagc.kernels.events.late_indicators import indicator_rates_at, indicators_at, set_late_modes
from lagc.kernels.events.location import SLACK_GROWTH, estimate_indicator_roundoff
from lagc.kernels.events.mode_change import change_modes, find_contacts, is_first_order
from lagc.kernels.events.modes import accept_modes, adopt_modes, advance_mode, choose_modes, update_edges
from lagc.kernels.events.sliding import slides, time_since_crossing, turns_back
from lagc.kernels.language.vocabulary import *

MOST_GROWTH_AFTER_EVENT = 1e5  # longest next step, over the time between the last two crossings
MOST_SHORT_BOUNCES = 200  # in a row, lower than round-off of the sizes of states
MOST_PROJECTION = 1e-6  # of the sizes of states: a larger change of new values by projection is an error


def update_conditions(p: Params, s: State, w: Work) -> bool:
    """Evaluate the conditions; return whether some have become true, w.clauses.triggered."""
    found = False
    # Edge-triggered: a condition acts when it becomes true, not while it is.
    fn_holds_on(p, s.t, s.x, w.modes, w.clauses.conditions)
    for k in range(NWHEN):
        w.clauses.triggered[k] = 1 if w.clauses.conditions[k] > s.conditions[k] else 0
        s.conditions[k] = w.clauses.conditions[k]
        if w.clauses.triggered[k] > 0:
            found = True
    return found


def last_reinit_clause(w: Work) -> int:
    """Return the last clause in w.clauses.triggered that assigns values to states, or -1."""
    found = -1
    for j in range(NJUMP):
        if w.clauses.triggered[reinit_clause[j]] > 0:
            found = reinit_clause[j]
    return found


def apply_reinit(p: Params, s: State, k: int, w: Work) -> bool:
    """Assign the new values of clause k; return whether there are any."""
    found = False
    # All new values of a clause are computed from the state before any is assigned.
    fn_reinit(p, s.t, s.x, w.clauses.reinit_values)
    for j in range(NJUMP):
        if reinit_clause[j] == k:
            s.x[reinit_target[j]] = w.clauses.reinit_values[j]
            found = True
    if NDISC > 0:
        box_discrete(s, w)
    return found


def meets_constraints(p: Params, s: State, w: Work) -> bool:
    """Project the new values onto the constraints; return whether that changes them by no more than
    round-off. Speeds without inertia follow the constraints: by the metric of the mass matrix they move
    alone."""

    w.clauses.x_reinit[:] = s.x
    if failed(project(p, s.t, s.x, s.sizes, w)):
        return False
    for i in range(NQ + NV):
        free = False
        if NMASSLESS > 0:
            free = massless[i] == 1
        if (
            not free
            and not fabs(s.x[i] - w.clauses.x_reinit[i]) <= MOST_PROJECTION * s.sizes[scaling_group[i]]
        ):
            return False
    return True


def slide_after_reinit(p: Params, s: State, direction: Real, w: Work) -> Status:
    """Set indicators to mode zero that new values leave at zero, to which both sides drive them back."""
    # After a jump an indicator may be exactly at zero, where both sides drive it back.
    indicator_rates_at(p, s.t, s.x, w.modes, w.xdot, w.events.rates, s, w)
    found = False
    for j in range(NFREE):
        k = NTIMED + j
        at_zero = has_edges[k] == 0 and fabs(w.events.indicators[k]) <= SLACK_GROWTH * w.events.roundoff[j]
        if at_zero and (w.events.crossed[k] > 0 or w.events.jumped[k] > 0):
            rate = w.events.rates[k]
            if NCON > 0:
                if k >= NMODE - NCON - NSLIP:
                    continue
            if w.modes[k] * rate * direction < 0.0:
                found = True
                slides(p, s, k, rate, w.events.old_rates[k], w)
    if not found:
        return OK
    s.rhs += 1
    return rates_at(p, s.t, s.x, w.xdot, w.lam, w)


def choose_modes_after_reinit(p: Params, s: State, direction: Real, w: Work) -> Status:
    """Find the modes of a state that has jumped, and its rates w.xdot. w.events.indicators_before are the
    indicators before the jump."""
    # The old values tell which indicators jumped, and how far a crossing that led here is behind.
    w.events.old_indicators[:] = w.events.indicators_before
    adopt_modes(p, s, w)
    status = rates_at(p, s.t, s.x, w.xdot, w.lam, w)
    s.rhs += 1
    if failed(status):
        return status
    indicators_at(p, s.t, s.x, w.modes, w.events.indicators, s, w)
    indicator_rates_at(p, s.t, s.x, w.modes, w.xdot, w.events.rates, s, w)
    # Time relations do not jump with the state; those that others moved are advanced by their rates.
    for i in range(NTIMED):
        if w.events.jumped[i] > 0:
            advance_mode(i, direction, 0.0, w, s.t)
    # Relations of the state: where new values put one at its crossing, within round-off, its rate tells the
    # mode. The crossing that triggered a clause goes through if no clause has set its indicator anew; in
    # contact it stays at zero.
    if NFREE > 0:
        find_contacts(p, s, w)
        estimate_indicator_roundoff(p, s, s.x, w)
        for j in range(NFREE):
            k = NTIMED + j
            if NCON > 0:
                if k >= NMODE - NCON - NSLIP:  # the modes of contacts are in the state
                    continue
            if w.events.jumped[k] > 0:
                w.clauses.indicator_reset[j] = 1
            beyond = w.events.crossed[k] > 0 and w.clauses.indicator_reset[j] == 0 and has_edges[k] == 0
            if w.clauses.in_contact[j] == 0:
                advance_mode(k, direction, inf if beyond else SLACK_GROWTH * w.events.roundoff[j], w, s.t)
            elif beyond:
                w.modes[k] = 0.0
    # The rates of these modes, in which the next clause acts or the motion goes on.
    update_edges(w)
    status = rates_at(p, s.t, s.x, w.xdot, w.lam, w)
    s.rhs += 1
    if NFREE > 0:
        if not failed(status):
            status = slide_after_reinit(p, s, direction, w)
    return status


def extrapolate_state(s: State, time: Real, w: Work) -> None:
    """Move the state by `time` with the rates w.xdot."""
    if time != 0.0:
        for i in range(NINT):
            s.x[i] += time * w.xdot[i]


def reset_conditions(p: Params, s: State, direction: Real, w: Work) -> Status:
    """Between two clauses of one event: mark conditions that are no longer true, as the next clause may
    make them true again."""
    status = choose_modes_after_reinit(p, s, direction, w)
    if not failed(status):
        fn_holds_on(p, s.t, s.x, w.modes, w.clauses.conditions)
        for k in range(NWHEN):
            if w.clauses.conditions[k] < s.conditions[k]:
                s.conditions[k] = w.clauses.conditions[k]
    return status


def reinitialize(p: Params, s: State, giver: int, direction: Real, w: Work) -> Status:
    """Assign the new values of the clauses in w.clauses.triggered up to `giver`, the last one that has any.
    The work integral gains the change of the energy."""
    # Indicators before the jump; the energy before it, for the work integral.
    indicators_at(p, s.t, s.x, w.modes, w.events.indicators_before, s, w)
    if NZ > 0:
        fn_energies(p, s.t, s.x, w.clauses.energies)
        before = w.clauses.energies[2]
    # Clauses act in the order of the text, each on the values that those before it gave.
    given = 0
    for k in range(giver + 1):
        if w.clauses.triggered[k] > 0 and apply_reinit(p, s, k, w):
            given += 1
            if not_finite(s.x, NX) >= 0:
                w.culprit = k
                return MISPLACED
            if k < giver:
                status = reset_conditions(p, s, direction, w)
                if failed(status):
                    return status
    # Consistency is checked once, after all clauses: the first of two assignments alone may violate a
    # constraint.
    enlarge_sizes(s.x, s.sizes)
    widen_ranges(s.x, s.lowest, s.highest)
    if NC > 0 or NQUAT > 0:
        if not meets_constraints(p, s, w):
            w.culprit = giver
            return MISPLACED
    if NZ > 0:
        fn_energies(p, s.t, s.x, w.clauses.energies)
        s.x[NINT - 1] += w.clauses.energies[2] - before
    # Contacts act on the new values before the modes of relations are known.
    if NCON > 0:
        status = settle_jump(p, s, w)
        if failed(status):
            return status
    status = choose_modes_after_reinit(p, s, direction, w)
    if not failed(status):
        s.jumps += given
    return status


def has_left_crossing(p: Params, s: State, direction: Real, w: Work) -> bool:
    """Return whether the indicators in w.events.crossed enter their new modes, and were elsewhere since their
    last crossing. An indicator that returns within round-off of time or state, as in ever shorter bounces,
    has not left it; nor has one that returns within round-off of the sizes of states without end."""
    is_low = False
    # A crossing that returns within round-off of time or state since its last one has not left it: a sequence
    # of ever shorter bounces ends here.
    if NFREE > 0:
        estimate_indicator_roundoff(p, s, s.x, w)
        for j in range(NFREE):
            k = NTIMED + j
            if w.events.crossed[k] > 0 and w.events.jumped[k] == 0:
                distance = fabs(w.events.old_rates[k]) * fabs(s.t - s.crossing_times[j])
                if distance <= SLACK_GROWTH * w.clauses.size_roundoff[j]:
                    is_low = True
                if distance <= SLACK_GROWTH * w.events.roundoff[j] or turns_back(
                    k, w.events.old_rates[k], w.events.old_rates[k], direction, w
                ):
                    return False
    # Low bounces are counted in a row; a higher one starts anew.
    s.short_bounces = s.short_bounces + 1 if is_low else 0
    return s.short_bounces <= MOST_SHORT_BOUNCES


def report_chattering(w: Work) -> Status:
    """Return CHATTERING, with the last clause in w.clauses.triggered as the culprit."""
    for k in range(NWHEN):
        if w.clauses.triggered[k] > 0:
            w.culprit = NMODE + k
    return CHATTERING


def act_in_order(p: Params, s: State, direction: Real, since: Real, w: Work) -> Status:
    """Let the clauses act whose conditions become true, and then those that they trigger. Before the first
    new values the state goes back by `since`, the time since the crossing, and w.clauses.at_event_time is
    set."""
    ended = OK
    # New values may make other conditions true, which trigger their clauses in the next round.
    while update_conditions(p, s, w):
        # Only the first round has a crossing that led to it; rounds that clauses trigger have none.
        if s.acts == 0 and not has_left_crossing(p, s, direction, w):
            return report_chattering(w)
        # Each clause that acts is recorded, up to a limit: clauses that trigger each other without end are an
        # error of the model.
        for k in range(NWHEN):
            if w.clauses.triggered[k] > 0:
                if s.acts == NACTS:
                    return report_chattering(w)
                s.acted[s.acts] = k
                s.acts += 1
                if terminates[k] > 0 and ended == OK:
                    s.culprit = k
                    ended = TERMINATED
        # New values belong to the time of the crossing, which is slightly before s.t: the state goes back by
        # first order, once.
        if NJUMP > 0:
            giver = last_reinit_clause(w)
            if giver >= 0:
                if not w.clauses.at_event_time:
                    w.clauses.at_event_time = True
                    extrapolate_state(s, -since, w)
                    s.t -= since
                status = reinitialize(p, s, giver, direction, w)
                if failed(status):
                    return status
    return ended


def act_on_conditions(p: Params, s: State, direction: Real, since: Real, w: Work) -> Status:
    """Let the clauses act whose conditions became true `since` before (s.t, s.x). They act on the state of
    that time, which then moves on to s.t. Rates are in w.xdot."""
    # Clauses see no indicator set, no act and the time of the event, before the first of them acts.
    for j in range(NFREE):
        w.clauses.indicator_reset[j] = 0
    s.acts = 0
    now = s.t
    w.clauses.at_event_time = False
    status = act_in_order(p, s, direction, since, w)
    s.t = now
    # The state that clauses left moves on from the time of the crossing to s.t, by the rates after it, so
    # that time never runs backwards.
    if w.clauses.at_event_time and (status == TERMINATED or not failed(status)):
        extrapolate_state(s, since, w)
        indicators_at(p, s.t, s.x, w.modes, w.events.indicators, s, w)
        accept_modes(s, w)
        s.rate_place = ABSENT
    return status


def event_delay(s: State, direction: Real, w: Work) -> Real:
    """Return the time since the first crossing in w.events.crossed, or 0 if it is more than round-off."""
    for k in range(NMODE):
        if w.events.crossed[k] > 0:
            since = time_since_crossing(k, direction, w)
            return since if is_first_order(since, s) else 0.0
    return 0.0


def save_state(s: State, w: Work) -> None:
    """Save what clauses may change."""
    w.clauses.x_saved[:] = s.x
    w.clauses.conditions_saved[:] = s.conditions
    w.clauses.modes_saved[:] = s.modes
    w.clauses.slack_saved[:] = s.slack


def restore_state(s: State, w: Work) -> None:
    """Restore the saved state: actions that fail are not done at all, and another call tries them again."""
    s.x[:] = w.clauses.x_saved
    s.conditions[:] = w.clauses.conditions_saved
    s.modes[:] = w.clauses.modes_saved
    s.slack[:] = w.clauses.slack_saved


def record_crossing_times(s: State, w: Work) -> None:
    """Store the times of the crossings. For crossings that follow ever faster, such as bounces, limit the
    next step to a multiple of the time between the last two."""
    for j in range(NFREE):
        # A factor of 1e5 per bounce still lets the step grow again after few crossings.
        if w.events.crossed[NTIMED + j] > 0:
            since = fabs(s.t - s.crossing_times[j])
            if since > 0.0 and s.h > MOST_GROWTH_AFTER_EVENT * since:
                s.h = MOST_GROWTH_AFTER_EVENT * since
            s.crossing_times[j] = s.t


def handle_event(p: Params, s: State, direction: Real, w: Work) -> Status:
    """Change the modes of the relations in w.events.crossed at (s.t, s.x), then let clauses `when` act."""
    # A failed event leaves the state as it was before it: the caller may mend what failed, and go on.
    if NWHEN > 0:
        save_state(s, w)
    status = change_modes(p, s, direction, w)
    if NWHEN > 0:
        if status == OK:
            status = act_on_conditions(p, s, direction, event_delay(s, direction, w), w)
            if failed(status) and status != TERMINATED:
                restore_state(s, w)
            else:
                record_crossing_times(s, w)
    return status


def update_modes_for_parameters(p: Params, s: State, direction: Real, w: Work) -> Status:
    """Find the modes of an unchanged state after a change of parameters or inputs: indicators that this
    moves get the modes of their values."""
    # Indicators with the old parameters against those with the new: only what the caller moved changes its
    # mode.
    w.modes[:] = s.modes
    update_edges(w)
    indicators_at(s.p, s.t, s.x, w.modes, w.events.indicators_before, s, w)
    w.events.old_indicators[:] = w.events.indicators_before
    adopt_modes(p, s, w)
    s.rhs += 1
    status = rates_at(p, s.t, s.x, s.k[0], w.lam, w)
    if failed(status):
        return status
    indicators_at(p, s.t, s.x, w.modes, w.events.indicators, s, w)
    accept_modes(s, w)
    return status


def start_modes(p: Params, s: State, direction: Real, elsewhere: bool, w: Work) -> Status:
    """Find the modes at the beginning of a call, and let clauses act there. `elsewhere`: the caller changed
    the state. Conditions that are true at the beginning of a trajectory do not trigger."""
    # Before the first step conditions have no past: those that are true then do not act.
    if NWHEN > 0:
        if not s.conditions_known:
            fn_modes(p, s.t, s.x, w.modes)
            if NLATE > 0:
                set_late_modes(p, s.t, s.x, s, w)
            update_edges(w)
            fn_holds_on(p, s.t, s.x, w.modes, s.conditions)
            s.conditions_known = True
            for j in range(NFREE):
                s.crossing_times[j] = -inf
        # Later calls compare with the conditions before: what the caller changed may trigger clauses.
        save_state(s, w)
        if elsewhere:
            status = choose_modes(p, s, direction, w)
        else:
            status = update_modes_for_parameters(p, s, direction, w)
        if status != OK:
            return status
        # Nothing crosses at a start: clauses act by what the caller changed.
        for k in range(NMODE):
            w.events.crossed[k] = 0
        w.xdot[:] = s.k[0]
        status = act_on_conditions(p, s, direction, 0.0, w)
        if failed(status) and status != TERMINATED:
            restore_state(s, w)
            return status
        # An act at the start is an event of the trajectory.
        if s.acts > 0:
            for i in range(NMODE):
                s.changed[i] = 0
            s.after_event = True
            s.changes += 1
        return status
    return choose_modes(p, s, direction, w)
