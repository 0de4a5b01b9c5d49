"""Loads that depend on reactions: closed forms, and the same motion with the reaction eliminated by hand."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import lagc
from lagc.diagnostics.faults import Refused

BACKENDS = ["numpy", pytest.param("c", marks=pytest.mark.full)]
G = 9.81
RAIL = """model Rail
  parameter Real mu = 0.2;
  parameter Angle b = 0.5 [rad];
  coordinate Length x, z;
  body p = Particle(mass = 2 [kg], at = {x, 0, z});
  constraint rail: z*cos(b) = x*sin(b);
  Gravity field(g = 9.81 [m/s2]);
  force pull = {30 [N], 0, 0} at p;
  force rub = -mu*LAW*{cos(b), 0, sin(b)} at p;
  output Force N = reaction(rail);
end Rail;
"""
HOOP = """model Hoop
  parameter Real mu = 0.05;
  coordinate Length x(rate = 7 [m/s], fixed = true), z(start = -1 [m]);
  body p = Particle(mass = 2 [kg], at = {x, 0, z});
  constraint hoop: norm(position(p)) = 1 [m];
  Gravity field(g = 9.81 [m/s2]);
  force rub = -mu*abs(reaction(hoop))*normalize(velocity(p)) at p;
end Hoop;
"""
LOCK = """model Lock
  parameter Real mu = 0.5;
  coordinate Length x(rate = 1 [m/s]), z;
  body p = Particle(mass = 2 [kg], at = {x, 0, z});
  constraint rail: z = 0;
  Gravity field(g = 9.81 [m/s2]);
  force brake = SIGNmu*abs(reaction(rail))*world.z at p;
  output Force N = reaction(rail);
end Lock;
"""


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("law", ["reaction(rail)", "abs(reaction(rail))"])
def test_a_block_that_rubs_on_a_rail(law: str, backend: str) -> None:
    """N = m g cos(b) + F sin(b), m a = F cos(b) - m g sin(b) - mu N."""
    run = lagc.loads(RAIL.replace("LAW", law)).compile(backend=backend).simulate(1.0, accuracy=1e-9)
    normal = 2.0 * G * math.cos(0.5) + 30.0 * math.sin(0.5)
    a = (30.0 * math.cos(0.5) - 2.0 * G * math.sin(0.5) - 0.2 * normal) / 2.0
    assert run.final["N"] == pytest.approx(normal, rel=1e-13)
    assert run.final["x"] == pytest.approx(0.5 * a * math.cos(0.5), rel=1e-12)


@pytest.mark.parametrize("method", ["dop853", pytest.param("radau5", marks=pytest.mark.full)])
@pytest.mark.parametrize("backend", BACKENDS)
def test_a_bead_on_a_rough_hoop(backend: str, method: str) -> None:
    """theta'' = -g sin(theta) - mu |theta'^2 + g cos(theta)|: the force on the bead changes its side."""

    def rates(_: float, y: Sequence[float]) -> list[float]:
        return [y[1], -G * math.sin(y[0]) - 0.05 * abs(y[1] ** 2 + G * math.cos(y[0]))]

    def side(_: float, y: Sequence[float]) -> float:
        return y[1] ** 2 + G * math.cos(y[0])

    exact: dict[str, Any] = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-13, "max_step": 1e-3}
    known = solve_ivp(rates, (0.0, 0.9), [0.0, 7.0], events=side, **exact)
    run = lagc.loads(HOOP).compile(backend=backend).simulate(0.9, accuracy=1e-9, method=method)
    assert run.status == "ok" and run.estimated is not None and run.estimated <= 1e-9
    assert [event.t for event in run.events] == pytest.approx(known.t_events[0], abs=1e-8)
    assert abs(run.final["x"] - math.sin(known.y[0, -1])) <= run.estimated + 1e-11
    assert math.hypot(run.final["der(x)"], run.final["der(z)"]) == pytest.approx(known.y[1, -1], abs=1e-8)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_journal_bearing(backend: str) -> None:
    """The friction by the length of a vector of reactions, beside a fixed point of the equation of motion."""
    inertia = 0.1 + 2.0 * 0.5**2

    def rates(_: float, y: Sequence[float]) -> list[float]:
        force, before = 2.0 * G, 0.0
        while abs(force - before) > 1e-15 * force:
            before = force
            rub = 0.2 * 0.02 * force * math.tanh(y[1] / 0.1)
            a = (-2.0 * G * 0.5 * math.sin(y[0]) - rub) / inertia
            x = 0.5 * (a * math.cos(y[0]) - y[1] ** 2 * math.sin(y[0]))
            z = 0.5 * (a * math.sin(y[0]) + y[1] ** 2 * math.cos(y[0]))
            force = 2.0 * math.hypot(x, z + G)
        return [y[1], a]

    start = [math.atan2(3.0, 4.0), 0.0]
    known = solve_ivp(rates, (0.0, 1.5), start, "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    run = lagc.load("journal_bearing").compile(backend=backend).simulate(1.5, accuracy=1e-9)
    assert run.status == "ok" and run.estimated is not None
    assert abs(run.final["theta"] - known[0]) <= run.estimated + 1e-11
    assert run.final["der(theta)"] == pytest.approx(known[1], abs=1e-8)


def test_a_brake_that_presses_itself_on() -> None:
    """N = m g + mu |N|: m g/(1 - mu) below mu = 1, no value above."""
    model = lagc.loads(LOCK.replace("SIGN", "-")).compile(backend="numpy")
    assert model.simulate(1.0, parameters={"mu": 0.99}).final["N"] == pytest.approx(200.0 * G, rel=1e-12)
    run = model.simulate(1.0, parameters={"mu": 1.2})
    assert run.status == "failed" and "reaction(rail)" in run.message


def test_a_brake_with_two_forces_is_refused() -> None:
    """N = m g - mu |N|: m g/(1 + mu) for mu < 1; for mu > 1 also m g/(1 - mu)."""
    model = lagc.loads(LOCK.replace("SIGN", "")).compile(backend="numpy")
    assert model.simulate(1.0).final["N"] == pytest.approx(2.0 * G / 1.5, rel=1e-12)
    run = model.simulate(1.0, parameters={"mu": 1.2})
    assert run.status == "failed" and "or several" in run.message


@pytest.mark.full
def test_linear_models_know_them() -> None:
    """N = m g + c x presses with mu N: x'' = -(k + mu c) x/m - mu g."""
    text = """model Pressed
      coordinate Length x, z;
      body p = Particle(mass = 2 [kg], at = {x, 0, z});
      constraint rail: z = 0;
      Gravity field(g = 9.81 [m/s2]);
      potential spring = 1/2*3 [N/m]*x^2;
      force press = {0, 0, -5 [N/m]*x} at p;
      force rub = {-0.2*reaction(rail), 0, 0} at p;
    end Pressed;"""
    linear = lagc.loads(text).compile(backend="numpy").linearize()
    assert linear.A[1][0] == pytest.approx(-(3.0 + 0.2 * 5.0) / 2.0, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("constraint again: 2*der(z) = 0;\n  force F = {-0.1*reaction(again), 0, 0} at b;", "LAG0431"),
        ("force F = -1 [kg]*acceleration(b) at b;", "LAG0219"),
    ],
)
def test_refusals(text: str, code: str) -> None:
    model = f"""model M
  coordinate Length x, z;
  body b = Particle(mass = 1 [kg], at = {{x, 0, z}});
  constraint rail: z = 0;
  {text}
end M;"""
    with pytest.raises(Refused) as caught:
        lagc.loads(model).compile(backend="numpy")
    assert caught.value.faults[0].code == code and caught.value.faults[0].remedy


def test_taylor_series_do_not_follow_them() -> None:
    with pytest.raises(Refused) as caught:
        lagc.loads(HOOP).compile(backend="numpy").simulate(0.1, method="taylor")
    assert caught.value.faults[0].code == "LAG0591"


@pytest.mark.full
@pytest.mark.parametrize("backend", ["numpy", "c"])
def test_sensitivities_follow_them(backend: str) -> None:
    """A bead that rubs on a parabola, against central differences of the fourth order."""
    text = """model Ramp
      parameter Real mu = 0.2; parameter Length l = 1 [m];
      coordinate Length x(start = l, rate = 1 [m/s]), y;
      body b = Particle(mass = 2 [kg], at = {x, y, 0});
      Gravity field(g = 9.81 [m/s2], direction = {0, -1, 0});
      constraint ramp: y = -0.5*x^2/(1 [m]);
      force rub = {-mu*abs(reaction(ramp))*der(x)/(1 [m/s]), 0, 0} at b;
    end Ramp;"""
    model = lagc.loads(text).compile(backend=backend)
    run = model.simulate(0.8, accuracy=1e-9, points=5, sensitivity=["mu", "l"])
    assert run.status == "ok", run.message
    for name, value in (("mu", 0.2), ("l", 1.0)):
        step = 1e-3 * value
        x = [
            model.simulate(0.8, accuracy=1e-12, points=5, parameters={name: value + k * step})["x"]
            for k in (-2, -1, 1, 2)
        ]
        slope = (8.0 * (x[2] - x[1]) - (x[3] - x[0])) / (12.0 * step)
        assert np.allclose(run[f"d(x)/d({name})"], slope, 0.0, 1e-9)
