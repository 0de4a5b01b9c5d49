"""Velocity rows with relations between positions planted in them: sums of f_i dg_i are the rates of
relations together, whatever the factors; what is added to them is not."""

import random
from collections.abc import Mapping, Sequence
from itertools import pairwise

import pytest

from lagc.mechanics.analysis import integrability
from lagc.mechanics.analysis.analysis import Analysis, analyse
from lagc.mechanics.derive import derive
from lagc.symbolic.derivative import gradient
from lagc.symbolic.finite_field import Echelon
from lagc.symbolic.graph import Node
from tests.mechanics.builder import Builder


def space(n: int) -> tuple[Builder, list[Node]]:
    b = Builder()
    q = [b.coordinate(f"q{k}", 0.3 + 0.1 * k) for k in range(n)]
    b.lagrangian("K", 0.5 * b.graph.sum(b.der(x) ** 2 for x in q), is_kinetic=True)
    return b, q


def answers(a: Analysis) -> dict[str, bool | None]:
    return {c.label: c.integrable for c in a.constraints if not c.holonomic}


def some_function(b: Builder, rng: random.Random, q: Sequence[Node]) -> Node:
    """Of two or three of `q`."""
    g = b.graph
    x, y, z = rng.sample(list(q), 3)
    c = rng.choice([0.7, 2.0, b.parameter(f"c{len(b.parameters)}", rng.uniform(0.5, 2.0))])
    return rng.choice([x * y + c * z, g.sin(x) + c * y * z, x + c * y * y, g.unary("exp", x) * z + c * y])


def factor(b: Builder, rng: random.Random, q: Sequence[Node]) -> Node:
    x, y = rng.sample(list(q), 2)
    return rng.choice([2.0 + x * x, x + y * y, b.graph.cos(x) * y + 3.0, b.graph.unary("exp", x - y)])


def contact(b: Builder, x: Node, y: Node, z: Node) -> Node:
    """dz - y dx, in rates: with nothing else it restricts no positions."""
    return b.der(z) - y * b.der(x)


@pytest.mark.sample(3)
@pytest.mark.parametrize("seed", range(20))
def test_planted_relations_are_found(seed: int) -> None:
    """k rows are combinations of dg_1 ... dg_k with changing factors: all are integrable together.
    One more is dz - y dx of coordinates of its own, and is not."""
    rng = random.Random(seed)
    n, k = rng.randint(4, 6), rng.randint(1, 3)
    b, q = space(n + 3)
    free, own = q[:n], q[n:]
    goals = [some_function(b, rng, free) for _ in range(k)]
    for i in range(k):
        terms = [factor(b, rng, free) * b.der(goal) for goal in goals[: i + 1]]
        b.constraint(f"planted{i}", b.graph.sum(terms))
    b.constraint("contact", contact(b, *own))
    a = analyse(derive(b.model()))
    rank = len(b.constraints) - len(a.dropped)
    planted = {label: x for label, x in answers(a).items() if label != "contact"}
    assert all(planted.values()) and answers(a)["contact"] is False
    assert (a.degrees_of_freedom, a.positional_freedom) == (n + 3 - rank, n + 3 - rank + 1)
    assert not a.seems.positional_freedom and all(c.proved for c in a.constraints)


@pytest.mark.parametrize("seed", range(12))
def test_relations_that_lie_in_no_row_alone_are_counted(seed: int) -> None:
    """Two contact rows with a multiple of dg added to both: their difference alone is integrable."""
    rng = random.Random(seed)
    b, (x, y, z, u, w, r, s) = space(7)
    goal = some_function(b, rng, (u, w, r, s))
    first = contact(b, x, y, z)
    scale = factor(b, rng, (u, w, x))
    b.constraint("one", first + scale * b.der(goal))
    b.constraint("two", factor(b, rng, (x, w, s)) * (first - scale * b.der(goal)))
    a = analyse(derive(b.model()))
    assert answers(a) == {"one": False, "two": False}
    assert (a.degrees_of_freedom, a.positional_freedom, a.seems.positional_freedom) == (5, 6, False)


@pytest.mark.parametrize("order", range(6))
@pytest.mark.parametrize("how", ["holonomic", "velocity", "with a factor"])
def test_a_row_that_another_makes_integrable(how: str, order: int) -> None:
    """dx = y dz is not integrable, and is where y is held; the third row has nothing to do with it."""
    b, (x, y, z, u, w, r) = space(6)
    held = {"holonomic": y - 0.4, "velocity": b.der(y), "with a factor": (2.0 + x * x) * b.der(y)}[how]
    rows = {"roll": b.der(x) - y * b.der(z), "held": held, "contact": contact(b, u, w, r)}
    names = [list(rows)[k] for k in ((0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0))[order]]
    for name in names:
        b.constraint(name, rows[name])
    a = analyse(derive(b.model()))
    expected = {"roll": True, "contact": False, **({} if how == "holonomic" else {"held": True})}
    assert answers(a) == expected
    assert (a.degrees_of_freedom, a.positional_freedom) == (3, 4)
    (reason,) = [c.explanation for c in a.constraints if c.label == "roll"]
    assert ("holonomic" if how == "holonomic" else "with other velocity rows") in reason


def test_a_chain_of_rows_each_of_which_needs_the_next() -> None:
    """da = b dc, db = c dd, dc = 0: from the last to the first."""
    b, (p, q, r, s, u) = space(5)
    b.constraint("first", b.der(p) - q * b.der(u))
    b.constraint("second", b.der(q) - r * b.der(s))
    assert answers(analyse(derive(b.model()))) == {"first": False, "second": False}
    b.constraint("third", b.der(r))
    assert answers(analyse(derive(b.model()))) == {"first": False, "second": True, "third": True}
    b.constraint("fourth", b.der(s))
    a = analyse(derive(b.model()))
    assert set(answers(a).values()) == {True}
    assert (a.degrees_of_freedom, a.positional_freedom) == (1, 1)


@pytest.mark.parametrize("hidden", [False, True])
def test_a_row_is_integrable_on_every_branch_or_not(hidden: bool) -> None:
    b, (x, y, z) = space(3)
    g = b.graph
    far = (x - 5.0) ** 3 * (y if hidden else g.one)
    b.constraint("roll", b.der(z) - g.select(g.binary("lt", g.const(5.0), x), far, g.zero) * b.der(x))
    assert answers(analyse(derive(b.model()))) == {"roll": not hidden}


def test_many_independent_wheels() -> None:
    """Each wheel is a system of its own."""
    b, q = space(30)
    for k in range(10):
        x, y, z = q[3 * k : 3 * k + 3]
        b.constraint(f"roll{k}", contact(b, x, y, z) if k % 2 else b.der(z) - x * b.der(x))
    found = answers(analyse(derive(b.model())))
    assert found == {f"roll{k}": k % 2 == 0 for k in range(10)}


def test_rows_of_many_positions_that_hang_together() -> None:
    b, q = space(20)
    total = b.graph.sum(x * x for x in q)
    b.constraint("sum", b.der(total))
    b.constraint("other", (1.0 + q[0] ** 2) * b.der(b.graph.sum(x * y for x, y in pairwise(q))))
    b.constraint("mixed", q[3] * b.der(total) + contact(b, q[0], q[1], q[2]))
    found = answers(analyse(derive(b.model())))
    assert found == {"sum": True, "other": True, "mixed": False}


def test_rows_that_drop_out_one_after_the_other(monkeypatch: pytest.MonkeyPatch) -> None:
    """dq_k - q_(k+1) dq_(k+2) of a chain are no relations, one sum besides is.  Without brackets, all rows
    are eliminated once each time that some drop out, not once more for each of them."""
    grows, counts = Echelon.grows, list[int]()

    def counted(rows: Echelon, row: Mapping[int, int]) -> bool:
        counts[-1] += 1
        return grows(rows, row)

    monkeypatch.setattr(integrability, "LONGEST", 0)
    monkeypatch.setattr(Echelon, "grows", counted)
    for n in (18, 36):
        b, q = space(n)
        for k in range(n // 2):
            b.constraint(f"roll{k}", contact(b, q[k + 2], q[k + 1], q[k]))
        b.constraint("sum", (1.0 + q[0] ** 2) * b.der(b.graph.sum(x * x for x in q)))
        counts.append(0)
        found = answers(analyse(derive(b.model())))
        assert found == {**{f"roll{k}": False for k in range(n // 2)}, "sum": True}
    assert counts[1] <= 2.5 * counts[0]


@pytest.mark.parametrize("seed", range(8))
def test_decimal_numbers_with_rounding_in_them_only_seem(seed: int) -> None:
    """2c, c/d and the like are folded by the compiler, with rounding."""
    rng = random.Random(seed)
    b, (x, y, z) = space(3)
    c, d = rng.uniform(0.5, 2.0), rng.uniform(0.1, 0.9)
    goal = x + c * y * y + d * b.graph.sin(z)
    b.constraint("planted", (c + x * x) * b.der(goal))
    a = analyse(derive(b.model()))
    assert answers(a) == {"planted": True} and a.seems.positional_freedom


def test_gradients_are_what_is_planted() -> None:
    """der(goal) is the sum of its slopes times rates: the planted rows are what the tests say."""
    b, q = space(3)
    goal = q[0] * q[1] + b.graph.sin(q[2])
    slopes = gradient(b.graph, {goal: b.graph.one}, q)
    assert b.der(goal) is b.graph.sum(slopes[x] * b.der(x) for x in q)
