"""Linear algebra in the finite field of `expr.modular`: exact, so that a rank needs no tolerance."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TypeAlias

from lagc.symbolic.finite_field import P, power

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


def solve(
    rows: Iterable[Mapping[int, int]], columns: Iterable[int], draw: Callable[[], int]
) -> Entries | None:
    """x with row . x = row[RIGHT] for all rows, free entries drawn; None where they contradict."""
    taken = Echelon()
    for row in rows:
        if not taken.grows(row) and taken.reduce(row):
            return None
    return taken.solution(columns, draw)
