"""What becomes of a motion where conditions change: the branch on from there."""

from __future__ import annotations

from math import fabs

from lagc.kernels.dynamics.rhs import rhs_at
from lagc.kernels.events.location import any_passes, still_at_rest
from lagc.kernels.events.modes import count, keep_branch, sign_of, spread_changes, take
from lagc.kernels.events.sliding import come_to_rest, hold_still, late, rates_of_sides, rests, turns_back
from lagc.kernels.language.model import fn_side_rates_on, fn_sides_on
from lagc.kernels.language.records import NOWHERE, State, Work
from lagc.kernels.language.sizes import NEDGES, NFREE, NMODE, NTIMED, NX
from lagc.kernels.language.statuses import CHATTERING, OK, failed
from lagc.kernels.language.tables import counted
from lagc.kernels.language.tolerances import NEARLY_THERE, SPACING
from lagc.kernels.language.words import Params, Real, Status

MOST_AT_ONCE = 20  # changes at one time, and two for each switch


def stays(p: Params, s: State, direction: Real, w: Work) -> bool:
    """Whether switches that only touched their change, as another turned them back there, are put back."""
    found = False
    others = 0
    for i in range(NMODE):
        others += w.crossed[i]
    for j in range(NFREE):
        k = NTIMED + j
        touches = w.crossed[k] > 0 and w.jumped[k] == 0 and others > 1
        if touches and turns_back(k, w.turning[k], w.before[k], direction, w):
            w.modes[k] = s.modes[k]
            w.crossed[k] = 0
            others -= 1
            found = True
    if found:
        take(w)
        fn_sides_on(p, s.t, s.x, w.modes, w.sides)
    return found


def is_little(time: Real, s: State) -> bool:
    """Of the last step, or last places of the time."""
    return fabs(time) <= s.little + NEARLY_THERE * SPACING * fabs(s.t)


def put_right(p: Params, s: State, direction: Real, w: Work) -> None:
    """The state, for the time since the first of the switches in w.crossed changed, or until it does: what is
    left of a step that ends there, which rounding is for the most part, as times have last places."""
    for k in range(NMODE):
        if w.crossed[k] > 0:
            since = late(k, direction, w)
            if is_little(since, s):
                for i in range(NX):
                    apart = w.xdot[i] - w.left_rates[i]
                    s.x[i] += since * apart
                    if k < NTIMED:
                        s.jolts[i] += SPACING * fabs(s.t * apart)
                fn_sides_on(p, s.t, s.x, w.modes, w.sides)
            return


def to_and_fro(s: State, w: Work) -> bool:
    """Whether switches change each other at one time without end."""
    if s.t != s.t_changed:
        s.t_changed = s.t
        s.changes_here = 0
    s.changes_here += 1
    for k in range(NMODE):
        if w.crossed[k] > 0:
            w.culprit = k
    return s.changes_here > MOST_AT_ONCE + 2 * NMODE


def pass_edge(k: int, s: State, direction: Real, w: Work) -> None:
    """The next mode of a switch that counts.  None where its side moves away from the nearest edge: a
    long step leads elsewhere once it ends where it seemed to come to one.  Twice at one time it moves on."""
    if NEDGES > 0:
        up = w.before[k] * direction > 0.0
        above = w.edges[2 * k + 1] - w.beside[k] < w.beside[k] - w.edges[2 * k]
        if k < NTIMED or up == above or s.t == s.t_changed:
            count(k, up, w)


def change(p: Params, s: State, direction: Real, w: Work) -> Status:
    """The switches in w.crossed change at (s.t, s.x)."""
    if NEDGES > 0:
        for i in range(NEDGES):
            w.left_edges[i] = w.edges[i]
    s.rhs += 1
    status = rhs_at(p, s.t, s.x, w.left_rates, w.lam, w)
    if failed(status):
        return status
    fn_side_rates_on(p, s.t, s.x, w.modes, w.left_rates, w.turning)
    fn_sides_on(p, s.t, s.x, w.modes, w.beside)
    w.sides[:] = w.beside
    if NFREE > 0:
        if not any_passes(p, s, direction, w):
            return OK
    w.before[:] = w.turning
    for i in range(NMODE):
        if w.crossed[i] > 0:
            if counted[i] > 0:
                pass_edge(i, s, direction, w)
            elif w.modes[i] == 0.0:
                away = w.before[i] * direction if still_at_rest(i, s, w) else w.beside[i]
                w.modes[i] = sign_of(away)
            else:
                w.modes[i] = -w.modes[i]
    spread_changes(p, s, direction, w.left_rates, w)
    if NFREE > 1:
        if come_to_rest(p, s, direction, w):
            take(w)
            fn_sides_on(p, s.t, s.x, w.modes, w.sides)
    status = rates_of_sides(p, s, w)
    if failed(status):
        return status
    if stays(p, s, direction, w):
        status = rates_of_sides(p, s, w)
        if failed(status):
            return status
    for j in range(NFREE):
        k = NTIMED + j
        rate = w.turning[k]
        if w.crossed[k] > 0 and w.jumped[k] == 0 and turns_back(k, rate, w.before[k], direction, w):
            # From rest it goes only where it does not come back.
            left = s.modes[k] == 0.0 and not still_at_rest(k, s, w)
            if left or not rests(p, s, k, rate, w.before[k], w):
                w.culprit = k
                return CHATTERING
    for i in range(NMODE):
        s.changed[i] = 1 if w.modes[i] != s.modes[i] else 0
    put_right(p, s, direction, w)
    keep_branch(s, w)
    hold_still(s, w)
    if to_and_fro(s, w):
        return CHATTERING
    s.changes += 1
    s.fresh = True
    s.rate = NOWHERE
    return OK
