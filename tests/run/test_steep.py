"""A stated value that a steep function of an unstated one meets far from its guess: only the latter moves."""

from __future__ import annotations

import random
import shutil
from collections.abc import Callable
from typing import Any

import mpmath
import pytest

from lagc.run.problem import OK
from tests.run.started import Twins, program_of

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
  body b{k} = Solid(mass = 1, inertia = {{1, 1, 1}}, frame = rotate_z(world, y{k}/({unit})), com = {{x{k}, 0, 0}});
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


@needs_gcc
@pytest.mark.parametrize("kind", ("Length", "Angle"))
def test_what_is_stated_stays_however_far_the_other_goes(kind: str) -> None:
    """Values of any size, of all functions at once that have them; the same bits in C."""
    twins = Twins(program_of(model(kind)))
    names, dice = twins.interface.q_names, random.Random(kind)
    for power in (-6, -3, 0, 2, 4, 6, 9):
        x, levels = twins.guess, [0] * len(twins.interface.start_levels)
        for k, (_, meets) in enumerate(FUNCTIONS.values()):
            value = dice.choice((1.0, -1.0)) * 10.0 ** (power + dice.random())
            at = names.index(f"x{k}")
            x[at] = value if meets(value) else -value
            levels[at] = int(meets(x[at]))
        size = max(map(abs, x)) if kind == "Length" else 1.0
        found = twins.by_python(0.0, x, levels)
        assert repr(found) == repr(twins.by_c(0.0, x, levels))
        assert found[0] == OK
        for k, (name, (f, _)) in enumerate(FUNCTIONS.items()):
            at = names.index(f"x{k}")
            if levels[at]:
                assert found[2][at] == x[at], name
                assert is_root(f, x[at], found[2][names.index(f"y{k}")], size), (name, x[at])
