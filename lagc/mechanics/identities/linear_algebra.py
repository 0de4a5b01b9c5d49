"""Ranks, null spaces and solutions of least norm of small dense matrices, for questions at compile time.

A rank is decided at the widest gap among the singular values of rows of length one, and a gap of numbers that
are remainders by rounding is wide: the last bits of a singular value, which depend on the machine, decide
nothing.
"""

import math
from collections.abc import Sequence
from operator import mul

import numpy as np

_SPARE = 1e-6  # of a row of length one: less may be rounding, or what Newton's steps left
_ROUNDING = 1e-16

Matrix = Sequence[Sequence[float]]


class Span:
    """The span of rows of one length, by the singular value decomposition of the rows scaled to length one.
    Rows that are zero or not finite count as zero."""

    def __init__(self, rows: Matrix):
        given = np.array([*rows], dtype=float).reshape(len(rows), len(rows[0]) if rows else 0)
        largest = np.max(np.abs(given), axis=1, initial=0.0)
        directed = np.isfinite(largest) & (largest > 0.0)
        self._units, self._lengths = np.zeros_like(given), np.full(len(rows), np.inf)
        scaled = given[directed] / largest[directed, None]  # squares of what is large do not overflow
        norms = np.linalg.norm(scaled, axis=1)
        self._units[directed] = scaled / norms[:, None]
        self._lengths[directed] = largest[directed] * norms
        left, self._values, right = np.linalg.svd(self._units)
        self.rank, self._threshold = _gap(self._values.tolist())
        self._left, self._null_left = left[:, : self.rank], left[:, self.rank :]
        self._basis, self._null = right[: self.rank], right[self.rank :]

    def remainder(self, x: Sequence[float]) -> list[float]:
        """Return `x` less its part in the span."""
        rest = np.array(x, dtype=float)
        for _ in range(2 if self.rank else 0):  # the second time for the rounding of the first
            rest -= self._basis.T @ (self._basis @ rest)
        found: list[float] = rest.tolist()
        return found

    def null_space(self) -> list[list[float]]:
        """Return an orthonormal basis of the x with rows . x = 0."""
        found: list[list[float]] = self._null.tolist()
        return found

    def entangled(self) -> frozenset[int]:
        """Return the rows in vanishing sums, sum(z[k]*row[k]) = 0 with nonzero z[k]: their multipliers are
        not unique."""
        return frozenset(np.flatnonzero(np.linalg.norm(self._null_left, axis=1) > _SPARE).tolist())

    def independent(self) -> list[int]:
        """Return the first rows, in their order, that span all: those that have a part of their own beside
        the rows before (Gram-Schmidt)."""
        basis = np.zeros((0, self._units.shape[1]))
        found: list[int] = []
        for k, unit in enumerate(self._units):
            if len(found) == self.rank:
                break
            rest = unit - basis.T @ (basis @ unit)
            rest -= basis.T @ (basis @ rest)
            size = np.linalg.norm(rest)
            if size > self._threshold:
                found.append(k)
                basis = np.vstack([basis, rest / size])
        return found

    def least_norm(self, right: Sequence[float]) -> list[float]:
        """Return x of least norm with rows . x = right; with dependent rows, the one nearest to all."""
        wanted = np.array(right, dtype=float) / self._lengths
        found: list[float] = (self._basis.T @ (self._left.T @ wanted / self._values[: self.rank])).tolist()
        return found


def _gap(values: Sequence[float]) -> tuple[int, float]:
    """Return how many of the falling numbers come before the widest gap that ends below `_SPARE`, and the
    middle of this gap."""
    falling = [*(max(x, _ROUNDING) for x in values), _ROUNDING]
    ends = [k for k in range(1, len(falling)) if falling[k] < _SPARE]
    rank = max(ends, key=lambda k: falling[k - 1] / falling[k], default=0)
    if rank == 0 or falling[rank - 1] <= _ROUNDING:
        return 0, 1.0
    return rank, math.sqrt(falling[rank - 1] * falling[rank])


def dimension(vectors: Matrix, least: float) -> int:
    """Return the number of directions in which the vectors are longer than `least`."""
    return (
        int(np.sum(np.linalg.svd(np.array(vectors, dtype=float), compute_uv=False) > least)) if vectors else 0
    )


def least_norm(matrix: Matrix, right: Sequence[float]) -> list[float]:
    """Return x of least norm with matrix x = right, as in `Span`."""
    return Span(matrix).least_norm(right)


def solve(matrix: Matrix, right: Sequence[float]) -> list[float] | None:
    """Return x with matrix x = right (n x n, n), or None if the matrix is singular."""
    table, wanted = np.array(matrix, dtype=float), np.array(right, dtype=float)
    sizes = np.max(np.abs(table), axis=1, initial=0.0)  # to one size, so that pivots do not depend on units
    sizes[sizes == 0.0] = 1.0
    try:
        found: list[float] = np.linalg.solve(table / sizes[:, None], wanted / sizes).tolist()
    except np.linalg.LinAlgError:
        return None
    return found


def dot(x: Sequence[float], y: Sequence[float]) -> float:
    """Return the scalar product."""
    return float(sum(map(mul, x, y)))
