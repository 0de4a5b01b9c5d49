"""What a call finds and leaves: where a trajectory is, and what the caller has changed since."""

from __future__ import annotations

from lagc.kernels.dynamics.rhs import factor_safely, rhs_at
from lagc.kernels.events.modes import take
from lagc.kernels.events.when_clauses import set_out
from lagc.kernels.integrators.dispatch import last
from lagc.kernels.language.records import NOWHERE, READY, STAGES, State, Work
from lagc.kernels.language.scaling_groups import enlarge
from lagc.kernels.language.sizes import NC, NKIND, NMODE, NP, NWHEN, NX, STRAIGHT
from lagc.kernels.language.statuses import CHATTERING, INTERRUPTED, MISPLACED, OK, STEP_UNDERFLOW, failed
from lagc.kernels.language.words import Params, Real, Status, Vec, public


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
    s.known = False
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
    if NMODE > 0:
        s.changes = 0
        s.changes_here = 0
        s.t_changed = t
        for i in range(NX):
            s.jolts[i] = 0.0
        for k in range(NMODE):
            s.slack[k] = 0.0
        s.fresh = False
        s.halved = False
        s.rough = 0.0
        s.little = 0.0
    if NWHEN > 0:
        s.acquainted = False
        s.jumps = 0
        s.x_left[:] = x


def enter(s: State, w: Work) -> None:
    """What a call finds: the workspace as this state left its own."""
    s.called = True
    s.entered = s.steps + s.rejected
    if NC > 0:
        w.lost = s.lost
    if NMODE > 0:
        w.held = True


def leave(s: State, status: Status, w: Work) -> Status:
    """What a call leaves: where the last step ended."""
    if status != OK and status != INTERRUPTED:
        s.rate = NOWHERE
    if not s.called:
        s.t_seen = s.t
        s.x_seen[:] = s.x
    if NC > 0:
        s.lost = w.lost
    if NMODE > 0:
        w.held = False
    return status


def stop(s: State, status: Status, w: Work) -> Status:
    if failed(status) and status < STEP_UNDERFLOW:
        s.culprit = w.culprit
    if NMODE > 0:
        if status == CHATTERING or status == MISPLACED:
            s.culprit = w.culprit
    return status


def state_changed(s: State) -> bool:
    """Whether the caller has changed the state since the last step, or there is none."""
    if not s.known or s.t != s.t_seen:
        return True
    for i in range(NX):
        if not s.x[i] == s.x_seen[i]:
            return True
    return False


def parameters_changed(p: Params, s: State) -> bool:
    """Whether the caller has changed parameters since the last step."""
    for k in range(NP):
        if not p[k] == s.p[k]:
            return True
    return False


def keep_parameters(p: Params, s: State) -> None:
    """What the caller has given is known from here on."""
    if s.called:
        s.p[:] = p
        s.known = True
        s.called = False


def depart(p: Params, s: State, direction: Real, w: Work) -> Status:
    """The rate at the start of a step, and the branch of it."""
    again = False
    if NMODE > 0:
        elsewhere = False
    if s.called:
        if state_changed(s):
            again = True
            if NMODE > 0:
                elsewhere = True
            s.stride = 0.0
            s.recalled = 0.0
            enlarge(s.x, s.sizes)
            if NC > 0:
                w.lost = False
                if STRAIGHT:
                    factor_safely(p, s.t, s.x, w)  # straight factors need not show dependent rows
                    w.fallbacks -= 1
        else:
            again = parameters_changed(p, s)
    if NMODE > 0:
        if again:
            s.rate = STAGES
            return set_out(p, s, direction, elsewhere, w)
        w.modes[:] = s.modes
        take(w)
    status = OK
    if again or s.rate == NOWHERE:
        status = rhs_at(p, s.t, s.x, s.k[0], w.lam, w)
        s.rhs += 1
        if failed(status):
            return status
    elif s.rate == READY:
        s.k[0][:] = s.k[last(s.method)]
    s.rate = STAGES
    return OK
