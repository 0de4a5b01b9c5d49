"""Consistent initial conditions: the equations by a Gauss-Newton method with steps of least norm.

The unknowns y are q, v, and stated rates that declared speeds replace.  The equations are phi = 0, psi = 0,
the `initial` section, rate - value = 0 for these rates, and unit quaternions.  A stated value is held.  If
nothing is found, values give way to values that are stated more firmly: DECLARED, then SCENE, then RUN; FIXED
values never do.
"""

from math import fabs, inf

from lagc.kernels.arguments import bad_parameter
from lagc.kernels.arithmetic.quaternions import normalise, square_at
from lagc.kernels.initialization.gauss_newton import distance, draw_back, newton, relax, tidy
from lagc.kernels.initialization.residuals import SLIGHT, mark_roundoff, row_begin, set_sizes, start_residual
from lagc.kernels.initialization.workspace import FIXED, UNSTATED, StartWork
from lagc.kernels.language.vocabulary import *

BEGINNINGS = 8  # the guess, and points beside it
BESIDE = 3  # the beginning that leaves a singular guess well behind
ALIKE = 1e-6  # of a residual: attempts that end with the same one ended at the same point
NEAR = 8.0  # scaled distance from the guess: a solution within it ends the search
PULL_STEPS = 20  # steps towards the guess


def find_part(first: int, end: int, stage: int, w: StartWork) -> int:
    """Move to the front of w.rows[first..end-1] the equations that share unknowns, directly or through
    others, with the first of them; set w.reached for these unknowns; return the end of this part."""
    for i in range(NU):
        w.reached[i] = 0
    stop = first
    changed = True
    # Breadth-first: rows that share an unknown with the part so far move to its end, until no row does. In
    # the first round only the first row counts (stop == first).
    while changed:
        changed = False
        begin = stop
        for r in range(begin, end):
            row = w.rows[r]
            shares = stop == first
            for k in range(row_begin(row), ends[row]):
                shares = shares or w.reached[w.column[k]] == 1
            if shares:
                w.rows[r] = w.rows[stop]
                w.rows[stop] = row
                stop += 1
                changed = True
                for k in range(row_begin(row), ends[row]):  # values that never move share nothing
                    j = w.column[k]
                    if w.levels[j] < FIXED and w.stage[j] >= stage:
                        w.reached[j] = 1
    return stop


def select_columns(stage: int, last: int, level: int, w: StartWork) -> bool:
    """Free the reached unknowns of the stages up to this level: set w.columns and w.step_scaling; return
    whether there are any of this level."""
    w.column_count = 0
    found = False
    # Columns in the order in which equations name unknowns, so that coupled ones are neighbours and rows stay
    # narrow.
    for k in range(NU):
        i = w.ordered[k]
        w.column_of[i] = -1
        if w.reached[i] == 1 and stage <= w.stage[i] and w.stage[i] <= last and w.levels[i] <= level:
            found = found or w.levels[i] == level
            w.column_of[i] = w.column_count
            w.columns[w.column_count] = i
            w.column_count += 1
            w.step_scaling[i] = w.scaling[i]
    return found


def begin_at(k: int, w: StartWork) -> None:
    """Set w.y, in w.columns, to the guess, beside it for k > 0: a guess may be singular."""
    # Deterministic points beside the guess: 1 % of the sizes first, then a quarter, a half ... of them. Seeds
    # are fixed, so that the same model has the same start on every machine.
    state: Length = 12345 + k  # the congruential generator of rand() in the C standard, of 31 bits
    for n in range(w.column_count):
        i = w.columns[n]
        w.y[i] = w.guess[i]
        state = (1103515245 * state + 12345) & 2147483647
        if k > 0:
            spread = 0.01 if k == 1 else 0.25 * float(k - 1)
            w.y[i] += spread * w.step_scaling[i] * (float(state) / 1073741824.0 - 1.0)
    if NQUAT > 0:
        if k > 0:
            normalise(w.y)


def solve_part(
    p: Params, t: Real, first: int, end: int, stage: int, last: int, level: int, w: StartWork
) -> bool:
    """Meet w.rows[first..end-1] by the reached unknowns of these stages that are stated no more firmly than
    `level`, from the guess and from points beside it; else leave w.y."""
    # Equations that the values meet as they are need no value to give way.
    if level > UNSTATED:  # a part that is met by less stays as it is
        start_residual(p, t, w.y, first, end, True, w)
        if w.worst <= ACCEPTED:
            return True
    if not select_columns(stage, last, level, w) and level > UNSTATED:
        return False
    if stage > 0:
        mark_roundoff(p, t, w.y, w)
    else:
        for k in range(NJ):
            w.roundoff[k] = 0  # positions move, and with them what is round-off
    # Attempts from the guess, w.ended its end, and from points beside it; the nearest solution counts.
    w.begun[:] = w.y
    w.ended[:] = w.y
    nearest = inf
    failed = 0.0  # the residual of the attempt before
    for k in range(BEGINNINGS):
        w.y[:] = w.ended
        begin_at(k, w)
        if newton(p, t, first, end, w):
            tidy(p, t, first, end, w)
            if k > 0:
                draw_back(p, t, first, end, PULL_STEPS, w)
            if level > UNSTATED:
                relax(p, t, level, first, end, w)  # all values of the level have moved: let few do
            tidy(p, t, first, end, w)
            if distance(w) < nearest:
                nearest = distance(w)
                w.best[:] = w.y
            if nearest <= NEAR or level > UNSTATED:
                break
        # A failed attempt: equal residuals of two of them mean that they ended at the same point, so more
        # would too.
        else:
            if k == 0:
                w.ended[:] = w.y
            if w.column_count == 0 or (k >= BESIDE and fabs(w.worst - failed) <= ALIKE * failed):
                break
            failed = w.worst if w.worst < inf else 0.0
    if nearest == inf:
        w.y[:] = w.begun
        return False
    # All unknowns of the part may have moved; the report names those that did.
    w.y[:] = w.best
    for n in range(w.column_count):
        w.free[w.columns[n]] = 1
    return True


def solve_stages(p: Params, t: Real, stage: int, last: int, level: int, w: StartWork) -> bool:
    """Meet the equations of these stages, each part that shares no unknown with others by itself; return
    whether all are met."""
    # Parts are independent, so each is solved, and fails, by itself; one that fails does not hide others.
    end = w.stage_begin[last + 1]
    first = w.stage_begin[stage]
    found = True
    while first < end:
        stop = find_part(first, end, stage, w)
        if not solve_part(p, t, first, stop, stage, last, level, w):
            found = False
            w.last[:] = w.ended
        first = stop
    return found


def reach_start(p: Params, t: Real, w: StartWork) -> Status:
    """Move w.y from the guess to consistent initial conditions: positions, then speeds, then all together."""
    w.y[:] = w.guess
    w.last[:] = w.guess
    found = False
    # First without touching stated values (UNSTATED), then with DECLARED ones, and so on: a value gives way
    # only if no less firm one is enough.
    for level in range(UNSTATED, FIXED):
        if not found:
            found = solve_stages(p, t, 0, 0, level, w)
    if found:
        # Speeds need positions; speeds without inertia follow from the others. If that fails, speeds of both
        # kinds together, then all stages together, level by level.
        found = solve_stages(p, t, 1, 1, UNSTATED, w) and solve_stages(p, t, 2, 2, UNSTATED, w)
        for level in range(UNSTATED, FIXED):
            if not found:
                found = solve_stages(p, t, 1, 2, level, w) or solve_stages(p, t, 0, 2, level, w)
    if not found:
        w.y[:] = w.last
    start_residual(p, t, w.y, 0, w.stage_begin[3], True, w)
    return OK if found else INCONSISTENT


def order_unknowns(w: StartWork) -> None:
    """Set w.ordered: all unknowns in the order in which equations name them.  Coupled ones are near each
    other then, and the rows of the matrix narrow."""
    for i in range(NU):
        w.reached[i] = 0
    count = 0
    # Each equation names its unknowns; what no equation names comes last.
    named = row_begin(size(NE))  # the number of derivatives
    for k in range(named + NU):
        j = w.column[k] if k < named else k - named
        if w.reached[j] == 0:
            w.reached[j] = 1
            w.ordered[count] = j
            count += 1


def select_equations(w: StartWork) -> None:
    """Set w.rows: the equations w.asked, by the stages of their unknowns."""
    count = 0
    # An equation belongs to the latest stage of its unknowns: it cannot be met before.
    for stage in range(3):
        w.stage_begin[stage] = count
        for i in range(NE):
            latest = 0
            for k in range(row_begin(i), ends[i]):
                if w.stage[w.column[k]] > latest:
                    latest = w.stage[w.column[k]]
            if w.asked[i] == 1 and latest == stage:
                w.rows[count] = i
                count += 1
    w.stage_begin[3] = count


def set_levels(levels: IVec[NU], w: StartWork) -> None:
    """Set levels, those of a quaternion alike, and stages; ask for all equations."""
    if present(levels):
        w.levels[:] = levels
    else:
        w.levels[:] = level
    # The four parts of a quaternion move together: the firmest statement counts for all.
    for i in range(NU):
        w.part[i] = 0
    if NQUAT > 0:
        for k in range(NQUAT):
            first = quaternion[k]
            for i in range(1, 4):
                if w.levels[first + i] > w.levels[first]:
                    w.levels[first] = w.levels[first + i]
            for i in range(1, 4):
                w.levels[first + i] = w.levels[first]
                w.part[first + i] = 1
    # Stages: positions, speeds, unstated speeds without inertia.
    for i in range(NU):
        w.free[i] = 1 if w.levels[i] == UNSTATED else 0
        w.stage[i] = 0 if i < NQ else 1
        if NMASSLESS > 0:
            if massless[i] == 1 and w.levels[i] == UNSTATED:
                w.stage[i] = 2
    # The unknown of each derivative, from the stretches of consecutive unknowns in which tables keep them.
    n = 0
    for k in range(NSTRETCH):
        for j in range(stretch_begins[k], stretch_ends[k]):
            w.column[n] = j
            n += 1
    for i in range(NE):
        w.asked[i] = 1
    select_equations(w)
    order_unknowns(w)


def check_input(p: Params, t: Real, levels: IVec[NU], w: StartWork) -> bool:
    """Return whether time, parameters and levels are valid; else w.culprit tells which is not."""
    w.culprit = bad_parameter(p) if fabs(t) < inf else BAD_TIME
    if present(levels):
        for i in range(NU):
            if w.culprit < 0 and (levels[i] < UNSTATED or levels[i] > FIXED):
                w.culprit = BAD_LEVEL
    return w.culprit < 0


def prepare(p: Params, t: Real, x: Vec[NX], levels: IVec[NU], w: StartWork) -> Status:
    """Set the guess, the levels and the sizes."""
    # Stated rates and sizes of parameters come from the model.
    rates = vector(NU)
    largest = vector(NU)
    for i in range(NU):
        rates[i] = 0.0
        largest[i] = 0.0
    if NCOND > 0:
        fn_measures(p, rates, largest)
    set_levels(levels, w)
    for i in range(NQ + NV):
        # The guess is what the caller gives: states, then stated rates.
        w.guess[i] = x[i]
    for i in range(NRATE):  # `x` has no stated rates: they are computed from parameters
        w.guess[NQ + NV + i] = rates[i]
    if NQUAT > 0:
        normalise(w.guess)
    w.culprit = not_finite(w.guess, NU)
    if w.culprit >= 0:
        return NOT_FINITE
    if NQUAT > 0:
        for k in range(NQUAT):  # a quaternion that is zero has no direction
            if square_at(w.guess, quaternion[k]) == 0.0:
                w.culprit = NCOND + k
                return INCONSISTENT
    # Sizes are found at the guess, before anything moves.
    w.work = 0
    w.share = SLIGHT
    w.y[:] = w.guess
    set_sizes(p, t, largest, w)
    return OK


@public
def consistent(p: Params, t: Real, x: Vec[NX], levels: IVec[NU], w: StartWork) -> Status:
    """Move the guess x[NX] to consistent initial conditions: constraints, their rates, the initial
    section, unit quaternions; x[NQ+NV..] stays.  Values of lower levels give way to those of higher ones.
    `levels` of q, v and the stated rates, in this order; NULL: those of the model.  Any status but OK leaves
    x as it was.  INCONSISTENT: no solution was found; the equations are phi[NH], psi[NC], those of the
    initial section, those of the stated rates, unit quaternions, in this order."""
    if not check_input(p, t, levels, w):
        return INVALID
    status = prepare(p, t, x, levels, w)
    if status == OK:
        status = reach_start(p, t, w)
    if status == OK:
        for i in range(NQ + NV):
            x[i] = w.y[i]
    return status
