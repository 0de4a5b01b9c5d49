"""Where pieces of the conditions of a start are: what goes to compiled code, and what comes back."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeAlias

from lagc.lowering.program import Interface

Found: TypeAlias = "tuple[list[slice], list[slice], list[slice]]"


class Spans:
    """Of pieces first..last-1: the unknowns in x; and with what belongs to none the conditions in c and
    sizes, the derivatives in J."""

    def __init__(self, interface: Interface):
        self.ends = interface.condition_ends
        self.unknowns: dict[int, list[int]] = {}  # of each piece; -1: of none
        self.rows: dict[int, list[int]] = {}
        for j, piece in enumerate(interface.pieces):
            self.unknowns.setdefault(piece, []).append(j)
        for i, piece in enumerate(interface.row_pieces):
            self.rows.setdefault(piece, []).append(i)
        self.known: dict[tuple[int, int], Found] = {}

    def __call__(self, first: int, last: int) -> Found:
        if (first, last) not in self.known:
            asked, ends = range(first, last), self.ends
            unknowns = sorted([j for piece in asked for j in self.unknowns.get(piece, ())])
            rows = sorted([i for piece in (-1, *asked) for i in self.rows.get(piece, ())])
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
