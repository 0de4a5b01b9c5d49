"""Sensitivities S = dx/dtheta at one state: their rates, and the tangents of the constraints.

S' = f_x S + f_theta.  With F(t, q, v, a, lam, p) = (M a - f - G^T lam; G a - gamma) = 0, the rates
(a', lam') along a direction solve K (a', lam') = -F', K = [M -G^T; G 0] (A. Griewank, A. Walther, Evaluating
Derivatives, SIAM 2008).
"""

from math import fabs, inf

from lagc.kernels.constraints.projection import assemble_at, solve_at
from lagc.kernels.dynamics.loaded_reactions import follow_loads, keep_load_matrix, motion_at, update_load
from lagc.kernels.dynamics.rhs import assemble_entries, factor_safely, rhs_at
from lagc.kernels.language.vocabulary import *
from lagc.kernels.linear_algebra.cholesky import solve_lower, solve_upper

CLEAR = 10.0  # times the round-off: a rate that is significant
SAME_LIMIT = 1e-13  # relative difference of the limits of a derivative from both sides


def factor_tangents(p: Params, t: Real, x: Vec[NX], w: Work, v: TangentWork) -> Status:
    """Factor K at (t, x)."""
    # The same factors as for accelerations; the tangents of a linear system have its matrix.
    v.dense = False
    if NC > 0:
        return assemble_at(p, t, x, w)
    if STRAIGHT:
        assemble_entries(p, t, x, w)
        fn_factor(w.kkt_entries, w.health)
        if w.health[0] >= SINGULAR:
            return OK
    if NM > 0:
        v.dense = True
        return factor_safely(p, t, x, w)
    return SINGULAR_MASS


def solve_tangents(w: Work, v: TangentWork) -> None:
    """Solve K v.solution = v.dr, with one step of refinement if there are constraints."""
    # Factors come from one state for many right-hand sides, so one step of refinement pays.
    if NC > 0:
        solve_at(v.dr, v.solution, w)
        if STRAIGHT:
            if NM > 0:
                if not w.rows.is_dense:
                    fn_refine(w.kkt_entries, v.dr, v.solution)
            else:
                fn_rest(w.kkt_entries, v.dr, v.solution, w.rows.residual)
                fn_solve(w.kkt_entries, w.rows.residual, w.rows.correction)
                for i in range(NR):
                    v.solution[i] += w.rows.correction[i]
    else:
        if STRAIGHT:
            if not v.dense:
                fn_solve(w.kkt_entries, v.dr, v.solution)
                return
        if NM > 0:
            w.a[:] = v.dr
            solve_lower(w, w.a)
            solve_upper(w, w.a)
            v.solution[:] = w.a


def rates_beside(
    p: Params, t: Real, x: Vec[NX], own: Vec[NX], offset: Real, rates: Vec[NX], w: Work, v: TangentWork
) -> None:
    """Compute the rates of S, with the derivatives of the equations at a small offset from x."""
    # Derivatives at an offset are defined where those at x may be 0/0.
    for i in range(NX):
        v.xdot[i] = x[i] + offset
    if NMODE > 0:
        fn_tangent_on(p, t, v.xdot, w.modes, v.a, v.lam, own, v.seeds, v.dqdot, v.dr)
    else:
        fn_tangent(p, t, v.xdot, v.a, v.lam, own, v.seeds, v.dqdot, v.dr)
    solve_tangents(w, v)
    if NLOADED > 0:
        if not follow_loads(v.solution, w):
            v.solution[0] = inf
    for i in range(NX):
        rates[i] = 0.0
    rates[:NQ] = v.dqdot
    rates[NQ : NQ + NV] = part(v.solution, 0, NV)


def tangent_rates(
    p: Params, t: Real, x: Vec[NX], own: Vec[NX], rates: Vec[NX], w: Work, v: TangentWork
) -> Status:
    """Compute the rates of S = own in the direction v.seeds, at the accelerations v.a and multipliers v.lam.
    A derivative without a value, such as that of norm(v) v at rest, is its limit from both sides."""
    # Where a rate is not finite, both limits are taken; if they agree, that is the derivative.
    rates_beside(p, t, x, own, 0.0, rates, w, v)
    if not_finite(rates, NX) < 0:
        return OK
    other = vector(NX)
    rates_beside(p, t, x, own, NO_LENGTH, rates, w, v)
    rates_beside(p, t, x, own, -NO_LENGTH, other, w, v)
    largest = 0.0
    for i in range(NX):
        if fabs(rates[i]) > largest:
            largest = fabs(rates[i])
    for i in range(NX):
        if not fabs(rates[i] - other[i]) <= SAME_LIMIT * largest:
            return NOT_FINITE
        rates[i] = 0.5 * (rates[i] + other[i])
    return OK if not_finite(rates, NX) < 0 else NOT_FINITE


def direction_rates(
    p: Params, t: Real, x: Vec[NX], own: Vec[NX], noise: Vec[NGROUP], rates: Vec[NX], w: Work, v: TangentWork
) -> Status:
    """Compute the rates of S = own. While S is zero, rates that are round-off, as those by a mass on which
    the motion does not depend, are zero."""
    # Zero S and rates below ten times their round-off: they stay zero, so that S of a state that does not
    # depend on the parameter is exactly zero.
    status = tangent_rates(p, t, x, own, rates, w, v)
    for i in range(NQ + NV):
        if own[i] != 0.0 or not fabs(rates[i]) <= CLEAR * noise[scaling_group[i]]:
            return status
    for i in range(NX):
        rates[i] = 0.0
    return status


def look_at(p: Params, t: Real, x: Vec[NX], w: Work, v: TangentWork) -> Status:
    """Evaluate the motion at (t, x), and factor K there."""
    if NLOADED > 0:
        status = motion_at(p, t, x, v.xdot, v.lam, w)
    else:
        status = rhs_at(p, t, x, v.xdot, v.lam, w)
    if failed(status):
        return status
    v.a[:] = part(v.xdot, NQ, NQ + NV)
    status = factor_tangents(p, t, x, w, v)
    # Loads follow the multipliers of S: their slopes at those of the motion.
    if NLOADED > 0:
        if not failed(status):
            w.loads.lam[:] = v.lam
            update_load(p, t, x, w)
            keep_load_matrix(w)
    return status


def stay_on_constraints(p: Params, t: Real, x: Vec[NX], own: Vec[NX], w: Work, v: TangentWork) -> None:
    """Project S so that phi_q S_q + phi_theta = 0, and the same for psi, by the smallest change in the metric
    of the mass matrix; quaternions keep their length.  K is factored at (t, x)."""
    # Unit quaternions: the part of S along e goes.
    for k in range(NQUAT):
        first = quaternion[k]
        along = 0.0
        length = 0.0
        for i in range(4):
            along += x[first + i] * own[first + i]
            length += x[first + i] * x[first + i]
        for i in range(4):
            own[first + i] -= x[first + i] * (along / length)
    if NC > 0:
        for i in range(NR):
            v.dr[i] = 0.0
        # Positions first, because the rates of holonomic rows depend on them; then speeds.
        if NH > 0:
            fn_tied(p, t, x, own, v.seeds, v.tied)
            for i in range(NH):
                v.dr[NV + i] = -v.tied[i]
            solve_tangents(w, v)
            if HAS_DISPLACE:
                fn_displace(p, t, x, v.solution, v.dqdot)
                for i in range(NQ):
                    own[i] += v.dqdot[i]
            else:
                for i in range(NQ):
                    own[i] += v.solution[i]
        fn_tied(p, t, x, own, v.seeds, v.tied)
        for i in range(NC):
            v.dr[NV + i] = -v.tied[NH + i]
        solve_tangents(w, v)
        for i in range(NV):
            own[NQ + i] += v.solution[i]
