"""To sympy and back: the same values, and sympy's derivatives are the graph's."""

from __future__ import annotations

import pytest
import sympy
from hypothesis import assume, given, settings

from lagc.symbolic.derivative import tangent
from lagc.symbolic.evaluate import evaluate
from lagc.symbolic.graph import Graph
from lagc.symbolic.operators import LOOKED_UP, OPERATORS
from lagc.symbolic.sympy import from_sympy, to_sympy
from tests.symbolic.expressions import NAMES, grow, points, programs

SYMBOLS = [sympy.Symbol(name, real=True) for name in NAMES]


@settings(max_examples=60, deadline=None)
@given(programs, points)
def test_there_and_back_keeps_the_value(program: list[tuple[str, int, int]], at: tuple[float, ...]) -> None:
    graph = Graph()
    node = grow(graph, program[:6]).node
    leaves = [graph.symbol("coordinate", name) for name in NAMES]
    state = dict(zip(leaves, at))
    back = from_sympy(graph, to_sympy([node])[0], dict(zip(SYMBOLS, leaves)))
    size = max(map(abs, evaluate(graph.nodes, state)))
    assume(size < 1e6)
    # sympy sorts sums and merges powers: roundings of the largest part
    expected = pytest.approx(evaluate([node], state), rel=1e-9, abs=1e-11 * max(1.0, size))
    assert evaluate([back], state) == expected


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


def test_every_function_goes_both_ways() -> None:
    graph = Graph()
    x, y = graph.symbol("coordinate", "x"), graph.symbol("coordinate", "y")
    state = {x: 0.4, y: 0.7}
    rows = [row for row in OPERATORS.values() if row.name not in LOOKED_UP]
    nodes = [graph.unary(row.name, x) for row in rows if row.arity == 1 and not row.truth]
    nodes += [graph.binary(row.name, x, y) for row in rows if row.arity == 2]
    less = graph.binary("lt", x, y)
    more = graph.logical_not(less)
    nodes += [graph.select(less, x, y), more, graph.binary("or", less, more)]
    for node, expr in zip(nodes, to_sympy(nodes)):
        back = from_sympy(graph, expr, dict(zip(SYMBOLS, (x, y))))
        assert evaluate([back], state) == pytest.approx(evaluate([node], state)), node


def test_numbers_that_read_well_are_exact() -> None:
    graph = Graph()
    x = graph.symbol("coordinate", "x")
    assert str(to_sympy([0.5 * x + 3.0])[0]) == "x/2 + 3"


def test_names_may_be_given() -> None:
    graph = Graph()
    q = sympy.Function("q")(sympy.Symbol("t"))
    assert to_sympy([graph.symbol("coordinate", "q") ** 2], lambda symbol: q) == [q**2]


def test_unknown_functions_are_told() -> None:
    with pytest.raises(ValueError, match="gamma"):
        from_sympy(Graph(), sympy.gamma(SYMBOLS[0]), {SYMBOLS[0]: Graph().one})
