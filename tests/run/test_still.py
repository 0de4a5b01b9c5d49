"""Kinds of states that are exactly zero but for rounding: symmetric systems, of which the truth is that of
the model without these coordinates."""

from __future__ import annotations

from random import Random
from typing import Any

import pytest

import lagc
from lagc.api import Run

pytestmark = pytest.mark.usefixtures("no_cache")
GRAVITY = "effect gravity\n Gravity field;\n end gravity;\n scene lab uses gravity;\n"
Pair = tuple[str, str, dict[str, str]]  # a model, the same without what is zero, and what its states are there


def carts(chance: Random) -> Pair:
    """Pendulums in opposite pairs on a cart, with dampers, against each alone on what does not move."""
    pairs = chance.randint(1, 3)
    lines, alone, same = [], [], {}
    for k in range(pairs):
        m, l, a = chance.uniform(0.3, 2.0), chance.uniform(0.3, 1.5), chance.uniform(0.2, 2.0)
        rate, c = chance.choice((0.0, chance.uniform(-1.0, 1.0))), chance.choice((0.0, chance.uniform(0.0, 0.5)))
        for side, sign in (("a", 1.0), ("b", -1.0)):
            lines.append(f"coordinate Angle {side}{k}(start = {sign * a!r}, rate = {sign * rate!r} [rad/s]);\n"
                         f"body {side}p{k} = Particle(mass = {m!r} [kg], at = {{x, 0, 0}} + "
                         f"({l!r} [m])*{{sin({side}{k}), 0, -cos({side}{k})}});\n"
                         f"force {side}f{k} = -({c!r} [N.s/m])*velocity({side}p{k}) at {side}p{k};")  # fmt: skip
            same[f"{side}{k}"] = f"a{k}" if sign > 0 else f"-a{k}"
        alone.append(lines[-2].replace("{x, 0, 0} + ", ""))
    cart = f"coordinate Length x;\nbody cart = Particle(mass = {chance.uniform(0.5, 5.0)!r} [kg], at = {{x, 0, 0}});"
    return framed([cart, *lines]), framed(alone), same


def springs(chance: Random) -> Pair:
    """A pendulum and a slider, joined by a spring that stays relaxed."""
    l, k = chance.uniform(0.3, 1.5), chance.uniform(1.0, 9.0)
    bob = (f"coordinate Angle a(start = {chance.uniform(0.3, 2.0)!r});\n"
           f"body bob = Particle(mass = 1 [kg], at = ({l!r} [m])*{{sin(a), 0, -cos(a)}});")  # fmt: skip
    slider = (f"coordinate Length x;\nbody c = Particle(mass = 1 [kg], at = {{x, 0, 0}});\n"
              f"potential s = 1/2*({k!r} [N/m])*(norm(position(bob) - position(c)) - {l!r} [m])^2;")
    return framed([bob, slider]), framed([bob]), {"a": "a"}


def planes(chance: Random) -> Pair:
    """A chain of two pendulums in space by angles, of which those out of the plane rest."""
    m, l, n = chance.uniform(0.5, 2.0), chance.uniform(0.5, 1.0), chance.uniform(0.5, 2.0)
    a, b = chance.uniform(0.2, 0.8), chance.uniform(0.2, 0.8)

    def text(out: bool) -> str:
        side = "y" if out else "0"
        return framed([f"coordinate Angle a(start = {a!r}), b(start = {b!r});\n",
                       "coordinate Length y;" if out else "",
                       f"point P = ({l!r} [m])*{{sin(a), 0, -cos(a)}};",
                       f"body p = Particle(mass = {m!r} [kg], at = P);",
                       f"body q = Particle(mass = {n!r} [kg], at = P + ({l!r} [m])*{{sin(b), 0, -cos(b)}} "
                       + (f"+ {side}*{{cos(a)*cos(b), 1, sin(a + b)}} - {side}*cos(b)*{{cos(a), 0, 0}} "
                          f"- {side}*{{0, 0, sin(a)*cos(b) + cos(a)*sin(b)}}" if out else "") + ");",
                       f"potential s = 1/2*(30 [N/m])*({side})^2;" if out else ""])

    return text(True), text(False), {"a": "a", "b": "b"}


def linkages(chance: Random) -> Pair:
    """Two cranks that mirror each other hold a slider by rods; its guide is free to the side."""
    r, l, rate = chance.uniform(0.2, 0.5), chance.uniform(0.8, 1.5), chance.uniform(2.0, 5.0)
    a = chance.uniform(0.5, 1.2)

    def crank(name: str, sign: float) -> str:
        return (f"coordinate Angle {name}(start = {sign * a!r}, rate = {sign * rate!r} [rad/s]);\n"
                f"body {name}p = Particle(mass = 1 [kg], at = ({r!r} [m])*{{sin({name}), 0, cos({name})}});")

    def rod(name: str, x: str) -> str:
        return f"constraint {name}r: norm(position({name}p) - {{{x}, 0, z}}) = {l!r} [m];"

    both = [crank("a", 1.0), crank("b", -1.0), "coordinate Length z(start = 1.2 [m]);",
            "coordinate Length x;", "body s = Particle(mass = 2 [kg], at = {x, 0, z});", rod("a", "x"), rod("b", "x")]
    one = [crank("a", 1.0), "coordinate Length z(start = 1.2 [m]);", "body s = Particle(mass = 1 [kg], at = {0 [m], 0, z});",
           rod("a", "0 [m]")]
    return framed(both), framed(one), {"a": "a", "b": "-a", "z": "z"}


def framed(lines: list[str]) -> str:
    return "model M\n" + "\n".join(lines) + "\n" + GRAVITY + "end M;"


def column(run: Run, name: str) -> Any:
    return -run[name[1:]] if name.startswith("-") else run[name]


@pytest.mark.parametrize("backend", ["numpy", "c"])
@pytest.mark.parametrize("make", [carts, springs, linkages])
def test_what_is_zero_but_for_rounding_costs_nothing(make: Any, backend: str) -> None:
    chance = Random(f"{make.__name__}")
    for _ in range(12):
        text, reduced, same = make(chance)
        accuracy = chance.choice((1e-4, 1e-6, 1e-8))
        run = lagc.loads(text).compile(backend=backend).simulate(3.0, accuracy=accuracy, points=31)
        one = lagc.loads(reduced).compile(backend=backend).simulate(3.0, accuracy=1e-11, points=31)
        asked = lagc.loads(reduced).compile(backend=backend).simulate(3.0, accuracy=accuracy, points=31)
        print(make.__name__, run.status, accuracy, run.estimated, run.cost.rhs, asked.cost.rhs, run.notes, run.message)
        for name, other in same.items():
            gap = abs(run[name] - column(one, other)).max() / abs(run[name]).max()
            print(name, gap)
