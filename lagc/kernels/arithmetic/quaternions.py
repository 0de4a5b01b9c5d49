"""Unit quaternions."""

from math import fabs, inf, sqrt
from typing import Any

from lagc.kernels.language.vocabulary import *

# Bounds of squared lengths that neither underflow nor overflow.
LEAST_SQUARE = by_type(1e-25, 1e-200, "1e-3000")
MOST_SQUARE = by_type(1e25, 1e200, "1e3000")


def square_at(x: Vec[Any], k: int) -> Real:
    """Return the squared length of the quaternion at x[k]."""
    return x[k] * x[k] + x[k + 1] * x[k + 1] + x[k + 2] * x[k + 2] + x[k + 3] * x[k + 3]


def normalise(x: Vec[Any]) -> None:
    """Normalize each quaternion in x. One that is zero or not finite is not changed."""
    for n in range(NQUAT):
        k = quaternion[n]
        square = square_at(x, k)
        # Squares that would underflow or overflow: the largest entry is divided out first.
        if not (LEAST_SQUARE < square and square < MOST_SQUARE):
            largest = 0.0
            for i in range(k, k + 4):
                if not fabs(x[i]) <= largest:
                    largest = fabs(x[i])
            if not (0.0 < largest and largest < inf):
                continue
            for i in range(k, k + 4):
                x[i] = x[i] / largest
            square = square_at(x, k)
        length = sqrt(square)
        for i in range(k, k + 4):
            x[i] = x[i] / length
