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
from lagc.kernels.contact.touching import put_on_constraints, rates_at
from lagc.kernels.events.contact_events import pass_event
from lagc.kernels.events.location import next_time_event, update_margins
from lagc.kernels.events.mode_change import MOST_CHANGES
from lagc.kernels.events.modes import update_edges
from lagc.kernels.language.vocabulary import *


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
    and positive until its relation changes; then call lagc_event."""
    hold_modes(s, w)
    s.p[:] = p
    if NCON > 0:
        status = rates_at(p, t, x, w.xdot, w.lam, w)  # finds the forces of contacts
        if failed(status):
            return status
    if NFREE > 0:
        update_margins(p, t, x, s, w)
        z[:] = w.events.margins
    return OK


def find_crossed(p: Params, s: State, ahead: Real, w: Work) -> Status:
    """Set w.events.crossed at (s.t, s.x): relations of time alone that are due, indicators beyond zero, and
    those that move there within the time `ahead`."""
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
        update_margins(p, s.t, s.x, s, w)
        # Two rates of change at one point would need derivatives of the indicators along the motion; one
        # explicit Euler step of length `ahead` instead gives their sign at the cost of one more evaluation.
        before = vector(NFREE)
        before[:] = w.events.margins
        if ahead > 0.0:
            w.search.x_part_end[:] = s.x
            for i in range(NINT):
                w.search.x_part_end[i] += ahead * w.xdot[i]
            if not failed(rates_at(p, s.t + ahead, w.search.x_part_end, w.xdot, w.lam, w)):
                update_margins(p, s.t + ahead, w.search.x_part_end, s, w)
        # Beyond zero already, or falling to it within `ahead`. An indicator below zero after the step, but
        # above its value before, is on its way back. If the rates fail after the step, margins stay `before`.
        for j in range(NFREE):
            falls = w.events.margins[j] < 0.0 and w.events.margins[j] < before[j]
            w.events.crossed[NTIMED + j] = 1 if before[j] < 0.0 or falls else 0
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


@public
def event(p: Params, s: State, t: Real, x: Vec[NX], error: Real, w: Work) -> Status:
    """Handle the events at (t, x), where an integrator of the caller has stopped; x then holds the state
    after them. `error` is that of the time: indicators that fall to zero so soon have crossed. Call it
    first after lagc_begin, and after a jump of parameters or inputs. Returns TERMINATED where a clause
    of the model ends the run."""
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
            status = pass_events(s.p, s, error, w)
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


@public
def project_state(p: Params, s: State, t: Real, x: Vec[NX], w: Work) -> Status:
    """Project x, which an integrator of the caller has moved, onto the constraints and onto the contacts that
    touch."""
    enlarge_sizes(x, s.sizes)
    hold_modes(s, w)
    return put_on_constraints(p, t, x, s.sizes, w)
