"""An adaptive run, and in lock step with it a check with steps of 5/6.

Both advance together, five steps of the run, then six of the check over the same time; nothing of a
trajectory is stored.
"""

from math import fabs, floor, inf
from typing import Any

from lagc.kernels.call_boundary import begin
from lagc.kernels.driver import step_once
from lagc.kernels.integrators.dispatch import has_series
from lagc.kernels.language.vocabulary import *
from lagc.kernels.trajectory import interpolate_at
from lagc.kernels.verification.quantity_errors import (
    BLOCK,
    FINER_SERIES,
    compare_quantities,
    count_near,
    measure_roundoff,
    measure_terms,
    state_quantities,
)

MOST_CHECK_STEPS = 10000  # over one step of the run
KEPT = 7  # times of jumps that are kept for comparison


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
    # The options of this attempt, and the run and its displaced check at the first time.
    o.rtol = v.tolerance
    o.alone = v.alone
    begin(v.run, begin_time, x0)
    displace_check(p, x0, v)
    begin(v.check, begin_time, v.x)
    state_quantities(p, begin_time, x0, v.of_run, v.run_work)
    v.low[:] = v.of_run
    v.high[:] = v.of_run
    # No differences, ranges and errors so far; the initial values are the first ones of each range.
    for i in range(NQUANTITY):
        v.gap[i] = 0.0
        v.near[i] = 0.0
        v.apart[i] = 0.0
        v.scale[i] = 0.0
        v.terms[i] = 0.0
        v.wider_change[i] = 0.0
    for i in range(NQ + NV):
        v.roundoff[i] = 0.0
        v.start[i] = x0[i]
        v.known[i] = 0
        v.rate[i] = inf
        v.varies[i] = 0
    v.begin_time = begin_time
    v.set_out_time = begin_time
    if NZ > 0:
        v.work_error = 0.0
    # Events and jumps are counted from here on in both runs.
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
            if present(outputs):
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
        # The step of the run in which the time lies. States are compared strictly within a step of both runs,
        # where both have passed the same events: an event lies at the end of a step.
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
            v.of_run[:] = v.of_check  # outputs that are not asked for have no error here
            for i in range(NQ + NV):
                v.of_run[i] = states[v.checked][i]
            if NY > 0:
                if present(outputs):
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


def follow_to(p: Params, target: Real, times: Vec[Any], o: Options, states: Rows[NX], outputs: Rows[NY],
              r: Report, v: Verification) -> Status:  # fmt: skip
    """Let the check reach a time, by one step if it is accurate enough, or a clause that ends it; compare the
    recorded times on the way."""
    changes = 0.0
    ended = OK
    before = v.check.steps + v.check.rejected
    while (ended == OK or ended == REDUNDANT) and v.check.t < target:
        # The run leaps over what the check creeps through.
        if v.check.steps + v.check.rejected - before > MOST_CHECK_STEPS:
            return MAX_STEPS
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
    recorded = v.checked
    for i in range(NQUANTITY):
        v.near[i] = 0.0
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
    if v.checked > recorded or final:
        count_near(v)
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
