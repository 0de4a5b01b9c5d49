"""The error that a run reports is its error; if none can be estimated, the run says so."""

from __future__ import annotations

import math
import random
from operator import mul

import mpmath
import numpy
import pytest

import lagc


def _kepler(t: numpy.ndarray, e: float) -> tuple[numpy.ndarray, ...]:
    """x, y, x', y' of the orbit with mu = a = 1 from the pericentre, by Newton on Kepler's equation."""
    mean = numpy.remainder(t, 2.0 * math.pi)
    anomaly = mean + e * numpy.sin(mean) / (1.0 - e + e * abs(mean - math.pi))  # any guess serves
    for _ in range(200):
        step = (anomaly - e * numpy.sin(anomaly) - mean) / (1.0 - e * numpy.cos(anomaly))
        anomaly = anomaly - numpy.clip(step, -0.5, 0.5)
    root, rate = math.sqrt(1.0 - e * e), 1.0 / (1.0 - e * numpy.cos(anomaly))
    return (
        numpy.cos(anomaly) - e,
        root * numpy.sin(anomaly),
        -numpy.sin(anomaly) * rate,
        root * numpy.cos(anomaly) * rate,
    )


@pytest.mark.sample(1)
@pytest.mark.parametrize("accuracy", [1e-4, 1e-6, 1e-8, 1e-9])
def test_reported_error_of_kepler_is_the_true_one(accuracy: float) -> None:
    run = lagc.load("classic/kepler").compile("comet").simulate(20.0 * math.pi, accuracy=accuracy)
    assert run.status == "ok", run.message
    exact = _kepler(run.t, 0.9)
    found = [run[n] for n in ("x", "y", "der(x)", "der(y)")]
    scales = [max(abs(found[0]).max(), abs(found[1]).max())] * 2
    scales += [max(abs(found[2]).max(), abs(found[3]).max())] * 2
    true = max(float(abs(f - x).max()) / s for f, x, s in zip(found, exact, scales))
    assert run.estimated is not None
    assert true <= accuracy
    assert true / 2.0 <= run.estimated <= max(2.0 * true, accuracy)
    assert true <= run.estimated * 2.0


def _double_pendulum(t: float) -> tuple[float, float]:
    """The angles from 90 deg at rest, by Taylor series in fixed point of 128 bits: what a motion in double
    precision loses by rounding alone (differences grow tenfold every 3 s) is not lost here."""
    bits, order = 128, 30
    left, g = int(t * 2**64) * 2 ** (bits - 64), 981 * 2**bits // 100

    def times(f: list[int], e: list[int]) -> int:  # the next coefficient of the product
        return sum(map(mul, f, reversed(e[: len(f)]))) >> bits

    def turned(angle: list[int], sine: list[int], cosine: list[int], k: int) -> None:
        rates = [j * angle[j] for j in range(1, k + 1)]
        s, c = times(rates, cosine), times(rates, sine)
        sine.append(s // k)
        cosine.append(-c // k)

    def value(f: list[int], h: int) -> int:
        total = 0
        for a in reversed(f):
            total = a + (total * h >> bits)
        return total

    with mpmath.workdps(40):
        one = mpmath.mpf(2) ** bits
        now = [int(mpmath.pi / 2 * one)] * 2 + [0, 0]
        while left > 0:
            a, b, u, v = ([x] for x in now)
            between = [now[0] - now[1]]
            angles = [(f, [int(mpmath.sin(f[0] / one) * one)], [int(mpmath.cos(f[0] / one) * one)])
                      for f in (a, b, between)]  # fmt: skip
            (_, sa, _), (_, sb, _), (_, s, c) = angles
            uu: list[int] = []
            vv: list[int] = []
            p: list[int] = []
            q: list[int] = []
            d: list[int] = []
            du: list[int] = []
            dv: list[int] = []
            for k in range(order):
                uu.append(times(u, u))
                vv.append(times(v, v))
                p.append(-times(vv, s) - (2 * g * sa[k] >> bits))
                q.append(times(uu, s) - (g * sb[k] >> bits))
                d.append((2 << bits if k == 0 else 0) - times(c, c))
                for rates, top in ((du, p[k] - times(c, q)), (dv, 2 * q[k] - times(c, p))):
                    rest = sum(map(mul, rates, reversed(d[1:]))) >> bits
                    rates.append(((top - rest) << bits) // d[0])
                for f, rate in ((a, u[k]), (b, v[k]), (u, du[k]), (v, dv[k])):
                    f.append(rate // (k + 1))
                between.append(a[-1] - b[-1])
                for angle, sine, cosine in angles:
                    turned(angle, sine, cosine, k + 1)
            last = max(abs(x) for f in (u, v) for x in f[-2:])  # from rest every other one is zero
            radius = float((one / last) ** (mpmath.mpf(1) / order))
            h = min(left, int(0.15 * radius * one))  # the last term is 1e-24 or so
            left -= h
            now = [value(f, h) for f in (a, b, u, v)]
    return float(now[0] / one), float(now[1] / one)


@pytest.mark.full
def test_chaotic_motion_is_told_only_as_far_as_it_can_be_known() -> None:
    run = lagc.load("classic/double_pendulum").compile("chaotic").simulate(100.0, accuracy=1e-6)
    assert run.status != "ok"
    assert "predictable" in run.message
    horizon = run.times[-1]
    assert 5.0 < horizon < 60.0
    exact = _double_pendulum(horizon)  # up to the horizon the points are right
    for name, value in zip(("theta1", "theta2"), exact):
        assert abs(run[name][-1] - value) <= 1e-6 * max(abs(run["theta1"]).max(), abs(run["theta2"]).max())


@pytest.mark.sample(1)
@pytest.mark.parametrize("method", ["dop853", "dopri5"])
def test_what_has_settled_stays_where_tolerances_are_below_rounding(method: str) -> None:
    """Steps there are as long as the method is stable. Errors are some 50 times the tolerance, if above
    round-off: ten times the round-off of a rate counts over a step, estimated one Euler step ahead."""
    chance = random.Random(3)
    for _ in range(12):
        stiffness, tolerance = 10.0 ** chance.uniform(0.0, 3.0), 10.0 ** chance.uniform(-14.0, -12.0)
        damping = 2.0 * math.sqrt(stiffness) * 10.0 ** chance.uniform(-0.7, 0.7)
        system = lagc.loads(f"""model Settles
          coordinate Length x;
          body b = Particle(mass = 1 [kg], at = {{x, 0, 0}});
          force f = {{2 [N] - ({stiffness!r} [N/m])*x - ({damping!r} [N.s/m])*der(x), 0, 0}} at b;
        end Settles;""").compile(backend="numpy")
        slowest = min(damping / 2.0, stiffness / damping)
        run = system.simulate(100.0 / slowest, method=method, rtol=tolerance)
        late = run.t > 40.0 / slowest  # exp(-40) is below rounding
        most = 600.0 * max(tolerance, 3e-13)
        assert late.any() and abs(run["x"][late] * stiffness / 2.0 - 1.0).max() < most
        assert abs(run["der(x)"][late]).max() < most * abs(run["der(x)"]).max()
