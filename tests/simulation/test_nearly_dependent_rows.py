"""Rows that all but depend on others: what they demand is met, or the run does not end well."""

import math
import random

import pytest

import lagc
from lagc.simulation.solution import Solution

PAIR = """
model Pair "two rows of one plane, but for a small share; the planes meet in a line along {d}"
  parameter Mass m = 1 [kg];
  parameter Real e = {e!r};
  coordinate Length x, y, z;
  body b = Particle(mass = m, at = {{x, y, z}});
  constraint first: {first} = 0;
  constraint second: {first} + e*({second}) = 0;
  potential V = (1 [N])*({push});
end Pair;
"""
RODS = """
model Rods "two rods whose far ends are d apart: x = 0 follows, and nothing less"
  parameter Mass m = 1 [kg];
  parameter Length l = 1 [m], d = {d!r} [m];
  coordinate Length x, y, z(start = -1);
  body b = Particle(mass = m, at = {{x, y, z}});
  constraint first: norm({{x, y, z}}) = l;
  constraint second: norm({{x - d, y, z}}) = sqrt(l^2 + d^2);
  potential V = (9.8 [N])*z + (3 [N])*x + (1 [N])*y;
end Rods;
"""


def _sum(weights: list[int]) -> str:
    return " + ".join(f"({w})*{name}" for w, name in zip(weights, "xyz"))


@pytest.mark.sample(2)
@pytest.mark.parametrize("seed", range(12))
def test_a_share_of_its_own_is_met_or_told(seed: int) -> None:
    """Two planes through the origin at an angle of about e: the particle can move along their common
    line only, c = first x second, with the acceleration -(push . c) c / c^2 / m."""
    chance = random.Random(seed)
    c = [0, 0, 0]
    while not any(c):
        a, b, f = ([chance.randint(-3, 3) for _ in range(3)] for _ in range(3))
        c = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    e = 10.0 ** chance.uniform(-10.0, -2.0)
    run = _run(PAIR.format(d=c, e=e, first=_sum(a), second=_sum(b), push=_sum(f)))
    along = -0.5 * sum(x * y for x, y in zip(f, c)) / sum(x * x for x in c)
    off = max(abs(run[name][-1] - along * x) for name, x in zip("xyz", c))
    if run.status == "ok":
        assert off <= 1e-6 * max(1.0, max(abs(along * x) for x in c)) + 1e-15 / e
    else:
        assert "nearly depends on others" in run.message and e < 1e-3
        assert run.estimated is None or run.estimated > 1e-6
        assert math.isclose(float(run.message.split("share of ")[1].split()[0]), e, rel_tol=100.0)


def _run(text: str) -> Solution:
    return lagc.loads(text).compile(backend="numpy").simulate(1.0, points=21)


@pytest.mark.sample(1)
@pytest.mark.parametrize("d", [1e-2, 1e-3, 1e-5, 1e-6, 1e-8, 1e-10])
def test_two_rods_with_ends_close_together(d: float) -> None:
    run = _run(RODS.format(d=d))
    if run.status == "ok":
        assert abs(run["x"]).max() <= 1e-6
    else:
        assert "nearly depends on others" in run.message


def test_a_row_that_does_depend_is_no_fault() -> None:
    text = PAIR.format(d="y", e=0.0, first="x - y", second="z", push="x + 2*y + 3*z")
    run = _run(text)
    assert run.status == "ok"
    assert run["z"][-1] == pytest.approx(-1.5) and run["x"][-1] == pytest.approx(-0.75)
