"""The mass matrix, dense; what of a row stands before its first entry costs nothing."""

from __future__ import annotations

from math import sqrt

from lagc.kernels.language.records import Work
from lagc.kernels.language.sizes import NC, NV
from lagc.kernels.language.tolerances import SINGULAR
from lagc.kernels.language.words import Real, Vec


def mass_entry(w: Work, i: int, j: int) -> Real:
    """An entry of M; of M + weight G^T G where weight > 0."""
    value = w.M[i * (i + 1) // 2 + j]
    if NC > 0:
        if w.penalty > 0.0:
            for k in range(NC):
                value += w.penalty * w.G[k * NV + i] * w.G[k * NV + j]
    return value


def cholesky(w: Work) -> bool:
    """M = L L^T, packed by rows, column after column; false where M is singular."""
    for i in range(NV):
        row = i * (i + 1) // 2
        head = i
        for j in range(i, -1, -1):
            value = mass_entry(w, i, j)
            w.cholesky[row + j] = value
            if value != 0.0:
                head = j
        w.row_begin[i] = head
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
            factor = w.cholesky[row + k] / pivot
            w.cholesky[row + k] = factor
            w.pivot_column[i] = factor
            for j in range(k + 1, i + 1):
                w.cholesky[row + j] -= factor * w.pivot_column[j]
    return True


def row_begin_of(w: Work, i: int) -> int:
    """The column where row i begins; that it is none before the first, compilers see here."""
    head = w.row_begin[i]
    return head if head > 0 else 0


def solve_lower(w: Work, z: Vec[NV]) -> None:
    """z = L^-1 z"""
    for i in range(NV):
        start = i * (i + 1) // 2
        value = z[i]
        head = row_begin_of(w, i)
        for k in range(head, i):
            value -= w.cholesky[start + k] * z[k]
        z[i] = value / w.cholesky[start + i]


def solve_upper(w: Work, z: Vec[NV]) -> None:
    """z = L^-T z"""
    for i in range(NV - 1, -1, -1):
        start = i * (i + 1) // 2
        value = z[i] / w.cholesky[start + i]
        z[i] = value
        head = row_begin_of(w, i)
        for k in range(head, i):
            z[k] -= w.cholesky[start + k] * value
