"""The graph's constructors keep their normal form and never change a value."""

import math
import random

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from lagc.symbolic.derivative import gradient, tangent
from lagc.symbolic.expression_text import text
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.walk import depends, evaluate, reachable, substitute, symbols
from tests.symbolic.expressions import NAMES, grow, points, programs


@pytest.fixture
def graph() -> Graph:
    return Graph()


def leaves(graph: Graph) -> list[Node]:
    return [graph.symbol("coordinate", name) for name in NAMES]


def values(graph: Graph, at: tuple[float, ...]) -> dict[Node, float]:
    return dict(zip(leaves(graph), at))


@pytest.mark.full
@settings(max_examples=300, deadline=None)
@given(programs, points)
def test_constructors_keep_the_value(program: list[tuple[str, int, int]], at: tuple[float, ...]) -> None:
    graph = Graph()
    pair = grow(graph, program)
    expected = pair.value(at)
    size = max(abs(v) for v in evaluate(graph.nodes, values(graph, at)) if math.isfinite(v))
    assume(size < 1e6)
    found = evaluate([pair.node], values(graph, at))[0]
    # sums in another order: some roundings of the largest term met on the way
    assert abs(found - expected) <= 1e-12 * max(1.0, size)


@settings(max_examples=100, deadline=None)
@given(programs)
def test_every_node_is_in_normal_form(program: list[tuple[str, int, int]]) -> None:
    graph = Graph()
    grow(graph, program)
    for node in graph.nodes:
        assert all(a.index < node.index for a in node.args)
        if node.op == "scale":
            assert node.args[0].op not in ("scale", "const")
            assert node.value not in (0.0, 1.0)
        if node.op == "mul":
            exponents: tuple[int, ...] = node.value
            assert all(e != 0 for e in exponents)
            assert [a.index for a in node.args] == sorted({a.index for a in node.args})
            assert all(a.op not in ("mul", "scale", "const") for a in node.args)
            assert exponents != (1,)
        if node.op == "add":
            assert not any(a.is_zero for a in node.args)


@settings(max_examples=100, deadline=None)
@given(programs)
def test_same_building_gives_the_same_node(program: list[tuple[str, int, int]]) -> None:
    graph = Graph()
    first = grow(graph, program).node
    count = len(graph.nodes)
    assert grow(graph, program).node is first
    assert len(graph.nodes) == count


@settings(max_examples=50, deadline=None)
@given(programs)
def test_order_of_building_alone_decides(program: list[tuple[str, int, int]]) -> None:
    first, second = Graph(), Graph()
    assert text(grow(first, program).node) == text(grow(second, program).node)
    assert [n.op for n in first.nodes] == [n.op for n in second.nodes]


def test_like_terms_and_factors(graph: Graph) -> None:
    x, y, _ = leaves(graph)
    assert x - x is graph.zero
    assert x + x is 2.0 * x
    assert 2.0 * x + y - 2.0 * x is y
    assert x * y / x is y
    assert x * x is x**2
    assert x / x is graph.one
    assert (2.0 * x) ** 3 is 8.0 * x**3
    assert graph.sqrt(x) * graph.sqrt(x) is x
    assert graph.sqrt(x) ** 3 is x * graph.sqrt(x)


def test_pythagoras(graph: Graph) -> None:
    x, y, _ = leaves(graph)
    s, c = graph.sin(x), graph.cos(x)
    assert s * s + c * c is graph.one
    assert 3.0 * y * s * s + 3.0 * y * c * c is 3.0 * y
    assert s * s - c * c is not graph.one


def test_signs_leave_odd_and_even_functions(graph: Graph) -> None:
    x = leaves(graph)[0]
    assert graph.sin(-x) is -graph.sin(x)
    assert graph.cos(-2.0 * x) is graph.cos(2.0 * x)


def test_constants_fold(graph: Graph) -> None:
    two = graph.const(2.0)
    assert graph.pow(two, graph.const(-1.0)).value == 0.5
    assert graph.sqrt(two).value == math.sqrt(2.0)
    assert graph.binary("atan2", graph.one, two).value == math.atan2(1.0, 2.0)
    assert graph.binary("lt", graph.one, two).value == 1.0
    assert graph.select(graph.one, two, graph.one) is two
    assert graph.logical_not(graph.zero) is graph.one


def test_what_has_no_value_does_not_fold(graph: Graph) -> None:
    root = graph.sqrt(graph.const(-1.0))
    assert root.op == "sqrt"
    assert math.isnan(evaluate([root], {})[0])


@pytest.mark.parametrize("turns", [*range(-9, 10), 359, -1000])
def test_quarters_of_a_turn_are_such(graph: Graph, turns: int) -> None:
    """As numbers of radians and of degrees; a little beside them, nothing is changed."""
    for angle in (turns * 0.5 * math.pi, math.radians(90.0 * turns), 90.0 * turns * (math.pi / 180.0)):
        for name, value in (("sin", math.sin(angle)), ("cos", math.cos(angle))):
            found = graph.unary(name, graph.const(angle))
            assert found.value == (0.0 if abs(value) < 0.5 else value)
        beside = angle + 1e-9
        assert graph.sin(graph.const(beside)).value == math.sin(beside)
        assert graph.cos(graph.const(beside)).value == math.cos(beside)


def test_minus_zero_is_zero(graph: Graph) -> None:
    assert graph.const(-0.0) is graph.zero


def test_division_by_zero_is_told(graph: Graph) -> None:
    with pytest.raises(ZeroDivisionError):
        graph.div(graph.one, graph.zero)


@given(st.floats(allow_nan=False, allow_infinity=False), st.floats(allow_nan=False, allow_infinity=False))
def test_sums_of_numbers_are_those_of_floats(a: float, b: float) -> None:
    graph = Graph()
    found = (graph.const(a) + b).value
    rounding = abs(a + b) <= 4.0 * math.ulp(a) and found == 0.0  # 0.1 + 0.2 - 0.3
    assert found == a + b or rounding or math.isinf(a + b)


@pytest.mark.full
def test_deep_graphs_need_no_recursion(graph: Graph) -> None:
    x, y, _ = leaves(graph)
    node = x
    for _ in range(10_000):
        node = graph.sin(node) + y
    nodes = reachable([node])
    assert len(nodes) == 20_002
    assert [n.index for n in nodes] == sorted(n.index for n in nodes)
    assert symbols([node]) == {x, y}
    assert len(depends([node], [x])) == 20_001
    other = substitute(graph, [node], {x: y})[0]
    at = {x: 0.3, y: 0.3}
    assert evaluate([other], at) == evaluate([node], at)
    along = tangent(graph, [node], {y: graph.one})[0]
    assert len(reachable([along])) > 20_000
    sums = x
    for k in range(5_000):
        sums = 0.5 * sums + graph.sin(y * float(k))
    across = gradient(graph, {sums: graph.one}, [y])[y]
    forward = tangent(graph, [sums], {y: graph.one})[0]
    assert evaluate([forward], at)[0] == pytest.approx(evaluate([across], at)[0], rel=1e-9)


NUMBERS = (0.0, 1.0, -1.0, 2.0, -0.5, 1e200, 1e-200, 5e-324, 3e307)


def combined(graph: Graph, chance: random.Random, x: Node, y: Node) -> Node:
    function = chance.choice(("log", "sqrt", "exp", "asin", "tan", "floor"))
    return chance.choice([
        lambda: x + y, lambda: x * y, lambda: graph.div(x, y), lambda: graph.pow(x, y),
        lambda: graph.power(x, chance.choice((-3, -2, -1, 2, 3))), lambda: -0.5 * x,
        lambda: graph.unary(function, x), lambda: graph.binary(chance.choice(("atan2", "min")), x, y),
        lambda: graph.select(graph.binary("lt", x, y), y, x),
    ])()  # fmt: skip


def test_any_number_may_take_the_place_of_any_symbol() -> None:
    """What has no finite value for it stays as it is written: 0^-1, log(0), 1e200^2."""
    chance = random.Random(6)
    finite = 0
    for _ in range(2000):
        graph = Graph()
        symbols = leaves(graph)
        nodes: list[Node] = list(symbols)
        for _ in range(chance.randrange(2, 9)):
            x, y = chance.choice(nodes), chance.choice(nodes)
            nodes.append(combined(graph, chance, x, y))
        at = {s: chance.choice(NUMBERS) for s in symbols}
        some = {s: graph.const(v) for s, v in at.items() if chance.random() < 0.7}
        (found,) = substitute(graph, [nodes[-1]], some)
        (new,), every = evaluate([found], at), evaluate(nodes, at)
        tame = all(math.isfinite(v) and (v == 0.0 or 1e-290 < abs(v) < 1e290) for v in every)
        smooth = {n.op for n in reachable([nodes[-1]])} <= {"symbol", "const", "add", "scale", "mul"}
        if tame and smooth and max(map(abs, every)) < 1e3:  # else what cancels is rounding
            assert new == pytest.approx(every[-1], rel=1e-9, abs=1e-9)
            finite += 1
    assert finite > 100
