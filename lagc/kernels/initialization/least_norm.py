"""The least-norm solution of a sparse linear system, by a rank-revealing orthogonalisation."""

from math import fabs, inf, sqrt
from typing import Any

from lagc.kernels.initialization.workspace import StartWork
from lagc.kernels.language.vocabulary import *


def sort_rows(w: StartWork, m: int, n: int) -> None:
    """Set w.by_first: rows sorted by first column; and w.reach_so_far: the largest end column up to each."""
    for j in range(n + 1):
        w.first_counts[j] = 0
    for i in range(m):
        w.first_counts[w.first_column[i]] += 1
    before = 0
    for j in range(n + 1):
        here = w.first_counts[j]
        w.first_counts[j] = before
        before += here
    for i in range(m):
        place = w.first_counts[w.first_column[i]]
        w.first_counts[w.first_column[i]] = place + 1
        w.by_first[place] = i
    reach = 0
    for k in range(m):
        if w.end_column[w.by_first[k]] > reach:
            reach = w.end_column[w.by_first[k]]
        w.reach_so_far[k] = reach


def find_near(w: StartWork, i: int, m: int) -> int:
    """Set w.neighbours: the rows that overlap the remainder of row i; return their number."""
    low = 0
    high = m
    while low < high:
        middle = (low + high) // 2
        if w.reach_so_far[middle] > w.first_nonzero[i]:
            high = middle
        else:
            low = middle + 1
    count = 0
    for k in range(low, m):
        r = w.by_first[k]
        if w.first_column[r] >= w.end_nonzero[i]:
            break
        if w.end_column[r] > w.first_nonzero[i]:
            w.neighbours[count] = r
            count += 1
    return count


def longer_row(w: StartWork, a: int, b: int) -> int:
    """The one of two rows with the longer remainder, the first of equals."""
    if w.remaining[a] == w.remaining[b]:
        return a if a < b else b
    return a if w.remaining[a] > w.remaining[b] else b


def build_tournament(w: StartWork, m: int) -> None:
    """Set w.tournament: a binary tree; w.tournament[1] is the row with the longest remainder."""
    for i in range(m):
        w.tournament[m + i] = i
    for k in range(m - 1, 0, -1):
        w.tournament[k] = longer_row(w, w.tournament[2 * k], w.tournament[2 * k + 1])


def set_remaining(w: StartWork, i: int, square: Real, m: int) -> None:
    """Set the squared remainder of row i, -1 if it takes part no more."""
    w.remaining[i] = square
    k = (m + i) // 2
    while k > 0:
        w.tournament[k] = longer_row(w, w.tournament[2 * k], w.tournament[2 * k + 1])
        k = k // 2


def inner(a: Vec[Any], b: Vec[Any], begin: int, stop: int) -> Real:
    """The inner product of a[begin:stop] and b[begin:stop]."""
    total = 0.0
    for j in range(begin, stop):
        total += a[j] * b[j]
    return total


def extend_row(w: StartWork, i: int, along: int) -> None:
    """Extend the nonzero range of row i of w.orthogonal by that of another row."""
    rest = w.orthogonal[i]
    low = w.first_nonzero[i]
    high = w.end_nonzero[i]
    lowest = w.first_nonzero[along]
    highest = w.end_nonzero[along]
    if lowest < low:
        for j in range(lowest, low):
            rest[j] = 0.0
        w.first_nonzero[i] = lowest
    if highest > high:
        for j in range(high, highest):
            rest[j] = 0.0
        w.end_nonzero[i] = highest


def projection(w: StartWork, i: int, along: int) -> Real:
    """The inner product of two rows of w.orthogonal, on their common range."""
    begin = w.first_nonzero[along] if w.first_nonzero[i] < w.first_nonzero[along] else w.first_nonzero[i]
    stop = w.end_nonzero[along] if w.end_nonzero[along] < w.end_nonzero[i] else w.end_nonzero[i]
    return inner(w.orthogonal[i], w.orthogonal[along], begin, stop) if begin < stop else 0.0


def orthogonalize(w: StartWork, i: int, along: int) -> bool:
    """Subtract from row i of w.orthogonal its projection on a unit row; return whether there is one."""
    part = projection(w, i, along)
    if part == 0.0:
        return False
    extend_row(w, i, along)
    values = w.orthogonal[i]
    direction = w.orthogonal[along]
    for j in range(w.first_nonzero[along], w.end_nonzero[along]):
        values[j] -= part * direction[j]
    return True


def orthogonalize_again(w: StartWork, i: int, along: int) -> None:
    """Subtract the projection that round-off left, within the range of row i."""
    part = projection(w, i, along)
    values = w.orthogonal[i]
    direction = w.orthogonal[along]
    begin = w.first_nonzero[along] if w.first_nonzero[i] < w.first_nonzero[along] else w.first_nonzero[i]
    stop = w.end_nonzero[along] if w.end_nonzero[along] < w.end_nonzero[i] else w.end_nonzero[i]
    for j in range(begin, stop):
        values[j] -= part * direction[j]


def orthogonalize_exactly(w: StartWork, i: int, along: int, lost: Real) -> Real:
    """Subtract the projection; entries that are at most `lost` of their terms become 0; return the largest
    that remains."""
    part = projection(w, i, along)
    if part != 0.0:
        extend_row(w, i, along)
    values = w.orthogonal[i]
    given = w.matrix[i]
    direction = w.orthogonal[along]
    largest = 0.0
    for j in range(w.first_nonzero[i], w.end_nonzero[i]):
        taken = part * direction[j] if w.first_nonzero[along] <= j and j < w.end_nonzero[along] else 0.0
        left = fabs(values[j] - taken)
        own = fabs(given[j]) if w.first_column[i] <= j and j < w.end_column[i] else 0.0
        if left <= lost * own or left <= lost * fabs(taken):
            left = 0.0
            values[j] = 0.0
        else:
            values[j] -= taken
        if left > largest:
            largest = left
    return largest


def normalize_row(w: StartWork, i: int) -> bool:
    """Make row i of w.orthogonal a unit vector; return whether it is nonzero."""
    values = w.orthogonal[i]
    begin = w.first_nonzero[i]
    stop = w.end_nonzero[i]
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
    """Normalise the nonzero rows of w.matrix and copy them to w.orthogonal; return their number, -1 where a
    number is not finite."""
    given = 0
    for i in range(m):
        row = w.matrix[i]
        rest = w.orthogonal[i]
        begin = w.first_column[i]
        stop = w.end_column[i]
        largest = 0.0
        for j in range(begin, stop):
            if not fabs(row[j]) <= largest:
                largest = fabs(row[j])
        if not (largest < inf and fabs(w.right[i]) < inf):
            return -1
        w.chosen[i] = 0
        w.remaining[i] = -1.0
        if largest == 0.0:
            continue
        for j in range(begin, stop):
            row[j] = row[j] / largest
        length = sqrt(inner(row, row, begin, stop))
        for j in range(begin, stop):
            row[j] = row[j] / length
            rest[j] = row[j]
        w.first_nonzero[i] = begin
        w.end_nonzero[i] = stop
        w.remaining[i] = 1.0 if lost > 0.0 else inner(rest, rest, begin, stop)
        w.right[i] = w.right[i] / largest / length
        given += 1
    return given


def trim_row(w: StartWork, i: int) -> None:
    """Cut entries below round-off from both ends of row i of w.orthogonal."""
    values = w.orthogonal[i]
    while fabs(values[w.first_nonzero[i]]) <= FADED:
        w.first_nonzero[i] += 1
    while fabs(values[w.end_nonzero[i] - 1]) <= FADED:
        w.end_nonzero[i] -= 1


def along_direction(w: StartWork, i: int) -> Real:
    """The projection of row i of w.matrix on its row of w.orthogonal."""
    begin = w.first_nonzero[i] if w.first_column[i] < w.first_nonzero[i] else w.first_column[i]
    stop = w.end_nonzero[i] if w.end_nonzero[i] < w.end_column[i] else w.end_column[i]
    return inner(w.matrix[i], w.orthogonal[i], begin, stop) if begin < stop else 0.0


def choose_row(w: StartWork, i: int, near: int, m: int, lost: Real) -> bool:
    """Make row i of w.orthogonal a unit vector orthogonal to the chosen rows; return whether it is one."""
    set_remaining(w, i, -1.0, m)
    normalize_row(w, i)
    for k in range(near):
        if w.chosen[w.neighbours[k]] == 1:
            orthogonalize_again(w, i, w.neighbours[k])
    if not normalize_row(w, i):
        return False
    if lost == 0.0:
        trim_row(w, i)
    return along_direction(w, i) != 0.0  # else the rest was rounding, across the row


def step_along(w: StartWork, i: int) -> None:
    """Add a multiple of row i of w.orthogonal to w.step, so that equation i is met."""
    direction = w.orthogonal[i]
    above = w.right[i] - inner(w.matrix[i], w.step, w.first_column[i], w.end_column[i])
    factor = above / along_direction(w, i)
    for j in range(w.first_nonzero[i], w.end_nonzero[i]):
        w.step[j] += factor * direction[j]


def least_norm(w: StartWork, m: int, n: int, dependent: Real, lost: Real) -> bool:
    """Set w.step[n] to the least-norm solution of the m rows of w.matrix and w.right; False where a number
    is not finite. The matrix is overwritten.

    Rank-revealing orthogonalisation by modified Gram-Schmidt with row pivoting, each row twice (A. Bjorck,
    *Numerical Methods for Least Squares Problems*, 1996, section 2.4): the row with the longest remainder
    comes next; rows with a remainder below `dependent` of their length are dropped. With `lost`, entries
    that are at most `lost` of their terms count as round-off."""
    for j in range(n):
        w.step[j] = 0.0
    given = unit_rows(w, m, lost)
    if given < 0:
        return False
    sort_rows(w, m, n)
    build_tournament(w, m)
    chosen = 0
    while True:
        best = w.tournament[1]
        if not w.remaining[best] > dependent * dependent:
            w.dropped_rows = given - chosen
            return True
        near = find_near(w, best, m)
        if not choose_row(w, best, near, m, lost):
            continue
        w.chosen[best] = 1
        chosen += 1
        step_along(w, best)
        for k in range(near):
            i = w.neighbours[k]
            if w.remaining[i] >= 0.0:
                if lost > 0.0:
                    set_remaining(w, i, orthogonalize_exactly(w, i, best, lost), m)
                elif orthogonalize(w, i, best):
                    set_remaining(
                        w, i, inner(w.orthogonal[i], w.orthogonal[i], w.first_nonzero[i], w.end_nonzero[i]), m
                    )
