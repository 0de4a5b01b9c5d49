"""Multipliers are the forces that the stories of the models work out by hand."""

import math

import pytest

import lagc


def _final(name: str, stop: float, **parameters: float) -> dict[str, float]:
    run = lagc.load(name).compile().simulate(stop, accuracy=1e-10, points=2, parameters=parameters)
    assert run.status == "ok", run.message
    return run.final


def test_string_pulls_with_weight_and_centrifugal_force() -> None:
    f = _final("course/string_pendulum", 3.0)
    mass, length, g = 1.0, 0.5, 9.81
    v2 = f["der(x)"] ** 2 + f["der(z)"] ** 2
    assert math.isclose(f["tension"], mass * (v2 - g * f["z"]) / length, rel_tol=1e-12)


def test_line_carries_the_disc_and_accelerates_it() -> None:
    t, a, w = 2.3, 0.2, 3.0
    f = _final("course/disc_on_a_line_explicit", t)
    assert math.isclose(f["lift"], 2.0 * (9.81 - a * w * w * math.sin(w * t)), rel_tol=1e-12)


def test_ground_carries_the_weight_of_the_wheel() -> None:
    assert math.isclose(_final("course/wheel_explicit", 2.0)["N"], 3.0 * 9.81, rel_tol=1e-12)


def test_rolling_wheel_needs_a_tangential_force() -> None:
    f = _final("course/wheel_rolling_explicit", 2.0)
    m, a, inertia, k, c = 3.0, 0.3, 0.2, 6.0, 0.5
    acceleration = (c / a - k * f["x"]) / (m + inertia / a**2)
    assert math.isclose(f["N"], m * 9.81, rel_tol=1e-12)
    assert math.isclose(f["T"], m * acceleration + k * f["x"], rel_tol=1e-12)


def test_plane_carries_the_sphere() -> None:
    assert math.isclose(_final("course/sphere_on_a_plane_explicit", 2.0)["N"], 9.81, rel_tol=1e-11)


def test_slide_pushes_with_m_g_cos_minus_gamma_sin() -> None:
    theta = math.radians(30.0)
    expected = 9.81 * math.cos(theta) - 2.0 * math.sin(theta)
    assert math.isclose(_final("course/moving_slide_explicit", 0.7)["R"], expected, rel_tol=1e-12)


def test_slide_that_falls_as_fast_as_the_point_does_not_touch_it() -> None:
    theta = math.radians(30.0)
    force = _final("course/moving_slide_explicit", 0.7, gamma=9.81 / math.tan(theta))["R"]
    assert abs(force) <= 1e-12 * 9.81


@pytest.mark.full
def test_upright_ladder_leaves_the_wall_at_two_thirds() -> None:
    # cos(theta) = 2/3 cos(theta0): there the force of the wall changes its sign
    theta0 = math.radians(10.0)
    run = lagc.load("classic/sliding_ladder_explicit").compile().simulate(1.5, accuracy=1e-9, points=3001)
    pushes = [float(c) for c, f in zip(run["theta"], run["from_wall"]) if f > 0.0]
    assert math.isclose(math.cos(pushes[-1]), 2.0 / 3.0 * math.cos(theta0), abs_tol=2e-3)  # the grid


def test_piston_pin_carries_its_inertia() -> None:
    # Newton's law of the piston alone: m3 s'' is the force on its pin along x
    system = lagc.load("classic/slider_crank").compile("idle")
    run = system.simulate(0.2, accuracy=1e-10, points=2)
    state = [run.final[n] for n in run.state_names]
    rate = system.rhs(0.2, state)
    acceleration = float(rate[run.state_names.index("der(s)")])
    assert math.isclose(run.final["Px"], -0.5 * acceleration, rel_tol=1e-9)
