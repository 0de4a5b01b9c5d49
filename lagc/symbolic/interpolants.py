"""Functions of one argument through points.

Between two knots each is a polynomial of the way from the left one, whose coefficients are looked up.  Before
the first knot and behind the last it holds the value there, or goes on straight with the slope it has.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from math import inf, nextafter

from lagc.host import cache
from lagc.symbolic.graph import Node
from lagc.symbolic.leaves import Curve, Table, digest

Numbers = Sequence[float]


def key_of(knots: Numbers, values: Numbers, kind: str, straight: bool) -> str:
    """Stands for an interpolant."""
    return cache.key(kind, str(straight), digest(knots), digest(values))


def interpolant(x: Node, knots: Numbers, values: Numbers, kind: str, straight: bool, name: str) -> Node:
    """The function of `kind`, one of KINDS, of x through the points, two at least, `knots` in order;
    `straight`: as it goes on beyond them.  Raises OverflowError where a coefficient is no number."""
    graph, curve = x.graph, Curve(name, key_of(knots, values, kind, straight))
    ends, *coefficients = KINDS[kind](knots, values)
    # What is before the first knot is a piece of its own, of as many coefficients.
    first, last = ([values[end], 0.0, 0.0, 0.0] for end in (0, -1))
    if straight and kind != "held":
        first[1], last[1] = coefficients[1][0], coefficients[1][-1]
    for k, row in enumerate(coefficients):
        curve.rows.append(Table([first[k], *row[: len(ends) - 1], last[k]], curve, k))
    if not all(c - c == 0.0 for row in curve.rows for c in row):
        raise OverflowError
    begins = Table([ends[0], *ends])
    place = graph.looked_up("piece", begins, x)
    way = x - graph.looked_up("entry", begins, place)
    total = graph.zero
    for table in reversed(curve.rows):
        total = total * way + graph.looked_up("entry", table, place)
    return total


def _held(knots: Numbers, values: Numbers) -> tuple[Numbers, ...]:
    """From each knot on its value; a knot where that is the same is none."""
    kept = [k for k in range(len(knots)) if k == 0 or values[k] != values[k - 1]]
    return [knots[k] for k in kept], [values[k] for k in kept]


def _linear(knots: Numbers, values: Numbers) -> tuple[Numbers, ...]:
    slopes = _slopes(knots, values)
    return _closed(knots), values, [*slopes, slopes[-1]]


def _cubic(knots: Numbers, values: Numbers) -> tuple[Numbers, ...]:
    """The spline with a continuous second derivative, whose third is too at the second knot and the last but
    one ("not a knot"): through three points it is the parabola.  C. de Boor, *A Practical Guide to Splines*,
    Springer 1978, chapter IV."""
    h, m = [b - a for a, b in pairwise(knots)], _slopes(knots, values)
    s = _spline_slopes(h, m)
    second = [(3.0 * m[k] - 2.0 * s[k] - s[k + 1]) / h[k] for k in range(len(h))]
    third = [(s[k] + s[k + 1] - 2.0 * m[k]) / h[k] / h[k] for k in range(len(h))]
    return _closed(knots), values, s, second, third


def _closed(knots: Numbers) -> Numbers:
    """The last knot belongs to the piece before it, as a run that ends there asks for no other."""
    return [*knots[:-1], nextafter(knots[-1], inf)]


KINDS: dict[str, Callable[[Numbers, Numbers], tuple[Numbers, ...]]] = {
    "held": _held, "linear": _linear, "cubic": _cubic,
}  # fmt: skip


def _slopes(knots: Numbers, values: Numbers) -> list[float]:
    return [(d - c) / (b - a) for (a, b), (c, d) in zip(pairwise(knots), pairwise(values))]


def _spline_slopes(h: Numbers, m: Numbers) -> list[float]:
    """The slopes at the knots, of ways h and mean slopes m between them: a tridiagonal system, eliminated
    from the left, where every pivot is positive."""
    n = len(h)
    if n == 1:
        return [m[0], m[0]]
    if n == 2:
        bend = (m[1] - m[0]) / (h[0] + h[1])
        return [m[0] - bend * h[0], m[0] + bend * h[0], m[1] + bend * h[1]]
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
