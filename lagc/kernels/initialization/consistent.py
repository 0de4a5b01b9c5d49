"""Consistent initial conditions: unstated values move first, stated values only where they have to."""

from math import fabs, inf

from lagc.kernels.arguments import bad_parameter
from lagc.kernels.arithmetic.quaternions import normalise
from lagc.kernels.initialization.gauss_newton import attempt, select_columns, unscaled_norm, unstated_distance
from lagc.kernels.initialization.multistart import NEAR, SPREADS, multistart
from lagc.kernels.initialization.relaxation import relax
from lagc.kernels.initialization.residuals import (
    largest_residual,
    row_begin,
    select_equations,
    set_levels,
    set_scales,
)
from lagc.kernels.initialization.scaling import set_scaling
from lagc.kernels.initialization.workspace import DECLARED, FIXED, UNSTATED, StartWork
from lagc.kernels.language.vocabulary import *


def moves_massless(i: int, w: StartWork) -> bool:
    """Whether equation i contains an unstated speed without inertia."""
    found = False
    for k in range(row_begin(i), ends[i]):
        j = w.column[k]
        found = found or (massless[j] == 1 and w.levels[j] == UNSTATED)
    return found


def select_without_massless(w: StartWork) -> int:
    """Select the equations without unstated speeds without inertia; return their number, -1 for all."""
    rows = w.row_count
    kept = 0
    for r in range(rows):
        w.whole[r] = w.rows[r]
        if not moves_massless(w.rows[r], w):
            w.selected[kept] = w.rows[r]
            kept += 1
    if kept == rows:
        return -1
    select_equations(kept, w)
    return kept


def complete_massless(p: Params, t: Real, rows: int, w: StartWork) -> bool:
    """Select all equations again; move speeds without inertia from w.y, and hold unstated ones with."""
    for r in range(rows):
        w.selected[r] = w.whole[r]
    select_equations(rows, w)
    for i in range(NQ, NQ + NV):
        w.held[i] = 0
        if massless[i] == 0 and w.levels[i] == UNSTATED and w.free[i] == 1:
            w.held[i] = 1
            w.free[i] = 0
    attempt(p, t, w.y, w)
    for i in range(NQ, NQ + NV):
        if w.held[i] == 1:
            w.free[i] = 1
    return largest_residual(p, t, w.y, w.row_count, w) <= ACCEPTED


def search(p: Params, t: Real, end: int, w: StartWork) -> bool:
    """Search from beginnings 0..end-1; unstated speeds without inertia move before those of bodies."""
    if NMASSLESS > 0:
        rows = w.row_count
        kept = select_without_massless(w)
        if kept >= 0:
            w.y[:] = w.guess
            met = kept == 0 or multistart(p, t, 0, end, w)
            if complete_massless(p, t, rows, w) and met:
                return True
    return multistart(p, t, 0, end, w)


def release_level(level: int, w: StartWork) -> bool:
    """Free all values of a level in this block; return whether there are any."""
    found = False
    for k in range(w.unknown_count):
        i = w.unknowns[k]
        if w.levels[i] == level:
            w.free[i] = 1
            found = True
    return found


def has_level(level: int, w: StartWork) -> bool:
    """Whether this block has a value of the level."""
    for k in range(w.unknown_count):
        i = w.unknowns[k]
        if w.levels[i] == level:
            return True
    return False


def release_levels(p: Params, t: Real, w: StartWork) -> bool:
    """Find a start of this block: free one priority level after the other, then hold all that need not
    move."""
    if search(p, t, SPREADS, w):
        return True
    level = DECLARED
    while level < FIXED:
        if release_level(level, w) and search(p, t, SPREADS, w):
            break
        level += 1
    if level == FIXED:
        return False
    while level > UNSTATED:
        if has_level(level, w):
            relax(p, t, level, w)
        level -= 1
    return True


def least_block(i: int, w: StartWork) -> int:
    """Give the unknowns of equation i that may move the least block number among them; return it."""
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


def label_blocks(w: StartWork) -> None:
    """Set w.block: equal for equations that share an unknown that may move."""
    for i in range(NU):
        w.picked[i] = i
    for r in range(NE):
        w.block[r] = -1
    changed = True
    while changed:
        changed = False
        for r in range(NE):
            least = least_block(w.all_rows[r], w)
            changed = changed or w.block[r] != least
            w.block[r] = least


def select_block(part: int, w: StartWork) -> int:
    """Select the equations of one block and reset the unknowns; return the number of equations."""
    n = 0
    for r in range(NE):
        if w.block[r] == part:
            w.selected[n] = w.all_rows[r]
            n += 1
    if n > 0:
        select_equations(n, w)
        for i in range(NU):
            w.free[i] = 0
        for k in range(w.unknown_count):
            w.free[w.unknowns[k]] = w.free_before[w.unknowns[k]]
        w.y[:] = w.block_begin
    return n


def solve_blocks(p: Params, t: Real, w: StartWork) -> bool:
    """Solve independent blocks of equations one by one."""
    w.block_begin[:] = w.y
    w.combined[:] = w.guess
    w.free_before[:] = w.free
    label_blocks(w)
    for part in range(NU + 1):
        if select_block(part, w) == 0:
            continue
        met = (
            largest_residual(p, t, w.block_begin, w.row_count, w) <= CLOSE
            and unstated_distance(w.block_begin, w) <= NEAR
        )
        if not met and not release_levels(p, t, w):
            return False
        for k in range(w.unknown_count):
            i = w.unknowns[k]
            if w.levels[i] < FIXED:
                w.combined[i] = w.y[i]
                w.free_before[i] = w.free[i]
    w.y[:] = w.combined
    w.free[:] = w.free_before
    return True


def reset_traces(w: StartWork) -> bool:
    """Set w.combined to w.y, with unknowns that moved by less than the tolerance reset to their guesses
    and held; return whether there are any."""
    w.combined[:] = w.y
    found = False
    for k in range(w.unknown_count):
        i = w.unknowns[k]
        move = fabs(w.y[i] - w.guess[i])
        if w.free[i] == 1 and 0.0 < move and move <= TRACE * w.scaling[i]:
            w.combined[i] = w.guess[i]
            w.free[i] = 0
            found = True
    return found


def meets_unscaled(p: Params, t: Real, y: Vec[NU], w: StartWork) -> bool:
    """Whether y meets the equations relative to their own terms."""
    select_columns(0, NU, w)
    largest_residual(p, t, y, w.row_count, w)
    w.entry_roundoff[:] = w.slope_roundoff
    return unscaled_norm(w.c, w.term_sizes, 0, w.row_count, w) <= CLOSE


def restore_traces(p: Params, t: Real, w: StartWork) -> None:
    """Reset unknowns that moved by less than the tolerance to their guesses, if the equations stay met:
    steps leave traces of round-off in unknowns that need not move."""
    for i in range(NE):
        w.selected[i] = w.all_rows[i]
    select_equations(NE, w)
    w.free_before[:] = w.free
    if reset_traces(w):
        w.full_steps = True
        attempt(p, t, w.combined, w)
        w.full_steps = False
        same = largest_residual(p, t, w.combined, w.row_count, w) <= CLOSE
        for i in range(NU):
            same = same and fabs(w.combined[i] - w.y[i]) <= TRACE * w.scaling[i]
        w.free[:] = w.free_before
        if same and (meets_unscaled(p, t, w.combined, w) or not meets_unscaled(p, t, w.y, w)):
            w.y[:] = w.combined
    w.free[:] = w.free_before


def check_input(p: Params, t: Real, levels: IVec[NU], w: StartWork) -> bool:
    """Whether time, parameters and levels are valid; else w.culprit tells which is not."""
    w.culprit = bad_parameter(p) if fabs(t) < inf else BAD_TIME
    if present(levels):
        for i in range(NU):
            if w.culprit < 0 and (levels[i] < UNSTATED or levels[i] > FIXED):
                w.culprit = BAD_LEVEL
    return w.culprit < 0


def prepare(p: Params, t: Real, x: Vec[NX], levels: IVec[NU], w: StartWork) -> Status:
    """Set the guess, the levels and the scaling."""
    rates = vector(NU)
    for i in range(NU):
        rates[i] = 0.0
    largest = vector(NU)
    for i in range(NU):
        largest[i] = 0.0
    if NCOND > 0:
        fn_measures(p, rates, largest)
    set_levels(levels, w)
    for i in range(NQ + NV):
        w.guess[i] = x[i]
    for i in range(NRATE):
        w.guess[NQ + NV + i] = rates[i]
    if NQUAT > 0:
        normalise(w.guess)
    w.culprit = not_finite(w.guess, NU)
    if w.culprit >= 0:
        return NOT_FINITE
    if NQUAT > 0:
        for k in range(NQUAT):
            at = quaternion[k]
            if (
                w.guess[at] == 0.0
                and w.guess[at + 1] == 0.0
                and w.guess[at + 2] == 0.0
                and w.guess[at + 3] == 0.0
            ):
                w.culprit = NCOND + k
                return INCONSISTENT
    w.full_steps = False
    w.work = 0
    set_scaling(p, t, largest, w)
    set_scales(False, w)
    return OK


def reach_start(p: Params, t: Real, w: StartWork) -> Status:
    """Move w.y from the guess to consistent initial conditions."""
    near = search(p, t, 1, w) and unstated_distance(w.y, w) <= NEAR
    if not near and not solve_blocks(p, t, w):
        largest_residual(p, t, w.y, w.row_count, w)
        return INCONSISTENT
    restore_traces(p, t, w)
    return OK


@public
def consistent(p: Params, t: Real, x: Vec[NX], levels: IVec[NU], w: StartWork) -> Status:
    """Move the guess x[NX] to consistent initial conditions: constraints, their rates, the initial
    section, unit quaternions; x[NQ+NV..] stays.  Lower levels move first, few values of each level.
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
