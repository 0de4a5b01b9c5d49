"""Round-off in the error of a rejected step.

Close to a tolerance of machine precision the error estimate of a step contains round-off of the rates,
which a shorter step does not reduce. It is estimated by a second evaluation with perturbed data (N. J.
Higham, Accuracy and Stability of Numerical Algorithms, SIAM 2002, chapter 1).
"""

from math import fabs, inf, sqrt

from lagc.kernels.constraints.projection import perturb_off_constraints, project_error
from lagc.kernels.contact.kept_blocks import keep_blocks
from lagc.kernels.contact.touching import rates_at
from lagc.kernels.integrators.dispatch import (
    has_two_estimates,
    is_implicit,
    method_error,
    method_error_parts,
    method_estimate_roundoff,
    method_stages,
)
from lagc.kernels.integrators.error_weights import set_error_weights
from lagc.kernels.language.vocabulary import *

ROUNDOFF_FADING = 0.9  # round-off that remains after a step as long as any so far
ROUNDOFF_FORGOTTEN = 0.03  # below it round-off is forgotten


def perturbation_factor(turn: Count) -> Real:
    """Return 1 plus or minus four units in the last place, by a bit of `turn`."""
    return 1.0 - FOUR_ULPS if turn >> 1 & 1 == 1 else 1.0 + FOUR_ULPS


def perturb_inputs(p: Params, s: State, attempt: Count, x: Vec[NX], other: Params) -> Real:
    """Perturb x and the parameters by four units in the last place, with other signs in each attempt;
    return the perturbed time."""
    # Signs from bits of a number that changes with each attempt: they are not random, but differ from state
    # to state and attempt to attempt.
    turn = 2 * attempt + 3
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


def estimate_rate_roundoff(p: Params, s: State, h: Real, w: Work) -> None:
    """Raise w.error.rate_roundoff to the change of the rates when time, state and parameters are perturbed:
    at the accepted state, and one explicit Euler step over h from it, where the state also moves by what the
    first change brings to it. At one state alone the round-off of a small difference may happen to cancel.
    Costs three evaluations."""
    x = vector(NX)
    other = params()
    # The change at the accepted state, against its rates s.k[0].
    t = perturb_inputs(p, s, s.rejected, x, other)
    s.rhs += 1
    if failed(rates_at(other, t, x, w.xdot, w.lam, w)):
        return
    change = vector(NX)
    for i in range(NINT):
        change[i] = 0.0
    enlarge_differences(w.xdot, s.k[0], change)
    # The change after an Euler step, with both motions one step on.
    moved = vector(NX)
    if NDISC > 0:
        keep_discrete(s.x, moved)
    for i in range(NINT):
        moved[i] = s.x[i] + h * s.k[0][i]
        x[i] += h * (s.k[0][i] + change[i])
    rates = vector(NX)
    s.rhs += 2
    if not failed(rates_at(p, s.t + h, moved, rates, w.lam, w)):
        if not failed(rates_at(other, t + h, x, w.xdot, w.lam, w)):
            enlarge_differences(w.xdot, rates, change)
    # The round-off is the largest of all estimates in this attempt.
    for i in range(NINT):
        if change[i] > w.error.rate_roundoff[i]:
            w.error.rate_roundoff[i] = change[i]


def norm_of_error(h: Real, parts: Mat[TWO, NX], w: Work) -> Real:
    """Return the scaled norm of an error with these two parts, |e5|^2 / sqrt(|e5|^2 + 0.01 |e3|^2) (HNW
    II.10.17)."""
    # |e5|^2 and |e3|^2 in the weights.
    first = 0.0
    for i in range(NQ + NV):
        e = h * parts[0][i] / w.error.weights[i]
        first += e * e
    second = 0.0
    for i in range(NQ + NV):
        e = h * parts[1][i] / w.error.weights[i]
        second += e * e
    total = float(size(NQ) + NV) * (first + 0.01 * second)
    if not total < inf:
        return inf
    return first / sqrt(total) if total > 0.0 else 0.0


def is_nearly_dependent(p: Params, s: State, h: Real, w: Work) -> bool:
    """Return whether constraint equations are nearly dependent within the motion of the attempted step over
    h, or within a thousandth of the distance to such a configuration. Coordinates of a group that moves by
    less than the residual of the projection are round-off: sets w.error.coordinate_roundoff."""
    if not perturb_off_constraints(p, s.t, s.x, s.sizes, w):
        return False
    # In each group: the motion of the step, and what a projection leaves of a perturbation.
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
        if fabs(w.error.x_perturbed[i] - s.x[i]) > left[own]:
            left[own] = fabs(w.error.x_perturbed[i] - s.x[i])
    # A group that moves by less than its projection leaves is known to that only.
    for i in range(NQ):
        if left[scaling_group[i]] > w.error.sizes[scaling_group[i]]:
            w.error.coordinate_roundoff[i] = left[scaling_group[i]] / fabs(h)
    # Near dependent rows a perturbation grows as 1 / distance, so that the product of motion and remainder
    # tells whether the motion crosses them.
    for k in range(NGROUP):
        reach = w.error.sizes[k]
        if w.rows.reaches[NC + NH + k] > reach:
            reach = w.rows.reaches[NC + NH + k]
        if k == 0 and reach > 1.0:
            reach = 1.0
        if left[k] > reach:
            continue
        if left[k] * moved[k] > CROSSING_BRANCHES * reach * reach or left[k] > BRANCH_DISTANCE * reach:
            return True
    return False


def error_along_constraints(p: Params, s: State, t: Real, h: Real, error: Real, method: int, w: Work) -> Real:
    """Return the error of a rejected step to t near a configuration with dependent rows. The step is repeated
    from a state perturbed by the residual of the projection. If its error changes by more than a tenth, it
    is mostly round-off of multipliers, which no shorter step reduces; then only the part of the error
    along the constraints counts, as the projection removes the rest."""
    # The two estimates of the step as it is, then of the step from a state that is off by what a projection
    # leaves.
    method_error_parts(method, s, w)
    for k in range(2):
        w.error.parts_before[k][:] = w.error.parts[k]
    if failed(method_stages(method, p, s.t, w.error.x_perturbed, h, s, w)):
        return error
    method_error_parts(method, s, w)
    for k in range(2):
        for i in range(NINT):
            w.error.parts_before[k][i] -= w.error.parts[k][i]
    change = norm_of_error(h, w.error.parts_before, w)
    # If that changes the error by less than a tenth, it is no round-off.
    if not change > 0.1 * norm_of_error(h, w.error.parts, w):
        return error
    method_stages(method, p, s.t, s.x, h, s, w)  # restore the step
    method_error_parts(method, s, w)
    if not project_error(p, t, s.x_new, w):
        return error
    return norm_of_error(h, w.error.parts, w)


def fade_roundoff(s: State, w: Work) -> None:
    """Before a step: reduce the remembered round-off by the size of the step before."""
    # Memory fades with the distance: 0.9 for a step as long as the longest so far.
    left = 1.0 - (1.0 - ROUNDOFF_FADING) * fabs(s.h_old) / s.longest_step if s.longest_step > 0.0 else 0.0
    s.roundoff_memory *= left
    if s.roundoff_memory < ROUNDOFF_FORGOTTEN:
        s.roundoff_memory = 0.0
    for i in range(NINT):
        s.rate_roundoff[i] = left * s.rate_roundoff[i] if s.roundoff_memory > 0.0 else 0.0
        w.error.rate_roundoff[i] = s.rate_roundoff[i]
    for i in range(NINT):
        w.error.coordinate_roundoff[i] = 0.0


def weighted_error(s: State, o: Options, h: Real, w: Work) -> Real:
    """Return the error of the step over h with the current round-off in its weights."""
    set_error_weights(s, o, h, w)
    return method_error(o.method, h, s, w)


def error_without_roundoff(p: Params, s: State, t: Real, h: Real, o: Options, before: Real, w: Work) -> Real:
    """Return the error of a rejected step over h to t, less its round-off. Only the round-off of rates at
    the accepted state (s.t, s.x) counts: the end of a step that diverges would excuse any error."""
    # Kept forces belong to the parameters of the step, not to perturbed ones.
    if NCON > 0:
        keep_blocks(False, w)
    # Three sources of round-off: that of implicit stages, that of nearly dependent constraints, that of the
    # rates.
    if NNEWTON > 0:
        if is_implicit(o.method):
            method_estimate_roundoff(o.method, p, s.t, s.x, h, s, w)
            return weighted_error(s, o, h, w)
    if NH > 0:
        if is_nearly_dependent(p, s, h, w):
            looked = o.project and has_two_estimates(o.method)
            return error_along_constraints(p, s, t, h, before, o.method, w) if looked else before
    if NSPACE > 0:
        w.contacts.slips_held = True  # where a slip ends its direction is uncertain, its stop is not
    estimate_rate_roundoff(p, s, h, w)
    if NSPACE > 0:
        w.contacts.slips_held = False
    # It is remembered if it explains the rejection, so that the next steps ask for it at once.
    error = weighted_error(s, o, h, w)
    if error <= 1.0 or error < 0.5 * before:
        s.roundoff_memory = 1.0
    return error
