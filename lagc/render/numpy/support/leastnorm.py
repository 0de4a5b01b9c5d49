"""The shortest solution of a linear system whose rows may depend on each other."""

from __future__ import annotations

from math import inf, sqrt

# -- what follows is part of generated modules --


def least_norm(rows: list[list[float]], right: list[float], dependent: float) -> list[float]:
    """The shortest y with rows . y = right; empty where a number is not finite.

    Rows that depend on the ones before (to `dependent` of their length) are left out, the longest
    remaining row first: a modified Gram-Schmidt factorisation L Q of the chosen rows, each
    orthogonalised twice.
    """
    n = len(rows[0])
    given, values = [], []
    for row, value in zip(rows, right):
        largest = 0.0
        for a in row:
            if not abs(a) <= largest:
                largest = abs(a)
        if not (largest < inf and abs(value) < inf):
            return []
        if largest == 0.0:
            continue
        scaled = [a / largest for a in row]
        length = sqrt(inner(scaled, scaled))
        given.append([a / length for a in scaled])
        values.append(value / largest / length)
    rests = [row[:] for row in given]
    squares = [inner(row, row) for row in rests]
    left = list(range(len(given)))
    chosen: list[list[float]] = []
    solution = [0.0] * n
    while left:
        best = left[0]
        for i in left:
            if squares[i] > squares[best]:
                best = i
        if not squares[best] > dependent * dependent:
            break
        direction = rests[best]
        _shorten(direction)
        for before in chosen:
            removed(direction, before, _places(before))
        _shorten(direction)
        chosen.append(direction)
        left.remove(best)
        factor = (values[best] - inner(given[best], solution)) / inner(given[best], direction)
        places = _places(direction)
        for j in places:
            solution[j] += factor * direction[j]
        for i in left:
            if removed(rests[i], direction, places):
                squares[i] = inner(rests[i], rests[i])
    return solution


def inner(a: list[float], b: list[float]) -> float:
    total = 0.0
    for x, y in zip(a, b):
        total += x * y
    return total


def removed(vector: list[float], direction: list[float], places: list[int]) -> bool:
    """Take from `vector` its part along a unit vector, which is zero but at `places`; whether it has one."""
    part = 0.0
    for j in places:
        part += vector[j] * direction[j]
    if part != 0.0:
        for j in places:
            vector[j] -= part * direction[j]
    return part != 0.0


def _places(vector: list[float]) -> list[int]:
    return [j for j, a in enumerate(vector) if a != 0.0]


def _shorten(vector: list[float]) -> None:
    length = sqrt(inner(vector, vector))
    for j in range(len(vector)):
        vector[j] = vector[j] / length
