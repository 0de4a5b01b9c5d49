"""The rows of a least-norm problem: which are side by side, and of which most is left."""

from __future__ import annotations

from lagc.kernels.initialization.workspace import StartWork
from lagc.kernels.language.words import Real


def sort_rows(w: StartWork, m: int, n: int) -> None:
    """w.sorted: the m rows by where they begin; w.behind: how far those up to there reach."""
    for j in range(n + 1):
        w.firsts[j] = 0
    for i in range(m):
        w.firsts[w.begins[i]] += 1
    before = 0
    for j in range(n + 1):
        here = w.firsts[j]
        w.firsts[j] = before
        before += here
    for i in range(m):
        place = w.firsts[w.begins[i]]
        w.firsts[w.begins[i]] = place + 1
        w.sorted[place] = i
    reach = 0
    for k in range(m):
        if w.stops[w.sorted[k]] > reach:
            reach = w.stops[w.sorted[k]]
        w.behind[k] = reach


def find_near(w: StartWork, i: int, m: int) -> int:
    """w.near: those of m rows that are where the rest of row i is; how many these are.  All others are
    orthogonal to it, as far as it is to the rows chosen before."""
    low = 0
    high = m
    while low < high:
        middle = (low + high) // 2
        if w.behind[middle] > w.lows[i]:
            high = middle
        else:
            low = middle + 1
    count = 0
    for k in range(low, m):
        r = w.sorted[k]
        if w.begins[r] >= w.highs[i]:
            break
        if w.stops[r] > w.lows[i]:
            w.near[count] = r
            count += 1
    return count


def longer(w: StartWork, a: int, b: int) -> int:
    """Of two rows the one of which more is left, of equals the first."""
    if w.squares[a] == w.squares[b]:
        return a if a < b else b
    return a if w.squares[a] > w.squares[b] else b


def pair_up(w: StartWork, m: int) -> None:
    """w.longest: a tree of pairs of the m rows, each the longer of the two below it; the longest of all is
    w.longest[1]."""
    for i in range(m):
        w.longest[m + i] = i
    for k in range(m - 1, 0, -1):
        w.longest[k] = longer(w, w.longest[2 * k], w.longest[2 * k + 1])


def keep_rest(w: StartWork, i: int, square: Real, m: int) -> None:
    """So much is left of row i of m, by the square of its length; -1: it takes part no more."""
    w.squares[i] = square
    k = (m + i) // 2
    while k > 0:
        w.longest[k] = longer(w, w.longest[2 * k], w.longest[2 * k + 1])
        k = k // 2
