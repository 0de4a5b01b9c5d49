"""The search for a consistent start in C and in Python: the same bits, and the same motion as `lagc sim`."""

from __future__ import annotations

import random
import shutil

import pytest

from tests.run.started import Twins, program_of, random_levels

needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
LIBRARY = (
    "andrews_squeezer", "chaplygin_sleigh_speeds", "four_bar", "heavy_top_quaternion", "n_four_bar",
    "particle_on_torus", "rolling_disc", "slider_crank", "sphere_on_turntable", "spring_chain", "wheelset",
)  # fmt: skip


@needs_gcc
@pytest.mark.parametrize("name", LIBRARY)
def test_c_and_python_find_the_same_start(name: str) -> None:
    """From random guesses, with random values stated more or less firmly; where there is none, too."""
    twins = Twins(program_of(f"classic/{name}"))
    dice = random.Random(name)
    statuses = set()
    for k in range(12):
        x = [a + dice.choice((0.0, 0.0, 0.1, 1.0)) * dice.gauss(0.0, 1.0) for a in twins.guess]
        levels = random_levels(len(twins.interface.start_levels), dice)
        if k < 4:
            levels = [min(level, 1) for level in levels]
        found = twins.by_python(0.0, x, levels)
        assert repr(found) == repr(twins.by_c(0.0, x, levels))
        statuses.add(found[0])
    assert 0 in statuses
    assert twins.by_c(0.0, twins.guess, None)[2] == twins.module["consistent"]()
