"""Loads of reactions and servo constraints beside contacts: closed forms, and equations by hand."""

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import lagc
from lagc.compiler import pipeline
from lagc.diagnostics.faults import Source

BACKENDS = ["numpy", pytest.param("c", marks=pytest.mark.full)]
G = 9.81
EXACT: dict[str, Any] = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-13}
WHEEL = """model Wheel
  coordinate Length x(rate = 3 [m/s]), z(start = 0.3 [m]);
  coordinate Angle phi(rate = 10 [rad/s]);
  frame B = rotate(world, world.y, phi);
  point C = {x, 0, z};
  body wheel = Solid(mass = 10 [kg], inertia = {0.4, 0.6, 0.4} [kg.m2], frame = B, com = C);
  Gravity field(g = 9.81 [m/s2]);
  constraint floor: z >= 0.3 [m] (friction = 0.5, slip = der(x) - 0.3 [m]*der(phi));
  torque resist = -0.006 [m]*LAW*tanh(der(phi)/(0.5 [rad/s]))*world.y on B;
  force drag = {-0.3 [kg/m]*der(x)*abs(der(x)), 0, 0} at C;
  output Force N = reaction(floor);
end Wheel;
"""
BLOCK = """model Block
  parameter Real k = 0.5;
  coordinate Length x(rate = 2 [m/s]), z(start = HEIGHT [m]);
  body p = Particle(mass = 2 [kg], at = {x, 0, z});
  Gravity field(g = 9.81 [m/s2]);
  constraint floor: z >= 0;
  force load = LOAD at p;
  output Force N = reaction(floor);
end Block;
"""


def block(load: str, height: float = 0.0) -> str:
    return BLOCK.replace("LOAD", load).replace("HEIGHT", str(height))


def ended(text: str, stop: float, backend: str = "numpy", **more: Any) -> Any:
    run = lagc.loads(text).compile(backend=backend).simulate(stop, accuracy=1e-9, **more)
    assert run.status == "ok" and run.estimated is not None and run.estimated <= 1e-9
    return run


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("law", ["reaction(floor)", "abs(reaction(floor))"])
def test_a_wheel_with_rolling_resistance(law: str, backend: str) -> None:
    """(m + I/r^2) x'' = -c x'^2 - f m g tanh(phi'/w0), while the wheel rolls."""

    def rates(_: float, y: Sequence[float]) -> list[float]:
        drag = 0.3 * y[1] * abs(y[1]) + 0.02 * 10.0 * G * math.tanh(y[1] / 0.3 / 0.5)
        return [y[1], -drag / (10.0 + 0.6 / 0.09)]

    known = solve_ivp(rates, (0.0, 2.0), [0.0, 3.0], **EXACT).y[:, -1]
    run = ended(WHEEL.replace("LAW", law), 2.0, backend)
    assert run.final["x"] == pytest.approx(known[0], abs=1e-8)
    assert run.final["der(x)"] == pytest.approx(known[1], abs=1e-8)
    assert run.final["N"] == pytest.approx(98.1, rel=1e-12) and not run.events


@pytest.mark.parametrize("reaction", ["floor", "line"])
def test_no_table_of_the_c_is_empty(reaction: str) -> None:
    """C has no empty tables; the load depends on the contact alone, or on the constraint alone."""
    text = WHEEL.replace("LAW", f"abs(reaction({reaction}))").replace(
        "output", "constraint line: y = 0; output"
    )
    text = text.replace("coordinate Angle", "coordinate Length y; coordinate Angle").replace(
        "{x, 0,", "{x, y,"
    )
    program = pipeline.delivered(pipeline.Compilation(Source("wheel", text), pipeline.Choice()))
    assert not any("[] = {}" in code for code in pipeline.render(program, "c").values())


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_block_that_lands_and_rubs(backend: str) -> None:
    """In flight nothing acts; from the impact on x'' = -c g x'. The energy balance counts the load."""
    run = ended(block("{-0.3 [s/m]*reaction(floor)*der(x), 0, 0}", 0.5), 1.0, backend)
    fall = math.sqrt(2.0 * 0.5 / G)
    rate = 0.3 * G
    assert [event.t for event in run.events] == pytest.approx([fall], abs=1e-9)
    assert run.final["der(x)"] == pytest.approx(2.0 * math.exp(-rate * (1.0 - fall)), abs=1e-8)
    gone = (1.0 - math.exp(-rate * (1.0 - fall))) / rate
    assert run.final["x"] == pytest.approx(2.0 * (fall + gone), abs=1e-8)
    assert run.energy is not None and abs(run.energy.imbalance) < 1e-7


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_load_along_the_contact(backend: str) -> None:
    """N = m g + k N, linear; N = m g - N^2/F, a quadratic equation."""
    assert ended(block("{0, 0, -k*reaction(floor)}"), 0.5, backend).final["N"] == pytest.approx(
        2.0 * G / 0.5, rel=1e-13
    )
    run = ended(block("{0, 0, reaction(floor)^2/(7 [N])}"), 0.5, backend)
    assert run.final["N"] == pytest.approx(0.5 * 7.0 * (math.sqrt(1.0 + 8.0 * G / 7.0) - 1.0), rel=1e-12)


@pytest.mark.parametrize("load", ["-k*reaction(floor)", "-k*abs(reaction(floor))"])
def test_a_load_that_presses_itself_on_has_no_motion(load: str) -> None:
    """N = m g + k N has no positive solution for k > 1."""
    model = lagc.loads(block("{0, 0, " + load + "}")).compile(backend="numpy")
    run = model.simulate(1.0, parameters={"k": 1.2})
    assert run.status == "failed" and "floor" in run.message


@pytest.mark.full
def test_a_load_that_lifts_off_has_two_motions() -> None:
    """Pulled up by more than its weight, m z'' = F - m g - k N + N: for k > 1 it may rise or stay."""
    text = block("{0, 0, -k*reaction(floor) + 30 [N]}")
    model = lagc.loads(text).compile(backend="numpy")
    assert model.simulate(0.5, parameters={"k": 0.5}).final["z"] > 0.1
    assert model.simulate(0.5, parameters={"k": 1.2}).status == "failed"


@pytest.mark.full
@pytest.mark.parametrize("backend", ["numpy", "c"])
def test_a_ball_with_viscous_sliding_friction(backend: str) -> None:
    """F = -c N u at the contact point, in space: u' = -(7/2) c g u, and the ball rolls in the end."""
    text = """model Ball
      coordinate Length x(rate = 2 [m/s]), y(rate = -1 [m/s]), z(start = 0.1 [m]);
      coordinate Orientation o(rate = {0, 0, 1} [rad/s]);
      frame B = rotate(world, o);
      point C = {x, y, z};
      body ball = Solid(mass = 1 [kg], inertia = 0.004*{1, 1, 1} [kg.m2], frame = B, com = C);
      Gravity field(g = 9.81 [m/s2]);
      constraint floor: z >= 0.1 [m];
      force rub = -0.05 [s/m]*reaction(floor)*velocity(ball, at = C - 0.1 [m]*world.z)
        on ball at C - 0.1 [m]*world.z;
    end Ball;"""
    run = ended(text, 1.0, backend)
    left = math.exp(-3.5 * 0.05 * G)
    assert run.final["der(x)"] == pytest.approx(2.0 * (1.0 - 2.0 / 7.0 * (1.0 - left)), abs=1e-8)
    assert run.final["der(y)"] == pytest.approx(-1.0 + 2.0 / 7.0 * (1.0 - left), abs=1e-8)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_rail_and_a_stop(backend: str) -> None:
    """A sleeve rubs on a rail with N = m g + k x, until a stop holds it; that bears F - mu N."""
    text = """model Sleeve
      coordinate Length x, z;
      body p = Particle(mass = 2 [kg], at = {x, 0, z});
      Gravity field(g = 9.81 [m/s2]);
      constraint rail: z = 0;
      constraint stop: x <= 0.5 [m];
      force pull = {10 [N], 0, -4 [N/m]*x} at p;
      force rub = {-0.2*abs(reaction(rail)), 0, 0} at p;
      output Force N = reaction(rail), S = reaction(stop);
    end Sleeve;"""
    run = ended(text, 1.0, backend)
    rate = math.sqrt(0.2 * 4.0 / 2.0)
    force = (10.0 - 0.2 * 2.0 * G) / 2.0  # x'' = force - rate^2 x
    hit = math.acos(1.0 - 0.5 * rate * rate / force) / rate
    assert [event.t for event in run.events] == pytest.approx([hit], abs=1e-8)
    assert run.final["N"] == pytest.approx(2.0 * G + 2.0, rel=1e-10)
    assert run.final["S"] == pytest.approx(10.0 - 0.2 * (2.0 * G + 2.0), rel=1e-10)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_load_of_a_contact_changes_the_rail(backend: str) -> None:
    """A stop that is pushed lifts the sleeve by half of its force: N_rail = m g - S/2, S = F - mu N_rail."""
    text = """model Sleeve
      coordinate Length x(start = 0.5 [m]), z;
      body p = Particle(mass = 2 [kg], at = {x, 0, z});
      Gravity field(g = 9.81 [m/s2]);
      constraint rail: z = 0;
      constraint stop: x <= 0.5 [m];
      force pull = {10 [N], 0, 0} at p;
      force rub = {-0.2*reaction(rail), 0, 0.5*reaction(stop)} at p;
      output Force N = reaction(rail), S = reaction(stop);
    end Sleeve;"""
    run = ended(text, 1.0, backend)
    stop = (10.0 - 0.2 * 2.0 * G) / (1.0 - 0.2 * 0.5)
    assert run.final["S"] == pytest.approx(stop, rel=1e-12)
    assert run.final["N"] == pytest.approx(2.0 * G - 0.5 * stop, rel=1e-12)


POLE = """model DrivenPole
  coordinate Length x;
  coordinate Angle theta(start = 0.4 [rad]);
  body cart = Particle(mass = 2 [kg], at = {x, 0, 0});
  body bob = Particle(mass = 0.5 [kg], at = {x + 0.6 [m]*sin(theta), 0, -0.6 [m]*cos(theta)});
  Gravity field(g = 9.81 [m/s2]);
  force motor = {1 [N], 0, 0} at cart;
  constraint path: x = 0.1 [m]*sin(4 [rad/s]*time) (by = motor);
  constraint wall: position(bob).x >= -0.1 [m] (restitution = 0.7);
  output Real u = reaction(path);
end DrivenPole;
"""


def driven_pole(stop: float) -> tuple[list[float], list[float]]:
    """The times of impacts, and theta, theta' at the end."""

    def moved(t: float) -> tuple[float, float, float]:
        return (0.1 * math.sin(4.0 * t), 0.4 * math.cos(4.0 * t), -1.6 * math.sin(4.0 * t))

    def rates(t: float, y: Sequence[float]) -> list[float]:
        return [y[1], (-G * math.sin(y[0]) - moved(t)[2] * math.cos(y[0])) / 0.6]

    def gap(t: float, y: Sequence[float]) -> float:
        return moved(t)[0] + 0.6 * math.sin(y[0]) + 0.1

    watch: Callable[..., float] = gap
    watch.terminal, watch.direction = True, -1.0  # type: ignore[attr-defined]
    t, y, hits = 0.0, [0.4, 0.0], list[float]()
    while True:
        found = solve_ivp(rates, (t, stop), y, events=watch, **EXACT)
        t, y = found.t[-1], list(found.y[:, -1])
        if found.status == 0:
            return hits, y
        hits.append(t)
        rate = moved(t)[1] + 0.6 * math.cos(y[0]) * y[1]
        y[1] = (-0.7 * rate - moved(t)[1]) / (0.6 * math.cos(y[0]))


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_driven_pole_hits_a_wall(backend: str) -> None:
    hits, known = driven_pole(3.0)
    run = ended(POLE, 3.0, backend)
    assert len(hits) > 1
    assert [event.t for event in run.events] == pytest.approx(hits, abs=1e-8)
    assert run.final["theta"] == pytest.approx(known[0], abs=1e-8)
    assert run.final["der(theta)"] == pytest.approx(known[1], abs=1e-7)


@pytest.mark.parametrize("backend", BACKENDS)
def test_an_actuator_gives_impulses(backend: str) -> None:
    """The motor at the first mass holds the distance of both. In an impact of the second one with a wall only
    the wall acts on it: its impulse is (1 + e) m2 v, that of the motor is m1 times the same change."""
    text = """model Relative
      coordinate Length x(rate = 1 [m/s], fixed = true), y(start = 0.2 [m]);
      body one = Particle(mass = 3 [kg], at = {x, 0, 0});
      body two = Particle(mass = 2 [kg], at = {x + y, 0, 0});
      force motor = {1 [N], 0, 0} at one;
      constraint path: y = 0.2 [m] (by = motor);
      constraint wall: x + y <= 0.7 [m] (restitution = 0.5);
      output Real P = impulse(wall)/(1 [N.s]);
    end Relative;"""
    run = ended(text, 1.0, backend)
    assert [event.t for event in run.events] == pytest.approx([0.5], abs=1e-9)
    assert run.final["x"] == pytest.approx(0.5 - 0.5 * 0.5, abs=1e-9)
    assert run.final["P"] == pytest.approx(1.5 * 2.0, rel=1e-9)


def test_a_path_into_a_wall_fails() -> None:
    text = POLE.replace("position(bob).x >= -0.1 [m] (restitution = 0.7)", "x <= 0.05 [m]")
    run = lagc.loads(text).compile(backend="numpy").simulate(2.0)
    assert run.status == "failed" and "wall" in run.message


@pytest.mark.full
def test_a_force_that_several_contacts_share_is_refused() -> None:
    """A beam on three feet: their forces are open, and so is a load of one."""
    text = """model Beam
      coordinate Length z;
      coordinate Angle a;
      frame B = rotate(world, world.y, a);
      body beam = Solid(mass = 2 [kg], inertia = {0.1, 0.1, 0.1} [kg.m2], frame = B, com = {0, 0, z});
      Gravity field;
      constraint left: z + 1 [m]*sin(a) >= 0;
      constraint middle: z >= 0;
      constraint right: z - 1 [m]*sin(a) >= 0;
      force load = {0, 0, -0.1*reaction(LABEL)} at beam;
    end Beam;"""
    run = lagc.loads(text.replace("LABEL", "left")).compile(backend="numpy").simulate(1.0)
    assert run.status == "failed" and "`reaction(left)`" in run.message


LEANING = """model Leaning
  PARAMETER
  coordinate Length x(rate = SPEED [m/s]);
  coordinate Angle a(start = 0.3 [rad]);
  body cart = Particle(mass = 2 [kg], at = x*world.AXIS);
  body tip = Particle(mass = 1 [kg], at = (x + l*cos(a))*world.AXIS + l*sin(a)*world.z);
  Gravity field(g = 9.81 [m/s2]);
  force pull = 3 [N]*world.AXIS at cart;
  constraint floor: position(tip).z >= 0.5 [m]*sin(0.3) (friction = 0.2, at = position(tip));
  HOLD
  output Force T = reaction(OWNER);
end Leaning;
"""


@pytest.mark.parametrize(("speed", "axis"), [("2", "y"), pytest.param("-2", "x", marks=pytest.mark.full)])
def test_a_release_that_moves_a_contact_counts_its_friction(speed: str, axis: str) -> None:
    """What holds the length of a bar whose tip slides is the multiplier of an explicit equation; and by hand,
    with the angle held by the floor, m x'' = -mu N s for the tip gives the force along the bar."""
    released = LEANING.replace("PARAMETER", "parameter Length l = 0.5 [m];").replace("HOLD", "")
    held = LEANING.replace("PARAMETER", "coordinate Length l(start = 0.5 [m]);")
    held = held.replace("HOLD", "constraint hold: l = 0.5 [m];")
    texts = [released.replace("OWNER", "l"), held.replace("OWNER", "hold")]
    found = [ended(text.replace("SPEED", speed).replace("AXIS", axis), 0.1).final["T"] for text in texts]
    assert found[0] == pytest.approx(found[1], rel=1e-9)
    side = math.copysign(1.0, float(speed))
    # N = m g - T sin(a) and x'' = (F - mu N side)/3; along x, x'' = T cos(a) - mu N side, with T on the tip
    matrix = [[math.sin(0.3), 1.0], [math.cos(0.3), -0.2 * side * (1.0 - 1.0 / 3.0)]]
    right = [G, 3.0 / 3.0]
    assert found[0] == pytest.approx(float(np.linalg.solve(matrix, right)[0]), rel=1e-9)


@pytest.mark.full
def test_linear_models_know_them() -> None:
    """N = m g + c x, so x'' = -(k + mu c) x/m - r g x' for a load -mu N - r N x'."""
    text = block("{-0.2*reaction(floor) - k*reaction(floor)*der(x)/(1 [m/s]), 0, -5 [N/m]*x}")
    text = text.replace("rate = 2", "rate = 0").replace(
        "  output", "  potential s = 1/2*3 [N/m]*x^2;\n  output"
    )
    model = lagc.loads(text).compile(backend="numpy")
    assert model.linearize().A[1] == pytest.approx([-(3.0 + 0.2 * 5.0) / 2.0, -0.5 * G], rel=1e-9)


@pytest.mark.full
def test_both_backends_are_equal_to_the_bit() -> None:
    for text in (WHEEL.replace("LAW", "reaction(floor)"), POLE):
        runs = [lagc.loads(text).compile(backend=b).simulate(1.0, accuracy=1e-9) for b in ("numpy", "c")]
        assert runs[0].states == runs[1].states and runs[0].events == runs[1].events
