"""The smallest solution of a linear system whose rows may depend on each other."""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt

_LARGE = 300_000  # products; beyond it NumPy's start-up time is worth it
_DEPENDENT = 1e-7  # above the noise of rows found by finite differences


def least_norm(rows: Sequence[Sequence[float]], right: Sequence[float]) -> list[float]:
    """The shortest y with rows . y = right.

    Rows that depend on the ones before (to 1e-7 of their length) are left out, the longest
    remaining row first: a modified Gram-Schmidt factorisation L Q of the chosen rows, each
    orthogonalised twice.
    """
    n = len(rows[0]) if rows else 0
    lengths = [sqrt(sum(a * a for a in row)) for row in rows]
    scaled = [[a / s for a in row] for row, s in zip(rows, lengths) if s > 0.0]
    values = [b / s for b, s in zip(right, lengths) if s > 0.0]
    if len(scaled) * len(scaled) * n > _LARGE:
        import numpy

        matrix, vector = numpy.array(scaled), numpy.array(values)
        found: list[float] = numpy.linalg.lstsq(matrix, vector, rcond=_DEPENDENT)[0].tolist()
        return found
    solution = [0.0] * n
    basis: list[list[float]] = []
    coefficients: list[float] = []
    remaining = list(range(len(scaled)))
    rests = [row[:] for row in scaled]
    while remaining:
        norm, k = max((sum(a * a for a in rests[i]), -i) for i in remaining)
        k, norm = -k, sqrt(norm)
        if norm < _DEPENDENT:
            break
        remaining.remove(k)
        direction = [a / norm for a in rests[k]]
        for q in basis:
            _remove(direction, q)
        length = sqrt(sum(a * a for a in direction))
        direction = [a / length for a in direction]
        row = scaled[k]
        known = sum(c * _dot(row, q) for c, q in zip(coefficients, basis))
        coefficient = (values[k] - known) / _dot(row, direction)
        basis.append(direction)
        coefficients.append(coefficient)
        for i in remaining:
            _remove(rests[i], direction)
    for c, q in zip(coefficients, basis):
        for i in range(n):
            solution[i] += c * q[i]
    return solution


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    return sum(x * y for x, y in zip(a, b))


def _remove(vector: list[float], direction: Sequence[float]) -> None:
    part = _dot(vector, direction)
    for i, d in enumerate(direction):
        vector[i] -= part * d
