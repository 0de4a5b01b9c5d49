"""Eigenvalues and eigenvectors of a matrix, with what rounding changes them by."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from lagc.run.derivatives import Array

ROUNDING = 1e-14  # of a matrix in its norm: what its entries are not known to
NEAR = 1e-7  # its root: what an eigenvalue that is one of two is not known to


class Spectrum(NamedTuple):
    values: Any  # complex; real and imaginary parts that are rounding are 0
    vectors: Any  # columns


def spectrum(a: Array, scales: Array) -> Spectrum:
    """Of `a`, where `scales` are what its unknowns are measured by.

    An eigenvalue is told to the rounding of the norm over the cosine between its right and its left vector,
    a row of the inverse of the right ones (G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th ed.,
    7.2.2), or to the root of that where vectors fall together.
    """
    if not len(a):
        return Spectrum(np.zeros(0, complex), np.zeros((0, 0), complex))
    scaled = a * scales / scales[:, None]
    values, vectors = (part.astype(complex) for part in np.linalg.eig(scaled))
    _, stretch, right = np.linalg.svd(vectors)
    cosines = 1.0 / np.linalg.norm(right / np.maximum(stretch, ROUNDING)[:, None], axis=0)
    errors = np.linalg.norm(scaled) * np.minimum(ROUNDING / cosines, NEAR)
    for part in (values.real, values.imag):  # views
        part[np.abs(part) <= errors] = 0.0
    return Spectrum(values, scales[:, None] * vectors)
