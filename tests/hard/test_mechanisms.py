"""Mechanisms that are hard on the equations: closed loops, configurations where the rank drops,
constraints that depend on each other everywhere, stated twice, or contradicting each other."""

import math
from statistics import median

import numpy
import pytest
from scipy.integrate import solve_ivp

import lagc
from lagc.simulation.backends.compile import compiler
from lagc.simulation.system import OK, Options
from lagc.simulation.verdict import verdict

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
