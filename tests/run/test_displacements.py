"""Coordinates that are displacements from places, and begin at zero: their size is that of the places, and
the motion that of coordinates from the origin."""

from __future__ import annotations

import math

import mpmath as mp
import pytest

import lagc

ACCURACY = 1e-8


def pendulum(length: float, speed: float) -> str:
    return f"""model Pendulum
  coordinate Length x(start = 0, rate = {speed!r}), z;
  body bob = Particle(mass = 2, at = {{x, 0, z - {length!r} [m]}});
  constraint rod: norm(position(bob)) = {length!r} [m];
  Gravity g(g = 9.81, direction = {{0, 0, -1}});
end Pendulum;
"""


@pytest.mark.parametrize("length", (1.0, 1e-4, 1e6))
@pytest.mark.parametrize("backend", ("numpy", "c"))
def test_a_pendulum_swings_from_its_place(length: float, backend: str) -> None:
    frequency, speed = math.sqrt(9.81 / length), 0.1 * math.sqrt(length)
    model = lagc.loads(pendulum(length, speed)).compile(backend=backend)
    run = model.simulate(stop=2 * math.pi / frequency, accuracy=ACCURACY)
    assert run.status == "ok", run.message
    k = speed / (2 * frequency * length)  # the sine of half the largest angle
    sines = [k * float(mp.ellipfun("sn", t * frequency, k=k)) for t in run.t]
    exact = [2 * length * s * math.sqrt(1 - s**2) for s in sines]
    assert max(abs(run["x"] - exact)) <= ACCURACY * max(map(abs, exact))


def strip(n: int, displaced: bool) -> str:
    lines = ["model Strip", "  parameter Length l = 1;"]
    for i in range(1, n + 1):
        place = f"{i}*l + x{i}" if displaced else f"x{i}"
        lines.append(f"  coordinate Length x{i}(start = {0 if displaced else i}), z{i}(rate = 0.05);")
        lines.append(f"  body p{i} = Particle(mass = 1, at = {{{place}, 0, z{i}}});")
        before = f" - position(p{i - 1})" if i > 1 else ""
        lines.append(f"  constraint rod{i}: norm(position(p{i}){before}) = l;")
    lines += ["  Gravity g(g = 9.81, direction = {0, 0, -1});", "end Strip;\n"]
    return "\n".join(lines)


@pytest.mark.parametrize("n", (1, 2, 3, 5, 12))
def test_a_strip_of_rods_moves_as_from_the_origin(n: int) -> None:
    runs = [
        lagc.loads(strip(n, displaced)).compile(backend="numpy").simulate(stop=1, accuracy=ACCURACY)
        for displaced in (True, False)
    ]
    assert all(run.status == "ok" for run in runs)
    assert not any(note for run in runs for note in run.notes)
    displaced, plain = runs
    for i in range(1, n + 1):
        for name, shift in ((f"x{i}", float(i)), (f"z{i}", 0.0)):
            far = abs(displaced[name] + shift - plain[name]).max()
            assert far <= 2 * n * ACCURACY
