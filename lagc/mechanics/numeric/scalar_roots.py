"""Where a function of one argument crosses zero or touches it, as far as a scan sees."""

from __future__ import annotations

import math
from collections.abc import Callable

from lagc.base.records import dataclass

Function = Callable[[float], float]

_WAYS = tuple([2.0**k for k in (*range(-6, 13), *range(16, 65, 4))])  # sizes from the start
_PARTS = 8  # of a period
_MOST = 3  # zeros, the nearest ones
_TOUCHES = 1e-9  # of what it is beside: a minimum that is zero
_BESIDE = 1e-6
_NEARS = 0.05  # of it, after some sections
_SOME, _SECTIONS = 14, 66
_GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


@dataclass(frozen=True, slots=True)
class Zero:
    """`reach`: how far its neighbours on the scan are away; `crosses`: the sign changes there."""

    at: float
    reach: float
    crosses: bool


def zeros(value: Function, start: float, size: float, period: float = math.inf) -> list[Zero]:
    """Those of `value` that are nearest to `start`; where it has a `period`, within that."""
    ways = [way * size for way in _WAYS]
    if period < math.inf:
        even = [k * period / _PARTS for k in range(1, _PARTS + 2)]
        ways = [*(way for way in ways if way < even[0]), *even]
    points = sorted([start, *(start + sign * way for way in ways for sign in (1.0, -1.0))])
    values = [value(x) for x in points]
    found: list[Zero] = []
    for k in range(1, len(points) - 1):
        before, here, after = values[k - 1 : k + 2]
        if here == 0.0 and before != 0.0 != after:
            found.append(Zero(points[k], points[k + 1] - points[k], before * after < 0.0))
        elif before * here < 0.0:
            at = _bisected(value, points[k - 1], points[k])
            found.append(Zero(at, points[k] - points[k - 1], True))
        elif before * here > 0.0 and here * after > 0.0 and abs(before) >= abs(here) <= abs(after):
            low = min(abs(before), abs(after))
            at = _lowest(value, points[k - 1], points[k + 1], _NEARS * low)
            if abs(value(at)) <= _TOUCHES * low:
                reach = points[k] - points[k - 1]  # where it may cross zero twice
                sides = value(at - _BESIDE * reach) * value(at + _BESIDE * reach)
                found.append(Zero(at, reach, sides < 0.0))
    found.sort(key=lambda zero: abs(zero.at - start))
    return found[:_MOST]


def _bisected(value: Function, a: float, b: float) -> float:
    low = value(a)
    for _ in range(200):
        middle = 0.5 * (a + b)
        if middle in (a, b):
            break
        found = value(middle)
        if found == 0.0:
            return middle
        a, b = (middle, b) if low * found > 0.0 else (a, middle)
    return 0.5 * (a + b)


def _lowest(value: Function, a: float, b: float, near: float) -> float:
    """The argument of the least |value| in (a, b), by golden sections, as long as it nears zero."""

    def size(x: float) -> float:
        found = abs(value(x))
        return math.inf if math.isnan(found) else found

    left, right = b - _GOLDEN * (b - a), a + _GOLDEN * (b - a)
    f, g = size(left), size(right)
    for k in range(_SECTIONS):
        if k == _SOME and min(f, g) > near:
            break
        if f <= g:
            b, right, g = right, left, f
            left = b - _GOLDEN * (b - a)
            f = size(left)
        else:
            a, left, f = left, right, g
            right = a + _GOLDEN * (b - a)
            g = size(right)
    return left if f <= g else right
