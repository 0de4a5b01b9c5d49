"""Quaternions of unit length."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, sqrt

# -- what follows is part of generated modules --


def with_unit_length(x: list[float], quaternions: Sequence[int]) -> None:
    """Unit length for the quaternion at each index; one that is zero or not finite is left."""
    for k in quaternions:
        a, b, c, d = x[k : k + 4]
        square = a * a + b * b + c * c + d * d
        if not 1e-200 < square < 1e200:
            largest = 0.0
            for part in (a, b, c, d):
                if not abs(part) <= largest:
                    largest = abs(part)
            if not 0.0 < largest < inf:
                continue
            a, b, c, d = a / largest, b / largest, c / largest, d / largest
            square = a * a + b * b + c * c + d * d
        length = sqrt(square)
        x[k : k + 4] = [a / length, b / length, c / length, d / length]
