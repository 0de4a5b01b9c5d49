"""Expressions over a finished run, against closed forms and outputs of the same text."""

import math
import pickle
from pathlib import Path

import numpy as np
import pytest

import lagc
from lagc.api.run import Run

TEXT = """
model Pendulum
  parameter Length l = 0.8 [m];
  parameter Mass m = 2 [kg];
  parameter Real unused = 3;
  coordinate Angle theta(start = 1 [rad]);
  body bob = Particle(mass = m, at = {l*sin(theta), 0, -l*cos(theta)});
  point middle = 0.5*position(bob);
  Gravity field;
  OUTPUTS
end Pendulum;
"""
PLAIN = TEXT.replace("OUTPUTS", "")
CONTACT = """
model Ball
  parameter Mass m = 1 [kg];
  coordinate Length z(start = 1 [m]);
  body ball = Particle(mass = m, at = {0, 0, z});
  Gravity field;
  constraint floor: ball.z >= 0 (restitution = 0.5);
end Ball;
"""


@pytest.fixture(scope="module")
def run() -> Run:
    return lagc.loads(PLAIN).compile(backend="numpy").simulate(2.0, points=41)


def test_an_expression_has_the_values_of_its_closed_form(run: Run) -> None:
    theta, rate = run["theta"], run["der(theta)"]
    bob = 0.8 * np.stack([np.sin(theta), 0.0 * theta, -np.cos(theta)], 1)
    assert run.position("bob") == pytest.approx(bob, abs=1e-15)
    assert run["position(bob)"] == pytest.approx(bob, abs=1e-15)
    assert run.position("middle") == pytest.approx(bob / 2, abs=1e-15)
    assert run["norm(velocity(bob))"] == pytest.approx(np.abs(0.8 * rate), rel=1e-12)
    assert run["2*theta + 1"] == pytest.approx(2 * theta + 1)
    acceleration = run["der(der(theta))"]
    assert acceleration == pytest.approx(-9.81 / 0.8 * np.sin(theta), rel=1e-12)
    tension = 2.0 * (9.81 * np.cos(theta) + 0.8 * rate**2)
    assert np.linalg.norm(run["reaction(bob)"], axis=1) == pytest.approx(np.abs(tension), rel=1e-9)
    assert (run.unit("reaction(bob)"), run.unit("theta"), run.unit("2")) == ("N", "rad", "")


def test_expressions_are_the_outputs_of_the_same_text(run: Run) -> None:
    """And the run with the outputs differs, since they count in its error estimate."""
    outputs = "output Force R[3] = reaction(bob); output Velocity s = norm(velocity(bob));"
    system = lagc.loads(TEXT.replace("OUTPUTS", outputs)).compile(backend="numpy").system
    rows = np.array([system.outputs(t, x) for t, x in zip(run.times, run.states)])
    assert np.abs(run["reaction(bob)"] - rows[:, :3]).max() <= 1e-9 * np.abs(rows[:, :3]).max()
    assert np.abs(run["norm(velocity(bob))"] - rows[:, 3]).max() <= 1e-9


def test_parameters_are_those_of_the_run() -> None:
    system = lagc.loads(PLAIN).compile(backend="numpy", parameters={"unused": 5.0})
    run = system.simulate(1.0, points=3, parameters={"l": (40.0, "cm")})
    assert np.linalg.norm(run.position("bob"), axis=1) == pytest.approx(0.4)
    assert run["unused*l"] == pytest.approx(2.0)


def test_a_run_keeps_its_columns_and_takes_more(run: Run, tmp_path: Path) -> None:
    own = lagc.loads(PLAIN).compile(backend="numpy").simulate(2.0, points=41)
    assert own.states == run.states and own.columns == run.columns
    own.add_columns("norm(velocity(bob))", "position(bob)")
    added = [name for name in own.columns if name not in run.columns]
    assert added == ["norm(velocity(bob))", *(f"position(bob)[{k}]" for k in (1, 2, 3))]
    assert [own.units[name] for name in added] == ["m/s", "m", "m", "m"]
    assert own.final["position(bob)[3]"] == own.position("bob")[-1, 2]
    own.save(str(tmp_path / "run.npz"))
    with np.load(tmp_path / "run.npz") as saved:
        assert (saved["position(bob)[1]"] == own.position("bob")[:, 0]).all()
    assert (pickle.loads(pickle.dumps(own)).position("bob") == own.position("bob")).all()


@pytest.mark.parametrize(
    ("wrong", "says"),
    [("tetha", "theta"), ("norm(velocity(boob))", "bob"), ("norm(", ""), ("theta + l", "dimension"), ("", ""),
     ("theta > 0", "number"), ("Gravity", "")],
)  # fmt: skip
def test_a_wrong_expression_is_a_key_error(run: Run, wrong: str, says: str) -> None:
    with pytest.raises(KeyError, match=says):
        run[wrong]
    assert wrong not in run


def test_evaluate_shows_the_place_of_a_fault(run: Run) -> None:
    with pytest.raises(lagc.Refused, match=r"<expression>:1:15"):
        run.evaluate("norm(velocity(boob))")


def test_an_expression_with_a_state_that_the_run_lacks_is_refused() -> None:
    run = lagc.loads(CONTACT).compile(backend="numpy").simulate(1.0, points=21)
    push = run["reaction(floor)"]
    assert push.min() == 0.0 and (run["ball.z"] >= -1e-12).all()
    with pytest.raises(lagc.Refused, match=r"impulse\(floor\)"):
        run.evaluate("impulse(floor)")
    text = CONTACT.replace("end Ball;", "  output Real[kg.m/s] j = impulse(floor);\nend Ball;")
    run = lagc.loads(text).compile(backend="numpy").simulate(1.0, points=21)
    assert run["impulse(floor)"].max() == pytest.approx(1.5 * math.sqrt(2 * 9.81), rel=1e-6)


def test_a_solution_without_a_model_has_columns_only(run: Run) -> None:
    bare = Run(**{name: getattr(run, name) for name in type(run).__match_args__})
    assert bare["theta"] is not None
    with pytest.raises(KeyError):
        bare["norm(velocity(bob))"]
    with pytest.raises(ValueError, match="no model"):
        bare.evaluate("theta")
