"""Scaling of the unknowns, and round-off estimates of the initial equations."""

from math import fabs, inf

from lagc.kernels.initialization.residuals import SLIGHT, evaluate_all, evaluate_rows, is_roundoff, row_begin
from lagc.kernels.initialization.workspace import UNSTATED, StartWork
from lagc.kernels.language.vocabulary import *


def perturb_parameters(p: Params, change: Real, other: Params) -> None:
    """Perturb parameters by four units in the last place, every other one in the opposite direction."""
    other[:] = p
    for k in range(NP):
        other[k] *= 1.0 + change if k % 2 == 0 else 1.0 - change
    if NPREPARED > 0:
        bind(other)


def smaller_change(change: Real, most: Real) -> Real:
    """Return the smaller of two changes, ignoring NaN."""
    if not change < inf:
        return 0.0
    return change if change < most else most


def estimate_roundoff(p: Params, t: Real, w: StartWork) -> None:
    """Estimate the effect of round-off in parameters on residuals and derivatives at the guess: the smaller
    change of two perturbations (Higham 2002, section 1.10)."""
    for i in range(NE):
        w.residual_roundoff[i] = inf if NP > 0 else 0.0
    for k in range(NJ):
        w.slope_roundoff[k] = inf if NP > 0 else 0.0
    if NP > 0:
        other = params()
        for turn in range(2):
            perturb_parameters(p, FOUR_ULPS if turn == 0 else -FOUR_ULPS, other)
            evaluate_all(other, t, w.guess, w.trial_c, w.trial_J, w.trial_term_sizes)
            for i in range(NE):
                w.residual_roundoff[i] = smaller_change(fabs(w.trial_c[i] - w.c[i]), w.residual_roundoff[i])
            for k in range(NJ):
                w.slope_roundoff[k] = smaller_change(fabs(w.trial_J[k] - w.J[k]), w.slope_roundoff[k])


def estimate_slope_roundoff(p: Params, t: Real, y: Vec[NU], sizes: Vec[NU], w: StartWork) -> None:
    """Set w.entry_roundoff: the change of the derivatives at y if positions, of these sizes, are
    perturbed by four units in the last place."""
    w.trial[:] = y
    for i in range(NQ):
        size = fabs(y[i]) if fabs(y[i]) > fabs(sizes[i]) else fabs(sizes[i])
        w.trial[i] += (FOUR_ULPS if i % 2 == 0 else -FOUR_ULPS) * size
    evaluate_rows(p, t, w.trial, w.trial_c, w.trial_J, w.trial_term_sizes, w)
    for r in range(w.row_count):
        for k in range(row_begin(w.rows[r]), ends[w.rows[r]]):
            change = fabs(w.trial_J[k] - w.J[k])
            w.entry_roundoff[k] = change if change > w.slope_roundoff[k] else w.slope_roundoff[k]


def known_terms(i: int, w: StartWork) -> Real:
    """The sum of the terms of equation i with known magnitudes."""
    total = w.guess_term_sizes[i]
    for k in range(row_begin(i), ends[i]):
        if w.magnitude[w.column[k]] < inf:
            total += fabs(w.J[k]) * w.magnitude[w.column[k]]
    return total


def is_open(k: int, w: StartWork) -> bool:
    """Whether derivative k is by an unknown without a magnitude."""
    return (
        w.magnitude[w.column[k]] == inf
        and 0.0 < fabs(w.J[k])
        and fabs(w.J[k]) < inf
        and not is_roundoff(k, w)
    )


def is_steepest(i: int, k: int, w: StartWork) -> bool:
    """Whether equation i depends on the unknown of derivative k more than on others of its unit without a
    magnitude."""
    if not is_open(k, w):
        return False
    for other in range(row_begin(i), ends[i]):
        if (
            unit[w.column[other]] == unit[w.column[k]]
            and is_open(other, w)
            and fabs(w.J[other]) > fabs(w.J[k])
        ):
            return False
    return True


def size_single(w: StartWork) -> bool:
    """Set the magnitude of the unknown that alone has none in an equation; return whether any was set."""
    found = False
    for i in range(NE):
        at = -1
        count = 0
        for k in range(row_begin(i), ends[i]):
            if is_open(k, w):
                at = k
                count += 1
        if count == 1 and w.chosen[i] == 0:
            w.chosen[i] = 1
            size = known_terms(i, w) / fabs(w.J[at])
            if size < inf:
                w.magnitude[w.column[at]] = size
                found = True
    return found


def size_several(w: StartWork) -> bool:
    """Set the magnitudes where equations hold several unknowns without one; return whether any was set."""
    found = False
    w.moves[:] = w.magnitude
    for turn in range(2):
        for i in range(NE):
            total = known_terms(i, w)
            if w.chosen[i] == 1 or not (0.0 < total and total < inf):
                continue
            for k in range(row_begin(i), ends[i]):
                if is_steepest(i, k, w):
                    size = total / fabs(w.J[k])
                    if turn == 0 and size < w.moves[w.column[k]]:
                        w.moves[w.column[k]] = size
                        found = True
                    if turn == 1 and size == w.moves[w.column[k]]:
                        w.chosen[i] = 1
    w.magnitude[:] = w.moves
    return found


def propagate_magnitudes(w: StartWork) -> None:
    """Set w.magnitude of each unknown from stated values, and from equation to equation; infinite if none
    determines it."""
    for i in range(NU):
        w.magnitude[i] = fabs(w.guess[i]) if w.guess[i] != 0.0 or w.levels[i] > UNSTATED else inf
    for i in range(NE):
        w.chosen[i] = 0
    for turn in range(2):  # values stated as zero come last if their unit has no size
        while True:
            if not size_single(w) and not size_several(w):
                break
        for i in range(NU):
            if turn == 0 and w.magnitude[i] == 0.0 and w.levels[i] > UNSTATED and w.unit_size[unit[i]] == 0.0:
                w.magnitude[i] = inf
    for i in range(NU):
        if (
            angle[i] == 1 and w.guess[i] == 0.0 and w.magnitude[i] < SLIGHT
        ):  # angles have the size of a radian
            w.magnitude[i] = inf


def unit_sizes(w: StartWork) -> None:
    """Set w.unit_size: the largest guess of each unit."""
    for i in range(NU):
        w.unit_size[i] = 0.0
    for i in range(NU):
        if fabs(w.guess[i]) > w.unit_size[unit[i]]:
            w.unit_size[unit[i]] = fabs(w.guess[i])


def share_sizes(w: StartWork) -> None:
    """Set w.unit_size, where all guesses of a unit are zero, to the largest magnitude in it."""
    for i in range(NU):
        w.begin[i] = w.unit_size[i]
    for i in range(NU):
        if w.begin[unit[i]] == 0.0 and w.magnitude[i] < MOST_WEIGHT and w.magnitude[i] > w.unit_size[unit[i]]:
            w.unit_size[unit[i]] = w.magnitude[i]


def usual_size(i: int, largest: Vec[NU], w: StartWork) -> Real:
    """The size of an unknown: its own, that of its unit, its magnitude, that of parameters of its unit,
    or 1."""
    weight = fabs(w.guess[i])
    if w.levels[i] == UNSTATED or weight == 0.0:
        weight = w.unit_size[unit[i]]
    if weight == 0.0 and w.magnitude[i] < inf:
        weight = w.magnitude[i]
    if weight == 0.0:
        weight = largest[unit[i]]
    if not (LEAST_WEIGHT < weight and weight < MOST_WEIGHT):
        weight = 1.0
    return weight


def tighten(w: StartWork) -> None:
    """Limit the magnitudes of unstated unknowns that are guessed zero by the other terms of equations."""
    for i in range(NE):
        at = -1
        largest = 0.0
        first = row_begin(i)
        end = ends[i]
        for k in range(first, end):
            own = fabs(w.J[k]) * w.magnitude[w.column[k]]
            if own > largest:
                at = k
                largest = own
        if at < 0 or is_roundoff(at, w):
            continue
        j = w.column[at]
        total = w.guess_term_sizes[i]
        for k in range(first, end):
            if k != at:
                total += fabs(w.J[k]) * w.magnitude[w.column[k]]
        if 0.0 < total and total < largest and w.levels[j] == UNSTATED and w.guess[j] == 0.0:
            w.magnitude[j] = total / fabs(w.J[at])


def set_scaling(p: Params, t: Real, largest: Vec[NU], w: StartWork) -> None:
    """Set w.scaling, w.unit_scaling and w.magnitude at the guess."""
    evaluate_all(p, t, w.guess, w.c, w.J, w.term_sizes)
    w.guess_term_sizes[:] = w.term_sizes
    estimate_roundoff(p, t, w)
    estimate_slope_roundoff(p, t, w.guess, w.guess, w)
    unit_sizes(w)
    propagate_magnitudes(w)
    share_sizes(w)
    for i in range(NU):
        w.begin[i] = usual_size(i, largest, w)
    for i in range(NU):
        weight = usual_size(i, largest, w)
        width = w.unit_size[unit[i]] if w.unit_size[unit[i]] < MOST_WEIGHT else MOST_WEIGHT
        if width < weight:
            width = weight
        reach = (
            w.magnitude[i] if w.guess[i] == 0.0 and 0.0 < w.magnitude[i] and w.magnitude[i] < inf else weight
        )
        if reach < LEAST_WEIGHT:
            reach = LEAST_WEIGHT
        if reach > MOST_WEIGHT:
            reach = MOST_WEIGHT
        if w.levels[i] == UNSTATED and (reach < SLIGHT * weight or weight < SLIGHT * reach):
            weight = reach
            width = reach
        most = 1.0 if angle[i] == 1 else inf
        w.scaling[i] = weight if weight < most else most
        w.unit_scaling[i] = width if width < most else most
        w.magnitude[i] = reach if reach < most else most
    tighten(w)
    if NQUAT > 0:
        for k in range(NQUAT):
            for i in range(4):
                w.scaling[quaternion[k] + i] = 1.0
                w.unit_scaling[quaternion[k] + i] = 1.0
                w.magnitude[quaternion[k] + i] = 1.0
