"""Constraints that are not linear in the speeds, and constraints that move."""

from __future__ import annotations

import math

import numpy
import pytest

import lagc
from lagc.simulation.backends.compile import compiler

FAST = compiler() is not None

# a particle with the speed 1 in an anisotropic bowl (P. Appell 1911 for such constraints): with
# Chetaev's rule the constraint force is along the velocity and keeps its size
SPEED = """
model ConstantSpeed
  parameter Mass m = 1 [kg];
  parameter Stiffness k = 1 [N/m];
  coordinate Length x(rate = 0.6 [m/s]), y(rate = 0.8 [m/s]);
  body p = Particle(mass = m, at = {x, y, 0});
  constraint speed: der(x)^2 + der(y)^2 = 1 [m2/s2];
  potential bowl = 1/2*k*(x^2 + 4*y^2);
end ConstantSpeed;
"""


def test_constant_speed_does_not_drift() -> None:
    steps = 200_000 if FAST else 2_000
    system = lagc.loads(SPEED).compile(backend="c" if FAST else "numpy")
    run = system.simulate(0.01 * steps, method="dopri5", step=0.01, points=101)
    assert run.status == "ok", run.message
    assert run.cost.steps >= steps
    assert run.velocity_drift <= 1e-14
    assert abs(run["der(x)"] ** 2 + run["der(y)"] ** 2 - 1.0).max() <= 1e-14


def test_constant_speed_turns_as_the_force_across_the_path_says() -> None:
    # with the speed 1 the state is x, y and the heading phi: phi' = (Fy cos phi - Fx sin phi)/m
    from scipy.integrate import solve_ivp

    def rate(_: float, s: list[float]) -> list[float]:
        x, y, phi = s
        return [math.cos(phi), math.sin(phi), -4.0 * y * math.cos(phi) + x * math.sin(phi)]

    start = [0.0, 0.0, math.atan2(0.8, 0.6)]
    expected = solve_ivp(rate, (0.0, 5.0), start, method="DOP853", rtol=1e-12, atol=1e-12).y[:, -1]
    final = lagc.loads(SPEED).compile().simulate(5.0, accuracy=1e-10, points=2).final
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


# a crank that is turned as a known function of time: nothing is left to integrate but the loop
DRIVEN = """
model DrivenSlider
  parameter Length r = 0.05 [m], l = 0.15 [m];
  parameter AngularVelocity w = 50 [rad/s];
  coordinate Angle phi(rate = w), psi(rate = r/l*w);
  coordinate Length s(start = r + l);
  frame C = rotate_z(world, phi);
  frame R = rotate_z(world, -psi);
  body crank = Solid(mass = 1 [kg], inertia = {0.005, 0.005, 0.005} [kg.m2], frame = C, com = {0, 0, 0});
  body rod = Solid(mass = 0.4 [kg], inertia = {0, 1e-3, 1e-3} [kg.m2], frame = R, com = r*C.x + l/2*R.x);
  body piston = Particle(mass = 0.5 [kg], at = {s, 0, 0});
  constraint pin: r*C.x + l*R.x = {s, 0, 0};
  constraint drive: phi = w*time + 0.1*sin(2*w*time)^2;
  output Torque motor = reaction(drive);
end DrivenSlider;
"""


def test_driven_crank_follows_its_drive_and_its_motor_does_the_work() -> None:
    run = lagc.loads(DRIVEN).compile().simulate(1.0, method="dop853", rtol=1e-11, atol=1e-11, points=201)
    assert run.status == "ok", run.message
    assert run.position_drift <= 1e-14
    # the drive's row has no size of its own where phi is 0: its rate is held against the speed
    assert run.velocity_drift <= 1e-13
    angle = 50.0 * run.t + 0.1 * numpy.sin(100.0 * run.t) ** 2
    assert abs(run["phi"] - angle).max() <= 1e-12
    rate = 50.0 + 10.0 * numpy.sin(200.0 * run.t)
    assert abs(run["der(phi)"] - rate).max() <= 1e-14 * 60.0 + 4e-16 * 200.0 * 10.0  # the sine's own rounding
    piston = 0.05 * numpy.cos(angle) + numpy.sqrt(0.15**2 - (0.05 * numpy.sin(angle)) ** 2)
    assert abs(run["s"] - piston).max() <= 1e-13
    assert abs(run.energy.imbalance) <= 1e-9 * abs(run.energy.end)
