"""The error of each quantity alone: against truth, and named where the accuracy of the group hides it."""

from __future__ import annotations

from math import cos, pi, sin, sqrt

import pytest

import lagc
from tests.simulation.test_generated import BACKENDS

FAST_SLOW = """\
model FastSlow "1000 Hz at a nanometre beside 1 Hz at a metre"
  parameter Mass m = 1 [kg];
  parameter Stiffness k = 40 [N/m], K = 4e7 [N/m];
  coordinate Length slow(start = 1 [m]), fast(start = 1e-9 [m]);
  body a = Particle(mass = m, at = {slow, 0, 0});
  body b = Particle(mass = m, at = {0, fast, 0});
  potential p = 1/2*k*slow^2 + 1/2*K*fast^2;
  output Length sum = slow + fast;
end FastSlow;
"""
SPRING = """\
model Spring
  coordinate Length x(start = 0.5 [m]), y;
  body b = Particle(mass = 2 [kg], at = {x, 0, 0});
  body c = Particle(mass = 2 [kg], at = {0, y, 0});
  potential V = 4 [N/m]*(x^2 + y^2);
  output Energy E = energy();
  output Velocity v = der(x);
end Spring;
"""


@BACKENDS
@pytest.mark.parametrize("accuracy", [1e-3, 1e-6])
def test_a_small_quantity_beside_a_large_one_is_named(backend: str, accuracy: float) -> None:
    """The error bar of each is above its true error, from the closed form."""
    run = lagc.loads(FAST_SLOW).compile(backend=backend).simulate(2, accuracy=accuracy, points=101)
    assert run.status == "ok"
    (note,) = [note for note in run.notes if "own ranges" in note]
    assert "`fast` by" in note and "`slow`" not in note and "`sum`" not in note
    for name, size, omega in (("slow", 1.0, sqrt(40.0)), ("fast", 1e-9, sqrt(4e7))):
        true = max(abs(x - size * cos(omega * t)) for t, x in zip(run.t, run[name]))
        assert (
            true <= 1.01 * run.errors[name]
        )  # two runs of an oscillation can differ by less than their error
        assert run.errors[name] < 200.0 * accuracy


@BACKENDS
def test_errors_of_states_and_outputs(backend: str) -> None:
    run = lagc.loads(SPRING).compile(backend=backend).simulate(5, accuracy=1e-7)
    assert set(run.errors) == {"x", "y", "der(x)", "der(y)", "E", "v"}
    assert not [note for note in run.notes if "own ranges" in note]  # y stays at 0, E is constant
    true = max(abs(x - 0.5 * cos(2 * t)) for t, x in zip(run.t, run["x"]))
    speed = max(abs(v + sin(2 * t)) for t, v in zip(run.t, run["v"]))
    assert true <= run.errors["x"] < 1e-6 and speed <= 1.5 * run.errors["v"] < 1e-5 and run.errors["y"] == 0.0
    again = lagc.loads(SPRING).compile(backend=backend).simulate(5, accuracy=1e-7)
    assert again.errors == run.errors  # also for a run that is remembered
    found = run.to_dict()
    assert found["errors"] == run.errors


def test_runs_that_are_not_verified_have_no_errors() -> None:
    assert lagc.loads(SPRING).compile(backend="numpy").simulate(1, rtol=1e-6).errors == {}


@pytest.mark.parametrize("start", [0.0, pi])
def test_a_pendulum_at_rest_names_nothing(start: float) -> None:
    run = lagc.load("simple_pendulum").compile(backend="numpy").simulate(1, starts={"theta": start})
    assert not [note for note in run.notes if "own ranges" in note]


STEEP = """\
model Steep "outputs that peak between two looks or at the end, and a value that a clause keeps"
  coordinate Length x(start = 1 [m], rate = 0);
  discrete Length kept(start = 0);
  discrete Boolean late(start = false);
  body b = Particle(mass = 1 [kg], at = {x, 0, 0});
  potential V = 2 [N/m]*x^2;
  output Real peak = 1/((time/(1 [s]) - 3.16)^2 + 1e-4)*x/(1 [m]);
  output Real last = 1/(10.001 - time/(1 [s]))*x/(1 [m]);
  when time > 3.15 [s] then
    reinit(kept, x);
    reinit(late, true);
  end when;
end Steep;
"""


@BACKENDS
def test_outputs_that_peak_once_and_kept_values(backend: str) -> None:
    """The error bars hold for every recorded time, also for the last one; closed form."""
    run = lagc.loads(STEEP).compile(backend=backend).simulate(10, accuracy=1e-5)
    assert run.status == "ok"
    for name, factor in (
        ("peak", lambda t: 1 / ((t - 3.16) ** 2 + 1e-4)),
        ("last", lambda t: 1 / (10.001 - t)),
    ):
        true = max(abs(value - factor(t) * cos(2 * t)) for t, value in zip(run.t, run[name]))
        assert 0.0 < true <= run.errors[name] < 1.0
    assert 0.0 < abs(run["kept"][-1] - cos(2 * 3.15)) <= run.errors["kept"] < 1e-4
    assert run.errors["late"] == 0.0
