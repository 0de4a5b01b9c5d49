"""[M G^T; G 0] whatever the rank of G, without a dense matrix.

Straight factors in their own order, in which a row with next to nothing of its own beside those before it
is left out, give accelerations and some multipliers.  The shortest are found among those with the same
forces.  With all rows damped by a share of their sizes D the factors are never singular, and what of
multipliers makes a force with a part s^2 of its own is less by a factor of share/(share + s^2) each time in

    lam := (G M^-1 G^T + share D)^-1 share D lam

(the proximal point method, R. T. Rockafellar, SIAM J. Control Optim. 14 (1976)); what is left makes none.

Behind the factors stand, for each row, its size without the rows before it, the share of that which is its
own (0: it is left out), and what that has to be above; then the share by which rows are damped, and that of
those that give a pivot to a speed without inertia.
"""

from __future__ import annotations

from math import fabs, sqrt

from lagc.kernels.language.model import fn_factor, fn_gamma_sizes, fn_rest, fn_solve
from lagc.kernels.language.records import Work
from lagc.kernels.language.sizes import NC, NR, NV, NWORK, NX
from lagc.kernels.language.statuses import INCONSISTENT, OK, REDUNDANT, SINGULAR_MASS
from lagc.kernels.language.tolerances import CONTRADICTION, DEPENDENT, LEAST_PIVOT, SINGULAR, SPACING, TINY
from lagc.kernels.language.words import Params, Real, Status, Vec, by_type, part, size

MORE_THAN_ALL = 2.0  # a share that no row has of its own
DISTINCT = 0.3  # the share of its own of a row that is well apart from others
# Shares by which rows are damped: always those that give a pivot to a speed without inertia; all.
BARELY_DAMPED = by_type(1e-6, 1.5e-14, "1e-32")
DAMPED = by_type(1e-4, 1e-9, "1e-18")
MOST_DAMPED = 12  # times
MOST_SHORTENED = 30  # times
SHORTENED = by_type(1e-12, 1e-30, "1e-60")  # square of what is left to shorten


def row_size(w: Work, i: int) -> Real:
    """Without the rows before it."""
    return w.entries[NWORK - 2 - 3 * NC + i]


def own_part(w: Work, i: int) -> Real:
    """Of a row that is kept, beside its size; 0 of one that is left out."""
    return w.entries[NWORK - 2 - 2 * NC + i]


def factor_with(share: Real, w: Work) -> int:
    """The factors of the entries in w; how many rows are kept."""
    w.entries[NWORK - 2] = share
    w.entries[NWORK - 1] = share if share > BARELY_DAMPED else BARELY_DAMPED
    fn_factor(w.entries, w.health)
    kept = 0
    for i in range(NC):
        if own_part(w, i) > 0.0:
            kept += 1
    return kept


def factor_apart(least: Real, w: Work) -> int:
    """The same, where rows are kept of which more than `least` is their own.  A row whose gradient all but
    vanishes has a direction that says little (`slight`)."""
    for i in range(NC):
        limit = least / w.slight[i]
        w.entries[NWORK - 2 - NC + i] = limit * limit
    return factor_with(0.0, w)


def finest(w: Work) -> Real:
    """The least part of its own of a row that is kept."""
    least = 1.0
    for i in range(NC):
        own = own_part(w, i)
        if own > 0.0 and own < least:
            least = own
    return least


def factor_whole(w: Work) -> bool:
    """The factors of the entries in w with all rows; whether they can be trusted."""
    for i in range(NC):
        w.slight[i] = 1.0
    kept = factor_apart(DEPENDENT, w)
    return kept == NC and finest(w) >= LEAST_PIVOT and w.health[0] >= LEAST_PIVOT


def well_apart(w: Work) -> bool:
    """Whether the rows that are kept are."""
    for i in range(NC):
        own = own_part(w, i) * w.slight[i] * w.slight[i]
        if own > 0.0 and own < DISTINCT * DISTINCT:
            return False
    return True


def factor_damped(p: Params, t: Real, x: Vec[NX], least: Real, w: Work) -> Status:
    """From the entries in w.  Of rows that depend on each other those are kept that are as far apart as their
    number allows."""
    rank = factor_apart(least, w)
    if rank < NC and not well_apart(w):
        apart = DISTINCT
        while apart > least and factor_apart(apart, w) < rank:
            apart *= 0.1
        if not apart > least:
            rank = factor_apart(least, w)
    if not w.health[0] > SINGULAR:
        w.culprit = size(NV)
        return SINGULAR_MASS
    fn_gamma_sizes(p, t, x, w.sizes)
    status = OK
    for i in range(NC):
        if not own_part(w, i) > 0.0:
            w.redundant[i] = 1
            w.culprit = i
            status = REDUNDANT
    return status


def refine(r: Vec[NR], s: Vec[NR], w: Work) -> None:
    """One step of iterative refinement."""
    fn_rest(w.entries, r, s, w.rest)
    fn_solve(w.entries, w.rest, w.change)
    for i in range(NR):
        s[i] += w.change[i]


def contradiction(r: Vec[NR], s: Vec[NR], w: Work) -> Status:
    """A row that is left out contradicts others where it misses r2 by more than a share of what r2 is made
    of: of the accelerations and forces, and of the terms of gamma, which are all that is left where its
    gradient vanishes."""
    power = 0.0  # a M a
    forces = 0.0
    for j in range(NV):
        power += s[j] * (r[j] - w.rest[j])
    for i in range(NC):
        power += s[NV + i] * (r[NV + i] - w.rest[NV + i])
        forces += row_size(w, i) * s[NV + i] * s[NV + i]
    extent = sqrt(fabs(power)) + sqrt(forces)
    status = OK
    worst = CONTRADICTION
    for i in range(NC):
        if own_part(w, i) > 0.0:
            continue
        terms = sqrt(row_size(w, i)) / w.slight[i] * extent + w.sizes[i]
        missed = fabs(w.rest[NV + i]) / (fabs(r[NV + i]) + terms + TINY)
        if missed > worst:
            status = INCONSISTENT
            w.culprit = i
            worst = missed
    return status


def keep_all(w: Work) -> None:
    """The factors with all rows, damped, but for those whose gradient is rounding."""
    for i in range(NC):
        w.entries[NWORK - 2 - NC + i] = -1.0 if w.slight[i] > DEPENDENT else MORE_THAN_ALL
    factor_with(DAMPED, w)


def size_of_forces(lam: Vec[NC], w: Work) -> Real:
    """Squared, of multipliers in the measure of the sizes of their rows."""
    total = 0.0
    for i in range(NC):
        total += row_size(w, i) * lam[i] * lam[i]
    return total


def damp(missed: Real, lam: Vec[NC], w: Work) -> Real:
    """lam by what of it makes no force; the square of its size, 0 where that is rounding.  Of what makes a
    force a share of `missed` is left each time."""
    whole = size_of_forces(lam, w)
    left = whole
    spare = whole
    for j in range(NV):
        w.rest[j] = 0.0
    for n in range(MOST_DAMPED):
        for i in range(NC):
            w.rest[NV + i] = DAMPED * row_size(w, i) * lam[i]
        fn_solve(w.entries, w.rest, w.change)
        lam[:] = part(w.change, NV, NV + NC)
        spare = size_of_forces(lam, w)
        left *= missed * missed
        if not spare > SHORTENED * whole:
            return 0.0
        if left <= SPACING * SPACING * spare:
            break
    return spare


def shorten_multipliers(s: Vec[NR], w: Work) -> None:
    """s2 by the shortest with the same forces: conjugate gradients, in the measure of the sizes, among those
    that make none."""
    missed = DAMPED / (DAMPED + finest(w))
    keep_all(w)
    before = 1.0
    for n in range(MOST_SHORTENED):
        for i in range(NC):
            extent = row_size(w, i)
            w.found[i] = s[NV + i] / extent if extent > 0.0 else 0.0
        spare = damp(missed, w.found, w)
        if spare == 0.0:
            break
        norm = 0.0
        for i in range(NC):
            w.free[i] = w.found[i] + (spare / before * w.free[i] if n > 0 else 0.0)
            norm += w.free[i] * w.free[i]
        for i in range(NC):
            s[NV + i] -= spare / norm * w.free[i]
        before = spare


def solve_damped(r: Vec[NR], s: Vec[NR], w: Work) -> Status:
    """M s1 - G^T s2 = r1, G s1 = r2."""
    fn_solve(w.entries, r, s)
    refine(r, s, w)
    refine(r, s, w)
    if not w.lost:
        return OK
    fn_rest(w.entries, r, s, w.rest)
    status = contradiction(r, s, w)
    if status != OK:
        return status
    shorten_multipliers(s, w)
    return REDUNDANT
