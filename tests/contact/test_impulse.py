"""Impulses of contacts as variables, and discrete variables beside contacts: closed forms."""

import json
import math

import pytest

import lagc
from lagc.cli.main import main
from lagc.diagnostics.faults import Refused

BACKENDS = ["numpy", pytest.param("c", marks=pytest.mark.full)]
G = 9.81
HEAD = """model M
  coordinate Length z(start = 1 [m]), x;
  discrete Real n(start = 0);
  Gravity field(g = 9.81 [m/s2]);
  body ball = Particle(mass = 2 [kg], at = {x, 0, z});
"""


@pytest.mark.parametrize("backend", BACKENDS)
def test_the_impulse_of_a_bouncing_ball(backend: str) -> None:
    """m (1 + e) e^n sqrt(2 g h), from each impact until the next."""
    run = lagc.load("dropped_parcel").compile(backend=backend).simulate(accuracy=1e-9, points=401)
    first = math.sqrt(2.0 / G)
    impacts = [first * (1.0 + 2.0 * sum(0.5**j for j in range(1, k + 1))) for k in range(6)]
    for t, blow in zip(run.t, run["blow"]):
        k = sum(t >= time for time in impacts)
        if k < len(impacts) and min(abs(t - time) for time in impacts) > 1e-9:
            assert blow == pytest.approx(
                2.0 * 1.5 * 0.5 ** (k - 1) * math.sqrt(2.0 * G) if k else 0.0, rel=1e-9
            )
    assert run.status == "ok" and run.estimated is not None and run.estimated < 1e-9
    assert run.final["blow"] == 0.0 and run.errors["blow"] < 1e-7  # it rests after ever softer impacts
    assert run.final["hurts"] == 1.0  # the condition stays true until a blow is softer
    assert run.final["hardest"] == pytest.approx(3.0 * math.sqrt(2.0 * G), rel=1e-12)


def test_a_blow_that_is_too_hard_ends_the_run() -> None:
    model = lagc.load("dropped_parcel").compile(backend="numpy")
    run = model.simulate(parameters={"limit": 13.0})
    assert run.status == "terminated" and run.t[-1] == pytest.approx(math.sqrt(2.0 / G), abs=1e-9)
    assert model.simulate(parameters={"limit": 14.0}).status == "ok"


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_discrete_switch_lifts_a_body_from_its_contact(backend: str) -> None:
    """On from 1 s with the force 20 N on 1 kg, off at 1 m: time and speed of the fall that follows."""
    text = """model Lift
      coordinate Length z(start = 0);
      discrete Real on(start = 0);
      body b = Particle(mass = 1 [kg], at = {0, 0, z});
      constraint floor: z >= 0 (restitution = 0);
      Gravity field(g = 9.81 [m/s2]);
      force lift = {0, 0, on*20 [N]} at b;
      when time > 1 [s] then reinit(on, 1); end when;
      when z > 1 [m] then reinit(on, 0); end when;
      when impulse(floor) > 0 then terminate("down"); end when;
    end Lift;"""
    run = lagc.loads(text).compile(backend=backend).simulate(4.0, accuracy=1e-9)
    up, a = math.sqrt(2.0 / (20.0 - G)), 20.0 - G
    speed = math.sqrt((a * up) ** 2 + 2.0 * G)
    assert run.t[-1] == pytest.approx(1.0 + up + (a * up + speed) / G, abs=1e-11)
    assert run.final["impulse(floor)"] == pytest.approx(speed, rel=1e-11)
    assert [event.kind for event in run.events if event.kind] == ["opens", "impact"]


def test_each_component_of_a_vector_has_its_own() -> None:
    text = f"""{HEAD}  constraint walls: {{z, x}} >= {{0, -1 [m]}} (restitution = 0.5);
  force wind = {{-4 [N], 0, 0}} at ball;
  output Real J[2] = {{impulse(walls)[1], impulse(walls)[2]}}/(1 [N.s]);
end M;"""
    run = lagc.loads(text).compile(backend="numpy").simulate(1.05, accuracy=1e-9)
    assert run.final["J[1]"] == pytest.approx(
        2.0 * 1.5 * math.sqrt(2.0 * G) * 0.5, rel=1e-9
    )  # the second one
    assert run.final["J[2]"] == pytest.approx(2.0 * 1.5 * 2.0, rel=1e-9)  # at 1 s, with 2 m/s


def test_the_summary_has_it(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sim", "dropped_parcel", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["final"]["hardest"] == pytest.approx(3.0 * math.sqrt(2.0 * G), rel=1e-6)
    assert found["final"]["impulse(floor)"] == 0.0


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("output Real J = impulse(ball)/(1 [N.s]);", "LAG0221"),
        ("constraint rail: x = 0;\n  output Real J = impulse(rail)/(1 [N.s]);", "LAG0221"),
        ("output Force J = impulse(floor);", "LAG0302"),
        ("constraint rail: x = impulse(floor)*1 [s/kg];", "LAG0232"),
    ],
)
def test_refusals(text: str, code: str) -> None:
    with pytest.raises(Refused) as caught:
        lagc.loads(f"{HEAD}  constraint floor: z >= 0;\n  {text}\nend M;").compile(backend="numpy")
    assert caught.value.faults[0].code == code and caught.value.faults[0].remedy
