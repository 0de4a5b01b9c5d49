"""Trajectories."""

from __future__ import annotations

from typing import Any

from lagc.kernels.arguments import check_call
from lagc.kernels.call_boundary import enter_call, leave_call, report_culprit
from lagc.kernels.constraints.projection import project
from lagc.kernels.driver import step_once
from lagc.kernels.dynamics.rhs import rhs_at
from lagc.kernels.integrators.dispatch import last_stage, method_dense_at, method_dense_output, method_stages
from lagc.kernels.language.records import ABSENT, BAD_BUDGET, BAD_TIME, READY, Options, State, Work
from lagc.kernels.language.scaling_groups import not_finite
from lagc.kernels.language.sizes import NC, NMODE, NQUAT, NWHEN, NX
from lagc.kernels.language.statuses import INTERRUPTED, INVALID, NOT_FINITE, OK, failed
from lagc.kernels.language.words import Cell, Count, Length, Params, Real, Rows, Status, Vec, by_type, public

OUTSIDE_STEP = by_type(1e-5, 1e-9, "1e-9")  # of a step: beyond its ends, but for rounding


def recompute_stages(s: State, t: Real, x: Vec[NX], w: Work) -> Status:
    """The stages of the last step once more: those of an attempt that failed have taken their place."""
    if NMODE > 0:
        w.modes[:] = s.modes_old
    status = rhs_at(s.p, s.t_old, s.x_old, s.k[0], w.lam, w)
    s.rate_place = ABSENT
    s.rhs += last_stage(s.method) + 1
    if not failed(status):
        status = method_stages(s.method, s.p, s.t_old, s.x_old, s.h_old, s, w)
    if not failed(status):
        status = rhs_at(s.p, t, x, s.k[last_stage(s.method)], w.lam, w)
    return status


def compute_dense_output(s: State, w: Work) -> Status:
    """The coefficients of dense output of the last step, with its parameters and its end, whatever the
    caller has changed since."""
    t = s.t_end if s.is_new_call else s.t
    if NWHEN > 0:
        x = s.x_before_event
    else:
        x = s.x_end if s.is_new_call else s.x
    if NMODE > 0:
        w.modes[:] = s.modes_old
    if s.dense_place == ABSENT:
        status = recompute_stages(s, t, x, w)
        if failed(status):
            return status
    return method_dense_output(s.method, s.p, s.t_old, s.x_old, x, s.h_old, s, w)


def interpolate_at(s: State, t: Real, o: Options, x: Vec[NX], w: Work) -> Status:
    if t == s.t or s.h_old == 0.0:
        x[:] = s.x
        return OK
    if s.dense_place != READY:
        status = compute_dense_output(s, w)
        if failed(status):
            return report_culprit(s, status, w)
        s.dense_place = READY
    method_dense_at(s.method, (t - s.t_old) / s.h_old, s, x)
    if NC > 0 or NQUAT > 0:
        if o.project:
            status = project(s.p, t, x, s.sizes, w)
            if failed(status):
                return report_culprit(s, status, w)
    return OK


def is_in_last_step(s: State, t: Real) -> bool:
    """Whether t is a time of the last step, but for rounding."""
    if t == s.t:
        return True
    if s.h_old == 0.0:
        return False
    part = (t - s.t_old) / s.h_old
    return part >= -OUTSIDE_STEP and part <= 1.0 + OUTSIDE_STEP


@public
def dense(p: Params, s: State, t: Real, o: Options, x: Vec[NX], w: Work) -> Status:
    """x[NX] at a time t within the last step, which was made with the parameters of then; at any other
    INVALID.  Of the options it takes `project` alone.  Where it fails x has no meaning."""
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


# step, advance and record look at the options, the times and the parameters of a call once, before anything
# is done: INVALID says that one makes no sense, NOT_FINITE that the state is not finite (s->culprit says
# which), and *s is as it was.  With any other status, and with NOT_FINITE of a motion that comes to where it
# has no value, *s is where the last step that was done has ended, and a call may go on from there.
#
# Between two of these calls the caller may change anything in *p, such as inputs, any option, and s->t and
# s->x: the next step begins with what is there then, at the cost of one evaluation where p, t or x is
# another, and with the size of step that was found before.  What is not changed costs nothing: the motion
# is that of one call, where t1 is the same.


@public
def step(p: Params, s: State, t1: Real, o: Options, w: Work) -> Status:
    """One step towards t1, before or after s->t, at most to it, and then exactly."""
    status = check_call(p, s, t1, o)
    if status != OK:
        return status
    enter_call(s, w)
    return leave_call(s, step_once(p, s, t1, o, w), w)


@public
def advance(p: Params, s: State, t1: Real, o: Options, w: Work) -> Status:
    """To t1 exactly, with error control and projection onto the constraints.  A step that is short only
    to end at t1 does not make the next one short."""
    status = check_call(p, s, t1, o)
    if status != OK:
        return status
    enter_call(s, w)
    while status == OK and s.t != t1:
        status = step_once(p, s, t1, o, w)
        if NMODE > 0:
            if status == OK and o.report != 0 and s.after_event:
                status = INTERRUPTED
    return leave_call(s, status, w)


def are_in_order(s: State, times: Vec[Any], n: Length, direction: Real) -> bool:
    """Whether times are in order from s.t on: asked once, of a grid of which nothing is done."""
    before = s.t
    for k in range(n):
        if not (times[k] - before) * direction >= 0.0:
            return False
        before = times[k]
    return True


def resumes_in_order(times: Vec[Any], n: Length, done: Length, direction: Real) -> bool:
    """Whether the next of times is where one may be, of a grid that was looked at before."""
    if done == n:
        return True
    there = times[done]
    return (there - times[done - 1]) * direction >= 0.0 and (times[n - 1] - there) * direction >= 0.0


@public
def record(p: Params, s: State, o: Options, times: Vec[Any], n: Length, states: Rows[NX], done: Cell[Length],
           budget: Count, w: Work) -> Status:  # fmt: skip
    """To times[n-1], with the states at times[0..n-1] written to states[n*NX]: *done of them so far,
    to be 0 in the first call.  The times are in order from s->t on, forwards or backwards.  After `budget`
    steps (0: no limit) it returns INTERRUPTED; call it again to go on.  Where n is 0, times and states may
    be NULL."""
    t1 = times[n - 1] if n > 0 else s.t
    direction = 1.0 if t1 > s.t or (t1 == s.t and s.t >= s.t_old) else -1.0
    status = check_call(p, s, t1, o)
    if status != OK:
        return status
    if budget < 0:
        s.culprit = BAD_BUDGET
        return INVALID
    known = done[0] > 0 and done[0] <= n and resumes_in_order(times, n, done[0], direction)
    if not known and (done[0] > 0 or not are_in_order(s, times, n, direction)):
        s.culprit = BAD_TIME
        return INVALID
    enter_call(s, w)
    count: Count = 0
    if NMODE > 0:
        ended = OK
    while status == OK:
        while status == OK and done[0] < n and (times[done[0]] - s.t) * direction <= 0.0:
            status = interpolate_at(s, times[done[0]], o, states[done[0]], w)
            if status == OK:
                done[0] += 1
        if NMODE > 0:
            if status == OK:
                status = ended
        if status != OK or done[0] == n:
            break
        if s.t == t1:  # and what is left of times is beyond
            s.culprit = BAD_TIME
            status = INVALID
            break
        if budget > 0 and count == budget:
            status = INTERRUPTED
        else:
            status = step_once(p, s, t1, o, w)
            if NMODE > 0:
                if status == OK and o.report != 0 and s.after_event:
                    status = INTERRUPTED
                if status != OK and status != INTERRUPTED:  # what came before is recorded
                    ended = status
                    status = OK
        count += 1
    return leave_call(s, status, w)
