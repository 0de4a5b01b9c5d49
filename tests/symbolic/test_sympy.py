"""Expressions of SymPy have the values and the derivatives of the graph."""

from collections.abc import Sequence

import pytest
import sympy
from hypothesis import assume, given, settings

from lagc.symbolic.derivative import tangent
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.operators import LOOKED_UP, OPERATORS
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
