"""Starts of linear equations of very different coefficients: exact arithmetic tells what is right. Mechanisms
with steep functions: unstated values move as far as the stated ones ask for."""

import math
import random
from collections.abc import Sequence
from fractions import Fraction

import pytest

from lagc.simulation.initialization.initialize import consistent_start
from lagc.simulation.initialization.solver import Conditions, Consistency
from tests.simulation.initialization.generated_starts import Starts, program_of, system_of

ACCEPTED = 1e-9  # scaled residual at which a start is taken: see `lagc.kernels.language.tolerances`
Row = tuple[dict[int, float], float]  # coefficients by unknown, and the value of their sum


def exact(row: Row, y: Sequence[float]) -> tuple[Fraction, Fraction]:
    """What the row misses at y, and the sum of the sizes of its terms."""
    terms = [Fraction(a) * Fraction(y[j]) for j, a in row[0].items()] + [-Fraction(row[1])]
    return abs(sum(terms)), sum(map(abs, terms))


def conditions(rows: Sequence[Row], n: int) -> Conditions:
    """The rows and their rates, in n coordinates of one unit and their rates of another."""
    ends, columns, slopes = list[int](), list[int](), list[float]()
    for first in (0, n):
        for coefficients, _ in rows:
            columns += [first + j for j in coefficients]
            slopes += coefficients.values()
            ends.append(len(columns))

    def evaluate(t: float, x: Sequence[float]) -> tuple[list[float], list[float], list[float]]:
        c, sizes = list[float](), list[float]()
        for first in (0, n):
            for coefficients, value in rows:
                terms = [a * x[first + j] for j, a in coefficients.items()]
                terms.append(0.0 if first else -value)
                c.append(sum(terms))
                sizes.append(sum(map(abs, terms)))
        return c, list(slopes), sizes

    return Conditions(n, n, (), [0] * n + [1] * n, (), ends, columns, evaluate, lambda: ([], [1.0, 1.0]))


def chain(dice: random.Random, n: int) -> tuple[list[Row], list[float], list[int]]:
    """Rows that each bring one unstated unknown, the guess and the levels.  Rows are of any size, the terms
    of one within six decades."""
    levels = [dice.choice((0, 1)) if j else 1 for j in range(n)]
    guess = [dice.choice((1, -1)) * 10 ** dice.uniform(-2, 2) if level else 0.0 for level in levels]
    rows, known = list[Row](), [j for j in range(n) if levels[j]]
    for j in (j for j in range(n) if not levels[j]):
        size = 10 ** dice.uniform(-50, 50)
        own = {k: dice.uniform(-1, 1) * 10 ** dice.uniform(-6, 0) * (size / guess[k])
               for k in dice.sample(known, min(2, len(known)))}  # fmt: skip
        rows.append(({**own, j: size * 10 ** dice.uniform(-4, 4)}, dice.choice((0.0, size))))
    return rows, guess, levels


@pytest.mark.full
def test_unstated_values_meet_equations_of_any_scale() -> None:
    """Nothing stated moves, however large or small the coefficient of what is zero so far."""
    dice = random.Random(5)
    for _ in range(300):
        n = dice.randint(2, 6)
        rows, guess, levels = chain(dice, n)
        rates = [a * 10 ** dice.uniform(-3, 3) for a in guess]
        search = Consistency(conditions(rows, n), 0.0, [*guess, *rates], [*levels, *levels])
        assert search.run() == 0, rows
        for row in rows:
            missed, size = exact(row, search.y[:n])
            assert missed <= ACCEPTED * size, (row, search.y)
            missed, size = exact((row[0], 0.0), search.y[n:])
            assert missed <= ACCEPTED * size, (row, search.y)
        for j, level in enumerate(levels):
            assert not level or (search.y[j] == guess[j] and search.y[n + j] == rates[j])


@pytest.mark.full
def test_contradicting_equations_of_any_scale_have_no_start() -> None:
    """A row said twice, the second time with another value: by its terms, or a thousandth of them."""
    dice = random.Random(6)
    refused = 0
    for _ in range(300):
        n = dice.randint(2, 6)
        rows, guess, levels = chain(dice, n)
        if not rows:
            continue
        coefficients, value = dice.choice(rows)
        size = max(abs(a * guess[j]) for j, a in coefficients.items()) + abs(value)
        rows.append((coefficients, value + size * dice.choice((1.0, -1.0, 1e-3))))
        search = Consistency(conditions(rows, n), 0.0, [*guess, *[0.0] * n], [*levels, *[0] * n])
        assert search.run() != 0, (rows, guess)
        refused += 1
    assert refused > 200


def tangled(dice: random.Random, n: int, span: float) -> tuple[list[Row], list[float], list[int]]:
    """Rows between any unknowns, many of them in rings: coefficients of any size, or of sizes that the terms
    share, or 1 but for one of each row."""
    levels = [1, *(int(dice.random() < 0.3) for _ in range(n - 2)), 0]
    guess = [dice.choice((1, -1)) * 10 ** dice.uniform(-2, 2) if level else 0.0 for level in levels]
    sizes = [abs(a) or 10 ** dice.uniform(-span / 2, span / 2) for a in guess]
    kind, ring, rows = dice.randrange(4), dice.sample(range(n), n), list[Row]()
    for k in range(dice.randint(1, n - sum(levels)) if kind == 3 else n - sum(levels)):
        own = {ring[k], ring[(k + 1) % n], *dice.choices(range(n), k=dice.choice((0, 0, 1)))}
        if kind == 3:
            own = set(dice.sample(range(n), dice.choice((2, 2, 3))))
        row, size = dict[int, float](), 10 ** dice.uniform(-span / 2, span / 2)
        one = dice.choice(sorted(own))
        for j in dice.sample(sorted(own), len(own)):
            wide = 10 ** dice.uniform(-span, span)
            shared = dice.uniform(0.5, 2) * size / sizes[j]
            row[j] = dice.choice((1, -1)) * (wide, shared, wide if j == one else 1.0, wide)[kind]
        rows.append((row, 0.0))
    return rows, guess, levels


def eliminated(rows: Sequence[Row], stated: Sequence[float], levels: Sequence[int]) -> list[Fraction] | None:
    """What nobody stated, 0 where the rows leave it open; None where they depend on each other there, or ask
    for numbers beyond doubles."""
    free = [j for j, level in enumerate(levels) if not level]
    table = [[Fraction(a.get(j, 0)) for j in free] for a, _ in rows]
    for line, (a, value) in zip(table, rows):
        line.append(Fraction(value) - sum(Fraction(a[j]) * Fraction(stated[j]) for j in a if levels[j]))
    found = [Fraction(a) for a in stated]
    for i, line in enumerate(table):
        k = next((k for k, a in enumerate(line[:-1]) if a), None)
        if k is None:
            return None
        table[i] = line = [a / line[k] for a in line]
        for r, other in enumerate(table):
            if r != i and other[k]:
                table[r] = [b - other[k] * a for a, b in zip(line, other)]
    for line in table:
        found[free[next(k for k, a in enumerate(line) if a)]] = line[-1]
    terms = [abs(Fraction(a) * found[j]) for row, _ in rows for j, a in row.items() if found[j]]
    within = [*terms, *(abs(a) for a in found if a)]
    return found if Fraction(10) ** -250 < min(within) and max(within) < Fraction(10) ** 250 else None


@pytest.mark.sample(1)
@pytest.mark.parametrize("span", [1, 2, 3, 4])
def test_rings_are_met(span: int) -> None:
    """Each row is met by its own terms, and nothing stated moves: what others have to be tells a size only
    where all rows are seen together."""
    dice = random.Random(span)
    tried = 0
    while tried < 60:
        n = dice.randint(3, 7)
        rows, guess, levels = tangled(dice, n, span)
        rates = [dice.uniform(1, 2) * a for a in guess]
        if not rows or eliminated(rows, guess, levels) is None or eliminated(rows, rates, levels) is None:
            continue
        tried += 1
        search = Consistency(conditions(rows, n), 0.0, [*guess, *rates], [*levels] * 2)
        assert search.run() == 0, (rows, guess, rates)
        for row in rows:
            for y in (search.y[:n], search.y[n:]):
                missed, size = exact(row, y)
                assert missed <= ACCEPTED * size, (row, y)
        for j, level in enumerate(levels):
            assert not level or (search.y[j], search.y[n + j]) == (guess[j], rates[j]), (rows, guess, rates)


@pytest.mark.sample(1)
@pytest.mark.parametrize("span", [1, 2, 3, 4])
def test_contradicting_rings_have_no_start(span: int) -> None:
    """One unknown of a ring is fixed beside what the others make of it: what is called a start is one."""
    dice = random.Random(span)
    tried = refused = 0
    while tried < 40:
        n = dice.randint(3, 6)
        rows, guess, levels = tangled(dice, n, span)
        true = eliminated(rows, guess, levels) if len(rows) == n - sum(levels) else None
        free = [j for j, level in enumerate(levels) if not level]
        if true is None or not free:
            continue
        tried += 1
        at = dice.choice(free)
        guess[at] = float(true[at]) * dice.choice((0.999, 1.001, -1.0, 1e3))
        held = [4 if level or j == at else 0 for j, level in enumerate(levels)]
        search = Consistency(conditions(rows, n), 0.0, [*guess, *[0.0] * n], [*held, *[0] * n])
        if search.run() != 0:
            refused += 1
            continue
        for row in rows:
            missed, size = exact(row, search.y[:n])
            assert missed <= ACCEPTED * size, (row, search.y)
    assert refused > 20


MODEL = """\
model M
  coordinate Length x(start = {x} [m], rate = 3 [m/s]), y, z(start = 2 [m]);
  body b = Particle(mass = 1, at = {{x, y, z}});
  constraint r: x = {k}*y{more};
end M;
"""


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize("k", ["30", "1e3", "3e7"])
def test_a_ring_is_met_by_c_and_python(k: str) -> None:
    """x = k y, y = z/k + u, z = x + w, w = 2 k u: of rings whose last places alone tell w and u."""
    rows = f";\n  constraint s: y = 1/{k}*w + u;\n  constraint t: w = x + v;\n  constraint o: v = 2*{k}*u;\n"
    rows += "  coordinate Length w, u, v;\n  body c = Particle(mass = 1, at = {w, u, v})"
    twins = Starts(program_of(MODEL.format(x=1, k=k, more=rows)))
    found = twins.by_python(0.0, twins.guess, twins.interface.start_levels)
    assert repr(found) == repr(twins.by_c(0.0, twins.guess, None))
    start = dict(zip((*twins.interface.q_names, *twins.interface.v_names), found[2]))
    assert (found[0], start["x"], start["der(x)"]) == (0, 1.0, 3.0)
    assert (start["w"], start["der(w)"]) == pytest.approx((1.0, 3.0), rel=1e-14)
    assert abs(start["v"]) <= 1e-15


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize("k", ["1e3", "1e6", "1e9", "1e10"])
def test_a_large_coefficient_hides_no_contradiction(k: str) -> None:
    twins = Starts(program_of(MODEL.format(x=1, k=k, more=f";\n  constraint s: x = 2 [m] + {k}*y")))
    found = twins.by_python(0.0, twins.guess, twins.interface.start_levels)
    assert repr(found) == repr(twins.by_c(0.0, twins.guess, None))
    assert found[0] != 0


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
  constraint nut: y = x*(x/(0.3 [m]))^5;
  constraint slider: x = 0.1 [m]*cos(c) + 0.3 [m]*cos(d);
  constraint guide: 0.1 [m]*sin(c) + 0.3 [m]*sin(d) = 0;
end Chain;
"""


@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", range(8))
def test_mechanisms_follow_what_is_stated_of_them(seed: int) -> None:
    """Cam and gears by closed form; the slider is where its steep nut says, the loop closed behind it: to
    1e-15 of a thousandth of the largest length, the tolerance of a start."""
    dice = random.Random(seed)
    system = system_of(CHAIN)
    h, x = 10.0 ** dice.uniform(-4.0, 0.0), dice.uniform(0.22, 0.38)
    given = {"h": h, "y": x * (x / 0.3) ** 5}
    start = consistent_start(system, 0.0, given)
    assert not start.unmet and not [c for c in start.changes if c.stated]
    found = dict(zip(system.interface.q_names, start.x))
    assert {name: found[name] for name in given} == given
    angle, off = math.log(h / 0.01) / 2.0, 1e-12 + 4e-15 * max(given.values()) / 1024
    assert math.isclose(found["a"], angle, rel_tol=1e-12, abs_tol=1e-12)
    assert math.isclose(found["b"], -angle / 7.0, rel_tol=1e-12, abs_tol=1e-12)
    assert abs(found["x"] - x) < off
    assert abs(0.1 * math.cos(found["c"]) + 0.3 * math.cos(found["d"]) - found["x"]) < off
    assert abs(0.1 * math.sin(found["c"]) + 0.3 * math.sin(found["d"])) < off


@pytest.mark.sample(2)
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
    assert not start.unmet
    found = dict(zip(system.interface.q_names, start.x))
    assert {name: found[name] for name in given} == given
    a, b, whole = math.log(given["x"]), math.log(given["w"]), i * l - j * k
    assert math.isclose(found["y"], (a * l - b * j) / whole, rel_tol=1e-11, abs_tol=1e-11)
    assert math.isclose(found["z"], (b * i - a * k) / whole, rel_tol=1e-11, abs_tol=1e-11)
