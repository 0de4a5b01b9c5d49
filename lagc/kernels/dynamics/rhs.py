"""The right-hand side: rates and multipliers, with checks of the linear solve.

The sparse factors of [M G^T; G 0] are straight-line code without pivoting. If their pivots or residuals
are bad, the rank-revealing factorization is used.
"""

from math import fabs, inf

from lagc.kernels.language.vocabulary import *
from lagc.kernels.linear_algebra.cholesky import cholesky, solve_lower, solve_upper
from lagc.kernels.linear_algebra.rank_revealing import factor_rank_revealing, solve_rank_revealing
from lagc.kernels.linear_algebra.sparse_rank_revealing import factor_all_rows, factor_sparse, solve_sparse


def update_modes(p: Params, t: Real, x: Vec[NX], w: Work) -> None:
    """Set the modes of a state, unless the modes of a step are fixed."""
    if not w.modes_fixed:
        fn_modes(p, t, x, w.modes)


@public
def hold(p: Params, t: Real, x: Vec[NX], w: Work) -> None:
    """Evaluate the equations with *w in the modes of (t, x) from now on, until *w is used to integrate or
    is filled with zeros."""
    # Evaluations by hand have neither a step nor an event: unknown signs and axes follow the state.
    fn_modes(p, t, x, w.modes)
    w.modes_fixed = True
    if NTWO > 0:
        for i in range(NCON):
            w.contacts.normal_signs[i] = 0
    if NSPACE > 0:
        for i in range(NCON):
            w.contacts.slip_axes[2 * i] = 0.0
            w.contacts.slip_axes[2 * i + 1] = 0.0
            w.contacts.slip_roundoff[i] = 0.0


def system_at(p: Params, t: Real, x: Vec[NX], w: Work) -> None:
    """Compute the dense equations of motion: qdot, M, r, G, gamma."""
    if NMODE > 0:
        update_modes(p, t, x, w)
        fn_system_on(p, t, x, w.modes, w.qdot, w.M, w.force, w.G, w.gamma)
    else:
        fn_system(p, t, x, w.qdot, w.M, w.force, w.G, w.gamma)


def assemble_entries(p: Params, t: Real, x: Vec[NX], w: Work) -> None:
    """Compute the entries of [M G^T; G 0] in w.kkt_entries."""
    if NMODE > 0:
        update_modes(p, t, x, w)
        fn_assemble_on(p, t, x, w.modes, w.kkt_entries)
    else:
        fn_assemble(p, t, x, w.kkt_entries)


def assemble_rhs(p: Params, t: Real, x: Vec[NX], w: Work) -> None:
    """Compute the right-hand side (r, gamma) in w.rows.rhs, and qdot."""
    if NM > 0:
        system_at(p, t, x, w)
        w.rows.rhs[:NV] = w.force
        w.rows.rhs[NV : NV + NC] = w.gamma
    elif NMODE > 0:
        update_modes(p, t, x, w)
        fn_forces_on(p, t, x, w.modes, w.qdot, w.rows.rhs)
    else:
        fn_forces(p, t, x, w.qdot, w.rows.rhs)


def measure_regularity(p: Params, t: Real, x: Vec[NX], w: Work) -> None:
    """Compute w.rows.violation, the scaled distance of x from the constraints, and w.rows.regularity: for
    each row its change over the size of the coordinates (for angles plus 1), over the size of its terms,
    at most 1."""
    # Reach of each row: its change if all coordinates move by their sizes; angles count as at least a radian.
    for i in range(NGROUP):
        w.rows.group_sizes[i] = 0.0
    enlarge_sizes(x, w.rows.group_sizes)
    w.rows.group_sizes[0] += 1.0
    w.rows.violation = 0.0
    fn_scales(p, t, x, w.rows.buffer2)
    fn_reaches(p, t, x, w.rows.group_sizes, w.rows.reaches)
    # The distance from the constraints, in the scales of the residuals. Off them, dependent rows look
    # independent by as much.
    if NH > 0:
        fn_position(p, t, x, w.rows.buffer)
        for i in range(NH):
            miss = fabs(w.rows.buffer[i]) / (w.rows.buffer2[i] + VANISHING_ROW * w.rows.reaches[i])
            if not miss <= w.rows.violation:
                w.rows.violation = miss
    # A row that moves by less than its terms has a vanishing gradient, as phi = x^2 near 0.
    for i in range(NC):
        w.rows.regularity[i] = (
            w.rows.reaches[i] / w.rows.buffer2[i] if w.rows.reaches[i] < w.rows.buffer2[i] else 1.0
        )


def mark_faint_gradients(p: Params, t: Real, x: Vec[NX], w: Work) -> None:
    """Reduce w.rows.regularity of rows whose gradient is much shorter than others: it may be round-off of its
    terms."""
    # Lengths of the gradients, by sums of magnitudes.
    if NM > 0:
        for i in range(NC):
            total = 0.0
            for j in range(NV):
                total += fabs(w.G[i * NV + j])
            w.rows.buffer[i] = total
    else:
        fn_gradients(p, t, x, w.rows.buffer)
    largest = 0.0
    smallest = inf
    for i in range(NC):
        if w.rows.buffer[i] > largest:
            largest = w.rows.buffer[i]
        if w.rows.buffer[i] < smallest:
            smallest = w.rows.buffer[i]
    # Only where lengths differ much is it worth to look at round-off: the gradient over the size of its
    # terms.
    if not smallest < FAINT_GRADIENT * largest:
        return
    fn_gradient_sizes(p, t, x, w.rows.buffer2)
    for i in range(NC):
        if w.rows.buffer[i] > 0.0 and w.rows.buffer[i] < w.rows.regularity[i] * w.rows.buffer2[i]:
            w.rows.regularity[i] = w.rows.buffer[i] / w.rows.buffer2[i]


def system_fault(x: Vec[NX], w: Work) -> int:
    """Return the index of x that a value of the equations that is not finite refers to, or -1."""
    # The first value in the order of rates, mass matrix, constraints; one of x itself explains all others.
    i = not_finite(w.qdot, NQ)
    if NM > 0:
        if i < 0:
            i = not_finite(w.force, NV)
            if i >= 0:
                i += NQ
        if i < 0 and not_finite(w.M, NM) >= 0:
            i = size(NQ)
        if NC > 0:
            if i < 0 and (not_finite(w.G, NG) >= 0 or not_finite(w.gamma, NC) >= 0):
                i = size(NQ)
    elif i < 0:
        i = not_finite(w.rows.rhs, NR)
        if i >= 0:
            i = i + NQ if i < NV else size(NQ)
    if i >= 0:
        own = not_finite(x, NX)
        if own >= 0:
            i = own
    return i


def least_share(w: Work) -> Real:
    """Return the independent share below which a row counts as dependent. At a configuration where two
    branches of a mechanism cross, round-off rounds the corner between them within about 1e-8; the motion
    continues straight only if the row is left out before. The limit is higher once rows are known to be
    dependent, and off the constraints, where dependent rows have an independent share of the size of the
    violation."""
    # Thresholds: higher while the rows are known to be dependent (hysteresis, so that the rank does not
    # change to and fro), and by the violation off the constraints, at most a tenth.
    least = REMAINS_DEPENDENT if w.rank_deficient else DEPENDENT
    if 30.0 * w.rows.violation > least:
        least = 30.0 * w.rows.violation if 30.0 * w.rows.violation < 0.1 else 0.1
    return least


def factor_safely(p: Params, t: Real, x: Vec[NX], w: Work) -> Status:
    """Factor the equations at (t, x) for any rank of G."""
    if STRAIGHT:
        w.fallbacks += 1
    # A value that is not finite would make all factors so: it is refused first, with the state that it comes
    # from.
    if NM > 0:
        system_at(p, t, x, w)
        fault = system_fault(x, w)
    else:
        fault = not_finite(x, NX)
    if fault >= 0:
        w.culprit = fault
        return NOT_FINITE
    if NC > 0:
        # Rows whose gradient nearly vanishes count by their regularity, so that they are not taken for
        # dependent.
        measure_regularity(p, t, x, w)
        mark_faint_gradients(p, t, x, w)
        if NM > 0:
            status = factor_rank_revealing(p, t, x, least_share(w), w)
            if status == REDUNDANT:
                for i in range(w.factors.rank, NC):
                    w.redundant[w.factors.order[i]] = 1
        else:
            assemble_entries(p, t, x, w)
            status = factor_sparse(p, t, x, least_share(w), w)
        # Later evaluations look for the dependent rows from the beginning.
        w.rank_deficient = status == REDUNDANT
        return status
    return OK if cholesky(w) else SINGULAR_MASS


def store_rates(p: Params, t: Real, x: Vec[NX], xdot: Vec[NX], lam: Vec[NC], w: Work) -> None:
    """Store the rates of x from w.qdot, w.a and lam."""
    # qdot and a are the rates of q and v; the work integral has the power of the non-conservative actions.
    xdot[:NQ] = w.qdot
    xdot[NQ : NQ + NV] = w.a
    if NZ > 0:
        if NPUSHED > 0:
            fn_pushed_work_on(p, t, x, w.modes, w.a, lam, w.contacts.pushes, w.power)
        elif NMODE > 0:
            fn_work_on(p, t, x, w.modes, w.a, lam, w.power)
        else:
            fn_work(p, t, x, w.a, lam, w.power)
        xdot[NQ + NV] = w.power[0]


def rhs_any_rank(p: Params, t: Real, x: Vec[NX], xdot: Vec[NX], lam: Vec[NC], w: Work) -> Status:
    """Compute rates and multipliers for any rank of G."""
    # Without dense equations the right-hand side is made before the factors, which need its entries.
    if not NM > 0:
        assemble_rhs(p, t, x, w)
        unfit = system_fault(x, w)
        if unfit >= 0:
            w.culprit = unfit
            return NOT_FINITE
    status = factor_safely(p, t, x, w)
    if failed(status):
        return status
    if NM > 0:
        # Solve with the factors: M a - G^T lam = r, G a = gamma.
        w.a[:] = w.force
        if NC > 0:
            status = solve_rank_revealing(w, w.gamma, w.a, lam)
            if failed(status):
                return status
        else:
            solve_lower(w, w.a)
            solve_upper(w, w.a)
    else:
        status = solve_sparse(w.rows.rhs, w.rows.solution, w)
        if failed(status):
            return status
        w.a[:] = part(w.rows.solution, 0, NV)
        lam[:] = part(w.rows.solution, NV, NV + NC)
    # Rates that overflow are refused here, before a step uses them.
    store_rates(p, t, x, xdot, lam, w)
    fault = not_finite(xdot, NINT)
    if fault >= 0:
        w.culprit = fault
        return NOT_FINITE
    return status


def rhs_refined(p: Params, t: Real, x: Vec[NX], xdot: Vec[NX], lam: Vec[NC], w: Work) -> None:
    """Compute them with one step of iterative refinement."""
    # Residual r - K s by the entries at this state, then the correction by the same factors.
    assemble_rhs(p, t, x, w)
    assemble_entries(p, t, x, w)
    if NM > 0:
        fn_factor(w.kkt_entries, w.health)
        fn_solve(w.kkt_entries, w.rows.rhs, w.rows.solution)
        fn_refine(w.kkt_entries, w.rows.rhs, w.rows.solution)
    else:
        factor_all_rows(w)
        solve_sparse(w.rows.rhs, w.rows.solution, w)
    w.a[:] = part(w.rows.solution, 0, NV)
    lam[:] = part(w.rows.solution, NV, NV + NC)
    store_rates(p, t, x, xdot, lam, w)


def check_rates(x: Vec[NX], xdot: Vec[NX], w: Work) -> Status:
    """Return the status of a solve without dense equations. It does not tell which speed has no inertia."""
    # In models without constraints and mass matrix all is straight-line code: pivots tell whether it could be
    # divided.
    w.culprit = not_finite(x, NX)
    if w.culprit < 0 and not w.health[0] >= SINGULAR:
        w.culprit = size(NV)
        return SINGULAR_MASS
    if w.culprit < 0:
        w.culprit = not_finite(xdot, NINT)
    return NOT_FINITE if w.culprit >= 0 else OK


def rhs_at(p: Params, t: Real, x: Vec[NX], xdot: Vec[NX], lam: Vec[NC], w: Work) -> Status:
    """Compute xdot and lam at (t, x): by the sparse factors if their pivots and residuals are good, else
    for any rank."""
    # Without dependent rows the whole right-hand side is one straight-line function of the model.
    if STRAIGHT:
        if NC > 0:
            # The sparse factors have no pivoting: they serve while the rows are independent.
            if w.rank_deficient:
                return rhs_any_rank(p, t, x, xdot, lam, w)
        if NMODE > 0:
            update_modes(p, t, x, w)
            fn_rhs_on(p, t, x, w.modes, xdot, lam, w.health)
        else:
            fn_rhs(p, t, x, xdot, lam, w.health)
        if NM > 0 or NC > 0:
            # Judge the solve by its smallest pivot and its residual, from good to bad: as it is, one
            # refinement, the factorization for any rank.
            least = LEAST_PIVOT if NC > 0 else SINGULAR
            if NC > 0:
                if not w.health[0] >= TRUSTED_PIVOT:
                    fn_watch(p, w.health)
            if not (w.health[0] >= least and w.health[1] <= LARGEST_RESIDUAL):
                return rhs_any_rank(p, t, x, xdot, lam, w)
            if NC > 0:
                if w.health[1] > REFINED_RESIDUAL * size(NMANY) * size(NMANY):
                    rhs_refined(p, t, x, xdot, lam, w)
            if not_finite(xdot, NINT) < 0:
                return OK
    # The fallback: dense factors with pivoting, or sparse ones that drop rows.
    if NM > 0 or NC > 0:
        return rhs_any_rank(p, t, x, xdot, lam, w)
    else:
        return check_rates(x, xdot, w)
