"""Small dense linear algebra on floats, for questions asked at compile time."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from operator import mul
from typing import TypeAlias

from lagc.symbolic.finite_field import P, power

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


class _Row:
    """A vector with the window in which it may differ from zero."""

    __slots__ = ("begin", "stop", "values")

    def __init__(self, values: list[float]):
        self.values = values
        self.begin = next((j for j, x in enumerate(values) if x), 0)
        self.stop = next((j for j in range(len(values), self.begin, -1) if values[j - 1]), self.begin)

    def length(self) -> float:
        own = self.values[self.begin : self.stop]
        return math.sqrt(dot(own, own))

    def over(self, size: float) -> _Row:
        return _Row([x / size for x in self.values])

    def along(self, e: _Row) -> float:
        """The part of this along a unit vector, which is taken away."""
        if e.begin >= self.stop or self.begin >= e.stop:
            return 0.0
        own, other = self.values[e.begin : e.stop], e.values[e.begin : e.stop]
        part = dot(other, own)
        if part:
            self.values[e.begin : e.stop] = [x - part * y for x, y in zip(own, other)]
            self.begin, self.stop = min(self.begin, e.begin), max(self.stop, e.stop)
        return part


class Span:
    """The span of normalized rows by an orthonormal basis. `rank` is decided at the widest gap among the
    remainders of rows without the rows before them, the largest first (`left`)."""

    def __init__(self, rows: Sequence[Sequence[float]]):
        self._units = [_unit(row) for row in rows]
        self.left: list[float] = []
        self.made: list[tuple[int, list[float]]] = []  # row of each base, its parts along those before
        self._base: list[_Row] = []
        rest = {k: _Row(list(row)) for k, row in enumerate(self._units) if row is not None}
        sizes = {k: row.length() for k, row in rest.items()}
        parts: dict[int, list[float]] = {k: [] for k in rest}
        while rest:
            best = max(sizes, key=sizes.__getitem__)
            size = sizes.pop(best)
            if size <= _ROUNDING:
                break
            e = rest.pop(best).over(size)
            if size < _LITTLE:  # once more: what was left is rounding in part
                e = self._orthogonal(e)
            self._base.append(e)
            self.left.append(size)
            self.made.append((best, [*parts.pop(best), size]))
            for k, row in rest.items():
                part = row.along(e)
                parts[k].append(part)
                if part:
                    sizes[k] = row.length()
        self._others = parts  # of the rows that gave no base
        self.rank, self._threshold = _gap(self.left)
        del self._base[self.rank :]

    def _orthogonal(self, e: _Row) -> _Row:
        found = _Row(self.remainder(e.values))
        size = found.length()
        return found.over(size) if size else found

    def remainder(self, x: Sequence[float]) -> list[float]:
        """`x` less its part in the span."""
        rest = _Row(list(x))
        for e in self._base:
            rest.along(e)
        return rest.values

    def combined(self, parts: Sequence[float], n: int) -> list[float]:
        """The sum of the bases, each times its part: a vector of n."""
        found = [0.0] * n
        for part, e in zip(parts, self._base):
            own = zip(found[e.begin : e.stop], e.values[e.begin : e.stop])
            found[e.begin : e.stop] = [a + part * b for a, b in own]
        return found

    def entangled(self) -> frozenset[int]:
        """Return the rows in vanishing sums, sum(z[k]*row[k]) = 0 with nonzero z[k]: their multipliers are
        not unique. Each row beyond the rank gives one such sum by back substitution."""
        bases = self.made[: self.rank]
        found = set()
        for row, parts in [*self.made[self.rank :], *self._others.items()]:
            rest = list(parts[: self.rank])
            for at in reversed(range(self.rank)):
                other, own = bases[at]
                factor = rest[at] / own[at]
                rest[:at] = [x - factor * y for x, y in zip(rest, own[:at])]
                if abs(factor) > _SPARE:
                    found |= {row, other}
        return frozenset(found | {k for k, unit in enumerate(self._units) if unit is None})

    def independent(self) -> list[int]:
        """The first rows, in their order, that span all."""
        held: list[_Row] = []
        found: list[int] = []
        for k, unit in enumerate(self._units):
            if unit is None or len(found) == self.rank:
                continue
            row = _Row(list(unit))
            for e in held:
                row.along(e)
            size = row.length()
            if size > self._threshold:
                found.append(k)
                held.append(row.over(size))
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
    for k, parts in spanned.made[: spanned.rank]:
        size = max(map(abs, matrix[k]))
        length = size * math.sqrt(sum((x / size) ** 2 for x in matrix[k]))
        y.append((right[k] / length - dot(parts, y)) / parts[-1])
    return spanned.combined(y, len(matrix[0]))


Entries: TypeAlias = dict[int, int]  # column -> value, zeros left out
RIGHT = -1  # the column of the right-hand side


class Echelon:
    """Rows taken in one by one, each reduced by those before."""

    def __init__(self) -> None:
        self.rows: dict[int, Entries] = {}  # pivot -> row, one at the pivot

    def reduce(self, row: Mapping[int, int]) -> Entries:
        """`row` less its part along the rows taken in."""
        rest = {j: x for j, x in row.items() if x}
        for pivot, base in self.rows.items():
            factor = rest.get(pivot)
            if factor:
                _subtract(rest, factor, base)
        return rest

    def grows(self, row: Mapping[int, int]) -> bool:
        """Take a row in; False where it follows from those before."""
        rest = self.reduce(row)
        pivot = next((j for j in rest if j != RIGHT), None)
        if pivot is None:
            return False
        scale = power(rest[pivot], -1)
        rest = {j: x * scale % P for j, x in rest.items()}
        self.rows[pivot] = rest
        return True

    @property
    def rank(self) -> int:
        return len(self.rows)

    def solution(self, columns: Iterable[int], draw: Callable[[], int]) -> Entries:
        """x with rows . x = right, free entries drawn."""
        values = {j: 0 if j in self.rows else draw() for j in columns}
        values[RIGHT] = P - 1
        for pivot, row in reversed(self.rows.items()):
            values[pivot] = -sum(x * values[j] for j, x in row.items() if j != pivot) % P
        del values[RIGHT]
        return values


def _subtract(row: Entries, factor: int, base: Mapping[int, int]) -> None:
    for j, x in base.items():
        value = (row.get(j, 0) - factor * x) % P
        if value:
            row[j] = value
        else:
            row.pop(j, None)


def solve_exactly(
    rows: Iterable[Mapping[int, int]], columns: Iterable[int], draw: Callable[[], int]
) -> Entries | None:
    """x with row . x = row[RIGHT] for all rows, free entries drawn; None where they contradict."""
    taken = Echelon()
    for row in rows:
        if not taken.grows(row) and taken.reduce(row):
            return None
    return taken.solution(columns, draw)
