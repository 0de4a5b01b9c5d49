"""Mechanisms with steep functions: unstated values move as far as the stated ones ask for."""

import math
import random

import pytest

from lagc.simulation.initialization.initialize import consistent_start
from tests.simulation.initialization.generated_starts import system_of

CHAIN = """\
model Chain "A follower, a cam, gears, and a crank that a nut on its slider drives"
  coordinate Angle a, b, c, d;
  coordinate Length h, x, y;
  body f = Particle(mass = 1, at = {x, y, h});
  body p = Solid(mass = 1, inertia = {1, 1, 1}, frame = rotate_z(world, a), com = {0, 0, 0});
  body q = Solid(mass = 1, inertia = {1, 1, 1}, frame = rotate_z(world, b), com = {0, 0, 0});
  body r = Solid(mass = 1, inertia = {1, 1, 1}, frame = rotate_z(world, c), com = {0, 0, 0});
  body s = Solid(mass = 1, inertia = {1, 1, 1}, frame = rotate_z(world, d), com = {0, 0, 0});
  constraint cam: h = 0.01 [m]*exp(2*a);
  constraint gears: a = -7*b;
  constraint nut: y = x*(x/(0.3 [m]))^5;
  constraint slider: x = 0.1 [m]*cos(c) + 0.3 [m]*cos(d);
  constraint guide: 0.1 [m]*sin(c) + 0.3 [m]*sin(d) = 0;
end Chain;
"""


@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", range(8))
def test_mechanisms_follow_what_is_stated_of_them(seed: int) -> None:
    """Cam and gears by closed form; the slider is where its steep nut says, the loop closed behind it: to
    1e-15 of a thousandth of the largest length, the tolerance of a start."""
    dice = random.Random(seed)
    system = system_of(CHAIN)
    h, x = 10.0 ** dice.uniform(-4.0, 0.0), dice.uniform(0.22, 0.38)
    given = {"h": h, "y": x * (x / 0.3) ** 5}
    start = consistent_start(system, 0.0, given)
    assert not start.unmet and not [c for c in start.changes if c.stated]
    found = dict(zip(system.interface.q_names, start.x))
    assert {name: found[name] for name in given} == given
    angle, off = math.log(h / 0.01) / 2.0, 1e-12 + 4e-15 * max(given.values()) / 1024
    assert math.isclose(found["a"], angle, rel_tol=1e-12, abs_tol=1e-12)
    assert math.isclose(found["b"], -angle / 7.0, rel_tol=1e-12, abs_tol=1e-12)
    assert abs(found["x"] - x) < off
    assert abs(0.1 * math.cos(found["c"]) + 0.3 * math.cos(found["d"]) - found["x"]) < off
    assert abs(0.1 * math.sin(found["c"]) + 0.3 * math.sin(found["d"])) < off


@pytest.mark.sample(2)
@pytest.mark.parametrize("seed", range(12))
def test_two_steep_conditions_in_two_unknowns(seed: int) -> None:
    """log x = i y + j z and log w = k y + l z."""
    dice = random.Random(seed)
    i, j, k, l = 1.0, dice.uniform(0.5, 2.0), dice.uniform(0.5, 2.0), -1.0  # noqa: E741
    text = f"""\
model Two
  coordinate Length x, w;
  coordinate Angle y, z;
  body b = Particle(mass = 1, at = {{x, w, 0}});
  body p = Solid(mass = 1, inertia = {{1, 1, 1}}, frame = rotate_z(world, y), com = {{0, 0, 0}});
  body q = Solid(mass = 1, inertia = {{1, 1, 1}}, frame = rotate_z(world, z), com = {{0, 0, 0}});
  constraint c: x = 1 [m]*exp({i!r}*y + {j!r}*z);
  constraint d: w = 1 [m]*exp({k!r}*y + ({l!r})*z);
end Two;
"""
    system = system_of(text)
    given = {"x": math.exp(dice.uniform(-6.0, 10.0)), "w": math.exp(dice.uniform(-6.0, 10.0))}
    start = consistent_start(system, 0.0, given)
    assert not start.unmet
    found = dict(zip(system.interface.q_names, start.x))
    assert {name: found[name] for name in given} == given
    a, b, whole = math.log(given["x"]), math.log(given["w"]), i * l - j * k
    assert math.isclose(found["y"], (a * l - b * j) / whole, rel_tol=1e-11, abs_tol=1e-11)
    assert math.isclose(found["z"], (b * i - a * k) / whole, rel_tol=1e-11, abs_tol=1e-11)
