"""Sums and products in another order: the same values, shorter chains."""

import math
import random

import pytest

from lagc.lowering.program import Function
from lagc.lowering.scalar.scheduling import balanced
from lagc.lowering.scalar.value_numbering import Block
from tests.invariants import verify
from tests.lowering.interpret import interpret


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
