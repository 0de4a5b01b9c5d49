"""Clauses `when`: what is done at the moment that a condition becomes true.

Those that become true at one moment act in their order, each on the state that the one before has left.
What they do may make others true, which act after them.
"""

from __future__ import annotations

from math import fabs, inf

from lagc.kernels.constraints.projection import project
from lagc.kernels.dynamics.rhs import rhs_at
from lagc.kernels.events.location import SEVERAL, smear
from lagc.kernels.events.mode_change import change, is_little
from lagc.kernels.events.modes import adopt_modes, choose_branch, keep_branch, nudge_mode, take
from lagc.kernels.events.sliding import late, turns_back
from lagc.kernels.language.model import (
    fn_energies,
    fn_holds_on,
    fn_modes,
    fn_reinit,
    fn_side_rates_on,
    fn_sides_on,
)
from lagc.kernels.language.records import NOWHERE, State, Work
from lagc.kernels.language.scaling_groups import enlarge, not_finite
from lagc.kernels.language.sizes import NACTS, NC, NFREE, NJUMP, NMODE, NQ, NQUAT, NTIMED, NV, NWHEN, NX, NZ
from lagc.kernels.language.statuses import CHATTERING, MISPLACED, OK, TERMINATED, failed
from lagc.kernels.language.tables import clause, counted, ending, kind, target
from lagc.kernels.language.words import Params, Real, Status

MANY_TIMES = 1e5
MISSED = 1e-6  # of the sizes of states: what constraints move new values by is no rounding


def come_true(p: Params, s: State, w: Work) -> bool:
    """Whether conditions do, in w.due."""
    found = False
    fn_holds_on(p, s.t, s.x, w.modes, w.holds)
    for k in range(NWHEN):
        w.due[k] = 1 if w.holds[k] > s.held[k] else 0
        s.held[k] = w.holds[k]
        if w.due[k] > 0:
            found = True
    return found


def last_giver(w: Work) -> int:
    """The last of the clauses in w.due that gives new values; -1."""
    found = -1
    for j in range(NJUMP):
        if w.due[clause[j]] > 0:
            found = clause[j]
    return found


def give(p: Params, s: State, k: int, w: Work) -> bool:
    """The new values of clause k; whether there are any."""
    found = False
    fn_reinit(p, s.t, s.x, w.fresh_values)
    for j in range(NJUMP):
        if clause[j] == k:
            s.x[target[j]] = w.fresh_values[j]
            found = True
    return found


def meets_constraints(p: Params, s: State, w: Work) -> bool:
    """Whether new values do, but for rounding, which is taken away."""
    w.landed[:] = s.x
    if failed(project(p, s.t, s.x, s.sizes, w)):
        return False
    for i in range(NQ + NV):
        if not fabs(s.x[i] - w.landed[i]) <= MISSED * s.sizes[kind[i]]:
            return False
    return True


def land(p: Params, s: State, direction: Real, w: Work) -> Status:
    """The branch on from a state that has jumped, and its rates, in w.xdot.  w.beside: its sides before."""
    w.left_sides[:] = w.beside
    adopt_modes(p, s, w)
    status = rhs_at(p, s.t, s.x, w.xdot, w.lam, w)
    s.rhs += 1
    if failed(status):
        return status
    fn_sides_on(p, s.t, s.x, w.modes, w.sides)
    fn_side_rates_on(p, s.t, s.x, w.modes, w.xdot, w.turning)
    for i in range(NTIMED):
        if w.jumped[i] > 0:
            nudge_mode(i, direction, 0.0, w, s.t)
    if NFREE > 0:
        smear(p, s, s.x, w)
        for j in range(NFREE):
            k = NTIMED + j
            if w.jumped[k] > 0:
                w.shifted[j] = 1
            beyond = w.crossed[k] > 0 and w.shifted[j] == 0 and counted[k] == 0
            nudge_mode(k, direction, inf if beyond else SEVERAL * w.blurs[j], w, s.t)
    take(w)
    status = rhs_at(p, s.t, s.x, w.xdot, w.lam, w)
    s.rhs += 1
    return status


def move_by(s: State, time: Real, w: Work) -> None:
    if time != 0.0:
        for i in range(NX):
            s.x[i] += time * w.xdot[i]


def let_go(p: Params, s: State, direction: Real, w: Work) -> Status:
    """Conditions that hold no longer after one clause may become true by the next."""
    status = land(p, s, direction, w)
    if not failed(status):
        fn_holds_on(p, s.t, s.x, w.modes, w.holds)
        for k in range(NWHEN):
            if w.holds[k] < s.held[k]:
                s.held[k] = w.holds[k]
    return status


def jump(p: Params, s: State, giver: int, direction: Real, w: Work) -> Status:
    """The clauses in w.due, of which `giver` is the last that does, give new values; what the energy gains by
    it is work that is done."""
    fn_sides_on(p, s.t, s.x, w.modes, w.beside)
    if NZ > 0:
        fn_energies(p, s.t, s.x, w.energies)
        before = w.energies[2]
    given = 0
    for k in range(giver + 1):
        if w.due[k] > 0 and give(p, s, k, w):
            given += 1
            if not_finite(s.x, NX) >= 0:
                w.culprit = k
                return MISPLACED
            if k < giver:
                status = let_go(p, s, direction, w)
                if failed(status):
                    return status
    enlarge(s.x, s.sizes)
    if NC > 0 or NQUAT > 0:
        if not meets_constraints(p, s, w):
            w.culprit = giver
            return MISPLACED
    if NZ > 0:
        fn_energies(p, s.t, s.x, w.energies)
        s.x[NX - 1] += w.energies[2] - before
    status = land(p, s, direction, w)
    if not failed(status):
        s.jumps += given
    return status


def told_apart(p: Params, s: State, direction: Real, w: Work) -> bool:
    """Whether the sides of the switches in w.crossed go where these have changed to, and have been somewhere
    else since they changed last: what comes back within the last places of the time or of a state, as bounces
    that are ever shorter, has not got anywhere."""
    if NFREE > 0:
        smear(p, s, s.x, w)
        for j in range(NFREE):
            k = NTIMED + j
            if w.crossed[k] > 0 and w.jumped[k] == 0:
                way = fabs(w.before[k]) * fabs(s.t - s.came[j])
                if way <= SEVERAL * w.blurs[j] or turns_back(k, w.before[k], w.before[k], direction, w):
                    return False
    return True


def blame(w: Work) -> Status:
    """Clauses act without end."""
    for k in range(NWHEN):
        if w.due[k] > 0:
            w.culprit = NMODE + k
    return CHATTERING


def act_in_turn(p: Params, s: State, direction: Real, since: Real, w: Work) -> Status:
    """The clauses whose conditions come true, and those that these make true.  Before the first new values
    the state goes back by `since`; w.went tells whether it has."""
    ended = OK
    while come_true(p, s, w):
        if s.acts == 0 and not told_apart(p, s, direction, w):
            return blame(w)
        for k in range(NWHEN):
            if w.due[k] > 0:
                if s.acts == NACTS:
                    return blame(w)
                s.acted[s.acts] = k
                s.acts += 1
                if ending[k] > 0 and ended == OK:
                    s.culprit = k
                    ended = TERMINATED
        if NJUMP > 0:
            giver = last_giver(w)
            if giver >= 0:
                if not w.went:
                    w.went = True
                    move_by(s, -since, w)
                    s.t -= since
                status = jump(p, s, giver, direction, w)
                if failed(status):
                    return status
    return ended


def act(p: Params, s: State, direction: Real, since: Real, w: Work) -> Status:
    """The clauses whose conditions come true at (s.t, s.x), `since` after they did: what they do is done at
    the time of then, and the motion goes on from it to now.  Rates are in w.xdot."""
    for j in range(NFREE):
        w.shifted[j] = 0
    s.acts = 0
    now = s.t
    w.went = False
    status = act_in_turn(p, s, direction, since, w)
    s.t = now
    if w.went and (status == TERMINATED or not failed(status)):
        move_by(s, since, w)
        fn_sides_on(p, s.t, s.x, w.modes, w.sides)
        keep_branch(s, w)
        s.rate = NOWHERE
    return status


def since_change(s: State, direction: Real, w: Work) -> Real:
    """What the first switch in w.crossed is late by, where that is rounding."""
    for k in range(NMODE):
        if w.crossed[k] > 0:
            since = late(k, direction, w)
            return since if is_little(since, s) else 0.0
    return 0.0


def remember(s: State, w: Work) -> None:
    """What is there before anything is done."""
    w.x_before[:] = s.x
    w.held_before[:] = s.held
    w.modes_before[:] = s.modes
    w.slack_before[:] = s.slack


def undo(s: State, w: Work) -> None:
    """Nothing is done that cannot be: another call comes to it again."""
    s.x[:] = w.x_before
    s.held[:] = w.held_before
    s.modes[:] = w.modes_before
    s.slack[:] = w.slack_before


def follow_up(s: State, w: Work) -> None:
    """When each switch has changed; of one that changes ever sooner, as by bounces, no change is stepped
    over: the next step is no longer than many times what lies between the last two."""
    for j in range(NFREE):
        if w.crossed[NTIMED + j] > 0:
            since = fabs(s.t - s.came[j])
            if since > 0.0 and s.h > MANY_TIMES * since:
                s.h = MANY_TIMES * since
            s.came[j] = s.t


def pass_change(p: Params, s: State, direction: Real, w: Work) -> Status:
    """The switches in w.crossed change at (s.t, s.x), and what is to be done then is done."""
    if NWHEN > 0:
        remember(s, w)
    status = change(p, s, direction, w)
    if NWHEN > 0:
        if status == OK:
            status = act(p, s, direction, since_change(s, direction, w), w)
            if failed(status) and status != TERMINATED:
                undo(s, w)
            else:
                follow_up(s, w)
    return status


def rejoin(p: Params, s: State, direction: Real, w: Work) -> Status:
    """The branch on from a state that is as it was, where parameters or inputs are others: sides that these
    move take the modes that they tell."""
    w.modes[:] = s.modes
    take(w)
    fn_sides_on(s.p, s.t, s.x, w.modes, w.beside)
    w.left_sides[:] = w.beside
    adopt_modes(p, s, w)
    s.rhs += 1
    status = rhs_at(p, s.t, s.x, s.k[0], w.lam, w)
    if failed(status):
        return status
    fn_sides_on(p, s.t, s.x, w.modes, w.sides)
    keep_branch(s, w)
    return status


def set_out(p: Params, s: State, direction: Real, elsewhere: bool, w: Work) -> Status:
    """The branch on from where a call begins, `elsewhere` than the last one ended, and what is to be done
    there: conditions that hold at the start of a trajectory do not become true."""
    if NWHEN > 0:
        if not s.acquainted:
            fn_modes(p, s.t, s.x, w.modes)
            take(w)
            fn_holds_on(p, s.t, s.x, w.modes, s.held)
            s.acquainted = True
            for j in range(NFREE):
                s.came[j] = -inf
        remember(s, w)
        if elsewhere:
            status = choose_branch(p, s, direction, w)
        else:
            status = rejoin(p, s, direction, w)
        if status != OK:
            return status
        for k in range(NMODE):
            w.crossed[k] = 0
        w.xdot[:] = s.k[0]
        status = act(p, s, direction, 0.0, w)
        if failed(status) and status != TERMINATED:
            undo(s, w)
            return status
        if s.acts > 0:
            for i in range(NMODE):
                s.changed[i] = 0
            s.fresh = True
            s.changes += 1
        return status
    return choose_branch(p, s, direction, w)
