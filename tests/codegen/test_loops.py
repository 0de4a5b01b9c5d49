"""Functions with loops compute their operations, in C and in Python, to the last bit."""

import math
import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lagc
from lagc.base.records import replace
from lagc.codegen.python.functions import ARITHMETIC, function_text
from lagc.lowering.loop_rolling import local, rerolled
from lagc.lowering.program import LEAVES, Function, uses
from tests.codegen.programs import Builder, repeated_function
from tests.codegen.test_functions import both, build, needs_gcc
from tests.codegen.tools import bits
from tests.lowering.interpret import interpret


def sorted_leaves(f: Function) -> Function:
    """What is used, leaves first, as long functions have it."""
    needed = [k for k, count in enumerate(uses(f)) if count]
    order = sorted(needed, key=lambda k: f.operations[k].op not in LEAVES)
    number = {old: new for new, old in enumerate(order)}
    operations = [f.operations[k] for k in order]
    moved = [replace(o, operands=tuple(number[k] for k in o.operands)) for o in operations]
    stores = [replace(s, value=number[s.value]) for s in f.stores]
    return replace(f, operations=tuple(moved), stores=tuple(stores))


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    """Short functions are rolled, too, and ones with little repetition."""
    monkeypatch.setattr("lagc.lowering.loop_rolling.STRAIGHT", 0)
    monkeypatch.setattr("lagc.lowering.loop_rolling._cost", lambda often, text, indexing=-math.inf: -indexing)
    monkeypatch.setattr("lagc.lowering.loop_rolling._GRAM", 4)
    monkeypatch.setattr("lagc.lowering.loop_rolling._WORTH", 6)
    monkeypatch.setattr("lagc.codegen.python.functions._STRAIGHT", 0)


@pytest.mark.full
@needs_gcc
@pytest.mark.parametrize("longest", [600, 20])
@pytest.mark.usefixtures("short")
def test_random_repetitions(longest: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("lagc.codegen.c.functions.LONGEST", longest)
    made = [sorted_leaves(repeated_function(seed, f"f{seed}")) for seed in range(16)]
    functions = [rerolled(local(f) if k % 2 else f) for k, f in enumerate(made)]
    assert all([f.runs and any([run.count > 1 for run in f.runs]) for f in functions])
    python, library = build(functions, tmp_path)
    rng = random.Random(3)
    for f in functions:
        for _ in range(5):
            p, t, *x = [rng.uniform(-1.0, 1.0) for _ in range(62)]
            ours, theirs = both(python, library, f.name, [p, 1.0, 9.81], t, x, 64)
            wanted = interpret(f, {"p": [p, 1.0, 9.81], "t": [t], "x": x})["y"]
            assert ours == theirs == bits(wanted), f.name


@pytest.mark.usefixtures("short")
def test_an_array_read_and_written_is_read_before_it_is_written() -> None:
    """By what stands between loops, too."""
    made = Builder("f", ("x",), (("x", 60), ("y", 58)))
    x = [made.load("x", k) for k in range(60)]
    products = [made.op("mul", x[k], x[59 - k]) for k in range(2, 60)]
    moved = [made.op("sub", x[1], x[2]), made.op("add", x[0], x[3])]
    for k, value in enumerate(moved):
        made.store("x", k, value)
    for k, value in enumerate(products):
        made.store("y", k, value)
    f = rerolled(made.function())
    assert [run.count > 1 for run in f.runs] == [True, False, True]
    python: dict[str, Any] = {}
    exec(ARITHMETIC + function_text(f, {}), python)
    rng = random.Random(1)
    before = [rng.uniform(-1.0, 1.0) for _ in range(60)]
    after, other = list(before), [0.0] * 58
    python["fn_f"](after, other)
    assert {"x": after, "y": other} == interpret(f, {"x": before})


@needs_gcc
@pytest.mark.usefixtures("short")
def test_what_stands_before_a_loop_ends_where_it_begins(tmp_path: Path) -> None:
    """Also where a sine is the last of one, and a cosine the first of the other."""
    made = Builder("before", ("p", "t", "x"), (("y", 62),))
    x = [made.load("x", k) for k in range(60)]
    first = made.op("sin", made.op("mul", x[0], x[1]))
    values = [first, *(made.op("cos", entry) for entry in x), made.op("add", first, x[0])]
    for k, value in enumerate(values):
        made.store("y", k, value)
    f = rerolled(made.function())
    loop = next(run.first for run in f.runs if run.count > 1)
    assert [f.operations[loop - 1].op, f.operations[loop].op] == ["sin", "cos"]
    python, library = build([f], tmp_path)
    given = [0.1 * k for k in range(60)]
    ours, theirs = both(python, library, "before", [0.0, 1.0, 9.81], 0.0, given, 62)
    assert ours == theirs
    values = np.frombuffer(b"".join(ours))
    assert np.abs(values - interpret(f, {"x": given})["y"]).max() <= 1e-15  # of sines and cosines


@pytest.mark.full
@needs_gcc
@pytest.mark.parametrize(("name", "n"), [("classic/chain", 250), ("large/rope", 30), ("large/net", 8)])
def test_large_models_agree_in_c_and_in_python(name: str, n: int) -> None:
    one, other = (lagc.load(name).compile(parameters={"n": n}, backend=backend) for backend in ("c", "numpy"))
    assert one.program.functions["rhs"].runs
    rng = random.Random(5)
    for _ in range(3):
        x = [rng.uniform(-1.0, 1.0) for _ in range(one.interface.nx)]
        assert bits(one.rhs(0.0, x)) == bits(other.rhs(0.0, x))


@needs_gcc
@pytest.mark.usefixtures("short")
def test_loops_over_numbers_divide_by_zero_as_c_does(tmp_path: Path) -> None:
    made = Builder("over", ("p", "t", "x"), (("y", 64),))
    x = [made.load("x", k) for k in range(64)]
    numbers = [made.const(float(k % 17 - 8)) for k in range(64)]
    values = [made.op("div", number, made.op("sub", entry, entry)) for entry, number in zip(x, numbers)]
    for k, value in enumerate(values):
        made.store("y", k, value)
    f = rerolled(made.function())
    assert [run for run in f.runs if run.count > 1]
    python, library = build([f], tmp_path)
    ours, theirs = both(python, library, "over", [0.0, 1.0, 9.81], 0.0, [0.5] * 64, 64)
    assert (
        ours
        == theirs
        == bits([math.copysign(math.inf, k % 17 - 8) if k % 17 != 8 else math.nan for k in range(64)])
    )
