"""Sensitivities on the stages of a step, printed once for each tableau.

S is integrated on the stages of the motion by the same method, which gives the derivative of the steps
themselves (H. G. Bock, Numerical treatment of inverse problems in chemical reaction kinetics, 1981; Hairer,
Norsett, Wanner, Solving Ordinary Differential Equations I, section II.6).
"""

from math import inf, sqrt
from typing import Any

from lagc.kernels.language.vocabulary import *
from lagc.kernels.sensitivity.tangents import direction_rates, factor_tangents, look_at


def look_at_stage(p: Params, t: Real, rates: Vec[NX], w: Work, v: TangentWork) -> Status:
    """Factor K at the stage (t, v.x) with these rates of the motion; the multipliers are computed again."""
    if NC > 0:
        return look_at(p, t, v.x, w, v)
    v.a[:] = part(rates, NQ, NQ + NV)
    return factor_tangents(p, t, v.x, w, v)


def load_rows(table: Rows[NX], first: Length, count: int, v: TangentWork) -> None:
    """Copy the first rates of S of a direction."""
    for j in range(count):
        v.k[j][:] = table[first + j]


def tangent_stages(
    p: Params, s: State, m: Length, columns: IVec[Any], now: Rows[NX], after: Rows[NX], table: Rows[NX],
    noise: Rows[NGROUP], w: Work, v: TangentWork,
) -> Status:  # fmt: skip
    """Compute the rates of S at all stages of the last step, and S at its end before the projection."""
    for j in static(range(len(C))):
        if j == 0:
            v.x[:] = s.x_old
        else:
            for i in range(NX):
                v.x[i] = s.x_old[i] + s.h_old * combination(A[j], s.k, i)
        # Stage j of the motion, whose accelerations s.k[j] has: K is factored there once for all directions.
        t = s.t_old + number(C[j]) * s.h_old
        status = look_at_stage(p, t, s.k[j], w, v)
        if failed(status):
            return status
        for k in range(m):
            if j == 0:
                v.own[:] = now[k]
            else:
                load_rows(table, k * NK, j, v)
                for i in range(NX):
                    v.own[i] = now[k][i] + s.h_old * combination(A[j], v.k, i)
            if columns[k] >= 0:
                v.seeds[columns[k]] = 1.0
            status = direction_rates(p, t, v.x, v.own, noise[k], table[k * NK + j], w, v)
            if columns[k] >= 0:
                v.seeds[columns[k]] = 0.0
            if failed(status):
                return status
    # S at the end of the step, by the weights of the method.
    for k in range(m):
        load_rows(table, k * NK, len(C), v)
        for i in range(NX):
            after[k][i] = now[k][i] + s.h_old * combination(B, v.k, i)
    return OK


def tangent_error(h: Real, v: TangentWork) -> Real:
    """Return the scaled error of S in one direction, with the rates v.k, as that of the motion."""
    if len(ERROR) == 0:
        return 0.0
    # States without weight, as discrete ones, do not count.
    n = 0.0
    first = 0.0
    if len(ERROR) == 2:
        second = 0.0
    for i in range(NQ + NV):
        if v.weights[i] > 0.0:
            n += 1.0
            e = h * combination(ERROR[0], v.k, i) / v.weights[i]
            first += e * e
            if len(ERROR) == 2:
                e = h * combination(ERROR[1], v.k, i) / v.weights[i]
                second += e * e
    if len(ERROR) == 2:
        total = n * (first + 0.01 * second)
        if not total < inf:
            return inf
        return first / sqrt(total) if total > 0.0 else 0.0
    if not first < inf:
        return inf
    return sqrt(first / n) if first > 0.0 else 0.0


def tangent_extra(
    p: Params, s: State, m: Length, columns: IVec[Any], now: Rows[NX], table: Rows[NX],
    noise: Rows[NGROUP], w: Work, v: TangentWork,
) -> Status:  # fmt: skip
    """Compute the rates of S at the additional stages of the dense output, which the motion has already."""
    # The motion has its extra stages already: S follows at the same points.
    for j in static(range(len(EXTRA_C))):
        for i in range(NX):
            v.x[i] = s.x_old[i] + s.h_old * combination(EXTRA_A[j], s.k, i)
        t = s.t_old + number(EXTRA_C[j]) * s.h_old
        status = look_at_stage(p, t, s.k[len(C) + 1 + j], w, v)
        if failed(status):
            return status
        for k in range(m):
            load_rows(table, k * NK, len(C) + 1 + j, v)
            for i in range(NX):
                v.own[i] = now[k][i] + s.h_old * combination(EXTRA_A[j], v.k, i)
            if columns[k] >= 0:
                v.seeds[columns[k]] = 1.0
            status = direction_rates(p, t, v.x, v.own, noise[k], table[k * NK + len(C) + 1 + j], w, v)
            if columns[k] >= 0:
                v.seeds[columns[k]] = 0.0
            if failed(status):
                return status
    return OK


def tangent_dense(
    share: Real, h: Real, k: Length, now: Rows[NX], after: Rows[NX], table: Rows[NX], found: Vec[NX],
    v: TangentWork,
) -> None:  # fmt: skip
    """Evaluate the dense output of S in direction k at a share of the step."""
    load_rows(table, k * NK, len(C) + 1 + len(EXTRA_C), v)
    # As the motion's dense output: Hermite's cubic and its corrections, from S, its change and its rates.
    rest = 1.0 - share
    for i in range(NX):
        change = after[k][i] - now[k][i]
        curvature = h * v.k[0][i] - change
        value = 0.0
        for j in static(range(len(DENSE) - 1, -1, -1)):
            value = h * combination(DENSE[j], v.k, i) + (share if j % 2 == 0 else rest) * value
        value = change - h * v.k[len(C)][i] - curvature + rest * value
        found[i] = now[k][i] + share * (change + rest * (curvature + share * value))
