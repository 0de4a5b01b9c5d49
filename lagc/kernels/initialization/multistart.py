"""The search for a start: from the guess and beside it."""

from __future__ import annotations

from math import fabs, inf

from lagc.kernels.arithmetic.quaternions import normalise
from lagc.kernels.initialization.gauss_newton import approach, attempt, strayed, unwind
from lagc.kernels.initialization.residuals import farthest, judge, meet, ratio, row_begin, set_scales
from lagc.kernels.initialization.scaling import blur
from lagc.kernels.initialization.workspace import UNSTATED, StartWork
from lagc.kernels.language.sizes import NQUAT, NU
from lagc.kernels.language.tables import ends
from lagc.kernels.language.tolerances import ACCEPTED, FARTHEST
from lagc.kernels.language.words import Length, Params, Real, Vec

SPREADS = 8
SIDES = 7  # unknowns whose sides are not left to chance
BESIDE = 2  # the spread that leaves a singular guess well behind
NEAR = 8.0  # weights from the guess: one farther off is taken if none is nearer
SURE = 1e3  # times what last places change a derivative by
ALIKE = 1.01  # what attempts from near the guess miss: they ended at the same place
MEANINGLESS = 0.5  # of its own terms: what misses so much does so anywhere


def spread_of(k: int) -> Real:
    """How far from the guess attempt k begins, in widths."""
    if k < 2:
        return 0.0 if k == 0 else 0.01
    if k < 4:
        return 0.1 if k == 2 else 0.5
    return 1.0 if k < 6 else 2.0


def side_of(k: int, n: int) -> Real:
    """To which side of the guess, -1 or 1, beginning k puts unknown n of the first SIDES of a part: any two
    of them all four ways, and the first two at first to two sides, then to one (a matrix of J. Hadamard,
    1893, its rows in the order of F. Gray, 1953)."""
    odd = 0
    bit = 1
    while bit <= SIDES:
        odd += (k // bit + k // (2 * bit)) * ((n + 1) // bit)
        bit *= 2
    return -1.0 if odd % 2 == 1 else 1.0


def spread(y: Vec[NU], k: int, w: StartWork) -> None:
    """Beginning k: the guess, with what is free moved by up to a share of its width, for a guess may be
    singular."""
    y[:] = w.home
    if k == 0:
        return
    # the congruential generator of rand() in the C standard, of 31 bits
    state: Length = 12345 + k
    owned = w.owned
    for n in range(owned):
        i = w.own[n]
        state = (1103515245 * state + 12345) & 2147483647
        if w.loose[i] == 1:
            way = float(state) / 1073741824.0 - 1.0
            if n < SIDES:
                way = side_of(k, n) * fabs(way)
            y[i] += spread_of(k) * w.widths[i] * way
    if NQUAT > 0:
        normalise(y)


def hopeless(p: Params, t: Real, w: StartWork) -> bool:
    """Whether a condition is missed that nothing free occurs in."""
    meet(p, t, w.home, w.c, w.J, w.sizes, w)
    judge(w.home, w.J, w.sizes, w)
    rows = w.ended
    for r in range(rows):
        i = w.rows[r]
        held = True
        first = row_begin(i)
        end = ends[i]
        for k in range(first, end):
            if w.loose[w.column[k]] == 1:
                held = False
        if held and not ratio(w.c[i], w.floors[i], w.scales[i]) <= ACCEPTED:
            return True
    return False


def begin_at(p: Params, t: Real, k: int, even: bool, w: StartWork) -> bool:
    """An attempt from beginning k, where stated values hardly move beside others, each by its own size, or
    where all of a unit move alike, `even`: a rope of stated values stays smooth.  Whether it leads to a
    start; w.best is the first that is near, else the nearest."""
    spread(w.now, k, w)
    set_scales(even, w)
    attempt(p, t, w.now, w)
    set_scales(False, w)
    size = farthest(p, t, w.now, w.ended, w)
    if size <= ACCEPTED:
        unwind(p, t, w.now, w)
        if k > 0 or even:
            approach(p, t, w.now, w)
        far = strayed(w.now, w)
        if far < w.nearest:
            w.best[:] = w.now
            w.least = 0.0
            w.nearest = far
        return True
    if size < w.least:
        w.best[:] = w.now
        w.least = size
    if size > w.most:
        w.most = size
    return False


def is_sure(j: int, w: StartWork) -> bool:
    """Whether a derivative by unknown j is far more than rounding."""
    rows = w.ended
    for r in range(rows):
        i = w.rows[r]
        first = row_begin(i)
        end = ends[i]
        for k in range(first, end):
            if w.column[k] == j and fabs(w.J[k]) > SURE * w.blurs[k]:
                return True
    return False


def is_chance(p: Params, t: Real, w: StartWork) -> bool:
    """Whether w.y meets conditions by last places of its positions: by something very far from the guess, by
    which derivatives vanish but for rounding."""
    if w.nearest < FARTHEST:
        return False
    meet(p, t, w.y, w.c, w.J, w.sizes, w)
    blur(p, t, w.y, w.weights, w)
    found = False
    owned = w.owned
    for k in range(owned):
        j = w.own[k]
        if fabs(w.y[j] - w.home[j]) > FARTHEST * w.weights[j]:
            found = found or not is_sure(j, w)
    w.blurs[:] = w.doubted
    return found


def find(p: Params, t: Real, begin: int, end: int, w: StartWork) -> bool:
    """Look for a start from the spreads begin..end-1, what is free moving; w.y is the best found: the first
    that is near, else the nearest."""
    w.y[:] = w.home
    if hopeless(p, t, w):
        return False
    w.best[:] = w.home
    w.least = inf
    w.most = 0.0
    w.nearest = inf
    some = False
    stated = False
    owned = w.owned
    for n in range(owned):
        i = w.own[n]
        some = some or w.loose[i] == 1
        stated = stated or (w.loose[i] == 1 and w.levels[i] > UNSTATED)
    for k in range(begin, end):
        if not begin_at(p, t, k, False, w) and stated:
            begin_at(p, t, k, True, w)
        if w.nearest <= NEAR or not some:
            break
        if (
            k == BESIDE
            and k + 1 < end
            and w.nearest == inf
            and w.most <= ALIKE * w.least
            and w.least < MEANINGLESS
        ):
            break
    w.y[:] = w.best
    return w.nearest < inf and not is_chance(p, t, w)
