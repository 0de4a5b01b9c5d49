"""Motions that can be written down: the formulas of the models' own stories. Motions against published
numbers, through the asked global accuracy."""

import math

import numpy
import pytest

import lagc
from tests.physics.references import compiled, names, read
from tests.physics.runs import motion, spread

G = 9.81
TOLERANCE = 1e-9


def assert_close(found: object, expected: object, tolerance: float = TOLERANCE) -> None:
    difference = numpy.abs(numpy.asarray(found) - numpy.asarray(expected)).max()
    assert difference <= tolerance * max(1.0, float(numpy.abs(expected).max())), difference


def test_thrown_stone_flies_a_parabola() -> None:
    run = motion("course/particle_under_gravity", 2.0)
    assert_close(run["x"], 3.0 * run.t)
    assert_close(run["z"], 4.0 * run.t - G * run.t**2 / 2.0)


def test_isotropic_spring_makes_an_ellipse() -> None:
    run = motion("course/particle_in_a_potential", 10.0)
    assert_close(run["x"], numpy.cos(2.0 * run.t))
    assert_close(run["y"], numpy.sin(2.0 * run.t) / 2.0)
    assert_close(run["z"], 0.2 * numpy.cos(2.0 * run.t))


def test_rolling_wheel_swings_with_the_inertia_of_its_rotation() -> None:
    run = motion("course/wheel_rolling_implicit", 5.0)
    m, a, inertia, k, c = 3.0, 0.3, 0.2, 6.0, 0.5
    w = math.sqrt(k * a * a / (m * a * a + inertia))
    rest = c / (k * a * a)
    assert_close(run["theta"], rest - rest * numpy.cos(w * run.t) + 2.0 / w * numpy.sin(w * run.t))


def test_rolling_sphere_weighs_seven_fifths() -> None:
    run = motion("course/sphere_rolling", 5.0)
    w = math.sqrt(2.0 / 1.4)
    rate = -0.1 * math.sin(math.radians(60.0)) * 2.0
    assert_close(run["x"], 0.2 * numpy.cos(w * run.t) + rate / w * numpy.sin(w * run.t))
    assert_close(run["y"], -0.05 / w * numpy.sin(w * run.t))


def test_point_on_the_moving_slide_has_a_constant_acceleration() -> None:
    run = motion("course/moving_slide_implicit", 1.0)
    s, c = math.sin(math.radians(30.0)), math.cos(math.radians(30.0))
    assert_close(run["x"], 1.0 - c * (2.0 * c + G * s) * run.t**2 / 2.0)


def test_cycloid_takes_the_same_time_for_every_amplitude() -> None:
    w = math.sqrt(G / (4.0 * 0.25))
    for start in (0.1, 1.0, 3.0):
        run = motion("classic/cycloid_pendulum", 5.0, starts={"u": start})
        assert_close(run["s"], 4.0 * 0.25 * math.sin(start / 2.0) * numpy.cos(w * run.t))


def test_charge_in_crossed_fields_rolls_along_a_cycloid() -> None:
    run = motion("classic/charged_particle", 10.0)
    w, drift = 2.0, 0.5
    assert_close(run["x"], drift * (run.t - numpy.sin(w * run.t) / w))
    assert_close(run["y"], drift / w * (1.0 - numpy.cos(w * run.t)))
    assert_close(run["z"], 0.1 * run.t)


def test_atwood_machine_falls_slowly() -> None:
    run = motion("classic/atwood_machine", 1.0)
    assert_close(run["x"], G * 0.1 / (2.1 + 5e-4 / 0.01) * run.t**2 / 2.0)


def test_double_atwood_machine_does_not_balance() -> None:
    run = motion("classic/double_atwood_machine", 1.0)
    # m1 a1 = m1 g - 2 T and so on for masses 3, 2, 1: T = 8/17 of the weight of 3 kg ...
    tension = 24.0 / 17.0 * G
    assert_close(run["x"], (G - 2.0 * tension / 3.0) * run.t**2 / 2.0)


def test_yo_yo_falls_as_its_axle_allows() -> None:
    run = motion("classic/yo_yo", 1.0)
    acceleration = G / (1.0 + 2e-5 / (0.05 * 0.004**2))
    assert_close(run["s"], acceleration * run.t**2 / 2.0)
    assert_close(run["tension"], 0.05 * (G - acceleration) + 0.0 * run.t)


def test_cylinder_rolls_down_the_wedge() -> None:
    run = motion("classic/cylinder_on_wedge", 1.0)
    c = math.cos(math.radians(30.0))
    assert_close(run["s"], G * 0.5 / (1.5 - c * c / 3.0) * run.t**2 / 2.0)


def test_coupled_oscillators_beat() -> None:
    run = motion("classic/coupled_oscillators", 20.0)
    slow, fast = math.sqrt(10.0), math.sqrt(12.0)
    assert_close(run["x1"], 0.05 * (numpy.cos(slow * run.t) + numpy.cos(fast * run.t)))
    assert_close(run["x2"], 0.05 * (numpy.cos(slow * run.t) - numpy.cos(fast * run.t)))


def test_driven_oscillator_settles_to_its_amplitude_and_phase() -> None:
    m, k, c, w = 1.0, 4.0, 0.2, 1.8
    amplitude = 1.0 / math.hypot(k - m * w * w, c * w)
    phase = math.atan2(c * w, k - m * w * w)
    starts = {"x": amplitude * math.cos(phase), "der(x)": amplitude * w * math.sin(phase)}
    run = motion("classic/driven_oscillator", 60.0, starts=starts)
    assert_close(run["x"], amplitude * numpy.cos(w * run.t - phase))


def test_skate_on_a_slope_drifts_sideways() -> None:
    run = motion("classic/knife_edge", 5.0)
    w, pull = 2.0, G * math.sin(math.radians(20.0))
    assert_close(run["x"], pull / (2.0 * w * w) * numpy.sin(w * run.t) ** 2)
    assert_close(run["y"], pull / (2.0 * w * w) * (w * run.t - numpy.sin(2.0 * w * run.t) / 2.0))


def test_wilberforce_pendulum_hands_its_energy_over() -> None:
    run = motion("classic/wilberforce_pendulum", 40.0)
    m, inertia, w, e = 0.4905, 1.39e-4, 2.314, 9.27e-3
    shift = e / (2.0 * math.sqrt(m * inertia))
    one, two = math.sqrt(w * w + shift), math.sqrt(w * w - shift)
    assert_close(run["z"], 0.05 * (numpy.cos(one * run.t) + numpy.cos(two * run.t)))


def test_paul_trap_holds_the_charge_that_a_static_field_loses() -> None:
    held = motion("classic/paul_trap", 20.0, accuracy=1e-8)
    assert numpy.abs(held["z"]).max() < 0.2
    lost = motion("classic/paul_trap", 5.0, accuracy=1e-8, V=0.0, U=1.0)
    assert_close(lost["z"], 0.05 * numpy.cosh(math.sqrt(2.0) * lost.t), 1e-6)


def test_shaken_pendulum_stands_upright_and_the_still_one_falls() -> None:
    shaken = motion("classic/kapitza_pendulum", 3.0, "shaken", accuracy=1e-6)
    assert numpy.abs(shaken["theta"] - math.pi).max() < math.radians(15.0)
    still = motion("classic/kapitza_pendulum", 3.0, "still", accuracy=1e-6)
    assert still["theta"].min() < 0.0


def test_controlled_cart_brings_its_pendulum_upright() -> None:
    run = motion("classic/cart_pendulum", 20.0, "balanced", accuracy=1e-6)
    final = run.final
    assert abs(final["theta"]) < 1e-3 and abs(final["x"]) < 1e-2
    assert motion("classic/cart_pendulum", 2.0, "falling", accuracy=1e-6).final["theta"] > 1.0


def test_governor_settles_where_the_forces_balance() -> None:
    run = motion("classic/watt_governor", 20.0, "driven", accuracy=1e-6)
    expected = math.acos(3.0 * G / (0.2 * 14.0**2))
    assert_close(run.final["theta"], expected, 1e-3)  # the last of the transient


def test_racket_turns_over_and_back_in_its_period() -> None:
    run = motion("classic/racket_flip", 45.88488122496584444659, accuracy=1e-10)
    final = run.final
    assert run["w2"].min() < -0.999 and run["w2"].max() > 0.999
    assert_close(final["w1"], 0.57735289733980435501, 1e-7)
    assert_close(final["w3"], 0.99999040995401550901, 1e-7)


def test_figure_eight_closes() -> None:
    run = motion("classic/three_body_figure_eight", 6.32591398)
    for i in (1, 2, 3):
        for name in (f"x[{i}]", f"y[{i}]"):
            assert_close(run[name][-1], run[name][0], 1e-6)  # the start is printed with 8 digits


def test_trojan_stays_with_its_triangle() -> None:
    run = motion("classic/lagrange_points", 100.0, accuracy=1e-8)
    angle = numpy.arctan2(run["y"], run["x"])
    assert math.radians(30.0) < angle.min() < angle.max() < math.radians(130.0)


def test_coin_runs_round_its_steady_circle() -> None:
    constants = read("rolling_disc").constants
    radius = float(numpy.asarray(constants["radius of the circle of the centre"]))
    run = motion("classic/rolling_disc", 3.0)
    assert_close(run["lean"], 0.3 + 0.0 * run.t)
    assert_close(run["der(spin)"], -4.383031894013006876555 + 0.0 * run.t)
    assert_close(numpy.hypot(run["der(x)"], run["der(y)"]), 2.0 * radius + 0.0 * run.t)
    assert spread(run["z"]) <= TOLERANCE


@pytest.mark.parametrize(
    ("state", "yaw", "lean", "spin", "rates"),
    [("first", 0.3, 0.1, 1.97, (-0.2, 1.3, 0.15)), ("second", 3.97, -0.28, 8.2, (-0.25, -2.2, 0.62))],
)
def test_coin_accelerates_as_published(
    state: str, yaw: float, lean: float, spin: float, rates: tuple[float, float, float]
) -> None:
    constants = read("rolling_disc").constants
    (published,) = [v for k, v in constants.items() if k.startswith(f"sympy state {state}")]
    assert isinstance(published, list)
    # the rates u of the source are in the axes that turn with the disc; see the angles of the model
    cs, ss, r = math.cos(spin), math.sin(spin), 0.26
    u1, u2, u3 = rates
    lean_rate, along = u1 * cs + u3 * ss, -u1 * ss + u3 * cs  # along L.x and L.z
    yaw_rate = along / math.cos(lean)
    spin_rate = u2 - yaw_rate * math.sin(lean)
    numpy.testing.assert_allclose([yaw_rate, lean_rate, spin_rate], published[:3], rtol=1e-13)

    # the speed of the centre follows from rolling: w x (r L.z) with w = lean' L.x + u2 L.y + along L.z
    cy, sy, cl, sl = math.cos(yaw), math.sin(yaw), math.cos(lean), math.sin(lean)
    ex, ey = (cy, sy, 0.0), (-sy * cl, cy * cl, sl)
    v = [r * (u2 * a - lean_rate * b) for a, b in zip(ex, ey)]
    system = lagc.load("classic/rolling_disc").compile()
    names = system.state_names
    values = {
        "x": 0.0, "y": 0.0, "z": r * cl, "yaw": yaw, "lean": lean, "spin": spin,
        "der(x)": v[0], "der(y)": v[1], "der(z)": v[2],
        "der(yaw)": yaw_rate, "der(lean)": lean_rate, "der(spin)": spin_rate,
    }  # fmt: skip
    rate = dict(zip(names, system.rhs(0.0, [values[n] for n in names])))
    a_yaw, a_lean, a_spin = rate["der(yaw)"], rate["der(lean)"], rate["der(spin)"]
    # u1 = lean' cos(spin) - yaw' cos(lean) sin(spin) and so on, differentiated
    d_along = a_yaw * cl - yaw_rate * lean_rate * sl
    found = [
        a_lean * cs - d_along * ss - spin_rate * (lean_rate * ss + along * cs),
        a_spin + a_yaw * sl + yaw_rate * lean_rate * cl,
        a_lean * ss + d_along * cs + spin_rate * (lean_rate * cs - along * ss),
    ]
    numpy.testing.assert_allclose(found, published[3:], rtol=1e-10)


@pytest.mark.full
def test_published_constants_of_the_references() -> None:
    run = motion("classic/spherical_pendulum", 3.0, points=3001)
    assert math.isclose(run["z"].min(), -0.8511918971852326, abs_tol=1e-5)  # between grid points
    assert math.isclose(run["z"].max(), -0.5, abs_tol=1e-9)
    top = motion("classic/heavy_top", 2.278301997688738312163)
    assert_close(top.final["theta"], math.radians(60.0), 1e-9)
    assert_close(top.final["der(theta)"], 0.0, 1e-8)


CASES = [(name, sample.t) for name in names() for sample in read(name).samples]


@pytest.mark.sample(2, 12)
@pytest.mark.parametrize(("name", "t"), CASES, ids=[f"{n}-{t:g}" for n, t in CASES])
def test_motion_is_the_published_one(name: str, t: float) -> None:
    reference = read(name)
    (sample,) = [s for s in reference.samples if s.t == t]
    if reference.tolerance is None:
        # asked a decade finer than compared: the error estimate is good to a factor of about 2
        run = compiled(name).simulate(t, accuracy=reference.accuracy / 10, points=2, starts=reference.starts)
    else:
        tol = reference.tolerance
        run = compiled(name).simulate(t, method="dop853", rtol=tol, atol=tol, points=2)
    assert run.status == "ok", run.message
    found = run.final
    for quantity, value in sample.values.items():
        error = abs(found[quantity] - value) / reference.scale(quantity)
        assert error <= reference.accuracy, (quantity, found[quantity], value)
