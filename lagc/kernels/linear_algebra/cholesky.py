"""Cholesky factorization of the dense mass matrix, with the leading zeros of each row skipped."""

from math import sqrt

from lagc.kernels.language.vocabulary import *


def mass_entry(w: Work, i: int, j: int) -> Real:
    """Return an entry of M, or of M + penalty G^T G."""
    # Row i of the lower triangle begins at i (i + 1) / 2.
    value = w.M[i * (i + 1) // 2 + j]
    if NC > 0:
        if w.factors.penalty > 0.0:
            for k in range(NC):
                value += w.factors.penalty * w.G[k * NV + i] * w.G[k * NV + j]
    return value


def cholesky(w: Work) -> bool:
    """Factor M = L L^T, packed by rows. Return False, with the column as the culprit, if M is singular."""
    # Copy M, and note where each row begins: L has zeros before the first entry of M that is not zero.
    for i in range(NV):
        row = i * (i + 1) // 2
        head = i
        for j in range(i, -1, -1):
            value = mass_entry(w, i, j)
            w.cholesky[row + j] = value
            if value != 0.0:
                head = j
        w.row_begin[i] = head
    # Columns from left to right. A pivot that is round-off of its own entry means that M is singular.
    for k in range(NV):
        diagonal = k * (k + 1) // 2 + k
        if not w.cholesky[diagonal] > SINGULAR * mass_entry(w, k, k):
            w.culprit = k
            return False
        pivot = sqrt(w.cholesky[diagonal])
        w.cholesky[diagonal] = pivot
        for i in range(k + 1, NV):
            if w.row_begin[i] > k:
                w.pivot_column[i] = 0.0
                continue
            row = i * (i + 1) // 2
            # Column k of L: M_ik / L_kk, after the columns before it were subtracted. Where the row begins
            # behind k its entry is zero and stays so: no fill-in to the left of the first entry (A. George,
            # J. W. Liu, Computer Solution of Large Sparse Positive Definite Systems, 1981, chapter 4).
            factor = w.cholesky[row + k] / pivot
            w.cholesky[row + k] = factor
            w.pivot_column[i] = factor
            # Update the rest of the row by the outer product of the column.
            for j in range(k + 1, i + 1):
                w.cholesky[row + j] -= factor * w.pivot_column[j]
    return True


def row_begin_of(w: Work, i: int) -> int:
    """Return the first column of row i that is not zero. The comparison tells compilers that it is not
    negative."""
    head = w.row_begin[i]
    return head if head > 0 else 0


def solve_lower(w: Work, z: Vec[NV]) -> None:
    """Solve z = L^-1 z."""
    # Forward substitution, row by row, from the first entry that is not zero.
    for i in range(NV):
        start = i * (i + 1) // 2
        value = z[i]
        for k in range(row_begin_of(w, i), i):
            value -= w.cholesky[start + k] * z[k]
        z[i] = value / w.cholesky[start + i]


def solve_upper(w: Work, z: Vec[NV]) -> None:
    """Solve z = L^-T z."""
    # Back substitution: L^T is used by columns, which are the rows of L.
    for i in range(NV - 1, -1, -1):
        start = i * (i + 1) // 2
        value = z[i] / w.cholesky[start + i]
        z[i] = value
        for k in range(row_begin_of(w, i), i):
            z[k] -= w.cholesky[start + k] * value
