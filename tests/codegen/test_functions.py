"""Functions printed in C and in Python compute the same bits."""

import ctypes
import math
import random
import shutil
import subprocess
from itertools import product
from pathlib import Path
from typing import Any

import pytest

from lagc.base.records import replace
from lagc.codegen.c import runtime
from lagc.codegen.c.functions import function_text as c_text
from lagc.codegen.c.functions import helpers
from lagc.codegen.identifiers import local_names
from lagc.codegen.kernel_compiler.library import sine_cosine_kernels
from lagc.codegen.kernel_compiler.real_types import DOUBLE
from lagc.codegen.python.functions import ARITHMETIC, function_text, sine_cosine
from lagc.codegen.tables import c_tables, numbered, python_tables
from lagc.lowering.program import Function, Program, operands
from lagc.symbolic.operators import LOOKED_UP
from tests.codegen.programs import TABLES, TRUTHS, Builder, program, random_function
from tests.codegen.tools import bits

FLAGS = [
    "-std=c99", "-O2", "-ffp-contract=off", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow",
    "-Werror",
]  # fmt: skip
needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="no gcc")
HARD = [
    0.0, -0.0, 1.0, -1.0, 0.5, -0.5, 2.0, 1e308, -1e308, 1e-310, math.inf, -math.inf, math.nan, 710.0, -7.5,
]  # fmt: skip


def build(functions: list[Function], folder: Path) -> tuple[dict[str, object], ctypes.CDLL]:
    made = program("Made", functions)
    names = local_names(made, ())
    members = {k: f.name for k, f in enumerate(made.interface.parameters)}
    python: dict[str, Any] = {}
    numbers = numbered(made)
    own = [function_text(f, names, numbers) for f in functions]
    exec(
        "\n".join(
            [ARITHMETIC, *python_tables(numbers), *sine_cosine(sine_cosine_kernels(own, "python")), *own]
        ),
        python,
    )
    body = "".join(
        c_text(f, names, members, DOUBLE, numbers).replace(
            f"static void lagc_fn_{f.name}(", f"void lagc_fn_{f.name}("
        )
        for f in functions
    )
    head = "".join(
        f"void lagc_fn_{f.name}(const lagc_params *p, double t, const double *x, double *y);\n"
        for f in functions
    )
    types = "typedef double lagc_real;\ntypedef struct { double m, l, g; } lagc_params;\n"
    shared = (
        helpers(made.functions.values())
        + "".join(c_tables(numbers, DOUBLE))
        + "".join(runtime.sine_cosine(sine_cosine_kernels([body], "double")))
    )
    source = folder / "made.c"
    source.write_text(DOUBLE.includes + types + shared + head + body)
    subprocess.run(
        ["gcc", *FLAGS, "-shared", "-fPIC", str(source), "-o", str(folder / "made.so"), "-lm"], check=True
    )
    return python, ctypes.CDLL(str(folder / "made.so"))


def both(
    python: dict[str, Any], library: ctypes.CDLL, name: str, p: list[float], t: float, x: list[float], n: int
) -> tuple[list[bytes], list[bytes]]:
    y = [0.0] * n
    python[f"fn_{name}"](p, t, x, y)
    out = (ctypes.c_double * n)()
    array = ctypes.c_double * len(x)
    getattr(library, f"lagc_fn_{name}")((ctypes.c_double * 3)(*p), ctypes.c_double(t), array(*x), out)
    return bits(y), bits(list(out))


@pytest.mark.full
@needs_gcc
def test_random_functions_agree_bitwise(tmp_path: Path) -> None:
    functions = [random_function(seed, name=f"f{seed}") for seed in range(30)]
    python, library = build(functions, tmp_path)
    rng = random.Random(1)
    for f in functions:
        for trial in range(40):
            values = [rng.gauss(0, 1) if trial < 20 else rng.choice(HARD) for _ in range(6)]
            ours, theirs = both(python, library, f.name, [values[0], 1.0, 9.81], values[1], values[2:], 8)
            assert ours == theirs, (f.name, values)


@pytest.mark.full
@needs_gcc
@pytest.mark.parametrize("length", [1, 7, 40])
def test_long_functions_in_parts_are_the_same(
    length: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("lagc.codegen.c.functions.LONGEST", 0)
    monkeypatch.setattr("lagc.codegen.loop_segments._LARGEST", length)
    functions = [random_function(seed, name=f"f{seed}") for seed in range(12)]
    # A comment is no use of what it names.
    about = dict.fromkeys(range(0, 400, 3), "what p, t and x have to do with it")
    functions = [replace(f, comments=about) for f in functions]
    python, library = build(functions, tmp_path)
    rng = random.Random(2)
    for f in functions:
        for _ in range(10):
            values = [rng.gauss(0, 1) for _ in range(6)]
            ours, theirs = both(python, library, f.name, [values[0], 1.0, 9.81], values[1], values[2:], 8)
            assert ours == theirs, (f.name, values)


@pytest.mark.full
@needs_gcc
def test_every_operation_agrees_on_special_values(tmp_path: Path) -> None:
    functions = []
    for op, count in operands().items():
        if count == 0 or op in ("and", "or", "not", "select"):
            continue
        build_ = Builder(f"op_{op}", ("p", "t", "x"), (("y", 1),))
        given = [build_.load("x", k) for k in range(count)]
        if op in LOOKED_UP:
            knots, row = TABLES[0]
            value = build_.look_up("piece", knots, *given)
            value = value if op == "piece" else build_.look_up("entry", row, value)
        else:
            value = build_.op(op, *given)
        if op in TRUTHS:
            value = build_.op("select", value, build_.const(2.0), build_.const(-0.0))
        build_.store("y", 0, value)
        functions.append(build_.function())
    python, library = build(functions, tmp_path)
    for f in functions:
        for a in HARD:
            for b in HARD:
                ours, theirs = both(python, library, f.name, [1.0, 1.0, 1.0], 0.0, [a, b], 1)
                assert ours == theirs, (f.name, a, b)


@needs_gcc
def test_functions_at_guesses_divide_as_c_does(tmp_path: Path) -> None:
    """Also where something else raises, and all is computed again."""
    made = Builder("conditions", ("p", "t", "x"), (("y", 2),))
    a, b = made.load("x", 0), made.load("x", 1)
    made.store("y", 0, made.op("div", a, b))
    made.store("y", 1, made.op("div", made.op("sqrt", a), made.op("sub", a, b)))
    python, library = build([made.function()], tmp_path)
    for x in product(HARD, HARD):
        ours, theirs = both(python, library, "conditions", [1.0, 1.0, 1.0], 0.0, list(x), 2)
        assert ours == theirs, x


def test_an_array_read_and_written_is_read_before_it_is_written() -> None:
    """Even where Python raises on the way and the function runs again."""
    swap = Builder("factor", ("w",), (("w", 3),))
    a, b, c = (swap.load("w", k) for k in range(3))
    swap.store("w", 0, swap.op("div", b, c))
    swap.store("w", 1, a)
    swap.store("w", 2, swap.op("div", a, swap.op("sub", c, c)))
    made = Program(program("Made", []).interface, {"factor": swap.function()})
    python: dict[str, Any] = {}
    exec(ARITHMETIC + function_text(made.functions["factor"], local_names(made, ())), python)
    w = [3.0, 4.0, 2.0]
    python["fn_factor"](w)
    assert w == [2.0, 3.0, math.inf]
