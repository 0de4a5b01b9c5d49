"""No size is hidden in the program: in other units of length, mass and time the same motion comes out,
with the same steps, and to the last bit where the units differ by powers of two."""

import random
from fractions import Fraction
from functools import cache

import pytest

from lagc.host.model_library import library_models, read
from lagc.lowering.program import Program
from lagc.simulation.backends.compile import compiler
from lagc.simulation.initialization.initialize import consistent_start
from lagc.simulation.system import OK, Options, Trajectory
from tests.simulation.scaled import Factors, program, state_factors, system

PLAIN: Factors = (Fraction(1), Fraction(1), Fraction(1))
LONGEST = 1.0  # s
POINTS = 6
# States are the same to some units in the last place alone: where contacts act; where dependent rows of
# different units share one penalty and their gradients are compared; where a mass is the literal 1, which
# vanishes from the code, so that other terms are shared.
IN_LAST_PLACES = ("course/leaving_wall_explicit", "hard/bennett", "mechanisms/universal_joint")
IN_FLIGHT = [
    name for name in library_models() if not name.startswith("contact/") and name not in IN_LAST_PLACES
]
# In impacts of two-sided contacts, normal impulses that are zero have no size of their own, and are scaled
# by 1: units that differ by 1e15 change the decision there.
_TWO_SIDED = ("block_in_rail", "painleve_klein", "rough_crank", "rough_hoop", "rough_pin")
RUBBING = [f"contact/{name}" for name in _TWO_SIDED]
IN_C = ("classic/heavy_top_quaternion", "course/string_pendulum")


@cache
def plain(name: str) -> Program:
    return program(read(name), PLAIN)


@cache
def beginning(name: str) -> tuple[list[float], float]:
    """The consistent start, and how long to run."""
    made = plain(name)
    found = list(consistent_start(system(made, "numpy")).x)
    found += [0.0] * (made.interface.nx - len(found))
    return found, min(LONGEST, made.interface.simulate.get("stop", LONGEST))


def moved(name: str, factors: Factors, backend: str, options: Options) -> tuple[Trajectory, list[float]]:
    """The motion in other units, and the factors of its states."""
    made = plain(name) if factors == PLAIN else program(read(name), factors)
    start, stop = beginning(name)
    times = [stop * k / (POINTS - 1) * float(factors[2]) for k in range(POINTS)]
    scaled = state_factors(made, factors)
    x0 = [a * b for a, b in zip(start, scaled)]
    return system(made, backend).integrate(options, 0.0, x0, times), scaled


def counts(run: Trajectory) -> tuple[int, ...]:
    return run.status, run.steps, run.rejected, run.rhs, run.fallbacks


def check_bits(name: str, factors: Factors, backend: str, method: str) -> None:
    options = Options(method, 1e-5)
    one, _ = moved(name, PLAIN, backend, options)
    other, scaled = moved(name, factors, backend, options)
    assert one.status == OK and counts(other) == counts(one)
    assert other.states == [[a * b for a, b in zip(x, scaled)] for x in one.states]
    assert (other.position_drift, other.velocity_drift) == (one.position_drift, one.velocity_drift)


@pytest.mark.sample(0, 7)
@pytest.mark.parametrize("name", IN_FLIGHT)
def test_units_that_are_powers_of_two_change_no_bit(name: str) -> None:
    rng = random.Random(name)
    kg, m, s = (Fraction(2) ** rng.choice((-50, -rng.randrange(50), rng.randrange(50), 50)) for _ in range(3))
    check_bits(name, (kg, m, s), "numpy", rng.choice(("dop853", "dop853", "dopri5")))


@pytest.mark.sample(1)
@pytest.mark.skipif(compiler() is None, reason="no C compiler")
@pytest.mark.parametrize("name", IN_C)
def test_nor_in_c(name: str) -> None:
    rng = random.Random(name)
    kg, m, s = (Fraction(2) ** rng.choice((-50, 50)) for _ in range(3))
    check_bits(name, (kg, m, s), "c", "dop853")


@pytest.mark.sample(0, 9)
@pytest.mark.parametrize("name", [name for name in library_models() if name not in RUBBING])
def test_other_units_change_the_motion_by_rounding_alone(name: str) -> None:
    rng = random.Random(name)
    kg, m, s = (Fraction(10) ** rng.choice((-15, 15)) for _ in range(3))
    options = Options("dop853", 1e-8)
    one, _ = moved(name, PLAIN, "numpy", options)
    other, scaled = moved(name, (kg, m, s), "numpy", options)
    assert one.status == OK and other.status == OK
    assert abs(other.steps - one.steps) <= 0.02 * one.steps + 2
    kinds = plain(name).interface.kinds
    for kind in set(kinds):
        group = [i for i, k in enumerate(kinds) if k == kind]
        size = max(abs(x[i]) for x in one.states for i in group)
        for x, y in zip(one.states, other.states):
            for i in group:
                assert abs(y[i] / scaled[i] - x[i]) <= 1e-7 * size
