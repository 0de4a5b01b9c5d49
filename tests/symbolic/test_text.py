"""The text of an expression says what the expression is."""

import math
import random
import re

import pytest
from hypothesis import assume, given, settings

from lagc.symbolic.expression_text import brief, text
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.operators import VALUES
from lagc.symbolic.walk import evaluate
from tests.symbolic.expressions import NAMES, grow, points, programs


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
