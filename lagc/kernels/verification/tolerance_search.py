"""A run to an accuracy: pairs of a run and its check, with smaller and smaller tolerances.

The error of one model is close to proportional to the tolerance; this law gives the next tolerance.
"""

from math import inf
from typing import Any

from lagc.kernels.arguments import check_call
from lagc.kernels.call_boundary import enter_call, leave_call
from lagc.kernels.driver import begin_trajectory
from lagc.kernels.language.vocabulary import *
from lagc.kernels.trajectory import are_in_order
from lagc.kernels.verification.pair import begin_attempt, check_block, record_times, step_run
from lagc.kernels.verification.quantity_errors import BLOCK, estimate_errors

PRIOR = 30.0  # error over tolerance of a model without a law: the mean over the library
AIM = 0.5  # of the accuracy: error that the next attempt aims at
COARSEST = 1e-3  # tolerances
FINEST = by_type(1e-6, 3e-15, "1e-31")
MOST_ATTEMPTS = 6
GIVEN_UP = 10.0  # predicted error over the accuracy at which an attempt ends early
TRUSTED_PART = 0.05  # of the time, from which on the error at the end is predicted
LEAST_PART = 1e-3
MEANINGLESS_ERROR = 1e-2  # error over scale at which the last attempt ends
PATIENCE = 1.5  # times the time until which the accuracy is met, before the last attempt ends,
WAIT = 0.1  # and of the whole time
FAILED_CHANGE = 1e-3  # of the tolerance, after an attempt that an error ended
MOST_FAILURES = 2


def gives_up(g: Goal, error: Real, part: Real, last: bool, r: Report, v: Verification) -> bool:
    """Return whether an attempt ends after this part of the time: it surely misses the accuracy, or has no
    meaning any more if it is the last one."""
    v.predicted = error / (part if part > LEAST_PART else LEAST_PART)
    if not part < 1.0:
        return False
    if part > TRUSTED_PART:
        if last:
            # A state that has just set out, or that round-off moves, is known as such later.
            waited = v.run.t - v.begin_time > PATIENCE * (r.until - v.begin_time) + WAIT * v.duration
            if error > MEANINGLESS_ERROR and error > g.accuracy and waited:
                return True
        elif v.run.t - v.set_out_time > TRUSTED_PART * v.duration and (
            error > g.accuracy or v.predicted > GIVEN_UP * g.accuracy
        ):
            return True
    return g.most > 0 and r.rhs + v.run.rhs + v.check.rhs > g.most


def run_attempt(p: Params, times: Vec[Any], n: Length, g: Goal, scales: Vec[NQUANTITY], o: Options,
                states: Rows[NX], outputs: Rows[NY], last: bool, r: Report,
                v: Verification) -> Status:  # fmt: skip
    """Advance both runs to the end, until the accuracy is surely missed, or until the slice of steps is
    made, or an event is to be reported (INTERRUPTED).  The last attempt goes on as long as its result has a
    meaning."""
    final = times[n - 1]
    before = v.run.steps
    while v.run.t < final:
        if g.slice > 0 and v.run.steps - before >= g.slice:
            return INTERRUPTED
        if NMODE > 0:
            changes = v.run.changes
        # Advance the run alone until its block is full, then let the check follow and compare both.
        ended = step_run(p, times, n, o, states, outputs, r, v)
        if failed(ended) and ended != TERMINATED:
            return ended
        if v.steps_done == BLOCK or ended == TERMINATED or not v.run.t < final:
            status = check_block(p, times, n, ended, o, states, outputs, r, v)
            if failed(status):
                return status
            error = estimate_errors(scales, g.accuracy, o.method, ended == OK and v.run.t < final, v)
            if error <= g.accuracy:
                r.until = v.run.t
            if ended == TERMINATED:
                return ended
            if gives_up(g, error, (v.run.t - times[0]) / v.duration, last, r, v):
                return OK
        if NMODE > 0:
            if o.report != 0 and v.run.changes > changes and v.run.t < final:
                return INTERRUPTED
    return OK


def end_attempt(whole: bool, g: Goal, scales: Vec[NQUANTITY], o: Options, r: Report,
                v: Verification) -> None:  # fmt: skip
    """Report the outcome of an attempt, which has reached the end if `whole`, and its law."""
    r.rhs += v.run.rhs + v.check.rhs
    r.steps = v.run.steps
    r.rtol = v.tolerance
    r.estimated = estimate_errors(scales, g.accuracy, o.method, False, v)
    g.law = (r.estimated if whole else v.predicted) / v.tolerance
    if not whole:
        r.estimated = inf


def next_tolerance(g: Goal, whole: bool, r: Report, v: Verification) -> None:
    """Set the tolerance of the next attempt by the law of this one."""
    error = r.estimated if whole else v.predicted
    if v.misses_by_small and not v.alone:
        v.alone = True
        v.tolerance = g.accuracy / PRIOR
        return
    most = 0.3 if r.attempts < 2 else 0.1 if r.attempts < 3 else 0.01  # a second miss goes farther
    change = AIM * g.accuracy / error if error > 0.0 else most
    if not change < most:
        change = most
    elif change < 1e-6:
        change = 1e-6
    v.tolerance *= change


def begin_both(p: Params, times: Vec[Any], n: Length, o: Options, states: Rows[NX], outputs: Rows[NY],
               r: Report, v: Verification) -> Status:  # fmt: skip
    """Let contacts act at the beginning of both runs, and record the first times. Return INTERRUPTED after an
    impact that is to be reported."""
    begun = OK
    if NCON > 0:
        begun = begin_trajectory(p, v.run, 1.0, o, v.run_work)
        if failed(begun) and begun != INTERRUPTED:
            return begun
        status = begin_trajectory(v.p, v.check, 1.0, o, v.check_work)
        if failed(status) and status != INTERRUPTED:
            return status
    status = record_times(p, times, n, o, states, outputs, r, v)
    return status if failed(status) else begun


def begin_search(p: Params, x0: Vec[NX], times: Vec[Any], n: Length, g: Goal, o: Options, r: Report,
                 v: Verification) -> Status:  # fmt: skip
    """Check the call, and set the tolerance of the first attempt by the law, or without one by the mean."""
    v.run.t = times[0]
    v.run.x[:] = x0
    o.rtol = COARSEST
    status = check_call(p, v.run, times[n - 1], o)
    if status != OK:
        return status
    if not are_in_order(v.run, times, n, 1.0):
        v.run.culprit = BAD_TIME
        return INVALID
    r.attempts = 0
    r.rhs = 0
    v.failures = 0
    v.alone = False
    v.duration = times[n - 1] - times[0]
    v.tolerance = AIM * g.accuracy / g.law if g.law > 0.0 else g.accuracy / PRIOR
    if not v.tolerance < COARSEST:
        v.tolerance = COARSEST
    return OK


@public
def verified(p: Params, x0: Vec[NX], times: Vec[Any], n: Length, g: Goal, scales: Vec[NQUANTITY],
             o: Options, states: Rows[NX], outputs: Rows[NY], r: Report,
             v: Verification) -> Status:  # fmt: skip
    """Integrate from (times[0], x0) to times[n-1] so that the error of each coordinate, speed, output and
    discrete variable is at most g->accuracy of its scale: scales[NQUANTITY] where they are given and
    positive, else the range of the quantity. Write states[n*NX] and outputs[n*NY] at the times, which
    increase, errors and scales to v->error and v->scale, and the rest of what is known to *r. The accuracy is
    met if r->estimated is at most g->accuracy; it is infinite if the end is not reached: r->done times are
    written, and it is met until r->until. o->method and o->max_step are used; o->rtol and o->alone are
    set. Begin with v->phase = 0. INTERRUPTED after g->slice steps: call again to continue."""
    if v.phase == 0:
        status = begin_search(p, x0, times, n, g, o, r, v)
        if status != OK:
            return status
    while True:
        begins = v.phase == 0
        if begins:
            r.attempts += 1
            if v.tolerance < FINEST:
                v.tolerance = FINEST
            # Both runs at this tolerance, from the beginning.
            begin_attempt(p, x0, times[0], o, r, v)
        last = r.attempts >= MOST_ATTEMPTS or v.tolerance <= FINEST
        enter_call(v.run, v.run_work)
        enter_call(v.check, v.check_work)
        if not begins:
            v.run.is_new_call = not v.run.parameters_known
            v.check.is_new_call = not v.check.parameters_known
        status = OK
        if begins:
            status = begin_both(p, times, n, o, states, outputs, r, v)
        if not failed(status):
            status = run_attempt(p, times, n, g, scales, o, states, outputs, last, r, v)
        status = leave_call(v.run, status, v.run_work)
        leave_call(v.check, status, v.check_work)
        if status == INTERRUPTED:
            v.phase = 1
            return status
        # The outcome of the attempt, and the law of the next one.
        v.phase = 0
        whole = v.run.t >= times[n - 1] or status == TERMINATED
        end_attempt(whole, g, scales, o, r, v)
        lost = failed(status) and status != TERMINATED
        if lost:
            v.failures += 1
        if last or (whole and r.estimated <= g.accuracy) or (g.most > 0 and r.rhs > g.most):
            return status
        if not lost:
            next_tolerance(g, whole, r, v)
        elif v.failures == MOST_FAILURES:
            return status
        else:
            v.tolerance *= FAILED_CHANGE
