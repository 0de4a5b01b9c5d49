"""simulate: the accuracy asked is had and told, failures are named, what was computed is kept."""

from math import cos
from typing import Any

import pytest

from lagc.diagnostics.faults import Refused
from lagc.simulation.request import Request
from lagc.simulation.simulate import simulate
from tests.simulation.systems import Massless, Oscillator, Runaway

pytestmark = pytest.mark.usefixtures("no_cache")


@pytest.mark.sample(4)
@pytest.mark.parametrize(("stop", "most"), [(10.0, 3.0), (300.0, 3.0)])
@pytest.mark.parametrize("accuracy", [1e-3, 1e-5, 1e-6, 1e-8, 1e-10, 1e-12])
def test_the_estimate_is_not_less_than_the_true_error_nor_much_more(
    accuracy: float, stop: float, most: float
) -> None:
    """The difference of the run and its check is .77 of the error; the margin is 1.2 to 3."""
    run = simulate(Oscillator(), Request(stop=stop, accuracy=accuracy))
    true = max(abs(x - cos(t)) for t, x in zip(run.times, run.column("x"))) / 2.0  # of its range
    assert run.status == "ok" and run.estimated is not None
    assert true <= run.estimated <= accuracy
    assert run.estimated <= most * true


@pytest.mark.parametrize("accuracy", [1e-2, 1e-5, 1e-10])
def test_dop853_serves_all_accuracies(accuracy: float) -> None:
    assert simulate(Oscillator(), Request(stop=1.0, accuracy=accuracy)).method == "dop853"


def test_an_accuracy_beyond_double_precision_is_said_to_be() -> None:
    run = simulate(Oscillator(), Request(stop=10.0, accuracy=1e-15))
    assert run.status == "failed" and "1e-15" in run.message and "double precision" in run.message
    assert len(run.times) == 501 and run.times[-1] == 10.0  # kept
    assert run.estimated is not None and 1e-15 < run.estimated < 1e-12


def test_a_motion_that_runs_away_fails_at_its_time_and_keeps_what_was_computed() -> None:
    run = simulate(Runaway(), Request(stop=10.0, accuracy=1e-6))
    assert run.status == "failed" and run.times
    # x'^2 / 2 = exp(x) - 1/2, from x = 0: the time of the end is the integral of 1/x'
    assert 1.0 < run.times[-1] < 2.0
    assert "t = 1." in run.message
    assert all(a == a for a in run.column("x"))


def test_a_vanishing_mass_is_named() -> None:
    run = simulate(Massless(), Request(stop=10.0, accuracy=1e-6))
    assert run.status == "failed"
    assert "mass matrix is singular" in run.message and "`der(x)`" in run.message
    assert run.times[-1] <= 1.0


def test_a_fixed_step_is_taken_as_asked() -> None:
    system = Oscillator()
    run = simulate(system, Request(stop=1.0, method="dopri5", step=0.125))
    assert run.cost.steps == 8 and run.asked is None and run.estimated is None and run.step == 0.125


def test_interruption_keeps_what_was_computed() -> None:
    seen: list[float] = []

    def progress(t: float) -> None:
        seen.append(t)
        if t > 3.0:
            raise KeyboardInterrupt

    run = simulate(Oscillator(), Request(stop=10.0, rtol=1e-6), progress=progress)
    assert run.interrupted and run.status == "failed"
    assert 1.0 < run.times[-1] <= seen[-1] and len(run.times) == len(run.states)


def test_an_interrupted_verification_returns_the_part_that_was_made() -> None:
    def progress(t: float) -> None:
        if t > 4.0:
            raise KeyboardInterrupt

    run = simulate(Oscillator(), Request(stop=10.0, accuracy=1e-9), progress=progress)
    assert run.interrupted and run.status == "failed" and 0.0 < run.times[-1] < 10.0
    assert run.states[-1][0] == pytest.approx(cos(run.times[-1]), abs=1e-6)


@pytest.mark.parametrize(
    "request_, word",
    [
        (Request(stop=-1.0), "stop"), (Request(stop=float("nan")), "stop"),
        (Request(stop=float("inf")), "stop"), (Request(accuracy=0.0), "accuracy"),
        (Request(accuracy=2.0), "accuracy"), (Request(accuracy=1e-6, rtol=1e-6), "accuracy"),
        (Request(step=0.1, rtol=1e-6), "step"), (Request(step=0.0), "step"),
        (Request(max_step=0.0), "max_step"), (Request(step=0.1, max_step=0.1), "max_step"),
        (Request(points=1), "points"), (Request(points=10, every=0.1), "every"),
        (Request(every=1e-30), "points"), (Request(points=10**20), "points"),
    ],
)  # fmt: skip
def test_requests_without_sense_are_refused(request_: Request, word: str) -> None:
    with pytest.raises(Refused) as refused:
        simulate(Oscillator(), request_)
    assert all(f.code == "LAG0604" for f in refused.value.faults)
    assert word in refused.value.faults[0].message


def test_a_scene_gives_what_was_not_asked() -> None:
    scene = {"stop": 3.0, "accuracy": 1e-4, "every": 0.5}
    done = Request().completed(scene)
    assert (done.stop, done.accuracy, done.every) == (3.0, 1e-4, 0.5)
    by_hand = Request(rtol=1e-5, points=7).completed(scene)
    assert (by_hand.accuracy, by_hand.every, by_hand.points) == (None, None, 7)
    assert Request().completed({"maxstep": 0.25}).max_step == 0.25
    assert Request(step=0.5).completed({"maxstep": 0.25}).max_step is None
    assert Request(max_step=0.5).completed({"step": 0.25}).step is None


@pytest.mark.parametrize("asked", [{"rtol": 1e-3}, {"accuracy": 1e-3}, {"accuracy": 1e-7}])
def test_no_step_is_longer_than_the_longest(asked: dict[str, float]) -> None:
    class Widest(Oscillator):
        def integrate(self, options, t0, x0, times, progress=None):  # type: ignore[no-untyped-def]
            found = super().integrate(options, t0, x0, times, progress)
            assert found.steps >= 4.0 / 0.05 / 1.01  # a step may be 1 % longer to end the run
            return found

    free = simulate(Oscillator(), Request(stop=4.0, **asked))
    bound = simulate(Widest(), Request(stop=4.0, max_step=0.05, **asked))
    assert free.cost.steps < 4.0 / 0.05 <= 1.01 * bound.cost.steps
    assert bound.status == "ok" and bound.states[-1][0] == pytest.approx(cos(4.0), abs=1e-3)
    if bound.estimated is not None:
        error = max(abs(x[0] - cos(t)) for t, x in zip(bound.times, bound.states))
        assert error <= bound.estimated


def test_the_recorded_grid() -> None:
    assert Request(stop=1.0, every=0.3).grid() == [0.0, 0.3, 0.6, 3 * 0.3, 1.0]
    assert Request(stop=0.3, every=0.1).grid() == [0.0, 0.1, 0.2, 0.3]
    assert Request(stop=1.0, points=3).grid() == [0.0, 0.5, 1.0]
    assert Request(stop=0.0).grid() == [0.0]


def test_a_run_of_no_duration_is_its_start() -> None:
    run = simulate(Oscillator(), Request(stop=0.0))
    assert run.status == "ok" and run.states == [[1.0, 0.0]]


@pytest.mark.parametrize("size", [1e-7, 1e6])
def test_the_accuracy_is_relative_to_the_size_of_the_motion(size: float) -> None:
    class Scaled(Oscillator):
        def start(self) -> list[float]:
            return [size, 0.0]

    run = simulate(Scaled(), Request(stop=10.0, accuracy=1e-8))
    true = max(abs(x / size - cos(t)) for t, x in zip(run.times, run.column("x"))) / 2.0  # of its range
    assert run.status == "ok" and run.estimated is not None
    assert true <= run.estimated <= 1e-8


@pytest.mark.parametrize(
    ("scene", "asked", "found"),
    [
        ({"step": 0.25}, {"method": "rk4"}, {"step": 0.25, "rtol": None}),
        ({"rtol": 1e-3, "atol": 1e-5}, {"method": "dopri5"}, {"rtol": 1e-3, "atol": 1e-5, "step": None}),
        ({"rtol": 1e-3, "atol": 1e-5}, {"rtol": 1e-4}, {"rtol": 1e-4, "atol": 1e-5}),
        ({"rtol": 1e-3, "atol": 1e-5}, {"step": 0.1}, {"rtol": None, "atol": None, "step": 0.1}),
        ({"step": 0.25}, {"rtol": 1e-4}, {"rtol": 1e-4, "step": None}),
        ({"step": 0.25}, {"accuracy": 1e-4}, {"accuracy": 1e-4, "step": None}),
        ({"accuracy": 1e-4}, {"method": "dopri5"}, {"accuracy": None, "rtol": None}),
    ],
)
def test_what_a_scene_states_holds_unless_something_else_is_asked(
    scene: dict[str, Any], asked: dict[str, Any], found: dict[str, Any]
) -> None:
    request = Request(**asked).completed(scene)
    assert {name: getattr(request, name) for name in found} == found
