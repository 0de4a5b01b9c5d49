"""Scaling groups.

A scaling group holds the coordinates, or the speeds, of one unit.  Errors of a state are scaled by the
largest magnitude in its group.  Group 0 holds coordinates without unit, such as angles.
"""

from math import fabs
from typing import Any

from lagc.kernels.language.model_tables import *
from lagc.kernels.language.sizes import NGROUP, NQ, NV, NX
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
