"""Derivatives against differences with an imaginary step, which lose no digits."""

import math
from collections.abc import Iterator

import pytest
from hypothesis import assume, given, settings

from lagc.symbolic.derivative import gradient, tangent
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.walk import evaluate
from tests.symbolic.expressions import NAMES, grow, points, programs

STEP = 1e-30  # f(x + ih) = f(x) + ih f'(x) + O(h^2): Squire & Trapp, SIAM Review 40, 1998


@pytest.mark.full
@settings(max_examples=300, deadline=None)
@given(programs, points)
def test_forward_and_reverse_agree_with_complex_steps(
    program: list[tuple[str, int, int]], at: tuple[float, ...]
) -> None:
    graph = Graph()
    pair = grow(graph, program)
    symbols = [graph.symbol("coordinate", name) for name in NAMES]
    state = dict(zip(symbols, at))
    slopes = gradient(graph, {pair.node: graph.one}, symbols)
    size = max(abs(x) for x in evaluate(graph.nodes, state) if math.isfinite(x))
    assume(size < 1e6)
    for k, symbol in enumerate(symbols):
        moved = [x + (1j * STEP if i == k else 0.0) for i, x in enumerate(at)]
        expected = pair.value(moved).imag / STEP
        along = tangent(graph, [pair.node], {symbol: graph.one})[0]
        found = evaluate([along, slopes.get(symbol, graph.zero)], state)
        # rounding of the terms of the derivative, of the size of the nodes that make it
        assert found == pytest.approx([expected, expected], rel=1e-9, abs=1e-10 * max(1.0, size))


@settings(max_examples=50, deadline=None)
@given(programs, points)
def test_second_derivatives_commute(program: list[tuple[str, int, int]], at: tuple[float, ...]) -> None:
    graph = Graph()
    node = grow(graph, program).node
    x, y = (graph.symbol("coordinate", name) for name in "xy")
    state = dict(zip([x, y, graph.symbol("coordinate", "z")], at))
    seeds = [{x: graph.one}, {y: graph.one}]
    first = tangent(graph, tangent(graph, [node], seeds[0]), seeds[1])
    second = tangent(graph, tangent(graph, [node], seeds[1]), seeds[0])
    size = max(abs(v) for v in evaluate(graph.nodes, state) if math.isfinite(v))
    assume(size < 1e6)
    expected = pytest.approx(evaluate(second, state), rel=1e-8, abs=1e-9 * max(1.0, size))
    assert evaluate(first, state) == expected


def at(node: Node, **values: float) -> float:
    table = {node.graph.symbol("coordinate", k): v for k, v in values.items()}
    return evaluate([node], table)[0]


@pytest.mark.parametrize(
    "op, x, expected",
    [
        ("tan", 0.4, 1.0 / math.cos(0.4) ** 2), ("asin", 0.4, 1.0 / math.sqrt(1.0 - 0.16)),
        ("acos", 0.4, -1.0 / math.sqrt(1.0 - 0.16)), ("abs", -0.4, -1.0), ("sign", 0.4, 0.0),
        ("floor", 0.4, 0.0), ("log", 0.4, 2.5), ("exp", 0.4, math.exp(0.4)),
    ],
)  # fmt: skip
def test_functions_of_one_argument(op: str, x: float, expected: float) -> None:
    graph = Graph()
    symbol = graph.symbol("coordinate", "x")
    slope = tangent(graph, [graph.unary(op, symbol)], {symbol: graph.one})[0]
    assert at(slope, x=x) == pytest.approx(expected, rel=1e-14)


def test_functions_of_two_arguments() -> None:
    graph = Graph()
    x, y = graph.symbol("coordinate", "x"), graph.symbol("coordinate", "y")
    point = {"x": 1.3, "y": 0.7}
    table = {
        "atan2": (0.7 / (1.3**2 + 0.7**2), -1.3 / (1.3**2 + 0.7**2)),
        "pow": (0.7 * 1.3**-0.3, math.log(1.3) * 1.3**0.7),
        "max": (1.0, 0.0),
        "min": (0.0, 1.0),
        "lt": (0.0, 0.0),
    }
    for op, expected in table.items():
        slopes = gradient(graph, {graph.binary(op, x, y): graph.one}, [x, y])
        found = [at(slopes.get(s, graph.zero), **point) for s in (x, y)]
        assert found == pytest.approx(expected, rel=1e-13), op


def test_branches_are_differentiated_one_by_one() -> None:
    graph = Graph()
    x = graph.symbol("coordinate", "x")
    node = graph.select(graph.binary("lt", x, graph.zero), x * x, 3.0 * x)
    slope = tangent(graph, [node], {x: graph.one})[0]
    assert [at(slope, x=v) for v in (-2.0, 2.0)] == [-4.0, 3.0]


@pytest.mark.parametrize("x", [-0.3, 0.3])
def test_a_branch_that_is_not_taken_need_have_no_slope(x: float) -> None:
    """3/2 k (-u)^(5/2) of a spring that pushes where it is pressed, and 1/sqrt(-u)."""
    graph = Graph()
    u, k = graph.symbol("coordinate", "u"), graph.symbol("parameter", "k")
    pressed = graph.binary("lt", u, graph.zero)
    energy = graph.select(
        pressed, 1.5 * k * graph.pow(-u, graph.const(2.5)) + graph.sqrt(-u) / -u, graph.zero
    )
    force = gradient(graph, {2.0 * energy: k}, [u])[u]
    slope = tangent(graph, [force], {u: graph.one})[0]
    h = max(-x, 0.0)
    wanted = [
        6.0 * (-3.75 * 3.0 * h**1.5 + 0.5 * h**-1.5) if h else 0.0,
        6.0 * (5.625 * 3.0 * h**0.5 + 0.75 * h**-2.5) if h else 0.0,
    ]
    assert evaluate([force, slope], {u: x, k: 3.0}) == pytest.approx(wanted, rel=1e-14)


@pytest.mark.parametrize("x", [-1.5, -0.5, 0.5, 1.5])
def test_nothing_of_a_branch_that_is_not_taken_is_asked(x: float) -> None:
    """Nested choices, products, and what a branch shares with others, with numbers for both sides."""
    graph = Graph()
    u, y = graph.symbol("coordinate", "u"), graph.symbol("coordinate", "y")
    zero, power = graph.zero, graph.const(2.5)
    up, down = graph.binary("lt", graph.one, u), graph.binary("lt", u, -graph.one)
    above, below = graph.pow(u - 1.0, power), graph.pow(-u - 1.0, power)
    stops = graph.select(up, above, graph.select(down, below, zero))
    product = graph.select(up, y * y * above / (2.0 + y), zero)
    logarithm = graph.select(down, y * (-u - 1.0) * graph.unary("log", -u - 1.0), zero)
    shared = graph.select(up, above, zero) + graph.select(up, 2.0 * above, y)
    slopes = gradient(graph, {stops: y, product: graph.one, logarithm: graph.one, shared: y}, [u, y])
    h, at_y = abs(x) - 1.0, 0.7
    rate = 2.5 * max(h, 0.0) ** 1.5
    by_u, by_y = (at_y * math.copysign(rate, x), 0.0) if h > 0.0 else (0.0, at_y)
    if x > 1.0:
        by_u += at_y**2 / 2.7 * rate + 3.0 * at_y * rate
        by_y += (2.0 * at_y / 2.7 - at_y**2 / 2.7**2) * h**2.5
    elif x < -1.0:
        by_u -= at_y * (math.log(h) + 1.0)
        by_y += h * math.log(h) + at_y
    found = evaluate([slopes[u], slopes[y]], {u: x, y: at_y})
    assert found == pytest.approx([by_u, by_y], rel=1e-14, abs=1e-15)


def test_weights_of_several_outputs_add_up() -> None:
    graph = Graph()
    x, y = graph.symbol("coordinate", "x"), graph.symbol("coordinate", "y")
    found = gradient(graph, {x * y: y, x + y: graph.const(2.0), x: graph.one}, [x, y])
    assert at(found[x], x=3.0, y=5.0) == 5.0 * 5.0 + 2.0 + 1.0
    assert at(found[y], x=3.0, y=5.0) == 3.0 * 5.0 + 2.0


def test_what_does_not_depend_is_left_out() -> None:
    graph = Graph()
    x, y = graph.symbol("coordinate", "x"), graph.symbol("coordinate", "y")
    assert gradient(graph, {x: graph.one}, [x, y]) == {x: graph.one}
    assert tangent(graph, [x * y], {}) == [graph.zero]


class _Places(dict[Node, int]):
    """Of leaves, through which nobody walks."""

    def __iter__(self) -> Iterator[Node]:
        raise AssertionError("all leaves are looked through")

    keys = values = items = __iter__  # type: ignore[assignment]


def test_of_many_leaves_those_are_looked_at_that_the_outputs_are_made_of() -> None:
    """In the order of their places, which is not that of the symbols."""
    graph = Graph()
    leaves = [graph.symbol("coordinate", f"x{k}") for k in range(6)]
    a, b, c = leaves[4], leaves[1], leaves[3]
    seeds = {a * b + graph.unary("sin", c) + 2.0 * a: graph.one}
    places = _Places({leaf: k for k, leaf in enumerate(reversed(leaves))})
    found = gradient(graph, seeds, places)
    assert list(found) == [a, c, b]
    assert found == gradient(graph, seeds, leaves)
