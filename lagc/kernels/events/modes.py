"""The branch of a step: the modes of switches, in which the sides of these are."""

from __future__ import annotations

from math import fabs, inf

from lagc.kernels.dynamics.rhs import rhs_at
from lagc.kernels.language.model import fn_edges_on, fn_modes, fn_own_on, fn_side_rates_on, fn_sides_on
from lagc.kernels.language.records import State, Work
from lagc.kernels.language.sizes import NEDGES, NMODE, NX
from lagc.kernels.language.statuses import failed
from lagc.kernels.language.tables import counted
from lagc.kernels.language.tolerances import NO_EDGE, SPACING
from lagc.kernels.language.words import Params, Real, Status, Vec


def sign_of(a: Real) -> Real:
    if a > 0.0:
        return 1.0
    return -1.0 if a < 0.0 else 0.0


def take(w: Work) -> None:
    """What goes with the modes.  Outermost edges are infinite, so that no side comes to them."""
    if NEDGES > 0:
        fn_edges_on(w.modes, w.edges)
        for i in range(NEDGES):
            if fabs(w.edges[i]) >= NO_EDGE:
                w.edges[i] *= inf


def count(k: int, up: bool, w: Work) -> None:
    """The next mode of a switch that counts, where there is one."""
    if NEDGES > 0:
        if fabs(w.edges[2 * k + 1] if up else w.edges[2 * k]) < inf:
            w.modes[k] += 1.0 if up else -1.0


def margin(k: int, side: Real, slack: Real, w: Work) -> Real:
    """How far a side is from where its switch changes, below zero beyond it."""
    if NEDGES > 0:
        if counted[k] > 0:
            low = side - w.edges[2 * k]
            high = w.edges[2 * k + 1] - side
            return slack + (low if low < high else high)
    mode = w.modes[k]
    return slack + (mode * side if mode != 0.0 else -fabs(side))


def nudge_mode(k: int, direction: Real, more: Real, w: Work, t: Real) -> None:
    """A side that has come to an edge of its mode, but for rounding and `more`, is where it goes."""
    ahead = w.turning[k] * direction
    near = more + 16.0 * SPACING * (fabs(w.sides[k]) + fabs(w.left_sides[k]) + fabs(t * w.turning[k]))
    if NEDGES > 0:
        if counted[k] > 0:
            if ahead > 0.0 and w.edges[2 * k + 1] - w.sides[k] <= near:
                count(k, True, w)
            elif ahead < 0.0 and w.sides[k] - w.edges[2 * k] <= near:
                count(k, False, w)
            return
    if fabs(w.sides[k]) <= near and ahead != 0.0:
        w.modes[k] = sign_of(ahead)


def adopt_modes(p: Params, s: State, w: Work) -> None:
    """Sides that are others than w.beside take the modes that they tell, w.jumped."""
    for k in range(NMODE):
        w.jumped[k] = 0
    for turn in range(NMODE):
        done = True
        fn_sides_on(p, s.t, s.x, w.modes, w.sides)
        fn_own_on(p, s.t, s.x, w.modes, w.own_modes)
        for k in range(NMODE):
            if w.sides[k] != w.beside[k]:
                w.jumped[k] = 1
                if w.own_modes[k] != w.modes[k]:
                    w.modes[k] = w.own_modes[k]
                    done = False
        w.beside[:] = w.sides
        if done:
            break
    take(w)


def spread_changes(p: Params, s: State, direction: Real, rates: Vec[NX], w: Work) -> None:
    """Sides that depend on modes that have changed may jump, and are on another side of theirs then: those
    that were at their change too.  w.beside are those before; `rates` of the state there."""
    w.left_sides[:] = w.beside
    adopt_modes(p, s, w)
    fn_side_rates_on(p, s.t, s.x, w.modes, rates, w.turning)
    for k in range(NMODE):
        if w.jumped[k] > 0:
            nudge_mode(k, direction, 0.0, w, s.t)
    take(w)


def keep_branch(s: State, w: Work) -> None:
    """The branch that was found; what a side is beyond its change, as it is where that was located, is none
    of another.  What rests keeps its slack."""
    for k in range(NMODE):
        beyond = -margin(k, w.sides[k], 0.0, w)
        least = s.slack[k] if w.modes[k] == 0.0 and s.modes[k] == 0.0 else 0.0
        s.slack[k] = beyond if beyond > least else least
        s.modes[k] = w.modes[k]


def at_its_beginning(k: int, w: Work) -> bool:
    """Whether a side is at the lower edge of its mode."""
    if NEDGES > 0:
        return w.beside[k] == w.edges[2 * k]
    return False


def choose_branch(p: Params, s: State, direction: Real, w: Work) -> Status:
    """The branch on from a state of which nothing else is known, and the rates there."""
    fn_modes(p, s.t, s.x, w.modes)
    take(w)
    status = rhs_at(p, s.t, s.x, s.k[0], w.lam, w)
    s.rhs += 1
    if failed(status):
        return status
    fn_sides_on(p, s.t, s.x, w.modes, w.beside)
    fn_side_rates_on(p, s.t, s.x, w.modes, s.k[0], w.turning)
    changed = False
    for k in range(NMODE):
        ahead = sign_of(w.turning[k] * direction)
        w.crossed[k] = 0
        if counted[k] > 0:
            if at_its_beginning(k, w) and ahead < 0.0:
                count(k, False, w)
                w.crossed[k] = 1
        elif w.modes[k] == 0.0 and ahead != 0.0:
            w.modes[k] = ahead
            w.crossed[k] = 1
        if w.crossed[k] > 0:
            changed = True
    w.sides[:] = w.beside
    if changed:
        spread_changes(p, s, direction, s.k[0], w)
        status = rhs_at(p, s.t, s.x, s.k[0], w.lam, w)
        s.rhs += 1
    keep_branch(s, w)
    return status
