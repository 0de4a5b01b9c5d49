"""Events for an integrator of the caller, which finds the zeros of event indicators itself.

Between events the equations are evaluated in the modes that the last event has left, so that the rates are
smooth. Root finders stop on either side of a zero, or on it: an indicator that reaches zero within the error
of the time counts as crossed.
"""

from math import fabs, inf

from lagc.kernels.call_boundary import (
    enter_call,
    evaluate_start,
    keep_parameters,
    leave_call,
    parameters_changed,
    report_culprit,
)
from lagc.kernels.contact.settle import OPENS
from lagc.kernels.contact.touching import put_on_constraints, rates_at
from lagc.kernels.events.contact_events import pass_event
from lagc.kernels.events.location import (
    SLACK_GROWTH,
    estimate_indicator_roundoff,
    next_time_event,
    update_all_margins,
)
from lagc.kernels.events.mode_change import MOST_CHANGES
from lagc.kernels.events.modes import update_edges
from lagc.kernels.language.vocabulary import *

LEFT_ERROR = 10.0  # times the tolerance: error of the states up to which an indicator has not left zero


@public
def hold_modes(s: State, w: Work) -> None:
    """Evaluate the equations with *w in the modes that the last event of *s has left, from now on. The
    functions below do so too."""
    if NMODE > 0:
        w.modes[:] = s.modes
        w.modes_fixed = True
        update_edges(w)
    if NTWO > 0:
        w.contacts.normal_signs[:] = s.normal_signs
    if NSPACE > 0:
        w.contacts.slip_axes[:] = s.slips.axes
        w.contacts.slip_roundoff[:] = s.slips.roundoff


@public
def indicators(p: Params, s: State, t: Real, x: Vec[NX], z: Vec[NFREE], w: Work) -> Status:
    """z[NFREE]: the event indicators at (t, x) that depend on the state. Each is continuous between events,
    and positive until its relation changes; then call lagc_event, which leaves all of them positive."""
    hold_modes(s, w)
    s.p[:] = p
    if NCON > 0:
        status = rates_at(p, t, x, w.xdot, w.lam, w)  # finds the forces of contacts
        if failed(status):
            return status
    if NFREE > 0:
        update_all_margins(p, t, x, s, w)
        z[:] = w.events.margins
    return OK


def find_ahead(p: Params, s: State, ahead: Real, w: Work) -> Status:
    """Add indicators to w.events.crossed that fall to zero within the time `ahead`, and move the state to
    where the first of them does, to first order. w.xdot and w.events.margins are those of the state."""
    # One explicit Euler step of length `ahead`. An indicator below zero after it, but above its value before,
    # is on its way back.
    before = vector(NFREE)
    before[:] = w.events.margins
    w.search.x_trial[:] = w.xdot
    w.search.x_part_end[:] = s.x
    for i in range(NINT):
        w.search.x_part_end[i] += ahead * w.xdot[i]
    if failed(rates_at(p, s.t + ahead, w.search.x_part_end, w.xdot, w.lam, w)):
        return OK
    update_all_margins(p, s.t + ahead, w.search.x_part_end, s, w)
    time = inf
    for j in range(NFREE):
        if w.events.margins[j] < 0.0 and w.events.margins[j] < before[j]:
            w.events.crossed[NTIMED + j] = 1
            own = ahead * before[j] / (before[j] - w.events.margins[j])
            if own < time:
                time = own
    # A state just behind the first zero, as where lagc's own event location stops.
    if time < inf:
        time += EVENT_TIME_ULPS * SPACING * fabs(s.t)
        for i in range(NINT):
            s.x[i] += time * w.search.x_trial[i]
    return OK


def find_crossed(p: Params, s: State, ahead: Real, w: Work) -> Status:
    """Set w.events.crossed at (s.t, s.x): relations of time alone that are due, and indicators beyond zero;
    if there are none of these, those that get there within the time `ahead`."""
    hold_modes(s, w)
    for k in range(NMODE):
        w.events.crossed[k] = 0
    if NTIMED > 0:
        # next_time_event marks the relations that change first, however late that is: they count only if they
        # are due, up to the error of the caller's time and the round-off of a time.
        due = next_time_event(p, s, inf, 1.0, w)
        if due > s.t + ahead + 8.0 * SPACING * fabs(s.t):
            for k in range(NTIMED):
                w.events.crossed[k] = 0
    if NFREE > 0:
        status = rates_at(p, s.t, s.x, w.xdot, w.lam, w)
        if failed(status):
            return status
        update_all_margins(p, s.t, s.x, s, w)
        found = False
        for j in range(NFREE):
            if w.events.margins[j] < 0.0:
                w.events.crossed[NTIMED + j] = 1
                found = True
        if ahead > 0.0 and not found:
            return find_ahead(p, s, ahead, w)
    return OK


def any_relation_crossed(w: Work) -> bool:
    """Return whether w.events.crossed holds any relation."""
    for k in range(NMODE):
        if w.events.crossed[k] > 0:
            return True
    return False


def pass_events(p: Params, s: State, ahead: Real, w: Work) -> Status:
    """Do what happens at (s.t, s.x), and what that leads to at the same time. Later turns do not look ahead:
    a contact that has just opened may close again there."""
    status = OK
    for turn in range(MOST_CHANGES + 2 * NMODE):
        status = find_crossed(p, s, ahead if turn == 0 else 0.0, w)
        if failed(status) or not any_relation_crossed(w):
            return status
        status = pass_event(p, s, 1.0, w)
        if failed(status):
            return status
    return CHATTERING


def leave_roots(p: Params, s: State, rtol: Real, w: Work) -> Status:
    """Let all indicators be positive after an event, by slack: a root finder would find one at zero again.
    Each is so by what round-off changes it by; the gap of a contact that has opened by what errors of the
    states by `rtol` do, as bodies leave each other slowly."""
    hold_modes(s, w)
    status = rates_at(p, s.t, s.x, w.xdot, w.lam, w)
    if failed(status):
        return status
    if NDISC > 0:
        box_discrete(s, w)
    for i in range(NQ + NV):
        w.search.x_part_middle[i] = s.sizes[scaling_group[i]]
    estimate_indicator_roundoff(p, s, w.search.x_part_middle, w)
    update_all_margins(p, s.t, s.x, s, w)
    for j in range(NFREE):
        least = SLACK_GROWTH * w.events.roundoff[j] + TINY
        if NCON > 0:
            contact = j - (NFREE - NCON)
            if contact >= 0 and s.settlements > 0:
                if s.contact_kinds[contact] == OPENS:
                    least += LEFT_ERROR * rtol / SPACING * w.events.roundoff[j]
        if w.events.margins[j] < least:
            s.slack[NTIMED + j] += least - w.events.margins[j]
    return OK


@public
def event(p: Params, s: State, t: Real, x: Vec[NX], time_error: Real, rtol: Real, w: Work) -> Status:
    """Handle the events at (t, x), where an integrator of the caller has stopped; x then holds the state
    after them. Indicators that fall to zero within `time_error` have crossed. `rtol`: the relative error of
    the states, by which a contact that has just opened may touch. Call it first after lagc_begin, and after
    a jump of parameters or inputs. Returns TERMINATED where a clause of the model ends the run."""
    # The motion reaches its events with the parameters of the last call of lagc_indicators; these jump then.
    enter_call(s, w)
    status = OK
    jumps = not s.parameters_known or parameters_changed(p, s)
    enlarge_sizes(x, s.sizes)
    widen_ranges(x, s.lowest, s.highest)
    if s.parameters_known:
        s.t = t
        s.x[:] = x
        if NDISC > 0:
            box_discrete(s, w)
        if NMODE > 0:
            status = pass_events(s.p, s, time_error, w)
        s.t_end = t
        s.x_end[:] = s.x
    s.rate_place = ABSENT
    if jumps and not failed(status):
        status = evaluate_start(p, s, 1.0, w)
        if NMODE > 0:
            if not failed(status):
                status = pass_events(p, s, 0.0, w)
    keep_parameters(p, s)
    if NC > 0 or NQUAT > 0 or NCON > 0:
        if not failed(status) or status == TERMINATED:
            hold_modes(s, w)
            corrected = put_on_constraints(p, s.t, s.x, s.sizes, w)
            if failed(corrected):
                status = corrected
    if NFREE > 0:
        if not failed(status):
            status = leave_roots(p, s, rtol, w)
    status = leave_call(s, report_culprit(s, status, w), w)
    x[:] = s.x
    hold_modes(s, w)
    return status


@public
def next_event(p: Params, s: State, w: Work) -> Real:
    """Return the time of the next change of a relation of time alone, as after lagc_event; infinity if there
    is none."""
    hold_modes(s, w)
    if NTIMED > 0:
        return next_time_event(p, s, inf, 1.0, w)
    return inf


def release_roots(p: Params, s: State, t: Real, x: Vec[NX], w: Work) -> None:
    """Set the slack of indicators to 0 that are several times as large, but of no contact that touches."""
    update_all_margins(p, t, x, s, w)
    for j in range(NFREE):
        k = NTIMED + j
        touches = False
        if NCON > 0:
            if k >= NMODE - NCON:
                touches = x[NX - NMODE + k] != 0.0
            elif k >= NMODE - NCON - NSLIP:
                touches = True
        if w.events.margins[j] > (1.0 + SLACK_GROWTH) * s.slack[k] and not touches:
            s.slack[k] = 0.0


@public
def project_state(p: Params, s: State, t: Real, x: Vec[NX], w: Work) -> Status:
    """Project x onto the constraints and onto the contacts that touch, after a step of an integrator of the
    caller."""
    enlarge_sizes(x, s.sizes)
    hold_modes(s, w)
    status = put_on_constraints(p, t, x, s.sizes, w)
    if NFREE > 0:
        if not failed(status):
            release_roots(p, s, t, x, w)
    return status
