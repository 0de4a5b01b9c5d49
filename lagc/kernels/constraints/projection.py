"""States put back onto their constraints."""

from __future__ import annotations

from math import fabs, inf
from typing import Any

from lagc.kernels.arithmetic.quaternions import normalise
from lagc.kernels.dynamics.rhs import assemble_entries, factor_safely, system_at
from lagc.kernels.language.model import (
    fn_displace,
    fn_factor,
    fn_position,
    fn_reaches,
    fn_rest,
    fn_scales,
    fn_solve,
    fn_velocity,
)
from lagc.kernels.language.records import Work
from lagc.kernels.language.scaling_groups import RESTING
from lagc.kernels.language.sizes import HAS_DISPLACE, NC, NH, NKIND, NM, NQ, NQUAT, NR, NV, NX, STRAIGHT
from lagc.kernels.language.statuses import INCONSISTENT, OK, failed
from lagc.kernels.language.tolerances import LARGEST_RESIDUAL, LEAST_PIVOT, LEFT_OVER, UNTOUCHED
from lagc.kernels.language.words import Params, Real, Size, Status, Vec, by_type, part
from lagc.kernels.linear_algebra.rank_revealing import solve_fallback
from lagc.kernels.linear_algebra.sparse_rank_revealing import factor_whole

MOST_TURNS = 8  # of simplified Newton iterations
HOPELESS = by_type(1e-3, 1e-6, "1e-6")  # scaled residual with which a projection has failed


def assemble_at(p: Params, t: Real, x: Vec[NX], w: Work) -> Status:
    """Factors of [M G^T; G 0] at (t, x)."""
    if STRAIGHT:
        if not w.lost:
            assemble_entries(p, t, x, w)
            if NM > 0:
                fn_factor(w.entries, w.health)
                if w.health[0] >= LEAST_PIVOT and w.health[1] <= LARGEST_RESIDUAL:
                    w.dense = False
                    return OK
            elif factor_whole(w):
                return OK
    if NM > 0:
        w.dense = True
    return factor_safely(p, t, x, w)


def solve_at(r: Vec[NR], s: Vec[NR], w: Work) -> None:
    """M s1 - G^T s2 = r1, G s1 = r2"""
    if NM > 0:
        if STRAIGHT:
            if not w.dense:
                fn_solve(w.entries, r, s)
                return
        w.a[:] = part(r, 0, NV)
        w.tail[:] = part(r, NV, NV + NC)
        solve_fallback(w, w.tail, w.a, w.mu)
        s[:NV] = w.a
        s[NV : NV + NC] = w.mu
    else:
        fn_solve(w.entries, r, s)


def measure(p: Params, t: Real, x: Vec[NX], sizes: Vec[NKIND], w: Work) -> None:
    """w.scales: what residuals are judged by, and w.rates; `sizes` are those of the trajectory."""
    w.own[:] = sizes
    if w.own[0] > 1.0:
        w.own[0] = 1.0
    fn_scales(p, t, x, w.scales)
    fn_reaches(p, t, x, w.own, w.reaches)
    for i in range(NC):
        w.scales[i] += RESTING * w.reaches[i]
    w.rates[:] = w.scales
    if NH > 0:
        for i in range(NH):
            w.rates[i] = w.reaches[NC + i]


def residual(values: Vec[Any], n: Size, scales: Vec[NC]) -> Real:
    """The largest of |value| / scale; infinity where one is not a number."""
    worst = 0.0
    for i in range(n):
        size = fabs(values[i]) / scales[i]
        if not size <= worst:
            worst = size if size == size else inf
    return worst


def worst_row(values: Vec[Any], n: Size, scales: Vec[NC]) -> int:
    """The row with the largest scaled residual."""
    row = 0
    worst = 0.0
    for i in range(n):
        size = fabs(values[i]) / scales[i]
        if not size <= worst:
            row = i
            worst = size
    return row


def row_rates(e: Vec[NX], w: Work) -> None:
    """w.rows = G e for the speeds of e."""
    if NM > 0:
        for i in range(NC):
            total = 0.0
            for j in range(NV):
                total += w.G[i * NV + j] * e[NQ + j]
            w.rows[i] = total
    else:
        for i in range(NC):
            w.right[NV + i] = 0.0
            w.left[NV + i] = 0.0
        for j in range(NV):
            w.left[j] = e[NQ + j]
        fn_rest(w.entries, w.right, w.left, w.rest)
        for i in range(NC):
            w.rows[i] = -w.rest[NV + i]


def tangents(p: Params, t: Real, x: Vec[NX], w: Work) -> bool:
    """Take from the parts of the error of a state near x what lies along the constraints in their speeds,
    in the metric of the mass matrix: projection takes it from the state.  False where it cannot be told."""
    lost = w.lost
    culprit = w.culprit
    for i in range(NC):
        w.known[i] = w.redundant[i]
    if NM > 0:
        system_at(p, t, x, w)
    status = assemble_at(p, t, x, w)
    if not failed(status):
        for j in range(NV):
            w.right[j] = 0.0
        for k in range(2):
            e = w.parts[k]
            row_rates(e, w)
            for i in range(NC):
                w.right[NV + i] = -w.rows[i]
            solve_at(w.right, w.left, w)
            for j in range(NV):
                e[NQ + j] += w.left[j]
    w.lost = lost
    w.culprit = culprit
    for i in range(NC):
        w.redundant[i] = w.known[i]
    return not failed(status)


def shift(p: Params, t: Real, x: Vec[NX], y: Vec[NX], w: Work) -> None:
    """y = x with its coordinates moved by the displacement w.left."""
    y[:] = x
    if HAS_DISPLACE:
        fn_displace(p, t, x, w.left, w.dq)
        for i in range(NQ):
            y[i] += w.dq[i]
    else:
        for i in range(NQ):
            y[i] += w.left[i]


def nudge(p: Params, t: Real, x: Vec[NX], sizes: Vec[NKIND], w: Work) -> bool:
    """w.nudged: a state beside x, off its constraints by what projection leaves, in the direction that costs
    most in the metric of the mass matrix, with speeds that fit.  False where that cannot be told."""
    if failed(assemble_at(p, t, x, w)):
        return False
    measure(p, t, x, sizes, w)
    for i in range(NV):
        w.right[i] = 0.0
    for i in range(NC):
        w.right[NV + i] = (LEFT_OVER if i % 2 == 0 else -LEFT_OVER) * w.scales[i]
    solve_at(w.right, w.left, w)
    shift(p, t, x, w.nudged, w)
    fn_velocity(p, t, w.nudged, w.rows)
    for i in range(NC):
        w.right[NV + i] = -w.rows[i]
    solve_at(w.right, w.left, w)
    for i in range(NV):
        w.nudged[NQ + i] += w.left[i]
    return True


def project_positions(p: Params, t: Real, x: Vec[NX], w: Work) -> Status:
    """Simplified Newton iterations, M d = G^T mu, G d = -phi, dq = N d."""
    fn_position(p, t, x, w.rows)
    w.position_left = residual(w.rows, NH, w.scales)
    for n in range(MOST_TURNS):
        if w.position_left <= (UNTOUCHED if n == 0 else LEFT_OVER):
            break
        if not w.assembled:
            status = assemble_at(p, t, x, w)
            if failed(status):
                return status
            w.assembled = True
        for i in range(NC):
            w.right[NV + i] = 0.0
        for i in range(NH):
            w.right[NV + i] = -w.rows[i]
        solve_at(w.right, w.left, w)
        shift(p, t, x, w.moved, w)
        if NQUAT > 0:
            normalise(w.moved)
        fn_position(p, t, w.moved, w.rows)
        size = residual(w.rows, NH, w.scales)
        if not size < w.position_left:
            break
        for i in range(NQ):
            x[i] = w.moved[i]
        w.position_left = size
    if w.position_left > HOPELESS:
        w.culprit = worst_row(w.rows, NH, w.scales)
        return INCONSISTENT
    return OK


def project_speeds(p: Params, t: Real, x: Vec[NX], w: Work) -> Status:
    """M dv = G^T mu, G dv = -psi."""
    fn_velocity(p, t, x, w.rows)
    w.velocity_left = residual(w.rows, NC, w.rates)
    for n in range(MOST_TURNS):
        if w.velocity_left <= (UNTOUCHED if n == 0 else LEFT_OVER):
            break
        if not w.assembled:
            status = assemble_at(p, t, x, w)
            if failed(status):
                return status
            w.assembled = True
        for i in range(NC):
            w.right[NV + i] = -w.rows[i]
        solve_at(w.right, w.left, w)
        w.moved[:] = x
        for i in range(NV):
            w.moved[NQ + i] += w.left[i]
        fn_velocity(p, t, w.moved, w.rows)
        size = residual(w.rows, NC, w.rates)
        if not size < w.velocity_left:
            break
        for i in range(NQ, NQ + NV):
            x[i] = w.moved[i]
        w.velocity_left = size
    if w.velocity_left > HOPELESS:
        w.culprit = worst_row(w.rows, NC, w.rates)
        return INCONSISTENT
    return OK


def project(p: Params, t: Real, x: Vec[NX], sizes: Vec[NKIND], w: Work) -> Status:
    """Move x onto the constraints by the shortest way in the metric of the mass matrix: positions, then
    speeds; the scaled residuals that remain in w.position_left and w.velocity_left."""
    w.position_left = 0.0
    w.velocity_left = 0.0
    if NQUAT > 0:
        normalise(x)
    if NC > 0:
        w.assembled = False
        for i in range(NV):
            w.right[i] = 0.0
        measure(p, t, x, sizes, w)
        if NH > 0:
            status = project_positions(p, t, x, w)
            if failed(status):
                return status
        return project_speeds(p, t, x, w)
    return OK
