"""Multipliers are the forces that the stories of the models work out by hand. Exercises on constraints with
friction and of one side: the formulas of the models' own stories."""

import math

import numpy as np
import pytest

import lagc
from tests.physics.runs import motion


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


G = 9.81
WAYS = ("explicit", "implicit")


@pytest.mark.sample(1)
@pytest.mark.parametrize("way", WAYS)
def test_a_rough_tube_slows_a_point_by_its_own_push(way: str) -> None:
    run = motion(f"course/rough_tube_{way}", 1.0)
    w, mu, r0, v0 = 3.0, 0.4, 0.1, 0.05
    fast, slow = w * (-mu + math.hypot(mu, 1.0)), w * (-mu - math.hypot(mu, 1.0))
    a = (v0 - slow * r0) / (fast - slow)
    grown, faded = a * np.exp(fast * run.t), (r0 - a) * np.exp(slow * run.t)
    assert run["r"] == pytest.approx(grown + faded, rel=1e-8)
    assert run["N"] == pytest.approx(2.0 * 0.2 * w * (fast * grown + slow * faded), rel=1e-7)


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    ("way", "mu"), [("explicit", 0.2), ("implicit", 0.2), ("explicit", 0.0), ("explicit", 0.7)]
)
def test_a_block_pushes_its_wedge_away(way: str, mu: float) -> None:
    """The implicit model is told that it slides; with mu > tan(a) the explicit one stays where it is."""
    run = motion(f"course/rough_wedge_{way}", 0.5, mu=mu)
    s, c, m, wedge = 0.5, math.cos(math.radians(30.0)), 1.0, 3.0
    push = m * G * c / (1.0 + m / wedge * s * (s - mu * c)) if mu < s / c else 0.0
    back = push * (s - mu * c) / wedge
    assert run["X"] == pytest.approx(-back * run.t**2 / 2.0, abs=1e-9)
    assert run["y"] == pytest.approx(
        1.0 - (G - push * (c + mu * s)) * run.t**2 / 2.0 * (push > 0.0), abs=1e-9
    )
    if way == "explicit" and mu < s / c:
        assert run["N"] == pytest.approx(np.full(len(run.t), push), rel=1e-10)


@pytest.mark.sample(1)
@pytest.mark.parametrize(("name", "size", "start"), [("sphere", 0.4, 70.0), ("wall", 0.75, 70.0)])
def test_what_leaves_does_so_at_two_thirds_of_its_height(name: str, size: float, start: float) -> None:
    """The speed of the centre along the floor stays from then on."""
    held, free = (lagc.load(f"course/leaving_{name}_{way}").compile(backend="numpy") for way in WAYS[::-1])
    (mark,) = held.simulate(accuracy=1e-9).events
    ends = held.simulate(mark.t, accuracy=1e-10)
    assert ends.final["y"] == pytest.approx(2.0 / 3.0 * size * math.sin(math.radians(start)), rel=1e-8)
    goes_on = free.simulate(accuracy=1e-9)
    (opens,) = [event for event in goes_on.events if event.kind == "opens"]
    assert opens.t == pytest.approx(mark.t, abs=1e-9)
    speed = ends.final["y"] * abs(ends.final["der(theta)"])
    assert goes_on.final["der(x)"] == pytest.approx(speed, rel=1e-8)


@pytest.mark.sample(1)
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("scene", ["rolls", "slips"])
def test_a_disc_rolls_or_slips_down_a_slope(way: str, scene: str) -> None:
    run = lagc.load(f"course/disc_on_a_slope_{way}").compile(scene, backend="numpy").simulate(accuracy=1e-9)
    s, c, r, mu = 0.5, math.cos(math.radians(30.0)), 0.1, 0.1
    along = 2.0 / 3.0 * G * s if scene == "rolls" else G * (s - mu * c)
    turn = along if scene == "rolls" else 2.0 * mu * G * c
    assert run.final["s"] == pytest.approx(along / 2.0, rel=1e-8)
    assert run.final["phi"] == pytest.approx(turn / 2.0 / r, rel=1e-8)
    assert not [note for note in run.notes if "`slope`" in note]  # whether it touches is exact


@pytest.mark.parametrize("mu", [0.99, 1.01])
def test_a_disc_rolls_up_to_a_slope_of_three_times_the_friction(mu: float) -> None:
    system = lagc.load("course/disc_on_a_slope_explicit").compile("rolls", backend="numpy")
    run = system.simulate(0.1, rtol=1e-8, parameters={"mu": mu * math.tan(math.radians(30.0)) / 3.0})
    assert (run.final["slope"] == 2.0) == (mu > 1.0)
