"""Conditions that fall into pieces which share no unknown, as those of many instances: in such an order that
loops go through the pieces, and may go through some of them alone."""

from __future__ import annotations

from lagc.optimize.block import reordered
from lagc.optimize.program import LEAVES, Function
from lagc.optimize.rolling import rolled
from lagc.records import replace

_LEAST = 3  # pieces, as many as make a loop


def in_pieces(function: Function) -> Function:
    """`function` rolled; with its `pieces`, where there are such."""
    ordered = _by_piece(function)
    found = rolled(ordered) if ordered else None
    pieces = _pieces(found) if found and found.runs else ()
    return replace(found, pieces=pieces) if found and pieces else rolled(function)


def _by_piece(function: Function) -> Function | None:
    """What belongs to one set of unknowns x that share no operation with others comes together, behind what
    needs none; None where there are fewer than `_LEAST` such sets."""
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
    order = [k for k, o in enumerate(operations) if o.op in LEAVES]
    order += [k for k, o in enumerate(operations) if o.op not in LEAVES and not moving[k]]
    found: dict[int, list[int]] = {}
    for k, o in enumerate(operations):
        if o.op not in LEAVES and moving[k]:
            found.setdefault(root(k), []).append(k)
    if len(found) < _LEAST:
        return None
    order += [k for _, own in sorted(found.items()) for k in own]
    stores = sorted(function.stores, key=lambda store: root(store.value) if moving[store.value] else -1)
    return reordered(replace(function, stores=tuple(stores)), order)


def _pieces(function: Function) -> tuple[int, ...]:
    """The repetition, of the loops that have most, that alone reads each entry of x, -1 where none does;
    nothing where some are read by several, or where repetitions take what others have made, or what is made
    of unknowns outside of these loops."""
    operations, count = function.operations, max([run.count for run in function.runs])
    if count == 1 or function.cleared:
        return ()
    number = [-1] * (len(operations) + len(function.stores))
    for run in function.runs:
        if run.count == count:
            number[run.first : run.end] = [n for n in range(count) for _ in range(run.period)]
    unknowns = _unknowns(function)
    moving = [k >= 0 for k in unknowns]
    items = [*(o.operands for o in operations), *((store.value,) for store in function.stores)]
    readers: dict[int, set[int]] = {}
    for k, (own, operands) in enumerate(zip(number, items)):
        if k < len(operations):
            moving[k] = moving[k] or any([moving[a] for a in operands])
        for a in operands:
            alike = number[a] == own or (number[a] < 0 and not moving[a])
            if operations[a].op not in LEAVES and not alike:
                return ()
            if own >= 0 and unknowns[a] >= 0:
                readers.setdefault(unknowns[a], set()).add(own)
    if any([len(own) > 1 for own in readers.values()]):
        return ()
    found = tuple([min(readers.get(k, (-1,))) for k in range(max(readers, default=-1) + 1)])
    return found if max(found, default=-1) == count - 1 else ()  # printers know the loops by their count


def _unknowns(function: Function) -> list[int]:
    """Which entry of x each operation loads, -1 for none."""
    loaded = [o.payload if isinstance(o.payload, tuple) else ("", 0) for o in function.operations]
    return [index if array == "x" else -1 for array, index in loaded]
