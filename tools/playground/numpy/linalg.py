"""Small dense linear algebra by Jacobi's rotations (G. H. Golub, C. F. Van Loan, Matrix Computations, 2013,
sections 8.5 and 8.6.3)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from operator import mul
from typing import Any

import numpy as np

ROUNDING = 2.0**-52
SWEEPS = 60


class LinAlgError(ValueError):
    """A matrix without the decomposition that is asked for."""


def norm(x: Any, axis: int | None = None) -> Any:
    x = np.asarray(x)
    return math.hypot(*x.flat) if axis is None else np.sqrt((x * x).sum(axis))


def _dot(x: Sequence[float], y: Sequence[float]) -> float:
    return sum(map(mul, x, y))


def _rotation(a: float, b: float, c: float) -> tuple[float, float]:
    """Return the cosine and the sine of the rotation that makes [[a, c], [c, b]] diagonal."""
    z = (b - a) / (2.0 * c)
    t = math.copysign(1.0, z) / (abs(z) + math.hypot(1.0, z))
    cosine = 1.0 / math.hypot(1.0, t)
    return cosine, t * cosine


def _turn(x: list[float], y: list[float], c: float, s: float) -> tuple[list[float], list[float]]:
    return [c * a - s * b for a, b in zip(x, y)], [s * a + c * b for a, b in zip(x, y)]


def svd(a: Any, full_matrices: bool = True, compute_uv: bool = True) -> Any:
    """Return the singular value decomposition by rotations of the shorter side's vectors (M. R. Hestenes)."""
    a = np.asarray(a)
    m, n = a.shape
    if m > n:
        left, values, right = svd(a.T, full_matrices)
        return (right.T, values, left.T) if compute_uv else values
    if not all(map(math.isfinite, a.flat)):
        raise LinAlgError("a number is not finite")
    rows, turns = a.tolist(), np.eye(m).tolist()  # rows = turns @ a
    for _ in range(SWEEPS):
        turned = False
        for i in range(m):
            for k in range(i + 1, m):
                product, one, other = _dot(rows[i], rows[k]), _dot(rows[i], rows[i]), _dot(rows[k], rows[k])
                if abs(product) > ROUNDING * math.sqrt(one) * math.sqrt(other):
                    c, s = _rotation(one, other, product)
                    rows[i], rows[k] = _turn(rows[i], rows[k], c, s)
                    turns[i], turns[k] = _turn(turns[i], turns[k], c, s)
                    turned = True
        if not turned:
            break
    sizes = [math.hypot(*row) for row in rows]
    order = sorted(range(m), key=lambda k: -sizes[k])
    values = np.array([sizes[k] for k in order], float)
    if not compute_uv:
        return values
    least = ROUNDING * n * max(sizes, default=0.0)
    units = [[x / sizes[k] for x in rows[k]] for k in order if sizes[k] > least]
    basis = np.array(_completed(units, n, n if full_matrices else m), float).reshape(-1, n)
    return np.array([turns[k] for k in order], float).reshape(m, m).T, values, basis


def _completed(units: list[list[float]], n: int, count: int) -> list[list[float]]:
    """Return orthonormal vectors of length n, the given ones first, by Gram and Schmidt's method, twice."""
    found = [*units]
    for k in range(n):
        rest = [float(i == k) for i in range(n)]
        for _ in range(2):
            for unit in found:
                part = _dot(unit, rest)
                rest = [x - part * u for x, u in zip(rest, unit)]
        size = math.hypot(*rest)
        if len(found) < count and size > 0.5 / math.sqrt(n):
            found.append([x / size for x in rest])
    return found


def eigh(a: Any) -> tuple[Any, Any]:
    """Return eigenvalues, rising, and eigenvectors in columns of symmetric matrices (..., n, n)."""
    a = np.asarray(a)
    if a.ndim > 2:
        pairs = [eigh(x) for x in a]
        return np.array([x.tolist() for x, _ in pairs]), np.array([x.tolist() for _, x in pairs])
    n, rows = len(a), a.tolist()
    turns = np.eye(n).tolist()
    for _ in range(SWEEPS):
        turned = False
        for i in range(n):
            for k in range(i + 1, n):
                x = rows[i][k]
                if abs(x) > ROUNDING * (abs(rows[i][i]) + abs(rows[k][k])) * 0.25 and abs(x) > 1e-300:
                    c, s = _rotation(rows[i][i], rows[k][k], x)
                    rows[i], rows[k] = _turn(rows[i], rows[k], c, s)
                    for row in rows:
                        row[i], row[k] = c * row[i] - s * row[k], s * row[i] + c * row[k]
                    turns[i], turns[k] = _turn(turns[i], turns[k], c, s)
                    turned = True
        if not turned:
            break
    order = sorted(range(n), key=lambda k: rows[k][k])
    vectors = np.array([turns[k] for k in order], float).reshape(n, n).T
    return np.array([rows[k][k] for k in order], float), vectors


def eigvalsh(a: Any) -> Any:
    return eigh(a)[0]


def matrix_rank(a: Any, tol: float) -> int:
    return sum(x > tol for x in svd(a, compute_uv=False))


def lstsq(a: Any, b: Any, rcond: float | None = None) -> tuple[Any, ...]:
    """Return x of least norm among those with the least |a x - b|, for a vector b."""
    left, values, right = svd(a, full_matrices=False)
    least = (ROUNDING * max(a.shape) if rcond is None else rcond) * max(values, default=0.0)
    parts = [x / s if s > least else 0.0 for x, s in zip((left.T @ np.asarray(b)).tolist(), values)]
    return np.array(parts, float) @ right[: len(values)], None, sum(s > least for s in values), values


def _eliminated(a: Any) -> tuple[list[list[float]], float]:
    """Return the triangle of Gauss's elimination with pivots by columns, and the determinant."""
    rows, n, determinant = np.asarray(a).tolist(), len(a), 1.0
    for k in range(n):
        p = max(range(k, n), key=lambda i: abs(rows[i][k]))
        determinant *= rows[p][k] if p == k else -rows[p][k]
        rows[k], rows[p] = rows[p], rows[k]
        if rows[k][k] == 0.0:
            return rows, 0.0
        for i in range(k + 1, n):
            factor = rows[i][k] / rows[k][k]
            rows[i] = [x - factor * y for x, y in zip(rows[i], rows[k])]
    return rows, determinant


def det(a: Any) -> float:
    return _eliminated(a)[1]


def solve(a: Any, b: Any) -> Any:
    """Return x with a x = b for a vector b.  Raises LinAlgError for a singular matrix."""
    n = len(b)
    rows, determinant = _eliminated(np.column_stack([a, b])) if n else ([], 1.0)
    if determinant == 0.0:
        raise LinAlgError("the matrix is singular")
    x = [0.0] * n
    for k in reversed(range(n)):
        x[k] = (rows[k][n] - _dot(rows[k][k + 1 : n], x[k + 1 :])) / rows[k][k]
    return np.array(x, float)
