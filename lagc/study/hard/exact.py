"""Independent solutions, in closed form or in long arithmetic, to compare runs with."""

from collections.abc import Sequence
from decimal import Decimal, localcontext
from math import pi, sqrt
from operator import mul

import numpy as np

DIGITS = 50
BITS, ORDER = 128, 30


def sine_cosine(angle: Decimal) -> tuple[Decimal, Decimal]:
    """sin and cos by their series, for angles of a few radians."""
    term, sums, k = Decimal(1), [Decimal(0), Decimal(0), Decimal(0), Decimal(0)], 0
    while term and abs(term) > Decimal(10) ** -DIGITS:
        sums[k % 4] += term
        k += 1
        term = term * angle / k
    return sums[1] - sums[3], sums[0] - sums[2]


def chain_accelerations(
    angles: Sequence[float], rates: Sequence[float], masses: Sequence[float], link: float, g: float
) -> list[float]:
    """th'' of a chain of bobs on massless links in 50 digits, without a mass matrix.

    The tensions S_i solve the tridiagonal system that says that each link keeps its length,

        S_(i-1) c_i / m_(i-1) - S_i (1/m_(i-1) + 1/m_i) + S_(i+1) c_(i+1) / m_i = -l th_i'^2,

    with c_i = cos(th_i - th_(i-1)); the part of the difference of two bobs' accelerations across a link is
    l th_i''.
    """
    with localcontext() as context:
        context.prec = DIGITS
        a, w, m = ([Decimal(x) for x in values] for values in (angles, rates, masses))
        length, gravity, n = Decimal(link), Decimal(g), len(angles)
        turns = [sine_cosine(a[i] - a[i - 1]) for i in range(1, n)]  # sin and cos between links
        # The system: diagonal and right-hand side. The first link also carries gravity along itself.
        diagonal = [-(1 / m[i] + (1 / m[i - 1] if i else 0)) for i in range(n)]
        right = [-length * w[i] * w[i] for i in range(n)]
        sine, cosine = sine_cosine(a[0])
        right[0] -= gravity * cosine
        # Forward elimination, then back substitution (L. H. Thomas).
        for i in range(1, n):  # the coupling of the rows i - 1 and i is c_i/m_(i-1)
            coupling = turns[i - 1][1] / m[i - 1]
            factor = coupling / diagonal[i - 1]
            diagonal[i] -= factor * coupling
            right[i] -= factor * right[i - 1]
        tension = [Decimal(0)] * n
        for i in reversed(range(n)):
            above = turns[i][1] / m[i] * tension[i + 1] if i + 1 < n else 0
            tension[i] = (right[i] - above) / diagonal[i]
        # Across a link act gravity, on the first alone since all bobs fall alike, and the tensions of its
        # neighbours.
        turn = [Decimal(0)] * n
        turn[0] = -gravity * sine
        for i in range(1, n):
            turn[i - 1] += tension[i] * turns[i - 1][0] / m[i - 1]
            turn[i] -= tension[i - 1] * turns[i - 1][0] / m[i - 1]
        return [float(t / length) for t in turn]


def double_pendulum(t: float, g: float = 9.81) -> tuple[float, float]:
    """The angles at t of two equal pendulums of length 1 m that start at rest from 90 deg each.

    By Taylor series in fixed point of 128 bits: what a motion in double precision loses by rounding alone
    (differences grow tenfold every 3 s) is not lost here.
    """
    left, gravity = int(t * 2**64) << BITS - 64, round(g * 100) * 2**BITS // 100
    one = 1 << BITS
    quarter = _half_pi()
    now = [quarter, quarter, 0, 0]
    turned = [(one, 0), (one, 0)]  # sin and cos of both angles
    while left > 0:
        series = _series(now, turned, gravity)
        last = max(abs(x) for f in series[0][2:] for x in f[-2:])  # from rest every other one is zero
        h = min(left, int(0.15 * (one / last) ** (1.0 / ORDER) * one))  # the last term is 1e-24 or so
        left -= h
        now = [_value(f, h) for f in series[0]]
        turned = [(_value(s, h), _value(c, h)) for s, c in series[1]]
    return now[0] / one, now[1] / one


def _half_pi() -> int:
    """pi/2 by Machin's formula."""

    def arctangent(x: int) -> int:
        term = total = (1 << BITS + 16) // x
        k, sign = 1, 1
        while term:
            term //= x * x
            k, sign = k + 2, -sign
            total += sign * (term // k)
        return total

    # pi/4 = 4 arctan(1/5) - arctan(1/239), with 16 bits that are cut off at the end.
    return (8 * arctangent(5) - 2 * arctangent(239)) >> 16


def _value(f: list[int], h: int) -> int:
    total = 0
    for a in reversed(f):
        total = a + (total * h >> BITS)
    return total


def _times(f: list[int], e: list[int]) -> int:
    """The next coefficient of the product."""
    total: int = sum(map(mul, f, reversed(e[: len(f)])))
    return total >> BITS


def _extend(angle: list[int], sine: list[int], cosine: list[int], k: int) -> None:
    """The coefficient k of sin and cos."""
    rates = [j * angle[j] for j in range(1, k + 1)]
    s, c = _times(rates, cosine), _times(rates, sine)
    sine.append(s // k)
    cosine.append(-c // k)


def _series(
    now: list[int], turned: list[tuple[int, int]], g: int
) -> tuple[list[list[int]], list[tuple[list[int], list[int]]]]:
    """The Taylor coefficients of both angles and rates, and of the sines and cosines of the angles."""
    a, b, u, v = ([x] for x in now)
    (s1, c1), (s2, c2) = turned
    sa, ca, sb, cb = [s1], [c1], [s2], [c2]
    between, s, c = [now[0] - now[1]], [(s1 * c2 - c1 * s2) >> BITS], [(c1 * c2 + s1 * s2) >> BITS]
    uu: list[int] = []
    vv: list[int] = []
    p: list[int] = []
    q: list[int] = []
    d: list[int] = []
    du: list[int] = []
    dv: list[int] = []
    # u, v are the rates. 2 u' + c v' = p and c u' + v' = q, with c, s = cos, sin(a - b), p = -v^2 s - 2 g
    # sin a and q = u^2 s - g sin b; so d u' = p - c q and d v' = 2 q - c p with d = 2 - c^2. Coefficient k
    # of a quotient follows from those before it (R. E. Moore, 1966).
    for k in range(ORDER):
        uu.append(_times(u, u))
        vv.append(_times(v, v))
        p.append(-_times(vv, s) - (2 * g * sa[k] >> BITS))
        q.append(_times(uu, s) - (g * sb[k] >> BITS))
        d.append((2 << BITS if k == 0 else 0) - _times(c, c))
        for rates, top in ((du, p[k] - _times(c, q)), (dv, 2 * q[k] - _times(c, p))):
            rest = sum(map(mul, rates, reversed(d[1:]))) >> BITS
            rates.append(((top - rest) << BITS) // d[0])
        for f, rate in ((a, u[k]), (b, v[k]), (u, du[k]), (v, dv[k])):
            f.append(rate // (k + 1))
        between.append(a[-1] - b[-1])
        for angle, sine, cosine in ((a, sa, ca), (b, sb, cb), (between, s, c)):
            _extend(angle, sine, cosine, k + 1)
    return [a, b, u, v], [(sa, ca), (sb, cb)]


def kepler_orbit(t: np.ndarray, e: float) -> list[np.ndarray]:
    """x, y, x', y' of the orbit with mu = a = 1 from the pericentre, by Newton on Kepler's equation."""
    mean = np.remainder(t, 2.0 * pi)
    anomaly = mean + e * np.sin(mean) / (1.0 - e + e * abs(mean - pi))  # any guess serves
    for _ in range(200):
        step = (anomaly - e * np.sin(anomaly) - mean) / (1.0 - e * np.cos(anomaly))
        anomaly = anomaly - np.clip(step, -0.5, 0.5)
    root, rate = sqrt(1.0 - e * e), 1.0 / (1.0 - e * np.cos(anomaly))
    return [np.cos(anomaly) - e, root * np.sin(anomaly), -np.sin(anomaly) * rate,
            root * np.cos(anomaly) * rate]  # fmt: skip
