"""The choice of the stated values that move, by trying."""

from __future__ import annotations

from math import inf

from lagc.kernels.initialization.gauss_newton import leads, strayed
from lagc.kernels.initialization.multistart import BESIDE, NEAR, SPREADS, find, lacking
from lagc.kernels.initialization.relaxation import (
    WIDE,
    following,
    let_all,
    let_one,
    moved,
    predicted,
    squared_move,
    tries,
)
from lagc.kernels.initialization.workspace import StartWork
from lagc.kernels.language.sizes import NU
from lagc.kernels.language.tolerances import UNMOVED
from lagc.kernels.language.words import Params, Real, Vec

MOST_WORK = 200  # factorisations of a search that no prediction helps


def let_picked(count: int, loose: int, w: StartWork) -> None:
    """Let those of w.values that the first of w.picked count move, or hold them."""
    for k in range(count):
        let_one(w.values[w.picked[k]], loose, w)


def fewest(p: Params, t: Real, n: int, count: int, limit: int, w: StartWork) -> bool:
    """Let `count` of the n values in w.values move, those that have to move least; whether there are any."""
    least = inf
    w.held[:] = w.y
    for k in range(count):
        w.picked[k] = k
    while w.work <= limit:
        let_picked(count, 1, w)
        if tries(p, t, w):
            moved(n, w)
            if w.total < least:
                least = w.total
                for k in range(count):
                    w.best_picked[k] = w.values[w.picked[k]]
                w.held[:] = w.y
        let_picked(count, 0, w)
        if not following(count, n, w):
            break
    if least < inf:
        let_all(w.best_picked, count, 1, w)
    w.y[:] = w.held
    return least < inf


def sort_moves(n: int, w: StartWork) -> None:
    """The n values in w.values by how far they moved, the order of equals kept."""
    for k in range(n):
        move = w.moves[k]
        value = w.values[k]
        i = k
        while i > 0 and w.moves[i - 1] > move:
            w.moves[i] = w.moves[i - 1]
            w.values[i] = w.values[i - 1]
            i -= 1
        w.moves[i] = move
        w.values[i] = value


def search(p: Params, t: Real, n: int, w: StartWork) -> None:
    """By trying sets, the smallest first, and then to hold one value after the other; what has not been
    tried when the work is done moves."""
    limit = w.work + MOST_WORK
    count = 0 if w.rank > 0 else 1  # none was tried already
    while count <= n and w.work <= limit:
        if fewest(p, t, n, count, limit, w):
            return
        count += 1
    sort_moves(n, w)
    for k in range(n):
        if w.moves[k] > 0.0:
            let_one(w.values[k], 1, w)
    limit = w.work + MOST_WORK
    for k in range(n):
        if w.moves[k] > 0.0 and w.work <= limit:
            let_one(w.values[k], 0, w)
            if not tries(p, t, w):
                let_one(w.values[k], 1, w)
    if not find(p, t, 0, SPREADS, w):
        let_all(w.values, n, 1, w)
        w.y[:] = w.kept


def returned(p: Params, t: Real, start: Vec[NU], n: int, w: StartWork) -> bool:
    """Whether the n values w.picked, now held, need not have moved to a start: rows that follow from others
    where all hold, and not elsewhere, may have moved them."""
    if lacking(p, t, start, w):
        return False
    w.now[:] = start
    for k in range(n):
        i = w.picked[k]
        w.now[i] = w.home[i]
        i += 1
        while i < NU and w.part[i] == 1:
            w.now[i] = w.home[i]
            i += 1
    if not leads(p, t, w.now, w):
        return False
    w.y[:] = w.now
    return True


def unmoved(p: Params, t: Real, n: int, w: StartWork) -> bool:
    """Whether there is a start where none of the n values w.values that were released moves: looked for from
    beside the guess where one went far, else from where they led to."""
    most = 0.0
    for k in range(n):
        w.picked[k] = w.values[k]
        if w.moves[k] > most:
            most = w.moves[k]
    if most <= WIDE * WIDE:
        return returned(p, t, w.kept, n, w)
    if not find(p, t, BESIDE + 1, SPREADS, w):
        return False
    w.other = w.first
    return True


def pick_little(n: int, most: Real, w: StartWork) -> int:
    """In w.picked those of the n values w.values that are free and moved by no more than `most`, squared; how
    many these are."""
    little = 0
    for k in range(n):
        if w.loose[w.values[k]] == 1 and squared_move(w.values[k], w) <= most:
            w.picked[little] = w.values[k]
            little += 1
    return little


def hold_little(p: Params, t: Real, n: int, w: StartWork) -> None:
    """Hold those of the n values w.values that hardly moved, or did not, if there is a start without."""
    w.held[:] = w.y
    for turn in range(2):
        little = pick_little(n, WIDE * WIDE if turn == 0 else UNMOVED, w)
        if little == 0:
            continue
        let_all(w.picked, little, 0, w)
        if returned(p, t, w.held, little, w) or (turn == 1 and tries(p, t, w)):
            break
        let_all(w.picked, little, 1, w)
        w.y[:] = w.held


def choose(p: Params, t: Real, level: int, w: StartWork) -> None:
    """Of the values of a level, which all move in the start w.y, let as few move as possible, and as little:
    those that linear prediction names, else by trying."""
    n = 0
    owned = w.owned
    for k in range(owned):
        i = w.own[k]
        if w.levels[i] == level and w.part[i] == 0:
            w.moves[n] = squared_move(i, w)
            w.values[n] = i
            n += 1
    w.kept[:] = w.y
    let_all(w.values, n, 0, w)
    if not unmoved(p, t, n, w):
        m = 0
        for k in range(owned):
            i = w.own[k]
            if w.levels[i] == level:
                w.stated[m] = i
                m += 1
        if not predicted(p, t, n, m, w):
            search(p, t, n, w)
        hold_little(p, t, n, w)
    if not strayed(w.y, w) <= NEAR:
        find(p, t, 0, SPREADS, w)
