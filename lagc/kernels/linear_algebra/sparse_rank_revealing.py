"""Solves with [M G^T; G 0] for any rank of G, by sparse factors.

The sparse factors keep a fixed order and leave out a row that is nearly dependent on those before it. They
give the accelerations and some multipliers. The shortest multipliers with the same forces follow from
damped factors: all rows damped by a share of their sizes D, which are never singular, in the proximal
point iteration

    lam := (G M^-1 G^T + share D)^-1 share D lam

(R. T. Rockafellar, SIAM J. Control Optim. 14 (1976) 877-898). Each iteration reduces the part of lam with
forces by a factor of share / (share + s^2), s^2 being its independent part; the part without forces
remains.

The factors are followed by three numbers for each row: its size without the rows before it, the share of
this size that is independent (0: the row is left out), and the least such share; then by the damping share
of all rows, and of rows that give a pivot to a speed without inertia.
"""

from math import fabs, sqrt

from lagc.kernels.language.vocabulary import *

NEVER_KEPT = 2.0  # a share that no row has
WELL_SEPARATED = 0.3  # independent share of a row that is well separated from others
# Damping shares of rows that give a pivot to a speed without inertia, always; of all rows.
BARELY_DAMPED = by_type(1e-6, 1.5e-14, "1e-32")
DAMPED = by_type(1e-4, 1e-9, "1e-18")
MOST_PROJECTIONS = 12  # iterations of one projection
MOST_CG_STEPS = 30  # conjugate gradient steps
CG_CONVERGED = by_type(1e-12, 1e-30, "1e-60")  # squared size of the rest, relative to the first


def row_size(w: Work, i: int) -> Real:
    """Return the size of a row without the rows before it."""
    return w.kkt_entries[NWORK - 2 - 3 * NC + i]


def independent_part(w: Work, i: int) -> Real:
    """Return the squared independent share of a row; 0 if the row is left out."""
    return w.kkt_entries[NWORK - 2 - 2 * NC + i]


def factor_with_damping(share: Real, w: Work) -> int:
    """Factor w.kkt_entries; return the number of rows that are kept."""
    w.kkt_entries[NWORK - 2] = share
    w.kkt_entries[NWORK - 1] = share if share > BARELY_DAMPED else BARELY_DAMPED
    fn_factor(w.kkt_entries, w.health)
    kept = 0
    for i in range(NC):
        if independent_part(w, i) > 0.0:
            kept += 1
    return kept


def factor_independent_rows(least: Real, w: Work) -> int:
    """Factor without damping, with the rows whose independent share is above `least`. A degenerate row
    counts by its regularity."""
    # `fn_factor` leaves a row out if its squared independent share is below the limit of the row. A
    # degenerate row has a higher limit.
    for i in range(NC):
        limit = least / w.rows.regularity[i]
        w.kkt_entries[NWORK - 2 - NC + i] = limit * limit
    return factor_with_damping(0.0, w)


def least_independent_part(w: Work) -> Real:
    """Return the least independent part of the rows that are kept."""
    least = 1.0
    for i in range(NC):
        own = independent_part(w, i)
        if own > 0.0 and own < least:
            least = own
    return least


def factor_all_rows(w: Work) -> bool:
    """Factor with all rows; return whether the factors are accurate."""
    # Rows that are independent need no regularity: their shares tell whether the factors serve.
    for i in range(NC):
        w.rows.regularity[i] = 1.0
    kept = factor_independent_rows(DEPENDENT, w)
    return kept == NC and least_independent_part(w) >= LEAST_PIVOT and w.health[0] >= LEAST_PIVOT


def are_well_separated(w: Work) -> bool:
    """Return whether the rows that are kept are well separated."""
    for i in range(NC):
        own = independent_part(w, i) * w.rows.regularity[i] * w.rows.regularity[i]
        if own > 0.0 and own < WELL_SEPARATED * WELL_SEPARATED:
            return False
    return True


def factor_sparse(p: Params, t: Real, x: Vec[NX], least: Real, w: Work) -> Status:
    """Factor w.kkt_entries for any rank. Of dependent rows, keep those that are separated as much as their
    number allows."""
    # First the rank at the least share. If a kept row is barely independent, its multipliers are large and
    # inaccurate: the highest limit that keeps as many rows is taken, in steps of 10.
    rank = factor_independent_rows(least, w)
    if rank < NC and not are_well_separated(w):
        apart = WELL_SEPARATED
        while apart > least and factor_independent_rows(apart, w) < rank:
            apart *= 0.1
        if not apart > least:
            rank = factor_independent_rows(least, w)
    if not w.health[0] > SINGULAR:
        w.culprit = size(NV)
        return SINGULAR_MASS
    # Rows that are left out are told, and their right-hand sides compared with those of the others in the
    # solve.
    fn_gamma_sizes(p, t, x, w.rows.gamma_sizes)
    status = OK
    for i in range(NC):
        if not independent_part(w, i) > 0.0:
            w.redundant[i] = 1
            w.culprit = i
            status = REDUNDANT
    return status


def refine_solution(r: Vec[NR], s: Vec[NR], w: Work) -> None:
    """Do one step of iterative refinement."""
    # s + K^-1 (r - K s): the residual is computed from the entries, not from the factors.
    fn_rest(w.kkt_entries, r, s, w.rows.residual)
    fn_solve(w.kkt_entries, w.rows.residual, w.rows.correction)
    for i in range(NR):
        s[i] += w.rows.correction[i]


def find_contradiction(r: Vec[NR], s: Vec[NR], w: Work) -> Status:
    """Return INCONSISTENT, with the culprit, if a row that is left out contradicts others: if its residual
    is more than a share of the terms of r2: of accelerations and forces, and of the terms of gamma, which
    alone remain where its gradient vanishes."""
    # The residual of a row that is left out against the terms that its right-hand side would have: its length
    # times sqrt(a M a), and that of the forces.
    power = 0.0  # a M a
    forces = 0.0
    for j in range(NV):
        power += s[j] * (r[j] - w.rows.residual[j])
    for i in range(NC):
        power += s[NV + i] * (r[NV + i] - w.rows.residual[NV + i])
        forces += row_size(w, i) * s[NV + i] * s[NV + i]
    extent = sqrt(fabs(power)) + sqrt(forces)
    status = OK
    worst = CONTRADICTION
    for i in range(NC):
        if independent_part(w, i) > 0.0:
            continue
        terms = sqrt(row_size(w, i)) / w.rows.regularity[i] * extent + w.rows.gamma_sizes[i]
        residual = fabs(w.rows.residual[NV + i]) / (fabs(r[NV + i]) + terms + TINY)
        if residual > worst:
            status = INCONSISTENT
            w.culprit = i
            worst = residual
    return status


def factor_all_damped(w: Work) -> None:
    """Factor with all rows, damped, except those whose gradient is round-off."""
    # A negative limit keeps a row in any case; only round-off gradients stay out.
    for i in range(NC):
        w.kkt_entries[NWORK - 2 - NC + i] = -1.0 if w.rows.regularity[i] > DEPENDENT else NEVER_KEPT
    factor_with_damping(DAMPED, w)


def size_of_forces(lam: Vec[NC], w: Work) -> Real:
    """Return the squared size of multipliers, in the measure of the sizes of their rows."""
    total = 0.0
    for i in range(NC):
        total += row_size(w, i) * lam[i] * lam[i]
    return total


def project_to_null_space(reduction: Real, lam: Vec[NC], w: Work) -> Real:
    """Replace lam by its part without forces; return its squared size, or 0 if it is round-off. Each
    iteration reduces the part with forces by `reduction`."""
    # lam := (G M^-1 G^T + share D)^-1 share D lam. Its part with forces shrinks by `reduction` in each turn;
    # what it may still be is `left`.
    whole = size_of_forces(lam, w)
    left = whole
    spare = whole
    for j in range(NV):
        w.rows.residual[j] = 0.0
    for n in range(MOST_PROJECTIONS):
        for i in range(NC):
            w.rows.residual[NV + i] = DAMPED * row_size(w, i) * lam[i]
        fn_solve(w.kkt_entries, w.rows.residual, w.rows.correction)
        lam[:] = part(w.rows.correction, NV, NV + NC)
        spare = size_of_forces(lam, w)
        left *= reduction * reduction
        if not spare > CG_CONVERGED * whole:
            return 0.0
        if left <= SPACING * SPACING * spare:
            break
    return spare


def shorten_multipliers(s: Vec[NR], w: Work) -> None:
    """Replace s2 by the shortest multipliers with the same forces: conjugate gradients in the null space,
    in the measure of the sizes."""
    # A kept row has an independent share of at least this, so each projection reduces forces by this factor.
    reduction = DAMPED / (DAMPED + least_independent_part(w))
    factor_all_damped(w)
    # Conjugate gradients for min lam^T D lam in the null space of the forces: the gradient D^-1 lam is
    # projected on it, and each direction is conjugate to those before (M. R. Hestenes, E. Stiefel, J. Res.
    # Nat. Bur. Stand. 49 (1952) 409-436).
    before = 1.0
    for n in range(MOST_CG_STEPS):
        for i in range(NC):
            extent = row_size(w, i)
            w.rows.buffer2[i] = s[NV + i] / extent if extent > 0.0 else 0.0
        spare = project_to_null_space(reduction, w.rows.buffer2, w)
        if spare == 0.0:
            break
        norm = 0.0
        for i in range(NC):
            w.rows.buffer[i] = w.rows.buffer2[i] + (spare / before * w.rows.buffer[i] if n > 0 else 0.0)
            norm += w.rows.buffer[i] * w.rows.buffer[i]
        for i in range(NC):
            s[NV + i] -= spare / norm * w.rows.buffer[i]
        before = spare


def solve_sparse(r: Vec[NR], s: Vec[NR], w: Work) -> Status:
    """Solve M s1 - G^T s2 = r1, G s1 = r2."""
    # Two steps of refinement: the fixed order without pivoting loses some digits in the first solve.
    fn_solve(w.kkt_entries, r, s)
    refine_solution(r, s, w)
    refine_solution(r, s, w)
    if not w.rank_deficient:
        return OK
    fn_rest(w.kkt_entries, r, s, w.rows.residual)
    status = find_contradiction(r, s, w)
    if status != OK:
        return status
    shorten_multipliers(s, w)
    return REDUNDANT
