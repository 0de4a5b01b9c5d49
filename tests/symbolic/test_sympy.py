"""Expressions of SymPy have the values and the derivatives of the graph. The text of an expression says what
the expression is."""

import math
import random
import re
from collections.abc import Sequence

import pytest
import sympy
from hypothesis import assume, given, settings

from lagc.symbolic.derivative import tangent
from lagc.symbolic.expression_text import brief, text
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.operators import LOOKED_UP, OPERATORS, VALUES
from lagc.symbolic.sympy import to_sympy
from lagc.symbolic.walk import evaluate
from tests.symbolic.expressions import NAMES, grow, points, programs

SYMBOLS = [sympy.Symbol(name, real=True) for name in NAMES]


def value_of(node: Node, at: Sequence[float]) -> float:
    """The value of a node in x, y and so on, by SymPy."""
    return float(to_sympy([node])[0].subs(dict(zip(SYMBOLS, at))))


@settings(max_examples=60, deadline=None)
@given(programs, points)
def test_values_are_those_of_sympy(program: list[tuple[str, int, int]], at: tuple[float, ...]) -> None:
    graph = Graph()
    node = grow(graph, program[:6]).node
    state = dict(zip([graph.symbol("coordinate", name) for name in NAMES], at))
    size = max(map(abs, evaluate(graph.nodes, state)))
    assume(size < 1e6)
    # sympy sorts sums and merges powers: roundings of the largest part
    expected = pytest.approx(evaluate([node], state)[0], rel=1e-9, abs=1e-11 * max(1.0, size))
    assert value_of(node, at) == expected


@settings(max_examples=30, deadline=None)
@given(programs, points)
def test_derivatives_are_those_of_sympy(program: list[tuple[str, int, int]], at: tuple[float, ...]) -> None:
    graph = Graph()
    node = grow(graph, program[:5]).node
    x = graph.symbol("coordinate", "x")
    state = dict(zip([graph.symbol("coordinate", name) for name in NAMES], at))
    ours = evaluate(tangent(graph, [node], {x: graph.one}), state)[0]
    size = max(map(abs, evaluate(graph.nodes, state)))
    assume(size < 1e6)
    theirs = to_sympy([node])[0].diff(SYMBOLS[0]).evalf(subs=dict(zip(SYMBOLS, at)))
    assert ours == pytest.approx(float(theirs), rel=1e-9, abs=1e-11 * max(1.0, size))


def test_every_function_has_its_value() -> None:
    graph = Graph()
    x, y = graph.symbol("coordinate", "x"), graph.symbol("coordinate", "y")
    state = {x: 0.4, y: 0.7}
    rows = [row for row in OPERATORS.values() if row.name not in LOOKED_UP]
    nodes = [graph.unary(row.name, x) for row in rows if row.arity == 1 and not row.truth]
    nodes += [graph.binary(row.name, x, y) for row in rows if row.arity == 2 and not row.truth]
    less = graph.binary("lt", x, y)
    for truth in (less, graph.logical_not(less), graph.binary("or", less, graph.logical_not(less))):
        nodes.append(graph.select(truth, x, y))
    for node in nodes:
        assert value_of(node, (0.4, 0.7)) == pytest.approx(evaluate([node], state)[0]), node


def test_numbers_that_read_well_are_exact() -> None:
    graph = Graph()
    x = graph.symbol("coordinate", "x")
    assert str(to_sympy([0.5 * x + 3.0])[0]) == "x/2 + 3"


def test_names_may_be_given() -> None:
    graph = Graph()
    q = sympy.Function("q")(sympy.Symbol("t"))
    assert to_sympy([graph.symbol("coordinate", "q") ** 2], lambda symbol: q) == [q**2]


def read(written: str, values: dict[str, float]) -> float:
    return float(eval(written.replace("^", "**"), {"__builtins__": {}}, {**VALUES, **values}))


@pytest.mark.full
@settings(max_examples=200, deadline=None)
@given(programs, points)
def test_reading_gives_the_value_back(program: list[tuple[str, int, int]], at: tuple[float, ...]) -> None:
    graph = Graph()
    node = grow(graph, program[:7]).node
    state = {graph.symbol("coordinate", name): x for name, x in zip(NAMES, at)}
    size = max(map(abs, evaluate(graph.nodes, state)))
    written = text(node)
    assume(size < 1e6 and len(written) < 5000 and written.count("(") < 90)
    # Python multiplies from the left, the graph in the order of its factors
    expected = pytest.approx(evaluate([node], state)[0], rel=1e-9, abs=1e-12 * max(1.0, size))
    assert read(written, dict(zip(NAMES, at))) == expected


@pytest.fixture
def graph() -> Graph:
    return Graph()


def leaf(graph: Graph, name: str) -> Node:
    return graph.symbol("coordinate", name)


def test_looks(graph: Graph) -> None:
    m, length, w = (leaf(graph, name) for name in ("m", "l", "der(theta)"))
    assert text(m * length**2 * w - 2.0 * graph.cos(m)) == "m*l^2*der(theta) - 2*cos(m)"
    assert text(-(m + length)) == "-(m + l)"
    assert text(m - (length - w)) == "m - (l - der(theta))"
    assert text(1.0 / (m * length)) == "1/(m*l)"
    assert text(m / (length + w)) == "m/(l + der(theta))"
    assert text((m + length) ** 2) == "(m + l)^2"
    assert text(graph.const(-0.1)) == "-0.1"
    assert text(graph.const(3.0)) == "3"


def test_choices_keep_their_branches_together(graph: Graph) -> None:
    x, y = leaf(graph, "x"), leaf(graph, "y")
    node = graph.select(graph.binary("lt", x, y), x, y)
    assert text(node + 1.0) == "1 + (if (x < y) then x else y)"
    assert text(2.0 * node) == "2*(if (x < y) then x else y)"


def test_of_what_is_long_people_read_the_beginning_and_the_end(graph: Graph) -> None:
    angles = [leaf(graph, f"a{k}") for k in range(300)]
    total = graph.sum(graph.unary("sin", x) for x in angles)
    assert brief(graph.sub(angles[0], angles[1])) == text(graph.sub(angles[0], angles[1]))
    found = brief(2.0 * total)
    assert len(found) < 150 and found.count("...") == 1
    assert found.startswith("2*(sin(a0) + sin(a1) + ") and found.endswith(" + sin(a299))")


@pytest.mark.parametrize("seed", range(20))
def test_what_is_left_out_is_said_once_and_no_name_is_cut(graph: Graph, seed: int) -> None:
    chance, known = random.Random(seed), dict[Node, tuple[str, int]]()
    leaves = [leaf(graph, f"stiffness{k}") for k in range(60)]
    names = {text(x) for x in leaves}
    nodes = list(leaves)
    for _ in range(60):
        some = chance.sample(nodes, 12)
        nodes.append(graph.sum(some) if chance.random() < 0.5 else math.prod(some[1:], start=some[0]))
        found = brief(nodes[-1], known)
        assert len(found) <= 120 and found.count("...") <= 1
        assert set(re.findall(r"[a-z]+\d*", found)) <= names
