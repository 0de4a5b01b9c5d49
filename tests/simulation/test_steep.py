"""A stated value that a steep function of an unstated one meets far from its guess: only the latter moves."""

from __future__ import annotations

import math
import random
import shutil
from collections.abc import Callable
from typing import Any

import mpmath
import pytest

from lagc.simulation.initialization.initialize import consistent_start
from lagc.simulation.system import OK
from tests.simulation.started import Twins, program_of, system_of

needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
mp = mpmath.mp.clone()
mp.dps = 60
FUNCTIONS: dict[str, tuple[Callable[[Any], Any], Callable[[float], bool]]] = {  # values, and which are met
    "sinh(U)": (mp.sinh, lambda x: True),
    "exp(U)": (mp.exp, lambda x: x > 0.0),
    "cosh(U)": (mp.cosh, lambda x: x >= 1.1),
    "U^7": (lambda u: u**7, lambda x: True),
    "U^3": (lambda u: u**3, lambda x: True),
    "tan(U)": (mp.tan, lambda x: True),
    "log(U)": (mp.log, lambda x: abs(x) <= 40.0),
    "exp(-U^2)": (lambda u: mp.exp(-u * u), lambda x: 0.0 < x <= 0.9),
    "U*exp(U)": (lambda u: u * mp.exp(u), lambda x: x > -0.3),
    "1/U": (lambda u: 1 / u, lambda x: True),
    "1/U^2": (lambda u: 1 / u**2, lambda x: x > 0.0),
    "3*U/(2 + U)": (lambda u: 3 * u / (2 + u), lambda x: abs(x - 3.0) > 0.1),
    "sqrt(U)": (mp.sqrt, lambda x: x > 0.0),
    "exp(U) + U^3": (lambda u: mp.exp(u) + u**3, lambda x: True),
    "exp(exp(U))": (lambda u: mp.exp(mp.exp(u)), lambda x: x > 1.1),
    "U^5 + U": (lambda u: u**5 + u, lambda x: True),
}
ROW = """\
  coordinate Length x{k}(start = 1 [m]);
  coordinate {kind} y{k};
  frame F{k} = rotate_z(world, y{k}/({unit}));
  body b{k} = Solid(mass = 1, inertia = {{1, 1, 1}}, frame = F{k}, com = {{x{k}, 0, 0}});
  constraint c{k}: x{k} = 1 [m]*({function});
"""


def model(kind: str) -> str:
    unit = {"Length": "1 [m]", "Angle": "1 [rad]"}[kind]
    rows = [
        ROW.format(k=k, kind=kind, unit=unit, function=f.replace("U", f"(y{k}/({unit}))"))
        for k, f in enumerate(FUNCTIONS)
    ]
    return "model Steep\n" + "".join(rows) + "end Steep;\n"


def is_root(f: Callable[[Any], Any], x: float, y: float, size: float) -> bool:
    """As far as a start is refined: to 1e-15 of the terms of its row and of what that changes by over a
    thousandth of the size of y, that of its unit; and to the rounding of y."""
    u = mp.mpf(y)
    slope = mp.diff(f, u, h=mp.mpf(10) ** -30 * (1 + abs(u)))
    return bool(abs(f(u) - x) <= 2e-15 * (abs(x) + abs(slope) * (abs(u) + size / 1024)))


@pytest.mark.full
@needs_gcc
@pytest.mark.parametrize("kind", ("Length", "Angle"))
def test_what_is_stated_stays_however_far_the_other_goes(kind: str) -> None:
    """Values of any size, of all functions at once that have them; the same bits in C."""
    twins = Twins(program_of(model(kind)))
    names, dice = twins.interface.q_names, random.Random(kind)
    for power in (-6, 0, 4, 9):
        x, levels = twins.guess, [0] * len(twins.interface.start_levels)
        for k, (f, meets) in enumerate(FUNCTIONS.values()):
            value = dice.choice((1.0, -1.0)) * 10.0 ** (power + dice.random())
            at, guess = names.index(f"x{k}"), dice.uniform(0.2, 3.0)
            x[names.index(f"y{k}")] = guess if power else 0.0
            x[at] = value if meets(value) else -value if meets(-value) else float(f(guess))
            levels[at] = int(abs(x[at]) == abs(value))
        size = max(map(abs, x)) if kind == "Length" else 3.0
        found = twins.by_python(0.0, x, levels)
        assert repr(found) == repr(twins.by_c(0.0, x, levels))
        assert found[0] == OK
        for k, (name, (f, _)) in enumerate(FUNCTIONS.items()):
            at = names.index(f"x{k}")
            if levels[at]:
                assert found[2][at] == x[at], name
                assert is_root(f, x[at], found[2][names.index(f"y{k}")], size), (name, x[at])


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
  constraint nut: y = x*(x/(0.01 [m]))^5;
  constraint slider: x = 0.1 [m]*cos(c) + 0.3 [m]*cos(d);
  constraint guide: 0.1 [m]*sin(c) + 0.3 [m]*sin(d) = 0;
end Chain;
"""


@pytest.mark.parametrize("seed", range(8))
def test_mechanisms_follow_what_is_stated_of_them(seed: int) -> None:
    """Cam and gears by closed form; the slider is where its steep nut says, the loop closed behind it: to
    1e-15 of a thousandth of the largest length, see `is_root`."""
    dice = random.Random(seed)
    system = system_of(CHAIN)
    h, x = 10.0 ** dice.uniform(-6.0, 9.0), dice.uniform(0.22, 0.38)
    given = {"h": h, "y": x * (x / 0.01) ** 5}
    start = consistent_start(system, 0.0, given)
    assert not start.missed and not [c for c in start.changes if c.stated]
    found = dict(zip(system.interface.q_names, start.x))
    assert {name: found[name] for name in given} == given
    angle, off = math.log(h / 0.01) / 2.0, 1e-12 + 4e-15 * max(given.values()) / 1024
    assert math.isclose(found["a"], angle, rel_tol=1e-12, abs_tol=1e-12)
    assert math.isclose(found["b"], -angle / 7.0, rel_tol=1e-12, abs_tol=1e-12)
    assert abs(found["x"] - x) < off
    assert abs(0.1 * math.cos(found["c"]) + 0.3 * math.cos(found["d"]) - found["x"]) < off
    assert abs(0.1 * math.sin(found["c"]) + 0.3 * math.sin(found["d"])) < off


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
    assert not start.missed
    found = dict(zip(system.interface.q_names, start.x))
    assert {name: found[name] for name in given} == given
    a, b, whole = math.log(given["x"]), math.log(given["w"]), i * l - j * k
    assert math.isclose(found["y"], (a * l - b * j) / whole, rel_tol=1e-11, abs_tol=1e-11)
    assert math.isclose(found["z"], (b * i - a * k) / whole, rel_tol=1e-11, abs_tol=1e-11)
