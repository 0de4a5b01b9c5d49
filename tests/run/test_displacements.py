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


RAIL = """model Rail
  parameter Length l = %s;
  parameter Angle al = 30 [deg];
  parameter Real k = 2;
  coordinate Length x, y;
  point A = %s;
  body b = Particle(mass = 1, at = A);
  constraint r: norm(A) = l;
  Gravity g(g = 9.81, direction = {0, 0, -1});
end Rail;
"""
HORIZONTAL = ("{l + x*cos(al), 0, y + x*sin(al)}", "{l + k*x, 0, k*y}", "{l - 1e-9*x, 0, y}", "{l + x, 0, y}")


@pytest.mark.parametrize("length", (1.0, 1e-3))
@pytest.mark.parametrize("place", HORIZONTAL)
def test_displacements_along_any_direction(place: str, length: float) -> None:
    """From the horizontal: sin(phi/2) = k sn(u, k) with k^2 = 1/2, u a quarter period before its end."""
    frequency = math.sqrt(9.81 / length)
    model = lagc.loads(RAIL % (length, place)).compile(backend="numpy")
    run = model.simulate(stop=1 / frequency, accuracy=ACCURACY)
    assert run.status == "ok" and not run.notes, run.message
    quarter = float(mp.ellipk(0.5))
    height = -length * math.cos(
        2 * math.asin(math.sqrt(0.5) * float(mp.ellipfun("sn", quarter - 1, k=math.sqrt(0.5))))
    )
    x, y = run["x"][-1], run["y"][-1]
    found = {"{l + x*cos(al), 0, y + x*sin(al)}": y + x / 2, "{l + k*x, 0, k*y}": 2 * y}.get(place, y)
    assert found == pytest.approx(height, abs=10 * ACCURACY * length)


BESIDE = """model Beside
  coordinate Length a, b, x(start = 1 [mm]), y;
  body p = Particle(mass = 1, at = {x, y, 0});
  body q = Particle(mass = 1, at = {a, b, 0});
  constraint rod: norm({x, y, 0}) = 1 [mm];
  constraint tie: %s;
  force f = {0, 1 [mN], 0} at p;
end Beside;
"""
TIES = (
    "a - 1e-9*b + 3 [m]*cos(b/(1 [m])) = 3 [m]",
    "1e-9*b - a - 3 [m]*cos(b/(1 [m])) = -3 [m]",
    "1e-310*b - a - 3 [m]*cos(b/(1 [m])) = -3 [m]",
    "norm({a, 0, b + 6.4e6 [m]}) = 6.4e6 [m]",
)


@pytest.mark.parametrize("tie", TIES)
def test_what_one_is_displaced_from_is_nothing_to_others(tie: str) -> None:
    run = lagc.loads(BESIDE % tie).compile(backend="numpy").simulate(stop=20, accuracy=ACCURACY)
    assert run.status == "ok", run.message
    assert max(abs(run["x"] ** 2 + run["y"] ** 2 - 1e-6)) <= 1e-15 * 1e-6
