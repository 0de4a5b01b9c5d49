"""Conditions of reactions, accelerations and energies, against closed forms."""

import json
import math

import numpy as np
import pytest

import lagc
from lagc.cli.main import main
from lagc.compiler import pipeline
from lagc.compiler.stages import Choice
from lagc.syntax.parse import Source

BACKENDS = ["numpy", pytest.param("c", marks=pytest.mark.full)]
G = 9.81
STRING = """model StringPendulum
  parameter Mass m = 2 [kg];
  parameter Length l = 1 [m];
  coordinate Length x(rate = 6 [m/s], fixed = true), z(start = -1 [m]);
  body bob = Particle(mass = m, at = {x, 0, z});
  constraint string: norm(position(bob)) = l;
  Gravity field(g = 9.81 [m/s2]);
  when -reaction(string) < 0 then terminate("slack"); end when;
  output Force T = -reaction(string);
end StringPendulum;
"""


def _slack() -> tuple[float, float]:
    """Angle and time at which the string is slack: m v^2/l + m g cos(theta) = 0, and the time by the energy,
    v^2 = v0^2 - 2 g l (1 - cos(theta))."""
    angle = math.acos((2.0 * G - 36.0) / (3.0 * G))
    places, weights = np.polynomial.legendre.leggauss(60)
    theta = angle * (places + 1.0) / 2.0
    return angle, float(np.sum(weights * angle / 2.0 / np.sqrt(36.0 - 2.0 * G * (1.0 - np.cos(theta)))))


def test_the_time_of_the_closed_form() -> None:
    assert _slack()[1] == pytest.approx(0.48446613, abs=5e-9)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    "method", ["dop853", *(pytest.param(m, marks=pytest.mark.full) for m in ("dopri5", "radau5", "taylor"))]
)
def test_a_string_goes_slack(backend: str, method: str) -> None:
    angle, time = _slack()
    run = lagc.loads(STRING).compile(backend=backend).simulate(2.0, accuracy=1e-9, method=method)
    assert run.status == "terminated" and run.estimated is not None
    assert run.events[-1].t == pytest.approx(time, abs=1e-9)
    assert abs(run.final["x"] - math.sin(angle)) <= run.estimated
    assert abs(run.final["z"] + math.cos(angle)) <= run.estimated
    assert abs(run.final["T"]) < 1e-6


@pytest.mark.parametrize("force", [5.0, 20.0, 29.0])
def test_a_string_breaks_at_a_force(force: float) -> None:
    """cos(theta) = F/(3 m g), for a force that holds a parameter."""
    run = lagc.load("string_breaks").compile(backend="numpy").simulate(parameters={"F": force}, accuracy=1e-9)
    assert run.status == "terminated" and run.estimated is not None
    angle = math.acos(force / (3.0 * G))
    assert abs(run.final["theta"] - angle) <= run.estimated * math.pi / 2.0


def test_the_force_of_a_joint_trips() -> None:
    """A rod of length 2 s, let go level: the pin bears m g (cos/4 along the swing, 5 sin/2 along the rod)."""
    text = """model Arm
      body arm = Solid(mass = 3 [kg], inertia = {1, 1, 1} [kg.m2], com = {0.5 [m], 0, 0});
      joint pin = Revolute(world, arm, axis = world.y, at = {0, 0, 0});
      Gravity field(g = 9.81 [m/s2]);
      when norm(reaction(pin).force) > 45 [N] then terminate("the pin breaks"); end when;
    end Arm;"""
    run = lagc.loads(text).compile(backend="numpy").simulate(3.0, accuracy=1e-9)
    turn, moment = math.sin(run.final["pin.angle"]), 1.0 + 3.0 * 0.25
    along = 3.0 * G * turn + 3.0 * 0.5 * 2.0 * 3.0 * G * 0.5 * turn / moment
    across = 3.0 * G * math.cos(run.final["pin.angle"]) * (1.0 - 3.0 * 0.25 / moment)
    assert run.status == "terminated" and math.hypot(along, across) == pytest.approx(45.0, abs=1e-6)


@pytest.mark.parametrize("backend", BACKENDS)
def test_an_acceleration_trips_where_the_force_grows_and_where_it_jumps(backend: str) -> None:
    text = """model Drive
      coordinate Length x;
      discrete Real n(start = 0);
      body b = Particle(mass = 2 [kg], at = {x, 0, 0});
      force F = {if time > 1 [s] then 20 [N] else 2 [N/s]*time, 0, 0} at b;
      when der(der(x)) > 5 [m/s2] then reinit(n, n + 1); mark("jump"); end when;
      when acceleration(b).x > 0.5 [m/s2] then reinit(n, n + 10); mark("growth"); end when;
    end Drive;"""
    run = lagc.loads(text).compile(backend=backend).simulate(3.0, accuracy=1e-9)
    assert run.status == "ok" and run.final["n"] == 11.0
    times = {event.name: event.t for event in run.events}
    assert times["growth"] == pytest.approx(0.5, abs=1e-12) and times["jump"] == 1.0


@pytest.mark.full
def test_all_crossings_of_an_acceleration_are_found() -> None:
    """The acceleration of a driven mass is the force: its crossings are those of a sum of sines."""
    text = """model Driven
      coordinate Length x;
      discrete Real n(start = 0);
      body b = Particle(mass = 1 [kg], at = {x, 0, 0});
      force F = {3 [N]*sin(time*1.3 [1/s]) + 1 [N]*sin(time*7.1 [1/s]), 0, 0} at b;
      when der(der(x)) > 1.5 [m/s2] then reinit(n, n + 1); end when;
    end Driven;"""
    run = lagc.loads(text).compile(backend="numpy").simulate(20.0, accuracy=1e-6)
    t = np.linspace(0.0, 20.0, 200001)
    above = 3.0 * np.sin(1.3 * t) + np.sin(7.1 * t) > 1.5
    assert run.final["n"] == np.count_nonzero(above[1:] & ~above[:-1]) > 5


def test_an_energy_that_friction_takes_trips() -> None:
    """v = v0 exp(-c t): half of the energy is left at t = log(2)/(2c)."""
    text = """model Damped
      coordinate Length x(rate = 3 [m/s]);
      body b = Particle(mass = 1 [kg], at = {x, 0, 0});
      force drag = -0.4 [kg/s]*velocity(b) at b;
      when energy() < 2.25 [J] then terminate("half"); end when;
    end Damped;"""
    run = lagc.loads(text).compile(backend="numpy").simulate(3.0, accuracy=1e-10)
    assert run.t[-1] == pytest.approx(math.log(2.0) / 0.8, abs=1e-9)


@pytest.mark.parametrize("backend", BACKENDS)
def test_the_force_of_a_contact_trips(backend: str) -> None:
    """A ball that lands, stays, and is pressed with 10 N/s: 20 N at (20 - 9.81)/10 s."""
    text = """model Scale
      coordinate Length z(start = 1 [m]);
      body b = Particle(mass = 1 [kg], at = {0, 0, z});
      constraint floor: z >= 0 (restitution = 0);
      force push = {0, 0, -10 [N/s]*time} at b;
      Gravity field(g = 9.81 [m/s2]);
      when reaction(floor) > 0 then mark("lands"); end when;
      when reaction(floor) > 20 [N] then terminate("overload"); end when;
    end Scale;"""
    run = lagc.loads(text).compile(backend=backend).simulate(3.0, accuracy=1e-9)
    impact = next(event.t for event in run.events if event.kind == "impact")
    assert [event.t for event in run.events if event.name == "lands"] == [impact]
    assert run.status == "terminated" and run.t[-1] == pytest.approx(1.019, abs=1e-12)


@pytest.mark.full
def test_a_change_of_the_limit_moves_the_event() -> None:
    """x = cos(w t) is stopped where x'' = -c, at w t = acos(c/w^2); then x = (c/w^2) cos(w (T - t))."""
    text = """model Stop
      parameter Acceleration c = 1.5 [m/s2];
      coordinate Length x(start = 1 [m]);
      body b = Particle(mass = 1 [kg], at = {x, 0, 0});
      potential spring = 1/2*4 [N/m]*x^2;
      when der(der(x)) > -c then reinit(der(x), 0); end when;
    end Stop;"""
    run = lagc.loads(text).compile(backend="numpy").simulate(1.0, accuracy=1e-9, sensitivity=["c"])
    time, w = math.acos(1.5 / 4.0) / 2.0, 2.0
    rest = w * (1.0 - time)
    shift = -1.0 / (w**3 * math.sin(w * time))
    expected = math.cos(rest) / w**2 + 1.5 / w**2 * w * math.sin(rest) * shift
    assert run.sensitivity("x", "c")[-1] == pytest.approx(expected, rel=1e-7)


def test_until_a_force(capsys: pytest.CaptureFixture[str]) -> None:
    """The tension m (v^2/l + g cos(theta)) is m g (3 cos(theta) - 2 cos(60 deg))."""
    assert main(["sim", "string_pendulum", "--until", "-reaction(string) > 15[N]", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["status"] == "terminated"
    assert -found["final"]["z"] / 0.5 == pytest.approx((15.0 / G + 1.0) / 3.0, rel=1e-6)


@pytest.mark.full
def test_a_reaction_without_a_load_trips_nothing() -> None:
    """A rail that bears nothing: its reaction is round-off, if anything."""
    text = """model Rail
      parameter Angle b = 0.3 [rad];
      coordinate Length x(start = 1 [m], rate = 0.7 [m/s]), z(start = tan(0.3)*1 [m]);
      body p = Particle(mass = 1.3 [kg], at = {x, 0, z});
      constraint rail: z*cos(b) = x*sin(b);
      potential spring = 1/2*3 [N/m]*(x^2 + z^2);
      when reaction(rail) < 0 then terminate("noise"); end when;
      when reaction(rail) > 0 then terminate("noise"); end when;
    end Rail;"""
    run = lagc.loads(text).compile(backend="numpy").simulate(20.0, accuracy=1e-9)
    assert run.status == "ok", run.message


def test_models_without_such_conditions_carry_none_of_it() -> None:
    for text, there in ((STRING, True), (STRING.replace("-reaction(string) < 0", "z > 0"), False)):
        program = pipeline.program(Source("string.lag", text), Choice())
        assert ("late" in program.functions) == there == bool(program.interface.late_relations)
        (code,) = [v for k, v in pipeline.render(program, "c").items() if k.endswith(".c")]
        assert ("w->late.values" in code) == there
