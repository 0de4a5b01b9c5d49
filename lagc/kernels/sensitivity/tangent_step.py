"""Sensitivities along a motion: steps, and times within them.

A step of the motion is made, then S over it.  If the error of S is above 1, the state is restored and the
step is shorter.  `columns` are the parameters of the directions (-1: an initial value); the
arrays have a row for each direction, `table` has NK; blur and rounding have a second one, of the terms of
constraints.
"""

from math import fabs, inf
from typing import Any

from lagc.kernels.integrators.dispatch import end_rate_row, error_exponent
from lagc.kernels.integrators.roundoff import perturbation_factor
from lagc.kernels.integrators.step_size import rational_power
from lagc.kernels.language.vocabulary import *
from lagc.kernels.sensitivity.tangent_dispatch import (
    method_tangent_dense,
    method_tangent_error,
    method_tangent_extra,
    method_tangent_stages,
)
from lagc.kernels.sensitivity.tangents import (
    direction_rates,
    factor_tangents,
    look_at,
    stay_on_constraints,
    tangent_rates,
)
from lagc.kernels.trajectory import interpolate_at, step

NOISE_FADING = 0.9  # from step to step
SHORTEST = 1e-12  # of the time of the run: a step that is repeated because of S
LEAST_GROWTH = 0.2  # inverse of the largest growth of the longest step for S
ROUNDOFF_STEPS = 10.0  # over which round-off counts in the weights of errors


def load_row(table: Rows[NX], first: Length, count: int, v: TangentWork) -> None:
    """Copy the rates of S of a direction."""
    for j in range(count):
        v.k[j][:] = table[first + j]


def seed(columns: IVec[Any], k: Length, value: Real, v: TangentWork) -> None:
    """Set the direction k in the parameters."""
    if columns[k] >= 0:
        v.seeds[columns[k]] = value


def rates_near(
    other: Params,
    s: State,
    turn: Count,
    columns: IVec[Any],
    k: Length,
    rates: Vec[NX],
    w: Work,
    v: TangentWork,
) -> Status:
    """Compute the rates of S = v.own in direction k at perturbed time, states and accelerations."""

    t = s.t_old * perturbation_factor(turn)
    for i in range(NQ + NV):
        v.x[i] *= perturbation_factor((i + 1) * turn)
    for i in range(NV):
        v.a[i] *= perturbation_factor((i + 2) * turn)
    for i in range(NC):
        v.lam[i] *= perturbation_factor((i + 3) * turn)
    status = factor_tangents(other, t, v.x, w, v)
    if not failed(status):
        seed(columns, k, 1.0, v)
        status = tangent_rates(other, t, v.x, v.own, rates, w, v)
        seed(columns, k, 0.0, v)
    return status


def estimate_noise(
    p: Params, s: State, m: Length, columns: IVec[Any], now: Rows[NX], noise: Rows[NGROUP], w: Work,
    v: TangentWork,
) -> Status:  # fmt: skip
    """Estimate the round-off of the rates of S at the beginning of the last step: their change when time,
    states, accelerations, parameters and S are perturbed by four units in the last place (compare
    `integrators/roundoff`). The state is accepted: a step that is rejected excuses nothing."""
    # The factors of the perturbation differ from step to step, and from number to number.
    turn = 2 * s.steps + 3
    other = params()
    # Parameters are perturbed once for all directions, and what `bind` computes from them follows.
    other[:] = p
    for j in range(NP):
        other[j] *= perturbation_factor((NQ + NV + j + 1) * turn)
    if NPREPARED > 0:
        bind(other)
    v.x[:] = s.x_old
    status = look_at(p, s.t_old, v.x, w, v)
    rates = vector(NX)
    # Each direction: its rates as they are, then with all inputs perturbed; k + 1 needs the factors at the
    # unperturbed state again.
    for k in range(m):
        seed(columns, k, 1.0, v)
        if not failed(status):
            status = tangent_rates(p, s.t_old, v.x, now[k], v.k[0], w, v)
        seed(columns, k, 0.0, v)
        for i in range(NX):
            v.own[i] = now[k][i] * perturbation_factor((i + 4) * turn)
        # The largest change so far in each scaling group, which fades.
        for g in range(NGROUP):
            noise[k][g] *= NOISE_FADING
        if failed(status) or failed(rates_near(other, s, turn, columns, k, rates, w, v)):
            return status
        for i in range(NQ + NV):
            change = fabs(rates[i] - v.k[0][i])
            if change > noise[k][scaling_group[i]]:
                noise[k][scaling_group[i]] = change
        if k + 1 < m:
            v.x[:] = s.x_old
            status = look_at(p, s.t_old, v.x, w, v)
    return status


def project_tangents(
    p: Params, s: State, k: Length, after: Rows[NX], blur: Vec[NGROUP], w: Work, v: TangentWork
) -> None:
    """Project S at the end of the last step onto the tangents of the constraints; `blur` is the round-off of
    that, by a projection of S that is perturbed by four units in the last place."""
    # A projection, and one of a perturbed S: their difference is the round-off of the projection.
    v.own[:] = after[k]
    stay_on_constraints(p, s.t, v.x, v.own, w, v)
    after[k][:] = v.own
    if NC > 0:
        turn = 2 * s.steps + 3
        for i in range(NX):
            v.own[i] *= perturbation_factor((i + 4) * turn)
        stay_on_constraints(p, s.t, v.x, v.own, w, v)
        for i in range(NQ + NV):
            change = fabs(v.own[i] - after[k][i])
            if change > blur[scaling_group[i]]:
                blur[scaling_group[i]] = change


def finish_tangents(
    p: Params, s: State, m: Length, columns: IVec[Any], after: Rows[NX], table: Rows[NX],
    noise: Rows[NGROUP], blur: Rows[NGROUP], w: Work, v: TangentWork,
) -> Status:  # fmt: skip
    """Project S at the end of the last step, and compute its rates there."""
    # At an event S belongs to the state before clauses changed it; the caller applies the jump.
    last = end_rate_row(s.method)
    if NWHEN > 0:
        v.x[:] = s.x_before_event
    else:
        v.x[:] = s.x
    # K is factored at the end of the step, with the accelerations of the motion there.
    if NC > 0 or s.dense_place == OPEN:
        status = look_at(p, s.t, v.x, w, v)
    else:
        v.a[:] = part(s.k[last], NQ, NQ + NV)
        status = factor_tangents(p, s.t, v.x, w, v)
    if failed(status):
        return status
    # In each direction: S on the tangents of the constraints, and its rate there, which the error estimate
    # and the dense output need.
    for k in range(m):
        for g in range(NGROUP):
            blur[k][g] = 0.0
        seed(columns, k, 1.0, v)
        if NC > 0 or NQUAT > 0:
            project_tangents(p, s, k, after, blur[k], w, v)
        # The second half of blur has the round-off of the projection alone.
        blur[m + k][:] = blur[k]
        v.own[:] = after[k]
        status = direction_rates(p, s.t, v.x, v.own, noise[k], table[k * NK + last], w, v)
        seed(columns, k, 0.0, v)
        if failed(status):
            return status
    return OK


def add_blur(
    p: Params, s: State, k: Length, noise: Rows[NGROUP], blur: Rows[NGROUP], w: Work, v: TangentWork
) -> None:
    """Add the round-off of the rates over the step to blur[k], and set v.terms: the perturbation by four
    units in the last place tells how large the terms are that cancel. Round-off of one group reaches others
    by the rates at the end of the step, where K is factored."""
    # Round-off of rates over the step, and of the projection, taken as a perturbation of S: its own rates
    # tell how it spreads between scaling groups.
    h = fabs(s.h_old)
    for i in range(NQ + NV):
        v.own[i] = h * noise[k][scaling_group[i]] + blur[k][scaling_group[i]]
    rates = vector(NX)
    known = tangent_rates(p, s.t, v.x, v.own, rates, w, v) == OK
    largest = vector(NGROUP)
    for g in range(NGROUP):
        largest[g] = noise[k][g]
    for i in range(NQ + NV):
        if known and fabs(rates[i]) > largest[scaling_group[i]]:
            largest[scaling_group[i]] = fabs(rates[i])
    for g in range(NGROUP):
        blur[k][g] += h * largest[g]
        v.terms[g] = h * largest[g] / FOUR_ULPS


def set_tangent_weights(
    s: State, o: Options, k: Length, after: Rows[NX], sizes: Rows[NGROUP], blur: Rows[NGROUP], v: TangentWork
) -> None:
    """Set the weights of the error of S in direction k: rtol times the largest of its scaling group, and
    round-off. The largest is the value so far, the new one, or that of terms that cancel in its change. The
    value of a group that was zero is that over the longest step so far, as for the motion
    (`extend_groups_at_rest`)."""
    # Sizes: value so far, new value, or terms that cancel.
    h = fabs(s.h_old)
    largest = vector(NGROUP)
    for g in range(NGROUP):
        largest[g] = sizes[k][g] if sizes[k][g] > v.terms[g] else v.terms[g]
    for i in range(NQ + NV):
        reach = fabs(after[k][i])
        if sizes[k][scaling_group[i]] == 0.0 and h < v.longest:
            reach *= v.longest / h
        if reach > largest[scaling_group[i]]:
            largest[scaling_group[i]] = reach
    for i in range(NQ + NV):
        own = scaling_group[i]
        v.weights[i] = o.rtol * largest[own] + ROUNDOFF_STEPS * blur[k][own]


def accept_tangents(
    m: Length, after: Rows[NX], sizes: Rows[NGROUP], blur: Rows[NGROUP], rounding: Rows[NGROUP]
) -> None:
    """Raise the sizes of S to its new values, add up its round-off, and raise the terms of constraints that
    cancel in S."""
    for k in range(m):
        for i in range(NQ + NV):
            if fabs(after[k][i]) > sizes[k][scaling_group[i]]:
                sizes[k][scaling_group[i]] = fabs(after[k][i])
        for g in range(NGROUP):
            rounding[k][g] += blur[k][g] + SPACING * sizes[k][g]
            terms = blur[m + k][g] / FOUR_ULPS
            if terms > rounding[m + k][g]:
                rounding[m + k][g] = terms


def begin_following(s: State, w: Work) -> None:
    """Prepare the workspace for evaluations on the branch of the last step."""
    if NC > 0:
        w.rank_deficient = s.rank_deficient
    if NMODE > 0:
        w.modes[:] = s.modes_old
        w.modes_fixed = True


def end_following(w: Work) -> None:
    """Release the workspace."""
    if NMODE > 0:
        w.modes_fixed = False


def follow_step(
    p: Params, s: State, o: Options, m: Length, columns: IVec[Any], repeated: bool, now: Rows[NX],
    after: Rows[NX], table: Rows[NX], sizes: Rows[NGROUP], noise: Rows[NGROUP],
    blur: Rows[NGROUP], w: Work, v: TangentWork,
) -> Status:  # fmt: skip
    """Integrate S over the last step, from `now` to `after`; v.error is the largest scaled error. `repeated`:
    a step from the same state was rejected because of S."""
    v.extra_known = False
    v.error = 0.0
    status = OK
    # Round-off of the rates at the old state, then the stages, then projection and rates at the new one.
    if not repeated:
        status = estimate_noise(p, s, m, columns, now, noise, w, v)
    if not failed(status):
        status = method_tangent_stages(s.method, p, s, m, columns, now, after, table, noise, w, v)
    if not failed(status):
        status = finish_tangents(p, s, m, columns, after, table, noise, blur, w, v)
    if failed(status):
        return status
    # The error estimate of the method, scaled by the weights of each direction.
    for k in range(m):
        add_blur(p, s, k, noise, blur, w, v)
        if o.step == 0.0:
            set_tangent_weights(s, o, k, after, sizes, blur, v)
            load_row(table, k * NK, end_rate_row(s.method) + 1, v)
            error = method_tangent_error(s.method, s.h_old, v)
            if not error <= v.error:
                v.error = error
    return OK


def tangents_there(
    p: Params, s: State, o: Options, t: Real, m: Length, columns: IVec[Any], now: Rows[NX], after: Rows[NX],
    table: Rows[NX], noise: Rows[NGROUP], first: Length, found: Rows[NX], w: Work, v: TangentWork,
) -> Status:  # fmt: skip
    """Evaluate S at a time t within the last step, in found[first] and on."""
    # The extra stages of dense output are made once for a step, at the first time that asks for them.
    status = interpolate_at(s, t, o, v.there, w)
    if not failed(status) and not v.extra_known:
        v.extra_known = True
        status = method_tangent_extra(s.method, p, s, m, columns, now, table, noise, w, v)
    if NC > 0:
        if not failed(status):
            status = factor_tangents(p, t, v.there, w, v)
    if failed(status):
        return status
    # Dense output of S in each direction, then onto the tangents at the interpolated state.
    share = (t - s.t_old) / s.h_old
    for k in range(m):
        method_tangent_dense(s.method, share, s.h_old, k, now, after, table, v.own, v)
        if NC > 0 or NQUAT > 0:
            seed(columns, k, 1.0, v)
            stay_on_constraints(p, t, v.there, v.own, w, v)
            seed(columns, k, 0.0, v)
        found[first + k][:] = v.own
    return OK


def set_pace(status: Status, t1: Real, s: State, o: Options, v: TangentWork) -> bool:
    """Set v.pace, the longest next step, by the error of S in this one; return whether S is accepted."""
    # The controller of the method with a factor of growth of 5 and of reduction of 10.
    h = s.t - s.t_old
    factor = 10.0
    # Accepted: the next step of the motion may be as long as S allows. Rejected: shorter, or given up with a
    # reason if the step is round-off of the run.
    if not failed(status):
        if v.error <= 1.0:
            v.pace = 0.0
            if v.error > 0.0:
                factor = rational_power(v.error, error_exponent(o.method)) / 0.9
                v.pace = h / (LEAST_GROWTH if factor < LEAST_GROWTH else factor if factor < 2.0 else 2.0)
            return True
        if v.error < inf:
            factor = rational_power(v.error, error_exponent(o.method)) / 0.9
    v.pace = h / (factor if factor < 10.0 else 10.0)
    if failed(status) and (o.step > 0.0 or not h > SHORTEST * t1):
        v.reason = 1
    elif not h > SHORTEST * t1:
        v.reason = 2
    return False


def follow_once(
    p: Params, s: State, kept: State, o: Options, longest: Real, t1: Real, m: Length, columns: IVec[Any],
    now: Rows[NX], after: Rows[NX], table: Rows[NX], sizes: Rows[NGROUP], noise: Rows[NGROUP],
    blur: Rows[NGROUP], rounding: Rows[NGROUP], w: Work, v: TangentWork,
) -> Status:  # fmt: skip
    """Make a step of the motion that is not too long for S, and S over it."""
    # A step of the motion is repeated, shorter, until S is accurate over it too.
    fn_copy_state(s, kept)
    v.reason = 0
    repeated = False
    while True:
        # The option max_step carries the limit of S to the motion's own controller.
        o.max_step = v.pace if v.pace > 0.0 and not (longest > 0.0 and longest < v.pace) else longest
        status = step(p, s, t1, o, w)
        v.stepped = s.steps > kept.steps
        if s.longest_step > v.longest:
            v.longest = s.longest_step
        # The motion ended or failed by itself.
        if (status != OK and status != TERMINATED) or not v.stepped:
            return status
        # S runs in the modes of the step, also where the state is behind its event already.
        begin_following(s, w)
        found = follow_step(p, s, o, m, columns, repeated, now, after, table, sizes, noise, blur, w, v)
        if set_pace(found, t1, s, o, v):
            accept_tangents(m, after, sizes, blur, rounding)
            v.steps += 1
            return status
        # Rejected: the state before the step comes back, and the step is made again, shorter.
        end_following(w)
        if v.reason > 0:
            return NOT_FINITE
        v.rejected += 1
        repeated = True
        fn_copy_state(kept, s)


def record_tangents(
    p: Params, s: State, o: Options, times: Vec[Any], n: Length, done: Cell[Length], m: Length,
    columns: IVec[Any], now: Rows[NX], after: Rows[NX], table: Rows[NX], noise: Rows[NGROUP],
    found: Rows[NX], w: Work, v: TangentWork,
) -> Status:  # fmt: skip
    """Write S at the times within the last step to `found`, m rows for each time, and make it the present
    one."""
    # Times within the step by dense output, before S moves on; times at its end are S itself.
    status = OK
    while not failed(status) and done[0] < n and times[done[0]] < s.t:
        status = tangents_there(
            p, s, o, times[done[0]], m, columns, now, after, table, noise, done[0] * m, found, w, v
        )
        if not failed(status):
            done[0] += 1
    for k in range(m):
        now[k][:] = after[k]
    while not failed(status) and done[0] < n and times[done[0]] == s.t:
        for k in range(m):
            found[done[0] * m + k][:] = now[k]
        done[0] += 1
    return status


@public
def follow(
    p: Params, s: State, kept: State, o: Options, longest: Real, times: Vec[Any], n: Length,
    done: Cell[Length], m: Length, columns: IVec[Any], now: Rows[NX], after: Rows[NX], table: Rows[NX],
    sizes: Rows[NGROUP], noise: Rows[NGROUP], blur: Rows[NGROUP], rounding: Rows[NGROUP], found: Rows[NX],
    budget: Count,
    w: Work, v: TangentWork,
) -> Status:  # fmt: skip
    """Integrate the motion and its derivatives S in m directions to times[n-1]; S at times[k] is found[k*m]
    and on. `longest`: the longest step, 0 for no limit. Returns INTERRUPTED after `budget` steps and after
    each step that ends at an event, where the caller changes S. The arrays have a row for each direction,
    table has 16; blur and rounding have m more, for the terms of constraints that cancel in S."""
    # One step of both after the other. A caller changes S where modes change, so each such step returns.
    count: Count = 0
    while s.t < times[n - 1]:
        if count == budget:
            return INTERRUPTED
        count += 1
        if NMODE > 0:
            changes = s.changes
        status = follow_once(
            p,
            s,
            kept,
            o,
            longest,
            times[n - 1],
            m,
            columns,
            now,
            after,
            table,
            sizes,
            noise,
            blur,
            rounding,
            w,
            v,
        )
        if v.stepped and (status == OK or status == TERMINATED):
            recorded = record_tangents(
                p, s, o, times, n, done, m, columns, now, after, table, noise, found, w, v
            )
            end_following(w)
            if failed(recorded):
                v.reason = 1
                return recorded
        if status != OK:
            return status
        if NMODE > 0:
            if s.changes != changes:
                return INTERRUPTED
    return OK


@public
def event_facts(
    s: State, w: Work, modes: Vec[NMODE], modes_old: Vec[NMODE], crossed: IVec[NMODE], jumped: IVec[NMODE]
) -> None:
    """Copy the modes after and before the last step, the relations that changed there, and those that
    changed with others."""
    modes[:] = s.modes
    modes_old[:] = s.modes_old
    crossed[:] = w.events.crossed
    jumped[:] = w.events.jumped
