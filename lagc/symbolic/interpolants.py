"""Interpolation of functions of one argument through points.

Between two knots the function is a polynomial in the distance from the left knot, with coefficients from a
table. Outside of the knots it is constant or linear.
"""

from collections.abc import Callable, Sequence
from itertools import pairwise
from math import inf, nextafter

from lagc.host import cache
from lagc.symbolic.graph import Node
from lagc.symbolic.leaves import Curve, Table, digest

Numbers = Sequence[float]


def key_of(knots: Numbers, values: Numbers, kind: str, straight: bool) -> str:
    """Return a key of the points and the interpolation."""
    return cache.key(kind, str(straight), digest(knots), digest(values))


def interpolant(x: Node, knots: Numbers, values: Numbers, kind: str, straight: bool, name: str) -> Node:
    """Return the function of x through at least two points with increasing `knots`; `kind` is one of KINDS.
    With `straight` it is continued linearly, else as a constant.  Raises OverflowError if a coefficient is
    not finite."""
    graph, curve = x.graph, Curve(name, key_of(knots, values, kind, straight))
    ends, *coefficients = KINDS[kind](knots, values)
    # There is one more piece before the first knot.
    first, last = ([values[end], 0.0, 0.0, 0.0] for end in (0, -1))
    if straight and kind != "held":
        first[1], last[1] = coefficients[1][0], coefficients[1][-1]
    for k, row in enumerate(coefficients):
        curve.rows.append(Table([first[k], *row[: len(ends) - 1], last[k]], curve, k))
    if not all(c - c == 0.0 for row in curve.rows for c in row):
        raise OverflowError
    begins = Table([ends[0], *ends])
    place = graph.looked_up("piece", begins, x)
    offset = x - graph.looked_up("entry", begins, place)
    total = graph.zero
    for table in reversed(curve.rows):
        total = total * offset + graph.looked_up("entry", table, place)
    return total


def _constant_pieces(knots: Numbers, values: Numbers) -> tuple[Numbers, ...]:
    """Return a step function with the value of each knot up to the next; knots without a change are
    dropped."""
    kept = [k for k in range(len(knots)) if k == 0 or values[k] != values[k - 1]]
    return [knots[k] for k in kept], [values[k] for k in kept]


def _linear(knots: Numbers, values: Numbers) -> tuple[Numbers, ...]:
    slopes = _slopes(knots, values)
    return _closed(knots), values, [*slopes, slopes[-1]]


def _cubic(knots: Numbers, values: Numbers) -> tuple[Numbers, ...]:
    """Return the cubic spline with the not-a-knot condition; through three points it is the parabola. C. de
    Boor, *A Practical Guide to Splines*, Springer 1978, chapter IV."""
    h, m = [b - a for a, b in pairwise(knots)], _slopes(knots, values)
    s = _spline_slopes(h, m)
    second = [(3.0 * m[k] - 2.0 * s[k] - s[k + 1]) / h[k] for k in range(len(h))]
    third = [(s[k] + s[k + 1] - 2.0 * m[k]) / h[k] / h[k] for k in range(len(h))]
    return _closed(knots), values, s, second, third


def _closed(knots: Numbers) -> Numbers:
    """Move the last knot up to the next float, so that it belongs to the piece before it."""
    return [*knots[:-1], nextafter(knots[-1], inf)]


KINDS: dict[str, Callable[[Numbers, Numbers], tuple[Numbers, ...]]] = {
    "held": _constant_pieces, "linear": _linear, "cubic": _cubic,
}  # fmt: skip


def _slopes(knots: Numbers, values: Numbers) -> list[float]:
    return [(d - c) / (b - a) for (a, b), (c, d) in zip(pairwise(knots), pairwise(values))]


def _spline_slopes(h: Numbers, m: Numbers) -> list[float]:
    """Return the slopes at the knots, given distances h and mean slopes m. The tridiagonal system is
    eliminated from the left; all pivots are positive."""
    n = len(h)
    if n == 1:
        return [m[0], m[0]]
    if n == 2:
        curvature = (m[1] - m[0]) / (h[0] + h[1])
        return [m[0] - curvature * h[0], m[0] + curvature * h[0], m[1] + curvature * h[1]]
    # Continuous second derivatives at inner knots, and one cubic over the two pieces at each end.
    ends = h[0] + h[1], h[-2] + h[-1]
    pivots, upper = [h[1]], [ends[0], *h[:-1]]
    right = [((h[0] + 2.0 * ends[0]) * h[1] * m[0] + h[0] * h[0] * m[1]) / ends[0]]
    for k in range(1, n):
        factor = h[k] / pivots[-1]
        pivots.append(2.0 * (h[k - 1] + h[k]) - factor * upper[k - 1])
        right.append(3.0 * (h[k] * m[k - 1] + h[k - 1] * m[k]) - factor * right[-1])
    last = (h[-1] * h[-1] * m[-2] + (2.0 * ends[1] + h[-1]) * h[-2] * m[-1]) / ends[1]
    factor = ends[1] / pivots[-1]
    s = [(last - factor * right[-1]) / (h[-2] - factor * upper[-1])]
    for k in range(n - 1, -1, -1):
        s.append((right[k] - upper[k] * s[-1]) / pivots[k])
    return s[::-1]
