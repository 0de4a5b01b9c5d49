"""One step after the other."""

from __future__ import annotations

from math import fabs

from lagc.kernels.call_boundary import depart, keep_parameters, stop
from lagc.kernels.constraints.projection import project
from lagc.kernels.dynamics.rhs import rhs_at
from lagc.kernels.events.enclosing import NONE
from lagc.kernels.events.location import (
    LEAST_SLACK,
    MOST_SLACK,
    all_but_changes,
    any_due,
    draw_tight,
    first_change,
    next_change,
    only_seem,
)
from lagc.kernels.events.step_guards import first_hidden
from lagc.kernels.events.when_clauses import pass_change
from lagc.kernels.integrators.dispatch import last, method_error, method_stages, uses_new
from lagc.kernels.integrators.error_norm import first_step, weigh_errors
from lagc.kernels.integrators.roundoff import forget, reconsider
from lagc.kernels.integrators.step_size import adapt, plan, raised, retreat, too_small
from lagc.kernels.language.records import NOWHERE, READY, STAGES, Options, State, Trial, Work
from lagc.kernels.language.scaling_groups import enlarge, not_finite
from lagc.kernels.language.sizes import NC, NFREE, NHIDE, NMODE, NQUAT, NTIMED, NWHEN, NX
from lagc.kernels.language.statuses import CHATTERING, MAX_STEPS, NOT_FINITE, OK, STEP_UNDERFLOW, failed
from lagc.kernels.language.tolerances import LEAST_STEP, SPACING
from lagc.kernels.language.words import Params, Real, Status

LEAST_SHRUNK = 0.1  # of a step that hides something from its beginning on: how long the next is tried
MOST_SHRUNK = 40  # times
ROUGH = 10.0  # of a step, times the tolerance
LITTLE = 0.1  # of a step, times the root of the tolerance
SHORT = 1e6  # last places of the time: of a step that has no error
FAR_TOO_LONG = 100.0  # the error of a step that tells little of how long it should be


def arrive(p: Params, s: State, t: Real, o: Options, w: Work) -> Status:
    """Project the new state and evaluate there."""
    if NC > 0 or NQUAT > 0:
        if o.project:
            status = project(p, t, s.y, w.reached, w)
            if failed(status):
                return status
            if w.position_left > s.position_drift:
                s.position_drift = w.position_left
            if w.velocity_left > s.velocity_drift:
                s.velocity_drift = w.velocity_left
    w.culprit = not_finite(s.y, NX)  # also of what no equation depends on
    if w.culprit >= 0:
        return NOT_FINITE
    s.rhs += 1
    return rhs_at(p, t, s.y, s.k[last(o.method)], w.lam, w)


def try_step(p: Params, s: State, o: Options, a: Trial, w: Work) -> Status:
    """Stages, error and arrival; a.error <= 1 where the step is accepted."""
    a.error = 0.0
    status = method_stages(o.method, p, s.t, s.x, a.h, s, w)
    s.rhs += last(o.method) - 1
    if failed(status):
        return status
    weigh_errors(s, o, a.h, w)
    if uses_new(o.method) or o.step > 0.0:
        status = arrive(p, s, a.t_new, o, w)
        if failed(status) or o.step > 0.0:
            return status
    a.error = method_error(o.method, a.h, s, w)
    a.heard = a.error > 1.0 and (a.rejected > 0 or s.listening or s.recalled > 0.0)
    if a.heard:
        a.error = reconsider(p, s, a.t_new, a.h, o, a.error, w)
    if a.error <= 1.0 and not uses_new(o.method):
        return arrive(p, s, a.t_new, o, w)
    return status


def stop_short(p: Params, s: State, o: Options, a: Trial, w: Work) -> Status:
    """Where a switch changes within the step, the step once more, to end there; a.h is 0 where that is at its
    beginning, and the switch has changed."""
    draw_tight(p, s, w)
    much = LEAST_SLACK
    part = first_change(p, s, o.method, a, w)
    while part >= 0.0 and part < NONE and much < MOST_SLACK and only_seem(p, s, o.method, part, much, a, w):
        much *= 2.0
        part = first_change(p, s, o.method, a, w)
    if part < 0.0:
        return NOT_FINITE
    if part > 1.0:
        a.meets = False
        return OK
    a.meets = True
    a.half = False
    a.whole = a.size
    a.size *= part
    a.h *= part
    a.lands = False
    a.t_new = s.t + a.h
    w.longest = s.longest
    if fabs(a.h) <= 4.0 * SPACING * fabs(s.t) + LEAST_STEP * a.whole:
        a.h = 0.0
        keep_parameters(p, s)
        return pass_change(p, s, a.direction, w)
    return try_step(p, s, o, a, w)


def ends_early(a: Trial) -> bool:
    """Whether a fixed step ends before its end: where a switch changes."""
    if NMODE > 0:
        return a.lands or a.meets
    return a.lands


def accept(p: Params, s: State, t1: Real, o: Options, a: Trial, w: Work) -> None:
    """The state moves on."""
    if o.step > 0.0:
        if a.lands and a.t_new == t1:
            s.grid = t1
            s.on_grid = 0
        elif not ends_early(a):
            s.on_grid += 1
    else:
        s.stride = 0.0
        adapt(s, a, o)
    keep_parameters(p, s)
    s.method = o.method
    s.steps += 1
    s.t_old = s.t
    s.h_old = a.h
    s.t = a.t_new
    s.x_old[:] = s.x
    s.x[:] = s.y
    if NWHEN > 0:
        s.x_left[:] = s.y
    enlarge(s.y, s.sizes)
    s.listening = a.heard
    s.rate = READY
    s.dense = STAGES
    if NMODE > 0:
        s.modes_old[:] = w.modes
        s.fresh = False
        s.halved = a.half
        s.rough = ROUGH * o.rtol * fabs(a.h)
        s.little = LITTLE * raised(o.rtol, 0.5) * fabs(a.h)


def size_up(p: Params, s: State, t1: Real, o: Options, a: Trial, w: Work) -> None:
    """How long a step is tried."""
    if s.h == 0.0:
        if o.step > 0.0:
            s.h = o.step
        elif o.first_step > 0.0:
            s.h = o.first_step
        else:
            s.h = first_step(p, s, t1, a.direction, o, w)
    if o.step > 0.0 and s.stride != o.step * a.direction:  # the grid begins here
        s.stride = o.step * a.direction
        s.grid = s.t
        s.on_grid = 0
    a.size = o.max_step if o.max_step > 0.0 and s.h > o.max_step else s.h


def starts_anew(p: Params, s: State, t1: Real, o: Options, a: Trial, w: Work) -> bool:
    """Whether the first step after a switch has changed is to be as short as that of a motion which begins
    there: it was far too long."""
    if s.fresh and a.rejected == 0 and a.error > FAR_TOO_LONG and o.first_step == 0.0:
        size = first_step(p, s, t1, a.direction, o, w)
        if size < a.size:
            a.size = size
            return True
    return False


def fall_back(p: Params, s: State, t1: Real, o: Options, a: Trial, w: Work) -> None:
    """After an error above 1."""
    if NMODE > 0:
        if starts_anew(p, s, t1, o, a, w):
            return
    retreat(a, o)


def is_short(s: State, t1: Real, size: Real) -> bool:
    return size <= SHORT * SPACING * (fabs(s.t) + fabs(t1 - s.t))


def halve_to(s: State, goal: Real, t1: Real, o: Options, a: Trial) -> None:
    """A step that would end at a given time, or leave less than itself to it, is made in two halves: of two
    runs that have the same steps there one errs by much less, else their difference would tell nothing."""
    rest = fabs(goal - s.t)
    if not o.halves or o.step > 0.0 or s.halved or a.half or 2.0 * a.size < rest or is_short(s, t1, rest):
        return
    a.size = 0.5 * rest
    a.half = True
    a.lands = False
    a.h = a.size * a.direction
    a.t_new = s.t + a.h


def is_halved(s: State, t1: Real, o: Options, a: Trial) -> bool:
    """Whether a step that ends where switches change is to be made in two."""
    if not (o.halves and a.meets and a.error > 0.0 and o.step == 0.0) or s.halved or is_short(s, t1, a.size):
        return False
    a.size *= 0.5
    a.half = True
    a.meets = False
    return True


def look_back(s: State, a: Trial, w: Work) -> None:
    """The longest step so far, s.longest; and w.longest, in another attempt or half of one."""
    if a.rejected == 0 and a.size > s.longest:
        s.longest = a.size
    w.longest = s.longest if a.rejected > 0 else 0.0
    if NMODE > 0:
        if a.half:
            w.longest = s.longest


def step_once(p: Params, s: State, t1: Real, o: Options, w: Work) -> Status:
    """One step towards t1, at most to it, and then exactly."""
    if s.dense == STAGES:
        s.dense = NOWHERE  # other stages take their place
    a = Trial()
    a.direction = 1.0 if t1 >= s.t else -1.0
    if NWHEN > 0:
        changes = s.changes
    status = depart(p, s, a.direction, w)
    if failed(status):
        return stop(s, status, w)
    if NWHEN > 0:
        if s.changes > changes:
            keep_parameters(p, s)
            return OK
    size_up(p, s, t1, o, a, w)
    forget(s, w)
    goal = t1
    if NTIMED > 0:
        goal = next_change(p, s, t1, a.direction, w)
        if goal == s.t:
            if t1 == s.t and not any_due(w):
                return OK
            keep_parameters(p, s)
            return stop(s, pass_change(p, s, a.direction, w), w)
    cause = OK
    if NHIDE > 0:
        shrunk = 0
    while True:
        if o.max_steps > 0 and s.steps + s.rejected - s.entered >= o.max_steps:
            if a.rejected > 0:
                s.h = a.size
            return MAX_STEPS
        plan(s, goal, o, a)
        if NMODE > 0:
            halve_to(s, goal, t1, o, a)
        look_back(s, a, w)
        if too_small(s, t1, a):
            if NFREE > 0:
                if cause != OK and all_but_changes(p, s, a.direction, w):
                    keep_parameters(p, s)
                    return stop(s, pass_change(p, s, a.direction, w), w)
            return stop(s, cause if cause != OK else STEP_UNDERFLOW, w)
        status = try_step(p, s, o, a, w)
        if NHIDE > 0:
            if not failed(status) and a.error <= 1.0 and o.step == 0.0 and shrunk < MOST_SHRUNK:
                hidden = first_hidden(p, s, o.method, a, o.rtol, w)
                if hidden < 1.0:
                    a.size *= hidden if hidden > LEAST_SHRUNK else LEAST_SHRUNK
                    s.rejected += 1
                    shrunk += 1
                    continue
        if NFREE > 0:
            if not failed(status) and a.error <= 1.0:
                status = stop_short(p, s, o, a, w)
                if status == CHATTERING or a.h == 0.0:
                    return stop(s, status, w)
        if failed(status):
            if o.step > 0.0:
                return stop(s, status, w)
            cause = status
            a.size *= 0.25
        elif a.error <= 1.0:
            if NMODE > 0:
                if is_halved(s, t1, o, a):
                    s.rejected += 1
                    continue
            break
        else:
            cause = OK
            fall_back(p, s, t1, o, a, w)
        a.rejected += 1
        s.rejected += 1
    accept(p, s, t1, o, a, w)
    if NMODE > 0:
        due = a.lands and goal != t1
        if NWHEN > 0:
            if a.lands and goal == t1 and any_due(w):
                due = True
        if a.meets or due:
            return stop(s, pass_change(p, s, a.direction, w), w)
    return OK
