"""What a start costs where stated values contradict the conditions, and how far the choice sees."""

import random
import shutil
from collections.abc import Sequence
from math import cos, hypot, pi, sin

import pytest

from lagc.simulation.initialization.conflicts import conditions_of
from lagc.simulation.initialization.initialize import consistent_start
from lagc.simulation.initialization.solver import Consistency
from lagc.simulation.system import INCONSISTENT, NOT_FINITE, OK
from tests.simulation.initialization.generated_starts import Starts, program_of, start_of, system_of

needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")


def chain(places: Sequence[tuple[float, float]], lengths: Sequence[float]) -> str:
    """Particles in a plane at stated places, each at a given distance from the one before."""
    lines = ["model Chain"]
    for i, (x, z) in enumerate(places):
        lines.append(f"  coordinate Length x{i}(start = {x!r} [m]), z{i}(start = {z!r} [m]);")
        lines.append(f"  body b{i} = Particle(mass = 1, at = {{x{i}, 0, z{i}}});")
    for i, length in enumerate(lengths):
        before = f" - {{x{i - 1}, 0, z{i - 1}}}" if i else ""
        lines.append(f"  constraint c{i}: norm({{x{i}, 0, z{i}}}{before}) = {length!r} [m];")
    return "\n".join([*lines, "end Chain;\n"])


def hanging(n: int) -> str:
    """Particles side by side in a plane at heights that are to be found, each at 1 m from the one before."""
    return f"""\
model Hanging
  coordinate Length x[{n}](each start = 0.5 [m]), z[{n}];
  point P[0] = {{0, 0, 0}};
  for i in 1:{n} loop
    point P[i] = {{x[i], 0, z[i]}};
    body b[i] = Particle(mass = 1, at = P[i]);
    constraint bar[i]: norm(P[i] - P[i-1]) = 1 [m];
  end for;
end Hanging;
"""


def bent(n: int, dice: random.Random) -> list[tuple[float, float]]:
    """The places of a chain of n links of 0.1 m that points anywhere but along an axis."""
    x, z, found = 0.0, 0.0, []
    for _ in range(n):
        angle = dice.choice((0.0, pi / 2, pi, 3 * pi / 2)) + dice.uniform(0.3, 1.2)
        x, z = x + 0.1 * cos(angle), z + 0.1 * sin(angle)
        found.append((x, z))
    return found


def test_divisors_that_are_zero_at_a_guess_cost_no_more_than_others(monkeypatch: pytest.MonkeyPatch) -> None:
    """Links that have no direction yet: nothing is computed again as C does, which takes far longer."""
    system = system_of(hanging(6))
    again: list[object] = []
    monkeypatch.setitem(system.model.module, "_again", lambda *given: again.append(given))  # type: ignore[attr-defined]
    found = consistent_start(system)
    assert not found.unmet and not again
    x, z = [0.0, *found.x[:6]], [0.0, *found.x[6:12]]
    assert [hypot(x[k + 1] - x[k], z[k + 1] - z[k]) for k in range(6)] == pytest.approx([1.0] * 6)


@pytest.mark.sample(1)
@pytest.mark.parametrize("n", (3, 8, 16, 30))
def test_places_that_were_rounded_cost_little(n: int) -> None:
    """Values move by about the rounding: an attempt or two settle it."""
    places = [(round(x, 3), round(z, 3)) for x, z in bent(n, random.Random(n))]
    system = system_of(chain(places, [0.1] * n))
    guess = system.start()
    search = Consistency(conditions_of(system), 0.0, guess, system.interface.start_levels)
    assert search.run() == OK
    assert search.space.work <= 60
    assert max(abs(a - b) for a, b in zip(guess, search.y)) < 0.05 * 0.1 * n
    assert len(consistent_start(system).notes) <= 3


@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", range(8))
def test_a_contradiction_in_the_middle_of_a_chain_stays_there(seed: int) -> None:
    """The length of one link is another: few values beside it move, of the 24 that are stated."""
    dice = random.Random(seed)
    n = 12
    at, places = dice.randrange(n), bent(n, dice)
    lengths = [hypot(x - u, z - w) for (x, z), (u, w) in zip(places, [(0.0, 0.0), *places])]
    lengths[at] *= 1.0 + dice.choice((-0.02, 0.02))
    system = system_of(chain(places, lengths))
    guess = system.start()
    search = Consistency(conditions_of(system), 0.0, guess, system.interface.start_levels)
    assert search.run() == OK
    assert sum(abs(a - b) > 1e-9 for a, b in zip(guess, search.y)) <= 4
    assert max(map(abs, search.evaluate(search.y)[0])) < 1e-12


def test_parts_that_share_nothing_are_left_alone() -> None:
    """Of many pendulums one is stated wrongly."""
    pendulums = [
        f"  coordinate Length x{i}(start = 0.6 [m]), y{i}(start = {0.8 if i != 7 else 0.9} [m]), z{i};\n"
        f"  body b{i} = Particle(mass = 1, at = {{x{i}, y{i}, z{i}}});\n"
        f"  constraint c{i}: x{i}^2 + y{i}^2 = 1 [m2];\n"
        f"  constraint d{i}: z{i} = 2*x{i};\n"
        for i in range(12)
    ]
    system = system_of("model M\n" + "".join(pendulums) + "end M;\n")
    start = consistent_start(system)
    (change,) = [c for c in start.changes if c.stated]
    assert change.name in ("x7", "y7")
    x, y = (start.x[system.interface.q_names.index(name)] for name in ("x7", "y7"))
    assert hypot(x, y) == pytest.approx(1.0, abs=1e-12)
    assert f"constraint `c7` (m.lag:{2 + 4 * 7 + 2})" in change.forced
    search = Consistency(conditions_of(system), 0.0, system.start(), system.interface.start_levels)
    assert search.run() == OK and search.space.work <= 4 * 12  # factorizations of each part alone


TURNED = """\
model M
  parameter Velocity v = 1 [m/s];
  coordinate Orientation o;
  coordinate Length x(rate = {rate}), y;
  speed Velocity u(start = 1 [m/s]) = der(x) + der(y);
  speed Velocity w(start = 1 [m/s]) = der(x) - der(y);
  body b = Solid(mass = 1, inertia = {{1, 2, 3}}, frame = rotate(world, o), com = {{x, y, 0}});
  constraint c: x + y = 1 [m];
end M;
"""


@pytest.fixture(scope="module")
def turning() -> Starts:
    return Starts(program_of(TURNED.format(rate="v")))


@pytest.mark.full
@needs_gcc
@pytest.mark.parametrize(
    ("parts", "status", "turned"),
    [
        ((2.0, 0.0, 0.0, 0.0), OK, (1.0, 0.0, 0.0, 0.0)),
        ((1e200, 0.0, 0.0, 0.0), OK, (1.0, 0.0, 0.0, 0.0)),
        ((3e-170, 4e-170, 0.0, 0.0), OK, (0.6, 0.8, 0.0, 0.0)),
        ((-3e170, 0.0, 4e170, 0.0), OK, (-0.6, 0.0, 0.8, 0.0)),
        ((5e-324, 0.0, 0.0, 0.0), OK, (1.0, 0.0, 0.0, 0.0)),
        ((0.0, 0.0, 0.0, 0.0), INCONSISTENT, None),
        ((float("nan"),) * 4, NOT_FINITE, None),
        ((1.0, float("inf"), 0.0, 0.0), NOT_FINITE, None),
    ],
)
def test_any_direction_is_taken_and_none_invented(
    turning: Starts, parts: tuple[float, ...], status: int, turned: tuple[float, ...] | None
) -> None:
    twins = turning
    names = twins.interface.q_names
    first = names.index("o.w")
    guess = twins.guess
    guess[first : first + 4] = parts
    found = twins.by_python(0.0, guess, twins.interface.start_levels)
    assert repr(found) == repr(twins.by_c(0.0, guess, None))
    assert found[0] == status
    if turned:
        assert found[2][first : first + 4] == pytest.approx(turned, rel=1e-15)


@pytest.mark.full
@needs_gcc
def test_a_stated_rate_that_is_not_finite_is_named() -> None:
    twins = Starts(program_of(TURNED.format(rate="v/(v - 1 [m/s])*v")))
    found = twins.by_python(0.0, twins.guess, twins.interface.start_levels)
    assert repr(found) == repr(twins.by_c(0.0, twins.guess, None))
    assert found[:2] == (NOT_FINITE, twins.n)
    start = consistent_start(system_of(TURNED.format(rate="v/(v - 1 [m/s])*v")))
    (unmet,) = map(str, start.unmet)
    assert unmet == "what `der(x)` (m.lag:4) is stated to be is no finite number there"


def test_a_step_beyond_all_numbers_ends_the_attempt() -> None:
    """A slope of 5e-324, the least that is not zero, asks for an endless step."""
    system = system_of("classic/n_four_bar")
    guess = [-0.6911375757741971, 0.0, 5e-324, -0.3162966008557273, 1.505160766880794, 0.3577644230700024]
    levels = [1, 3, 0, 1, 0, 0]
    search = Consistency(conditions_of(system), 0.0, guess, levels)
    assert search.run() in (OK, INCONSISTENT)


@pytest.mark.sample(3)
@pytest.mark.parametrize("turns", (0.1, 20.0, 300.0, -1e6))
def test_gears_begin_turned_as_far_as_is_stated(turns: float) -> None:
    """Linear in angles: the partner of a wheel that has turned often is where the ratio says."""
    solid = (
        "body {0} = Solid(mass = 1, inertia = {{1, 1, 1}}, frame = rotate_z(world, {0}a), com = {{0, 0, 0}});"
    )
    bodies = "\n  ".join(map(solid.format, "pqr"))
    text = f"""\
model Gears
  coordinate Angle pa(start = {turns!r} [rad]), qa, ra;
  {bodies}
  constraint g: pa = 2*qa;
  constraint h: qa + 3*ra = 0;
end Gears;
"""
    found = start_of(text)
    assert found["pa"] == turns
    assert found["qa"] == pytest.approx(turns / 2.0, rel=1e-14)
    assert found["ra"] == pytest.approx(-turns / 6.0, rel=1e-14)
