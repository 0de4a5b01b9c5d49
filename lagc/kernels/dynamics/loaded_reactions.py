"""Loads that depend on reactions, f(t, q, v, lam):

    M a - G^T lam = r + f(lam)      G a = gamma

With K = [M G^T; G 0], let mu(lam) be the multipliers of K z = (r + f(lam), gamma). The motion has
mu(lam) = lam, found by Newton's method from the multipliers without f. One step is exact for loads that are
linear in lam. Piecewise linear equations have one solution for any right-hand side only if the determinants
of all pieces have one sign (S. Scholtes, Introduction to Piecewise Differentiable Equations, Springer 2012,
2.3): that of 1 - dmu/dlam is compared at lam and -lam.

An equation that an actuator holds has no force along its gradient: its row is mu(lam) = 0, and its lam the
number of times that the actuator acts.
"""

from math import fabs, sqrt

from lagc.kernels.constraints.projection import assemble_at, solve_at
from lagc.kernels.dynamics.rhs import rhs_at, store_rates
from lagc.kernels.language.vocabulary import *

MOST_LOAD_STEPS = 30  # of Newton's method


def update_load(p: Params, t: Real, x: Vec[NX], w: Work) -> None:
    """Compute w.load_force and w.load_slopes at w.load_lam."""
    if NPUSHED > 0:
        fn_pushed_on(p, t, x, w.modes, w.load_lam, w.contact_forces, w.load_force, w.load_slopes)
    elif NMODE > 0:
        fn_loaded_on(p, t, x, w.modes, w.load_lam, w.load_force, w.load_slopes)
    else:
        fn_loaded(p, t, x, w.load_lam, w.load_force, w.load_slopes)


def load_response(w: Work) -> None:
    """Compute w.load_answer, the accelerations and multipliers by w.load_force alone."""
    for i in range(NR):
        w.load_rhs[i] = w.load_force[i] if i < NV else 0.0
    solve_at(w.load_rhs, w.load_answer, w)


def acts_along(k: int) -> bool:
    """Return whether the multiplier of a row acts along its gradient, as without an actuator."""
    if NHELD > 0:
        return load_held[k] == 0
    return True


def reach_of_actuator(k: int, w: Work) -> Real:
    """Return the most by which the multiplier of a held row can follow the force w.load_force, whose response
    is w.load_answer, by the inequality of Cauchy and Schwarz in the metric of the inverse mass matrix."""
    row = NV + loading_row[k]
    own = w.load_answer[row]
    power = 0.0
    for i in range(NV):
        power += w.load_force[i] * w.load_answer[i]
    for i in range(NR):
        w.load_rhs[i] = 1.0 if i == row else 0.0
    solve_at(w.load_rhs, w.load_answer, w)
    return sqrt(fabs(power * w.load_answer[row]) + own * own)


def linearize_load(w: Work) -> None:
    """Compute w.load_columns, the responses to w.load_slopes, and w.load_matrix, 1 - dmu/dlam."""
    for k in range(NLOADED):
        for i in range(NV):
            w.load_force[i] = w.load_slopes[k * NV + i]
        load_response(w)
        for i in range(NR):
            w.load_columns[k * NR + i] = w.load_answer[i]
        for i in range(NLOADED):
            own = w.load_answer[NV + loading_row[i]]
            w.load_matrix[i * NLOADED + k] = (1.0 if i == k else 0.0) - own
            w.load_sizes[i * NLOADED + k] = (1.0 if i == k else 0.0) + fabs(own)
        if NHELD > 0:
            if load_held[k] > 0:
                w.load_matrix[k * NLOADED + k] -= 1.0
                w.load_sizes[k * NLOADED + k] = reach_of_actuator(k, w)


def eliminate_load(w: Work) -> Real:
    """Solve w.load_matrix d = w.load_step for d, in its place. Return the sign of the determinant, or 0 with
    w.culprit if the matrix is singular to round-off of its terms."""
    sign = 1.0
    for k in range(NLOADED):
        best = k
        for i in range(k + 1, NLOADED):
            if fabs(w.load_matrix[i * NLOADED + k]) > fabs(w.load_matrix[best * NLOADED + k]):
                best = i
        if best != k:
            sign = -sign
            for j in range(NLOADED):
                kept = w.load_matrix[k * NLOADED + j]
                w.load_matrix[k * NLOADED + j] = w.load_matrix[best * NLOADED + j]
                w.load_matrix[best * NLOADED + j] = kept
                kept = w.load_sizes[k * NLOADED + j]
                w.load_sizes[k * NLOADED + j] = w.load_sizes[best * NLOADED + j]
                w.load_sizes[best * NLOADED + j] = kept
            kept = w.load_step[k]
            w.load_step[k] = w.load_step[best]
            w.load_step[best] = kept
        pivot = w.load_matrix[k * NLOADED + k]
        if not fabs(pivot) > CONTACT_ROUNDOFF * w.load_sizes[k * NLOADED + k]:
            w.culprit = loading_row[k]
            return 0.0
        if pivot < 0.0:
            sign = -sign
        for i in range(k + 1, NLOADED):
            factor = w.load_matrix[i * NLOADED + k] / pivot
            for j in range(k, NLOADED):
                w.load_matrix[i * NLOADED + j] -= factor * w.load_matrix[k * NLOADED + j]
                w.load_sizes[i * NLOADED + j] += fabs(factor) * w.load_sizes[k * NLOADED + j]
            w.load_step[i] -= factor * w.load_step[k]
    for back in range(NLOADED):
        last = NLOADED - 1 - back
        for j in range(last + 1, NLOADED):
            w.load_step[last] -= w.load_matrix[last * NLOADED + j] * w.load_step[j]
        w.load_step[last] /= w.load_matrix[last * NLOADED + last]
    return sign


def load_orientation(p: Params, t: Real, x: Vec[NX], factor: Real, lam: Vec[NC], w: Work) -> Real:
    """Return the sign of the determinant of 1 - dmu/dlam at factor lam, or 0."""
    for i in range(NC):
        w.load_lam[i] = factor * lam[i]
    update_load(p, t, x, w)
    linearize_load(w)
    return eliminate_load(w)


def solve_load(p: Params, t: Real, x: Vec[NX], w: Work) -> bool:
    """Find w.load_lam and w.load_total, the accelerations and multipliers that the loads add. It ends where
    the residual is 64 units in the last place of its terms, or a step 1e-10 of them. Return whether it
    ends."""
    w.load_lam[:] = w.load_free
    if NHELD > 0:
        for k in range(NLOADED):
            if load_held[k] > 0:
                w.load_lam[loading_row[k]] = 0.0
    for turn in range(MOST_LOAD_STEPS):
        update_load(p, t, x, w)
        load_response(w)
        w.load_total[:] = w.load_answer
        done = True
        for k in range(NLOADED):
            row = loading_row[k]
            w.load_step[k] = w.load_free[row] + w.load_answer[NV + row]
            w.load_reach[k] = fabs(w.load_free[row]) + fabs(w.load_answer[NV + row])
            if acts_along(k):
                w.load_step[k] -= w.load_lam[row]
                w.load_reach[k] += fabs(w.load_lam[row])
            if not fabs(w.load_step[k]) <= 64.0 * SPACING * w.load_reach[k]:
                done = False
            if not acts_along(k):
                w.load_reach[k] = fabs(w.load_lam[row])
        if done and (not NHELD > 0 or turn > 0):
            return True
        linearize_load(w)
        if eliminate_load(w) == 0.0:
            return False
        done = True
        for k in range(NLOADED):
            step = w.load_step[k]
            w.load_lam[loading_row[k]] += step
            for i in range(NR):
                w.load_total[i] += step * w.load_columns[k * NR + i]
            if not fabs(step) <= LOAD_STEP * w.load_reach[k]:
                done = False
        if done:
            return True
    w.culprit = loading_row[0]
    return False


def is_one_of_many(p: Params, t: Real, x: Vec[NX], lam: Vec[NC], w: Work) -> bool:
    """Return whether other loads of this kind have no solution or several: the sign of the determinant
    differs between lam and -lam."""
    moved = False
    for k in range(NLOADED):
        if lam[loading_row[k]] != 0.0:
            moved = True
    if not moved:
        return False
    w.culprit = loading_row[0]
    one = load_orientation(p, t, x, 1.0, lam, w)
    return not one * load_orientation(p, t, x, -1.0, lam, w) > 0.0


def motion_at(p: Params, t: Real, x: Vec[NX], xdot: Vec[NX], lam: Vec[NC], w: Work) -> Status:
    """Compute xdot and lam at (t, x). Returns PARADOX, with a row as the culprit, if the loads or dependent
    constraint equations leave the reactions open."""
    status = rhs_at(p, t, x, xdot, lam, w)
    if failed(status):
        return status
    w.culprit = loading_row[0]
    if status == REDUNDANT:  # multipliers of equations that depend on each other are open
        return PARADOX
    w.load_free[:] = lam
    factored = assemble_at(p, t, x, w)
    if failed(factored):
        return factored
    if not solve_load(p, t, x, w):
        return PARADOX
    for i in range(NV):
        xdot[NQ + i] += w.load_total[i]
    for i in range(NC):
        lam[i] += w.load_total[NV + i]
    if NHELD > 0:
        for k in range(NLOADED):
            if load_held[k] > 0:
                lam[loading_row[k]] = w.load_lam[loading_row[k]]
    if NCURVED > 0:
        if is_one_of_many(p, t, x, lam, w):
            return PARADOX
    if NZ > 0:
        w.a[:] = part(xdot, NQ, NQ + NV)
        w.qdot[:] = part(xdot, 0, NQ)
        store_rates(p, t, x, xdot, lam, w)
    w.culprit = not_finite(xdot, NINT)
    return NOT_FINITE if w.culprit >= 0 else status
