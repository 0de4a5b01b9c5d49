"""Long runs: what accumulates and what must not.  Where there is no C compiler the runs are shorter."""

from __future__ import annotations

import math

import numpy
import pytest

import lagc
from lagc.simulation.backends.compile import compiler

FAST = compiler() is not None
BACKEND = "c" if FAST else "numpy"


@pytest.mark.full
def test_cartesian_pendulum_over_many_periods() -> None:
    # 90 degrees, l = 0.5 m: the period is 4 K(1/2) sqrt(l/g)
    period = 4.0 * 1.854074677301372 * math.sqrt(0.5 / 9.81)
    periods = 2000 if FAST else 50
    system = lagc.load("course/string_pendulum").compile(backend=BACKEND)
    run = system.simulate(
        periods * period, method="dop853", rtol=1e-12, atol=1e-12, points=2, starts={"x": 0.5, "z": 0.0}
    )
    assert run.status == "ok", run.message
    assert run.position_drift <= 1e-15
    assert run.velocity_drift <= 1e-15
    # 1e-7 over 1e5 periods (of m g l = 4.9 J); it grows linearly
    assert abs(run.energy.imbalance) <= 1e-7 * 9.81 * 0.5 * periods / 2000.0
    final = run.final
    assert math.isclose(final["x"], 0.5, rel_tol=1e-6)


def test_sleigh_runs_straight_for_half_an_hour() -> None:
    m, inertia, a, v0, w0, stop = 1.0, 0.1, 0.2, 0.3, 3.0, 2000.0
    run = lagc.load("classic/chaplygin_sleigh").compile().simulate(stop, accuracy=1e-9, points=2)
    assert run.status == "ok", run.message
    assert run.velocity_drift <= 1e-15
    # v = V tanh(k (t - t0)), w = (V/c) sech(k (t - t0)), theta the Gudermannian
    c = math.sqrt((inertia + m * a * a) / m)
    top = math.hypot(v0, c * w0)
    k = a * top / c**2
    t0 = -math.atanh(v0 / top) / k
    heading = (c / a) * (math.pi / 2.0 - math.atan(math.sinh(-k * t0)))  # of the last straight
    final = run.final
    assert abs(final["v"] - top) <= 1e-8 * top
    assert abs(final["theta"] - heading) <= 1e-8
    from scipy.integrate import quad

    def path(component: int) -> float:
        def rate(t: float) -> float:
            theta = (c / a) * (math.atan(math.sinh(k * (t - t0))) - math.atan(math.sinh(-k * t0)))
            return top * math.tanh(k * (t - t0)) * (math.cos(theta), math.sin(theta))[component]

        near: float = quad(rate, 0.0, 30.0, epsabs=1e-12, epsrel=1e-12, limit=500)[0]
        return near + top * (stop - 30.0) * (math.cos(heading), math.sin(heading))[component]

    distance = top * stop
    assert abs(final["x"] - path(0)) <= 1e-8 * distance
    assert abs(final["y"] - path(1)) <= 1e-8 * distance


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", ["euler_top", "racket_flip"])
def test_free_solid_over_ten_thousand_turns(name: str) -> None:
    turns = 10_000 if FAST else 100
    stop = turns * 2.0 * math.pi / 1.2  # the body turns with 1.15 to 1.26 rad/s
    system = lagc.load(f"classic/{name}").compile(backend=BACKEND)
    run = system.simulate(stop, method="dop853", rtol=1e-15, atol=1e-15, points=501)
    assert run.status == "ok", run.message
    states = numpy.array([run[f"o.{i}"] for i in "wxyz"])
    assert abs(numpy.sqrt((states**2).sum(axis=0)) - 1.0).max() <= 1e-15
    assert abs(run.energy.imbalance) <= 1e-10
    w, x, y, z = states
    l1, l2, l3 = 3.0 * run["w1"], 2.0 * run["w2"], 1.0 * run["w3"]
    momentum = [
        (1 - 2 * (y * y + z * z)) * l1 + 2 * (x * y - w * z) * l2 + 2 * (x * z + w * y) * l3,
        2 * (x * y + w * z) * l1 + (1 - 2 * (x * x + z * z)) * l2 + 2 * (y * z - w * x) * l3,
        2 * (x * z - w * y) * l1 + 2 * (y * z + w * x) * l2 + (1 - 2 * (x * x + y * y)) * l3,
    ]
    size = numpy.sqrt(sum(component**2 for component in momentum))
    assert numpy.ptp(size) <= 1e-10
    for component in momentum:  # in space: the attitude error of the run adds to it
        assert numpy.ptp(component) <= 1e-9
