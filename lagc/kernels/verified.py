"""A run whose error is known: an adaptive run, and in lock step with it a check with steps of 5/6.

The error of a method of order p is h^p times a function of the trajectory (HNW, Theorem II.3.4), so the
check errs by (5/6)^p of the error of the run, and their difference is 1 - (5/6)^p of it.  Both advance
together, five steps of the run, then six of the check over the same time; nothing of a trajectory is stored.
They round independently, so round-off is part of their difference.

If the estimated error is above what is asked, the run is repeated with a smaller tolerance.  The error of one
model is close to proportional to the tolerance; this law gives the next tolerance.
"""

from math import fabs, inf
from typing import Any

from lagc.kernels.arguments import check_call
from lagc.kernels.call_boundary import begin, enter_call, leave_call
from lagc.kernels.driver import begin_trajectory, step_once
from lagc.kernels.language.vocabulary import *
from lagc.kernels.trajectory import are_in_order, interpolate_at

BLOCK = 5  # steps of the run between two comparisons; the check makes one more
SAFETY = 1.2  # of the estimated error
FINEST_SAFETY = 3.0  # at the finest tolerance, where the difference is one sample of round-off
PRIOR = 30.0  # error over tolerance of a model without a law: the mean over the library
AIM = 0.5  # of the accuracy: error that the next attempt aims at
COARSEST = 1e-3  # tolerances
FINEST = by_type(1e-6, 3e-14, "1e-31")
MOST_ATTEMPTS = 6
GIVEN_UP = 10.0  # predicted error over the accuracy at which an attempt ends early
TRUSTED_PART = 0.05  # of the time, from which on the error at the end is predicted
LEAST_PART = 1e-3
MEANINGLESS_ERROR = 1e-2  # error over scale at which the last attempt ends
EARLY = 1e-3  # of the size of its group: least scale of a quantity that has hardly begun to move
SMALL = 1e-2  # of the size of its group: a state below it that misses gets an error weight of its own
CONSTANT = 1e-9  # of its terms: range of a quantity that does not move
SURELY_MOVES = 1e-3
BY_CHANCE = 20.0  # differences of the two runs: range of a quantity that only errors move
OFFSET = by_type(2.4e-4, 1.5e-8, "1e-17")  # relative change of a state that shows the terms of outputs


def state_quantities(p: Params, t: Real, x: Vec[NX], y: Vec[NQUANTITY], w: Work) -> None:
    """Set y to the coordinates, speeds and outputs at (t, x)."""
    for i in range(NQ + NV):
        y[i] = x[i]
    if NY > 0:
        observed = vector(NY)
        fn_observe(p, t, x, observed, w)
        for i in range(NY):
            y[NQ + NV + i] = observed[i]


def compare_quantities(v: Verification) -> None:
    """Enlarge the gaps to the differences of the two runs, and the ranges to the values of the run."""
    for i in range(NQUANTITY):
        gap = fabs(v.of_run[i] - v.of_check[i])
        if not gap <= v.gap[i]:
            v.gap[i] = gap
        if v.of_run[i] < v.low[i]:
            v.low[i] = v.of_run[i]
        if v.of_run[i] > v.high[i]:
            v.high[i] = v.of_run[i]


def known_part(method: int) -> Real:
    """Return the difference of the two runs over the error of the run: 1 - (5/6)^order."""
    rest = 1.0
    for m in static(METHODS):
        if method == m.NUMBER:
            for count in range(m.ORDER):
                rest *= BLOCK / (BLOCK + 1.0)
    return 1.0 - rest


def estimate_errors(g: Goal, scales: Vec[NQUANTITY], method: int, underway: bool, v: Verification) -> Real:
    """Set errors and scales of the quantities from what was compared so far; return the largest error over
    scale."""
    events: Count = 0
    if NMODE > 0:
        events = v.run.changes
    margin = SAFETY / known_part(method) * (1.0 + (1.0 + events) / (v.run.steps + 1.0))
    if v.tolerance <= 2.0 * FINEST:
        margin *= FINEST_SAFETY
    worst = 0.0
    v.misses_by_small = False
    for i in range(NQUANTITY):
        largest = fabs(v.low[i]) if fabs(v.low[i]) > fabs(v.high[i]) else fabs(v.high[i])
        group = 0.0
        noise = 0.0
        if i < NQ + NV:
            group = v.run.sizes[scaling_group[i]]
            if NC > 0 or NCON > 0:
                noise = PROJECTED_NOISE * group
            else:
                noise = LEAST_COMPARED * group
        size = v.terms[i] if v.terms[i] > largest else largest
        if 0.1 * noise > size:
            size = 0.1 * noise
        span = v.high[i] - v.low[i]
        scale = span
        given = False
        if present(scales):
            given = scales[i] > 0.0
        v.constant[i] = 0
        if given:
            scale = scales[i]
        elif span <= CONSTANT * size or (span <= SURELY_MOVES * size and span <= BY_CHANCE * v.gap[i]):
            scale = group if largest <= noise else size
            v.constant[i] = 1
        if NQUAT > 0:
            for k in range(NQUAT):
                if i >= quaternion[k] and i < quaternion[k] + 4:
                    scale = 1.0
        if underway:
            least = EARLY * (group if i < NQ + NV else size)
            if scale < least:
                scale = least
        v.scale[i] = scale
        v.error[i] = margin * v.gap[i] + SPACING * size
        if scale > 0.0 and not v.error[i] <= worst * scale:
            worst = v.error[i] / scale
            v.misses_by_small = i < NQ + NV and largest < SMALL * group
    return worst


def begin_attempt(p: Params, x0: Vec[NX], begin_time: Real, o: Options, r: Report, v: Verification) -> None:
    """Set both runs to the beginning."""
    o.rtol = v.tolerance
    o.alone = v.sizes_alone
    begin(v.run, begin_time, x0)
    begin(v.check, begin_time, x0)
    state_quantities(p, begin_time, x0, v.of_run, v.run_work)
    v.low[:] = v.of_run
    v.high[:] = v.of_run
    for i in range(NQUANTITY):
        v.gap[i] = 0.0
        v.terms[i] = 0.0
    v.steps_done = 0
    v.checked = 0
    v.predicted = 0.0
    v.block_times[0] = begin_time
    r.until = begin_time
    r.skipped = 0
    r.done = 0


def record_times(p: Params, times: Vec[Any], n: Length, o: Options, states: Rows[NX], outputs: Rows[NY],
                 r: Report, v: Verification) -> Status:  # fmt: skip
    """Write the states and outputs of the run at the times up to its end."""
    while r.done < n and times[r.done] <= v.run.t:
        status = interpolate_at(v.run, times[r.done], o, states[r.done], v.run_work)
        if failed(status):
            return status
        if NY > 0:
            fn_observe(p, times[r.done], states[r.done], outputs[r.done], v.run_work)
        r.done += 1
    return OK


def step_run(p: Params, times: Vec[Any], n: Length, o: Options, states: Rows[NX], outputs: Rows[NY],
             r: Report, v: Verification) -> Status:  # fmt: skip
    """Make one step of the run, and keep what its check is compared with."""
    changes: Count = 0
    if NMODE > 0:
        changes = v.run.changes
    recorded = r.done
    ended = step_once(p, v.run, times[n - 1], o, v.run_work)
    if failed(ended) and ended != TERMINATED:
        return ended
    v.run.is_new_call = False
    status = record_times(p, times, n, o, states, outputs, r, v)
    if failed(status):
        return status
    m = v.steps_done
    if not v.run.t > v.block_times[m]:
        return ended
    # The check reaches its next time within this step of the run.  Where the dense output of the run exists,
    # it is compared there.
    there = v.block_times[m] + (1.0 - (m + 1.0) / (BLOCK + 1.0)) * (v.run.t - v.block_times[m])
    v.check_times[m] = there
    v.block_changes[m] = float(changes)
    v.compared[m] = 0
    if v.run.dense_place == READY or r.done > recorded:
        status = interpolate_at(v.run, there, o, v.x, v.run_work)
        if failed(status):
            return status
        state_quantities(p, there, v.x, v.before[m], v.run_work)
        v.compared[m] = 1
    v.steps_done = m + 1
    v.block_times[m + 1] = v.run.t
    return ended


def passed_alike(s: State, changes: Real) -> bool:
    """Return whether a run has passed this number of events."""
    if NMODE > 0:
        return s.changes == changes
    return True


def compare_recorded(p: Params, times: Vec[Any], o: Options, states: Rows[NX], outputs: Rows[NY],
                     target: Real, r: Report, v: Verification) -> Status:  # fmt: skip
    """Compare the recorded times up to a time that the check has reached with its dense output."""
    while v.checked < r.done and times[v.checked] <= target:
        t = times[v.checked]
        step = 0
        while step + 1 < v.steps_done and t > v.block_times[step + 1]:
            step += 1
        if t < target and t > v.check.t_old and t < v.block_times[step + 1]:
            if passed_alike(v.check, v.block_changes[step]) and passed_alike(v.run, v.block_changes[step]):
                status = interpolate_at(v.check, t, o, v.x, v.check_work)
                if failed(status):
                    return status
                state_quantities(p, t, v.x, v.of_check, v.check_work)
                for i in range(NQ + NV):
                    v.of_run[i] = states[v.checked][i]
                if NY > 0:
                    for i in range(NY):
                        v.of_run[NQ + NV + i] = outputs[v.checked][i]
                compare_quantities(v)
        v.checked += 1
    return OK


def agree(one: State, other: State) -> bool:
    """Return whether two runs have passed the same number of events."""
    if NMODE > 0:
        return one.changes == other.changes
    return True


def measure_terms(p: Params, v: Verification) -> None:
    """Enlarge the terms of the outputs to their change under a small relative change of the state: the sum of
    the magnitudes of what an output is made of, which bounds its round-off."""
    for i in range(NX):
        v.x[i] = v.run.x[i] * (1.0 + (OFFSET if i % 2 == 1 else -OFFSET))
    state_quantities(p, v.run.t, v.run.x, v.of_run, v.run_work)
    state_quantities(p, v.run.t, v.x, v.of_check, v.run_work)
    for i in range(NQ + NV, NQUANTITY):
        term = fabs(v.of_run[i] - v.of_check[i]) / OFFSET
        if term > v.terms[i]:
            v.terms[i] = term


def follow_to(p: Params, target: Real, o: Options, v: Verification) -> Status:
    """Let the check reach a time, by one step if it is accurate enough, or a clause that ends it."""
    while v.check.t < target:
        v.check.h = target - v.check.t
        status = step_once(p, v.check, target, o, v.check_work)
        if failed(status):
            return status
        v.check.is_new_call = False
    return OK


def check_block(p: Params, times: Vec[Any], n: Length, ended: Status, o: Options, states: Rows[NX],
                outputs: Rows[NY], r: Report, v: Verification) -> Status:  # fmt: skip
    """Let the check follow the steps of the run since the last comparison, and compare.  Where a clause has
    ended the run, it ends the check too, at another time, and both ends are compared."""
    last = v.steps_done
    final = ended == TERMINATED or not v.run.t < times[n - 1]
    closed = OK
    for m in range(last + 1):
        target = v.run.t if m == last else v.check_times[m]
        if closed == OK:
            closed = follow_to(p, target, o, v)
        if m == last and ended == TERMINATED and closed == OK:
            closed = follow_to(p, times[n - 1], o, v)
        if failed(closed) and closed != TERMINATED:
            return closed
        if closed == TERMINATED and m < last:
            continue
        status = compare_recorded(p, times, o, states, outputs, target, r, v)
        if failed(status):
            return status
        alike = m == last and final
        if not alike:
            alike = passed_alike(v.check, v.block_changes[m]) if m < last else agree(v.run, v.check)
        if not alike:
            r.skipped += 1
        elif m == last:
            state_quantities(p, target, v.run.x, v.of_run, v.run_work)
        elif v.compared[m] == 1:
            v.of_run[:] = v.before[m]
        if alike and (m == last or v.compared[m] == 1):
            state_quantities(p, target, v.check.x, v.of_check, v.check_work)
            compare_quantities(v)
    v.steps_done = 0
    v.block_times[0] = v.run.t
    for i in range(NQ + NV):
        if v.run.lowest[i] < v.low[i]:
            v.low[i] = v.run.lowest[i]
        if v.run.highest[i] > v.high[i]:
            v.high[i] = v.run.highest[i]
    if NY > 0:
        measure_terms(p, v)
    return OK


def run_attempt(p: Params, times: Vec[Any], n: Length, g: Goal, scales: Vec[NQUANTITY], o: Options,
                states: Rows[NX], outputs: Rows[NY], last: bool, r: Report,
                v: Verification) -> Status:  # fmt: skip
    """Advance both runs to the end, until the accuracy is surely missed, or until the slice of steps is
    made (INTERRUPTED).  The last attempt goes on as long as its result has a meaning."""
    first = times[0]
    final = times[n - 1]
    before = v.run.steps
    while v.run.t < final:
        if g.slice > 0 and v.run.steps - before >= g.slice:
            return INTERRUPTED
        ended = step_run(p, times, n, o, states, outputs, r, v)
        if failed(ended) and ended != TERMINATED:
            return ended
        if v.steps_done == BLOCK or ended == TERMINATED or not v.run.t < final:
            status = check_block(p, times, n, ended, o, states, outputs, r, v)
            if failed(status):
                return status
            error = estimate_errors(g, scales, o.method, ended == OK and v.run.t < final, v)
            part = (v.run.t - first) / (final - first)
            if error <= g.accuracy:
                r.until = v.run.t
            if ended == TERMINATED:
                return ended
            v.predicted = error / (part if part > LEAST_PART else LEAST_PART)
            if part < 1.0:
                if last:
                    if error > MEANINGLESS_ERROR and error > g.accuracy:
                        return OK
                elif part > TRUSTED_PART and (error > g.accuracy or v.predicted > GIVEN_UP * g.accuracy):
                    return OK
                if g.most > 0 and r.rhs + v.run.rhs + v.check.rhs > g.most:
                    return OK
    return OK


def next_tolerance(g: Goal, whole: bool, lost: bool, r: Report, v: Verification) -> None:
    """Set the tolerance of the next attempt by the law of this one."""
    error = r.estimated if whole else v.predicted
    if v.misses_by_small and not v.sizes_alone:
        v.sizes_alone = True
        v.tolerance = g.accuracy / PRIOR
        return
    most = 0.3 if r.attempts < 2 else 0.1 if r.attempts < 3 else 0.01  # a second miss goes farther
    change = AIM * g.accuracy / error if error > 0.0 else most
    if lost:
        change = 0.01
    elif not change < most:
        change = most
    elif change < 1e-6:
        change = 1e-6
    v.tolerance *= change


@public
def verified(p: Params, x0: Vec[NX], times: Vec[Any], n: Length, g: Goal, scales: Vec[NQUANTITY],
             o: Options, states: Rows[NX], outputs: Rows[NY], r: Report,
             v: Verification) -> Status:  # fmt: skip
    """Integrate from (times[0], x0) to times[n-1] so that the error of each coordinate, speed and output is
    at most g->accuracy of its scale: scales[NQUANTITY] where they are given and positive, else the range of
    the quantity. Write states[n*NX] and outputs[n*NY] at the times, which increase, errors and scales to
    v->error and v->scale, and the rest of what is known to *r. The accuracy is met if r->estimated is at
    most g->accuracy; it is infinite if the end is not reached: r->done times are written, and it is met
    until r->until. o->method and o->max_step are used; o->rtol and o->alone are set. Begin with
    v->phase = 0. INTERRUPTED after g->slice steps: call again to continue."""
    if v.phase == 0:
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
        v.sizes_alone = False
        v.tolerance = AIM * g.accuracy / g.law if g.law > 0.0 else g.accuracy / PRIOR
        if not v.tolerance < COARSEST:
            v.tolerance = COARSEST
    while True:
        begins = v.phase == 0
        if begins:
            r.attempts += 1
            if v.tolerance < FINEST:
                v.tolerance = FINEST
            begin_attempt(p, x0, times[0], o, r, v)
        last = r.attempts >= MOST_ATTEMPTS or v.tolerance <= FINEST
        enter_call(v.run, v.run_work)
        enter_call(v.check, v.check_work)
        if not begins:
            v.run.is_new_call = False
            v.check.is_new_call = False
        status = OK
        if begins:
            if NCON > 0:
                status = begin_trajectory(p, v.run, 1.0, o, v.run_work)
                if not failed(status):
                    status = begin_trajectory(p, v.check, 1.0, o, v.check_work)
            if not failed(status):
                status = record_times(p, times, n, o, states, outputs, r, v)
        if not failed(status):
            status = run_attempt(p, times, n, g, scales, o, states, outputs, last, r, v)
        status = leave_call(v.run, status, v.run_work)
        leave_call(v.check, status, v.check_work)
        if status == INTERRUPTED:
            v.phase = 1
            return status
        v.phase = 0
        r.rhs += v.run.rhs + v.check.rhs
        r.steps = v.run.steps
        r.rtol = v.tolerance
        r.estimated = estimate_errors(g, scales, o.method, False, v)
        whole = v.run.t >= times[n - 1] or status == TERMINATED
        g.law = (r.estimated if whole else v.predicted) / v.tolerance
        if not whole:
            r.estimated = inf
        if last or (whole and r.estimated <= g.accuracy) or (g.most > 0 and r.rhs > g.most):
            return status
        next_tolerance(g, whole, failed(status) and status != TERMINATED, r, v)
