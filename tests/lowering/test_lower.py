"""Lowering, factoring and multiplying out keep values; they save what they are meant to save. Sums and
products in another order: the same values, shorter chains."""

import math
import random
from collections.abc import Sequence

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lagc.lowering.program import Function
from lagc.lowering.scalar.common_factors import factored, plan
from lagc.lowering.scalar.expand import Lowering, expanded
from lagc.lowering.scalar.scheduling import balanced
from lagc.lowering.scalar.value_numbering import Block
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.walk import evaluate
from tests.invariants import verify
from tests.lowering.interpret import interpret

UNARY = ("sin", "cos", "tan", "atan", "sinh", "cosh", "tanh", "exp", "abs", "floor", "sign")
BINARY = ("atan2", "min", "max")


def random_nodes(seed: int, size: int = 60) -> tuple[Graph, list[Node], list[Node]]:
    """A graph, its symbols, and some expressions over all operations."""
    rng = random.Random(seed)
    graph = Graph()
    x = [graph.symbol("coordinate", f"x{k}") for k in range(4)]
    pool = [*x, graph.const(0.7), graph.const(-2.0)]
    for _ in range(size):
        a, b, c = (rng.choice(pool[-14:] + x) for _ in range(3))
        kind = rng.randrange(9)
        if kind <= 1:
            pool.append(a + b)
        elif kind <= 3:
            pool.append(a * b)
        elif kind == 4:
            pool.append(a - rng.choice((0.5, 2.0)) * b)
        elif kind == 5:
            pool.append(graph.unary(rng.choice(UNARY), graph.unary("atan", a)))
        elif kind == 6:
            pool.append(a / (1.5 + b * b))
        elif kind == 7:
            pool.append(graph.binary(rng.choice(BINARY), a, b))
        else:
            test = graph.binary(rng.choice(("lt", "le")), a, b)
            if rng.random() < 0.5:
                test = graph.logical_not(test)
            pool.append(graph.select(test, b, c))
    return graph, x, pool[-8:]


def lowered(x: list[Node], nodes: list[Node], with_plan: bool = True) -> Function:
    block = Block()
    known = {s: block.load("x", k) for k, s in enumerate(x)}
    for k, value in enumerate(Lowering(block, known, plan(nodes) if with_plan else None)(nodes)):
        block.store("y", k, value)
    return block.function("test", ("x",), (("y", len(nodes)),), "")


def compare(found: Sequence[float], wanted: Sequence[float]) -> None:
    for a, b in zip(found, wanted, strict=True):
        if math.isfinite(b) and abs(b) < 1e100:
            assert a == pytest.approx(b, rel=1e-9, abs=1e-9)


@settings(max_examples=80, deadline=None)
@given(st.integers(0, 10**6))
def test_operations_have_the_values_of_the_nodes(seed: int) -> None:
    graph, x, nodes = random_nodes(seed)
    rng = random.Random(seed + 1)
    values = [rng.uniform(-1.5, 1.5) for _ in x]
    wanted = evaluate(nodes, dict(zip(x, values)))
    if not all(math.isfinite(w) and abs(w) < 1e6 for w in wanted):
        return
    compare(interpret(lowered(x, nodes), {"x": values})["y"], wanted)
    compare(evaluate(factored(graph, nodes), dict(zip(x, values))), wanted)
    compare(evaluate(expanded(graph, nodes), dict(zip(x, values))), wanted)


def test_every_operand_stands_before_its_user_and_none_is_in_vain() -> None:
    _, x, nodes = random_nodes(5)
    function = lowered(x, nodes)
    used = {s.value for s in function.stores}
    for k, o in enumerate(function.operations):
        assert all(j < k for j in o.operands)
        used.update(o.operands)
    assert used == set(range(len(function.operations)))


def test_no_operation_is_made_twice() -> None:
    _, x, nodes = random_nodes(6, 150)
    operations = lowered(x, nodes).operations
    assert len(set(operations)) == len(operations)


def test_a_common_factor_is_taken_out() -> None:
    g = Graph()
    a, b, c, d = (g.symbol("parameter", name) for name in "abcd")
    function = lowered([a, b, c, d], factored(g, [a * b + a * c + a * d]))
    assert function.cost == 3
    assert lowered([a, b], factored(g, [2.0 * a * a + 2.0 * a * b])).cost == 3


def test_products_share_their_parts() -> None:
    g = Graph()
    x = [g.symbol("parameter", name) for name in "abcde"]
    a, b, c, d, e = x
    function = lowered(x, [a * b * c, b * c * d, b * c * e])
    assert function.cost == 4


def test_what_several_products_are_divided_by_divides_once() -> None:
    """The three components of a force along a thread, and others over the same divisor."""
    g = Graph()
    x = [g.symbol("coordinate", name) for name in "abcdef"]
    a, b, c, d, e, f = x
    ops = [o.op for o in lowered(x, [a * d / (e * f), b * d / (e * f), c * d / (e * f)]).operations]
    assert (ops.count("mul"), ops.count("div")) == (4, 1)
    ops = [o.op for o in lowered(x, [1.0 / e, a / e, b / e**2, a * b / e**2]).operations]
    assert (ops.count("mul"), ops.count("div")) == (2, 3)  # e e, a (b / e e)


def test_integer_powers_are_products_and_one_reciprocal_serves_a_quotient() -> None:
    g = Graph()
    a, b = g.symbol("parameter", "a"), g.symbol("parameter", "b")
    ops = [o.op for o in lowered([a, b], [a**8]).operations]
    assert ops.count("mul") == 3
    assert "pow" not in ops
    assert [o.op for o in lowered([a, b], [a / b**2]).operations].count("div") == 1


def test_signs_cost_nothing_until_they_are_stored() -> None:
    g = Graph()
    a, b = g.symbol("parameter", "a"), g.symbol("parameter", "b")
    ops = [o.op for o in lowered([a, b], [a - 2.0 * b, -(a * b), g.sin(-a) * g.sin(-b)]).operations]
    assert ops.count("neg") == 1
    assert ops.count("sub") == 1


def test_turned_sums_cancel_when_multiplied_out() -> None:
    """(s w)(c w) - (c w)(s w) and sin^2 + cos^2 inside products."""
    g = Graph()
    t, u, w = (g.symbol("coordinate", name) for name in "tuw")
    s, c, s2, c2 = g.sin(t), g.cos(t), g.sin(u), g.cos(u)
    node = s * (c * w + c2) - c * (s * w + s2)
    (found,) = expanded(g, [node])
    assert found is s * c2 - c * s2
    (one,) = expanded(g, [(s * w + s2) * s + c * (c * w + c2)])
    assert one is w + (s * s2 + c * c2)


def test_differences_of_lengths_are_not_multiplied_out() -> None:
    g = Graph()
    a, b = g.symbol("coordinate", "a"), g.symbol("coordinate", "b")
    node = (a - b) ** 2 + (a - b) * g.sin(a)
    assert expanded(g, [node]) == [node]


@pytest.mark.parametrize("seed", range(20))
def test_what_numbers_make_is_a_number(seed: int) -> None:
    """To the bit as the machine has it; what has no finite value is left to the program."""
    chance = random.Random(seed)
    block = Block()
    values = [chance.choice((-1, 1)) * 10.0 ** chance.uniform(-200, 200) for _ in range(4)]
    made = [block.const(value) for value in values]
    for _ in range(40):
        j, k, op = chance.randrange(len(made)), chance.randrange(len(made)), chance.randrange(4)
        a, b = values[j], values[k]
        value = (a + b, a - b, a * b, a / b if b else math.nan)[op]
        number = (block.add, block.sub, block.mul, block.div)[op](made[j], made[k])
        if math.isfinite(value):
            made.append(number)
            values.append(value)
    for k, number in enumerate(made):
        block.store("y", k, number)
    function = block.function("test", (), (("y", len(made)),), "")
    assert {o.op for o in function.operations} <= {"const", "neg"}
    assert interpret(function, {})["y"] == values


def random_function(seed: int) -> Function:
    """Sums, differences and products of positive numbers, so that nothing cancels much."""
    rng = random.Random(seed)
    block = Block()
    pool = [block.load("x", k) for k in range(6)] + [block.const(0.5)]
    for _ in range(60):
        a, b = rng.choice(pool), rng.choice(pool[-8:])
        kind = rng.randrange(5)
        if kind < 3:
            pool.append(block.add(a, b))
        elif kind == 3:
            pool.append(block.apply("sqrt", block.mul(a, b)))
        else:
            pool.append(block.div(a, block.add(a, b)))
    for k, value in enumerate(pool[-4:]):
        block.store("w", k, ~value if k % 2 else value)
    return block.function("test", ("x",), (("w", 4),), "")


@pytest.mark.parametrize("seed", range(30))
def test_values_stay_up_to_rounding(seed: int) -> None:
    function = random_function(seed)
    other = balanced(function)
    verify(other)
    assert other.cost <= function.cost
    x = {"x": [0.3 + 0.2 * k for k in range(6)]}
    before, after = interpret(function, x)["w"], interpret(other, x)["w"]
    assert all(math.isclose(a, b, rel_tol=1e-13) for a, b in zip(before, after))


def test_what_is_known_last_is_added_last() -> None:
    block = Block()
    x = [block.load("x", k) for k in range(3)]
    late = block.apply("sin", x[0])
    block.store("w", 0, block.sub(block.sub(block.sub(late, x[1]), x[2]), block.mul(x[1], x[2])))
    function = balanced(block.function("test", ("x",), (("w", 1),), ""))
    (store,) = function.stores
    last = function.operations[store.value]
    assert [function.operations[k].op for k in last.operands] == ["sin", "add"]
    found = interpret(function, {"x": [0.4, 3.0, 5.0]})["w"][0]
    assert found == pytest.approx(math.sin(0.4) - 23.0, rel=1e-15)


def test_the_longest_chain_begins_first() -> None:
    block = Block()
    x = [block.load("x", k) for k in range(4)]
    short = block.mul(x[2], x[3])
    long = block.div(block.one, block.div(x[0], block.add(x[0], x[1])))
    block.store("w", 0, short)
    block.store("w", 1, long)
    function = balanced(block.function("test", ("x",), (("w", 2),), ""))
    ops = [o.op for o in function.operations if o.op in ("add", "mul", "div")]
    assert ops == ["add", "div", "div", "mul"]


def test_a_sum_that_others_use_stays_whole() -> None:
    block = Block()
    x = [block.load("x", k) for k in range(3)]
    shared = block.add(x[0], x[1])
    block.store("w", 0, block.add(shared, x[2]))
    block.store("w", 1, block.mul(shared, shared))
    function = block.function("test", ("x",), (("w", 2),), "")
    assert balanced(function).cost == function.cost == 3
