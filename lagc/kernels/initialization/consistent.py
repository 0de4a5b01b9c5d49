"""A consistent start: what nobody stated moves first, what was stated only where it has to."""

from __future__ import annotations

from math import fabs, inf

from lagc.kernels.arguments import bad_parameter
from lagc.kernels.arithmetic.quaternions import normalise
from lagc.kernels.initialization.gauss_newton import attempt, loosen, rough, strayed
from lagc.kernels.initialization.multistart import NEAR, SPREADS, find
from lagc.kernels.initialization.relaxation import relax
from lagc.kernels.initialization.residuals import arrange, confine, farthest, row_begin, set_scales
from lagc.kernels.initialization.scaling import weigh
from lagc.kernels.initialization.workspace import DECLARED, FIXED, UNSTATED, StartWork
from lagc.kernels.language.model import fn_measures
from lagc.kernels.language.records import BAD_LEVEL, BAD_TIME
from lagc.kernels.language.scaling_groups import not_finite
from lagc.kernels.language.sizes import NCOND, NE, NQ, NQUAT, NRATE, NU, NV, NX
from lagc.kernels.language.statuses import INCONSISTENT, INVALID, NOT_FINITE, OK
from lagc.kernels.language.tables import ends, quaternion
from lagc.kernels.language.tolerances import CLOSE, TRACE
from lagc.kernels.language.words import IVec, Params, Real, Status, Vec, present, public, size, vector


def release_level(level: int, w: StartWork) -> bool:
    """Let all values of a level move; whether this part has any."""
    found = False
    owned = w.owned
    for k in range(owned):
        i = w.own[k]
        if w.levels[i] == level:
            w.loose[i] = 1
            found = True
    return found


def has_level(level: int, w: StartWork) -> bool:
    """Whether a value of this part is stated at a level."""
    owned = w.owned
    for k in range(owned):
        i = w.own[k]
        if w.levels[i] == level:
            return True
    return False


def ladder(p: Params, t: Real, w: StartWork) -> bool:
    """Level after level is let go until there is a start; then as much as possible is held again."""
    if find(p, t, 0, SPREADS, w):
        return True
    level = DECLARED
    while level < FIXED:
        if release_level(level, w) and find(p, t, 0, SPREADS, w):
            break
        level += 1
    if level == FIXED:
        return False
    while level > UNSTATED:
        if has_level(level, w):
            relax(p, t, level, w)
        level -= 1
    return True


def least_owner(i: int, w: StartWork) -> int:
    """The least of w.picked of the unknowns in condition i that may move; they all get it."""
    found = size(NU)
    first = row_begin(i)
    end = ends[i]
    for k in range(first, end):
        if w.levels[w.column[k]] < FIXED and w.picked[w.column[k]] < found:
            found = w.picked[w.column[k]]
    for k in range(first, end):
        if w.levels[w.column[k]] < FIXED:
            w.picked[w.column[k]] = found
    return found


def group(w: StartWork) -> None:
    """w.group: a number for each row, the same for rows that share an unknown that may move."""
    for i in range(NU):
        w.picked[i] = i
    for r in range(NE):
        w.group[r] = -1
    changed = True
    while changed:
        changed = False
        for r in range(NE):
            least = least_owner(w.all[r], w)
            changed = changed or w.group[r] != least
            w.group[r] = least


def confine_to(part: int, w: StartWork) -> int:
    """Look at the rows of a group alone; how many they are."""
    n = 0
    for r in range(NE):
        if w.group[r] == part:
            w.order[n] = w.all[r]
            n += 1
    if n > 0:
        confine(n, w)
        for i in range(NU):
            w.loose[i] = 0
        owned = w.owned
        for k in range(owned):
            w.loose[w.own[k]] = w.let[w.own[k]]
        w.y[:] = w.reached
    return n


def by_parts(p: Params, t: Real, w: StartWork) -> bool:
    """Each part of the conditions that shares no unknown with the others by itself."""
    w.reached[:] = w.y
    w.answer[:] = w.home
    w.let[:] = w.loose
    group(w)
    for part in range(NU + 1):
        if confine_to(part, w) == 0:
            continue
        met = farthest(p, t, w.reached, w.ended, w) <= CLOSE and strayed(w.reached, w) <= NEAR
        if not met and not ladder(p, t, w):
            return False
        owned = w.owned
        for k in range(owned):
            i = w.own[k]
            if w.levels[i] < FIXED:
                w.answer[i] = w.y[i]
                w.let[i] = w.loose[i]
    w.y[:] = w.answer
    w.loose[:] = w.let
    return True


def lay_still(w: StartWork) -> bool:
    """w.answer: w.y, with what went next to no way as guessed, and held; whether there is any."""
    w.answer[:] = w.y
    found = False
    owned = w.owned
    for k in range(owned):
        i = w.own[k]
        way = fabs(w.y[i] - w.home[i])
        if w.loose[i] == 1 and 0.0 < way and way <= TRACE * w.weights[i]:
            w.answer[i] = w.home[i]
            w.loose[i] = 0
            found = True
    return found


def met_by_terms(p: Params, t: Real, y: Vec[NU], w: StartWork) -> bool:
    """Whether y meets the conditions as near by as their own terms tell."""
    loosen(0, NU, w)
    farthest(p, t, y, w.ended, w)
    w.blurs[:] = w.doubted
    return rough(w.c, w.sizes, 0, w.ended, w) <= CLOSE


def calm(p: Params, t: Real, w: StartWork) -> None:
    """Leave as guessed what went next to no way, if what is left meets the conditions as near by: steps leave
    traces in unknowns that they need not move."""
    for i in range(NE):
        w.order[i] = w.all[i]
    confine(NE, w)
    w.let[:] = w.loose
    if lay_still(w):
        w.whole = True
        attempt(p, t, w.answer, w)
        w.whole = False
        same = farthest(p, t, w.answer, w.ended, w) <= CLOSE
        for i in range(NU):
            same = same and fabs(w.answer[i] - w.y[i]) <= TRACE * w.weights[i]
        w.loose[:] = w.let
        if same and (met_by_terms(p, t, w.answer, w) or not met_by_terms(p, t, w.y, w)):
            w.y[:] = w.answer
    w.loose[:] = w.let


def demand_start(p: Params, t: Real, levels: IVec[NU], w: StartWork) -> bool:
    """Whether what is given makes sense; else w.culprit does not."""
    w.culprit = bad_parameter(p) if fabs(t) < inf else BAD_TIME
    if present(levels):
        for i in range(NU):
            if w.culprit < 0 and (levels[i] < UNSTATED or levels[i] > FIXED):
                w.culprit = BAD_LEVEL
    return w.culprit < 0


def prepare(p: Params, t: Real, x: Vec[NX], levels: IVec[NU], w: StartWork) -> Status:
    """The guess, with all conditions before it."""
    rates = vector(NU)
    for i in range(NU):
        rates[i] = 0.0
    largest = vector(NU)
    for i in range(NU):
        largest[i] = 0.0
    if NCOND > 0:
        fn_measures(p, rates, largest)
    arrange(levels, w)
    for i in range(NQ + NV):
        w.home[i] = x[i]
    for i in range(NRATE):
        w.home[NQ + NV + i] = rates[i]
    if NQUAT > 0:
        normalise(w.home)
    w.culprit = not_finite(w.home, NU)
    if w.culprit >= 0:
        return NOT_FINITE
    if NQUAT > 0:
        for k in range(NQUAT):
            at = quaternion[k]
            if (
                w.home[at] == 0.0
                and w.home[at + 1] == 0.0
                and w.home[at + 2] == 0.0
                and w.home[at + 3] == 0.0
            ):
                w.culprit = NCOND + k
                return INCONSISTENT
    w.whole = False
    w.work = 0
    weigh(p, t, largest, w)
    set_scales(False, w)
    return OK


def reach_start(p: Params, t: Real, w: StartWork) -> Status:
    """From the guess to a start, w.y."""
    near = find(p, t, 0, 1, w) and strayed(w.y, w) <= NEAR
    if not near and not by_parts(p, t, w):
        farthest(p, t, w.y, w.ended, w)
        return INCONSISTENT
    calm(p, t, w)
    return OK


@public
def consistent(p: Params, t: Real, x: Vec[NX], levels: IVec[NU], w: StartWork) -> Status:
    """Move the guess x[NX] onto all conditions of the start: constraints, their rates, the initial
    section, unit quaternions; x[NQ+NV..] is left.  What is stated less firmly moves first, of what is
    stated as few as possible.  `levels` of q, v and the stated rates, in this order; NULL: the model's.
    Any other status than OK leaves x as it was.  INCONSISTENT: no start was found; the conditions are
    phi[NH], psi[NC], those of the initial section, those of the stated rates, unit quaternions, in this
    order."""
    if not demand_start(p, t, levels, w):
        return INVALID
    status = prepare(p, t, x, levels, w)
    if status == OK:
        status = reach_start(p, t, w)
    if status == OK:
        for i in range(NQ + NV):
            x[i] = w.y[i]
    return status
