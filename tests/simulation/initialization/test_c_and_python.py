"""The search for a consistent start in C and in Python: the same bits, and the same motion as `lagc sim`."""

import random
import shutil

import pytest

from lagc.semantics.units import unit
from lagc.simulation.initialization.conflicts import conditions_of
from lagc.simulation.initialization.solver import Consistency
from tests.simulation.initialization.generated_starts import Starts, program_of, random_levels, system_of

needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
LIBRARY = (
    "andrews_squeezer", "chaplygin_sleigh_speeds", "four_bar", "heavy_top_quaternion", "n_four_bar",
    "particle_on_torus", "rolling_disc", "slider_crank", "sphere_on_turntable", "spring_chain", "wheelset",
)  # fmt: skip


@pytest.mark.sample(0, 2)
@needs_gcc
@pytest.mark.parametrize("name", LIBRARY)
def test_c_and_python_find_the_same_start(name: str) -> None:
    """From random guesses, with random values stated more or less firmly; where there is none, too."""
    twins = Starts(program_of(f"classic/{name}"))
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


BODY = """\
model M
  coordinate Length x{x}, y, z(start = 1 [m]);
  coordinate Orientation o(start = {{1, 0, 0, 0}});
  body b = Solid(mass = 1, inertia = {{1, 2, 3}}, frame = rotate(world, o), com = {{x, y, z}});
  constraint c: {c};
end M;
"""
STRANGE = {
    "no gradient": BODY.format(x="", c="norm({x, y, 0}) = 0.5 [m]"),
    "no number": BODY.format(x="(start = -1 [m], fixed = true)", c="y = 1 [m]*log(x/(1 [m]))"),
    "no solution": BODY.format(x="(start = 3 [m], fixed = true)", c="x^2 + y^2 = 1 [m2]"),
    "too far": BODY.format(x="(start = 3 [m])", c="x^2 + y^2 = 1 [m2]"),
    "turned": BODY.format(x="", c="dot(rotate(world, o).z, world.z) = 0.5"),
}


@pytest.mark.full
@needs_gcc
@pytest.mark.parametrize("name", STRANGE)
def test_strange_starts_are_the_same_too(name: str) -> None:
    twins = Starts(program_of(STRANGE[name]))
    levels = list(twins.interface.start_levels)
    found = twins.by_python(0.0, twins.guess, levels)
    assert repr(found) == repr(twins.by_c(0.0, twins.guess, None))
    assert (found[0] != 0) == (name in ("no number", "no solution"))
    far = [float("nan"), *twins.guess[1:]]
    assert repr(twins.by_python(0.0, far, levels)) == repr(twins.by_c(0.0, far, levels))


def factor(text: str, scales: tuple[float, float, float]) -> float:
    """Of a quantity in the unit `text`, where mass, length and time are scaled by powers of two."""
    found = 1.0
    for exponent, scale in zip(unit(text or "1").dimension, scales):
        found *= scale ** (exponent / 12)
    return found


@pytest.mark.sample(1, 10)
@pytest.mark.parametrize("scales", [(1.0, 2.0**50, 1.0), (1.0, 1.0, 2.0**-50), (2.0**50, 2.0**-50, 2.0**30)])
@pytest.mark.parametrize("name", [name for name in LIBRARY if not name.endswith("_speeds")])
def test_a_scaled_model_starts_in_the_scaled_state(name: str, scales: tuple[float, float, float]) -> None:
    """To the bit, from random guesses of which some are stated."""
    system, dice = system_of(f"classic/{name}"), random.Random(name)
    interface = system.interface
    fields = (*interface.parameters, *interface.inputs)
    other = system.bind([a * factor(f.unit, scales) for a, f in zip(system.parameters, fields)])
    factors = [factor(u, scales) for u in (*interface.q_units, *interface.v_units)]
    guess = [
        a + (dice.gauss(0.0, 0.2) if dice.random() < 0.6 else 0.0) for a in system.start()[: len(factors)]
    ]
    levels = [dice.choice((0, 0, 0, 1)) for _ in interface.start_levels]
    one = Consistency(conditions_of(system), 0.0, guess, levels)
    two = Consistency(conditions_of(other), 0.0, [a * f for a, f in zip(guess, factors)], levels)
    assert one.run() == two.run() == 0
    assert [a * f for a, f in zip(one.y, factors)] == two.y
