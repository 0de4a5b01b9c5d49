"""The shortest solution of a linear system."""

from __future__ import annotations

from math import fabs, inf, sqrt
from typing import Any

from lagc.kernels.startrecords import StartWork
from lagc.kernels.words import Real, Vec


def inner(a: Vec[Any], b: Vec[Any], n: int) -> Real:
    total = 0.0
    for j in range(n):
        total += a[j] * b[j]
    return total


def clear(values: Vec[Any], direction: Vec[Any], n: int) -> bool:
    """Take from a vector its part along a unit vector; whether it has one."""
    part = inner(values, direction, n)
    if part == 0.0:
        return False
    for j in range(n):
        values[j] -= part * direction[j]
    return True


def clear_exactly(values: Vec[Any], given: Vec[Any], direction: Vec[Any], n: int, lost: Real) -> Real:
    """The same, where what is no more than `lost` of what it is the rest of is rounding and becomes 0; the
    largest that is left."""
    part = inner(values, direction, n)
    largest = 0.0
    for j in range(n):
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


def shorten(values: Vec[Any], n: int) -> bool:
    """Make a vector a unit vector; whether it has a direction."""
    largest = 0.0
    for j in range(n):
        if fabs(values[j]) > largest:
            largest = fabs(values[j])
    if largest == 0.0:
        return False
    for j in range(n):
        values[j] = values[j] / largest
    length = sqrt(inner(values, values, n))
    for j in range(n):
        values[j] = values[j] / length
    return True


def unit_rows(w: StartWork, m: int, n: int) -> int:
    """The m rows of w.matrix, which are not zero, as unit vectors there and in w.rests; how many they are,
    -1 where a number is not finite."""
    given = 0
    for i in range(m):
        row = w.matrix[i]
        largest = 0.0
        for j in range(n):
            if not fabs(row[j]) <= largest:
                largest = fabs(row[j])
        if not (largest < inf and fabs(w.right[i]) < inf):
            return -1
        if largest == 0.0:
            continue
        scaled = w.matrix[given]
        for j in range(n):
            scaled[j] = row[j] / largest
        length = sqrt(inner(scaled, scaled, n))
        for j in range(n):
            scaled[j] = scaled[j] / length
        rest = w.rests[given]
        for j in range(n):
            rest[j] = scaled[j]
        w.squares[given] = inner(rest, rest, n)
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
    Gram-Schmidt factorisation, each row orthogonalised twice.  Entry by entry what is no more than `lost` of
    what it is the rest of is taken for rounding."""
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
        shorten(direction, n)
        for k in range(chosen):
            clear(direction, w.rests[w.turns[k]], n)
        if not shorten(direction, n):
            continue
        along = inner(w.matrix[best], direction, n)
        if along == 0.0:  # the rest was rounding, across the row
            continue
        w.turns[chosen] = best
        chosen += 1
        above = w.right[best] - inner(w.matrix[best], w.step, n)
        factor = above / along
        for j in range(n):
            w.step[j] += factor * direction[j]
        for i in range(given):
            if w.chosen[i] == 0:
                if lost > 0.0:
                    w.squares[i] = clear_exactly(w.rests[i], w.matrix[i], direction, n, lost)
                elif clear(w.rests[i], direction, n):
                    w.squares[i] = inner(w.rests[i], w.rests[i], n)
