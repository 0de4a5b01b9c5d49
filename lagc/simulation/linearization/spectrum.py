"""Eigenvalues and eigenvectors of a matrix, with what rounding changes them by."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from lagc.simulation.linearization.derivatives import Array

ROUNDING = 1e-14  # of a matrix in its norm: what its entries are not known to
NEAR = 1e-7  # its root: what an eigenvalue that is one of two is not known to
SWEEPS = 20  # of balancing: most are done after a few


class Spectrum(NamedTuple):
    values: Any  # complex; real and imaginary parts that are rounding are 0
    vectors: Any  # columns


def spectrum(a: Array, scales: Array) -> Spectrum:
    """Of `a`, where `scales` are what its unknowns are measured by, brought to rows as long as their columns:
    so a slow motion is not lost beside a fast one that it has little to do with.

    An eigenvalue is told to the rounding of the norm over the cosine between its right and its left vector,
    a row of the inverse of the right ones (G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th ed.,
    7.2.2), or to the root of that where vectors fall together.
    """
    if not len(a):
        return Spectrum(np.zeros(0, complex), np.zeros((0, 0), complex))
    scales = _balanced(a, scales)
    scaled = a * scales / scales[:, None]
    values, vectors = (part.astype(complex) for part in np.linalg.eig(scaled))
    _, stretch, right = np.linalg.svd(vectors)
    cosines = 1.0 / np.linalg.norm(right / np.maximum(stretch, ROUNDING)[:, None], axis=0)
    errors = np.linalg.norm(scaled) * np.minimum(ROUNDING / cosines, NEAR)
    for part in (values.real, values.imag):  # views
        part[np.abs(part) <= errors] = 0.0
    return Spectrum(values, scales[:, None] * vectors)


def _balanced(a: Array, scales: Array) -> Array:
    """`scales` times powers of two by which no row is far longer than its column (B. N. Parlett, C. Reinsch,
    Numer. Math. 13, 1969)."""
    found = np.array(scales, float)
    for _ in range(SWEEPS):
        before = found.copy()
        for k in range(len(a)):
            row = np.abs(a[k] * found) / found[k]
            column = np.abs(a[:, k]) * found[k] / found
            row[k] = column[k] = 0.0
            if row.any() and column.any():
                found[k] *= 2.0 ** np.round(0.5 * np.log2(np.linalg.norm(row) / np.linalg.norm(column)))
        if (found == before).all():
            break
    return found
