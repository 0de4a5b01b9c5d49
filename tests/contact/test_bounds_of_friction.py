"""Friction that cannot be is refused; what it couples and what it spoils is told."""

import math

import pytest

import lagc
from lagc.compiler.pipeline import Contents, delivered
from lagc.diagnostics.faults import Refused

SLOPE = """model M
  parameter Real mu = 0.4, mu_s = 0.5, one = 1;
  parameter Length r = 5 [mm];
  coordinate Length s(rate = {rate} [m/s]), n;
  Gravity field(g = 9.81 [m/s2]);
  body block = Particle(mass = 1 [kg], at = {{s*cos(12 [deg]), 0, -s*sin(12 [deg])}} + n*{{0, 0, 1}});
  {rows}
  scene run
    simulate(stop = 0.5 [s]);
  end run;
end M;
"""


def _model(rows: str, rate: float = 0.0) -> lagc.ModelFile:
    return lagc.loads(SLOPE.format(rows=rows, rate=rate))


@pytest.mark.parametrize("relation", ["=", ">="])
def test_static_friction_below_that_of_sliding_is_refused(relation: str) -> None:
    text = f"constraint slope: n {relation} 0 [m] (friction = mu, static = mu_s, slip = der(s));"
    compiled = _model(text).compile(backend="numpy")
    with pytest.raises(Refused) as refused:
        compiled.simulate(parameters={"mu_s": 0.3})
    assert [fault.code for fault in refused.value.faults] == ["LAG0617"]
    assert compiled.simulate(accuracy=1e-6).final["s"] == 0.0


@pytest.mark.parametrize("relation", ["=", ">="])
def test_static_friction_is_at_least_that_of_sliding(relation: str) -> None:
    """Where it depends on the slip: tan(12 deg) = .21 is above `static`, and below what friction holds."""
    law = "friction = 0.1*one + 0.2*exp(-slip/(0.1 [m/s])), static = 0.2"
    model = _model(f"constraint slope: n {relation} 0 [m] ({law}, slip = der(s));")
    run = model.compile(backend="numpy").simulate(accuracy=1e-6)
    assert run.status == "ok" and run.final["s"] == 0.0 and 0.2 < math.tan(math.radians(12.0)) < 0.3


def test_a_pin_has_no_negative_radius() -> None:
    pin = """  body rod = Solid(mass = 1 [kg], inertia = {0, 0.1, 0.1} [kg.m2], com = {0.5 [m], 0, 0});
  joint pin = Revolute(world, rod, axis = world.y, at = {0, 0, 0}, friction = 0.2, radius = -5 [mm]);"""
    with pytest.raises(Refused) as refused:
        _model(pin).compile(backend="numpy")
    assert [fault.code for fault in refused.value.faults] == ["LAG0235"]


@pytest.mark.parametrize("relation", ["=", ">="])
@pytest.mark.parametrize("method", ["radau5", "taylor"])
def test_no_code_of_a_method_that_follows_no_contacts(relation: str, method: str) -> None:
    model = _model(f"constraint slope: n {relation} 0 [m] (friction = mu, slip = der(s));")
    with pytest.raises(Refused) as refused:
        delivered(model.compile().compilation, Contents([method]))
    assert [fault.code for fault in refused.value.faults] == ["LAG0623"]


def test_friction_couples_what_it_presses_with_what_it_slows() -> None:
    rows = """constraint slope: n = 0 [m] (friction = 0.05, slip = der(s));
  force up = {0, 0, 20[N]*sin(3[rad/s]*time)} at block;"""
    fixed = rows.replace(" (friction = 0.05, slip = der(s))", "")
    texts = [SLOPE.format(rows=text, rate=1.0).replace("12 [deg]", "0") for text in (rows, fixed)]
    notes = [" ".join(lagc.loads(text).compile(backend="numpy").interface.notes) for text in texts]
    assert ["independent" in note for note in notes] == [False, True]
