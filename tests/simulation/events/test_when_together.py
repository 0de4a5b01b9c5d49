"""Clauses that act at one moment: balls of one mass that meet from both sides pass their speeds on."""

from math import asin, hypot, pi, sin, sqrt

import pytest

import lagc

pytestmark = pytest.mark.usefixtures("own_cache")

WIDE = 0.1


def balls(starts: str, rates: str, more: str = "") -> str:
    return f"""model Balls
      parameter Length d = 0;
      parameter Stiffness k = 7;
      coordinate Length x[3](start = {starts}, rate = {rates});
      for i in 1:3 loop
        body b[i] = Particle(mass = 1 [kg], at = {{x[i], 0, 0}});
      end for;
      {more}
      for i in 1:2 loop
        when x[i+1] - x[i] < {WIDE} [m] then
          reinit({{der(x[i]), der(x[i+1])}}, {{der(x[i+1]), der(x[i])}});
        end when;
      end for;
    end Balls;"""


@pytest.mark.sample(1)
@pytest.mark.parametrize("backend", ["numpy", "c"])
def test_what_one_clause_ends_the_next_makes_true_again(backend: str) -> None:
    """The first two part, the last two drive them together again, and they part once more.  So it is beside,
    where they meet one after the other."""
    system = lagc.loads(balls("{-1 [m] - d, 0 [m], 1 [m]}", "{1, 0, -1}")).compile(backend=backend)
    for places in (0, 1, -1, 2, -3, 7, 50, 1e3, 1e9):
        apart = places * 2.0**-53
        run = system.simulate(2.0, rtol=1e-9, parameters={"d": apart})
        assert run.status == "ok" and len(run.events) == 3, (places, run.events)
        assert [run[f"der(x[{i}])"][-1] for i in (1, 2, 3)] == pytest.approx([-1.0, 0.0, 1.0])
        there = [run[f"x[{i}]"][-1] for i in (1, 2, 3)]
        assert there == pytest.approx([-1.2, 0.0, 1.2], abs=1e-12 + 3.0 * abs(apart))


@pytest.mark.parametrize("accuracy", [1e-4, 1e-8, 1e-11])
def test_runs_in_which_clauses_act_together_or_one_after_the_other_agree(accuracy: float) -> None:
    """On springs, from both sides at a time: each outer one swings, and the middle one is its wall."""
    springs = "potential s = k/2*((x[2] - x[1] - 0.2 [m])^2 + (x[3] - x[2] - 0.2 [m])^2);"
    text = balls("{-1/3, 0.05, 1/3 + 0.1}", "{0.7, 0, -0.7}", springs)
    run = lagc.loads(text).compile(backend="numpy").simulate(4.0, accuracy=accuracy)
    assert run.status == "ok" and run.estimated is not None, run.message
    assert len(run.events) == 9
    omega, rest = sqrt(7.0), 0.05 - 0.2
    begin, wall = -1.0 / 3.0 - rest, 0.05 - WIDE - rest
    size = hypot(begin, 0.7 / omega)
    turn = pi - asin(wall / size)  # the phase behind the wall
    largest = max(map(abs, run["x[1]"]))
    for t, left, middle, right in zip(run.t, run["x[1]"], run["x[2]"], run["x[3]"]):
        phase = turn + (2.0 * pi + asin(begin / size) + omega * t - turn) % (3.0 * pi - 2.0 * turn)
        place = rest + size * sin(phase)
        off = max(abs(left - place), abs(middle - 0.05), abs(right - 0.1 + place))
        assert off <= run.estimated * largest
