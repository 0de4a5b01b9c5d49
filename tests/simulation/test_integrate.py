"""One trajectory: steps, landing, dense output, what stops it; in Python, on systems written by hand."""

from math import cos, inf, nan, sin, sqrt
from random import Random

import pytest

from lagc.kernels import EXPLICIT
from lagc.simulation.system import (
    INCONSISTENT,
    INTERRUPTED,
    MAX_STEPS,
    NOT_FINITE,
    OK,
    STEP_UNDERFLOW,
    Options,
    Vector,
)
from tests.interfaces import interface
from tests.simulation.handmade import integrate, integrator, project
from tests.simulation.systems import LINE, Handmade, Oscillator, Rod, norm

EACH = pytest.mark.parametrize("method", ["dop853", "dopri5"])
EVERY = pytest.mark.parametrize("method", EXPLICIT)


@EACH
@pytest.mark.parametrize("end", [0.1, 1.0 / 3.0, 7.3, -2.0])
def test_the_end_is_met_exactly(method: str, end: float) -> None:
    run = integrate(Oscillator(), Options(method=method), 0.25, [cos(0.25), -sin(0.25)], [end])
    assert run.t == end and run.times == [end] and run.states == [run.x]
    assert run.x[0] == pytest.approx(cos(end), abs=1e-7)


@EACH
def test_the_grid_does_not_change_the_steps(method: str) -> None:
    options = Options(method=method, rtol=1e-8, atol=1e-8)
    bare = integrate(Oscillator(), options, 0.0, [1.0, 0.0], [5.0])
    fine = integrate(Oscillator(), options, 0.0, [1.0, 0.0], [0.01 * i for i in range(500)] + [5.0])
    assert (bare.x, bare.steps, bare.rejected) == (fine.x, fine.steps, fine.rejected)
    assert len(fine.states) == 501 and fine.times[0] == 0.0 and fine.states[0] == [1.0, 0.0]
    assert max(abs(x[0] - cos(t)) for t, x in zip(fine.times, fine.states)) < 5e-7


@EVERY
def test_steps_may_be_fixed(method: str) -> None:
    run = integrate(Oscillator(), Options(method=method, step=0.1), 0.0, [1.0, 0.0], [0.55, 1.0])
    assert run.steps == 10 and run.rejected == 0 and run.t == 1.0
    run = integrate(Oscillator(), Options(method=method, step=0.1), 0.0, [1.0, 0.0], [1.05])
    assert run.steps == 11 and run.t == 1.05


@EVERY
def test_fixed_steps_do_not_pile_up_rounding(method: str) -> None:
    run = integrator(Oscillator(), Options(method=method, step=0.1), 0.0, [1.0, 0.0])
    for k in range(1, 1001):
        assert run.step(100.0) == OK
        assert run.t == (k * 0.1 if k < 1000 else 100.0)


def test_advancing_in_pieces_keeps_the_step() -> None:
    """Landing on a near time does not make the next step short."""
    run = integrator(Oscillator(), Options(), 0.0, [1.0, 0.0])
    for _ in range(3):
        assert run.step(5.0) == OK
    planned = run.h
    end = run.t + 1e-3
    assert run.step(end) == OK and run.t == end
    assert run.h >= planned


def test_first_and_largest_steps_are_obeyed() -> None:
    run = integrator(Oscillator(), Options(first_step=1e-3), 0.0, [1.0, 0.0])
    run.step(1.0)
    assert run.t == 1e-3
    limited = integrate(Oscillator(), Options(max_step=0.05), 0.0, [1.0, 0.0], [1.0])
    assert 20 <= limited.steps <= 25


def test_the_number_of_steps_may_be_limited() -> None:
    run = integrate(Oscillator(), Options(max_steps=5), 0.0, [1.0, 0.0], [0.1, 100.0])
    assert run.status == MAX_STEPS and run.steps + run.rejected == 5
    assert run.times == [0.1] and run.t < 100.0 and run.x[0] == pytest.approx(cos(run.t), abs=1e-7)


@pytest.mark.parametrize("method", ["dop853", "dopri5"])
def test_one_attempt_a_call_gets_on(method: str) -> None:
    """Also where each first step is far too long: what was learned from a rejection is kept."""
    run = integrator(Oscillator(), Options(method, first_step=50.0), 0.0, [1.0, 0.0])
    calls = 0
    while run.t < 10.0 and calls < 1000:
        calls += 1
        run.options.max_steps = 1
        assert run.advance(10.0) in (OK, MAX_STEPS)
    assert run.t == 10.0 and run.steps + run.rejected == calls
    assert run.x[0] == pytest.approx(cos(10.0), abs=1e-6)


class Interrupted(Rod):
    """The rod, with Ctrl-C in one of its evaluations, or in one of its constraints."""

    def __init__(self, after: int) -> None:
        super().__init__()
        self.left = after

    def count(self) -> None:
        self.left -= 1
        if self.left == 0:
            raise KeyboardInterrupt

    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        self.count()
        return super().rhs(t, x, xdot, lam)

    def velocity(self, t: float, x: Vector) -> list[float]:
        self.count()
        return super().velocity(t, x)


@pytest.mark.sample(6)
@pytest.mark.parametrize("seed", range(20))
def test_what_was_recorded_is_whole_wherever_an_interruption_comes(seed: int) -> None:
    """Time and state belong together, and the states are those of the run that was not interrupted."""
    times, x = [0.01 * i for i in range(201)], [0.6, -0.8, 0.8, 0.6]
    counted = Interrupted(0)
    whole = integrate(counted, Options(), 0.0, x, times)
    after = Random(seed).randrange(1, -counted.left)
    run = integrate(Interrupted(after), Options(), 0.0, x, times)
    assert run.status == INTERRUPTED and run.t < 2.0
    assert run.states == whole.states[: len(run.states)] and run.times == times[: len(run.times)]
    there = integrate(Rod(), Options(), 0.0, x, [run.t])
    assert run.x == pytest.approx(there.x, abs=1e-7) and run.rhs < after
    assert not run.times or run.times[-1] <= run.t


class Wall(Handmade):
    """x'' = -1/sqrt(x) (not a number beyond x = 0), from x = 1 at rest."""

    def __init__(self, beyond: float) -> None:
        super().__init__(interface(**LINE))
        self.beyond = beyond

    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        xdot[0], xdot[1] = x[1], -1.0 / sqrt(x[0]) if x[0] > 0.0 else self.beyond
        return OK


@EACH
@pytest.mark.parametrize("beyond", [nan, inf])
def test_what_is_not_a_number_stops_the_run_there(method: str, beyond: float) -> None:
    """x' = -2 sqrt(1 - sqrt x): it falls to x = 0 in 4/3 s."""
    times = [0.1 * i for i in range(1, 21)]
    run = integrate(Wall(beyond), Options(method=method), 0.0, [1.0, 0.0], times)
    assert run.status in (NOT_FINITE, STEP_UNDERFLOW)
    assert run.t == pytest.approx(4.0 / 3.0, abs=1e-4)
    assert len(run.states) == 13 and run.states[-1][0] > 0.0


class Silent(Wall):
    """The same, with a status of its own."""

    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        if x[0] > 0.0:
            return super().rhs(t, x, xdot, lam)
        self.culprit = 1
        return NOT_FINITE


def test_the_culprit_is_kept() -> None:
    run = integrate(Silent(nan), Options(), 0.0, [1.0, 0.0], [2.0])
    assert (run.status, run.culprit) == (NOT_FINITE, 1)
    run = integrate(Silent(nan), Options(), 0.0, [-1.0, 0.0], [2.0])
    assert (run.status, run.culprit, run.t, run.states) == (NOT_FINITE, 1, 0.0, [])
    run = integrate(Silent(nan), Options(step=0.1), 0.0, [1.0, 0.0], [2.0])
    assert run.status == NOT_FINITE and run.t == pytest.approx(1.3)


class Explosion(Handmade):
    """x' = x^2 from 1: infinite at t = 1."""

    def __init__(self) -> None:
        super().__init__(interface(**LINE))

    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        xdot[0], xdot[1] = x[0] * x[0], 0.0
        return OK


@EACH
def test_a_pole_is_not_passed(method: str) -> None:
    run = integrate(Explosion(), Options(method=method), 0.0, [1.0, 0.0], [2.0])
    assert run.status in (STEP_UNDERFLOW, NOT_FINITE) and run.t == pytest.approx(1.0, abs=1e-6)


class Worked(Oscillator):
    """The oscillator with an integral that no step follows."""

    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        xdot[2] = 1e6 * sin(1e4 * t)
        return super().rhs(t, x, xdot, lam)


@EACH
def test_the_work_integral_does_not_choose_the_steps(method: str) -> None:
    plain = integrate(Oscillator(), Options(method=method), 0.0, [1.0, 0.0], [5.0])
    worked = integrate(Worked(nz=1), Options(method=method), 0.0, [1.0, 0.0, 0.0], [5.0])
    assert worked.steps == plain.steps and worked.x[:2] == plain.x


def test_without_projection_the_constraint_drifts() -> None:
    free = Options(rtol=1e-6, atol=1e-6, project=False)
    run = integrate(Rod(), free, 0.0, [0.6, -0.8, 0.8, 0.6], [10.0])
    assert run.status == OK and abs(norm(run.x[:2]) - 1.0) > 1e-10
    assert run.position_drift == 0.0


@EACH
def test_projection_costs_no_evaluation(method: str) -> None:
    """The rate at the projected state is the first stage of the next step, and only evaluated there."""
    count, order = (12, 8) if method == "dop853" else (6, 5)
    run = integrate(Rod(), Options(method=method), 0.0, [0.6, -0.8, 0.8, 0.6], [3.0])
    tried = run.steps + run.rejected
    arrivals = tried if order == 5 else run.steps
    assert run.rhs == 2 + (count - 1) * tried + arrivals


def test_projection_is_the_shortest_way() -> None:
    """In the metric of the (unit) mass matrix: along the radius, and to the square of the distance."""
    x = [0.6 * 1.001, -0.8 * 1.001, 0.8 + 0.006, 0.6 - 0.008]
    status, position, velocity = project(Rod(), 0.0, x, [0.0, 1.0, 1.0])
    assert status == OK and position <= 1e-15 and velocity <= 1e-15
    assert x == pytest.approx([0.6, -0.8, 0.8, 0.6], abs=2e-6)


def test_a_constraint_that_cannot_be_met_is_said_so() -> None:
    class Impossible(Rod):
        def position(self, t: float, x: Vector) -> list[float]:
            return [x[0] * x[0] + x[1] * x[1] + 1.0]

    status, position, _ = project(Impossible(), 0.0, [0.6, -0.8, 0.8, 0.6], [0.0, 1.0, 1.0])
    assert status == INCONSISTENT and position > 0.1
