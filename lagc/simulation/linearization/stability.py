"""Eigenvalues, and whether the potential energy has a strict minimum at an equilibrium.

With the independent entries y_q = X dq, y_v = X dv of the state and dy_q' = T dy_v, the second derivatives
of the energy along motions are

C = X_v^T K X_q T,      K = d(M a - tau + h - G^T lam)/dq.

The energy has a strict minimum if C is positive definite.  C is scaled to a unit diagonal, so that stiff
springs do not hide soft ones.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from lagc.simulation.linearization.derivatives import ROUNDING, Array, Point
from lagc.simulation.linearization.independent_states import Independent
from lagc.simulation.system import FAILED

BEYOND = 4.0  # Newton steps: the equilibrium is within this distance, up to a root of that order
TRIALS = 3


def is_energy_minimum(point: Point, chosen: Independent, a: Array) -> bool:
    """Return True if C is positive definite beyond round-off, also at points near the state, as at the flat
    minimum of q^4."""
    nq, nv = point.system.nq, point.system.nv
    speeds = np.array(chosen.indices) >= nq
    back, there = chosen.motions[nq:, speeds].T, chosen.motions[:nq, ~speeds]
    rates = a[np.ix_(~speeds, speeds)]

    def second(stiffness: Array) -> Array:
        found: Array = back @ stiffness[:nv, :nq] @ (there @ rates)
        return found

    try:
        steps = BEYOND * np.abs(np.linalg.inv(a[np.ix_(speeds, ~speeds)])) @ _left(point, chosen.indices)
    except np.linalg.LinAlgError:
        return False
    whole = second(point.residual("state"))
    diagonal = np.diagonal(whole)
    if not (diagonal > 0.0).all():
        return False
    terms = np.abs(back) @ point.parts("state")[:nv, :nq] @ (np.abs(there) @ np.abs(rates))
    doubt = ROUNDING * terms + np.abs(whole - whole.T)
    chance = random.Random(0)
    for _ in range(TRIALS):
        move = there @ (steps * [chance.choice((-1.0, 1.0)) for _ in steps])
        for x in (point.x[:nq] + move, point.x[:nq] - move):
            other = Point(point.system, point.t, [*x.tolist(), *point.x[nq:]], point.a, point.lam)
            doubt = np.maximum(doubt, np.abs(second(other.residual("state")) - whole))
    unit = 1.0 / np.sqrt(np.outer(diagonal, diagonal))
    lowest = float(np.linalg.eigvalsh(unit * (whole + whole.T) / 2.0)[0])
    return lowest > float(np.linalg.norm(unit * doubt))


def _left(point: Point, indices: Sequence[int]) -> Array:
    """The accelerations of the independent speeds, which are 0 up to round-off, and their round-off."""
    nq, nc = point.system.nq, point.system.nc
    here = np.array(point.a)
    found = np.abs(here)
    for other in point.perturbed:
        rates = [0.0] * point.system.nx
        if other.system.rhs(other.t, other.x, rates, [0.0] * nc) not in FAILED:
            found = np.maximum(found, np.abs(rates[nq : nq + len(here)] - here))
    own: Array = found[[k - nq for k in indices if k >= nq]]
    return own


UNKNOWN = 1e-14  # of the norm of a matrix: the error of its entries
NEAR = 1e-7  # its root: the error of a double eigenvalue
SWEEPS = 20  # largest number of balancing sweeps


class Spectrum(NamedTuple):
    values: Any  # complex; real and imaginary parts that are rounding are 0
    vectors: Any  # columns


def spectrum(a: Array, scales: Array) -> Spectrum:
    """The eigenvalues and eigenvectors of `a`, balanced, with unknowns measured by `scales`. An eigenvalue is
    accurate to the round-off of the norm over the cosine between its right and left vectors (G. H. Golub, C.
    F. Van Loan, Matrix Computations, 4th ed., 7.2.2), or to the root of that if vectors coincide."""
    if not len(a):
        return Spectrum(np.zeros(0, complex), np.zeros((0, 0), complex))
    scales = _balanced(a, scales)
    scaled = a * scales / scales[:, None]
    values, vectors = (part.astype(complex) for part in np.linalg.eig(scaled))
    _, stretch, right = np.linalg.svd(vectors)
    cosines = 1.0 / np.linalg.norm(right / np.maximum(stretch, UNKNOWN)[:, None], axis=0)
    errors = np.linalg.norm(scaled) * np.minimum(UNKNOWN / cosines, NEAR)
    for part in (values.real, values.imag):  # views
        part[np.abs(part) <= errors] = 0.0
    return Spectrum(values, scales[:, None] * vectors)


def _balanced(a: Array, scales: Array) -> Array:
    """`scales` times powers of two that make rows and columns of similar length (B. N. Parlett, C. Reinsch,
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
