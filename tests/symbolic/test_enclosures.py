"""Enclosures hold whatever their expressions come to, and are points where nothing moves. Intervals hold what
expressions are, and zeros are where functions are zero."""

import math
from random import Random

import pytest

from lagc.symbolic.enclosures import EVERYWHERE, UNKNOWN, enclosures, intervals
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.walk import evaluate

UNARY = ("sin", "cos", "abs", "tanh", "atan", "cosh", "sinh", "tan", "floor", "sign")


def expression(graph: Graph, leaves: list[Node], chance: Random, depth: int) -> Node:
    if depth == 0:
        return chance.choice([*leaves, graph.const(chance.uniform(-2.0, 2.0))])
    a, b = (expression(graph, leaves, chance, depth - 1) for _ in range(2))
    kind = chance.randrange(13)
    if kind < 3:
        return (a + b, a - b, a * b)[kind]
    if kind < 6:
        return graph.unary(chance.choice(UNARY), a)
    if kind == 6:
        return graph.power(a, chance.choice((2, 3, 4)))
    if kind == 7:
        return graph.div(b, graph.power(a, 2) + 0.5)
    if kind == 8:
        return graph.unary("exp", graph.unary("sin", a))
    if kind == 9:
        return graph.pow(graph.power(a, 2) + 0.5, b)
    if kind == 10:
        return graph.binary("atan2", a, b)
    if kind == 11:  # of any base, as no more than the exponent's value tells that it is whole
        return graph.pow(a, graph.symbol("parameter", "n"))
    return graph.binary(chance.choice(("min", "max")), a, b)


@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", range(4))
def test_random_expressions_keep_to_their_enclosures(seed: int) -> None:
    graph, chance = Graph(), Random(seed)
    leaves = [graph.symbol("coordinate", name) for name in "xyz"]
    n = graph.symbol("parameter", "n")
    ends = [(graph.symbol("least", name), graph.symbol("largest", name)) for name in "xyz"]
    seen = tight = 0
    for _ in range(100):
        node = expression(graph, leaves, chance, 3)
        ((low, high),) = enclosures(graph, [node], dict(zip(leaves, ends)))
        for _ in range(5):
            box = [sorted(chance.uniform(-3.0, 3.0) for _ in range(2)) for _ in leaves]
            if chance.random() < 0.5:
                box = [[a, a + 1e-3] for a, _ in box]
            given = {end: value for pair, two in zip(ends, box) for end, value in zip(pair, two)}
            least, largest = evaluate([low, high], {**given, n: 3.0})
            for _ in range(5):
                inside = {x: chance.uniform(*two) for x, two in zip(leaves, box)}
                value = evaluate([node], {**inside, n: 3.0})[0]
                if abs(value) < UNKNOWN and least <= largest:  # else nothing is known
                    room = 1e-9 * (1.0 + abs(value))
                    assert least - room <= value <= largest + room, (node, box)
                    seen += 1
                    tight += largest - least < 1.0
    assert seen > 2000 and tight > 500


def test_what_is_known_exactly() -> None:
    graph = Graph()
    x, p = graph.symbol("coordinate", "x"), graph.symbol("parameter", "p")
    box = {x: (graph.const(-1.0), graph.const(2.0))}

    def ends(node: Node) -> tuple[float, float]:
        ((low, high),) = enclosures(graph, [node], box)
        found = evaluate([low, high], {p: 3.0})
        return found[0], found[1]

    assert ends(x * x) == (0.0, 4.0)
    assert ends(p * x - 1.0) == (-4.0, 5.0)
    assert ends(graph.cos(x)) == (math.cos(2.0), 1.0)
    assert ends(graph.power(x, 3)) == (-1.0, 8.0)
    assert ends(graph.unary("abs", x)) == (0.0, 2.0)
    assert ends(p * p) == (9.0, 9.0)
    assert ends(graph.pow(x + 2.0, p)) == pytest.approx((1.0, 64.0))
    assert ends(graph.pow(x, p)) == (-UNKNOWN, UNKNOWN)  # -1 for p = 3, no value for 2.5
    assert ends(graph.pow(x, graph.const(2.5))) == pytest.approx((0.0, 2.0**2.5))
    assert ends(graph.pow(x, graph.const(-2.5))) == (-UNKNOWN, UNKNOWN)
    assert ends(graph.div(graph.one, x * x + 1.0)) == (0.2, 1.0)
    assert ends(graph.div(graph.one, x)) == (-UNKNOWN, UNKNOWN)


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
