"""Solves with [M G^T; G 0] for any rank of G, by dense factors.

L^-1 G^T = Q F diag(row_lengths), with M = L L^T, by modified Gram-Schmidt with pivoting; each vector is
orthogonalized twice (A. Bjorck, Numerical Methods for Least Squares Problems, SIAM 1996, section 2.4). The
rows row_order[rank..] depend on the others.
"""

from math import fabs, inf, sqrt

from lagc.kernels.language.vocabulary import *
from lagc.kernels.linear_algebra.cholesky import cholesky, solve_lower, solve_upper


def orthogonalise_row(w: Work, i: int, along: int) -> Real:
    """Remove from row i of Q^T its part along another row; return this part."""
    v = w.factors.q_rows[i]
    q = w.factors.q_rows[along]
    # Entries of q outside of its range are zero, so products skip them; the remainder is not zero where
    # either row is.
    begin = w.factors.q_begin[along]
    stop = w.factors.q_end[along]
    share = 0.0
    for j in range(begin, stop):
        share += v[j] * q[j]
    if share != 0.0:
        for j in range(begin, stop):
            v[j] -= share * q[j]
        if begin < w.factors.q_begin[i]:
            w.factors.q_begin[i] = begin
        if stop > w.factors.q_end[i]:
            w.factors.q_end[i] = stop
    return share


def squared_length(w: Work, i: int) -> Real:
    """Return the squared length of row i of Q^T."""
    v = w.factors.q_rows[i]
    begin = w.factors.q_begin[i]
    value = 0.0
    for j in range(begin, w.factors.q_end[i]):
        value += v[j] * v[j]
    return value


def divide_row(w: Work, i: int, length: Real) -> None:
    """Divide row i of Q^T by a length."""
    v = w.factors.q_rows[i]
    for j in range(w.factors.q_begin[i], w.factors.q_end[i]):
        v[j] = v[j] / length


def normalise_row(w: Work, i: int) -> None:
    """Set row i of Q^T to row i of G as a unit vector in the metric of M, and store its length."""
    row = w.factors.q_rows[i]
    for j in range(NV):
        # L^-1 g has the length of the gradient g in the metric of M^-1.
        row[j] = w.G[i * NV + j]
    solve_lower(w, row)
    w.factors.q_begin[i] = 0
    w.factors.q_end[i] = 0
    for j in range(NV):
        if row[j] != 0.0:
            if w.factors.q_end[i] == 0:
                w.factors.q_begin[i] = j
            w.factors.q_end[i] = j + 1
    length = sqrt(squared_length(w, i))
    # A degenerate row, whose gradient nearly vanishes, counts as shorter: its remainder then falls below
    # `dependent` only if it depends on others beyond its own round-off.
    if length > 0.0:
        length = length / w.rows.regularity[i]
    w.factors.lengths[i] = length
    if length > 0.0:
        divide_row(w, i, length)


def gamma_ratio(w: Work, i: int) -> Real:
    """Return the size of the terms of gamma over the length of a row."""
    if w.factors.lengths[i] > 0.0:
        return w.rows.gamma_sizes[i] / w.factors.lengths[i]
    return inf


def next_row(w: Work, k: int, longest: Real) -> int:
    """Return the place in w.factors.order, from k on, of the next vector. It is the first row that is long
    enough and not the longest one, so that the same rows are found to be dependent at all times. Rows are
    skipped whose gamma has much larger terms over their length than that of others: near a vanishing
    gradient, other rows say the same with less round-off."""
    steadiest = inf
    for j in range(k, NC):
        # The steadiest of the long rows: least terms of gamma over the length. Then the first in the order of
        # the model, of those that are nearly as steady.
        i = w.factors.order[j]
        if w.rows.buffer[i] >= 0.1 * longest and gamma_ratio(w, i) < steadiest:
            steadiest = gamma_ratio(w, i)
    best = -1
    for j in range(k, NC):
        i = w.factors.order[j]
        if w.rows.buffer[i] < 0.1 * longest or gamma_ratio(w, i) > 100.0 * steadiest:
            continue
        if best < 0 or i < w.factors.order[best]:
            best = j
    return best


def orthogonalise(w: Work, dependent: Real) -> None:
    """Compute Q, F, row_lengths, row_order and rank. A row whose independent share is below `dependent`
    depends on those before."""
    for i in range(NC):
        normalise_row(w, i)
        w.factors.order[i] = i
    for k in range(NC):
        # The row with the longest remainder is next, as in QR with column pivoting: the remainders fall, so
        # that the first one below `dependent` ends the independent rows.
        longest = 0.0
        for j in range(k, NC):
            value = squared_length(w, w.factors.order[j])
            w.rows.buffer[w.factors.order[j]] = value
            if value > longest:
                longest = value
        if not longest > dependent * dependent:
            w.factors.rank = k
            return
        best = next_row(w, k, longest)
        row = w.factors.order[best]
        w.factors.order[best] = w.factors.order[k]
        w.factors.order[k] = row
        # A second Gram-Schmidt pass removes the round-off of the first one: two passes are enough (Kahan).
        for j in range(k):
            w.factors.factor[j][row] += orthogonalise_row(w, row, w.factors.order[j])
        length = sqrt(squared_length(w, row))
        w.factors.factor[k][row] = length
        divide_row(w, row, length)
        # Remove the new direction from the rows behind it.
        for j in range(k + 1, NC):
            w.factors.factor[k][w.factors.order[j]] = orthogonalise_row(w, w.factors.order[j], row)
    w.factors.rank = NC


def factor_rank_revealing(p: Params, t: Real, x: Vec[NX], least: Real, w: Work) -> Status:
    """Factor M and G. A row is dependent if its independent share is below `least`; a degenerate row
    counts by its regularity. If M is singular or very uneven, M + penalty G^T G takes its place, which has
    the same solution as G a is given."""
    # Sizes of gamma decide about the order of rows; none are known before the first attempt.
    w.factors.penalty = 0.0
    for i in range(NC):
        w.rows.gamma_sizes[i] = 0.0
    # First as if all rows were independent and M regular, which nearly all states have.
    if not w.rank_deficient:
        if cholesky(w):
            orthogonalise(w, least)
            if w.factors.rank == NC:
                return OK
    # M + penalty G^T G with a penalty that makes both terms equally large. It is regular if M is along the
    # constraints, and with G a = gamma it has the same accelerations.
    trace = 0.0
    for i in range(NV):
        trace += w.M[i * (i + 1) // 2 + i]
    squares = 0.0
    for i in range(NG):
        squares += w.G[i] * w.G[i]
    if squares > 0.0:
        w.factors.penalty = trace / squares if trace > 0.0 else 1.0 / squares
    if not cholesky(w):
        return SINGULAR_MASS
    # Sizes of the right-hand sides tell whether dependent rows contradict each other.
    fn_gamma_sizes(p, t, x, w.rows.gamma_sizes)
    orthogonalise(w, least)
    if w.factors.rank == NC:
        return OK
    w.culprit = w.factors.order[w.factors.rank]
    return REDUNDANT


def solve_triangle(w: Work, c: Vec[NC]) -> None:
    """Solve c = diag(1/row_lengths) F^-1 c over the independent rows."""
    rank = w.factors.rank
    # Backwards over F, whose columns are in pivot order, then by the lengths of the rows.
    for k in range(rank - 1, -1, -1):
        value = c[k]
        for j in range(k + 1, rank):
            value -= w.factors.factor[k][w.factors.order[j]] * c[j]
        c[k] = value / w.factors.factor[k][w.factors.order[k]]
    for k in range(rank):
        c[k] = c[k] / w.factors.lengths[w.factors.order[k]]


def shortest_multipliers(w: Work, c: Vec[NC], lam: Vec[NC]) -> None:
    """Compute the shortest lam with the forces of c. The multipliers y of the dependent rows minimize |c -
    T y|^2 + |y|^2, T being w.factors.dependence."""
    rank = w.factors.rank
    count = NC - w.factors.rank
    y = w.rows.buffer
    # One solution: dependent rows have no multiplier.
    solve_triangle(w, c)
    for k in range(rank):
        lam[w.factors.order[k]] = c[k]
    # Each dependent row is a combination T of the independent ones, so its multiplier y can move to them.
    for f in range(count):
        i = w.factors.order[rank + f]
        for k in range(rank):
            w.factors.dependence[f][k] = w.factors.factor[k][i] * w.factors.lengths[i]
        solve_triangle(w, w.factors.dependence[f])
    # Normal equations (1 + T T^T) y = T c by Cholesky, row by row with the forward substitution. They are
    # well-conditioned by the 1.
    for f in range(count):
        column = w.factors.dependence[f]
        for e in range(f + 1):
            other = w.factors.dependence[e]
            value = 1.0 if e == f else 0.0
            for k in range(rank):
                value += column[k] * other[k]
            for k in range(e):
                value -= w.factors.normal_matrix[f][k] * w.factors.normal_matrix[e][k]
            w.factors.normal_matrix[f][e] = value / w.factors.normal_matrix[e][e] if e < f else sqrt(value)
        total = 0.0
        for k in range(rank):
            total += column[k] * c[k]
        for k in range(f):
            total -= w.factors.normal_matrix[f][k] * y[k]
        y[f] = total / w.factors.normal_matrix[f][f]
    # Back substitution; each y moves its share from the independent rows.
    for f in range(count - 1, -1, -1):
        column = w.factors.dependence[f]
        total = y[f]
        for k in range(f + 1, count):
            total -= w.factors.normal_matrix[k][f] * y[k]
        y[f] = total / w.factors.normal_matrix[f][f]
        lam[w.factors.order[rank + f]] = y[f]
        for k in range(rank):
            lam[w.factors.order[k]] -= column[k] * y[f]


def solve_rank_revealing(w: Work, r2: Vec[NC], z: Vec[NV], lam: Vec[NC]) -> Status:
    """Solve M z - G^T lam = r1, G z = r2; z holds r1 at first. A dependent row contradicts the others if
    its residual is more than a share of the terms of r2: of accelerations and of the terms of gamma, which
    alone remain where its gradient vanishes."""
    rank = w.factors.rank
    status = OK if w.factors.rank == NC else REDUNDANT
    c = w.rows.buffer2
    # The right-hand side of M + penalty G^T G.
    if w.factors.penalty > 0.0:
        for i in range(NC):
            factor = w.factors.penalty * r2[i]
            for j in range(NV):
                z[j] += factor * w.G[i * NV + j]
    solve_lower(w, z)
    # c becomes Q^T L^-1 of the accelerations along the rows: F^T c = r2 / lengths. `size` is the size of
    # these terms.
    size = 0.0
    for j in range(NV):
        size += z[j] * z[j]
    longest = 0.0
    for k in range(rank):
        row = w.factors.order[k]
        value = r2[row] / w.factors.lengths[row]
        for j in range(k):
            value -= w.factors.factor[j][row] * c[j]
        c[k] = value / w.factors.factor[k][row]
        size += c[k] * c[k]
        if w.factors.lengths[row] > longest:
            longest = w.factors.lengths[row]
    size = longest * sqrt(size)
    # A dependent row is consistent if its r2 is that of its combination of the others.
    worst = CONTRADICTION
    for k in range(rank, NC):
        row = w.factors.order[k]
        value = 0.0
        for j in range(rank):
            value += w.factors.factor[j][row] * c[j]
        value = r2[row] - w.factors.lengths[row] * value
        share = fabs(value) / (fabs(r2[row]) + size + w.rows.gamma_sizes[row] + TINY)
        if share > worst:
            status = INCONSISTENT
            w.culprit = row
            worst = share
    # The change along the rows is what G z lacks: c - Q^T z.
    for k in range(rank):
        q = w.factors.q_rows[w.factors.order[k]]
        value = c[k]
        for j in range(NV):
            value -= q[j] * z[j]
        c[k] = value
    # Add it, and go back from L^T z to z.
    for k in range(rank):
        q = w.factors.q_rows[w.factors.order[k]]
        for j in range(NV):
            z[j] += q[j] * c[k]
    solve_upper(w, z)
    shortest_multipliers(w, c, lam)
    return status
