"""Radau IIA methods with error estimate and dense output, printed once for each tableau.

A simplified Newton method solves the stages; the transformation of A^-1 parts its linear systems into a real
and a complex one.

E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, Springer 1996 (HW), sections IV.8 and VII.4.
"""

from math import fabs, sqrt

from lagc.kernels.contact.touching import forget_forces, rates_at
from lagc.kernels.integrators.stage_equations import (
    factor_stages,
    residual_at,
    solve_shifted,
    solve_turned,
    update_jacobian,
)
from lagc.kernels.language.vocabulary import *

DIVERGENT = 0.99  # ratio of two increments
MOST_GROWN = 10.0  # the first ratio, which may say little
FAST = 1e-3  # such a ratio below which the derivatives serve again
SAME_SIZE = 1.2  # ratio of two step sizes below which the factors serve again
LEAST_ERROR = 1e-2  # of a step, for the controller
LARGEST = 1e12  # scaled error of a state


def start_stages(h: Real, s: State) -> None:
    """Extrapolate the last step to the stages of a step over h, if it is known."""
    # z(c) of the last step is the cubic through 0 and its three stages, in Newton's form; at 1 + c h / h_old
    # it predicts z of this step, less its end value (HW IV.8, in divided differences).
    known = s.newton.kept_step == s.steps
    for j in static(range(len(C))):
        for i in range(NLAM):
            s.newton.stage_lam[j][i] = s.newton.start_lam[i]
        there = 1.0 + number(C[j]) * h / s.h_old if known else 0.0
        for i in range(NINT):
            s.k[1 + j][i] = 0.0
        if known:
            for i in range(NQ + NV):
                first = (s.k[5][i] / number(C[0]) - s.k[7][i]) / (1.0 - number(C[0]))
                slope = (s.k[6][i] / number(C[1]) - s.k[7][i]) / (1.0 - number(C[1])) - first
                slope /= number(C[1]) - number(C[0])
                value = first + (there - number(C[0])) * slope
                s.k[1 + j][i] = (there - 1.0) * (s.k[7][i] - there * value)
            # Multipliers have no value at the beginning (index 2): a parabola through three stages.
            for i in range(NLAM):
                first = (s.newton.kept_lam[1][i] - s.newton.kept_lam[0][i]) / (number(C[1]) - number(C[0]))
                slope = (s.newton.kept_lam[2][i] - s.newton.kept_lam[1][i]) / (1.0 - number(C[1])) - first
                slope /= 1.0 - number(C[0])
                value = first + (there - number(C[1])) * slope
                s.newton.stage_lam[j][i] = s.newton.kept_lam[0][i] + (there - number(C[0])) * value


def newton_increments(p: Params, t: Real, x: Vec[NX], h: Real, s: State, w: Work) -> Status:
    """Compute the next increments of the stages in w.newton.increments."""
    if NDISC > 0:
        # Discrete variables keep their values within a step.
        keep_discrete(x, w.newton.x_stage)
    for i in range(NX):
        w.newton.x_stage[i] = x[i]
    # Residual of each stage at its state x + z_j and its rates, the row of A^-1 z / h. Dependent constraint
    # equations have none.
    for j in static(range(len(C))):
        for i in range(NQ + NV):
            w.newton.x_stage[i] = x[i] + s.k[1 + j][i]
            w.newton.rates_stage[i] = combination(INVERSE[j], s.k, i) / h
        status = residual_at(p, t + number(C[j]) * h, s.newton.stage_lam[j], w)
        if failed(status):
            return status
        if NLAM > 0:
            for i in range(NLAM):
                if s.newton.dependent[i] == 1:
                    w.newton.residual[NQ + NV + i] = 0.0
        w.newton.stage_residuals[j][:] = w.newton.residual
    s.rhs += len(C)
    # In the basis of A^-1's eigenvectors the three stages fall into one real and one complex system (HW
    # IV.8.5).
    for i in range(NNEWTON):
        first = combination(FORTH[0], w.newton.stage_residuals, i)
        second = combination(FORTH[1], w.newton.stage_residuals, i)
        third = combination(FORTH[2], w.newton.stage_residuals, i)
        w.newton.stage_residuals[0][i] = -first
        w.newton.stage_residuals[1][i] = -second
        w.newton.stage_residuals[2][i] = -third
    solve_shifted(number(SHIFT) / h, s, w.newton.stage_residuals[0], w)
    solve_turned(
        number(SHIFTS[0]) / h,
        number(SHIFTS[1]) / h,
        s,
        w.newton.stage_residuals[1],
        w.newton.stage_residuals[2],
        w,
    )
    # Back from this basis.
    for j in static(range(len(C))):
        for i in range(NNEWTON):
            w.newton.increments[j][i] = combination(BACK[j], w.newton.stage_residuals, i)
    return OK


def scaled_norm(e: Vec[NNEWTON], w: Work) -> Real:
    """Return the root mean square of the coordinates and speeds of e over their weights, each at most
    LARGEST; not a number if one is none."""
    total = 0.0
    # Capped, so that a single state cannot overflow the sum; NaN stays NaN.
    for i in range(NQ + NV):
        own = e[i] / (w.error.weights[i] * w.newton.loosening)
        if fabs(own) > LARGEST:
            own = LARGEST
        total += own * own
    return sqrt(total / float(size(NQ) + NV))


def estimate_roundoff(p: Params, t: Real, x: Vec[NX], h: Real, s: State, w: Work) -> None:
    """Raise w.error.rate_roundoff to the round-off of a step over h, divided by h: the solution of the real
    system for the change of the residual when state, rates, multipliers and the sums of M a are perturbed by
    four units in the last place. Costs two evaluations."""
    # The residual as it is, then with its inputs perturbed, by turns up and down.
    for turn in range(2):
        w.newton.x_stage[:] = x
        w.newton.rates_stage[:] = s.k[0]
        for i in range(NLAM):
            w.lam[i] = s.newton.start_lam[i]
        if turn == 1:
            w.newton.residual_before[:] = w.newton.residual
            for i in range(NQ + NV):
                w.newton.x_stage[i] *= 1.0 + FOUR_ULPS if i % 2 == 0 else 1.0 - FOUR_ULPS
                w.newton.rates_stage[i] *= 1.0 - FOUR_ULPS if i % 2 == 0 else 1.0 + FOUR_ULPS
            for i in range(NLAM):
                w.lam[i] *= 1.0 + FOUR_ULPS if i % 2 == 0 else 1.0 - FOUR_ULPS
        if failed(residual_at(p, t, w.lam, w)):
            return
    s.rhs += 2
    # The difference, and the round-off of the sums of M a, which the perturbation does not reach.
    for i in range(NNEWTON):
        w.newton.residual[i] -= w.newton.residual_before[i]
    for i in range(NV):
        terms = 0.0
        for j in range(NV):
            terms += fabs(s.newton.mass[i * NV + j] * s.k[0][NQ + j])
        w.newton.residual[NQ + i] += FOUR_ULPS * terms if i % 2 == 0 else -FOUR_ULPS * terms
    # A step amplifies it as the real system does.
    solve_shifted(number(SHIFT) / h, s, w.newton.residual, w)
    for i in range(NQ + NV):
        change = fabs(w.newton.residual[i] / h)
        if change > w.error.rate_roundoff[i]:
            w.error.rate_roundoff[i] = change
    s.roundoff_memory = 1.0


def are_roundoff(h: Real, w: Work) -> bool:
    """Return whether all increments are below ten times the round-off, or the tolerance."""
    for j in static(range(len(C))):
        for i in range(NQ + NV):
            least = w.newton.tolerance * w.newton.loosening * w.error.weights[i]
            if not fabs(w.newton.increments[j][i]) <= 10.0 * fabs(h) * w.error.rate_roundoff[i] + least:
                return False
    return True


def add_increments(s: State, x: Vec[NX], w: Work) -> Real:
    """Add the increments to the stages, and to the sizes that their weights are relative to; return their
    largest scaled size, which is no number if one of them is none."""
    for j in static(range(len(C))):
        for i in range(NQ + NV):
            # Rates grow the sizes too: a state at rest gets its weight from what the stages reach.
            s.k[1 + j][i] += w.newton.increments[j][i]
        for i in range(NLAM):
            s.newton.stage_lam[j][i] += w.newton.increments[j][NQ + NV + i]
    for i in range(NQ + NV):
        s.x_new[i] = x[i] + s.k[len(C)][i]
    enlarge_sizes(s.x_new, w.error.sizes)
    for i in range(NQ + NV):
        least = w.newton.rtol * w.error.sizes[scaling_group[i]]
        if least > w.error.weights[i]:
            w.error.weights[i] = least
    largest = 0.0
    for j in static(range(len(C))):
        own = scaled_norm(w.newton.increments[j], w)
        if not own <= largest:
            largest = own
    return largest


def solve_stages(p: Params, t: Real, x: Vec[NX], h: Real, s: State, w: Work) -> Status:
    """Solve the equations of the stages (HW IV.8). Increments that are round-off do not shrink: they end the
    iteration."""
    eta = sqrt(s.newton.eta)
    s.newton.eta = eta  # also where one iteration is enough: a ratio from long ago says little (HW IV.8)
    before = 0.0
    ratio_before = 1.0
    for n in range(w.newton.most):
        # `eta` estimates the sum of the increments that follow over the last one, theta / (1 - theta).
        status = newton_increments(p, t, x, h, s, w)
        if failed(status):
            return status
        now = add_increments(s, x, w)
        if not now <= LARGEST:
            return NOT_CONVERGED
        s.newton.count = n + 1
        if before > 0.0:
            ratio = now / before
            theta = sqrt(ratio * ratio_before) if ratio_before < DIVERGENT else ratio
            ratio_before = ratio
            left = now
            if theta < DIVERGENT:
                eta = theta / (1.0 - theta)
                left = eta * now
                for k in range(w.newton.most - 1 - n):
                    left *= theta
            # `left` is what the last allowed iteration would leave: give up as soon as that is too much (HW
            # IV.8.11).
            if (theta >= DIVERGENT or left > w.newton.tolerance) and (n > 1 or theta > MOST_GROWN):
                if not are_roundoff(h, w):
                    estimate_roundoff(p, t, x, h, s, w)
                return OK if are_roundoff(h, w) else NOT_CONVERGED
            if theta >= DIVERGENT:
                eta = 1.0 / (1.0 - DIVERGENT)
            s.newton.theta = theta
            s.newton.eta = eta
        before = now
        if eta * now <= w.newton.tolerance or (s.roundoff_memory > 0.0 and are_roundoff(h, w)):
            return OK
    return NOT_CONVERGED


def sample_stages(p: Params, t: Real, x: Vec[NX], h: Real, s: State, w: Work) -> Status:
    """Evaluate the rates with contacts at the solved stages: the ranges of their forces, and the power."""
    # Samples of the iteration do not count.
    forget_forces(w)
    w.newton.x_stage[:] = x
    for j in static(range(len(C))):
        for i in range(NQ + NV):
            w.newton.x_stage[i] = x[i] + s.k[1 + j][i]
        status = rates_at(p, t + number(C[j]) * h, w.newton.x_stage, w.xdot, w.lam, w)
        if failed(status):
            return status
        if NZ > 0:
            w.newton.stage_power[1 + j][0] = w.xdot[NQ + NV]
    s.rhs += len(C)
    return OK


def set_stage_power(p: Params, t: Real, x: Vec[NX], h: Real, s: State, w: Work) -> None:
    """Compute the power at the stages without contacts."""
    if NZ > 0:
        # By the rates of the stages, not by an evaluation.
        for i in range(NX):
            w.newton.x_stage[i] = x[i]
        for j in static(range(len(C))):
            for i in range(NQ + NV):
                w.newton.x_stage[i] = x[i] + s.k[1 + j][i]
                w.newton.rates_stage[i] = combination(INVERSE[j], s.k, i) / h
            w.a[:] = part(w.newton.rates_stage, NQ, NQ + NV)
            if NMODE > 0:
                fn_work_on(
                    p, t + number(C[j]) * h, w.newton.x_stage, w.modes, w.a, s.newton.stage_lam[j], w.power
                )
            else:
                fn_work(p, t + number(C[j]) * h, w.newton.x_stage, w.a, s.newton.stage_lam[j], w.power)
            w.newton.stage_power[1 + j][0] = w.power[0]


def add_work(p: Params, t: Real, x: Vec[NX], h: Real, s: State, w: Work) -> Status:
    """Integrate the work over the stages, z = h A power."""
    if NCON > 0:
        status = sample_stages(p, t, x, h, s, w)
        if failed(status):
            return status
    else:
        set_stage_power(p, t, x, h, s, w)
    if NZ > 0:
        for j in static(range(len(C))):
            s.k[1 + j][NQ + NV] = h * combination(A[j], w.newton.stage_power, 0)
    return OK


def stages(p: Params, t: Real, x: Vec[NX], h: Real, s: State, w: Work) -> Status:
    """Compute the stages less x in the rows of s.k from 1 on, and the end of the step in s.x_new. The
    derivatives and factors of a step before are used again while they serve."""
    if s.newton.jacobian_step < 0:
        status = update_jacobian(p, t, x, h, s, w)
        if failed(status):
            return status
    # Without derivatives from an earlier step they are computed first; else tried as they are.
    solved = NOT_CONVERGED
    while failed(solved):
        # The factors belong to one step size.
        if s.newton.factored != h:
            s.newton.factored = h
            if not factor_stages(number(SHIFT) / h, number(SHIFTS[0]) / h, number(SHIFTS[1]) / h, s):
                s.newton.factored = 0.0
                return NOT_CONVERGED
        start_stages(h, s)
        solved = solve_stages(p, t, x, h, s, w)
        if failed(solved):
            # A failure with old derivatives is tried again with new ones; with new ones the step is
            # shortened.
            s.newton.eta = 1.0
            if s.newton.jacobian_step == s.steps:
                return solved
            status = update_jacobian(p, t, x, h, s, w)
            if failed(status):
                return status
    status = add_work(p, t, x, h, s, w)
    if failed(status):
        return status
    # The end of a Radau IIA step is its last stage (c_3 = 1).
    s.x_new[:] = x
    for i in range(NINT):
        s.x_new[i] = x[i] + s.k[len(C)][i]
    return OK


def filter_error(own: Vec[NX], h: Real, s: State, w: Work) -> None:
    """Solve the real system of the Newton method for w.newton.residual, with rates on the right."""
    # Right-hand side M own for speeds, own for coordinates, 0 for constraints.
    for i in range(NQ):
        w.newton.residual[i] = own[i]
    for i in range(NV):
        total = 0.0
        for j in range(NV):
            total += s.newton.mass[i * NV + j] * own[NQ + j]
        w.newton.residual[NQ + i] = total
    for i in range(NLAM):
        w.newton.residual[NQ + NV + i] = 0.0
    solve_shifted(number(SHIFT) / h, s, w.newton.residual, w)


def error(h: Real, s: State, w: Work) -> Real:
    """Return the scaled error, filtered by the matrix of the Newton method (HW IV.8.19), and if it is above 1
    once more (HW IV.8.20, with the derivatives that are known)."""
    own = vector(NX)
    # (HW IV.8.19): the embedded formula has the rate at the beginning and a combination of the stages.
    for i in range(NQ + NV):
        own[i] = s.k[0][i] + combination(ESTIMATE, s.k, i) / h
    filter_error(own, h, s, w)
    found = scaled_norm(w.newton.residual, w)
    # The filter twice for first steps and rejected ones, which makes the estimate bounded for stiff parts.
    if found > 1.0:
        for i in range(NQ + NV):
            own[i] = w.newton.residual[i] * (number(SHIFT) / h)
        filter_error(own, h, s, w)
        found = scaled_norm(w.newton.residual, w)
    return found


def next_size(s: State, a: Trial) -> Real:
    """Return the size of the next step, by the predictive controller (HW IV.8.25). A size that is nearly the
    last one stays, so that the factors serve again."""
    # 0.9 (2 k + 1) / (2 k + n): fewer iterations allow a bolder step (HW IV.8).
    safety = 0.9 * (2.0 * MOST_ITERATED + 1.0) / (2.0 * MOST_ITERATED + float(s.newton.count))
    factor = sqrt(sqrt(a.error)) / safety
    # K. Gustafsson's predictive controller: the ratio of the last two errors over that of the sizes.
    if s.h_old != 0.0:
        predicted = fabs(s.h_old) / a.size * sqrt(a.error / sqrt(s.error_old)) / 0.9
        if predicted > factor:
            factor = predicted
    s.error_old = a.error if a.error > LEAST_ERROR else LEAST_ERROR
    # Bounds of growth and reduction; then the dead zone, in which factors need not be computed anew.
    if factor > 1.0 / number(SHRINK):
        factor = 1.0 / number(SHRINK)
    if factor < 1.0 / number(GROW):
        factor = 1.0 / number(GROW)
    if s.newton.theta <= FAST and factor <= 1.0 and factor * SAME_SIZE >= 1.0:
        factor = 1.0
    return a.size / factor


def reduced_size(a: Trial) -> Real:
    """Return the size of the next attempt after an error above 1."""
    factor = sqrt(sqrt(a.error)) / 0.9
    return a.size / (factor if factor < 1.0 / number(SHRINK) else 1.0 / number(SHRINK))


def keep_stages(s: State) -> None:
    """Keep the stages of a step that is accepted, to extrapolate them; and the derivatives, if the Newton
    method converged fast by them."""
    for j in static(range(len(C))):
        s.k[5 + j][:] = s.k[1 + j]
        for i in range(NLAM):
            s.newton.kept_lam[j][i] = s.newton.stage_lam[j][i]
    for i in range(NLAM):
        s.newton.start_lam[i] = s.newton.stage_lam[len(C) - 1][i]
    if s.newton.theta > FAST:
        s.newton.jacobian_step = -1
    s.newton.kept_step = s.steps + 1


def restore_stages(s: State) -> None:
    """Take the kept stages for those of the last step."""
    for j in static(range(len(C))):
        s.k[1 + j][:] = s.k[5 + j]


def stage_deviation(i: int, h: Real, s: State) -> Real:
    """Return the largest deviation of the rate of a state at the stages from the slope of the cubic between
    the ends of the step from s.x to s.x_new."""
    # Rates of the stages by A^-1 z / h against the slope of the cubic Hermite interpolant.
    mean = (s.x_new[i] - s.x[i]) / h
    far = 0.0
    for j in static(range(len(C))):
        c = number(C[j])
        slope = 6.0 * c * (1.0 - c) * mean + (1.0 - c) * (1.0 - 3.0 * c) * s.k[0][i]
        own = fabs(combination(INVERSE[j], s.k, i) / h - slope - c * (3.0 * c - 2.0) * s.k[END_RATE][i])
        if own > far:
            far = own
    return far


def dense_output(p: Params, t: Real, x: Vec[NX], z: Vec[NX], h: Real, s: State, w: Work) -> Status:
    """Compute the coefficients s.r of the polynomial through x, the inner stages and z, the end of the
    step."""
    if NDISC > 0:
        keep_discrete(x, s.r[0])
    # Newton's form of the cubic through c = 0, c_1, c_2, 1.
    for i in range(NINT):
        s.r[0][i] = x[i]
        s.r[1][i] = z[i] - x[i]
        s.r[2][i] = (s.k[1][i] / number(C[0]) - s.r[1][i]) / (1.0 - number(C[0]))
        s.r[3][i] = (s.k[2][i] / number(C[1]) - s.r[1][i]) / (1.0 - number(C[1])) - s.r[2][i]
        s.r[3][i] /= number(C[1]) - number(C[0])
        s.r[2][i] -= number(C[0]) * s.r[3][i]
    return OK


def dense_state(part: Real, i: int, s: State) -> Real:
    """Return a state at a part of the last step by its dense output."""
    return s.r[0][i] + part * (s.r[1][i] + (1.0 - part) * (s.r[2][i] + part * s.r[3][i]))


def dense_at(part: Real, s: State, x: Vec[NX]) -> None:
    """Evaluate the dense output at a part of the last step."""
    if NDISC > 0:
        keep_discrete(s.r[0], x)
    for i in range(NINT):
        x[i] = dense_state(part, i, s)
