"""What the rows say of the operators, against numbers with many digits."""

import math
import random

import mpmath
import pytest

from lagc.codegen.python.public_functions import public_functions
from lagc.symbolic.derivative import tangent
from lagc.symbolic.graph import Graph
from lagc.symbolic.operators import (
    CHOICE,
    COMPARISONS,
    CORNER,
    ENTIRE,
    LOGIC,
    LOOKED_UP,
    OPERATORS,
    STEP,
    Operator,
    spelling,
)
from lagc.symbolic.walk import evaluate
from tests.codegen.programs import pendulum

ROWS = list(OPERATORS.values())
NUMERIC = [row for row in ROWS if row.smoothness not in (LOGIC, CHOICE) and not row.looked_up]
SMOOTH = [row for row in NUMERIC if row.smoothness not in (STEP, CORNER)]
TRUE = {
    "abs": mpmath.fabs, "pow": mpmath.power, "min": min, "max": max,
    "lt": lambda x, y: x < y, "le": lambda x, y: x <= y, "eq": lambda x, y: x == y,
}  # fmt: skip


def exact(row: Operator, *x: object) -> mpmath.mpf:
    found = TRUE.get(row.name) or getattr(mpmath, row.name)
    return mpmath.mpf(found(*x))


def inside(row: Operator, rng: random.Random, count: int) -> list[list[float]]:
    """Arguments where it has a value: log, sqrt and pow have one for what is positive."""
    low, high = {"asin": (-1.0, 1.0), "acos": (-1.0, 1.0)}.get(row.name, (-4.0, 4.0))
    low = 1e-3 if row.name in ("log", "sqrt", "pow") else low
    return [[rng.uniform(low, high) for _ in range(row.arity)] for _ in range(count)]


def named(row: Operator) -> str:
    return row.name


@pytest.mark.sample(3, 12)
@pytest.mark.parametrize("row", NUMERIC, ids=named)
def test_values_ranges_and_symmetries_are_those_of_the_function(row: Operator) -> None:
    before: list[list[float]] = []
    for x in inside(row, random.Random(row.name), 200):
        true = exact(row, *x)
        assert float(row.value(*x)) == pytest.approx(float(true), rel=1e-14, abs=1e-15)
        assert row.within[0] <= true <= row.within[1]
        if row.rising:
            lower = [y for y in before if all(a <= b for a, b in zip(y, x))]
            assert all(exact(row, *y) <= true for y in lower)
            before.append(x)
        if row.parity:
            assert exact(row, *(-a for a in x)) == row.parity * true
        if row.twin:
            assert abs(true**2 + exact(OPERATORS[row.twin], *x) ** 2 - 1) < 1e-14
        if row.sides is not None:
            graph = Graph()
            leaves = [graph.symbol("coordinate", str(k)) for k in range(row.arity)]
            assert evaluate([row.sides(graph, *leaves)], dict(zip(leaves, x))) == [float(true)]


@pytest.mark.parametrize("name", ["acos", "exp", "floor"])
def test_what_has_no_parity_is_not_symmetric(name: str) -> None:
    row = OPERATORS[name]
    assert row.parity == 0 and abs(row.value(0.3)) != abs(row.value(-0.3))


@pytest.mark.parametrize("row", NUMERIC, ids=named)
def test_slopes_are_those_of_the_function(row: Operator) -> None:
    graph = Graph()
    leaves = [graph.symbol("coordinate", str(k)) for k in range(row.arity)]
    node = graph.unary(row.name, *leaves) if row.arity == 1 else graph.binary(row.name, *leaves)
    for x in inside(row, random.Random(row.name), 30):
        state = dict(zip(leaves, x))
        for k, leaf in enumerate(leaves):
            found = evaluate(tangent(graph, [node], {leaf: graph.one}), state)[0]
            with mpmath.workdps(40):  # the difference has about 20 digits
                h = mpmath.mpf("1e-12")
                ends = [[a + s * h if i == k else mpmath.mpf(a) for i, a in enumerate(x)] for s in (1, -1)]
                true = (exact(row, *ends[0]) - exact(row, *ends[1])) / (2 * h)
            assert found == pytest.approx(float(true), rel=1e-11, abs=1e-11)


@pytest.mark.parametrize("row", SMOOTH, ids=named)
def test_an_entire_function_has_a_value_everywhere(row: Operator) -> None:
    if row.smoothness == ENTIRE:
        assert all(math.isfinite(row.value(x)) for x in (-300.0, -1.5, 0.0, 1.5, 300.0))


def test_whole_columns_know_every_function_that_generated_python_calls() -> None:
    text = public_functions(pendulum(), True)[-1]
    ours = ("sin", "cos")  # one call gives both
    calls = [
        "sine_cosine",
        *(word for op, word in spelling("python").items() if op not in (*COMPARISONS, *LOOKED_UP, *ours)),
    ]
    assert all(f'"{word}":' in text or f'arrays["{word}"]' in text for word in calls)
