"""A run whose steps stability limits is told so, and no other one is."""

from __future__ import annotations

from typing import Any

import pytest

import lagc
from lagc.simulation.simulate import stability_note
from lagc.simulation.system import Options
from tests.simulation.test_radau import SLIDE, SPRING

pytestmark = pytest.mark.usefixtures("own_cache")
# Decays of 1e6/s and 1e-2/s; a slow pendulum on a spring that rings at 1e4 rad/s and decays.
DAMPED, PAIR = SLIDE, SPRING.replace("k = 1e6", "k = 1e8").replace("c = 0", "c = 2e3")


def integrated(text: str, stop: float, backend: str = "c", **given: Any) -> Any:
    system = lagc.loads(text).compile(backend=backend).load(backend)
    return system.integrate(Options(**given), 0.0, system.start(), [stop])


@pytest.mark.parametrize("text, rate", [(DAMPED, 1e6), (PAIR, 1e4)], ids=["decay", "ringing"])
@pytest.mark.parametrize("method, bound", [("dop853", 6.1), ("dopri5", 3.25)])
def test_steps_at_the_border_of_stability(text: str, rate: float, method: str, bound: float) -> None:
    """The steps are as long as the largest eigenvalue of the equations allows, whatever the tolerance. Where
    it is complex, single tests of a thousand steps miss it: about half of them find it."""
    stop, found, tests = 4e4 / rate, 0, 0
    for rtol in (1e-4, 1e-5, 1e-6, 1e-7):
        run = integrated(text, stop, method=method, rtol=rtol)
        assert run.steps == pytest.approx(stop * rate / bound, rel=0.4)
        found, tests = found + run.stiff, tests + run.steps // 1000
    assert found >= (0.6 if text == DAMPED else 0.4) * tests > 1


@pytest.mark.parametrize("method", ["dop853", "dopri5"])
@pytest.mark.parametrize("name", ["simple_pendulum", "double_pendulum", "four_bar"])
def test_steps_that_accuracy_limits(name: str, method: str) -> None:
    system = lagc.load(name).compile(backend="c").load("c")
    start = lagc.load(name).compile(backend="numpy").start()
    x = [*map(float, start), *[0.0] * (system.nx - len(start))]
    for rtol in (1e-3, 1e-6, 1e-10):
        run: Any = system.integrate(Options(method=method, rtol=rtol), 0.0, x, [200.0])
        assert run.stiff == 0


def test_c_and_python_count_the_same() -> None:
    one, two = (integrated(DAMPED, 1e-2, backend, rtol=1e-6) for backend in ("c", "numpy"))
    assert (one.steps, one.stiff) == (two.steps, two.stiff) and one.stiff > 0


def test_the_note_names_the_steps() -> None:
    run = integrated(DAMPED, 0.7, rtol=1e-6)
    assert run.steps > 100_000
    (note,) = stability_note(run)
    assert str(run.steps) in note and "--method radau5" in note
    assert not stability_note(run.changed(steps=99_999)) and not stability_note(run.changed(stiff=1))


@pytest.mark.full
def test_a_run_has_the_note() -> None:
    model = lagc.loads(DAMPED).compile(backend="c")
    assert any("stability limited" in note for note in model.simulate(0.7, rtol=1e-6).notes)
    assert not any("stability limited" in note for note in model.simulate(0.1, rtol=1e-6).notes)
