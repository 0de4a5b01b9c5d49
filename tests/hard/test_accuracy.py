"""The error that a run reports is its error; where nothing can be foretold, it says so."""

from __future__ import annotations

import math

import numpy
import pytest

import lagc


def _kepler(t: numpy.ndarray, e: float) -> tuple[numpy.ndarray, ...]:
    """x, y, x', y' of the orbit with mu = a = 1 from the pericentre, by Newton on Kepler's equation."""
    mean = numpy.remainder(t, 2.0 * math.pi)
    anomaly = mean + e * numpy.sin(mean) / (1.0 - e + e * abs(mean - math.pi))  # any guess serves
    for _ in range(200):
        step = (anomaly - e * numpy.sin(anomaly) - mean) / (1.0 - e * numpy.cos(anomaly))
        anomaly = anomaly - numpy.clip(step, -0.5, 0.5)
    root, rate = math.sqrt(1.0 - e * e), 1.0 / (1.0 - e * numpy.cos(anomaly))
    return (
        numpy.cos(anomaly) - e,
        root * numpy.sin(anomaly),
        -numpy.sin(anomaly) * rate,
        root * numpy.cos(anomaly) * rate,
    )


@pytest.mark.parametrize("accuracy", [1e-4, 1e-6, 1e-8, 1e-9])
def test_reported_error_of_kepler_is_the_true_one(accuracy: float) -> None:
    run = lagc.load("classic/kepler").compile("comet").simulate(20.0 * math.pi, accuracy=accuracy)
    assert run.status == "ok", run.message
    exact = _kepler(run.t, 0.9)
    found = [run[n] for n in ("x", "y", "der(x)", "der(y)")]
    scales = [max(abs(found[0]).max(), abs(found[1]).max())] * 2
    scales += [max(abs(found[2]).max(), abs(found[3]).max())] * 2
    true = max(float(abs(f - x).max()) / s for f, x, s in zip(found, exact, scales))
    assert run.estimated is not None
    assert true <= accuracy
    assert true / 2.0 <= run.estimated <= max(2.0 * true, accuracy)
    assert true <= run.estimated * 2.0


def test_chaotic_motion_is_told_only_as_far_as_it_can_be_known() -> None:
    run = lagc.load("classic/double_pendulum").compile("chaotic").simulate(100.0, accuracy=1e-6)
    assert run.status != "ok"
    assert "foretold" in run.message
    horizon = run.times[-1]
    assert 5.0 < horizon < 60.0
    # up to the horizon the points are right: another run, much finer and by another method, agrees
    finer = lagc.load("classic/double_pendulum").compile("chaotic").simulate(
        horizon, method="dopri5", rtol=1e-13, atol=1e-13, points=2
    )  # fmt: skip
    for name in ("theta1", "theta2"):
        assert abs(run[name][-1] - finer[name][-1]) <= 1e-4
