"""Walks, evaluation and vectors."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lagc.symbolic import vectors
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.walk import depends, evaluate, reachable, substitute, symbols
from tests.symbolic.expressions import NAMES, grow, points, programs


@settings(max_examples=100, deadline=None)
@given(programs, programs, points)
def test_substitution_is_composition(
    outer: list[tuple[str, int, int]], inner: list[tuple[str, int, int]], at: tuple[float, ...]
) -> None:
    graph = Graph()
    f, g = grow(graph, outer[:6]).node, grow(graph, inner[:6]).node
    leaves = [graph.symbol("coordinate", name) for name in NAMES]
    state = dict(zip(leaves, at))
    composed = substitute(graph, [f], {leaves[0]: graph.sin(g)})[0]
    inside = math.sin(evaluate([g], state)[0])
    expected = evaluate([f], {**state, leaves[0]: inside})[0]
    size = max(abs(x) for x in evaluate(reachable([f]), {**state, leaves[0]: inside}))
    assert evaluate([composed], state)[0] == pytest.approx(expected, rel=1e-9, abs=1e-11 * max(1.0, size))


def test_replacements_happen_at_once() -> None:
    graph = Graph()
    x, y = graph.symbol("coordinate", "x"), graph.symbol("coordinate", "y")
    assert substitute(graph, [x - 2.0 * y, x], {x: y, y: x}) == [y - 2.0 * x, y]


def test_only_what_is_touched_is_built_anew() -> None:
    graph = Graph()
    x, y = graph.symbol("coordinate", "x"), graph.symbol("coordinate", "y")
    kept = graph.sin(y)
    count = len(graph.nodes)
    assert substitute(graph, [kept], {x: y}) == [kept]
    assert len(graph.nodes) == count


def test_who_depends_on_whom() -> None:
    graph = Graph()
    x, y = graph.symbol("coordinate", "x"), graph.symbol("coordinate", "y")
    a, b = graph.sin(x), graph.cos(y)
    assert symbols([a + b]) == {x, y}
    assert depends([a + b, b], [x]) == {x, a, a + b}
    assert depends([b], [x]) == set()
    assert reachable([a]) == [x, a]


def test_kinds_keep_symbols_apart() -> None:
    graph = Graph()
    assert graph.symbol("coordinate", "x") is not graph.symbol("parameter", "x")


def test_outside_a_domain_the_value_is_nan() -> None:
    graph = Graph()
    x = graph.symbol("coordinate", "x")
    functions = [graph.unary(op, x) for op in ("sqrt", "log", "asin", "acos")]
    for node in (*functions, graph.pow(x, graph.const(0.3))):
        assert math.isnan(evaluate([node], {x: -2.0})[0])


def test_a_symbol_without_a_value_is_told() -> None:
    graph = Graph()
    with pytest.raises(KeyError):
        evaluate([graph.symbol("coordinate", "x") + 1.0], {})


triples = st.tuples(*[st.floats(-10, 10) for _ in range(3)])
matrices = st.tuples(triples, triples, triples)


@given(triples, triples, matrices, matrices)
def test_vectors_are_those_of_numpy(
    a: tuple[float, ...],
    b: tuple[float, ...],
    m: tuple[tuple[float, ...], ...],
    n: tuple[tuple[float, ...], ...],
) -> None:
    graph = Graph()

    def vector(v: tuple[float, ...]) -> vectors.Vector:
        x, y, z = (graph.const(c) for c in v)
        return (x, y, z)

    def matrix(rows: tuple[tuple[float, ...], ...]) -> vectors.Matrix:
        x, y, z = (vector(row) for row in rows)
        return (x, y, z)

    def close(found: tuple[Node | vectors.Vector, ...], expected: np.ndarray) -> None:
        flat = [x for row in found for x in (row if isinstance(row, tuple) else (row,))]
        assert evaluate(flat, {}) == pytest.approx(np.ravel(expected).tolist(), abs=1e-11)

    p, q, s, t = vector(a), vector(b), matrix(m), matrix(n)
    close((vectors.dot(p, q),), np.dot(a, b))
    close(vectors.cross(p, q), np.cross(a, b))
    close((vectors.norm(p),), np.linalg.norm(a))
    close(vectors.add(p, q), np.add(a, b))
    close(vectors.sub(p, q), np.subtract(a, b))
    close(vectors.scale(2.5, p), 2.5 * np.array(a))
    close(vectors.matvec(s, p), np.array(m) @ np.array(a))
    close(vectors.matmul(s, t), np.array(m) @ np.array(n))
    close(vectors.transpose(s), np.transpose(m))
