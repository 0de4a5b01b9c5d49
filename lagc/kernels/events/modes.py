"""Modes: the branch of each relation on which the equations are evaluated.

A mode is sign(z) of an indicator z, or floor(z) of a stepwise relation, which changes at the edges of its
mode. Modes are constant during a step.
"""

from math import fabs, inf

from lagc.kernels.contact.touching import rates_at
from lagc.kernels.events.late_indicators import (
    adopt_late_modes,
    indicator_rates_at,
    indicators_at,
    set_late_modes,
)
from lagc.kernels.language.vocabulary import *


def sign_of(a: Real) -> Real:
    """Return 1, 0 or -1."""
    if a > 0.0:
        return 1.0
    return -1.0 if a < 0.0 else 0.0


def update_edges(w: Work) -> None:
    """Compute the edges of the current modes. An outermost edge is infinite: no indicator reaches it."""
    if NEDGES > 0:
        # Edges beyond any number are made infinite, so that no comparison with them is true.
        fn_edges_on(w.modes, w.events.edges)
        for i in range(NEDGES):
            if fabs(w.events.edges[i]) >= NO_EDGE:
                w.events.edges[i] *= inf


def step_mode(k: int, up: bool, w: Work) -> None:
    """Move a stepwise relation to its next mode, up or down, if there is one."""
    if NEDGES > 0:
        if fabs(w.events.edges[2 * k + 1] if up else w.events.edges[2 * k]) < inf:
            w.modes[k] += 1.0 if up else -1.0


def margin(k: int, indicator: Real, slack: Real, w: Work) -> Real:
    """Return the distance of an indicator from its crossing, plus its slack; negative beyond it."""
    # Of a stepwise relation the distance from the nearer edge; of a sign mode times indicator, and in mode
    # zero minus its magnitude: any motion leaves it.
    if NEDGES > 0:
        if has_edges[k] > 0:
            low = indicator - w.events.edges[2 * k]
            high = w.events.edges[2 * k + 1] - indicator
            return slack + (low if low < high else high)
    mode = w.modes[k]
    return slack + (mode * indicator if mode != 0.0 else -fabs(indicator))


def advance_mode(k: int, direction: Real, more: Real, w: Work, t: Real) -> None:
    """If an indicator is within round-off and `more` of a crossing, change its mode to the one that it
    moves to."""
    # Near: within round-off of the indicator's old and new value, and of its motion over the round-off of the
    # time.
    ahead = w.events.rates[k] * direction
    near = more + 16.0 * SPACING * (
        fabs(w.events.indicators[k]) + fabs(w.events.old_indicators[k]) + fabs(t * w.events.rates[k])
    )
    if NEDGES > 0:
        if has_edges[k] > 0:
            if ahead > 0.0 and w.events.edges[2 * k + 1] - w.events.indicators[k] <= near:
                step_mode(k, True, w)
            elif ahead < 0.0 and w.events.indicators[k] - w.events.edges[2 * k] <= near:
                step_mode(k, False, w)
            return
    if NCON > 0:
        if k >= NMODE - NCON - NSLIP:  # a contact
            return
    if fabs(w.events.indicators[k]) <= near and ahead != 0.0:
        w.modes[k] = sign_of(ahead)


def adopt_modes(p: Params, s: State, w: Work) -> None:
    """Give indicators that differ from w.events.indicators_before the modes of their values, and mark them in
    w.events.jumped. Repeat, since modes change other indicators."""
    # Only indicators that jumped get new modes; those that moved on continuously keep theirs up to their
    # crossing.
    for k in range(NMODE):
        w.events.jumped[k] = 0
    for turn in range(NMODE):
        done = True
        indicators_at(p, s.t, s.x, w.modes, w.events.indicators, s, w)
        if NPLAIN > 0:
            fn_own_modes_on(p, s.t, s.x, w.modes, w.events.candidate_modes)
        else:
            w.events.candidate_modes[:] = w.modes
        if NLATE > 0:
            adopt_late_modes(w)
        for k in range(NMODE):
            if w.events.indicators[k] != w.events.indicators_before[k]:
                w.events.jumped[k] = 1
                if w.events.candidate_modes[k] != w.modes[k]:
                    w.modes[k] = w.events.candidate_modes[k]
                    done = False
        w.events.indicators_before[:] = w.events.indicators
        if done:
            break
    update_edges(w)


def propagate_changes(p: Params, s: State, direction: Real, rates: Vec[NX], w: Work) -> None:
    """After some modes changed, update the modes of indicators that depend on them and jump.
    w.events.indicators_before are the indicators before; `rates` are the rates of the state there."""
    # Old indicators are kept: time since crossing is measured in the old modes. An indicator that jumped onto
    # a crossing moves on from it.
    w.events.old_indicators[:] = w.events.indicators_before
    adopt_modes(p, s, w)
    indicator_rates_at(p, s.t, s.x, w.modes, rates, w.events.rates, s, w)
    for k in range(NMODE):
        if w.events.jumped[k] > 0:
            advance_mode(k, direction, 0.0, w, s.t)
    update_edges(w)


def accept_modes(s: State, w: Work) -> None:
    """Make w.modes the modes of the next step. The slack of an indicator becomes its distance beyond a
    crossing, which is that of its location; an indicator in sliding mode keeps at least its slack."""
    for k in range(NMODE):
        if NCON > 0:
            if k >= NMODE - NCON - NSLIP:  # their slack is set by `set_contact_slack`
                s.modes[k] = w.modes[k]
                continue
        # The distance beyond its crossing, in its new mode: where the next step begins, and how far round-off
        # may have it.
        beyond = -margin(k, w.events.indicators[k], 0.0, w)
        least = s.slack[k] if w.modes[k] == 0.0 and s.modes[k] == 0.0 else 0.0
        s.slack[k] = beyond if beyond > least else least
        s.modes[k] = w.modes[k]


def is_at_lower_edge(k: int, w: Work) -> bool:
    """Return whether an indicator is exactly at the lower edge of its mode."""
    if NEDGES > 0:
        return w.events.indicators_before[k] == w.events.edges[2 * k]
    return False


def leave_zero(direction: Real, w: Work) -> bool:
    """Give indicators at zero, or at the lower edge of their modes, the modes that they move to, and mark
    them in w.events.crossed. Return whether there are any."""
    found = False
    # At exactly zero (or a lower edge) the value says nothing about the mode; the rate does.
    for k in range(NMODE):
        ahead = sign_of(w.events.rates[k] * direction)
        w.events.crossed[k] = 0
        if has_edges[k] > 0:
            if is_at_lower_edge(k, w) and ahead < 0.0:
                step_mode(k, False, w)
                w.events.crossed[k] = 1
        elif w.modes[k] == 0.0 and ahead != 0.0:
            if NCON > 0:
                if w.settling.indicators_unmoved[k] > 0:
                    continue
            w.modes[k] = ahead
            w.events.crossed[k] = 1
        if w.events.crossed[k] > 0:
            found = True
    return found


def choose_modes(p: Params, s: State, direction: Real, w: Work) -> Status:
    """Find the modes of a new state, and compute its rates. An indicator at zero gets the mode that it
    moves to."""
    # Contacts have moved the state without what `indicators_unmoved` lists: these keep modes, as their values
    # did not change.
    if NCON > 0:
        w.events.candidate_modes[:] = w.modes
    fn_modes(p, s.t, s.x, w.modes)
    if NCON > 0:
        for k in range(NMODE):
            if w.settling.indicators_unmoved[k] > 0:
                w.modes[k] = w.events.candidate_modes[k]
    # Relations that need accelerations come after those that need only the state.
    if NLATE > 0:
        set_late_modes(p, s.t, s.x, s, w)
    update_edges(w)
    # Rates in these modes tell where indicators at zero go; if one leaves, others may change with it, and the
    # rates are evaluated again.
    status = rates_at(p, s.t, s.x, s.k[0], w.lam, w)
    s.rhs += 1
    if failed(status):
        return status
    indicators_at(p, s.t, s.x, w.modes, w.events.indicators_before, s, w)
    indicator_rates_at(p, s.t, s.x, w.modes, s.k[0], w.events.rates, s, w)
    w.events.indicators[:] = w.events.indicators_before
    if NPLAIN > 0:
        if leave_zero(direction, w):
            propagate_changes(p, s, direction, s.k[0], w)
            status = rates_at(p, s.t, s.x, s.k[0], w.lam, w)
            s.rhs += 1
    else:  # the motion does not depend on modes of gaps
        leave_zero(direction, w)
    accept_modes(s, w)
    return status
