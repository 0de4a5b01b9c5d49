"""The unknowns and equations of the initialization, and their residuals.

The unknowns y are q, v, and stated rates that declared speeds replace.  The initial equations are phi = 0,
psi = 0, the `initial` section, rate - value = 0 for these rates, and unit quaternions.  Each unknown has a
level, from UNSTATED to FIXED.
"""

from math import fabs, inf, sqrt

from lagc.kernels.arithmetic.quaternions import square_at
from lagc.kernels.initialization.workspace import UNSTATED, StartWork
from lagc.kernels.language.vocabulary import *

SLIGHT = (
    1.0 / 1024.0
)  # weight of the unknowns' magnitudes in the scale of a row, and of stated values in a step


def part_begin(i: int) -> int:
    """The index of the first partial derivative of equation i, or of a sum behind the equations."""
    return part_ends[i - 1] if i > 0 else 0


def assemble_slopes(J: Vec[NJ]) -> None:
    """Assemble J from partial derivatives by unknowns and shared sums, by the chain rule, last sum first."""
    parts = vector(NPARTS)
    for k in range(NPARTS):
        parts[k] = J[k]
    total = vector(NWHOLE)
    for j in range(NWHOLE):
        total[j] = 0.0
    made = 0
    stretch = 0
    for i in range(NCOND):
        first = part_begin(i)
        last = -1
        for k in range(first, part_ends[i]):
            total[part_column[k]] = parts[k]
            if part_column[k] - NU > last:
                last = part_column[k] - NU
        for n in range(last + 1):
            at = last - n
            slope = total[NU + at]
            total[NU + at] = 0.0
            if slope != 0.0:
                for k in range(part_begin(NCOND + at), part_ends[NCOND + at]):
                    total[part_column[k]] += slope * parts[k]
        while made < ends[i]:
            for j in range(stretch_begins[stretch], stretch_ends[stretch]):
                J[made] = total[j]
                total[j] = 0.0
                made += 1
            stretch += 1


def row_begin(i: int) -> int:
    """The index in J of the first derivative of equation i."""
    return ends[i - 1] if i > 0 else 0


def is_roundoff(k: int, w: StartWork) -> bool:
    """Whether derivative k is within its round-off estimate."""
    return 0.0 < fabs(w.J[k]) and fabs(w.J[k]) <= w.entry_roundoff[k]


def complete_row(i: int, y: Vec[NU], c: Vec[NE], J: Vec[NJ], sizes: Vec[NE]) -> None:
    """Complete equation i where it is that of a stated rate or of a unit quaternion."""
    if NRATE > 0:
        k = i - (NCOND - NRATE)
        if k >= 0 and k < NRATE:
            c[i] -= y[NQ + NV + k]
            sizes[i] += fabs(y[NQ + NV + k])
    if NQUAT > 0:
        if i >= NCOND:
            at = quaternion[i - NCOND]
            first = row_begin(i)
            c[i] = 0.5 * (square_at(y, at) - 1.0)
            sizes[i] = 1.0
            for j in range(4):
                J[first + j] = y[at + j]


def evaluate_all(p: Params, t: Real, y: Vec[NU], c: Vec[NE], J: Vec[NJ], sizes: Vec[NE]) -> None:
    """Evaluate residuals, Jacobian and term sizes of all equations."""
    if NCOND > 0:
        if NPIECE > 0:
            fn_conditions_some(p, t, y, c, J, sizes, 0, size(NPIECE))
        else:
            fn_conditions(p, t, y, c, J, sizes)
    if NSUM > 0:
        assemble_slopes(J)
    if NRATE > 0 or NQUAT > 0:
        for i in range(NCOND - NRATE, NE):
            complete_row(i, y, c, J, sizes)


def evaluate_rows(
    p: Params, t: Real, y: Vec[NU], c: Vec[NE], J: Vec[NJ], sizes: Vec[NE], w: StartWork
) -> None:
    """Evaluate the same of w.rows alone. Values of other rows may belong to another point."""
    if NPIECE > 0:
        fn_conditions_some(p, t, y, c, J, sizes, w.first_piece, w.end_piece)
        if NRATE > 0 or NQUAT > 0:
            for r in range(w.row_count):
                complete_row(w.rows[r], y, c, J, sizes)
    else:
        evaluate_all(p, t, y, c, J, sizes)


def set_scales(even: bool, w: StartWork) -> None:
    """Set w.step_scaling, by which a step prefers unstated unknowns to stated ones; even: the same for all
    unknowns of a unit."""
    for i in range(NU):
        if even:
            w.step_scaling[i] = w.unit_scaling[i]
        else:
            w.step_scaling[i] = w.scaling[i] if w.levels[i] == UNSTATED else SLIGHT * w.scaling[i]


def scale_rows(y: Vec[NU], J: Vec[NJ], sizes: Vec[NE], w: StartWork) -> None:
    """Set w.row_scaling and w.roundoff of w.rows at y: residuals count relative to the terms and to the
    change by a thousandth of the magnitudes of the unknowns; residuals below round-off count as zero."""
    for r in range(w.row_count):
        i = w.rows[r]
        slight = 0.0
        w.roundoff[i] = w.residual_roundoff[i]
        for k in range(row_begin(i), ends[i]):
            j = w.column[k]
            size = fabs(y[j])
            if w.free[j] == 1 and w.magnitude[j] > size:
                size = w.magnitude[j]
            slight += fabs(J[k]) * size
            w.roundoff[i] += w.slope_roundoff[k] * fabs(y[j])
            if r >= w.position_rows and j < NQ and w.free[j] == 0:
                w.roundoff[i] += fabs(J[k]) * FOUR_ULPS * w.unit_scaling[j]
        w.row_scaling[i] = sizes[i] + SLIGHT * slight


def relative_residual(value: Real, floor: Real, scale: Real) -> Real:
    """A residual relative to its scale, 0 below its round-off."""
    if fabs(value) <= floor:
        return 0.0
    return fabs(value) / scale if 0.0 < scale and scale < inf else inf


def residual_norm(c: Vec[NE], first: int, end: int, w: StartWork) -> Real:
    """The norm of the relative residuals of w.rows[first..end-1]; infinity if one is not a number."""
    total = 0.0
    for k in range(first, end):
        i = w.rows[k]
        size = relative_residual(c[i], w.roundoff[i], w.row_scaling[i])
        total += size * size
    return sqrt(total) if total == total else inf


def largest_residual(p: Params, t: Real, y: Vec[NU], end: int, w: StartWork) -> Real:
    """The largest relative residual of w.rows[..end-1] at y; infinity if one is not a number."""
    evaluate_rows(p, t, y, w.c, w.J, w.term_sizes, w)
    scale_rows(y, w.J, w.term_sizes, w)
    w.culprit = -1
    worst = 0.0
    for k in range(end):
        i = w.rows[k]
        size = relative_residual(w.c[i], w.roundoff[i], w.row_scaling[i])
        if not size <= worst:
            worst = size if size == size else inf
            w.culprit = i
            if worst == inf:
                break
    return worst


def has_speeds(i: int, w: StartWork) -> bool:
    """Whether equation i contains speeds."""
    for k in range(row_begin(i), ends[i]):
        if w.column[k] >= NQ:
            return True
    return False


def link_entries(w: StartWork) -> None:
    """Link the derivatives of w.rows by each unknown: from w.last on by w.previous; w.equation_of each."""
    for j in range(NU):
        w.last[j] = -1
    for r in range(w.row_count):
        i = w.rows[r]
        for k in range(row_begin(i), ends[i]):
            w.equation_of[k] = i
            w.previous[k] = w.last[w.column[k]]
            w.last[w.column[k]] = k


def visit(i: int, count: int, w: StartWork) -> int:
    """Append the new unknowns of equation i to w.ordered; return how many it holds."""
    w.chosen[i] = 1
    found = count
    for k in range(row_begin(i), ends[i]):
        j = w.column[k]
        if w.marks[j] == 0:
            w.marks[j] = 1
            w.ordered[found] = j
            found += 1
    return found


def order_unknowns(w: StartWork) -> None:
    """Set w.ordered: the unknowns of the rows such that coupled ones are near (E. Cuthill, J. McKee,
    1969)."""
    link_entries(w)
    for j in range(NU):
        w.marks[j] = 0
    for i in range(NE):
        w.chosen[i] = 0
    count = 0
    at = 0
    for r in range(w.row_count):
        if w.chosen[w.rows[r]] == 0:
            count = visit(w.rows[r], count, w)
        while at < count:
            k = w.last[w.ordered[at]]
            while k >= 0:
                if w.chosen[w.equation_of[k]] == 0:
                    count = visit(w.equation_of[k], count, w)
                k = w.previous[k]
            at += 1


def find_piece_range(w: StartWork) -> None:
    """Set the range of independently evaluated groups that the rows belong to."""
    w.first_piece = size(NPIECE)
    w.end_piece = 0
    for r in range(w.row_count):
        own = row_piece[w.rows[r]]
        if own >= 0 and own < w.first_piece:
            w.first_piece = own
        if own >= w.end_piece:
            w.end_piece = own + 1


def select_equations(n: Size, w: StartWork) -> None:
    """Select the n equations w.selected, equations of positions first, and their unknowns."""
    for i in range(NU):
        w.marks[i] = 0
    for i in range(n):
        for k in range(row_begin(w.selected[i]), ends[w.selected[i]]):
            w.marks[w.column[k]] = 1
    w.unknown_count = 0
    for i in range(NU):
        if w.marks[i] == 1:
            w.unknowns[w.unknown_count] = i
            w.unknown_count += 1
    w.row_count = 0
    for i in range(n):
        if not has_speeds(w.selected[i], w):
            w.rows[w.row_count] = w.selected[i]
            w.row_count += 1
    w.position_rows = w.row_count
    for i in range(n):
        if has_speeds(w.selected[i], w):
            w.rows[w.row_count] = w.selected[i]
            w.row_count += 1
    if NPIECE > 0:
        find_piece_range(w)
    order_unknowns(w)


def fill_columns(w: StartWork) -> None:
    """Set w.column, the unknown of each derivative."""
    n = 0
    for k in range(NSTRETCH):
        for j in range(stretch_begins[k], stretch_ends[k]):
            w.column[n] = j
            n += 1


def set_levels(levels: IVec[NU], w: StartWork) -> None:
    """Set the levels, one for each quaternion, and select all equations."""
    if present(levels):
        w.levels[:] = levels
    else:
        w.levels[:] = level
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
    for i in range(NU):
        w.free[i] = 1 if w.levels[i] == UNSTATED else 0
    fill_columns(w)
    for i in range(NE):
        w.selected[i] = i
    select_equations(NE, w)
    for i in range(NE):
        w.all_rows[i] = w.rows[i]
