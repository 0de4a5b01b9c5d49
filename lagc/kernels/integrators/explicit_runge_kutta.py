"""Explicit Runge-Kutta methods with error estimate and dense output, printed once for each tableau.

E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, Springer 1993 (HNW),
sections II.4 (error), II.6 (dense output), II.10 (DOP853).
"""

from math import fabs, inf, sqrt

from lagc.kernels.contact.touching import rates_at
from lagc.kernels.language.vocabulary import *


def stages(p: Params, t: Real, x: Vec[NX], h: Real, s: State, w: Work) -> Status:
    """Compute k_2 ... k_s from k_1, k_i = f(t + c_i h, x + h sum a_ij k_j), and the end of the step in
    s.x_new (HNW II.1.8)."""
    s.rhs += len(C) - 1
    own = vector(NX)  # a copy of x that does not alias s, so that compilers vectorize the loops
    own[:] = x
    if NDISC > 0:
        keep_discrete(x, s.x_new)
    # One function evaluation for each stage; coefficients are printed as numbers, zeros left out.
    for j in static(range(1, len(C))):
        for i in range(NINT):
            s.x_new[i] = own[i] + h * combination(A[j], s.k, i)
        status = rates_at(p, t + number(C[j]) * h, s.x_new, s.k[j], w.lam, w)
        if failed(status):
            return status
    for i in range(NINT):
        s.x_new[i] = own[i] + h * combination(B, s.k, i)
    return OK


def error_sums(h: Real, s: State, w: Work, sums: Out[TWO]) -> None:
    """Compute the sums over coordinates and speeds of the squares of the estimates over w.error.weights."""
    if len(ERROR) > 0:
        first = 0.0
        second = 0.0
        for i in range(NQ + NV):
            e = h * combination(ERROR[0], s.k, i) / w.error.weights[i]
            first += e * e
            if len(ERROR) == 2:
                e = h * combination(ERROR[1], s.k, i) / w.error.weights[i]
                second += e * e
        sums[0] = first
        sums[1] = second


def error_of_sums(first: Real, second: Real) -> Real:
    """Return the scaled error: the root mean square of the estimate over the weights (HNW II.4.11). Two
    estimates e5 and e3 are combined to |e5|^2 / sqrt(|e5|^2 + 0.01 |e3|^2) (HNW II.10.17). Infinite if it
    overflows."""
    n = size(NQ) + NV
    if len(ERROR) == 2:
        total = n * (first + 0.01 * second)
        if not total < inf:
            return inf
        return first / sqrt(total) if total > 0.0 else 0.0
    return sqrt(first / n) if first < inf else inf


def error(h: Real, s: State, w: Work) -> Real:
    """Return the scaled error of a step; 0 for a method without estimate."""
    if len(ERROR) == 0:
        return 0.0
    sums = vector(TWO)
    error_sums(h, s, w, sums)
    return error_of_sums(sums[0], sums[1])


def add_stability(s: State, w: Work) -> None:
    """Add the scaled squares of two differences between the last stage and the end of the step, which have
    the same time: h times that of the rates over h |lambda| at the border of stability, and that of the
    states. Their quotient is (h |lambda|)^2 in these units (Hairer, Wanner, Solving Ordinary Differential
    Equations II, 1996, IV.2.5)."""
    if len(STABILITY) > 0:
        h = s.h_old / number(STABILITY[0])
        for i in range(NQ + NV):
            apart = h * (s.k[len(C)][i] - s.k[len(C) - 1][i]) / w.error.weights[i]
            s.rates_apart += apart * apart
            stage = s.x_old[i] + s.h_old * combination(A[len(C) - 1], s.k, i)
            apart = (s.x[i] - stage) / w.error.weights[i]
            s.states_apart += apart * apart


def error_parts(s: State, w: Work) -> None:
    """Compute the error estimates as vectors in w.error.parts, without the factor h."""
    if NH > 0:
        for j in static(range(len(ERROR))):
            for i in range(NINT):
                w.error.parts[j][i] = combination(ERROR[j], s.k, i)


def stage_deviation(i: int, h: Real, s: State) -> Real:
    """Return the largest deviation of the rate of a state at the stages from the slope of the cubic between
    the ends of the step from s.x to s.x_new."""
    # Slope of the cubic Hermite interpolant at c: 6 c (1 - c) mean + (1 - c)(1 - 3 c) x0' + c (3 c - 2) x1'.
    mean = (s.x_new[i] - s.x[i]) / h
    far = 0.0
    for j in static(range(1, len(C))):
        c = number(C[j])
        slope = 6.0 * c * (1.0 - c) * mean + (1.0 - c) * (1.0 - 3.0 * c) * s.k[0][i]
        own = fabs(s.k[j][i] - slope - c * (3.0 * c - 2.0) * s.k[len(C)][i])
        if own > far:
            far = own
    return far


def dense_output(p: Params, t: Real, x: Vec[NX], z: Vec[NX], h: Real, s: State, w: Work) -> Status:
    """Compute the coefficients s.r of the dense output of the step from x to z (HNW II.6, II.10.4)."""
    # Additional stages of DOP853's dense output, evaluated only where it is asked for.
    if NDISC > 0:
        keep_discrete(x, s.x_new)
        keep_discrete(x, s.r[0])
    for j in static(range(len(EXTRA_C))):
        for i in range(NINT):
            s.x_new[i] = x[i] + h * combination(EXTRA_A[j], s.k, i)
        status = rates_at(p, t + number(EXTRA_C[j]) * h, s.x_new, s.k[len(C) + 1 + j], w.lam, w)
        if failed(status):
            return status
    # The first four coefficients are those of the cubic Hermite interpolant, in Horner's form of HNW II.6.
    for i in range(NINT):
        s.r[0][i] = x[i]
        s.r[1][i] = z[i] - x[i]
        s.r[2][i] = h * s.k[0][i] - s.r[1][i]
        s.r[3][i] = s.r[1][i] - h * s.k[len(C)][i] - s.r[2][i]
        for j in static(range(len(DENSE))):
            s.r[4 + j][i] = h * combination(DENSE[j], s.k, i)
    return OK


def dense_state(part: Real, i: int, s: State) -> Real:
    """Return a state at a part of the last step by its dense output."""
    # x0 + c (r1 + (1 - c)(r2 + c (r3 + ...))): factors c and 1 - c by turns.
    rest = 1.0 - part
    value = s.r[3 + len(DENSE)][i]
    for j in static(range(2 + len(DENSE), -1, -1)):
        value = s.r[j][i] + (part if j % 2 == 0 else rest) * value
    return value


def dense_at(part: Real, s: State, x: Vec[NX]) -> None:
    """Evaluate the dense output at a part of the last step."""
    if NDISC > 0:
        keep_discrete(s.r[0], x)
    for i in range(NINT):
        x[i] = dense_state(part, i, s)
