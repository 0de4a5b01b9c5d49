"""The shortest solution of a linear system."""

from __future__ import annotations

from math import fabs, inf, sqrt
from typing import Any

from lagc.kernels.initialization.leastrows import find_near, keep_rest, pair_up, sort_rows
from lagc.kernels.initialization.workspace import StartWork
from lagc.kernels.language.tolerances import FADED
from lagc.kernels.language.words import Real, Vec


def inner(a: Vec[Any], b: Vec[Any], begin: int, stop: int) -> Real:
    total = 0.0
    for j in range(begin, stop):
        total += a[j] * b[j]
    return total


def widen(w: StartWork, i: int, along: int) -> None:
    """Row i of w.rests reaches as far as another, too, that it has places with in common."""
    rest = w.rests[i]
    low = w.lows[i]
    high = w.highs[i]
    lowest = w.lows[along]
    highest = w.highs[along]
    if lowest < low:
        for j in range(lowest, low):
            rest[j] = 0.0
        w.lows[i] = lowest
    if highest > high:
        for j in range(high, highest):
            rest[j] = 0.0
        w.highs[i] = highest


def part_along(w: StartWork, i: int, along: int) -> Real:
    """The inner product of two rows of w.rests, where both are: no more than sparse rows ask for."""
    begin = w.lows[along] if w.lows[i] < w.lows[along] else w.lows[i]
    stop = w.highs[along] if w.highs[along] < w.highs[i] else w.highs[i]
    return inner(w.rests[i], w.rests[along], begin, stop) if begin < stop else 0.0


def clear(w: StartWork, i: int, along: int) -> bool:
    """Take from row i of w.rests its part along a unit vector, another row; whether it has one."""
    part = part_along(w, i, along)
    if part == 0.0:
        return False
    widen(w, i, along)
    values = w.rests[i]
    direction = w.rests[along]
    begin = w.lows[along]
    stop = w.highs[along]
    for j in range(begin, stop):
        values[j] -= part * direction[j]
    return True


def clear_again(w: StartWork, i: int, along: int) -> None:
    """The same of a row that was cleared of it: what rounding has left, which makes it no wider."""
    part = part_along(w, i, along)
    values = w.rests[i]
    direction = w.rests[along]
    begin = w.lows[along] if w.lows[i] < w.lows[along] else w.lows[i]
    stop = w.highs[along] if w.highs[along] < w.highs[i] else w.highs[i]
    for j in range(begin, stop):
        values[j] -= part * direction[j]


def clear_exactly(w: StartWork, i: int, along: int, lost: Real) -> Real:
    """The same, where what is no more than `lost` of what it is the rest of is rounding and becomes 0; the
    largest that is left."""
    part = part_along(w, i, along)
    if part != 0.0:
        widen(w, i, along)
    values = w.rests[i]
    given = w.matrix[i]
    direction = w.rests[along]
    largest = 0.0
    begin = w.lows[i]
    stop = w.highs[i]
    for j in range(begin, stop):
        taken = part * direction[j] if w.lows[along] <= j and j < w.highs[along] else 0.0
        left = fabs(values[j] - taken)
        own = fabs(given[j]) if w.begins[i] <= j and j < w.stops[i] else 0.0
        if left <= lost * own or left <= lost * fabs(taken):
            left = 0.0
            values[j] = 0.0
        else:
            values[j] -= taken
        if left > largest:
            largest = left
    return largest


def shorten(w: StartWork, i: int) -> bool:
    """Make row i of w.rests a unit vector; whether it has a direction."""
    values = w.rests[i]
    begin = w.lows[i]
    stop = w.highs[i]
    largest = 0.0
    for j in range(begin, stop):
        if fabs(values[j]) > largest:
            largest = fabs(values[j])
    if largest == 0.0:
        return False
    for j in range(begin, stop):
        values[j] = values[j] / largest
    length = sqrt(inner(values, values, begin, stop))
    for j in range(begin, stop):
        values[j] = values[j] / length
    return True


def unit_rows(w: StartWork, m: int, lost: Real) -> int:
    """Those of the m rows of w.matrix that are not zero, as unit vectors there and in w.rests; how many they
    are, -1 where a number is not finite."""
    given = 0
    for i in range(m):
        row = w.matrix[i]
        rest = w.rests[i]
        begin = w.begins[i]
        stop = w.stops[i]
        largest = 0.0
        for j in range(begin, stop):
            if not fabs(row[j]) <= largest:
                largest = fabs(row[j])
        if not (largest < inf and fabs(w.right[i]) < inf):
            return -1
        w.chosen[i] = 0
        w.squares[i] = -1.0
        if largest == 0.0:
            continue
        for j in range(begin, stop):
            row[j] = row[j] / largest
        length = sqrt(inner(row, row, begin, stop))
        for j in range(begin, stop):
            row[j] = row[j] / length
            rest[j] = row[j]
        w.lows[i] = begin
        w.highs[i] = stop
        w.squares[i] = 1.0 if lost > 0.0 else inner(rest, rest, begin, stop)
        w.right[i] = w.right[i] / largest / length
        given += 1
    return given


def trim(w: StartWork, i: int) -> None:
    """Let a unit vector, row i of w.rests, end where its entries have faded, as they do along a chain."""
    values = w.rests[i]
    while fabs(values[w.lows[i]]) <= FADED:
        w.lows[i] += 1
    while fabs(values[w.highs[i] - 1]) <= FADED:
        w.highs[i] -= 1


def along_direction(w: StartWork, i: int) -> Real:
    """The part of row i along its direction."""
    begin = w.lows[i] if w.begins[i] < w.lows[i] else w.begins[i]
    stop = w.highs[i] if w.highs[i] < w.stops[i] else w.stops[i]
    return inner(w.matrix[i], w.rests[i], begin, stop) if begin < stop else 0.0


def choose_row(w: StartWork, i: int, near: int, m: int, lost: Real) -> bool:
    """Make the rest of row i of m a direction, orthogonal to all others near it; whether it is one."""
    keep_rest(w, i, -1.0, m)
    shorten(w, i)
    for k in range(near):
        if w.chosen[w.near[k]] == 1:
            clear_again(w, i, w.near[k])
    if not shorten(w, i):
        return False
    if lost == 0.0:
        trim(w, i)
    return along_direction(w, i) != 0.0  # else the rest was rounding, across the row


def step_along(w: StartWork, i: int) -> None:
    """Add to w.step what row i misses, along its direction."""
    direction = w.rests[i]
    above = w.right[i] - inner(w.matrix[i], w.step, w.begins[i], w.stops[i])
    factor = above / along_direction(w, i)
    begin = w.lows[i]
    stop = w.highs[i]
    for j in range(begin, stop):
        w.step[j] += factor * direction[j]


def least_norm(w: StartWork, m: int, n: int, dependent: Real, lost: Real) -> bool:
    """w.step[n], the shortest solution of the m rows of w.matrix (which are lost), each of them from w.begins
    to w.stops, with the right-hand sides w.right; False where a number is not finite.  Rows that depend on
    the ones before (to `dependent` of their length) are left out, the longest remaining row first: a modified
    Gram-Schmidt factorisation, each row orthogonalised twice.  Entry by entry what is no more than `lost` of
    what it is the rest of is taken for rounding."""
    for j in range(n):
        w.step[j] = 0.0
    given = unit_rows(w, m, lost)
    if given < 0:
        return False
    sort_rows(w, m, n)
    pair_up(w, m)
    chosen = 0
    while True:
        best = w.longest[1]
        if not w.squares[best] > dependent * dependent:
            w.left_out = given - chosen
            return True
        near = find_near(w, best, m)
        if not choose_row(w, best, near, m, lost):
            continue
        w.chosen[best] = 1
        chosen += 1
        step_along(w, best)
        for k in range(near):
            i = w.near[k]
            if w.squares[i] >= 0.0:
                if lost > 0.0:
                    keep_rest(w, i, clear_exactly(w, i, best, lost), m)
                elif clear(w, i, best):
                    keep_rest(w, i, inner(w.rests[i], w.rests[i], w.lows[i], w.highs[i]), m)
