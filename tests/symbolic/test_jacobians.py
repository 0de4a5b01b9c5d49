"""Derivatives by sums are those by leaves: against differences, and against plain reverse sweeps."""

import random

import pytest

from lagc.symbolic import derivative as module
from lagc.symbolic.derivative import Slopes, gradient, slopes
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.walk import evaluate

STEP = 1e-6


def ladder(graph: Graph, n: int) -> tuple[list[Node], list[Node]]:
    """Distances between points along two chains, whose places are sums that they share; and the angles."""
    a = [graph.symbol("q", f"a{k}") for k in range(n)]
    b = [graph.symbol("q", f"b{k}") for k in range(n)]
    x = y = graph.zero
    u = v = graph.one
    found = []
    for left, right in zip(a, b):
        x, y = x + graph.unary("sin", left), y - graph.unary("cos", left)
        u, v = u + graph.unary("sin", right), v - graph.unary("cos", right)
        found.append((x - u) ** 2 + (y - v) ** 2)
    return found, [*a, *b]


def tangle(graph: Graph, seed: int) -> tuple[list[Node], list[Node]]:
    """Sums of sums and products of them, used again and again; some derivatives are zero."""
    dice = random.Random(seed)
    leaves = [graph.symbol("q", f"x{k}") for k in range(12)]
    pool = list(leaves)
    for _ in range(40):
        left, right = dice.choice(pool), dice.choice(pool)
        kind = dice.choice(("add", "add", "sub", "mul", "sin"))
        made = {
            "add": left + right,
            "sub": left - right,
            "mul": left * right,
            "sin": graph.unary("sin", left),
        }
        pool.append(made[kind])
    return [x for x in pool[-8:] if not x.is_const], leaves


def values(graph: Graph, found: Slopes, k: int, state: dict[Node, float]) -> dict[int, float]:
    own = found.entries(k)
    return dict(zip(own, evaluate(list(own.values()), state)))


@pytest.mark.parametrize("seed", range(30))
def test_entries_are_differences(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_WORTH", 0)  # by sums wherever there are some
    graph, dice = Graph(), random.Random(seed)
    nodes, leaves = ladder(graph, 4) if seed == 0 else tangle(graph, seed)
    found = slopes(graph, nodes, {x: k for k, x in enumerate(leaves)}, len(leaves))
    state = {x: dice.uniform(-1.0, 1.0) for x in leaves}
    for k, node in enumerate(nodes):
        own = values(graph, found, k, state)
        assert list(own) == sorted(own)
        for j, leaf in enumerate(leaves):
            (above,) = evaluate([node], {**state, leaf: state[leaf] + STEP})
            (below,) = evaluate([node], {**state, leaf: state[leaf] - STEP})
            size = 1.0 + abs(above) + abs(own.get(j, 0.0))
            assert own.get(j, 0.0) == pytest.approx((above - below) / (2 * STEP), abs=1e-4 * size)


def test_many_are_given_by_sums_and_few_are_not() -> None:
    graph = Graph()
    nodes, leaves = ladder(graph, 60)
    places = {x: k for k, x in enumerate(leaves)}
    found = slopes(graph, nodes, places, len(leaves))
    assert found.sums and len(found.nodes) <= 20 * len(nodes)
    assert [len(columns) for columns in found.columns] == [2 * (k + 1) for k in range(60)]
    assert not slopes(graph, nodes, places, len(leaves), few=10_000).sums
    assert not slopes(graph, leaves, places, len(leaves)).sums
    dice = random.Random(1)
    state = {x: dice.uniform(-1.0, 1.0) for x in leaves}
    for k in (0, 7, 59):
        plain = gradient(graph, {nodes[k]: graph.one}, places)
        wanted = dict(zip([places[x] for x in plain], evaluate(list(plain.values()), state)))
        assert values(graph, found, k, state) == pytest.approx(wanted, rel=1e-12, abs=1e-12)


def test_leaves_are_placed_anew_and_derivatives_replaced() -> None:
    graph = Graph()
    nodes, leaves = ladder(graph, 30)
    found = slopes(graph, nodes, {x: k for k, x in enumerate(leaves)}, len(leaves))
    assert found.sums
    turned = found.placed({k: 59 - k for k in range(60)}, 70)
    twice = turned.mapped(lambda own: [2.0 * x for x in own])
    state = {x: 0.1 * k for k, x in enumerate(leaves)}
    for k in (3, 29):
        old = values(graph, found, k, state)
        assert values(graph, turned, k, state) == {59 - j: x for j, x in reversed(old.items())}
    assert [len(own) for own in twice.rows] == [len(own) for own in found.rows]
    assert twice.rows[5] == {j: 2.0 * x for j, x in turned.rows[5].items()}
