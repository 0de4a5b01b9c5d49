"""The shortest solution of a linear system."""

from __future__ import annotations

from math import fabs, inf, sqrt
from typing import Any

from lagc.kernels.startrecords import StartWork
from lagc.kernels.words import Real, Vec


def inner(a: Vec[Any], b: Vec[Any], begin: int, stop: int) -> Real:
    total = 0.0
    for j in range(begin, stop):
        total += a[j] * b[j]
    return total


def widen(w: StartWork, i: int, along: int) -> None:
    """Row i of w.rests reaches as far as another, too."""
    if w.begins[along] < w.begins[i]:
        w.begins[i] = w.begins[along]
    if w.stops[along] > w.stops[i]:
        w.stops[i] = w.stops[along]


def part_along(w: StartWork, i: int, along: int) -> Real:
    """The inner product of two rows of w.rests, where both are: no more than sparse rows ask for."""
    begin = w.begins[along] if w.begins[i] < w.begins[along] else w.begins[i]
    stop = w.stops[along] if w.stops[along] < w.stops[i] else w.stops[i]
    return inner(w.rests[i], w.rests[along], begin, stop) if begin < stop else 0.0


def clear(w: StartWork, i: int, along: int) -> bool:
    """Take from row i of w.rests its part along a unit vector, another row; whether it has one."""
    values = w.rests[i]
    direction = w.rests[along]
    begin = w.begins[along]
    stop = w.stops[along]
    part = part_along(w, i, along)
    if part == 0.0:
        return False
    for j in range(begin, stop):
        values[j] -= part * direction[j]
    widen(w, i, along)
    return True


def clear_exactly(w: StartWork, i: int, along: int, lost: Real) -> Real:
    """The same, where what is no more than `lost` of what it is the rest of is rounding and becomes 0; the
    largest that is left."""
    values = w.rests[i]
    given = w.matrix[i]
    direction = w.rests[along]
    part = part_along(w, i, along)
    if part != 0.0:
        widen(w, i, along)
    largest = 0.0
    begin = w.begins[i]
    stop = w.stops[i]
    for j in range(begin, stop):
        taken = part * direction[j]
        left = fabs(values[j] - taken)
        if left <= lost * fabs(given[j]) or left <= lost * fabs(taken):
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
    begin = w.begins[i]
    stop = w.stops[i]
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


def unit_rows(w: StartWork, m: int, n: int) -> int:
    """The m rows of w.matrix, which are not zero, as unit vectors there and in w.rests; how many they are,
    -1 where a number is not finite."""
    given = 0
    for i in range(m):
        row = w.matrix[i]
        begin = n
        stop = 0
        largest = 0.0
        for j in range(n):
            if row[j] != 0.0:
                stop = j + 1
                if begin == n:
                    begin = j
            if not fabs(row[j]) <= largest:
                largest = fabs(row[j])
        if not (largest < inf and fabs(w.right[i]) < inf):
            return -1
        if largest == 0.0:
            continue
        scaled = w.matrix[given]
        rest = w.rests[given]
        for j in range(n):
            scaled[j] = row[j]
            rest[j] = 0.0
        for j in range(begin, stop):
            scaled[j] = scaled[j] / largest
        length = sqrt(inner(scaled, scaled, begin, stop))
        for j in range(begin, stop):
            scaled[j] = scaled[j] / length
            rest[j] = scaled[j]
        w.begins[given] = begin
        w.stops[given] = stop
        w.squares[given] = inner(rest, rest, begin, stop)
        w.right[given] = w.right[i] / largest / length
        w.chosen[given] = 0
        given += 1
    return given


def longest_rest(w: StartWork, given: int, least: Real) -> int:
    """The row of which most is left, by the square of its length, that is not chosen; -1 where none is above
    `least`."""
    best = -1
    longest = least
    for i in range(given):
        if w.chosen[i] == 0 and w.squares[i] > longest:
            best = i
            longest = w.squares[i]
    return best


def least_norm(w: StartWork, m: int, n: int, dependent: Real, lost: Real) -> bool:
    """w.step[n], the shortest solution of the m rows of w.matrix (which are lost) with the right-hand
    sides w.right; False where a number is not finite.  Rows that depend on the ones before (to
    `dependent` of their length) are left out, the longest remaining row first: a modified
    Gram-Schmidt factorisation, each row orthogonalised twice, from its first entry to its last.  Entry
    by entry what is no more than `lost` of what it is the rest of is taken for rounding."""
    for j in range(n):
        w.step[j] = 0.0
    given = unit_rows(w, m, n)
    if given < 0:
        return False
    chosen = 0
    while True:
        best = longest_rest(w, given, dependent * dependent)
        if best < 0:
            w.left_out = given - chosen
            return True
        w.chosen[best] = 1
        direction = w.rests[best]
        shorten(w, best)
        for k in range(chosen):
            clear(w, best, w.turns[k])
        if not shorten(w, best):
            continue
        begin = w.begins[best]
        stop = w.stops[best]
        along = inner(w.matrix[best], direction, begin, stop)
        if along == 0.0:  # the rest was rounding, across the row
            continue
        w.turns[chosen] = best
        chosen += 1
        above = w.right[best] - inner(w.matrix[best], w.step, begin, stop)
        factor = above / along
        for j in range(begin, stop):
            w.step[j] += factor * direction[j]
        for i in range(given):
            if w.chosen[i] == 0:
                if lost > 0.0:
                    w.squares[i] = clear_exactly(w, i, best, lost)
                elif clear(w, i, best):
                    w.squares[i] = inner(w.rests[i], w.rests[i], w.begins[i], w.stops[i])
