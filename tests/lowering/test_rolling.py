"""Loops are found in what is made of like parts, and nothing changes by them."""

import math
import random

import pytest

from lagc.base.records import replace
from lagc.codegen.c.emit import render
from lagc.codegen.loop_segments import segments
from lagc.compiler.stages import Choice, derive, parse, resolve
from lagc.host import model_library
from lagc.lowering.loop_rolling import local, rerolled
from lagc.lowering.lower_equations import optimize
from lagc.lowering.program import LEAVES, Function, Program
from lagc.lowering.scalar.value_numbering import ordered
from tests.codegen.programs import repeated_function
from tests.codegen.test_loops import sorted_leaves
from tests.invariants import verify
from tests.lowering import large
from tests.lowering.interpret import interpret


def program(family: str, n: int) -> Program:
    return optimize(large.equations(large.TREES[family], n))


def length(f: Function) -> int:
    """Operations and stores in the text of a function."""
    return sum([run.period for run in f.runs]) if f.runs else len(f.operations) + len(f.stores)


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize(("family", "n"), [("chain", 60), ("relative", 40), ("spherical", 40), ("balls", 20)])
def test_the_code_of_a_chain_does_not_grow_with_it(family: str, n: int) -> None:
    """But for tables of indices, of which there are few."""
    less, more = (program(family, size).functions["rhs"] for size in (n, 2 * n))
    assert more.runs and more.cost > 1.9 * less.cost
    assert length(more) <= 1.1 * length(less) + 20
    assert length(more) < 0.15 * more.cost


@pytest.mark.full
def test_what_grows_with_a_chain_is_little() -> None:
    """Names, kinds of states, the rows of the table of members: bytes of C a link."""
    less, more = (len("".join(render(program("chain", n)).values())) for n in (150, 300))
    assert more - less < 150 * 400


@pytest.mark.full
def test_the_code_of_trees_grows_slowly() -> None:
    """With their depth."""
    less, more = (length(program("tree", n).functions["rhs"]) for n in (127, 255))
    assert more < 1.6 * less


@pytest.mark.full
@pytest.mark.parametrize("family", sorted({*large.TREES} - {"balls_relative"}))
def test_runs_cover_all_operations(family: str) -> None:
    found = program(family, 31)
    verify(found)
    for f in found.functions.values():
        if f.runs:
            ends = [f.runs[0].first, *(run.end for run in f.runs)]
            assert all([o.op in LEAVES for o in f.operations[: ends[0]]])
            assert [run.first for run in f.runs] == ends[:-1]
            assert ends[-1] == len(f.operations) + len(f.stores)


@pytest.mark.full
def test_what_is_done_to_a_part_is_done_at_once() -> None:
    """Of the 46 operations that a knot of a net takes the values of few are kept from loop to loop."""
    n = 12
    choice = Choice(parameters={"n": n})
    f = optimize(derive(resolve(parse(model_library.read("large/net")), choice))).functions["rhs"]
    assert f.runs
    assert segments(f)[1] < 5 * n * n


@pytest.mark.parametrize("seed", range(15))
def test_the_order_of_long_functions_changes_no_value(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("lagc.lowering.loop_rolling.STRAIGHT", 0)
    monkeypatch.setattr("lagc.lowering.loop_rolling._cost", lambda often, text, indexing=-math.inf: -indexing)
    f = sorted_leaves(repeated_function(seed, "f"))
    rng = random.Random(seed)
    given = {"p": [0.3, 1.0, 9.81], "t": [0.7], "x": [rng.uniform(-1.0, 1.0) for _ in range(60)]}
    wanted = interpret(f, given)
    assert interpret(rerolled(f), given) == wanted
    for order in (ordered, local):
        back = order(f)
        verify(back)
        assert interpret(back, given) == wanted


def test_an_entry_that_is_read_and_changed_keeps_a_function_straight(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its stores would be in another order than its loads."""
    monkeypatch.setattr("lagc.lowering.loop_rolling.STRAIGHT", 0)
    monkeypatch.setattr("lagc.lowering.loop_rolling._cost", lambda often, text, indexing=-math.inf: -indexing)
    f = sorted_leaves(repeated_function(1, "f"))
    for behind, has_runs in ((0, False), (60, True)):  # of 60 entries that are read
        stores = tuple([replace(store, array="x", index=store.index + behind) for store in f.stores])
        assert bool(rerolled(replace(f, outputs=(("x", 124),), stores=stores)).runs) == has_runs
