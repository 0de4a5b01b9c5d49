"""A plate on equal parallel strings: what hangs level at the guess hangs level at the start, exactly."""

from __future__ import annotations

import math
import random

import pytest

from tests.simulation.started import Twins, program_of


def table(strings: int, dice: random.Random) -> str:
    """Six coordinates, a row for each string of length 1; x and z are stated, y and the angles are not."""
    lines = ["model Table", "  parameter Length l = 1 [m];"]
    x = dice.uniform(0.1, 0.5)
    z = -math.sqrt(1.0 - x * x) * dice.uniform(0.8, 1.0)
    lines += [f"  coordinate Length x(start = {x!r} [m], rate = 1 [m/s]), y, z(start = {z!r} [m]);"]
    lines += ["  coordinate Angle al, be, ga;", "  frame F1 = rotate_z(world, ga);"]
    lines += ["  frame F2 = rotate_x(F1, al);", "  frame F = rotate_y(F2, be);", "  point G = {x, y, z};"]
    lines += ["  body plate = Solid(mass = 3, inertia = {1, 1, 1}, frame = F, com = G);"]
    for k in range(strings):
        r, phi = dice.uniform(0.2, 1.0), 2 * math.pi * (k + dice.uniform(0.0, 0.7)) / strings
        a, b = r * math.cos(phi), r * math.sin(phi)
        arms = [f"({a!r})*l*{frame}.x + ({b!r})*l*{frame}.y" for frame in ("F", "world")]
        lines.append(f"  constraint s{k}: norm(G + {arms[0]} - ({arms[1]})) = l;")
    return "\n".join([*lines, "end Table;\n"])


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize("seed", range(4))
def test_a_plate_on_equal_strings_stays_level(seed: int) -> None:
    """It moves as one string: y and the rates that are left tell themselves, the stated stay."""
    dice = random.Random(seed)
    twins = Twins(program_of(table(3 + seed % 2, dice)))
    levels = twins.interface.start_levels
    found = twins.by_python(0.0, twins.guess, levels)
    assert repr(found) == repr(twins.by_c(0.0, twins.guess, levels))
    assert found[0] == 0
    x, y, z, *angles = found[2][:6]
    vx, vy, vz, *turning = found[2][6:]
    assert angles == turning == [0.0, 0.0, 0.0]
    assert (x, z, vx) == (twins.guess[0], twins.guess[2], 1.0)
    assert abs(math.hypot(x, y, z) - 1.0) < 1e-15 and abs(x * vx + y * vy + z * vz) < 1e-15
