"""The Jacobian of rows on states, reduced line by line: what depends on the lines before has nothing left.

Rows that are given by sums (see `Entries`) are not put together: the sums are unknowns too, and the
definition of each is a line before the first row that builds on it.  Rows depend on each other as they do
without.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from heapq import heapify, heappop, heappush
from typing import NamedTuple

from lagc.mechanics.formulation.equations import Row
from lagc.mechanics.formulation.jacobian import Entries
from lagc.mechanics.formulation.states import States
from lagc.mechanics.numeric.cancellation import VANISHES, magnitudes
from lagc.mechanics.numeric.samples import samples
from lagc.symbolic.graph import Node

_WORTH = 0.1  # of a line's largest entry: less is no pivot

Columns = Mapping[int, tuple[float, float]]  # of a line: value and size of each entry


class _Base(NamedTuple):
    line: int
    pivot: int
    entries: dict[int, float]
    factors: dict[int, float]  # of the bases before that were taken from it


class Reduced:
    """The lines on one state; `rows` are the rows that they are, None of the definition of a sum."""

    def __init__(self, rows: Sequence[int | None], lines: Sequence[Columns]):
        self.rows = rows
        self.entries = [{j: x for j, (x, _) in line.items()} for line in lines]
        self.sizes = [max([size for _, size in line.values()], default=0.0) for line in lines]
        self._bases: list[_Base] = []
        self._of_pivot: dict[int, int] = {}
        self._last = {j: k for k, line in enumerate(lines) for j in line}  # line that has an entry there

    def surely(self, line: int) -> dict[int, bool]:
        """By column, whether the entry is more than rounding."""
        return {j: abs(x) > VANISHES * self.sizes[line] for j, x in self.entries[line].items()}

    def reduce(self, line: int) -> tuple[dict[int, float], dict[int, float]]:
        """Return the remainder of a line, and the factor of each base that was taken from it."""
        left, factors = dict(self.entries[line]), dict[int, float]()
        waiting = [self._of_pivot[j] for j in left if j in self._of_pivot]
        heapify(waiting)
        while waiting:
            k = heappop(waiting)
            base = self._bases[k]
            factors[k] = left.pop(base.pivot) / base.entries[base.pivot]
            for j, x in base.entries.items():
                if j in left:
                    left[j] -= factors[k] * x
                elif j != base.pivot:
                    left[j] = -factors[k] * x
                    if j in self._of_pivot:
                        heappush(waiting, self._of_pivot[j])
        return left, factors

    def depends(self, line: int, left: Mapping[int, float]) -> bool:
        return max(map(abs, left.values()), default=0.0) <= VANISHES * self.sizes[line]

    def add(self, line: int, left: dict[int, float], factors: dict[int, float]) -> None:
        """Add the remainder of a line, unless it is zero, as a base for the lines to come; its pivot is in
        the column that these are done with first."""
        largest = max(map(abs, left.values()), default=0.0)
        if largest:
            pivots = [j for j, x in left.items() if abs(x) >= _WORTH * largest]
            pivot = min(pivots, key=lambda j: (self._last[j], -abs(left[j])))
            self._of_pivot[pivot] = len(self._bases)
            self._bases.append(_Base(line, pivot, left, factors))

    def made_of(self, factors: Mapping[int, float]) -> dict[int, float]:
        """The rows that such a part of a line is made of."""
        weights, found = dict(factors), dict[int, float]()
        for k in range(len(self._bases) - 1, -1, -1):
            weight, base = weights.pop(k, 0.0), self._bases[k]
            row = self.rows[base.line]
            if weight and row is not None:
                found[row] = weight
            for i, x in base.factors.items() if weight else ():
                weights[i] = weights.get(i, 0.0) - weight * x
        return found


def tables(
    states: States, rows: Sequence[Row], count: int, vary: bool = True
) -> Iterator[tuple[dict[Node, float], Reduced]]:
    """Yield `count` random states, as `samples` does, each with the lines of `rows` there."""
    lines = list(_lines([row.jacobian for row in rows]))
    numbers = [line.row for line in lines]
    nodes = [node for line in lines for node in line.slopes.values()]
    for sample in samples(states.model, count, vary) if rows else ():
        values = magnitudes(nodes, sample)
        if all(math.isfinite(size) for _, size in values):
            value = iter(values)
            own = [{j: next(value) for j in line.slopes} for line in lines]
            yield sample, Reduced(numbers, _measured(lines, own))


class _Line(NamedTuple):
    row: int | None
    column: int | None  # of the sum that it defines
    slopes: Mapping[int, Node]


def _lines(rows: Sequence[Mapping[int, Node]]) -> Iterator[_Line]:
    """`rows`, each behind the definitions of the sums that it builds on."""
    known: set[int] = set()
    for k, row in enumerate(rows):
        if not isinstance(row, Entries):
            yield _Line(k, None, row)
            continue
        own, first, sums = row.slopes.rows[row.k], row.slopes.leaves, row.slopes.sums
        wanted = {j for j in own if j >= first} - known
        new, waiting = set(wanted), list(wanted)
        while waiting:
            below = {j for j in sums[waiting.pop() - first] if j >= first} - known - new
            new |= below
            waiting += below
        for column in sorted(new):
            yield _Line(None, column, sums[column - first])
        known |= new
        yield _Line(k, None, own)


def _measured(lines: Sequence[_Line], found: Sequence[Columns]) -> list[Columns]:
    """`found` with sums measured by what speeds of 1 bring to them, so that their units count for nothing."""
    units: dict[int, float] = {}
    measured: list[Columns] = []
    for line, columns in zip(lines, found):
        if line.row is not None and not units:
            measured.append(columns)
            continue
        sized = {j: (x * units.get(j, 1.0), size * units.get(j, 1.0)) for j, (x, size) in columns.items()}
        if line.column is not None:
            unit = max([size for _, size in sized.values()], default=0.0) or 1.0
            units[line.column] = unit
            sized = {j: (x / unit, size / unit) for j, (x, size) in sized.items()}
            sized[line.column] = (-1.0, 1.0)
        measured.append(sized)
    return measured
