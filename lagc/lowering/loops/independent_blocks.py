"""Initial equations that consist of blocks without a common unknown, as those of many instances, in an order
in which some blocks can be evaluated alone.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from itertools import accumulate
from typing import Any, TypeAlias

from lagc.base.records import replace
from lagc.lowering.loops.loop_rolling import Letter, lettered, rerolled, rerolled_between
from lagc.lowering.program import LEAVES, Function, Run
from lagc.lowering.scalar.value_numbering import STRAIGHT, reordered

_LEAST = 3  # pieces, and alike that make a loop

_Piece: TypeAlias = "tuple[list[int], list[int]]"  # operations and stores


def in_pieces(function: Function) -> Function:
    """`function` rolled; with its `pieces`, where it is long and there are such."""
    if function.cleared or len(function.operations) + len(function.stores) <= STRAIGHT:
        return rerolled(function)
    common, pieces = _apart(function)
    if len(pieces) < _LEAST:
        return rerolled(function)
    function, letters = lettered(function)
    alike = _alike(function, letters, pieces)
    ordered = _in_order(function, [common, *(piece for group in alike for piece in group)])
    runs = _runs(ordered, common, alike)
    parts = [piece for group in alike for piece in group]
    rows = _of_rows(function, parts)
    if not {*range(len(parts))} <= {*rows}:  # nobody would ask for the others
        return rerolled(function)
    return replace(ordered, runs=runs, pieces=_of_unknowns(function, parts), row_pieces=rows)


def _apart(function: Function) -> tuple[_Piece, list[_Piece]]:
    """Return the operations without an unknown, and the sets of operations that share unknowns, in the order
    of their leaves."""
    operations = function.operations
    parent = list(range(len(operations)))
    moving = [k >= 0 for k in _unknowns(function)]

    def root(k: int) -> int:
        while parent[k] != k:
            parent[k] = parent[parent[k]]
            k = parent[k]
        return k

    for k, o in enumerate(operations):
        for a in o.operands:
            if moving[a]:
                moving[k] = True
                one, other = sorted((root(a), root(k)))
                parent[other] = one
    common: _Piece = ([], [])
    found: dict[int, _Piece] = {}
    for k, o in enumerate(operations):
        if o.op not in LEAVES:
            (found.setdefault(root(k), ([], [])) if moving[k] else common)[0].append(k)
    for k, store in enumerate(function.stores):
        value = store.value
        (found.setdefault(root(value), ([], [])) if moving[value] else common)[1].append(k)
    return common, [piece for _, piece in sorted(found.items())]


def _alike(function: Function, letters: Sequence[Letter], pieces: Sequence[_Piece]) -> list[list[_Piece]]:
    """Return the blocks that have the same operations and stores in the same order, with the same edges."""
    count = len(function.operations)
    found: dict[Any, list[_Piece]] = {}
    for piece in pieces:
        own, stores = piece
        place = {k: n for n, k in enumerate(own)}
        edges = [tuple([place.get(a, -1) for a in function.operations[k].operands]) for k in own]
        ends = [place.get(function.stores[k].value, -1) for k in stores]
        text = [letters[k] for k in own] + [letters[count + k] for k in stores]
        key = tuple(text), tuple(edges), tuple(ends)
        found.setdefault(key, []).append(piece)
    return [*found.values()]


def _in_order(function: Function, pieces: Sequence[_Piece]) -> Function:
    """Piece by piece, behind the leaves."""
    order = [k for k, o in enumerate(function.operations) if o.op in LEAVES]
    order += [k for own, _ in pieces for k in own]
    stores = [k for _, own in pieces for k in own]
    count = len(function.operations)
    place = {count + k: count + n for n, k in enumerate(stores)}
    comments = {place.get(k, k): text for k, text in function.comments.items()}
    moved = replace(function, stores=tuple([function.stores[k] for k in stores]), comments=comments)
    return reordered(moved, order)


def _runs(function: Function, common: _Piece, alike: Sequence[Sequence[_Piece]]) -> tuple[Run, ...]:
    """Loops through pieces that are alike, unless what they have in loops of their own is less to write."""
    numbers = [0, *accumulate(map(len, alike))]  # of the first piece of each
    groups = [(-1, [common]), *zip(numbers, alike)]
    at = sum([o.op in LEAVES for o in function.operations])
    blocks: list[tuple[int, int, int, int]] = []  # first piece, where it begins, size, how many
    for part in (0, 1):
        for piece, group in groups:
            size = len(group[0][part])
            blocks.append((piece, at, size, len(group)))
            at += size * len(group)
    starts = [at + size * n for _, at, size, count in blocks for n in range(count if size else 0)]
    inner = deque(rerolled_between(function, starts))
    found: list[Run] = []
    for piece, at, size, count in blocks:
        own: list[Run] = []
        while inner and inner[0].first < at + size * count:
            run = inner.popleft()
            own.append(run if piece < 0 else replace(run, piece=piece + (run.first - at) // size))
        if piece >= 0 and count >= _LEAST and 0 < size <= sum([run.period for run in own]):
            own = [Run(at, size, count, piece, through=True)]
        found += own
    return tuple(found)


def _of_unknowns(function: Function, pieces: Sequence[_Piece]) -> tuple[int, ...]:
    """Which piece needs each entry of x."""
    unknowns = _unknowns(function)
    found = [-1] * (max(unknowns, default=-1) + 1)
    for number, (own, stores) in enumerate(pieces):
        taken = [a for k in own for a in function.operations[k].operands]
        for a in (*taken, *(function.stores[k].value for k in stores)):
            if unknowns[a] >= 0:
                found[unknowns[a]] = number
    return tuple(found)


def _of_rows(function: Function, pieces: Sequence[_Piece]) -> tuple[int, ...]:
    """Which piece makes each entry of the first output."""
    array, length = function.outputs[0]
    found = [-1] * length
    for number, (_, stores) in enumerate(pieces):
        for k in stores:
            if function.stores[k].array == array:
                found[function.stores[k].index] = number
    return tuple(found)


def _unknowns(function: Function) -> list[int]:
    """Which entry of x each operation loads, -1 for none."""
    loaded = [o.payload if isinstance(o.payload, tuple) else ("", 0) for o in function.operations]
    return [index if array == "x" else -1 for array, index in loaded]
