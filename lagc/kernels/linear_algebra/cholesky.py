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
        if w.weight > 0.0:
            for k in range(NC):
                value += w.weight * w.G[k * NV + i] * w.G[k * NV + j]
    return value


def cholesky(w: Work) -> bool:
    """M = L L^T, packed by rows, column after column; false where M is singular."""
    for i in range(NV):
        row = i * (i + 1) // 2
        head = i
        for j in range(i, -1, -1):
            value = mass_entry(w, i, j)
            w.low[row + j] = value
            if value != 0.0:
                head = j
        w.heads[i] = head
    for k in range(NV):
        diagonal = k * (k + 1) // 2 + k
        if not w.low[diagonal] > SINGULAR * mass_entry(w, k, k):
            w.culprit = k
            return False
        pivot = sqrt(w.low[diagonal])
        w.low[diagonal] = pivot
        for i in range(k + 1, NV):
            if w.heads[i] > k:
                w.column[i] = 0.0
                continue
            row = i * (i + 1) // 2
            factor = w.low[row + k] / pivot
            w.low[row + k] = factor
            w.column[i] = factor
            for j in range(k + 1, i + 1):
                w.low[row + j] -= factor * w.column[j]
    return True


def head_of(w: Work, i: int) -> int:
    """The column where row i begins; that it is none before the first, compilers see here."""
    head = w.heads[i]
    return head if head > 0 else 0


def lower(w: Work, z: Vec[NV]) -> None:
    """z = L^-1 z"""
    for i in range(NV):
        start = i * (i + 1) // 2
        value = z[i]
        head = head_of(w, i)
        for k in range(head, i):
            value -= w.low[start + k] * z[k]
        z[i] = value / w.low[start + i]


def upper(w: Work, z: Vec[NV]) -> None:
    """z = L^-T z"""
    for i in range(NV - 1, -1, -1):
        start = i * (i + 1) // 2
        value = z[i] / w.low[start + i]
        z[i] = value
        head = head_of(w, i)
        for k in range(head, i):
            z[k] -= w.low[start + k] * value
