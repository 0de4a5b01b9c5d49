"""Motions with more events than steps: a mass on a spring between two walls, whose phase is a triangle
wave, and a mass that is pushed back and forth."""

from math import asin, cos, hypot, sin
from random import Random

import pytest

import lagc
from lagc.api import Run
from lagc.simulation.global_error.verified_run import longest_step
from lagc.simulation.system import Options

pytestmark = pytest.mark.usefixtures("own_cache")

STOP, POINTS = 6.0, 61


class Walls:
    """`off` is the largest error of x, relative to its size."""

    def __init__(self, seed: int):
        chance = Random(seed)
        self.omega, wall, v = chance.uniform(0.5, 3.0), chance.uniform(0.2, 2.0), chance.uniform(0.3, 3.0)
        self.size = hypot(0.01, v / self.omega)
        self.top = asin(wall / self.size) if wall < self.size else 4.0
        self.largest = min(wall, self.size)
        text = f"""model M
          coordinate Real x(start = 0.01, rate = {v!r} [1/s]);
          body b = Particle(mass = 1 [kg], at = {{x, 0, 0}}*1 [m]);
          force f = {{-{self.omega!r}^2*x*1 [N], 0, 0}} at b;
          when x > {wall!r} then reinit(der(x), -der(x)); end when;
          when x < -{wall!r} then reinit(der(x), -der(x)); end when;
        end M;"""
        self.model = lagc.loads(text).compile(backend="numpy")

    def off(self, run: Run) -> float:
        return max(abs(x - self._place(t)) for t, x in zip(run.times, run["x"])) / self.largest

    def _place(self, t: float) -> float:
        phase = asin(0.01 / self.size) + self.omega * t
        if self.top < 4.0:
            phase = (phase + self.top) % (4.0 * self.top)
            phase = phase - self.top if phase < 2.0 * self.top else 3.0 * self.top - phase
        return self.size * sin(phase)


@pytest.mark.full
@pytest.mark.parametrize("seed", [15, 42, 62, 63, 65, 86, *range(12)])
def test_the_estimate_knows_of_all_times(seed: int) -> None:
    """Runs that are compared take other steps, also where each step ends at a change."""
    walls = Walls(seed)
    for accuracy in (1e-4, 1e-6, 1e-8):
        run = walls.model.simulate(STOP, accuracy=accuracy, points=POINTS)
        assert run.status == "ok" and run.estimated is not None, run.message
        assert walls.off(run) * walls.largest <= run.errors["x"], (accuracy, run.estimated)


KICK, AT = 0.5, 0.6
KICKED = f"""model M
  coordinate Real x(start = 1);
  body b = Particle(mass = 1 [kg], at = {{x, 0, 0}}*1 [m]);
  force f = {{-x*1 [N], 0, 0}} at b;
  when time > {AT}*1 [s] then reinit(der(x), der(x) + {KICK}*1 [1/s]); end when;
end M;"""


def test_halves_err_by_less_however_far_the_end_is() -> None:
    """Also where one step leads nearly there."""
    model = lagc.loads(KICKED).compile(backend="numpy")
    system, start = model.bind({}).system, model.simulate(1.0, method="dop853", points=2).states[0]

    def off(stop: float, tol: float, halves: bool) -> float:
        longest = longest_step(system, stop, None) * (tol / 1e-5) ** 0.125
        options = Options(method="dop853", rtol=tol, max_step=longest, halves=halves)
        run = system.integrate(options, 0.0, start, [stop * k / 40 for k in range(41)])
        exact = [cos(t) + KICK * sin(max(t - AT, 0.0)) for t in run.times]
        return max(abs(x[0] - there) for x, there in zip(run.states, exact))

    for k in range(12):
        stop = AT * (1.6 + 0.03 * k)
        assert off(stop, 1e-6, True) < 0.1 * off(stop, 1e-5, False), stop


@pytest.mark.sample(3)
@pytest.mark.parametrize("seed", [3, 81, 207, 297])
def test_a_crossing_is_located_on_the_step_that_ends_there(seed: int) -> None:
    """It is located on the dense output of a step that goes far beyond, which errs by more."""
    walls = Walls(seed)
    assert walls.off(walls.model.simulate(STOP, rtol=1e-6, points=POINTS)) < 1e-5


@pytest.mark.sample(2)
@pytest.mark.parametrize("seed", range(16))
def test_steps_that_times_cut_short_are_no_proof(seed: int) -> None:
    """An oscillator under a square wave: all runs would end steps at the same times, with like errors."""
    chance = Random(seed)
    omega, period, points = chance.uniform(1.0, 4.0), chance.uniform(0.1, 0.4), chance.choice([3, 7, 40])
    text = f"""model M
      coordinate Real x(start = 1, rate = 0.5 [1/s]);
      body b = Particle(mass = 1 [kg], at = {{x, 0, 0}}*1 [m]);
      force spring = {{-{omega!r}^2*x*1 [N], 0, 0}} at b;
      force f = {{if mod(time, {period!r} [s]) < {period / 2!r} [s] then 1 [N] else -1 [N], 0, 0}} at b;
    end M;"""

    def place(t: float) -> float:
        x, v, here, sign = 1.0, 0.5, 0.0, 1.0
        while True:
            until = min(here + period / 2, t)
            rest, turn = sign / omega**2, omega * (until - here)
            x, v = (
                rest + (x - rest) * cos(turn) + v / omega * sin(turn),
                -(x - rest) * omega * sin(turn) + v * cos(turn),
            )
            if until == t:
                return x
            here, sign = until, -sign

    model = lagc.loads(text).compile(backend="numpy")
    for accuracy in (1e-6, 1e-8, 1e-10):
        run = model.simulate(4.0, accuracy=accuracy, points=points)
        assert run.status == "ok" and run.estimated is not None, run.message
        off = max(abs(x - place(t)) for t, x in zip(run.times, run["x"]))
        assert off <= run.errors["x"] + 1e-13, (accuracy, off, run.errors)
