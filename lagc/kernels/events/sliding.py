"""Where a side comes to rest at its change: what acts on either side of it drives it back, what acts
between leaves it there.  So dry friction stops what slides, and the joints of a mechanism all at once."""

from __future__ import annotations

from math import fabs

from lagc.kernels.dynamics.rhs import rhs_at
from lagc.kernels.events.modes import sign_of
from lagc.kernels.language.model import fn_side_rates_on
from lagc.kernels.language.records import State, Work
from lagc.kernels.language.sizes import NEDGES, NFREE, NMODE, NTIMED
from lagc.kernels.language.statuses import failed
from lagc.kernels.language.tables import counted
from lagc.kernels.language.tolerances import NEARLY_THERE, SPACING
from lagc.kernels.language.words import Params, Real, Status

TURNED = 1e-9  # of a rate: more than that back to where it came from is no rounding
STILL = 1e-12  # of the rates on both sides: less than that is rest between them


def turns_back(k: int, rate: Real, before: Real, direction: Real, w: Work) -> bool:
    """Whether a switch that has changed goes back at once, by its rates now and before."""
    ahead = rate * direction
    if counted[k] > 0:
        ahead *= sign_of(before * direction)
    else:
        ahead *= w.modes[k]
    return ahead < -TURNED * fabs(before)


def late(k: int, direction: Real, w: Work) -> Real:
    """The time since this switch changed, by what its side was before."""
    target = 0.0
    if NEDGES > 0:
        if counted[k] > 0:
            target = w.left_edges[2 * k + 1] if w.before[k] * direction > 0.0 else w.left_edges[2 * k]
    return (w.left_sides[k] - target) / w.before[k] if w.before[k] != 0.0 else 0.0


def rates_of_sides(p: Params, s: State, w: Work) -> Status:
    """w.turning, on the branch of w.modes."""
    s.rhs += 1
    status = rhs_at(p, s.t, s.x, w.xdot, w.lam, w)
    if not failed(status):
        fn_side_rates_on(p, s.t, s.x, w.modes, w.xdot, w.turning)
    return status


def first_crossed(w: Work) -> int:
    first = 0
    while first < NMODE - 1 and w.crossed[first] == 0:
        first += 1
    return first


def in_company(s: State, first: int, direction: Real, w: Work) -> bool:
    """Whether other sides come to zero with this one, as exactly as the step tells: w.halted."""
    when = late(first, direction, w)
    near = s.rough + NEARLY_THERE * SPACING * fabs(s.t)
    found = False
    for j in range(NFREE):
        k = NTIMED + j
        w.halted[j] = 0
        if counted[k] == 0 and w.jumped[k] == 0 and w.before[k] != 0.0 and k != first:
            if fabs(late(k, direction, w) - when) <= near:
                w.halted[j] = 1
                found = True
    return found


def halt(p: Params, s: State, first: int, w: Work) -> bool:
    """Mode zero for this side and for those of w.halted whose modes move it, which remain; whether any do."""
    w.modes[first] = 0.0
    if failed(rates_of_sides(p, s, w)):
        return False
    several = False
    for j in range(NFREE):
        k = NTIMED + j
        if w.halted[j] > 0:
            mode = w.modes[k]
            rate = w.turning[first]
            w.modes[k] = 0.0
            if failed(rates_of_sides(p, s, w)):
                return False
            if fabs(w.turning[first] - rate) > STILL * fabs(w.before[first]):
                several = True
            else:
                w.halted[j] = 0
                w.modes[k] = mode
                w.turning[first] = rate
    w.halted[first - NTIMED] = 1
    return several


def between(p: Params, s: State, direction: Real, w: Work) -> bool:
    """Whether the sides in w.halted stay at zero, and are driven back where all have passed."""
    there = not failed(rates_of_sides(p, s, w))
    for j in range(NFREE):
        k = NTIMED + j
        if w.halted[j] > 0:
            if not fabs(w.turning[k]) <= STILL * fabs(w.before[k]):
                there = False
            w.modes[k] = sign_of(w.before[k] * direction)
    there = there and not failed(rates_of_sides(p, s, w))
    for j in range(NFREE):
        k = NTIMED + j
        if w.halted[j] > 0:
            if not turns_back(k, w.turning[k], w.before[k], direction, w):
                there = False
            w.modes[k] = 0.0
    return there


def come_to_rest(p: Params, s: State, direction: Real, w: Work) -> bool:
    """Whether sides that come to zero together stay there, in mode zero, as joints with friction do."""
    first = first_crossed(w)
    if first < NTIMED or counted[first] > 0 or w.jumped[first] > 0 or w.before[first] == 0.0:
        return False
    if not in_company(s, first, direction, w):
        return False
    w.own_modes[:] = w.modes
    if halt(p, s, first, w) and between(p, s, direction, w):
        return True
    w.modes[:] = w.own_modes
    return False


def rests(p: Params, s: State, k: int, rate: Real, before: Real, w: Work) -> bool:
    """Whether the side stays at zero, where its mode is zero."""
    if counted[k] > 0:
        return False
    mode = w.modes[k]
    w.modes[k] = 0.0
    if not failed(rates_of_sides(p, s, w)) and fabs(w.turning[k]) <= STILL * (fabs(rate) + fabs(before)):
        return True
    w.modes[k] = mode
    return False


def hold_still(s: State, w: Work) -> None:
    """What rests has the slack by which it would go on within last places of the time."""
    for j in range(NFREE):
        k = NTIMED + j
        if s.modes[k] == 0.0 and s.changed[k] > 0:
            own = NEARLY_THERE * SPACING * fabs(s.t * w.before[k])
            if own > s.slack[k]:
                s.slack[k] = own
