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
    chosen: list[int] = []
    solution = [0.0] * n
    for _ in range(len(given)):
        best, longest = -1, dependent * dependent
        for i in range(len(given)):
            if i not in chosen:
                square = inner(rests[i], rests[i])
                if square > longest:
                    best, longest = i, square
        if best < 0:
            break
        direction = rests[best]
        _shorten(direction)
        for k in chosen:
            remove(direction, rests[k])
        _shorten(direction)
        chosen.append(best)
        factor = (values[best] - inner(given[best], solution)) / inner(given[best], direction)
        for j in range(n):
            solution[j] += factor * direction[j]
        for i in range(len(given)):
            if i not in chosen:
                remove(rests[i], direction)
    return solution


def inner(a: list[float], b: list[float]) -> float:
    total = 0.0
    for x, y in zip(a, b):
        total += x * y
    return total


def remove(vector: list[float], direction: list[float]) -> None:
    """Take from `vector` its part along a unit vector."""
    part = inner(vector, direction)
    if part != 0.0:
        for j, d in enumerate(direction):
            vector[j] -= part * d


def _shorten(vector: list[float]) -> None:
    length = sqrt(inner(vector, vector))
    for j in range(len(vector)):
        vector[j] = vector[j] / length
