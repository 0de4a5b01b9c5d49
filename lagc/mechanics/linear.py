"""Small dense linear algebra on floats, for questions asked at compile time."""

from __future__ import annotations

from collections.abc import Sequence

_SMALL = 1e-9  # relative; what cancels leaves about 1e-16


def solve(matrix: Sequence[Sequence[float]], right: Sequence[float]) -> list[float] | None:
    """x with matrix x = right (n x n, n); None where the matrix is singular."""
    n = len(right)
    table = [[*row, r] for row, r in zip(matrix, right)]
    for k in range(n):
        best = max(range(k, n), key=lambda i: abs(table[i][k]))
        table[k], table[best] = table[best], table[k]
        pivot = table[k]
        if not abs(pivot[k]) > 0.0:
            return None
        for i in range(k + 1, n):
            factor = table[i][k] / pivot[k]
            if factor:
                table[i] = [x - factor * y for x, y in zip(table[i], pivot)]
    x = [0.0] * n
    for k in reversed(range(n)):
        x[k] = (table[k][n] - sum(table[k][j] * x[j] for j in range(k + 1, n))) / table[k][k]
    return x


def null_space(matrix: Sequence[Sequence[float]], width: int) -> list[list[float]]:
    """A basis of the x (of length `width`) with matrix x = 0, by reduction with row pivots."""
    rows: list[list[float]] = []
    pivots: list[int] = []
    for given in matrix:
        row = list(given)
        size = max(map(abs, row), default=0.0)
        for pivot, base in zip(pivots, rows):
            factor = row[pivot]
            row = [x - factor * y for x, y in zip(row, base)]
            row[pivot] = 0.0
        best = max(range(width), key=lambda j: abs(row[j]))
        if abs(row[best]) <= _SMALL * size:
            continue
        row = [x / row[best] for x in row]
        for i, base in enumerate(rows):
            factor = base[best]
            rows[i] = [x - factor * y for x, y in zip(base, row)]
        rows.append(row)
        pivots.append(best)
    basis: list[list[float]] = []
    for free in range(width):
        if free not in pivots:
            x = [0.0] * width
            x[free] = 1.0
            for pivot, base in zip(pivots, rows):
                x[pivot] = -base[free]
            basis.append(x)
    return basis
