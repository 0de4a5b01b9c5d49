"""The search for consistent initial conditions from the guess and from points beside it."""

from math import fabs, inf

from lagc.kernels.arithmetic.quaternions import normalise
from lagc.kernels.initialization.gauss_newton import attempt, pull_to_guess, remove_turns, unstated_distance
from lagc.kernels.initialization.residuals import (
    evaluate_rows,
    largest_residual,
    relative_residual,
    row_begin,
    scale_rows,
    set_scales,
)
from lagc.kernels.initialization.scaling import estimate_slope_roundoff
from lagc.kernels.initialization.workspace import UNSTATED, StartWork
from lagc.kernels.language.vocabulary import *

SPREADS = 8  # beginnings
SIDES = 7  # unknowns whose sides of the guess are not pseudo-random
BESIDE = 2  # the beginning that leaves a singular guess well behind
NEAR = 8.0  # scaled distance from the guess: a start within it ends the search
SURE = 1e3  # a derivative this many times its round-off is significant
ALIKE = 1.01  # ratio of residuals: attempts that end with such ended at the same point
MEANINGLESS = 0.5  # a relative residual this large gives no information


def spread_of(k: int) -> Real:
    """How far beginning k is from the guess, in sizes."""
    if k < 2:
        return 0.0 if k == 0 else 0.01
    if k < 4:
        return 0.1 if k == 2 else 0.5
    return 1.0 if k < 6 else 2.0


def side_of(k: int, n: int) -> Real:
    """The side of the guess, -1 or 1, of unknown n in beginning k: the first SIDES unknowns take all pairs of
    sides (a Hadamard matrix, its rows in Gray order)."""
    odd = 0
    bit = 1
    while bit <= SIDES:
        odd += (k // bit + k // (2 * bit)) * ((n + 1) // bit)
        bit *= 2
    return -1.0 if odd % 2 == 1 else 1.0


def perturb_guess(y: Vec[NU], k: int, w: StartWork) -> None:
    """Set y to beginning k: the guess, with free unknowns moved pseudo-randomly by up to a share of their
    size, since a guess may be singular."""
    y[:] = w.guess
    if k == 0:
        return
    # the congruential generator of rand() in the C standard, of 31 bits
    state: Length = 12345 + k
    for n in range(w.unknown_count):
        i = w.unknowns[n]
        state = (1103515245 * state + 12345) & 2147483647
        if w.free[i] == 1:
            offset = float(state) / 1073741824.0 - 1.0
            if n < SIDES:
                offset = side_of(k, n) * fabs(offset)
            y[i] += spread_of(k) * w.unit_scaling[i] * offset
    if NQUAT > 0:
        normalise(y)


def is_unsolvable(p: Params, t: Real, w: StartWork) -> bool:
    """Whether an equation without free unknowns is not met."""
    evaluate_rows(p, t, w.guess, w.c, w.J, w.term_sizes, w)
    scale_rows(w.guess, w.J, w.term_sizes, w)
    for r in range(w.row_count):
        i = w.rows[r]
        held = True
        for k in range(row_begin(i), ends[i]):
            if w.free[w.column[k]] == 1:
                held = False
        if held and not relative_residual(w.c[i], w.roundoff[i], w.row_scaling[i]) <= ACCEPTED:
            return True
    return False


def attempt_from(p: Params, t: Real, k: int, even: bool, w: StartWork) -> bool:
    """Attempt from beginning k, with scaling by unknown or by unit; return whether it reaches a start.
    w.best becomes the nearest start, or the point with the least residual."""
    perturb_guess(w.begin, k, w)
    set_scales(even, w)
    attempt(p, t, w.begin, w)
    set_scales(False, w)
    size = largest_residual(p, t, w.begin, w.row_count, w)
    if size <= ACCEPTED:
        remove_turns(p, t, w.begin, w)
        if k > 0 or even:
            pull_to_guess(p, t, w.begin, w)
        far = unstated_distance(w.begin, w)
        if far < w.nearest:
            w.best[:] = w.begin
            w.least_residual = 0.0
            w.nearest = far
        return True
    if size < w.least_residual:
        w.best[:] = w.begin
        w.least_residual = size
    if size > w.most_residual:
        w.most_residual = size
    return False


def is_significant(j: int, w: StartWork) -> bool:
    """Whether a derivative by unknown j is far above round-off."""
    for r in range(w.row_count):
        i = w.rows[r]
        for k in range(row_begin(i), ends[i]):
            if w.column[k] == j and fabs(w.J[k]) > SURE * w.entry_roundoff[k]:
                return True
    return False


def relies_on_roundoff(p: Params, t: Real, w: StartWork) -> bool:
    """Whether w.y is very far from the guess and meets equations by derivatives that are round-off."""
    if w.nearest < FARTHEST:
        return False
    evaluate_rows(p, t, w.y, w.c, w.J, w.term_sizes, w)
    estimate_slope_roundoff(p, t, w.y, w.scaling, w)
    found = False
    for k in range(w.unknown_count):
        j = w.unknowns[k]
        if fabs(w.y[j] - w.guess[j]) > FARTHEST * w.scaling[j]:
            found = found or not is_significant(j, w)
    w.entry_roundoff[:] = w.slope_roundoff
    return found


def multistart(p: Params, t: Real, begin: int, end: int, w: StartWork) -> bool:
    """Search from beginnings begin..end-1; w.y becomes the first start near the guess, else the nearest;
    return whether there is one."""
    w.y[:] = w.guess
    if is_unsolvable(p, t, w):
        return False
    w.best[:] = w.guess
    w.least_residual = inf
    w.most_residual = 0.0
    w.nearest = inf
    some = False
    stated = False
    for n in range(w.unknown_count):
        i = w.unknowns[n]
        some = some or w.free[i] == 1
        stated = stated or (w.free[i] == 1 and w.levels[i] > UNSTATED)
    for k in range(begin, end):
        if not attempt_from(p, t, k, False, w) and stated:
            attempt_from(p, t, k, True, w)
        if w.nearest <= NEAR or not some:
            break
        if (
            k == BESIDE
            and k + 1 < end
            and w.nearest == inf
            and w.most_residual <= ALIKE * w.least_residual
            and w.least_residual < MEANINGLESS
        ):
            break
    w.y[:] = w.best
    return w.nearest < inf and not relies_on_roundoff(p, t, w)
