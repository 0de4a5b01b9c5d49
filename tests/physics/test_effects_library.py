"""The library of effects: each against its closed form, or the published figure where there is none."""

from math import cos, cosh, exp, pi, sin, sqrt, tanh
from pathlib import Path

import pytest

import lagc
from lagc.simulation.solution import Solution
from tests.physics.library import compiled

EXACT = 1e-9  # accuracy of the runs
NEAR = 1e-7


def _run(name: str, scene: str, stop: float, points: int = 2, **parameters: float) -> Solution:
    run = compiled(f"effects/{name}", scene, "numpy").simulate(
        stop, accuracy=EXACT, points=points, parameters=parameters
    )
    assert run.status == "ok", run.message
    return run


def _text(text: str, stop: float, accuracy: float = EXACT) -> Solution:
    run = lagc.loads(text).compile(backend="numpy").simulate(stop, accuracy=accuracy, points=2)
    assert run.status == "ok", run.message
    return run


def _damped(start: float, mass: float, k: float, c: float, t: float) -> float:
    d, w = c / (2 * mass), sqrt(k / mass - (c / (2 * mass)) ** 2)
    return start * exp(-d * t) * (cos(w * t) + d / w * sin(w * t))


R, RHO, M, G = 0.05, 50.0, 0.1, 9.81  # the sphere of `fluid_forces`
S, V = pi * R**2, 4 / 3 * pi * R**3


@pytest.mark.full
def test_a_sphere_sinks_with_linear_drag_buoyancy_and_added_mass() -> None:
    c, whole = 6 * pi * 0.5 * R, M + RHO * V / 2
    found = _run("fluid_forces", "sinking", 0.05).final["der(z)"]
    assert found == pytest.approx(-(M - RHO * V) * G / c * (1 - exp(-c * 0.05 / whole)), rel=NEAR)


@pytest.mark.full
def test_a_sphere_falls_with_quadratic_drag() -> None:
    vt = sqrt(2 * M * G / (RHO * 0.47 * S))
    assert _run("fluid_forces", "falling", 0.5).final["der(z)"] == pytest.approx(
        -vt * tanh(G * 0.5 / vt), rel=NEAR
    )


@pytest.mark.full
def test_wind_takes_a_sphere_along() -> None:
    k, u = RHO * 0.47 * S / 2 / M, 3.0
    assert _run("fluid_forces", "blown", 1.0).final["der(x)"] == pytest.approx(u - u / (1 + k * u), rel=NEAR)


def test_a_spinning_sphere_goes_in_a_circle() -> None:
    w = pi * RHO * R**3 * 100 / M
    final = _run("fluid_forces", "spinning", 0.2).final
    assert (final["x"], final["y"]) == pytest.approx((sin(0.2 * w) / w, (1 - cos(0.2 * w)) / w), abs=NEAR)


@pytest.mark.full
def test_the_phugoid_of_lanchester() -> None:
    """vx - v^3/(3 vt^2), with m g = 1/2 rho C S vt^2."""
    vt2 = 2 * M * G / (RHO * 0.2 * S)
    run = _run("fluid_forces", "phugoid", 5.0, points=50)
    known = [vx - v**3 / (3 * vt2) for vx, v in zip(run.column("der(x)"), run.column("speed"))]
    assert known == pytest.approx([8 - 8**3 / (3 * vt2)] * 50, abs=10 * NEAR)
    assert max(run.column("z")) - min(run.column("z")) > 1.0


@pytest.mark.full
def test_springs_dampers_and_their_torsional_kin() -> None:
    final = _run("springs", "damped", 0.7).final
    assert final["x"] == pytest.approx(0.5 + _damped(0.5, 1, 100, 2, 0.7), abs=NEAR)
    assert final["phi"] == pytest.approx(_damped(1, 0.2, 2, 0.1, 0.7), abs=NEAR)


@pytest.mark.full
def test_the_period_of_duffing() -> None:
    """4 K/W with W^2 = w^2 + a A^2 and the parameter a A^2/(2 W^2); K by the arithmetic-geometric mean."""
    W2 = 100 + 200 * 0.5**2
    a, b = 1.0, sqrt(1 - 200 * 0.5**2 / (2 * W2))
    for _ in range(8):
        a, b = (a + b) / 2, sqrt(a * b)
    period = 2 * pi / (a * sqrt(W2))
    assert _run("springs", "duffing", period).final["x"] == pytest.approx(1.0, abs=NEAR)
    assert _run("springs", "duffing", period / 4).final["x"] == pytest.approx(0.5, abs=NEAR)


@pytest.mark.full
def test_a_rod_pulls_and_pushes() -> None:
    w = sqrt(2.1e11 * 1e-6 / 0.999)
    assert _run("springs", "steel", 0.01).final["x"] == pytest.approx(
        0.999 + 1e-3 * cos(0.01 * w), abs=1e-3 * NEAR * 10
    )


@pytest.mark.full
def test_a_string_only_pulls() -> None:
    w = sqrt(1e6 * 1e-4 / 0.8)
    t = pi / 2 / w + 0.02
    assert _run("springs", "rubber", t).final["x"] == pytest.approx(0.8 - 0.2 * w * 0.02, abs=NEAR)
    assert _run("springs", "rubber", 0.1).final["x"] == pytest.approx(0.8 + 0.2 * cos(0.1 * w), abs=NEAR)


@pytest.mark.full
def test_turning_points_of_dry_friction_come_closer_until_it_holds() -> None:
    run = _run("friction_forces", "slides", 4.0)
    assert run.final["x"] == pytest.approx(1 - 2 * 3 * 0.15 - 0.2 + 0.0, abs=NEAR)  # 1, -0.7, 0.4, -0.1
    stops = [e.t for e in run.events if e.name.endswith("stops")]
    assert stops == pytest.approx([k * pi / sqrt(10) for k in (1, 2, 3)], abs=10 * NEAR)


@pytest.mark.full
def test_viscous_friction_and_rolling_resistance() -> None:
    assert _run("friction_forces", "oiled", 2.0).final["x"] == pytest.approx(
        _damped(1, 1, 10, 0.5, 2.0), abs=NEAR
    )
    rolls = _run("friction_forces", "rolls", 12.0)
    assert rolls.final["x"] == pytest.approx(2**2 / (2 * 0.02 * G), rel=NEAR) and rolls.final["der(x)"] == 0.0
    assert rolls.events[0].t == pytest.approx(2 / (0.02 * G), rel=NEAR)


def test_a_motor_with_gear_and_rotor() -> None:
    tau = (0.01 + 100 * 2e-5) / 0.5**2
    found = _run("motor_drive", "start", 0.05).final["w"]
    assert found == pytest.approx(24 * (1 - exp(-0.05 / tau)), rel=NEAR)


@pytest.mark.full
def test_a_free_particle_seen_from_turning_axes() -> None:
    t, w = 1.5, 2.0
    final = _run("turning_frame", "carousel", t).final
    x, y = 1.0, (0.5 + w) * t  # in space
    back = (cos(w * t) * x + sin(w * t) * y, -sin(w * t) * x + cos(w * t) * y, 0.1 * t)
    assert (final["x"], final["y"], final["z"]) == pytest.approx(back, abs=NEAR * 10)
    slow = _run("turning_frame", "slow", t).final  # a circle of the radius v/(2 w)
    assert slow["x"] == pytest.approx(1 + 0.5 / (2 * w) * (1 - cos(2 * w * t)), abs=NEAR)
    assert slow["y"] == pytest.approx(0.5 / (2 * w) * sin(2 * w * t), abs=NEAR)


def test_a_charge_in_fields() -> None:
    t, w = 1.3, 2.0
    helix = _run("charge_forces", "helix", t).final
    assert (helix["x"], helix["y"], helix["z"]) == pytest.approx(
        (sin(w * t) / w, (cos(w * t) - 1) / w, 0.1 * t), abs=NEAR
    )
    drift = _run("charge_forces", "drift", t).final  # 0.5 m/s along E x B, and half the circle
    assert (drift["x"], drift["y"]) == pytest.approx(
        (0.5 * t + 0.5 * sin(w * t) / w, 0.5 * (cos(w * t) - 1) / w), abs=NEAR
    )


@pytest.mark.full
def test_the_perihelion_of_mercury() -> None:
    """Einstein 1915; 42.98 arc seconds in a century (Will, Living Rev. Relativity 17, 2014, table 4)."""
    mu, a, e, c = 1.32712440018e20, 5.79090827e10, 0.20563, 299792458.0
    period = 2 * pi * sqrt(a**3 / mu)
    run = compiled("effects/orbit_forces", "mercury", "numpy").simulate(period, accuracy=1e-11, points=2)
    turned = run.final["perihelion"]
    assert turned == pytest.approx(6 * pi * mu / (c**2 * a * (1 - e**2)), rel=2e-4)
    assert turned * 36525 * 86400 / period * 180 * 3600 / pi == pytest.approx(42.98, abs=0.02)


@pytest.mark.full
def test_light_takes_a_part_of_the_gravity_of_the_sun() -> None:
    mu, a = 1.32712440018e20, 5.79090827e10
    lost = 4.56e-6 * 1.495978707e11**2 * 2 * 1e4 / (1000 * mu)
    period = 2 * pi * sqrt(a**3 / (mu * (1 - lost)))
    final = _run("orbit_forces", "sail", period, e=0.0, lost=lost).final
    assert lost > 0.01 and (final["x"] / a, final["y"] / a) == pytest.approx((1.0, 0.0), abs=10 * NEAR)


@pytest.mark.full
def test_a_tide_pulls_along_and_pushes_across() -> None:
    run = _text(
        """import "effects/orbit_forces.lag";
model Stretched
  coordinate Length x(start = 1), y(start = 1);
  body dust = Particle(mass = 2 [kg], at = {x, y, 0});
  effect tide
    Tide moon(b = dust, C = {0, 0, 0}, T = {100, 0, 0} [m], mu = 1e6);
  end tide;
  scene s uses tide;
end Stretched;""",
        1.0,
    )
    assert run.final["x"] == pytest.approx(cosh(sqrt(2.0)), rel=NEAR)
    assert run.final["y"] == pytest.approx(cos(1.0), rel=NEAR)


ORBIT = """import "effects/orbit_forces.lag";
model Round
  parameter Real[m3/s2] mu = 3.986004418e14;
  parameter Length a = 7e6;
  parameter Velocity v = sqrt(mu/a);
  coordinate Length x(start = a), y(rate = v*cos(60 [deg])), z(rate = v*sin(60 [deg]));
  body craft = Particle(mass = 500 [kg], at = {x, y, z});
  point C = {0, 0, 0};
  CentralGravity earth(b = craft, C = C);
  effect flat Oblateness grown(b = craft, C = C, F = world); end flat;
  effect air ThinAir drag(b = craft, C = C, rho = 1e-9 [kg/m3], r0 = 7e6 [m], H = 1e9 [m]); end air;
  scene one uses %s;
  output Real node = -(z*der(x) - x*der(z))/(y*der(z) - z*der(y));
  output Length axis = 1/(2/norm(position(craft)) - dot(velocity(craft), velocity(craft))/mu);
end Round;"""


@pytest.mark.full
def test_the_node_of_an_orbit_of_an_oblate_earth_goes_back() -> None:
    """-3/2 n J2 (R/p)^2 cos i (Kaula 1966, eq. 3.74), to first order in J2; ten orbits."""
    n = sqrt(3.986004418e14 / 7e6**3)
    system = lagc.loads(ORBIT % "flat").compile(backend="numpy")
    run = system.simulate(20 * pi / n, accuracy=1e-9, points=2)
    h = [run.final["y"]*run.final["der(z)"] - run.final["z"]*run.final["der(y)"],
         run.final["z"]*run.final["der(x)"] - run.final["x"]*run.final["der(z)"]]  # fmt: skip
    turned = h[0] / -h[1]
    rate = -1.5 * n * 1.08263e-3 * (6.378137 / 7) ** 2 * cos(pi / 3)
    assert turned == pytest.approx(rate * 20 * pi / n, rel=0.01)


@pytest.mark.full
def test_thin_air_lowers_an_orbit() -> None:
    """-2 pi rho D S/m a^2 in a turn (King-Hele, Satellite Orbits in an Atmosphere, 1987, 3.1)."""
    run = _text(ORBIT % "air", 2 * pi * sqrt(7e6**3 / 3.986004418e14))
    lost = 2 * pi * 1e-9 * 2.2 * 4 / 500 * 7e6**2
    assert 7e6 - run.final["axis"] == pytest.approx(lost, rel=1e-2)


@pytest.mark.full
def test_the_gravity_gradient_holds_a_satellite_upright() -> None:
    n = sqrt(3.986004418e14 / 7e6**3)
    final = _run("libration", "orbit", 2000.0).final
    assert final["pitch"] == pytest.approx(1e-3 * cos(n * sqrt(3 * 800 / 1000) * 2000), abs=1e-9)


def test_an_effect_is_used_on_bodies_of_ones_own(tmp_path: Path) -> None:
    """Two balls in air: each has its drag, and the scene says which."""
    model = tmp_path / "mine.lag"
    model.write_text("""import "effects/fluid_forces.lag";
model Two
  coordinate Length x[2](each rate = 1 [m/s]);
  body ball[1] = Particle(mass = 1 [kg], at = {x[1], 0, 0});
  body ball[2] = Particle(mass = 1 [kg], at = {x[2], 0, 0});
  effect air
    QuadraticDrag drag[2](b = ball, each C = 1, each rho = 2, S = {0.5, 1});
  end air;
  scene s uses air;
end Two;""")
    final = lagc.load(str(model)).compile(backend="numpy").simulate(1.0, accuracy=EXACT).final
    assert (final["der(x[1])"], final["der(x[2])"]) == pytest.approx((1 / 1.5, 1 / 2), rel=NEAR)
