"""Mechanisms that are hard on the equations: closed loops, configurations where the rank drops, constraints
that depend on each other everywhere, stated twice, or contradicting each other. The error that a run
reports is its error; if none can be estimated, the run says so."""

import math
import random
from statistics import median

import numpy
import pytest
from scipy.integrate import solve_ivp

import lagc
from lagc.simulation.backends.compile import compiler
from lagc.simulation.system import OK, Options
from lagc.simulation.verdict import verdict
from lagc.study.hard.exact import double_pendulum, kepler_orbit

BACKEND = "c" if compiler() is not None else "numpy"


@pytest.mark.sample(1)
@pytest.mark.parametrize("windows", [1, 4])
def test_what_is_claimed_from_the_flat_configuration_is_true(windows: int) -> None:
    """There multipliers are quotients of rounding, and what a first step does is chance: energy is no bound.
    So the motion is compared with the pendulum that it is; where a fine accuracy is not claimed, the row
    is named."""
    system = lagc.load("classic/n_four_bar").compile(parameters={"N": windows})
    starts = {f"th[{i}]": math.pi / 2.0 for i in range(1, windows + 2)}
    times = numpy.linspace(0.0, 10.0, 101)
    rate = 9.81 * ((windows + 1) / 2 + windows) / ((windows + 1) / 3 + windows)
    exact = solve_ivp(lambda _, x: [x[1], rate * math.sin(x[0])], (0.0, 10.0), [math.pi / 2.0, 1.0],
                      "DOP853", times, rtol=1e-13, atol=1e-13).y  # fmt: skip
    for accuracy in (1e-4, 1e-6, 1e-8):
        run = system.simulate(10.0, accuracy=accuracy, points=101, starts=starts)
        assert run.status == "ok" or ((windows > 1 or accuracy < 1e-4) and "hinge[" in run.message), (
            run.message
        )
        for i in range(1, windows + 2) if run.status == "ok" else ():
            for name, column in zip((f"th[{i}]", f"der(th[{i}])"), exact):
                assert abs(run[name] - column).max() <= accuracy * abs(column).max()


@pytest.mark.sample(1)
@pytest.mark.parametrize("windows", [1, 2, 4])
def test_windows_pass_the_flat_configuration_at_any_tolerance(windows: int) -> None:
    # each passage meets it at other distances, down to where multipliers are nothing but rounding
    model = lagc.load("classic/n_four_bar").compile(parameters={"N": windows})
    system = model.load(BACKEND)
    x = system.start()
    start = system.energies(0.0, x)[2]
    ratios, tolerances = [], [10.0 ** (-6.0 - k / 8.0) for k in range(40)]
    tolerances = tolerances[:: 1 if BACKEND == "c" else 5]
    for tolerance in tolerances:
        done = system.integrate(Options("dop853", tolerance, tolerance, max_steps=5000), 0.0, x, [0.0, 10.0])
        if done.status == OK:  # never on another branch, which needs other energy
            ratios.append(abs(system.energies(10.0, done.x)[2] - start) / (tolerance * start))
            assert max(abs(done.x[windows + 1 + i]) for i in range(windows)) <= 1e-6
        else:
            assert "hinge[" in verdict(system, done, 10.0)[1]
    assert len(ratios) >= 0.9 * len(tolerances)
    # some 60 steps of one tolerance each; of one in thousands, that leaps two radians through the
    # flat configuration, the difference of two embedded formulas may tell a thousandth of the error
    assert median(ratios) <= 10.0 and max(ratios) <= 1e3


def test_constant_speed_turns_as_the_force_across_the_path_says() -> None:
    # with the speed 1 the state is x, y and the heading phi: phi' = (Fy cos phi - Fx sin phi)/m
    def rate(_: float, s: list[float]) -> list[float]:
        x, y, phi = s
        return [math.cos(phi), math.sin(phi), -4.0 * y * math.cos(phi) + x * math.sin(phi)]

    start = [0.0, 0.0, math.atan2(0.8, 0.6)]
    expected = solve_ivp(rate, (0.0, 5.0), start, method="DOP853", rtol=1e-12, atol=1e-12).y[:, -1]
    final = lagc.load("hard/constant_speed").compile().simulate(5.0, accuracy=1e-10, points=2).final
    assert abs(final["x"] - expected[0]) <= 1e-9
    assert abs(final["y"] - expected[1]) <= 1e-9


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
