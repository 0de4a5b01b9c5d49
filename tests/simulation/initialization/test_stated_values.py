"""What was stated moves only where it has to: random conditions whose truth is known by construction."""

import random
from collections.abc import Callable, Sequence
from itertools import combinations

import numpy as np
import pytest

import lagc
from lagc.simulation.initialization.solver import Conditions, Consistency
from lagc.simulation.system import INCONSISTENT, OK

Rows = Callable[[Sequence[float]], tuple[list[float], list[list[float]], list[float]]]


def conditions(n: int, rows: Rows, angles: Sequence[int] = ()) -> Conditions:
    """Of n coordinates of one unit, without speeds; `rows` gives c, dense J and sizes."""
    m = len(rows([0.5] * n)[0])

    def evaluate(t: float, x: Sequence[float]) -> tuple[list[float], list[float], list[float]]:
        c, jacobian, sizes = rows(x)
        return list(c), [a for row in jacobian for a in row], list(sizes)

    ends = [n * (i + 1) for i in range(m)]
    return Conditions(n, 0, (), [0] * n, angles, ends, [*range(n)] * m, evaluate, lambda: ([], [0.0]))


def linear(matrix: np.ndarray, right: np.ndarray) -> Rows:
    def rows(x: Sequence[float]) -> tuple[list[float], list[list[float]], list[float]]:
        c = [float(sum(a * b for a, b in zip(row, x)) - r) for row, r in zip(matrix.tolist(), right.tolist())]
        sizes = [float(sum(abs(a * b) for a, b in zip(row, x)) + abs(r)) for row, r in zip(matrix, right)]
        return c, matrix.tolist(), sizes

    return rows


def solvable(matrix: np.ndarray, right: np.ndarray, x: np.ndarray, free: Sequence[int]) -> bool:
    rest = right - matrix @ x
    if not free:
        return bool(np.max(np.abs(rest)) < 1e-9)
    step = np.linalg.lstsq(matrix[:, free], rest, rcond=1e-9)[0]
    return bool(np.max(np.abs(matrix[:, free] @ step - rest)) < 1e-9)


def truth(matrix: np.ndarray, right: np.ndarray, x: np.ndarray, levels: Sequence[int]) -> list[int] | None:
    """How many values of the levels 3, 2, 1 have to move, found by trying all; None: there is no start."""
    free = [i for i, level in enumerate(levels) if level == 0]
    below = {k: [i for i, level in enumerate(levels) if 0 < level < k] for k in (1, 2, 3)}
    chosen: list[list[int]] = [[]]  # all smallest choices of the levels above
    counts: list[int] = []
    for k in (3, 2, 1):
        own = [i for i, level in enumerate(levels) if level == k]
        for count in range(len(own) + 1):
            found = [
                [*above, *picked]
                for above in chosen
                for picked in combinations(own, count)
                if solvable(matrix, right, x, [*free, *below[k], *above, *picked])
            ]
            if found:
                break
        else:
            return None
        chosen, counts = found, [*counts, count]
    return counts


@pytest.mark.sample(6, 12)
@pytest.mark.parametrize("seed", range(60))
def test_few_stated_values_move(seed: int) -> None:
    """Against all subsets: a start is found where there is one, no value of a level moves where lower levels
    suffice, and of the highest level at most twice the least number."""
    dice = random.Random(seed)
    n, m = dice.randint(2, 7), dice.randint(1, 4)
    matrix = np.array([[dice.choice((0, 0, 1, -1, 2)) for _ in range(n)] for _ in range(m)], float)
    right = matrix @ np.array([dice.choice((0.0, 1.0, 2.0, -1.5)) for _ in range(n)])
    x = np.array([dice.choice((0.0, 1.0, 2.0, -1.5, 3.0)) for _ in range(n)])
    levels = [dice.choice((0, 1, 1, 2, 3, 4)) for _ in range(n)]
    search = Consistency(conditions(n, linear(matrix, right)), 0.0, x.tolist(), levels)
    status = search.run()
    expected = truth(matrix, right, x, levels)
    assert (status == INCONSISTENT) == (expected is None)
    if expected is None:
        return
    assert status == OK
    y = np.array(search.y)
    assert np.max(np.abs(matrix @ y - right)) < 1e-12
    assert not any(y[i] != x[i] for i in range(n) if levels[i] == 4)
    counts = [sum(y[i] != x[i] for i in range(n) if levels[i] == k) for k in (3, 2, 1)]
    highest = next((k for k in range(3) if expected[k]), None)
    if highest is None:
        assert counts == expected
    else:  # values that play the same part move alike
        assert not any(counts[:highest]) and expected[highest] <= counts[highest] <= 2 * expected[highest]


def distances(n: int, pairs: Sequence[tuple[int, int]], lengths: Sequence[float]) -> Rows:
    """n points in the plane at given distances from one another."""

    def rows(x: Sequence[float]) -> tuple[list[float], list[list[float]], list[float]]:
        c, jacobian, sizes = [], [], []
        for (a, b), length in zip(pairs, lengths):
            dx, dy = x[2 * a] - x[2 * b], x[2 * a + 1] - x[2 * b + 1]
            row = [0.0] * (2 * n)
            row[2 * a], row[2 * a + 1], row[2 * b], row[2 * b + 1] = 2 * dx, 2 * dy, -2 * dx, -2 * dy
            c.append(dx * dx + dy * dy - length * length)
            jacobian.append(row)
            sizes.append(dx * dx + dy * dy + length * length)
        return c, jacobian, sizes

    return rows


@pytest.mark.parametrize("seed", range(40))
def test_no_stated_value_moves_where_the_others_can(seed: int) -> None:
    """Points in the plane, at the distances of a solution chosen first; its values are stated, those
    of other coordinates are off, by up to a fifth, or not given at all."""
    dice = random.Random(seed)
    n = dice.randint(2, 5)
    solution = [dice.gauss(0.0, 1.0) for _ in range(2 * n)]
    pairs = dice.sample([(a, b) for a in range(n) for b in range(a)], dice.randint(1, n - 1))
    lengths = [
        float(np.hypot(*(solution[2 * a + k] - solution[2 * b + k] for k in (0, 1)))) for a, b in pairs
    ]
    levels = [dice.choice((0, 0, 1, 2, 3, 4)) for _ in range(2 * n)]
    guess = [a if level else a + dice.uniform(-0.2, 0.2) for a, level in zip(solution, levels)]
    problem = conditions(2 * n, distances(n, pairs, lengths))
    search = Consistency(problem, 0.0, guess, levels)
    assert search.run() == OK
    assert all(a == b for a, b, level in zip(guess, search.y, levels) if level)
    assert max(map(abs, problem.evaluate(0.0, search.y)[0]), default=0.0) < 1e-9


@pytest.mark.sample(4)
@pytest.mark.parametrize("power", (-500, -50, 50, 166))
@pytest.mark.parametrize("seed", range(4))
def test_no_size_is_hidden(seed: int, power: int) -> None:
    """Powers of two change no digit: the same start, scaled (lengths squared stay within doubles)."""
    dice = random.Random(seed)
    n, scale = 4, 2.0**power
    solution = [dice.gauss(0.0, 1.0) for _ in range(2 * n)]
    pairs = [(a, a - 1) for a in range(1, n)] + [(n - 1, 0)]
    lengths = [
        float(np.hypot(*(solution[2 * a + k] - solution[2 * b + k] for k in (0, 1)))) for a, b in pairs
    ]
    levels = [dice.choice((0, 0, 1, 3)) for _ in range(2 * n)]
    guess = [a + dice.uniform(-0.3, 0.3) if dice.random() < 0.7 else 0.0 for a in solution]
    one = Consistency(conditions(2 * n, distances(n, pairs, lengths)), 0.0, guess, levels)
    other = Consistency(
        conditions(2 * n, distances(n, pairs, [a * scale for a in lengths])),
        0.0,
        [a * scale for a in guess],
        levels,
    )
    assert one.run() == other.run() == OK
    assert [a * scale for a in one.y] == other.y


@pytest.mark.parametrize("seed", range(20))
def test_a_singular_guess_is_left(seed: int) -> None:
    """All points at one place, where no distance has a gradient; those that nothing ties stay there."""
    dice = random.Random(seed)
    n = dice.randint(2, 5)
    pairs = [(a, dice.randrange(a)) for a in range(1, n)]
    lengths = [dice.uniform(0.5, 2.0) for _ in pairs]
    problem = conditions(2 * n + 2, distances(n + 1, pairs, lengths))
    search = Consistency(problem, 0.0, [0.0] * (2 * n + 2), [0] * (2 * n + 2))
    assert search.run() == OK
    assert search.y[2 * n :] == [0.0, 0.0]
    assert max(map(abs, problem.evaluate(0.0, search.y)[0])) < 1e-12


def test_a_stated_rate_gives_way_before_another_goes_to_the_end_of_the_world() -> None:
    """The second body turns about the axis that it shares with the first.  Derivatives of that condition by
    rates of the first vanish where it is met; rates of 1e12 rad/s meet any rate by what rounding leaves."""
    model = lagc.loads("""model Hinge
  coordinate Orientation o, p(rate = {1, 0, 0});
  frame A = rotate(world, o);
  frame B = rotate(A, p);
  body first = Solid(mass = 1, inertia = {1, 2, 3}, frame = A, com = {0, 0, 0});
  body second = Solid(mass = 1, inertia = {1, 2, 3}, frame = B, com = {0, 0, 0});
  constraint axis: B.x = A.x;
end Hinge;""").compile()
    run = model.simulate(stop=0.0, starts={"p.rate.y": 1e-3})
    rates = [run[f"{body}.rate.{axis}"][0] for body in "op" for axis in "xyz"]
    assert run.status == "ok" and rates == pytest.approx([0.0, 0.0, 0.0, 1.0, 0.0, 0.0], abs=1e-12)


@pytest.mark.parametrize("condition", ["x^2 = 1e8 [m2]", "x*y = 1e12 [m2]"])
def test_what_has_no_other_start_goes_far(condition: str) -> None:
    model = lagc.loads(f"""model Far
  parameter Length l = 1 [m];
  coordinate Length x, y(fixed = true, start = l);
  body b = Particle(mass = 1 [kg], at = {{x, y, 0}});
initial
  {condition};
end Far;""").compile()
    x = model.simulate(stop=0.0)["x"][0]
    assert abs(x) == pytest.approx({"x^2": 1e4, "x*y": 1e12}[condition.partition(" ")[0]])
