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

    An eigenvalue is told to the rounding of the norm over the distance of its vector from the span of the
    others (the cosine between left and right vectors: G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th
    ed., 7.2.2), or to the root of that where vectors fall together.
    """
    if not len(a):
        return Spectrum(np.zeros(0, complex), np.zeros((0, 0), complex))
    scaled = a * scales / scales[:, None]
    values, vectors = (part.astype(complex) for part in np.linalg.eig(scaled))
    norm = float(np.linalg.norm(scaled))
    for k in range(len(a)):
        others = np.delete(vectors, k, axis=1)
        apart = vectors[:, k] - others @ np.linalg.lstsq(others, vectors[:, k], rcond=None)[0]
        error = norm * min(ROUNDING / max(float(np.linalg.norm(apart)), ROUNDING), NEAR)
        values[k] = complex(*(0.0 if abs(x) <= error else x for x in (values[k].real, values[k].imag)))
    return Spectrum(values, scales[:, None] * vectors)
