"""Where pieces of the conditions of a start are: what goes to compiled code, and what comes back."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeAlias

from lagc.optimize.program import Interface

Found: TypeAlias = "tuple[list[slice], list[slice], list[slice]]"


class Spans:
    """Of pieces first..last-1, and of what belongs to none: the unknowns in x, the conditions in c and sizes,
    the derivatives in J."""

    def __init__(self, interface: Interface):
        pieces = interface.pieces
        self.ends = interface.condition_ends
        self.unknowns: dict[int, list[int]] = {}  # of each piece; -1: of none
        self.rows: dict[int, list[int]] = {}
        for j, piece in enumerate(pieces):
            self.unknowns.setdefault(piece, []).append(j)
        begin = 0
        for i, end in enumerate(self.ends):
            own = [pieces[j] for j in interface.condition_columns[begin:end] if j < len(pieces)]
            self.rows.setdefault(max(own, default=-1), []).append(i)
            begin = end
        self.known: dict[tuple[int, int], Found] = {}

    def __call__(self, first: int, last: int) -> Found:
        if (first, last) not in self.known:
            asked, ends = (-1, *range(first, last)), self.ends
            unknowns = sorted([j for piece in asked for j in self.unknowns.get(piece, ())])
            rows = sorted([i for piece in asked for i in self.rows.get(piece, ())])
            entries = [k for i in rows for k in range(ends[i - 1] if i > 0 else 0, ends[i])]
            self.known[first, last] = slices(unknowns), slices(rows), slices(entries)
        return self.known[first, last]


def slices(numbers: Iterable[int]) -> list[slice]:
    """Those that ascending numbers make where they follow each other."""
    found: list[slice] = []
    begin = end = -1
    for k in numbers:
        if k != end:
            if begin >= 0:
                found.append(slice(begin, end))
            begin = k
        end = k + 1
    return [*found, slice(begin, end)] if begin >= 0 else found
