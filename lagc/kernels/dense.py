"""The mass matrix, dense."""

from __future__ import annotations

from math import sqrt

from lagc.kernels.limits import SINGULAR
from lagc.kernels.records import Work
from lagc.kernels.sizes import NC, NV
from lagc.kernels.words import Real, Vec


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
        for j in range(i + 1):
            w.low[i * (i + 1) // 2 + j] = mass_entry(w, i, j)
    for k in range(NV):
        diagonal = k * (k + 1) // 2 + k
        if not w.low[diagonal] > SINGULAR * mass_entry(w, k, k):
            w.culprit = k
            return False
        pivot = sqrt(w.low[diagonal])
        w.low[diagonal] = pivot
        for i in range(k + 1, NV):
            row = i * (i + 1) // 2
            factor = w.low[row + k] / pivot
            w.low[row + k] = factor
            w.column[i] = factor
            for j in range(k + 1, i + 1):
                w.low[row + j] -= factor * w.column[j]
    return True


def lower(w: Work, z: Vec[NV]) -> None:
    """z = L^-1 z"""
    for i in range(NV):
        start = i * (i + 1) // 2
        value = z[i]
        for k in range(i):
            value -= w.low[start + k] * z[k]
        z[i] = value / w.low[start + i]


def upper(w: Work, z: Vec[NV]) -> None:
    """z = L^-T z"""
    for i in range(NV - 1, -1, -1):
        start = i * (i + 1) // 2
        value = z[i] / w.low[start + i]
        z[i] = value
        for k in range(i):
            z[k] -= w.low[start + k] * value
