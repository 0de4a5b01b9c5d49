"""Constraints that are not linear in the speeds, and constraints that move."""

import math

import pytest

import lagc


def test_constant_speed_turns_as_the_force_across_the_path_says() -> None:
    # with the speed 1 the state is x, y and the heading phi: phi' = (Fy cos phi - Fx sin phi)/m
    from scipy.integrate import solve_ivp

    def rate(_: float, s: list[float]) -> list[float]:
        x, y, phi = s
        return [math.cos(phi), math.sin(phi), -4.0 * y * math.cos(phi) + x * math.sin(phi)]

    start = [0.0, 0.0, math.atan2(0.8, 0.6)]
    expected = solve_ivp(rate, (0.0, 5.0), start, method="DOP853", rtol=1e-12, atol=1e-12).y[:, -1]
    final = lagc.load("hard/constant_speed").compile().simulate(5.0, accuracy=1e-10, points=2).final
    assert abs(final["x"] - expected[0]) <= 1e-9
    assert abs(final["y"] - expected[1]) <= 1e-9


@pytest.mark.parametrize(
    ("name", "stop"),
    [
        ("classic/bead_on_hoop", 5.0),
        ("classic/moving_rail", 1.0),
        ("course/disc_on_a_line_explicit", 5.0),
        ("course/moving_slide_explicit", 1.0),
    ],
)
def test_moving_constraint_does_the_work_that_the_energy_gains(name: str, stop: float) -> None:
    run = lagc.load(name).compile().simulate(stop, method="dop853", rtol=1e-11, atol=1e-11, points=51)
    assert run.status == "ok", run.message
    assert run.position_drift <= 1e-14
    assert run.velocity_drift <= 1e-14
    assert run.energy.work != 0.0
    assert abs(run.energy.imbalance) <= 1e-9 * max(1.0, abs(run.energy.work))
