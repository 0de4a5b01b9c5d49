"""Small dense linear algebra on floats, for questions asked at compile time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from operator import mul

_SPARE = 1e-6  # of a row of size one: less may be rounding, or what Newton's steps left
_LITTLE = 1e-2
_ROUNDING = 1e-16


def solve(matrix: Sequence[Sequence[float]], right: Sequence[float]) -> list[float] | None:
    """x with matrix x = right (n x n, n); None where the matrix is singular."""
    n = len(right)
    table = [[*row, r] for row, r in zip(matrix, right)]
    for i, row in enumerate(table):  # to one size, so that pivots do not depend on units
        size = max(map(abs, row[:n]), default=0.0)
        if size:
            table[i] = [x / size for x in row]
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


class Span:
    """The span of rows, which are taken to size one: `basis` is orthonormal, `rank` is decided at the
    widest gap among what is left of rows beside those before them, the largest first (`left`)."""

    def __init__(self, rows: Sequence[Sequence[float]]):
        self._units = [_unit(row) for row in rows]
        self.basis: list[list[float]] = []
        self.left: list[float] = []
        self.made: list[tuple[int, list[float]]] = []  # row of each base, its parts along those before
        rest = {k: row for k, row in enumerate(self._units) if row is not None}
        parts: dict[int, list[float]] = {k: [] for k in rest}
        while rest:
            sizes = {k: math.sqrt(dot(row, row)) for k, row in rest.items()}
            best = max(sizes, key=lambda k: sizes[k])
            size = sizes[best]
            if size <= _ROUNDING:
                break
            e = [x / size for x in rest.pop(best)]
            if size < _LITTLE:  # once more: what was left is rounding in part
                e = self._orthogonal(e)
            self.basis.append(e)
            self.left.append(size)
            self.made.append((best, [*parts.pop(best), size]))
            for k, row in rest.items():
                part = dot(e, row)
                parts[k].append(part)
                if part:
                    rest[k] = [x - part * y for x, y in zip(row, e)]
        self.rank, self._threshold = _gap(self.left)
        del self.basis[self.rank :]

    def _orthogonal(self, e: list[float]) -> list[float]:
        e = self.remainder(e)
        size = math.sqrt(dot(e, e))
        return [x / size for x in e] if size else e

    def remainder(self, x: Sequence[float]) -> list[float]:
        """`x` less its part in the span."""
        rest = list(x)
        for e in self.basis:
            part = dot(e, rest)
            rest = [a - part * b for a, b in zip(rest, e)]
        return rest

    def independent(self) -> list[int]:
        """The first rows, in their order, that span all."""
        held: list[list[float]] = []
        found: list[int] = []
        for k, row in enumerate(self._units):
            if row is None or len(found) == self.rank:
                continue
            for e in held:
                part = dot(e, row)
                row = [x - part * y for x, y in zip(row, e)]
            size = math.sqrt(dot(row, row))
            if size > self._threshold:
                found.append(k)
                held.append([x / size for x in row])
        return found


def _unit(row: Sequence[float]) -> list[float] | None:
    size = max(map(abs, row), default=0.0)
    if not 0.0 < size < math.inf:
        return None
    scaled = [x / size for x in row]
    length = math.sqrt(dot(scaled, scaled))
    return [x / length for x in scaled]


def _gap(left: Sequence[float]) -> tuple[int, float]:
    """How many of the falling numbers are no remainders, and what lies between."""
    falling = [*left, _ROUNDING]
    rank = max(
        (k for k in range(1, len(falling)) if falling[k] < _SPARE),
        key=lambda k: falling[k - 1] / falling[k],
        default=0,
    )
    return (rank, math.sqrt(falling[rank - 1] * falling[rank])) if rank else (0, 1.0)


def dimension(vectors: Sequence[Sequence[float]], least: float) -> int:
    """How many of the vectors are longer than `least` beside those before them, the longest first."""
    rest = [list(x) for x in vectors]
    found = 0
    while rest:
        longest = max(rest, key=lambda x: dot(x, x))
        size = math.sqrt(dot(longest, longest))
        if size <= least:
            break
        rest.remove(longest)
        e = [x / size for x in longest]
        rest = [[a - part * b for a, b in zip(x, e)] for x in rest for part in [dot(e, x)]]
        found += 1
    return found


def dot(x: Sequence[float], y: Sequence[float]) -> float:
    return float(sum(map(mul, x, y)))


def least_norm(matrix: Sequence[Sequence[float]], right: Sequence[float]) -> list[float]:
    """x of least norm with matrix x = right, for the rows that `Span` calls independent."""
    spanned = Span(matrix)
    y: list[float] = []
    for (k, parts), _ in zip(spanned.made, spanned.basis):
        size = max(map(abs, matrix[k]))
        length = size * math.sqrt(sum((x / size) ** 2 for x in matrix[k]))
        y.append((right[k] / length - dot(parts, y)) / parts[-1])
    return [dot(y, column) for column in zip(*spanned.basis)] if y else [0.0] * len(matrix[0])
