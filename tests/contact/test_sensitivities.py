"""Sensitivities beside contacts, to the first event of one, against closed forms and differences of runs."""

import numpy as np
import pytest

import lagc
from lagc import Refused
from lagc.cli.main import main

BACKENDS = ["numpy", pytest.param("c", marks=pytest.mark.full)]


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_flight(backend: str) -> None:
    """y = h - g t^2/2: the restitution has no effect before the impact."""
    ball = lagc.load("bouncing_ball").compile(backend=backend)
    run = ball.simulate(0.4, accuracy=1e-9, sensitivity=["h", "e", "field.g"])
    assert run.status == "ok"
    t = np.array(run.t)
    assert np.allclose(run["d(y)/d(field.g)"], -(t**2) / 2.0, 0.0, 1e-12)
    assert np.allclose(run["d(y)/d(h)"], 1.0, 1e-12) and not any(run["d(y)/d(e)"])


@pytest.mark.parametrize("backend", BACKENDS)
def test_they_end_at_an_impact(backend: str) -> None:
    run = lagc.load("bouncing_ball").compile(backend=backend).simulate(1.0, sensitivity="h")
    assert run.status == "failed" and run.message.endswith("they end at t = 0.451524 s: floor: impact")
    known = ~np.isnan(run["d(y)/d(h)"])
    assert np.array_equal(known, np.array(run.t) < 0.4515236409857309)
    assert len(run["y"]) == 501 and not np.isnan(run["y"]).any()


@pytest.mark.full
@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(("name", "value"), [("l", 1.0), ("field.g", 9.81)])
def test_a_taut_rope_is_followed(backend: str, name: str, value: float) -> None:
    """Against differences of runs with 1e-12; the start moves with the rope."""
    model = lagc.load("slack_rope").compile(backend=backend)
    found = model.simulate(0.4, accuracy=1e-9, sensitivity=name)
    assert found.status == "ok"
    far = 1e-4 * value
    up, down = (model.simulate(0.4, accuracy=1e-12, parameters={name: value + s * far}) for s in (1, -1))
    for column in ("x", "z", "der(x)", "tension"):
        slopes = (np.array(up[column]) - np.array(down[column])) / (2.0 * far)
        size = np.abs(slopes).max()
        assert np.allclose(found[f"d({column})/d({name})"], slopes, 0.0, 1e-6 * size)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_block_that_sticks_to_its_belt(backend: str) -> None:
    """x = w t, and E = m w^2/2 + k x^2/2."""
    belt = lagc.load("block_on_belt").compile(backend=backend)
    run = belt.simulate(2.0, accuracy=1e-9, sensitivity=["w", "k"])
    t = np.array(run.t)
    assert run.status == "ok" and np.allclose(run["d(x)/d(w)"], t, 0.0, 1e-12)
    assert np.allclose(run["d(E)/d(k)"], (0.1 * t) ** 2 / 2.0, 0.0, 1e-12)


def test_what_is_not_followed() -> None:
    for name, code in (("incline", "LAG0623"), ("conveyor", "LAG0622")):
        with pytest.raises(Refused) as refused:
            lagc.load(name).compile(backend="numpy").simulate(0.1, sensitivity="mu")
        assert refused.value.faults[0].code == code
    with pytest.raises(Refused) as refused:
        lagc.load("bouncing_ball").compile(backend="numpy").simulate(0.1, sensitivity="nothing")
    assert refused.value.faults[0].code == "LAG0601"


def test_an_impact_at_the_start_leaves_none() -> None:
    ball = lagc.load("bouncing_ball").compile(backend="numpy")
    run = ball.simulate(0.2, starts={"y": 0.0, "der(y)": -1.0}, sensitivity="m")
    assert run.status == "failed" and "they end at t = 0 s: floor: impact" in run.message
    assert np.isnan(run["d(y)/d(m)"]).all()


def test_the_command_says_where_they_end(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sim", "bouncing_ball", "--sensitivity", "h"]) == 3
    assert "they end at t = 0.451524 s: floor: impact" in "".join(capsys.readouterr())
