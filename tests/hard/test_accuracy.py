"""The error that a run reports is its error; if none can be estimated, the run says so."""

import math
import random

import numpy
import pytest
from scipy.integrate import solve_ivp

import lagc
from lagc.study.hard.exact import double_pendulum, kepler_orbit


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


def test_the_independent_solutions_are_right() -> None:
    """Against SciPy's DOP853 on equations of their own."""

    def pendulum(t: float, x: numpy.ndarray) -> list[float]:
        a, b, u, v = x
        s, c = math.sin(a - b), math.cos(a - b)
        p, q = -v * v * s - 2.0 * 9.81 * math.sin(a), u * u * s - 9.81 * math.sin(b)
        return [u, v, (p - c * q) / (2.0 - c * c), (2.0 * q - c * p) / (2.0 - c * c)]

    def orbit(t: float, x: numpy.ndarray) -> list[float]:
        cube = math.hypot(x[0], x[1]) ** 3
        return [x[2], x[3], -x[0] / cube, -x[1] / cube]

    given = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-13}
    found = solve_ivp(pendulum, (0.0, 1.5), [math.pi / 2, math.pi / 2, 0.0, 0.0], **given).y[:, -1]
    assert double_pendulum(1.5) == pytest.approx(found[:2], abs=1e-9)
    start = [1.0 - 0.9, 0.0, 0.0, math.sqrt(1.9 / 0.1)]
    found = solve_ivp(orbit, (0.0, 3.0), start, **given).y[:, -1]
    assert [float(x) for x in kepler_orbit(numpy.array(3.0), 0.9)] == pytest.approx(found, abs=1e-9)
