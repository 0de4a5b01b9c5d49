"""What of the error of a step that was rejected is rounding."""

from __future__ import annotations

from math import fabs, inf, sqrt

from lagc.kernels.constraints.projection import nudge, tangents
from lagc.kernels.dynamics.rhs import rhs_at
from lagc.kernels.integrators.dispatch import has_parts, last, method_error, method_parts, method_stages
from lagc.kernels.integrators.error_norm import weigh_errors
from lagc.kernels.language.parameters import bind
from lagc.kernels.language.records import Options, State, Work
from lagc.kernels.language.scaling_groups import set_apart
from lagc.kernels.language.sizes import NC, NH, NKIND, NP, NPREPARED, NQ, NV, NX, TWO
from lagc.kernels.language.statuses import failed
from lagc.kernels.language.tables import kind
from lagc.kernels.language.tolerances import APART, CROSSING, NEARLY
from lagc.kernels.language.words import Count, Mat, Params, Real, Vec, params, size, vector

FADING = 0.9  # of rounding that made a step good, what is left after a step as long as any so far
FORGOTTEN = 0.03  # what is so little of it that it is forgotten


def shake(turn: Count) -> Real:
    """Four units of the last place more or less."""
    return 1.0 - NEARLY if turn >> 1 & 1 == 1 else 1.0 + NEARLY


def shaken(p: Params, s: State, x: Vec[NX], other: Params) -> Real:
    """Time, state x and parameters changed by four units of their last place, another way for each turn;
    the time."""
    turn = 2 * s.rejected + 3
    n = size(NQ) + NV
    x[:] = s.x
    for i in range(NQ + NV):
        x[i] *= shake((i + 1) * turn)
    other[:] = p
    for j in range(NP):
        other[j] *= shake((n + j + 1) * turn)
    if NPREPARED > 0:
        bind(other)
    return s.t * shake(turn)


def listen(p: Params, s: State, w: Work) -> None:
    """Raise s.noise to what rounding may change in the rates s.k[0]: to what changes when all is shaken."""
    x = vector(NX)
    other = params()
    t = shaken(p, s, x, other)
    s.rhs += 1
    if not failed(rhs_at(other, t, x, w.xdot, w.lam, w)):
        set_apart(w.xdot, s.k[0], s.noise)


def parts_norm(h: Real, parts: Mat[TWO, NX], w: Work) -> Real:
    """The norm of an error with such parts; see the methods' `error`."""
    first = 0.0
    for i in range(NQ + NV):
        e = h * parts[0][i] / w.weights[i]
        first += e * e
    second = 0.0
    for i in range(NQ + NV):
        e = h * parts[1][i] / w.weights[i]
        second += e * e
    total = float(size(NQ) + NV) * (first + 0.01 * second)
    if not total < inf:
        return inf
    return first / sqrt(total) if total > 0.0 else 0.0


def all_but_dependent(p: Params, s: State, h: Real, w: Work) -> bool:
    """Whether rows are all but dependent within the way of the step over h that was tried, or a thousandth of
    the way that the coordinates have to where they are zero.  Coordinates of a kind that have moved by no
    more than what projection leaves are rounding: w.play."""
    if not nudge(p, s.t, s.x, s.sizes, w):
        return False
    moved = vector(NKIND)
    for k in range(NKIND):
        moved[k] = 0.0
    left = vector(NKIND)
    for k in range(NKIND):
        left[k] = 0.0
    for i in range(NQ):
        own = kind[i]
        if fabs(s.y[i] - s.x[i]) > moved[own]:
            moved[own] = fabs(s.y[i] - s.x[i])
        if fabs(w.nudged[i] - s.x[i]) > left[own]:
            left[own] = fabs(w.nudged[i] - s.x[i])
    for i in range(NQ):
        if left[kind[i]] > w.reached[kind[i]]:
            w.play[i] = left[kind[i]] / fabs(h)
    for k in range(NKIND):
        reach = w.reached[k]
        if w.reaches[NC + NH + k] > reach:
            reach = w.reaches[NC + NH + k]
        if k == 0 and reach > 1.0:
            reach = 1.0
        if left[k] > reach:
            continue
        if left[k] * moved[k] > CROSSING * reach * reach or left[k] > APART * reach:
            return True
    return False


def second_look(p: Params, s: State, t: Real, h: Real, error: Real, method: int, w: Work) -> Real:
    """There, a step to t, rejected because of `error`, once more from a state moved by what projection
    leaves.  Where the error changes by it, it tells of rounding: near postures where rows are all but
    dependent their multipliers are little else, and no step would be small enough.  Then only what
    projection does not take from the error counts."""
    method_parts(method, s, w)
    for k in range(2):
        w.other[k][:] = w.parts[k]
    s.rhs += last(method) - 1
    if failed(method_stages(method, p, s.t, w.nudged, h, s, w)):
        return error
    method_parts(method, s, w)
    for k in range(2):
        for i in range(NX):
            w.other[k][i] -= w.parts[k][i]
    change = parts_norm(h, w.other, w)
    if not change > 0.1 * parts_norm(h, w.parts, w):
        return error
    s.rhs += last(method) - 1
    method_stages(method, p, s.t, s.x, h, s, w)  # the step as it was
    method_parts(method, s, w)
    if not tangents(p, t, s.y, w):
        return error
    return parts_norm(h, w.parts, w)


def forget(s: State, w: Work) -> None:
    """Before a step: what is left of the rounding that was heard, after the step before."""
    left = 1.0 - (1.0 - FADING) * fabs(s.h_old) / s.longest if s.longest > 0.0 else 0.0
    s.recalled *= left
    if s.recalled < FORGOTTEN:
        s.recalled = 0.0
    for i in range(NX):
        s.noise[i] = left * s.noise[i] if s.recalled > 0.0 else 0.0
    for i in range(NX):
        w.play[i] = 0.0


def error_of(s: State, o: Options, h: Real, w: Work) -> Real:
    """That of the step over h, with the rounding that was heard."""
    weigh_errors(s, o, h, w)
    return method_error(o.method, h, s, w)


def reconsider(p: Params, s: State, t: Real, h: Real, o: Options, before: Real, w: Work) -> Real:
    """The error of a rejected step over h to t again, less what round-off contributes.

    Round-off is what last places of the accepted state (s.t, s.x) bring to its rates.  Nothing that the
    rejected step itself has reached counts: a step that explodes would excuse its own error.
    """
    if NH > 0:
        if all_but_dependent(p, s, h, w):
            looked = o.project and has_parts(o.method)
            return second_look(p, s, t, h, before, o.method, w) if looked else before
    listen(p, s, w)
    error = error_of(s, o, h, w)
    if error <= 1.0 or error < 0.5 * before:
        s.recalled = 1.0
    return error
