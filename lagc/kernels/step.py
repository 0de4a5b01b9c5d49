"""One step after the other."""

from __future__ import annotations

from lagc.kernels.control import adapt, plan, retreat, too_small
from lagc.kernels.kinds import enlarge
from lagc.kernels.listening import forget, reconsider
from lagc.kernels.method import last, method_error, method_stages, uses_new
from lagc.kernels.projection import project
from lagc.kernels.records import NOWHERE, READY, STAGES, Options, State, Trial, Work
from lagc.kernels.rhs import factor_dense, rhs_at
from lagc.kernels.sizes import NC, NKIND, NP, NQUAT, NX, STRAIGHT
from lagc.kernels.statuses import INTERRUPTED, MAX_STEPS, OK, STEP_UNDERFLOW, failed
from lagc.kernels.weights import first_step, weigh_errors
from lagc.kernels.words import Params, Real, Status, Vec, public


@public
def begin(s: State, t: Real, x: Vec[NX]) -> None:
    """A new trajectory from (t, x); x meets the constraints.  *s need not be filled before."""
    s.t = t
    s.t_old = t
    s.t_seen = t
    s.x[:] = x
    s.x_old[:] = x
    s.x_seen[:] = x
    for i in range(NKIND):
        s.sizes[i] = 0.0
    enlarge(x, s.sizes)
    s.h_old = 0.0
    s.h = 0.0
    s.error_old = 1e-4
    s.grid = t
    s.stride = 0.0
    s.position_drift = 0.0
    s.velocity_drift = 0.0
    s.on_grid = 0
    s.steps = 0
    s.rejected = 0
    s.rhs = 0
    s.entered = 0
    s.called = True
    s.method = 0
    s.rate = NOWHERE
    s.dense = NOWHERE
    if NC > 0:
        s.lost = False
    s.listening = False
    s.recalled = 0.0
    for i in range(NX):
        s.noise[i] = 0.0
    s.longest = 0.0
    s.culprit = -1


def enter(s: State, w: Work) -> None:
    """What a call finds: the workspace as this state left its own."""
    s.called = True
    s.entered = s.steps + s.rejected
    if NC > 0:
        w.lost = s.lost


def leave(s: State, status: Status, w: Work) -> Status:
    """What a call leaves: where the last step ended."""
    if status != OK and status != INTERRUPTED:
        s.rate = NOWHERE
    if not s.called:
        s.t_seen = s.t
        s.x_seen[:] = s.x
    if NC > 0:
        s.lost = w.lost
    return status


def stop(s: State, status: Status, w: Work) -> Status:
    if failed(status) and status < STEP_UNDERFLOW:
        s.culprit = w.culprit
    return status


def state_changed(s: State) -> bool:
    """Whether the caller has changed the state since the last step."""
    if s.h == 0.0 or s.t != s.t_seen:
        return True
    for i in range(NX):
        if not s.x[i] == s.x_seen[i]:
            return True
    return False


def parameters_changed(p: Params, s: State) -> bool:
    """Whether the rate at the state is to be found once more: the caller has changed parameters."""
    if s.rate == NOWHERE:
        return True
    for k in range(NP):
        if not p[k] == s.p[k]:
            return True
    return False


def depart(p: Params, s: State, w: Work) -> Status:
    """The rate at the start of a step."""
    again = False
    if s.called:
        if state_changed(s):
            again = True
            s.stride = 0.0
            s.recalled = 0.0
            enlarge(s.x, s.sizes)
            if NC > 0:
                w.lost = False
                if STRAIGHT:
                    factor_dense(p, s.t, s.x, w)  # straight factors need not show dependent rows
                    w.fallbacks -= 1
        else:
            again = parameters_changed(p, s)
    status = OK
    if again:
        status = rhs_at(p, s.t, s.x, s.k[0], w.lam, w)
        s.rhs += 1
        if failed(status):
            return status
    elif s.rate == READY:
        s.k[0][:] = s.k[last(s.method)]
    s.rate = STAGES
    return OK


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
        a.error = reconsider(p, s, a.t_new, a.h, o, a.error, a.rejected, w)
    if a.error <= 1.0 and not uses_new(o.method):
        return arrive(p, s, a.t_new, o, w)
    return status


def accept(p: Params, s: State, t1: Real, o: Options, a: Trial) -> None:
    """The state moves on."""
    if o.step > 0.0:
        s.grid = t1 if a.lands else s.grid
        s.on_grid = 0 if a.lands else s.on_grid + 1
    else:
        s.stride = 0.0
        adapt(s, a, o)
    if s.called:
        s.p[:] = p
        s.called = False
    s.method = o.method
    s.steps += 1
    s.t_old = s.t
    s.h_old = a.h
    s.t = a.t_new
    s.x_old[:] = s.x
    s.x[:] = s.y
    enlarge(s.y, s.sizes)
    s.listening = a.heard
    s.rate = READY
    s.dense = STAGES


def step_once(p: Params, s: State, t1: Real, o: Options, w: Work) -> Status:
    """One step towards t1, at most to it, and then exactly."""
    if s.dense == STAGES:
        s.dense = NOWHERE  # other stages take their place
    a = Trial()
    a.direction = 1.0 if t1 >= s.t else -1.0
    status = depart(p, s, w)
    if failed(status):
        return stop(s, status, w)
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
    forget(s, w)
    a.size = o.max_step if o.max_step > 0.0 and s.h > o.max_step else s.h
    cause = OK
    while True:
        if o.max_steps > 0 and s.steps + s.rejected - s.entered >= o.max_steps:
            if a.rejected > 0:
                s.h = a.size
            return MAX_STEPS
        plan(s, t1, o, a)
        if a.rejected == 0 and a.size > s.longest:
            s.longest = a.size
        w.longest = s.longest if a.rejected > 0 else 0.0
        if too_small(s, t1, a):
            return stop(s, cause if cause != OK else STEP_UNDERFLOW, w)
        status = try_step(p, s, o, a, w)
        if failed(status):
            if o.step > 0.0:
                return stop(s, status, w)
            cause = status
            a.size *= 0.25
        elif a.error <= 1.0:
            break
        else:
            cause = OK
            retreat(a, o)
        a.rejected += 1
        s.rejected += 1
    accept(p, s, t1, o, a)
    return OK
