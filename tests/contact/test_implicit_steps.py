"""Radau IIA beside contacts: stiff bushings on a floor, friction, rest, verified runs, both backends."""

from functools import cache
from math import acos, cos, sin, sqrt

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad
from scipy.linalg import expm
from scipy.optimize import brentq

import lagc

Array = NDArray[np.float64]
G = 9.81
M, m, k, c, h = 20.0, 0.5, 1e8, 1e5, 0.1  # of BUSHING, as in `bushing_on_floor`
BUSHING = """model M
  parameter Stiffness k(min = 0) = 1e8 [N/m];
  parameter Damping c(min = 0) = 1e5 [N.s/m];
  parameter Force A = 0 [N] "shakes the machine";
  coordinate Length z(start = 0.1 [m]) "of the foot", s(rate = 0) "stretch of the bushing";
  Gravity field(g = 9.81 [m/s2]);
  body foot = Particle(mass = 0.5 [kg], at = {0, 0, z});
  body machine = Particle(mass = 20 [kg], at = {0, 0, z + s});
  potential bushing = 1/2*k*s^2;
  dissipation loss = 1/2*c*der(s)^2;
  force shake = {0, 0, A*sin(30 [rad/s]*time)} at machine;
  constraint floor: z >= 0;
end M;"""
SPHERE = """model M
  coordinate Angle a(start = 30 [deg]) "from the top";
  coordinate Length r(start = 1 [m]);
  Gravity field(g = 9.81 [m/s2]);
  body bead = Particle(mass = 1 [kg], at = r*{sin(a), 0, cos(a)});
  constraint ball: r >= 1 [m];
end M;"""


@cache
def bushing() -> lagc.CompiledModel:
    return lagc.loads(BUSHING).compile(backend="numpy")


class Motion:
    """The exact motion of BUSHING from one event to the next: in flight and on the floor the states (z, s,
    z', s', 1) obey x' = A x."""

    def __init__(self) -> None:
        self.flight, self.floor = np.zeros((5, 5)), np.zeros((5, 5))
        # The foot has the force k s + c s', the machine its negative: relative to the foot both count.
        self.flight[0, 2] = self.flight[1, 3] = self.floor[1, 3] = 1.0
        self.flight[2] = k / m * np.array([0.0, 1.0, 0.0, c / k, -G * m / k])
        self.flight[3] = -k * (1.0 / m + 1.0 / M) * np.array([0.0, 1.0, 0.0, c / k, 0.0])
        self.floor[3] = -k / M * np.array([0.0, 1.0, 0.0, c / k, M * G / k])
        self.t, self.x, self.events = 0.0, np.array([h, 0.0, 0.0, 0.0, 1.0]), list[tuple[float, str]]()

    def indicator(self, x: Array, closed: bool) -> float:
        """The gap, or the push of the floor m g - k s - c s'."""
        return float(m * G - k * x[1] - c * x[3]) if closed else float(x[0])

    def follow(self, stop: float) -> None:
        """Pass all events until `stop`."""
        closed = False
        while True:
            matrix, begin = (self.floor if closed else self.flight), self.x
            # The first crossing, sought on a grid that grows from a microsecond.
            left, right = 0.0, 1e-6
            while self.t + left < stop and self.indicator(expm(matrix * right) @ begin, closed) > 0.0:
                left, right = right, right + max(1e-6, 0.02 * right)
            if self.t + left >= stop:
                self.t, self.x = stop, expm(matrix * (stop - self.t)) @ begin
                return

            def value(t: float, matrix: Array = matrix, begin: Array = begin, closed: bool = closed) -> float:
                return self.indicator(expm(matrix * t) @ begin, closed)

            after = brentq(value, left or 1e-7, right, xtol=1e-15)
            self.t, self.x = self.t + after, expm(matrix * after) @ begin
            if not closed:  # the foot stops, the machine does not
                self.x = np.array([0.0, self.x[1], 0.0, self.x[3] + self.x[2], 1.0])
            closed = not closed
            self.events.append((self.t, "floor rests" if closed else "floor opens"))


@cache
def exact(stop: float) -> Motion:
    motion = Motion()
    motion.follow(stop)
    return motion


def test_a_bushing_that_bounces_is_the_exact_motion() -> None:
    """Times of impacts and of forces that fall to zero, and the end; the error follows the tolerance."""
    motion = exact(0.2)
    for rtol in (1e-5, 1e-7, 1e-9):
        run = bushing().simulate(0.2, method="radau5", rtol=rtol, points=2)
        assert run.status == "ok" and len(run.events) == len(motion.events) == 5
        # A relative error of the gap, over the slowest impact, with 6 mm/s: 16 rtol h/m.
        assert max(abs(event.t - t) for event, (t, _) in zip(run.events, motion.events)) < rtol
        states = [run.final[name] for name in ("z", "s", "der(z)", "der(s)")]
        assert np.abs(np.array(states) - motion.x[:4]).max() < 10.0 * rtol * h
    assert (
        run.cost.steps < 400
    )  # the fast part decays in 5 us: stability allows an explicit step of about 20 us


def test_a_verified_run_keeps_its_accuracy() -> None:
    """At recorded times in flight and on the floor. Errors are relative to the largest values of a unit."""
    run = bushing().simulate(0.17, method="radau5", accuracy=1e-7, points=18)
    assert run.status == "ok" and run.estimated <= 1e-7
    for t, z, s, vz, vs in zip(run.t, *(run[name] for name in ("z", "s", "der(z)", "der(s)"))):
        x = exact(t).x
        assert max(abs(z - x[0]), abs(s - x[1])) <= 1e-7 * h
        assert max(abs(vz - x[2]), abs(vs - x[3])) <= 1e-7 * sqrt(2.0 * G * h)


@pytest.mark.full
def test_auto_takes_it_where_stability_limits_the_steps() -> None:
    """A machine shakes on a bushing of 1e9 N/m: an explicit run would have 100,000 steps and more."""
    run = bushing().simulate(1.0, parameters={"k": 1e9, "c": 1e6, "A": 100.0}, points=2)
    assert run.status == "ok" and run.method == "radau5" and run.estimated <= 1e-6
    assert any("stability limits" in note for note in run.notes)
    # The machine follows the load at once, but for its inertia and the delay c/k.
    load = M * G - 100.0 * sin(30.0 * (1.0 - 1e-3))
    assert run.final["s"] == pytest.approx(-load / 1e9, rel=1e-3) and run.final["floor"] == 1.0


@pytest.mark.full
def test_it_needs_far_fewer_steps_than_an_explicit_method() -> None:
    """Flight, impacts, slip, rest: the same events as those of an independent method, in a twentieth of its
    steps. Both backends return the same bits."""
    models = [lagc.load("bushing_on_floor").compile(backend=backend) for backend in ("c", "numpy")]
    explicit = models[0].simulate(1.0, method="dop853", rtol=1e-10, points=11)
    runs = [model.simulate(1.0, method="radau5", rtol=1e-7, points=11) for model in models]
    assert runs[0].final == runs[1].final and runs[0].cost.steps == runs[1].cost.steps
    assert 20 * runs[0].cost.steps < explicit.cost.steps and 20 * runs[0].cost.rhs < explicit.cost.rhs
    assert [event.name for event in runs[0].events] == [event.name for event in explicit.events]
    for one, other in zip(runs[0].events, explicit.events):
        assert one.t == pytest.approx(other.t, abs=1e-6)
    for name in ("x", "z", "s"):
        assert np.abs(runs[0][name] - explicit[name]).max() < 1e-7


def test_fixed_steps_along_a_curved_contact_have_order_5() -> None:
    """A bead slides down a sphere and leaves it where cos(a) = 2/3 cos(a0): the time of that."""
    model = lagc.loads(SPHERE).compile(backend="numpy")
    a0, errors = np.pi / 6.0, []
    leaves = acos(2.0 / 3.0 * cos(a0))
    # The time of a fall from a0 to a is an elliptic integral.
    end = quad(lambda a: 1.0 / sqrt(2.0 * G * (cos(a0) - cos(a0 + a * a))) * 2.0 * a, 0.0, sqrt(leaves - a0))[
        0
    ]
    for step in (0.05, 0.025, 0.0125):
        run = model.simulate(0.4, method="radau5", step=step, points=2)
        ((t, name),) = [(event.t, event.name) for event in run.events]
        assert name == "ball opens"
        errors.append(abs(t - end))
    assert errors[2] < 1e-11
    assert 24.0 < errors[0] / errors[1] < 40.0 and 24.0 < errors[1] / errors[2] < 40.0


@pytest.mark.full
def test_forces_that_exist_on_one_side_alone() -> None:
    """A pad with the force s^1.5, which is no number beyond its surface, under a machine that bounces."""
    force = "if s > 0 then k*s*sqrt(s/1 [mm]) + c*sqrt(s/1 [mm])*der(s) else 0 [N]"
    text = f"""model M
  parameter Stiffness k = 3e7 [N/m];
  parameter Damping c = 1e4 [N.s/m];
  coordinate Length z(start = 0.1 [m]), s(start = 1 [mm]) "compression";
  Gravity field;
  body foot = Particle(mass = 0.5 [kg], at = {{0, 0, z}});
  body machine = Particle(mass = 20 [kg], at = {{0, 0, z - s}});
  force up = {{0, 0, {force}}} at machine;
  force down = {{0, 0, -({force})}} at foot;
  constraint floor: z >= 0 (restitution = 0.2);
end M;"""
    model = lagc.loads(text).compile(backend="numpy")
    runs = [model.simulate(0.2, method=m, rtol=r, points=2) for m, r in (("radau5", 1e-7), ("dop853", 1e-10))]
    assert [event.name for event in runs[0].events] == [event.name for event in runs[1].events]
    for name in ("z", "s"):
        assert runs[0].final[name] == pytest.approx(runs[1].final[name], abs=1e-6)


@pytest.mark.full
def test_dry_friction_of_a_joint_behind_a_stiff_shaft() -> None:
    """A wheel in a bearing with the friction torque T = mu r m g stops after J w0/T and sticks. The motion of
    a small motor beside it decays in a microsecond."""
    text = """model M
  parameter Inertia J = 0.1 [kg.m2], j = 1e-4 [kg.m2];
  parameter RotationalStiffness k = 1e6 [N.m/rad];
  parameter RotationalDamping c = 100 [N.m.s/rad];
  coordinate Angle b(rate = 10 [rad/s]) "of the motor";
  Gravity field(g = 9.81 [m/s2], direction = {0, -1, 0});
  body wheel = Solid(mass = 10 [kg], inertia = {J, J, J}, com = {0, 0, 0});
  body motor = Solid(mass = 1 [kg], inertia = {j, j, j}, frame = rotate_z(world, b), com = {0, 0, 0});
  joint bearing = Revolute(world, wheel, axis = world.z, at = {0, 0, 0}, friction = 0.2, radius = 50 [mm],
    angle(rate = 10 [rad/s]));
  potential shaft = 1/2*k*(bearing.angle - b)^2;
  dissipation loss = 1/2*c*(der(bearing.angle) - der(b))^2;
end M;"""
    run = lagc.loads(text).compile(backend="numpy").simulate(2.0, method="radau5", rtol=1e-8, points=2)
    ((t, name),) = [(event.t, event.name) for event in run.events]
    torque = 0.2 * 0.05 * 10.0 * 9.81
    assert name == "bearing sticks" and t == pytest.approx(0.1001 * 10.0 / torque, rel=1e-9)
    assert run.final["bearing.angle"] == pytest.approx(5.0 * t, rel=1e-9)
    assert run.cost.steps < 100
