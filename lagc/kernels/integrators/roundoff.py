"""What of the error of a step that was rejected is rounding."""

from __future__ import annotations

from math import fabs, inf, sqrt

from lagc.kernels.constraints.projection import perturb_off_constraints, project_error
from lagc.kernels.dynamics.rhs import rhs_at
from lagc.kernels.integrators.dispatch import (
    has_two_estimates,
    last_stage,
    method_error,
    method_error_parts,
    method_stages,
)
from lagc.kernels.integrators.error_norm import set_error_weights
from lagc.kernels.language.parameters import bind
from lagc.kernels.language.records import Options, State, Work
from lagc.kernels.language.scaling_groups import enlarge_differences
from lagc.kernels.language.sizes import NC, NGROUP, NH, NP, NPREPARED, NQ, NV, NX, TWO
from lagc.kernels.language.statuses import failed
from lagc.kernels.language.tables import scaling_group
from lagc.kernels.language.tolerances import BRANCH_DISTANCE, CROSSING_BRANCHES, FOUR_ULPS
from lagc.kernels.language.words import Count, Mat, Params, Real, Vec, params, size, vector

ROUNDOFF_FADING = 0.9  # of rounding that made a step good, what is left after a step as long as any so far
ROUNDOFF_FORGOTTEN = 0.03  # what is so little of it that it is forgotten


def perturbation_factor(turn: Count) -> Real:
    """Four units of the last place more or less."""
    return 1.0 - FOUR_ULPS if turn >> 1 & 1 == 1 else 1.0 + FOUR_ULPS


def perturb_inputs(p: Params, s: State, x: Vec[NX], other: Params) -> Real:
    """Time, state x and parameters changed by four units of their last place, another way for each turn;
    the time."""
    turn = 2 * s.rejected + 3
    n = size(NQ) + NV
    x[:] = s.x
    for i in range(NQ + NV):
        x[i] *= perturbation_factor((i + 1) * turn)
    other[:] = p
    for j in range(NP):
        other[j] *= perturbation_factor((n + j + 1) * turn)
    if NPREPARED > 0:
        bind(other)
    return s.t * perturbation_factor(turn)


def estimate_rate_roundoff(p: Params, s: State, w: Work) -> None:
    """Raise s.rate_roundoff to what rounding may change in the rates s.k[0]: to what changes when all is shaken."""
    x = vector(NX)
    other = params()
    t = perturb_inputs(p, s, x, other)
    s.rhs += 1
    if not failed(rhs_at(other, t, x, w.xdot, w.lam, w)):
        enlarge_differences(w.xdot, s.k[0], s.rate_roundoff)


def norm_of_error(h: Real, parts: Mat[TWO, NX], w: Work) -> Real:
    """The norm of an error with such parts; see the methods' `error`."""
    first = 0.0
    for i in range(NQ + NV):
        e = h * parts[0][i] / w.error_weights[i]
        first += e * e
    second = 0.0
    for i in range(NQ + NV):
        e = h * parts[1][i] / w.error_weights[i]
        second += e * e
    total = float(size(NQ) + NV) * (first + 0.01 * second)
    if not total < inf:
        return inf
    return first / sqrt(total) if total > 0.0 else 0.0


def is_nearly_dependent(p: Params, s: State, h: Real, w: Work) -> bool:
    """Whether rows are all but dependent within the way of the step over h that was tried, or a thousandth of
    the way that the coordinates have to where they are zero.  Coordinates of a kind that have moved by no
    more than what projection leaves are rounding: w.coordinate_roundoff."""
    if not perturb_off_constraints(p, s.t, s.x, s.sizes, w):
        return False
    moved = vector(NGROUP)
    for k in range(NGROUP):
        moved[k] = 0.0
    left = vector(NGROUP)
    for k in range(NGROUP):
        left[k] = 0.0
    for i in range(NQ):
        own = scaling_group[i]
        if fabs(s.x_new[i] - s.x[i]) > moved[own]:
            moved[own] = fabs(s.x_new[i] - s.x[i])
        if fabs(w.x_perturbed[i] - s.x[i]) > left[own]:
            left[own] = fabs(w.x_perturbed[i] - s.x[i])
    for i in range(NQ):
        if left[scaling_group[i]] > w.trial_sizes[scaling_group[i]]:
            w.coordinate_roundoff[i] = left[scaling_group[i]] / fabs(h)
    for k in range(NGROUP):
        reach = w.trial_sizes[k]
        if w.reaches[NC + NH + k] > reach:
            reach = w.reaches[NC + NH + k]
        if k == 0 and reach > 1.0:
            reach = 1.0
        if left[k] > reach:
            continue
        if left[k] * moved[k] > CROSSING_BRANCHES * reach * reach or left[k] > BRANCH_DISTANCE * reach:
            return True
    return False


def error_along_constraints(p: Params, s: State, t: Real, h: Real, error: Real, method: int, w: Work) -> Real:
    """There, a step to t, rejected because of `error`, once more from a state moved by what projection
    leaves.  Where the error changes by it, it tells of rounding: near postures where rows are all but
    dependent their multipliers are little else, and no step would be small enough.  Then only what
    projection does not take from the error counts."""
    method_error_parts(method, s, w)
    for k in range(2):
        w.error_parts_before[k][:] = w.error_parts[k]
    s.rhs += last_stage(method) - 1
    if failed(method_stages(method, p, s.t, w.x_perturbed, h, s, w)):
        return error
    method_error_parts(method, s, w)
    for k in range(2):
        for i in range(NX):
            w.error_parts_before[k][i] -= w.error_parts[k][i]
    change = norm_of_error(h, w.error_parts_before, w)
    if not change > 0.1 * norm_of_error(h, w.error_parts, w):
        return error
    s.rhs += last_stage(method) - 1
    method_stages(method, p, s.t, s.x, h, s, w)  # the step as it was
    method_error_parts(method, s, w)
    if not project_error(p, t, s.x_new, w):
        return error
    return norm_of_error(h, w.error_parts, w)


def fade_roundoff(s: State, w: Work) -> None:
    """Before a step: what is left of the rounding that was heard, after the step before."""
    left = 1.0 - (1.0 - ROUNDOFF_FADING) * fabs(s.h_old) / s.longest_step if s.longest_step > 0.0 else 0.0
    s.roundoff_memory *= left
    if s.roundoff_memory < ROUNDOFF_FORGOTTEN:
        s.roundoff_memory = 0.0
    for i in range(NX):
        s.rate_roundoff[i] = left * s.rate_roundoff[i] if s.roundoff_memory > 0.0 else 0.0
    for i in range(NX):
        w.coordinate_roundoff[i] = 0.0


def weighted_error(s: State, o: Options, h: Real, w: Work) -> Real:
    """That of the step over h, with the rounding that was heard."""
    set_error_weights(s, o, h, w)
    return method_error(o.method, h, s, w)


def error_without_roundoff(p: Params, s: State, t: Real, h: Real, o: Options, before: Real, w: Work) -> Real:
    """The error of a rejected step over h to t again, less what round-off contributes.

    Round-off is what last places of the accepted state (s.t, s.x) bring to its rates.  Nothing that the
    rejected step itself has reached counts: a step that explodes would excuse its own error.
    """
    if NH > 0:
        if is_nearly_dependent(p, s, h, w):
            looked = o.project and has_two_estimates(o.method)
            return error_along_constraints(p, s, t, h, before, o.method, w) if looked else before
    estimate_rate_roundoff(p, s, w)
    error = weighted_error(s, o, h, w)
    if error <= 1.0 or error < 0.5 * before:
        s.roundoff_memory = 1.0
    return error
