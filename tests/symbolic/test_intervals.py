"""Intervals hold what expressions are, and zeros are where functions are zero."""

import math
from random import Random

import pytest

from lagc.symbolic.enclosures import EVERYWHERE, intervals
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.walk import evaluate

ONE = (
    "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "sqrt", "abs", "floor",
    "sign",
)  # fmt: skip
TWO = ("atan2", "pow", "min", "max", "lt", "le", "eq")


def grown(graph: Graph, leaves: list[Node], chance: Random) -> list[Node]:
    nodes = [*leaves, graph.const(chance.uniform(-3.0, 3.0))]
    for _ in range(12):
        x, y = chance.choice(nodes), chance.choice(nodes)
        way = chance.randrange(6)
        if way == 0:
            nodes.append(x + y)
        elif way == 1:
            nodes.append(graph.scale(chance.uniform(-2.0, 2.0), x))
        elif way == 2:
            nodes.append(
                graph.product([(x, chance.choice((-2, -1, 1, 2, 3))), (y, 1)]) if not x.is_const else x
            )
        elif way == 3:
            nodes.append(graph.unary(chance.choice(ONE), x))
        elif way == 4:
            nodes.append(graph.binary(chance.choice(TWO), x, y))
        else:
            nodes.append(graph.select(graph.binary("lt", x, y), x, y))
    return nodes


@pytest.mark.parametrize("seed", range(40))
def test_no_value_is_outside_its_interval(seed: int) -> None:
    chance, graph = Random(seed), Graph()
    leaves = [graph.symbol("parameter", name) for name in "abc"]
    given = {leaves[0]: (0.0, math.inf), leaves[1]: (-1.5, 0.5)}
    nodes = grown(graph, leaves, chance)
    found = intervals(nodes, given)
    for _ in range(60):
        c = chance.gauss(0.0, 3.0)
        state = dict(zip(leaves, (abs(chance.gauss(0.0, 2.0)), chance.uniform(-1.5, 0.5), c)))
        for node, value in zip(nodes, evaluate(nodes, state)):
            low, high = found[node]
            slack = 1e-9 * (1.0 + abs(value))
            assert not (value < low - slack or value > high + slack), (node, value, low, high)


def test_intervals_tell_something() -> None:
    graph = Graph()
    x = graph.symbol("coordinate", "x")
    wave = graph.sin(x)
    for node, truth in (
        (2.0 + wave, (1.0, 3.0)),
        (wave * wave, (0.0, 1.0)),
        (1.0 / (2.0 + wave), (1.0 / 3.0, 1.0)),
        (graph.unary("exp", wave), (math.exp(-1.0), math.e)),
        (graph.sqrt(x * x + 4.0), (2.0, math.inf)),
        (graph.binary("max", wave, graph.const(0.5)), (0.5, 1.0)),
        (x, EVERYWHERE),
    ):
        assert intervals([node], {})[node] == pytest.approx(truth)
