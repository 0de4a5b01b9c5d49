"""State vectors: magnitudes and ranges of states, discrete variables.

A scaling group holds the coordinates, or the speeds, of one unit.  Errors of a state are scaled by the
largest magnitude in its group.  Group 0 holds coordinates without unit, such as angles.
Discrete variables are the last entries; clauses `when` alone change them.
"""

from math import fabs
from typing import Any

from lagc.kernels.language.model_tables import *
from lagc.kernels.language.records import State, Work
from lagc.kernels.language.sizes import NDISC, NGROUP, NINT, NQ, NSEARCH, NV, NX
from lagc.kernels.language.words import Size, Vec

# Share of the reach of a row in its scale: a row whose terms all vanish is scaled by it.
VANISHING_ROW = 1e-3


def enlarge_sizes(x: Vec[NX], sizes: Vec[NGROUP]) -> None:
    """Raise sizes[NGROUP] to the magnitudes of x."""
    for i in range(NQ + NV):
        if fabs(x[i]) > sizes[scaling_group[i]]:
            sizes[scaling_group[i]] = fabs(x[i])


def widen_ranges(x: Vec[NX], lowest: Vec[NX], highest: Vec[NX]) -> None:
    """Widen the ranges from lowest[NX] to highest[NX] to contain x."""
    for i in range(NX):
        if x[i] < lowest[i]:
            lowest[i] = x[i]
        if x[i] > highest[i]:
            highest[i] = x[i]


def not_finite(values: Vec[Any], n: Size) -> int:
    """Return the index of the first value that is infinite or NaN, or -1."""
    total = 0.0
    for i in range(n):
        total += values[i]
    if total - total == 0.0:
        return -1
    for i in range(n):
        if not values[i] - values[i] == 0.0:
            return i
    return -1


def enlarge_differences(one: Vec[NX], other: Vec[NX], apart: Vec[NX]) -> None:
    """Raise apart[NX] to the differences of two vectors of rates."""
    for i in range(NQ + NV):
        if fabs(one[i] - other[i]) > apart[i]:
            apart[i] = fabs(one[i] - other[i])


def keep_discrete(x: Vec[NX], other: Vec[NX]) -> None:
    """Copy the discrete variables of x, which a step does not change."""
    if NDISC > 0:
        for i in range(NDISC):
            other[NINT + i] = x[NINT + i]


def box_discrete(s: State, w: Work) -> None:
    """Store the discrete variables behind the ends of w.search.box."""
    if NDISC > 0:
        if NSEARCH > 0:
            for i in range(NDISC):
                w.search.box[2 * (NQ + NV) + 2 + i] = s.x[NINT + i]
