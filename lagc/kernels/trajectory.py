"""Trajectories: dense output, and integration to one time or to many."""

from typing import Any

from lagc.kernels.arguments import check_call
from lagc.kernels.call_boundary import enter_call, leave_call, report_culprit
from lagc.kernels.contact.touching import put_on_constraints, rates_at
from lagc.kernels.driver import begin_trajectory, step_once
from lagc.kernels.integrators.dispatch import (
    end_rate_row,
    has_series,
    method_dense_at,
    method_dense_output,
    method_restore_series,
    method_restore_stages,
    method_stages,
)
from lagc.kernels.integrators.step_grid import begin_grid, is_reached
from lagc.kernels.language.vocabulary import *

OUTSIDE_STEP = by_type(1e-5, 1e-9, "1e-9")  # of a step: times that are outside by less count as inside


def recompute_stages(s: State, t: Real, x: Vec[NX], w: Work) -> Status:
    """Compute the stages of the last step again: a later failed attempt has overwritten them."""
    # The step had other modes than the state that it led to, if it ended at an event.
    if NMODE > 0:
        w.modes[:] = s.modes_old
        if NTWO > 0:
            w.contacts.normal_signs[:] = s.normal_signs_old
        if NSPACE > 0:
            w.contacts.slip_axes[:] = s.slips.axes_old
            w.contacts.slip_roundoff[:] = s.slips.roundoff_old
    # The same arithmetic gives the same stages. The rate at s.t, which shares their storage, is lost.
    status = rates_at(s.p, s.t_old, s.x_old, s.k[0], w.lam, w)
    s.rate_place = ABSENT
    s.rhs += 2
    if not failed(status):
        status = method_stages(s.method, s.p, s.t_old, s.x_old, s.h_old, s, w)
    if not failed(status):
        status = rates_at(s.p, t, x, s.k[end_rate_row(s.method)], w.lam, w)
    return status


def compute_dense_output(s: State, w: Work) -> Status:
    """Compute the coefficients of the dense output of the last step, with its parameters and its end, even
    if the caller changed them."""
    # The polynomial ends where the step ended: before changes by the caller, and before the jump of an event.
    t = s.t_end if s.is_new_call else s.t
    if NLEAP > 0:
        x = s.x_before_event
    else:
        x = s.x_end if s.is_new_call else s.x
    # Indicators, signs and slip axes within the step are those that the step was made with.
    if NMODE > 0:
        w.modes[:] = s.modes_old
        if NTWO > 0:
            w.contacts.normal_signs[:] = s.normal_signs_old
        if NSPACE > 0:
            w.contacts.slip_axes[:] = s.slips.axes_old
            w.contacts.slip_roundoff[:] = s.slips.roundoff_old
    # Implicit stages and coefficients of series were kept apart from the workspace, so that they need no
    # evaluation.
    if NNEWTON > 0:
        if s.newton.kept_step == s.steps:
            method_restore_stages(s.method, s)
            return method_dense_output(s.method, s.p, s.t_old, s.x_old, x, s.h_old, s, w)
    if NSERIES > 0:
        if has_series(s.method):
            status = method_restore_series(s.method, s, w)
            if failed(status):
                return status
            return method_dense_output(s.method, s.p, s.t_old, s.x_old, x, s.h_old, s, w)
    # Explicit stages are in s.k until a further attempt overwrites them; an end rate that was left open
    # (inputs might have changed there) is evaluated first.
    if s.dense_place == ABSENT:
        status = recompute_stages(s, t, x, w)
        if failed(status):
            return status
    elif s.dense_place == OPEN:
        status = rates_at(s.p, t, x, s.k[end_rate_row(s.method)], w.lam, w)
        s.rhs += 1
        if failed(status):
            return status
        s.rate_place = READY
    return method_dense_output(s.method, s.p, s.t_old, s.x_old, x, s.h_old, s, w)


def interpolate_at(s: State, t: Real, o: Options, x: Vec[NX], w: Work) -> Status:
    """Evaluate the last step at t, and project the result onto the constraints."""
    if t == s.t or s.h_old == 0.0:
        x[:] = s.x
        return OK
    if s.dense_place != READY:
        status = compute_dense_output(s, w)
        if failed(status):
            return report_culprit(s, status, w)
        s.dense_place = READY
    method_dense_at(s.method, (t - s.t_old) / s.h_old, s, x)
    if NC > 0 or NQUAT > 0 or NCON > 0:
        if o.project:
            if NCON > 0:
                w.modes[:] = s.modes_old
            status = put_on_constraints(s.p, t, x, s.sizes, w)
            if failed(status):
                return report_culprit(s, status, w)
    return OK


def is_in_last_step(s: State, t: Real) -> bool:
    """Return whether t is a time of the last step, within round-off."""
    if t == s.t:
        return True
    if s.h_old == 0.0:
        return False
    part = (t - s.t_old) / s.h_old
    return part >= -OUTSIDE_STEP and part <= 1.0 + OUTSIDE_STEP


@public
def dense(p: Params, s: State, t: Real, o: Options, x: Vec[NX], w: Work) -> Status:
    """Evaluate the dense output: x[NX] at a time t within the last step, with the parameters of that step.
    INVALID for any other time. Uses only the option `project`. After a failure x has no meaning."""
    if not is_in_last_step(s, t):
        s.culprit = BAD_TIME
        return INVALID
    enter_call(s, w)
    status = interpolate_at(s, t, o, x, w)
    if status == OK and not_finite(x, NX) >= 0:
        s.culprit = not_finite(x, NX)
        status = NOT_FINITE
    if NC > 0:
        s.rank_deficient = w.rank_deficient
    if NMODE > 0:
        w.modes_fixed = False
    return status


# step, advance and record check options, times, parameters and the state once, before anything else.  If
# that fails, they return INVALID or NOT_FINITE (s->culprit tells which value) and do not change *s.  After
# any other failure, *s is at the end of the last accepted step, and another call continues from there.
#
# Between two of these calls the caller may change *p (parameters, then lagc_bind, or inputs), options, s->t
# and s->x.  The next step begins with these values, with the step size found before; it costs one more
# evaluation if p, t or x changed.  If nothing changed, several calls to the same t1 give the same motion as
# one.


@public
def step(p: Params, s: State, t1: Real, o: Options, w: Work) -> Status:
    """Make one step towards t1, which may be before or after s->t. The step does not pass t1."""
    status = check_call(p, s, t1, o)
    if status != OK:
        return status
    if o.step > 0.0:
        begin_grid(s, t1, o)
    enter_call(s, w)
    return leave_call(s, step_once(p, s, t1, o, w), w)


@public
def advance(p: Params, s: State, t1: Real, o: Options, w: Work) -> Status:
    """Integrate to t1 exactly, with error control and projection onto the constraints. A step that is
    shortened to end at t1 does not shorten the next one. Fixed steps are counted: a call that ends within
    round-off of a step ends with it, and calls of the same length make the same number of steps."""
    status = check_call(p, s, t1, o)
    if status != OK:
        return status
    if o.step > 0.0:
        begin_grid(s, t1, o)
        if s.grid.goal > s.grid.index:
            s.grid.stride = s.grid.goal - s.grid.index
    enter_call(s, w)
    while status == OK and not is_reached(s, t1, o):
        status = step_once(p, s, t1, o, w)
        if NMODE > 0:
            if status == OK and o.report != 0 and s.after_event:
                status = INTERRUPTED
    return leave_call(s, status, w)


def are_in_order(s: State, times: Vec[Any], n: Length, direction: Real) -> bool:
    """Return whether all times are in order from s.t on. Called once for each grid of times."""
    before = s.t
    for k in range(n):
        if not (times[k] - before) * direction >= 0.0:
            return False
        before = times[k]
    return True


def resumes_in_order(times: Vec[Any], n: Length, done: Length, direction: Real) -> bool:
    """Return whether the next of the times is in order, for a grid that was checked before."""
    if done == n:
        return True
    there = times[done]
    return (there - times[done - 1]) * direction >= 0.0 and (times[n - 1] - there) * direction >= 0.0


def check_record(p: Params, s: State, o: Options, times: Vec[Any], n: Length, done: Cell[Length],
                 budget: Count, t1: Real, direction: Real) -> Status:  # fmt: skip
    """Check the arguments of `record`; returns OK, INVALID or NOT_FINITE, with s.culprit."""
    status = check_call(p, s, t1, o)
    if status != OK:
        return status
    if budget < 0:
        s.culprit = BAD_BUDGET
        return INVALID
    # Of a grid that was checked in an earlier call only the next time is looked at: to check it whole each
    # time would cost n^2.
    known = done[0] > 0 and done[0] <= n and resumes_in_order(times, n, done[0], direction)
    if not known and (done[0] > 0 or not are_in_order(s, times, n, direction)):
        s.culprit = BAD_TIME
        return INVALID
    return OK


@public
def record(p: Params, s: State, o: Options, times: Vec[Any], n: Length, states: Rows[NX], done: Cell[Length],
           budget: Count, w: Work) -> Status:  # fmt: skip
    """Integrate to times[n-1] and write the states at times[0..n-1] to states[n*NX]; *done counts those
    that are written, and is 0 in the first call. The times are in order from s->t on, forwards or
    backwards. After `budget` steps (0: no limit) it returns INTERRUPTED: call again to continue. If n is
    0, times and states may be NULL."""
    # The direction of times follows from their end; a grid of one time, that of the state, has the direction
    # of the last step.
    t1 = times[n - 1] if n > 0 else s.t
    direction = 1.0 if t1 > s.t or (t1 == s.t and s.t >= s.t_old) else -1.0
    # All arguments are checked before anything changes.
    status = check_record(p, s, o, times, n, done, budget, t1, direction)
    if status != OK:
        return status
    if o.step > 0.0:
        begin_grid(s, t1, o)
    enter_call(s, w)
    # Contacts act before the first state is recorded, so that this one is consistent.
    count: Count = 0
    if NCON > 0:
        if done[0] == 0 and n > 0:
            status = begin_trajectory(p, s, direction, o, w)
    if NMODE > 0:
        ended = OK
    while status == OK:
        # Each turn writes the times that the last step has passed, then makes a step. An event changes s.x,
        # but times before it are interpolated on the step that led there.
        while status == OK and done[0] < n and (times[done[0]] - s.t) * direction <= 0.0:
            status = interpolate_at(s, times[done[0]], o, states[done[0]], w)
            if status == OK:
                done[0] += 1
        if NMODE > 0:
            if status == OK:
                # A step that failed or was interrupted has ended on an accepted state: the loop first writes
                # the times up to that.
                status = ended
        if status != OK or done[0] == n:
            break
        if s.t == t1:  # the next time is not in order
            s.culprit = BAD_TIME
            status = INVALID
            break
        if budget > 0 and count == budget:
            status = INTERRUPTED
        else:
            status = step_once(p, s, t1, o, w)
            # The budget counts turns, so that a caller gets back control (for a signal, or a limit of time)
            # within a known number of steps.
            if NMODE > 0:
                if status == OK and o.report != 0 and s.after_event:
                    status = INTERRUPTED
                if status != OK and status != INTERRUPTED:  # record the times before it first
                    ended = status
                    status = OK
        count += 1
    return leave_call(s, status, w)
