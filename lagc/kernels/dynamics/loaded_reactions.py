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
    """Compute w.loads.force and w.loads.slopes at w.loads.lam."""
    # Loads may depend on normal forces of contacts, on modes, or on neither: a model has one function for its
    # case.
    if NPUSHED > 0:
        fn_pushed_on(p, t, x, w.modes, w.loads.lam, w.contacts.forces, w.loads.force, w.loads.slopes)
    elif NMODE > 0:
        fn_loaded_on(p, t, x, w.modes, w.loads.lam, w.loads.force, w.loads.slopes)
    else:
        fn_loaded(p, t, x, w.loads.lam, w.loads.force, w.loads.slopes)


def load_response(w: Work) -> None:
    """Compute w.loads.answer, the accelerations and multipliers by w.loads.force alone."""
    for i in range(NR):
        w.loads.rhs[i] = w.loads.force[i] if i < NV else 0.0
    solve_at(w.loads.rhs, w.loads.answer, w)


def acts_along(k: int) -> bool:
    """Return whether the multiplier of a row acts along its gradient, as without an actuator."""
    if NHELD > 0:
        return load_held[k] == 0
    return True


def reach_of_actuator(k: int, w: Work) -> Real:
    """Return the most by which the multiplier of a held row can follow the force w.loads.force, whose
    response is w.loads.answer, by the inequality of Cauchy and Schwarz in the metric of the inverse mass
    matrix."""
    row = NV + loading_row[k]
    # The multiplier of the row for the force f is e^T K^-1 f; squared it is at most (f K^-1 f) (e K^-1 e)
    # along the constraints. Its own value is added, so that a bound of zero means that it cannot follow.
    own = w.loads.answer[row]
    power = 0.0
    for i in range(NV):
        power += w.loads.force[i] * w.loads.answer[i]
    for i in range(NR):
        w.loads.rhs[i] = 1.0 if i == row else 0.0
    solve_at(w.loads.rhs, w.loads.answer, w)
    return sqrt(fabs(power * w.loads.answer[row]) + own * own)


def linearize_load(w: Work) -> None:
    """Compute w.loads.columns, the responses to w.loads.slopes, and w.loads.matrix, 1 - dmu/dlam."""
    # One solve for each derivative: column k of dmu/dlam, with the sizes of terms for a test of round-off.
    for k in range(NLOADED):
        for i in range(NV):
            w.loads.force[i] = w.loads.slopes[k * NV + i]
        load_response(w)
        for i in range(NR):
            w.loads.columns[k * NR + i] = w.loads.answer[i]
        for i in range(NLOADED):
            own = w.loads.answer[NV + loading_row[i]]
            w.loads.matrix[i * NLOADED + k] = (1.0 if i == k else 0.0) - own
            w.loads.sizes[i * NLOADED + k] = (1.0 if i == k else 0.0) + fabs(own)
        # A held row is mu(lam) = 0 instead of mu(lam) = lam: its 1 on the diagonal goes.
        if NHELD > 0:
            if load_held[k] > 0:
                w.loads.matrix[k * NLOADED + k] -= 1.0
                w.loads.sizes[k * NLOADED + k] = reach_of_actuator(k, w)


def eliminate_load(w: Work) -> Real:
    """Solve w.loads.matrix d = w.loads.step for d, in its place. Return the sign of the determinant, or 0
    with w.culprit if the matrix is singular to round-off of its terms."""
    sign = 1.0
    for k in range(NLOADED):
        # Partial pivoting; `sizes` go with their rows.
        best = k
        for i in range(k + 1, NLOADED):
            if fabs(w.loads.matrix[i * NLOADED + k]) > fabs(w.loads.matrix[best * NLOADED + k]):
                best = i
        if best != k:
            sign = -sign
            for j in range(NLOADED):
                kept = w.loads.matrix[k * NLOADED + j]
                w.loads.matrix[k * NLOADED + j] = w.loads.matrix[best * NLOADED + j]
                w.loads.matrix[best * NLOADED + j] = kept
                kept = w.loads.sizes[k * NLOADED + j]
                w.loads.sizes[k * NLOADED + j] = w.loads.sizes[best * NLOADED + j]
                w.loads.sizes[best * NLOADED + j] = kept
            kept = w.loads.step[k]
            w.loads.step[k] = w.loads.step[best]
            w.loads.step[best] = kept
        # A pivot is zero if it is round-off of the terms that were summed to it.
        pivot = w.loads.matrix[k * NLOADED + k]
        if not fabs(pivot) > CONTACT_ROUNDOFF * w.loads.sizes[k * NLOADED + k]:
            w.culprit = loading_row[k]
            return 0.0
        if pivot < 0.0:
            sign = -sign
        for i in range(k + 1, NLOADED):
            factor = w.loads.matrix[i * NLOADED + k] / pivot
            for j in range(k, NLOADED):
                w.loads.matrix[i * NLOADED + j] -= factor * w.loads.matrix[k * NLOADED + j]
                w.loads.sizes[i * NLOADED + j] += fabs(factor) * w.loads.sizes[k * NLOADED + j]
            w.loads.step[i] -= factor * w.loads.step[k]
    # Back substitution.
    for back in range(NLOADED):
        last = NLOADED - 1 - back
        for j in range(last + 1, NLOADED):
            w.loads.step[last] -= w.loads.matrix[last * NLOADED + j] * w.loads.step[j]
        w.loads.step[last] /= w.loads.matrix[last * NLOADED + last]
    return sign


def keep_load_matrix(w: Work) -> None:
    """Compute the responses to w.loads.slopes, for `follow_loads`."""
    linearize_load(w)
    for k in range(NLOADMATRIX):
        w.loads.matrix_kept[k] = w.loads.matrix[k]
        w.loads.sizes_kept[k] = w.loads.sizes[k]


def follow_loads(solution: Vec[NR], w: Work) -> bool:
    """Add to a response, accelerations and multipliers, that of the loads of its multipliers. Return False,
    with the constraint equation as w.culprit, if they leave these open."""
    # (I - C) s = s_response: matrix and sizes are overwritten by the elimination, so they are copied. s are
    # the multipliers with the loads that they cause.
    for k in range(NLOADMATRIX):
        w.loads.matrix[k] = w.loads.matrix_kept[k]
        w.loads.sizes[k] = w.loads.sizes_kept[k]
    for k in range(NLOADED):
        w.loads.step[k] = solution[NV + loading_row[k]]
    if eliminate_load(w) == 0.0:
        return False
    # Each multiplier adds the response of the loads that follow it.
    for k in range(NLOADED):
        for i in range(NR):
            solution[i] += w.loads.step[k] * w.loads.columns[k * NR + i]
    # These multipliers are the solution itself: to set them removes the round-off of the sum.
    for k in range(NLOADED):
        solution[NV + loading_row[k]] = w.loads.step[k]
    return True


def load_orientation(p: Params, t: Real, x: Vec[NX], factor: Real, lam: Vec[NC], w: Work) -> Real:
    """Return the sign of the determinant of 1 - dmu/dlam at factor lam, or 0."""
    # Determinants are compared at lam and -lam: different signs there mean that some right-hand side has no
    # solution, or several (S. Scholtes, 2.3).
    for i in range(NC):
        w.loads.lam[i] = factor * lam[i]
    update_load(p, t, x, w)
    linearize_load(w)
    return eliminate_load(w)


def solve_load(p: Params, t: Real, x: Vec[NX], w: Work) -> bool:
    """Find w.loads.lam and w.loads.total, the accelerations and multipliers that the loads add. It ends where
    the residual is 64 units in the last place of its terms, or a step 1e-10 of them. Return whether it
    ends."""
    # Newton's method for lam = free + response to the loads at lam, from the reactions without loads.
    w.loads.lam[:] = w.loads.free
    if NHELD > 0:
        for k in range(NLOADED):
            if load_held[k] > 0:
                w.loads.lam[loading_row[k]] = 0.0
    for turn in range(MOST_LOAD_STEPS):
        # Residual of each loading row, and the size of its terms. A held row demands that the sum vanishes.
        update_load(p, t, x, w)
        load_response(w)
        w.loads.total[:] = w.loads.answer
        done = True
        for k in range(NLOADED):
            row = loading_row[k]
            w.loads.step[k] = w.loads.free[row] + w.loads.answer[NV + row]
            w.loads.reach[k] = fabs(w.loads.free[row]) + fabs(w.loads.answer[NV + row])
            if acts_along(k):
                w.loads.step[k] -= w.loads.lam[row]
                w.loads.reach[k] += fabs(w.loads.lam[row])
            if not fabs(w.loads.step[k]) <= 64.0 * SPACING * w.loads.reach[k]:
                done = False
            if not acts_along(k):
                w.loads.reach[k] = fabs(w.loads.lam[row])
        if done and (not NHELD > 0 or turn > 0):
            return True
        # The step by the derivatives of the loads; accelerations and multipliers follow linearly.
        linearize_load(w)
        if eliminate_load(w) == 0.0:
            return False
        done = True
        for k in range(NLOADED):
            step = w.loads.step[k]
            w.loads.lam[loading_row[k]] += step
            for i in range(NR):
                w.loads.total[i] += step * w.loads.columns[k * NR + i]
            if not fabs(step) <= LOAD_STEP * w.loads.reach[k]:
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
    # Rates and multipliers without the loads, from the right-hand side that all models have.
    status = rhs_at(p, t, x, xdot, lam, w)
    if failed(status):
        return status
    w.culprit = loading_row[0]
    if status == REDUNDANT:  # multipliers of equations that depend on each other are open
        return PARADOX
    # The motion without loads, then their share on top of it, with the same factors.
    w.loads.free[:] = lam
    factored = assemble_at(p, t, x, w)
    if failed(factored):
        return factored
    if not solve_load(p, t, x, w):
        return PARADOX
    for i in range(NV):
        xdot[NQ + i] += w.loads.total[i]
    for i in range(NC):
        lam[i] += w.loads.total[NV + i]
    # The multiplier of a held row is that of its actuator.
    if NHELD > 0:
        for k in range(NLOADED):
            if load_held[k] > 0:
                lam[loading_row[k]] = w.loads.lam[loading_row[k]]
    if NCURVED > 0:
        if is_one_of_many(p, t, x, lam, w):
            return PARADOX
    # The power depends on the loads.
    if NZ > 0:
        w.a[:] = part(xdot, NQ, NQ + NV)
        w.qdot[:] = part(xdot, 0, NQ)
        store_rates(p, t, x, xdot, lam, w)
    w.culprit = not_finite(xdot, NINT)
    return NOT_FINITE if w.culprit >= 0 else status
