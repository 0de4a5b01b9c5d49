"""A run whose error is known: an adaptive run, and in lock step with it a check with steps of 5/6.

The error of a method of order p is h^p times a function of the trajectory (HNW, Theorem II.3.4), so the
check errs by (5/6)^p of the error of the run, and their difference is 1 - (5/6)^p of it.  Both advance
together, five steps of the run, then six of the check over the same time; nothing of a trajectory is stored.
They round independently, so round-off is part of their difference.

If the estimated error is above what is asked, the run is repeated with a smaller tolerance.  The error of one
model is close to proportional to the tolerance; this law gives the next tolerance.
"""

from math import fabs, floor, inf
from typing import Any

from lagc.kernels.arguments import check_call
from lagc.kernels.call_boundary import begin, enter_call, leave_call
from lagc.kernels.contact.touching import rates_at
from lagc.kernels.driver import begin_trajectory, step_once
from lagc.kernels.integrators.dispatch import has_series
from lagc.kernels.integrators.roundoff import perturb_inputs
from lagc.kernels.language.vocabulary import *
from lagc.kernels.trajectory import are_in_order, interpolate_at

BLOCK = 5  # steps of the run between two comparisons; the check makes one more
SAFETY = 1.2  # of the estimated error
FINE_SAFETY = 1.5  # near the finest tolerance, where the difference is one sample of round-off
PRIOR = 30.0  # error over tolerance of a model without a law: the mean over the library
AIM = 0.5  # of the accuracy: error that the next attempt aims at
COARSEST = 1e-3  # tolerances
FINEST = by_type(1e-6, 1e-15, "1e-31")
FINE = by_type(2e-5, 2e-14, "2e-30")  # tolerance below which round-off is a large part of errors
MOST_ATTEMPTS = 6
GIVEN_UP = 10.0  # predicted error over the accuracy at which an attempt ends early
TRUSTED_PART = 0.05  # of the time, from which on the error at the end is predicted
LEAST_PART = 1e-3
MEANINGLESS_ERROR = 1e-2  # error over scale at which the last attempt ends
PATIENCE = 1.5  # times the time until which the accuracy is met, before the last attempt ends,
WAIT = 0.1  # and of the whole time
EARLY = 1e-3  # of the size of its group: least scale of a quantity that has hardly begun to move
SMALL = 1e-2  # of the size of its group: a state below it that misses gets an error weight of its own
CONSTANT = 1e-9  # of its terms: range of a quantity that does not move
SURELY_MOVES = 1e-3
BY_CHANCE = 20.0  # differences of the two runs: range of a quantity that only errors move
OFFSET = by_type(2.4e-4, 1.5e-8, "1e-17")  # relative change of a state that shows the terms of outputs
STEADY = 1e-6  # relative: change of an acceleration that stays the same
SEVERAL = 3.0  # factor on the round-off of rates at a few states
KEPT = 7  # times of jumps that are kept for comparison
FINER_SERIES = 0.1  # tolerance of the check over that of the run, for a method whose order follows from it
FAILED_CHANGE = 1e-3  # of the tolerance, after an attempt that an error ended
MOST_FAILURES = 2


def state_quantities(p: Params, t: Real, x: Vec[NX], y: Vec[NQUANTITY], w: Work) -> None:
    """Set y to the coordinates, speeds, outputs and discrete variables at (t, x)."""
    for i in range(NQ + NV):
        y[i] = x[i]
    if NY > 0:
        observed = vector(NY)
        fn_observe(p, t, x, observed, w)
        for i in range(NY):
            y[NQ + NV + i] = observed[i]
    for i in range(NDISC):
        y[NQ + NV + NY + i] = x[NINT + i]


def compare_quantities(v: Verification) -> None:
    """Enlarge the gaps to the differences of the two runs, and the ranges to the values of the run. Values
    of outputs that are not finite are left out."""
    if NZ > 0:
        gap = fabs(v.run.x[NQ + NV] - v.check.x[NQ + NV])
        if v.run.t == v.check.t and gap > v.work_error:
            v.work_error = gap
    for i in range(NQUANTITY):
        gap = fabs(v.of_run[i] - v.of_check[i])
        if not gap - gap == 0.0:
            continue
        if gap > v.gap[i]:
            v.gap[i] = gap
        if v.of_run[i] < v.low[i]:
            v.low[i] = v.of_run[i]
        if v.of_run[i] > v.high[i]:
            v.high[i] = v.of_run[i]


def known_part(method: int) -> Real:
    """Return the difference of the two runs over the error of the run: 1 - (5/6)^order, or the part that the
    tolerance of the check leaves."""
    if NSERIES > 0:
        if has_series(method):
            return 1.0 - FINER_SERIES
    rest = 1.0
    for m in static(METHODS):
        if method == m.NUMBER:
            for count in range(m.ORDER):
                rest *= BLOCK / (BLOCK + 1.0)
    return 1.0 - rest


def roundoff_of(i: Size, v: Verification) -> Real:
    """Return a bound of how far round-off of the rates moves a state over the time of the run so far."""
    time = SEVERAL * (v.run.t - v.begin_time)
    if i >= NQ and i < NQ + NV:
        return time * v.roundoff[i]
    if not HAS_DISPLACE:
        if i < NQ:
            return time * (v.run.t - v.begin_time) * v.roundoff[i + NQ]
    return 0.0


def shared_roundoff(i: Size, v: Verification) -> Real:
    """Return the part of `roundoff_of` that the difference of the runs does not show: an acceleration that
    stays the same is rounded alike in both."""
    if i < NQ and not HAS_DISPLACE:
        return roundoff_of(i, v) if v.varies[i + NQ] == 0 else 0.0
    return roundoff_of(i, v) if i >= NQ and v.varies[i] == 0 else 0.0


def scale_of(i: Size, group: Real, accuracy: Real, underway: bool, scales: Vec[NQUANTITY],
             v: Verification) -> Real:  # fmt: skip
    """Return the scale of a quantity: the one that is given, the range, or for a quantity that does not move
    the size of its terms. `group` is the size of the scaling group of a state."""
    largest = fabs(v.low[i]) if fabs(v.low[i]) > fabs(v.high[i]) else fabs(v.high[i])
    # A state below its noise cannot be told from zero beside the others of its group.
    noise = (PROJECTED_NOISE if NC > 0 or NCON > 0 else LEAST_COMPARED) * group
    size = v.terms[i] if v.terms[i] > largest else largest
    if 0.1 * noise > size:
        size = 0.1 * noise
    v.size[i] = size
    v.constant[i] = 0
    scale = v.high[i] - v.low[i]
    if present(scales):
        if scales[i] > 0.0:
            return scales[i]
    if largest == 0.0 and v.gap[i] == 0.0:
        return 0.0
    if scale <= CONSTANT * size or (scale <= SURELY_MOVES * size and scale <= BY_CHANCE * v.gap[i]):
        scale = group if largest <= noise else size
        v.constant[i] = 1
    if NQUAT > 0:
        for k in range(NQUAT):
            if i >= quaternion[k] and i < quaternion[k] + 4:
                scale = 1.0
    # Round-off alone moves this state, or keeps it, beside others of its group, from the accuracy.
    if i < NQ + NV:
        roundoff = roundoff_of(i, v)
        if largest > BY_CHANCE * v.gap[i]:
            v.known[i] = 1
        elif v.known[i] == 0 and v.tolerance <= FINE and largest > roundoff:
            roundoff = largest
        if v.start[i] == 0.0 and largest <= roundoff and group <= roundoff:
            v.constant[i] = 0
            return 0.0
    if group > scale and largest < SMALL * group and roundoff > accuracy * scale:
        v.constant[i] = 2
        return group
    # A quantity that has hardly begun to move has no range yet.
    least = EARLY * (group if i < NQ + NV else size)
    return least if underway and scale < least else scale


def estimate_errors(scales: Vec[NQUANTITY], accuracy: Real, method: int, underway: bool,
                    v: Verification) -> Real:  # fmt: skip
    """Set errors and scales of the quantities from what was compared so far; return the largest error over
    scale. That of the times of jumps is relative to the time of the run."""
    events: Count = 0
    if NMODE > 0:
        events = v.run.changes
    margin = SAFETY / known_part(method) * (1.0 + (1.0 + events) / (v.run.steps + 1.0))
    if v.tolerance <= FINE:
        margin *= FINE_SAFETY
    worst = 0.0
    v.misses_by_small = False
    for i in range(NQUANTITY):
        group = v.run.sizes[scaling_group[i]] if i < NQ + NV else 0.0
        scale = scale_of(i, group, accuracy, underway, scales, v)
        v.scale[i] = scale
        v.error[i] = margin * v.gap[i]
        if i < NQ + NV + NY:
            v.error[i] += SPACING * v.size[i]
        if i < NQ + NV:
            v.error[i] += shared_roundoff(i, v)
        if scale > 0.0 and not v.error[i] <= worst * scale:
            worst = v.error[i] / scale
            v.misses_by_small = i < NQ + NV and v.size[i] < SMALL * group
    if NLEAP > 0:
        v.time_error = margin * v.time_gap
        if v.time_error > worst * v.duration:
            worst = v.time_error / v.duration
    return worst


def displace_check(p: Params, x0: Vec[NX], v: Verification) -> None:
    """Begin the check with data that differ from those of the run in the last place: what rounding of states
    and parameters does to a motion, and of what is prepared from them, is then part of the difference, as
    large as it grows. Integers without a unit may be exponents and stay. Models with relations begin alike,
    since the last place may decide on which side of one they are, and constraints keep their parameters, on
    which it may depend whether one follows from others."""
    v.x[:] = x0
    v.p[:] = p
    if NMODE == 0:
        for i in range(NQ + NV):
            v.x[i] *= 1.0 + (SPACING if i % 2 == 0 else -SPACING)
        if NC == 0:
            for k in range(NP):
                if has_unit[k] != 0 or p[k] != floor(p[k]):
                    v.p[k] = p[k] * (1.0 + (SPACING if k % 2 == 0 else -SPACING))
            if NPREPARED > 0:
                bind(v.p)


def begin_attempt(p: Params, x0: Vec[NX], begin_time: Real, o: Options, r: Report, v: Verification) -> None:
    """Set both runs to the beginning."""
    o.rtol = v.tolerance
    o.alone = v.alone
    begin(v.run, begin_time, x0)
    displace_check(p, x0, v)
    begin(v.check, begin_time, v.x)
    state_quantities(p, begin_time, x0, v.of_run, v.run_work)
    v.low[:] = v.of_run
    v.high[:] = v.of_run
    for i in range(NQUANTITY):
        v.gap[i] = 0.0
        v.terms[i] = 0.0
    for i in range(NQ + NV):
        v.roundoff[i] = 0.0
        v.start[i] = x0[i]
        v.known[i] = 0
        v.rate[i] = inf
        v.varies[i] = 0
    v.begin_time = begin_time
    if NZ > 0:
        v.work_error = 0.0
    if NMODE > 0:
        v.lag = 0
        v.changes_before = 0
        v.check_before = 0
    if NLEAP > 0:
        v.time_gap = 0.0
        v.jump_lag = 0
    v.check_ended = False
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


def note_jumps(s: State, before: Count, lag: Count, own: Vec[SEVEN], other: Vec[SEVEN], passed: Count,
               v: Verification) -> None:  # fmt: skip
    """Keep the times of the jumps of one run since `before`, and compare them with those of the other, which
    has `passed` jumps. Jump k of this run is jump k + lag of the other."""
    if NLEAP > 0:
        k = before
        while k < s.jumps:
            own[k % KEPT] = s.t
            there = k + lag
            if there >= 0 and there < passed and passed - there <= KEPT:
                gap = fabs(s.t - other[there % KEPT])
                if gap > v.time_gap:
                    v.time_gap = gap
            k += 1


def step_run(p: Params, times: Vec[Any], n: Length, o: Options, states: Rows[NX], outputs: Rows[NY],
             r: Report, v: Verification) -> Status:  # fmt: skip
    """Make one step of the run, and keep what its check is compared with."""
    m = v.steps_done
    if NMODE > 0:
        v.block_changes[m] = float(v.run.changes)
    if NLEAP > 0:
        jumps = v.run.jumps
    recorded = r.done
    ended = step_once(p, v.run, times[n - 1], o, v.run_work)
    if failed(ended) and ended != TERMINATED:
        record_times(p, times, n, o, states, outputs, r, v)
        return ended
    v.run.is_new_call = False
    if NLEAP > 0:
        note_jumps(v.run, jumps, -v.jump_lag, v.run_jumps, v.check_jumps, v.check.jumps, v)
    status = record_times(p, times, n, o, states, outputs, r, v)
    if failed(status):
        return status
    if not v.run.t > v.block_times[m]:
        return ended
    # The check reaches its next time within this step of the run.  Where the dense output of the run exists,
    # it is compared there.
    there = v.block_times[m] + (1.0 - (m + 1.0) / (BLOCK + 1.0)) * (v.run.t - v.block_times[m])
    v.check_times[m] = there
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


def check_is_alike(step: Size, v: Verification) -> bool:
    """Return whether the check has passed the events that the run had passed before a step of the block."""
    if NMODE > 0:
        return float(v.check.changes + v.lag) == v.block_changes[step]
    return True


def compare_recorded(p: Params, times: Vec[Any], o: Options, states: Rows[NX], outputs: Rows[NY],
                     changes: Real, r: Report, v: Verification) -> Status:  # fmt: skip
    """Compare the recorded times within the last step of the check with its dense output. `changes` is the
    number of events before that step: an event of a step is at its end."""
    while v.checked < r.done and times[v.checked] <= v.check.t:
        t = times[v.checked]
        step = 0
        while step + 1 < v.steps_done and t >= v.block_times[step + 1]:
            step += 1
        alike = t < v.check.t and t > v.check.t_old and t < v.block_times[step + 1]
        if NMODE > 0:
            alike = alike and changes == v.block_changes[step]
        if alike:
            status = interpolate_at(v.check, t, o, v.x, v.check_work)
            if failed(status):
                return status
            if NMODE > 0:
                v.check_work.modes[:] = v.check.modes_old
            state_quantities(v.p, t, v.x, v.of_check, v.check_work)
            for i in range(NQ + NV):
                v.of_run[i] = states[v.checked][i]
            if NY > 0:
                for i in range(NY):
                    v.of_run[NQ + NV + i] = outputs[v.checked][i]
            for i in range(NDISC):
                v.of_run[NQ + NV + NY + i] = states[v.checked][NINT + i]
            compare_quantities(v)
        v.checked += 1
    return OK


def agree(v: Verification) -> bool:
    """Return whether both runs have passed the same events at the end of a block. Where they had none in it
    they count as the same: round-off decides about the last of many bounces, or whether one touches."""
    if NMODE > 0:
        if v.run.changes != v.check.changes + v.lag:
            if v.run.changes != v.changes_before or v.check.changes != v.check_before:
                return False
            v.lag = v.run.changes - v.check.changes
            if NLEAP > 0:
                v.jump_lag = v.run.jumps - v.check.jumps
        v.changes_before = v.run.changes
        v.check_before = v.check.changes
    return True


def measure_terms(p: Params, v: Verification) -> None:
    """Enlarge the terms of the outputs to their change under a small relative change of the state: the sum of
    the magnitudes of what an output is made of, which bounds its round-off (J. Vignes, Math. Comput. Simul.
    35, 1993)."""
    v.x[:] = v.run.x
    for i in range(NQ + NV):
        v.x[i] *= 1.0 + (OFFSET if i % 2 == 1 else -OFFSET)
    state_quantities(p, v.run.t, v.run.x, v.of_run, v.check_work)
    state_quantities(p, v.run.t, v.x, v.of_check, v.check_work)
    for i in range(NQ + NV, NQ + NV + NY):
        term = fabs(v.of_run[i] - v.of_check[i]) / OFFSET
        if term > v.terms[i] and term < inf:
            v.terms[i] = term


def measure_roundoff(p: Params, v: Verification) -> None:
    """Enlarge the round-off of the rates of speeds to their change under perturbations of all data by a few
    units in the last place, and by that over the least pivot of the mass matrix. Note the accelerations that
    vary."""
    other = params()
    rates = vector(NX)
    t = perturb_inputs(p, v.run, v.run.steps, v.x, other)
    v.check.rhs += 2
    if failed(rates_at(p, v.run.t, v.run.x, rates, v.check_work.lam, v.check_work)):
        return
    pivot = 1.0
    if NM > 0 and NC == 0:
        pivot = v.check_work.health[0]
    if failed(rates_at(other, t, v.x, v.check_work.xdot, v.check_work.lam, v.check_work)):
        return
    for i in range(NQ, NQ + NV):
        change = fabs(v.check_work.xdot[i] - rates[i]) + SPACING / pivot * fabs(rates[i])
        if change > v.roundoff[i] and change < inf:
            v.roundoff[i] = change
        if v.rate[i] < inf and fabs(rates[i] - v.rate[i]) > STEADY * fabs(rates[i]):
            v.varies[i] = 1
        v.rate[i] = rates[i]


def follow_to(p: Params, target: Real, times: Vec[Any], o: Options, states: Rows[NX], outputs: Rows[NY],
              r: Report, v: Verification) -> Status:  # fmt: skip
    """Let the check reach a time, by one step if it is accurate enough, or a clause that ends it; compare the
    recorded times on the way."""
    changes = 0.0
    ended = OK
    while (ended == OK or ended == REDUNDANT) and v.check.t < target:
        v.check.h = target - v.check.t
        if NMODE > 0:
            changes = float(v.check.changes + v.lag)
        if NLEAP > 0:
            jumps = v.check.jumps
        if NSERIES > 0:
            if has_series(o.method):
                o.rtol = FINER_SERIES * v.tolerance
        ended = step_once(v.p, v.check, target, o, v.check_work)
        o.rtol = v.tolerance
        if failed(ended) and ended != TERMINATED:
            return ended
        v.check.is_new_call = False
        if NLEAP > 0:
            note_jumps(v.check, jumps, v.jump_lag, v.check_jumps, v.run_jumps, v.run.jumps, v)
        status = compare_recorded(p, times, o, states, outputs, changes, r, v)
        if failed(status):
            return status
    return ended


def compare_ends(p: Params, ended: Status, r: Report, v: Verification) -> None:
    """Compare both runs at their ends. Where one has passed a jump that the other has not, at the end of the
    time, their distance in time is that to the end at least."""
    if NLEAP > 0:
        if ended == TERMINATED or v.check_ended:
            gap = fabs(v.run.t - v.check.t)
            if gap > v.time_gap:
                v.time_gap = gap
            if not (ended == TERMINATED and v.check_ended):
                r.skipped += 1
                return
        elif not agree(v):
            r.skipped += 1
            if v.run.jumps != v.check.jumps + v.jump_lag:
                later = v.run.t_changed if v.run.changes > v.check.changes + v.lag else v.check.t_changed
                if v.run.t - later > v.time_gap:
                    v.time_gap = v.run.t - later
            return
    state_quantities(p, v.run.t, v.run.x, v.of_run, v.run_work)
    state_quantities(v.p, v.check.t, v.check.x, v.of_check, v.check_work)
    compare_quantities(v)


def check_block(p: Params, times: Vec[Any], n: Length, ended: Status, o: Options, states: Rows[NX],
                outputs: Rows[NY], r: Report, v: Verification) -> Status:  # fmt: skip
    """Let the check follow the steps of the run since the last comparison, and compare.  Where a clause has
    ended the run, it ends the check too, at another time, and both ends are compared."""
    last = v.steps_done
    final = ended == TERMINATED or not v.run.t < times[n - 1]
    for m in range(last + 1):
        target = v.run.t if m == last else v.check_times[m]
        if m == last and ended == TERMINATED:
            target = times[n - 1]
        if not v.check_ended:
            status = follow_to(p, target, times, o, states, outputs, r, v)
            if failed(status) and status != TERMINATED:
                v.run.culprit = v.check.culprit
                return status
            v.check_ended = status == TERMINATED
        if v.check_ended and not (m == last and final):
            continue
        if m == last and final:
            compare_ends(p, ended, r, v)
        elif not (agree(v) if m == last else check_is_alike(m, v)):
            r.skipped += 1
        elif m == last or v.compared[m] == 1:
            if m == last:
                state_quantities(p, target, v.run.x, v.of_run, v.run_work)
            else:
                v.of_run[:] = v.before[m]
            state_quantities(v.p, target, v.check.x, v.of_check, v.check_work)
            compare_quantities(v)
    v.steps_done = 0
    v.block_times[0] = v.run.t
    for i in range(NQ + NV):
        if v.run.lowest[i] < v.low[i]:
            v.low[i] = v.run.lowest[i]
        if v.run.highest[i] > v.high[i]:
            v.high[i] = v.run.highest[i]
    # In the workspace of the check, whose next step sets its modes: that of the run tells of the run alone.
    if NMODE > 0:
        v.check_work.modes[:] = v.run_work.modes
    if NY > 0:
        measure_terms(p, v)
    measure_roundoff(p, v)
    return OK


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
        elif error > g.accuracy or v.predicted > GIVEN_UP * g.accuracy:
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
        r.rhs += v.run.rhs + v.check.rhs
        r.steps = v.run.steps
        r.rtol = v.tolerance
        r.estimated = estimate_errors(scales, g.accuracy, o.method, False, v)
        whole = v.run.t >= times[n - 1] or status == TERMINATED
        g.law = (r.estimated if whole else v.predicted) / v.tolerance
        if not whole:
            r.estimated = inf
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
