"""Projection of states onto their constraints, in the metric of the mass matrix.

E. Eich, Convergence results for a coordinate projection method applied to mechanical systems with
algebraic constraints, SIAM J. Numer. Anal. 30 (1993) 1467-1482.
"""

from math import fabs, inf
from typing import Any

from lagc.kernels.arithmetic.quaternions import normalise
from lagc.kernels.dynamics.rhs import assemble_entries, factor_safely, system_at
from lagc.kernels.language.vocabulary import *
from lagc.kernels.linear_algebra.rank_revealing import solve_rank_revealing
from lagc.kernels.linear_algebra.sparse_rank_revealing import factor_all_rows

MOST_ITERATIONS = 8  # of the simplified Newton method
FAILED_PROJECTION = by_type(1e-3, 1e-6, "1e-6")  # scaled residual above which a projection has failed


def assemble_at(p: Params, t: Real, x: Vec[NX], w: Work) -> Status:
    """Factor [M G^T; G 0] at (t, x)."""
    # Sparse factors first. They are good if no pivot is small and the residual of a solve that `fn_factor`
    # makes is.
    if STRAIGHT:
        if not w.rank_deficient:
            assemble_entries(p, t, x, w)
            if NM > 0:
                fn_factor(w.kkt_entries, w.health)
                if w.health[0] >= LEAST_PIVOT and w.health[1] <= LARGEST_RESIDUAL:
                    w.rows.is_dense = False
                    return OK
            elif factor_all_rows(w):
                return OK
    if NM > 0:
        w.rows.is_dense = True
    return factor_safely(p, t, x, w)


def solve_at(r: Vec[NR], s: Vec[NR], w: Work) -> None:
    """Solve M s1 - G^T s2 = r1, G s1 = r2."""
    # Dense factors solve by the rank-revealing method: dependent rows get shortest multipliers.
    if NM > 0:
        if STRAIGHT:
            if not w.rows.is_dense:
                fn_solve(w.kkt_entries, r, s)
                return
        w.a[:] = part(r, 0, NV)
        w.factors.rhs[:] = part(r, NV, NV + NC)
        solve_rank_revealing(w, w.factors.rhs, w.a, w.factors.mu)
        s[:NV] = w.a
        s[NV : NV + NC] = w.factors.mu
    else:
        fn_solve(w.kkt_entries, r, s)


def set_row_scales(p: Params, t: Real, x: Vec[NX], sizes: Vec[NGROUP], w: Work) -> None:
    """Set w.rows.scales and w.rows.rate_scales, the scales of residuals and of their rates; `sizes` are those
    of the trajectory."""
    # Angles of many turns do not enlarge the scales of residuals.
    w.rows.group_sizes[:] = sizes
    if w.rows.group_sizes[0] > 1.0:
        w.rows.group_sizes[0] = 1.0
    fn_scales(p, t, x, w.rows.scales)
    fn_reaches(p, t, x, w.rows.group_sizes, w.rows.reaches)
    # A row whose terms all vanish is scaled by a share of its reach; rates of a holonomic row by their own.
    for i in range(NC):
        w.rows.scales[i] += VANISHING_ROW * w.rows.reaches[i]
    w.rows.rate_scales[:] = w.rows.scales
    if NH > 0:
        for i in range(NH):
            w.rows.rate_scales[i] = w.rows.reaches[NC + i]


def scaled_residual(values: Vec[Any], n: Size, scales: Vec[NC]) -> Real:
    """Return the largest |value| / scale; infinity if one is NaN."""
    worst = 0.0
    for i in range(n):
        size = fabs(values[i]) / scales[i]
        if not size <= worst:
            worst = size if size == size else inf
    return worst


def worst_row(values: Vec[Any], n: Size, scales: Vec[NC]) -> int:
    """Return the row with the largest scaled residual."""
    row = 0
    worst = 0.0
    for i in range(n):
        size = fabs(values[i]) / scales[i]
        if not size <= worst:
            row = i
            worst = size
    return row


def constraint_rates_of(e: Vec[NX], w: Work) -> None:
    """Compute w.rows.values = G e, for the speeds of e."""
    # With a dense G by products; else K (e, 0) has G e as its second part, by the sparse entries.
    if NM > 0:
        for i in range(NC):
            total = 0.0
            for j in range(NV):
                total += w.G[i * NV + j] * e[NQ + j]
            w.rows.values[i] = total
    else:
        for i in range(NC):
            w.rows.rhs[NV + i] = 0.0
            w.rows.solution[NV + i] = 0.0
        for j in range(NV):
            w.rows.solution[j] = e[NQ + j]
        fn_rest(w.kkt_entries, w.rows.rhs, w.rows.solution, w.rows.residual)
        for i in range(NC):
            w.rows.values[i] = -w.rows.residual[NV + i]


def project_error(p: Params, t: Real, x: Vec[NX], w: Work) -> bool:
    """Remove from the error estimates, near a state x, the part of the speeds that the projection removes:
    what is not along the constraints, in the metric of the mass matrix. Return False if that fails."""
    # The solve must leave no trace: an estimate is no evaluation of the motion.
    lost = w.rank_deficient
    culprit = w.culprit
    for i in range(NC):
        w.rows.redundant_before[i] = w.redundant[i]
    if NM > 0:
        system_at(p, t, x, w)
    status = assemble_at(p, t, x, w)
    if not failed(status):
        # Both estimates e are projected as speeds are: M d = G^T mu, G d = -(rates of the constraints along
        # e).
        for j in range(NV):
            w.rows.rhs[j] = 0.0
        for k in range(2):
            e = w.error.parts[k]
            constraint_rates_of(e, w)
            for i in range(NC):
                w.rows.rhs[NV + i] = -w.rows.values[i]
            solve_at(w.rows.rhs, w.rows.solution, w)
            for j in range(NV):
                e[NQ + j] += w.rows.solution[j]
    w.rank_deficient = lost
    w.culprit = culprit
    for i in range(NC):
        w.redundant[i] = w.rows.redundant_before[i]
    return not failed(status)


def displace_state(p: Params, t: Real, x: Vec[NX], y: Vec[NX], w: Work) -> None:
    """Compute y = x, with its coordinates moved by the displacement w.rows.solution."""
    y[:] = x
    if HAS_DISPLACE:
        fn_displace(p, t, x, w.rows.solution, w.rows.dq)
        for i in range(NQ):
            y[i] += w.rows.dq[i]
    else:
        for i in range(NQ):
            y[i] += w.rows.solution[i]


def perturb_off_constraints(p: Params, t: Real, x: Vec[NX], sizes: Vec[NGROUP], w: Work) -> bool:
    """Compute w.error.x_perturbed: a state near x, off its constraints by the residual of a projection, with
    consistent speeds. Return False if that fails."""
    # Residuals of alternating signs, as large as a projection leaves them.
    if failed(assemble_at(p, t, x, w)):
        return False
    set_row_scales(p, t, x, sizes, w)
    for i in range(NV):
        w.rows.rhs[i] = 0.0
    for i in range(NC):
        w.rows.rhs[NV + i] = (ROUNDOFF_RESIDUAL if i % 2 == 0 else -ROUNDOFF_RESIDUAL) * w.rows.scales[i]
    solve_at(w.rows.rhs, w.rows.solution, w)
    displace_state(p, t, x, w.error.x_perturbed, w)
    # Speeds again tangential at the perturbed place: only the position is off.
    fn_velocity(p, t, w.error.x_perturbed, w.rows.values)
    for i in range(NC):
        w.rows.rhs[NV + i] = -w.rows.values[i]
    solve_at(w.rows.rhs, w.rows.solution, w)
    for i in range(NV):
        w.error.x_perturbed[NQ + i] += w.rows.solution[i]
    return True


def assemble_once(p: Params, t: Real, x: Vec[NX], w: Work) -> Status:
    """Factor [M G^T; G 0] at (t, x), unless this projection has factors."""
    if w.rows.is_assembled:
        return OK
    status = assemble_at(p, t, x, w)
    w.rows.is_assembled = not failed(status)
    return status


def project_positions(p: Params, t: Real, x: Vec[NX], w: Work) -> Status:
    """Project the coordinates by simplified Newton iterations: M d = G^T mu, G d = -phi, dq = N d."""
    fn_position(p, t, x, w.rows.values)
    w.position_residual = scaled_residual(w.rows.values, NH, w.rows.scales)
    for n in range(MOST_ITERATIONS):
        # Small residuals are left: a projection would only add round-off. Once begun it goes to round-off.
        if w.position_residual <= (UNPROJECTED_RESIDUAL if n == 0 else ROUNDOFF_RESIDUAL):
            break
        status = assemble_once(p, t, x, w)
        if failed(status):
            return status
        # The factors of the first iteration serve all of them. Rates of velocity constraints do not change.
        for i in range(NC):
            w.rows.rhs[NV + i] = 0.0
        for i in range(NH):
            w.rows.rhs[NV + i] = -w.rows.values[i]
        solve_at(w.rows.rhs, w.rows.solution, w)
        displace_state(p, t, x, w.rows.x_candidate, w)
        if NQUAT > 0:
            normalise(w.rows.x_candidate)
        fn_position(p, t, w.rows.x_candidate, w.rows.values)
        size = scaled_residual(w.rows.values, NH, w.rows.scales)
        # A step that does not reduce the residual is not made: it is at its round-off.
        if not size < w.position_residual:
            break
        for i in range(NQ):
            x[i] = w.rows.x_candidate[i]
        w.position_residual = size
    if w.position_residual > FAILED_PROJECTION:
        w.culprit = worst_row(w.rows.values, NH, w.rows.scales)
        return INCONSISTENT
    return OK


def project_speeds(p: Params, t: Real, x: Vec[NX], w: Work) -> Status:
    """Project the speeds: M dv = G^T mu, G dv = -psi."""
    fn_velocity(p, t, x, w.rows.values)
    w.velocity_residual = scaled_residual(w.rows.values, NC, w.rows.rate_scales)
    for n in range(MOST_ITERATIONS):
        # As for the coordinates; the equations are linear, so that one iteration reaches round-off.
        if w.velocity_residual <= (UNPROJECTED_RESIDUAL if n == 0 else ROUNDOFF_RESIDUAL):
            break
        # The factors may be those of the coordinates before their projection: a simplified Newton method.
        status = assemble_once(p, t, x, w)
        if failed(status):
            return status
        for i in range(NC):
            w.rows.rhs[NV + i] = -w.rows.values[i]
        solve_at(w.rows.rhs, w.rows.solution, w)
        w.rows.x_candidate[:] = x
        for i in range(NV):
            w.rows.x_candidate[NQ + i] += w.rows.solution[i]
        fn_velocity(p, t, w.rows.x_candidate, w.rows.values)
        size = scaled_residual(w.rows.values, NC, w.rows.rate_scales)
        # A step that does not reduce the residual is not made.
        if not size < w.velocity_residual:
            break
        for i in range(NQ, NQ + NV):
            x[i] = w.rows.x_candidate[i]
        w.velocity_residual = size
    if w.velocity_residual > FAILED_PROJECTION:
        w.culprit = worst_row(w.rows.values, NC, w.rows.rate_scales)
        return INCONSISTENT
    return OK


def project(p: Params, t: Real, x: Vec[NX], sizes: Vec[NGROUP], w: Work) -> Status:
    """Project x onto the constraints, first coordinates, then speeds, by the shortest displacement in the
    metric of the mass matrix. The scaled residuals that remain are in w.position_residual and
    w.velocity_residual."""
    w.position_residual = 0.0
    w.velocity_residual = 0.0
    if NQUAT > 0:
        # Unit quaternions are projected by their norm alone, before the constraints.
        normalise(x)
    if NC > 0:
        w.rows.is_assembled = False
        for i in range(NV):
            w.rows.rhs[i] = 0.0
        set_row_scales(p, t, x, sizes, w)
        if NH > 0:
            status = project_positions(p, t, x, w)
            if failed(status):
                return status
        return project_speeds(p, t, x, w)
    return OK
