"""The conditions of a start made linear: what they ask of stated values."""

from __future__ import annotations

from math import fabs, inf

from lagc.kernels.initialization.residuals import meet, row_begin
from lagc.kernels.initialization.workspace import StartWork
from lagc.kernels.language.sizes import NE, NROW, NU
from lagc.kernels.language.tables import ends
from lagc.kernels.language.tolerances import NEGLIGIBLE
from lagc.kernels.language.words import Mat, Params, Real, Vec


def pivot(rows: Mat[NE, NROW], m: int, n: int, i: int, k: int) -> None:
    """Solve row i of m for column k of n, and take it from the others."""
    own = rows[i]
    scale = own[k]
    for j in range(n):
        own[j] = own[j] / scale
    for r in range(m):
        row = rows[r]
        part = row[k]
        if r != i and part != 0.0:
            for j in range(n):
                row[j] = row[j] - part * own[j]


def find_largest(i: int, n: int, w: StartWork) -> None:
    """w.squares and w.near of row i of w.rests: its largest entry of n, and where that is."""
    row = w.rests[i]
    largest = 0.0
    for k in range(n):
        if fabs(row[k]) > largest:
            largest = fabs(row[k])
            w.near[i] = k
    w.squares[i] = largest


def solve_rows(m: int, n: int, w: StartWork) -> int:
    """Gauss-Jordan with complete pivoting on the m rows of w.rests, n columns and the right-hand side:
    how many were solved, w.solved, for the columns w.basis."""
    for i in range(m):
        w.chosen[i] = 0
        find_largest(i, n, w)
    count = 0
    while True:
        at = -1
        largest = NEGLIGIBLE
        for i in range(m):
            if w.chosen[i] == 0 and w.squares[i] > largest:
                at = i
                largest = w.squares[i]
        if at < 0:
            return count
        best = w.near[at]
        w.chosen[at] = 1
        for i in range(m):
            w.behind[i] = 1 if w.chosen[i] == 0 and w.rests[i][best] != 0.0 else 0
        pivot(w.rests, m, n + 1, at, best)
        for i in range(m):
            if w.behind[i] == 1:
                find_largest(i, n, w)
        w.solved[count] = at
        w.basis[count] = best
        count += 1


def lay_out(n: int, w: StartWork) -> int:
    """w.places of unknowns in a row of the table: what is free, then the n values w.stated; how many are
    free."""
    first = 0
    owned = w.owned
    for k in range(owned):
        i = w.own[k]
        w.places[i] = -1
        if w.loose[i] == 1:
            w.places[i] = first
            first += 1
    for k in range(n):
        w.places[w.stated[k]] = first + k
    return first


def linear_row(i: int, m: int, width: int, w: StartWork) -> bool:
    """Row m of w.rests: condition i by its derivatives w.J and its residual in w.c, with a largest slope of
    1; whether there is one."""
    row = w.rests[m]
    for j in range(width):
        row[j] = 0.0
    largest = 0.0
    first = row_begin(i)
    end = ends[i]
    for k in range(first, end):
        if w.places[w.column[k]] >= 0:
            value = w.J[k] * w.weights[w.column[k]]
            row[w.places[w.column[k]]] = value
            if not fabs(value) <= largest:
                largest = fabs(value)
    if not (0.0 < largest and largest < inf):
        return False
    row[width - 1] = -w.c[i]
    for j in range(width):
        row[j] = row[j] / largest
    return True


def eliminate(first: int, m: int, width: int, w: StartWork) -> None:
    """Take the first columns from the m rows of w.rests; those that this takes are w.chosen."""
    w.work += 1
    for i in range(m):
        w.chosen[i] = 0
    for k in range(first):
        best = -1
        largest = NEGLIGIBLE
        for r in range(m):
            if w.chosen[r] == 0 and fabs(w.rests[r][k]) > largest:
                best = r
                largest = fabs(w.rests[r][k])
        if best < 0:
            continue
        w.chosen[best] = 1
        own = w.rests[best]
        for r in range(m):
            row = w.rests[r]
            if w.chosen[r] == 0 and row[k] != 0.0:
                part = row[k] / own[k]
                for j in range(k, width):
                    row[j] -= part * own[j]


def table(p: Params, t: Real, at: Vec[NU], beside: Vec[NU], n: int, w: StartWork) -> int:
    """In w.rests the conditions T d = r, linear with the slopes `at` a point, in the moves d (in weights) of
    the n values w.stated from `beside`: what is free eliminated, and Gauss-Jordan on the columns of the
    basis; how many these are."""
    first = lay_out(n, w)
    meet(p, t, beside, w.c, w.J, w.sizes, w)
    meet(p, t, at, w.trial_c, w.J, w.sizes, w)
    m = 0
    end = w.ended
    for r in range(end):
        if linear_row(w.rows[r], m, first + n + 1, w):
            m += 1
    eliminate(first, m, first + n + 1, w)
    w.left = 0
    for r in range(m):
        if w.chosen[r] == 0:
            row = w.rests[r]
            rest = w.rests[w.left]
            for j in range(n + 1):
                rest[j] = row[first + j]
            w.left += 1
    return solve_rows(w.left, n, w)


def find_ways(n: int, k: int, w: StartWork) -> bool:
    """w.ways: the moves of the k picked of n columns alone that satisfy all rows; False where there are
    none."""
    for r in range(k):
        row = w.rests[w.solved[r]]
        own = w.matrix[r]
        for i in range(k):
            own[i] = row[w.picked[i]]
        own[k] = row[n]
    for i in range(k):
        best = -1
        largest = NEGLIGIBLE
        for r in range(i, k):
            if fabs(w.matrix[r][i]) > largest:
                best = r
                largest = fabs(w.matrix[r][i])
        if best < 0:
            return False
        for j in range(k + 1):
            other = w.matrix[i][j]
            w.matrix[i][j] = w.matrix[best][j]
            w.matrix[best][j] = other
        pivot(w.matrix, k, k + 1, i, i)
    for r in range(k):
        w.ways[r] = w.matrix[r][k]
    return True
