"""One step of a trajectory: attempts, events, acceptance.

E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, Springer 1993 (HNW),
section II.4; L. F. Shampine, I. Gladwell, R. W. Brankin, ACM Trans. Math. Software 17 (1991) 11-25 (events).
"""

from math import fabs

from lagc.kernels.call_boundary import evaluate_start, keep_parameters, report_culprit
from lagc.kernels.contact.flight import begin_flight
from lagc.kernels.contact.kept_blocks import keep_blocks, keep_blocks_at_rest
from lagc.kernels.contact.slips import keep_slip_errors, time_to_stop, turns_fast
from lagc.kernels.contact.touching import forget_forces, put_on_constraints, rates_at
from lagc.kernels.events.contact_events import pass_event
from lagc.kernels.events.departures import end_departures, find_departures, leaves_event_unresolved
from lagc.kernels.events.location import (
    LEAST_SLACK,
    MOST_SLACK,
    NO_EVENT,
    crosses_by_roundoff,
    crosses_within_roundoff,
    first_crossing,
    is_time_event_due,
    next_time_event,
    release_slack,
)
from lagc.kernels.events.step_guards import find_hidden_event
from lagc.kernels.integrators.dispatch import (
    end_rate_row,
    has_series,
    is_implicit,
    keeps_constraints,
    method_begin_step,
    method_error,
    method_keep_series,
    method_keep_stages,
    method_stages,
    needs_end_rate,
)
from lagc.kernels.integrators.error_weights import first_step_size, set_error_weights
from lagc.kernels.integrators.roundoff import error_without_roundoff, fade_roundoff
from lagc.kernels.integrators.step_grid import fixed_step_underflows, pass_grid, plan_fixed_step
from lagc.kernels.integrators.step_size import (
    plan_step,
    rational_power,
    set_next_step,
    shrink_step,
    step_underflows,
)
from lagc.kernels.integrators.stiffness import detect_stiffness
from lagc.kernels.language.vocabulary import *

LEAST_REDUCTION = 0.1  # least size, relative to that of a step that hides an event, of the next attempt
MOST_REDUCTIONS = 40  # of one step because of a hidden event
TIME_ERROR = 10.0  # error of an event time, over step size and tolerance
FIRST_ORDER = 0.1  # time that is corrected to first order, over step size and root of the tolerance
SHORT_STEP = 1e6  # size of a step without truncation error, in units in the last place of the time
LEAST_ATTEMPT = 16.0  # least size of a first attempt, in units in the last place of the time
NEWTON_TOLERANCE = 0.03  # error of the stages over that of a step, at most
FIXED_STEP_TOLERANCE = by_type(1e-5, 1e-11, "1e-27")  # relative error of the stages of a fixed step
LOOSENING = 0.1  # tolerance of the estimated error over that of a step at a tolerance of 1
DEPARTURE = 2.0  # of what leaves zero after an event, over that tolerance
LOOSER = 0.1875  # and the power of the tolerance by which that grows
MOST_STOPS = 8  # Newton iterations of the time at which a slip in space stops
LARGE_ERROR = 100.0  # error of a step that says little about the right step size


def finish_step(p: Params, s: State, t: Real, o: Options, leaves_end_rate: bool, w: Work) -> Status:
    """Project the new state onto the constraints and evaluate its rate, unless it is left open."""
    # Projection comes before the rate: the next step begins on the constraints, with a rate that belongs to
    # the projected state. Methods whose stages meet the constraints have nothing to project.
    if NC > 0 or NQUAT > 0 or NCON > 0:
        if o.project and not keeps_constraints(o.method):
            status = put_on_constraints(p, t, s.x_new, w.error.sizes, w)
            if failed(status):
                return status
            if w.position_residual > s.position_drift:
                s.position_drift = w.position_residual
            if w.velocity_residual > s.velocity_drift:
                s.velocity_drift = w.velocity_residual
    w.culprit = not_finite(s.x_new, NX)  # also of states that appear in no equation
    if w.culprit >= 0:
        return NOT_FINITE
    if leaves_end_rate:
        return OK
    s.rhs += 1
    return rates_at(p, t, s.x_new, s.k[end_rate_row(o.method)], w.lam, w)


def loosening(o: Options) -> Real:
    """Return the tolerance of the error that an implicit step estimates, over that of the option."""
    return LOOSENING / rational_power(o.rtol, LOOSER) if o.rtol > 0.0 else 1.0


def prepare_newton(s: State, o: Options, h: Real, w: Work) -> None:
    """Set the weights and the tolerance of the Newton method of an implicit step. The error that it estimates
    is of order 3, and that of its steps of order 5: a power of the tolerance makes that proportional to
    it."""
    # The weights take the larger of both ends of the step; of the new end nothing is known yet.
    s.x_new[:] = s.x
    set_error_weights(s, o, h, w)
    w.newton.loosening = 1.0
    w.newton.tolerance = NEWTON_TOLERANCE
    w.newton.rtol = o.rtol
    w.newton.most = MOST_ITERATED
    # A fixed step has no error to compare with: its stages are solved to round-off, by weights that follow
    # the sizes of the states.
    if o.step > 0.0:
        w.newton.most = MOST_FIXED
        w.newton.rtol = FIXED_STEP_TOLERANCE
        for i in range(NQ + NV):
            w.error.weights[i] = FIXED_STEP_TOLERANCE * w.error.sizes[scaling_group[i]] + TINY
    elif o.rtol > 0.0:
        # RADAU5 does the same with 0.1 rtol^(2/3), and ends iterations at min(0.03, sqrt(rtol)) (E. Hairer,
        # G. Wanner, Solving Ordinary Differential Equations II, 1996, IV.8): the geometric mean of both
        # tolerances, so that the residual of the stages does not spoil the estimate.
        w.newton.loosening = loosening(o)
        w.newton.tolerance = rational_power(o.rtol * w.newton.loosening, 0.5)
        if w.newton.tolerance > NEWTON_TOLERANCE:
            w.newton.tolerance = NEWTON_TOLERANCE


def finish_attempt(p: Params, s: State, o: Options, a: Trial, w: Work) -> Status:
    """Finish an attempt whose error is known, without its round-off."""
    # Is it round-off that rejects the step? One more evaluation tells. It is made when an attempt was
    # rejected already, or round-off decided shortly before: not in each step.
    a.roundoff_estimated = a.error > 1.0 and (
        a.rejected > 0 or s.roundoff_estimated or s.roundoff_memory > 0.0
    )
    if a.roundoff_estimated:
        a.error = error_without_roundoff(p, s, a.t_new, a.h, o, a.error, w)
    if a.error <= 1.0 and not needs_end_rate(o.method):
        return finish_step(p, s, a.t_new, o, a.leaves_end_rate, w)
    return OK


def try_step(p: Params, s: State, o: Options, a: Trial, w: Work) -> Status:
    """Compute stages, error and end of an attempt.  It is acceptable if a.error <= 1."""
    # An error of 0 counts as accepted: fixed steps have no estimate.
    a.error = 0.0
    if NCON > 0:
        forget_forces(w)
    if NNEWTON > 0:
        if is_implicit(o.method):
            prepare_newton(s, o, a.h, w)
    status = method_stages(o.method, p, s.t, s.x, a.h, s, w)
    if failed(status):
        return status
    # Weights of the error need the new state. A method that does not use the rate at its end is tested first,
    # so that a rejected attempt saves the projection and this evaluation.
    set_error_weights(s, o, a.h, w)
    if needs_end_rate(o.method) or o.step > 0.0:
        status = finish_step(p, s, a.t_new, o, a.leaves_end_rate, w)
        if failed(status) or o.step > 0.0:
            return status
    a.error = method_error(o.method, a.h, s, w)
    return finish_attempt(p, s, o, a, w)


def end_step_at_event(p: Params, s: State, o: Options, a: Trial, w: Work) -> Status:
    """If an indicator crosses zero within the step, repeat the step so that it ends at the crossing.  If the
    crossing is at its beginning, handle the event and set a.h to 0."""
    # A state that begins at a crossing may be beyond it by round-off. Its slack shifts the crossing there; it
    # must not hide the next one, so it shrinks as the indicator moves on.
    release_slack(p, s, w)
    factor = LEAST_SLACK
    part = first_crossing(p, s, o.method, a, w)
    # A crossing that round-off of the state explains is no event: its indicator gets twice the slack, and the
    # next crossing is sought.
    while (
        part >= 0.0
        and part < NO_EVENT
        and factor < MOST_SLACK
        and crosses_by_roundoff(p, s, o.method, part, factor, a, w)
    ):
        factor *= 2.0
        part = first_crossing(p, s, o.method, a, w)
    if part < 0.0:
        return NOT_FINITE
    if part > 1.0:
        a.ends_at_event = False
        return OK
    # The step ends at the crossing. It is made again to there (L. F. Shampine, I. Gladwell, R. W. Brankin,
    # 1991): the solution has the order of the method at the event, not that of its dense output.
    a.ends_at_event = True
    a.is_split = False
    a.size_before_event = a.size
    a.size *= part
    a.h *= part
    a.ends_on_target = False
    a.ends_on_grid = False
    a.t_new = s.t + a.h
    w.error.longest_step = s.longest_step
    # An event at the beginning of the step leaves no step to make. It acts at once.
    if fabs(a.h) <= 4.0 * SPACING * fabs(s.t) + LEAST_STEP * a.size_before_event:
        a.h = 0.0
        keep_parameters(p, s)
        return pass_event(p, s, a.direction, w)
    status = try_step(p, s, o, a, w)
    # In space the speed of a slip turns ever faster towards its stop, and the dense output is less accurate
    # than a step. Newton's method finds the time on the ends of steps.
    if NSPACE > 0:
        for count in range(MOST_STOPS):
            if failed(status) or a.error > 1.0:
                break
            change = time_to_stop(p, s, a.t_new, s.k[end_rate_row(o.method)], w)
            if not (fabs(change) > SPACING * fabs(a.t_new) and fabs(change) < 0.5 * fabs(a.h)):
                break
            a.size *= 1.0 + change / a.h
            a.h += change
            a.t_new = s.t + a.h
            status = try_step(p, s, o, a, w)
    return status


def accept_step(p: Params, s: State, t1: Real, o: Options, a: Trial, w: Work) -> None:
    """Make the new state the current one, and set the size of the next step."""
    # On the grid of fixed steps its points are counted; else the controller sets the next size.
    if o.step > 0.0:
        pass_grid(s, t1, a)
    else:
        s.grid.step = 0.0
        set_next_step(s, a, o)
    # From here the last step is this one: its parameters, ends, modes and stages serve dense output until the
    # next step is accepted.
    keep_parameters(p, s)
    if NNEWTON > 0:
        method_keep_stages(o.method, s)
    if NSERIES > 0:
        method_keep_series(o.method, s)
    s.method = o.method
    s.steps += 1
    s.t_old = s.t
    s.h_old = a.h
    s.rate_roundoff[:] = w.error.rate_roundoff
    s.t = a.t_new
    s.x_old[:] = s.x
    s.x[:] = s.x_new
    if o.step == 0.0:
        detect_stiffness(s, w)
    if NLEAP > 0:
        s.x_before_event[:] = s.x_new
    # The largest magnitudes and ranges so far scale errors and round-off.
    enlarge_sizes(s.x_new, s.sizes)
    widen_ranges(s.x_new, s.lowest, s.highest)
    s.roundoff_estimated = a.roundoff_estimated
    # Where the rate at the end is: dense output and the next step look there.
    s.rate_place = ABSENT if a.leaves_end_rate else READY
    s.dense_place = OPEN if a.leaves_end_rate else STAGES
    # Modes of the step, for dense output behind an event that changes them, and the time within which an
    # event is as good as exact.
    if NMODE > 0:
        s.modes_old[:] = w.modes
        if NTWO > 0:
            s.normal_signs_old[:] = w.contacts.normal_signs
        if NSPACE > 0:
            s.slips.axes_old[:] = w.contacts.slip_axes
            s.slips.roundoff_old[:] = w.contacts.slip_roundoff
            keep_slip_errors(s, w)
        if NCON > 0:
            if NNEWTON > 0:
                if is_implicit(o.method):
                    end_departures(s, w)
        s.after_event = False
        s.is_split = a.is_split
        s.event_time_error = TIME_ERROR * o.rtol * fabs(a.h)
        s.first_order_time = FIRST_ORDER * rational_power(o.rtol, 0.5) * fabs(a.h)


def choose_step_size(p: Params, s: State, t1: Real, o: Options, a: Trial, w: Work) -> None:
    """Set the size of the first attempt, which the round-off of the time bounds from below."""
    if s.h == 0.0:
        if o.step > 0.0:
            s.h = o.step
        elif o.first_step > 0.0:
            s.h = o.first_step
        else:
            s.h = first_step_size(p, s, t1, a.direction, o, w)
    # A step below this size would be round-off of the time, whatever the controller says.
    least = LEAST_ATTEMPT * SPACING * fabs(s.t)
    a.size = s.h if s.h > least else least
    if o.max_step > 0.0 and a.size > o.max_step:
        a.size = o.max_step


def begin_step(p: Params, s: State, o: Options, a: Trial, w: Work) -> Status:
    """Let a method with series expand the motion, and set the size of the step."""
    if NSERIES > 0:
        if has_series(o.method):
            s.x_new[:] = s.x
            set_error_weights(s, o, a.size, w)
            return method_begin_step(o.method, p, s, o, a, w)
    return OK


def restarts_short(p: Params, s: State, t1: Real, o: Options, a: Trial, w: Work) -> bool:
    """Choose the step size as at the beginning of a trajectory, if the first step after an event has a large
    error.  Return whether it was reduced."""
    if s.after_event and a.rejected == 0 and a.error > LARGE_ERROR and o.first_step == 0.0:
        size = first_step_size(p, s, t1, a.direction, o, w)
        if size < a.size:
            a.size = size
            return True
    return False


def reduce_step(p: Params, s: State, t1: Real, o: Options, a: Trial, w: Work) -> None:
    """Reduce the step size after an error above 1."""
    if NMODE > 0:
        if restarts_short(p, s, t1, o, a, w):
            return
    shrink_step(a, o)


def is_short(s: State, t1: Real, size: Real) -> bool:
    """Return whether a step of this size has round-off instead of a truncation error."""
    return size <= SHORT_STEP * SPACING * (fabs(s.t) + fabs(t1 - s.t))


def split_step_to(s: State, goal: Real, t1: Real, o: Options, a: Trial) -> None:
    """With the option `halves`, reach a given time by two half steps.  Two runs of different tolerance would
    otherwise have the same last step, and their difference would not show its error."""
    # The last step before `goal` is split unless it is half of one already, or so short that it has no
    # truncation error.
    rest = fabs(goal - s.t)
    if (
        not o.halves
        or o.step > 0.0
        or s.is_split
        or a.is_split
        or 2.0 * a.size < rest
        or is_short(s, t1, rest)
    ):
        return
    a.size = 0.5 * rest
    a.is_split = True
    a.ends_on_target = False
    a.h = a.size * a.direction
    a.t_new = s.t + a.h


def splits_event_step(s: State, t1: Real, o: Options, a: Trial) -> bool:
    """Halve a step that ends at an event, with the option `halves`; return whether it was halved."""
    if (
        not (o.halves and a.ends_at_event and a.error > 0.0 and o.step == 0.0)
        or s.is_split
        or is_short(s, t1, a.size)
    ):
        return False
    a.size *= 0.5
    a.is_split = True
    a.ends_at_event = False
    return True


def update_longest_step(s: State, a: Trial, w: Work) -> None:
    """Update s.longest_step; set w.error.longest_step to it in a repeated or a half step, else to 0."""
    if a.rejected == 0 and a.size > s.longest_step:
        s.longest_step = a.size
    w.error.longest_step = s.longest_step if a.rejected > 0 else 0.0
    if NMODE > 0:
        if a.is_split:
            w.error.longest_step = s.longest_step


def end_by_underflow(p: Params, s: State, cause: Status, a: Trial, w: Work) -> Status:
    """End a step whose size underflowed: by an event that is nearer than round-off, or with the status of the
    last failed attempt."""
    if NFREE > 0:
        if cause != OK and crosses_within_roundoff(p, s, a.direction, w):
            keep_parameters(p, s)
            return report_culprit(s, pass_event(p, s, a.direction, w), w)
    return report_culprit(s, cause if cause != OK else STEP_UNDERFLOW, w)


def plan_attempt(s: State, t1: Real, goal: Real, o: Options, a: Trial) -> None:
    """Plan an attempt towards `goal`: a step of the grid, or one of the size that the error asks for."""
    if o.step > 0.0:
        plan_fixed_step(s, goal, t1, a)
        # A fixed step ends where inputs may change: a model without events leaves the rate there to the
        # next step.
        if not NMODE > 0:
            a.leaves_end_rate = a.ends_on_target
    else:
        plan_step(s, goal, a)
    if NMODE > 0:
        split_step_to(s, goal, t1, o, a)


def plans_attempt(p: Params, s: State, t1: Real, goal: Real, o: Options, a: Trial, w: Work) -> bool:
    """Plan the next attempt towards `goal`; return whether there is one.  Else a.status is that of the
    call."""
    # The limit counts attempts. The size that was reached is kept for the next call.
    if o.max_steps > 0 and s.steps + s.rejected - s.steps_before_call >= o.max_steps:
        if a.rejected > 0:
            s.h = a.size
        a.status = MAX_STEPS
        return False
    plan_attempt(s, t1, goal, o, a)
    update_longest_step(s, a, w)
    if fixed_step_underflows(s, t1, a) if o.step > 0.0 else step_underflows(s, t1, a):
        a.status = end_by_underflow(p, s, a.cause, a, w)
        return False
    return True


def hides_event(p: Params, s: State, status: Status, o: Options, a: Trial, w: Work) -> bool:
    """Return whether something narrow may lie between the stages of an acceptable attempt: the step goes on
    with the part that excludes it."""
    if failed(status) or not a.error <= 1.0 or o.step > 0.0 or a.reductions == MOST_REDUCTIONS:
        return False
    hidden = find_hidden_event(p, s, o.method, a, o.rtol, w)
    if hidden < 1.0:
        a.size *= hidden if hidden > LEAST_REDUCTION else LEAST_REDUCTION
        s.rejected += 1
        a.reductions += 1
        return True
    return False


def accepts_attempt(p: Params, s: State, t1: Real, status: Status, o: Options, a: Trial, w: Work) -> bool:
    """Return whether an attempt is accepted; else reduce the size of the next one."""
    # A failed evaluation may lie beyond what the motion reaches: a quarter of the step is tried. Its status
    # is told if the size underflows; a Newton method that did not converge is none of the model.
    if failed(status):
        a.cause = status if status != NOT_CONVERGED else OK
        a.size *= 0.25
    elif a.error <= 1.0:
        a.is_accepted = True
        return True
    else:
        a.cause = OK
        reduce_step(p, s, t1, o, a, w)
    w.error.rate_roundoff[:] = s.rate_roundoff  # that of a longer step does not count
    a.rejected += 1
    s.rejected += 1
    return False


def find_step(p: Params, s: State, t1: Real, goal: Real, o: Options, a: Trial, w: Work) -> Status:
    """Attempt steps towards `goal` until one is accepted, a.is_accepted, or the call ends."""
    # Each turn is one attempt: plan it, compute it, look for what forbids it (a turning slip, a hidden event,
    # a crossing), accept or reduce. Guards come first: crossings are sought on a true dense output.
    while True:
        if not plans_attempt(p, s, t1, goal, o, a, w):
            return a.status
        status = try_step(p, s, o, a, w)
        # A slip in space that turns within the step is not resolved by it.
        if NSPACE > 0:
            if not failed(status) and a.error <= 1.0 and o.step == 0.0 and turns_fast(s, w):
                a.size *= 0.5
                a.rejected += 1
                s.rejected += 1
                continue
        if NGUARD > 0:
            if hides_event(p, s, status, o, a, w):
                continue
        # A step that contains a crossing is repeated to end there, and may then fail or be rejected.
        if NFREE > 0:
            if not failed(status) and a.error <= 1.0:
                status = end_step_at_event(p, s, o, a, w)
                if status == CHATTERING or a.h == 0.0:
                    return report_culprit(s, status, w)
        if failed(status) and o.step > 0.0:
            return report_culprit(s, status, w)
        if NCON > 0:
            if NNEWTON > 0:
                if not failed(status) and a.error <= 1.0 and leaves_event_unresolved(p, s, o, a, w):
                    continue
        if NMODE > 0:
            if not failed(status) and a.error <= 1.0 and splits_event_step(s, t1, o, a):
                s.rejected += 1
                continue
        if accepts_attempt(p, s, t1, status, o, a, w):
            return OK


def prepare_contacts(p: Params, s: State, o: Options, w: Work) -> None:
    """Prepare the workspace of contacts for the attempts of a step."""
    implicit = False
    if NNEWTON > 0:
        implicit = is_implicit(o.method)
        if implicit:
            find_departures(p, s, DEPARTURE * o.rtol * loosening(o), w)
    keep_blocks(True, w)
    begin_flight(s.x, implicit, w)


def step_once(p: Params, s: State, t1: Real, o: Options, w: Work) -> Status:
    """Make one step towards t1, at most to it, and then exactly."""
    # The dense output of the last step reads stages that this step overwrites.
    if s.dense_place == STAGES or s.dense_place == OPEN:
        s.dense_place = ABSENT  # this step overwrites the stages
    a = Trial()
    a.direction = 1.0 if t1 >= s.t else -1.0
    if o.step > 0.0:
        a.direction = 1.0 if s.grid.step > 0.0 else -1.0
    # Contacts or clauses that act at the beginning are reported as a step of length 0.
    if NLEAP > 0:
        changes = s.changes
    if NCON > 0:
        keep_blocks_at_rest(True, w)
    status = evaluate_start(p, s, a.direction, w)
    if NCON > 0:
        keep_blocks(False, w)
    if failed(status):
        return report_culprit(s, status, w)
    if NLEAP > 0:
        if s.changes > changes:
            keep_parameters(p, s)
            return OK
    choose_step_size(p, s, t1, o, a, w)
    fade_roundoff(s, w)
    # Events of time alone have known times: the step ends there exactly, and needs no search.
    goal = t1
    if NTIMED > 0:
        goal = next_time_event(p, s, t1, a.direction, w)
        # If one is due now, it acts before any step, so that the step begins in its modes.
        if goal == s.t:
            if t1 == s.t and not is_time_event_due(w):
                return OK
            keep_parameters(p, s)
            return report_culprit(s, pass_event(p, s, a.direction, w), w)
    if NSERIES > 0:
        status = begin_step(p, s, o, a, w)
        if failed(status):
            return report_culprit(s, status, w)
    if NCON > 0:
        prepare_contacts(p, s, o, w)
    status = find_step(p, s, t1, goal, o, a, w)
    if NCON > 0:
        keep_blocks(False, w)
    if not a.is_accepted:
        return status
    accept_step(p, s, t1, o, a, w)
    # The step has ended at an event of the state, or at a time event before t1. An event at t1 itself acts in
    # this call if it belongs to a clause; that of a relation is left to the next, which begins there.
    if NMODE > 0:
        due = a.ends_on_target and goal != t1
        if NWHEN > 0:
            if a.ends_on_target and goal == t1 and is_time_event_due(w):
                due = True
        if a.ends_at_event or due:
            return report_culprit(s, pass_event(p, s, a.direction, w), w)
    return OK


def begin_trajectory(p: Params, s: State, direction: Real, o: Options, w: Work) -> Status:
    """Let contacts act at the beginning of a trajectory, before its first state is recorded. Return
    INTERRUPTED after an impact that is to be reported."""
    changes = s.changes
    status = evaluate_start(p, s, direction, w)
    if failed(status):
        return report_culprit(s, status, w)
    keep_parameters(p, s)
    return INTERRUPTED if o.report != 0 and s.changes > changes else OK
