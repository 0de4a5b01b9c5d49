"""Sizes.

States are judged by the largest magnitude of their kind: coordinates, or speeds, of one unit.
Kind 0 are the coordinates that are numbers, as angles are.
"""

from __future__ import annotations

from math import fabs
from typing import Any

from lagc.kernels.language.sizes import NGROUP, NQ, NV, NX
from lagc.kernels.language.tables import group
from lagc.kernels.language.words import Size, Vec

# Of the change of a row over the sizes of states: a row whose terms vanish is judged by it.
VANISHING_ROW = 1e-3


def enlarge_sizes(x: Vec[NX], sizes: Vec[NGROUP]) -> None:
    """sizes[NGROUP] become at least those of x."""
    for i in range(NQ + NV):
        if fabs(x[i]) > sizes[group[i]]:
            sizes[group[i]] = fabs(x[i])


def not_finite(values: Vec[Any], n: Size) -> int:
    """The index of the first value that is infinite or not a number; -1."""
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
    """apart[NX] become at least how far rates are apart."""
    for i in range(NQ + NV):
        if fabs(one[i] - other[i]) > apart[i]:
            apart[i] = fabs(one[i] - other[i])
