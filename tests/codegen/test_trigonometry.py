"""Our sine and cosine: constants, accuracy, and the same bits everywhere.

LAGC_POINTS asks for more points of each of 16 ranges than are enough to see a mistake, for all levels of all
compilers; 700,000 take minutes.
"""

import importlib.util
import math
import os
import random
import re
import shutil
import subprocess
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any

import mpmath
import pytest

from lagc.codegen.c import runtime
from lagc.codegen.kernel_compiler.library import SINE_COSINE, sine_cosine_kernels
from lagc.codegen.python import functions
from lagc.codegen.python.functions import ARITHMETIC
from lagc.lowering.program import Function, Operation, Store
from tests.codegen.everywhere import LEVELS, clang, compilers, machines, wide
from tests.codegen.tools import STRICT, bits, present
from tests.invariants import verify

ROOT = Path(__file__).parents[2]
POINTS = int(os.environ.get("LAGC_POINTS", "4000"))
CALLS = ("sine_cosine(x)", "sine_cosine_two(x, y)")
# The doubles that come nearest to multiples of pi/2, over all exponents and at some, and those around where
# angles are reduced in another way.
HARD = (
    6381956970095103 * 2.0**797, 6411027962775774.0 * 2.0**-49, 5126562517154117.0 * 2.0**5, math.pi / 2,
    math.pi, 11.0, 22.0, 355.0, 710.0, 103993.0, 312689.0, 1.7976931348623157e308, 2.0**1023, 1e22, 1e5,
    99999.99,
    0.785, math.nextafter(0.785, 1.0), math.pi / 4, 5e-324, 2.2250738585072014e-308, 1e-300, 1e-8, 2.0**24,
    2.0**48,
)  # fmt: skip


def printed_c(calls: Iterable[str]) -> str:
    text = "\n".join(runtime.sine_cosine(sine_cosine_kernels(calls, "double"))).replace("lagc_real", "double")
    guard = "#ifdef __clang__\n#pragma STDC FP_CONTRACT OFF\n#endif"
    return f"#include <math.h>\n#include <stdbool.h>\n{guard}\n{text}\n"


@cache
def kernel() -> str:
    """The printed C, and how its bits are asked for."""
    return printed_c(CALLS) + Path(__file__).with_name("trigonometry.c").read_text()


@cache
def printed_python() -> Any:
    return printed_names()["sine_cosine"]


@cache
def printed_names() -> dict[str, Any]:
    space: dict[str, Any] = {}
    exec("\n\n".join([ARITHMETIC, *functions.sine_cosine(sine_cosine_kernels(CALLS, "python"))]), space)
    return space


def digests(words: list[str], folder: Path, *arguments: object, under: tuple[str, ...] = ()) -> list[str]:
    (folder / "a.c").write_text(kernel())
    last = ["-lquadmath"] if "-DQUAD" in words else []
    done = subprocess.run(
        [*words, "a.c", "-o", "a.out", *last, "-lm"], cwd=folder, capture_output=True, text=True
    )
    assert done.returncode == 0 and not done.stderr, done.stderr[:2000]
    ran = subprocess.run(
        [*under, "./a.out", *map(str, arguments)], cwd=folder, capture_output=True, text=True
    )
    assert ran.returncode == 0, ran.stderr
    return ran.stdout.splitlines()


def error(got: float, value: mpmath.mpf) -> float:
    """In units of the last place of the true value."""
    return float(abs(mpmath.mpf(got) - value) / mpmath.mpf(math.ulp(float(value))))


@pytest.mark.full
def test_the_constants_are_those_of_the_script() -> None:
    spec = importlib.util.spec_from_file_location("constants", ROOT / "tools" / "trigonometry.py")
    assert spec is not None and spec.loader is not None
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    from lagc.kernels.arithmetic import trigonometry

    for name, value in script.constants().items():
        assert getattr(trigonometry, name) == value, name


def test_the_hardest_angles_are_within_one_unit() -> None:
    function = printed_python()
    with mpmath.workdps(400):
        for x in [s * x for x in HARD for s in (1.0, -1.0)]:
            sine, cosine = function(x)
            assert error(sine, mpmath.sin(x)) < 1.0 and error(cosine, mpmath.cos(x)) < 1.0, x


def test_every_multiple_that_parts_of_half_pi_serve_is_within_one_unit() -> None:
    """The double next to each multiple below 1e5: the rest there has the fewest digits."""
    chance, function = random.Random(1), printed_python()
    with mpmath.workdps(60):
        half = mpmath.pi / 2
        quarters = {1, 2, 3, 63661, 63662, *chance.sample(range(1, 63662), min(63661, POINTS // 4))}
        for n in quarters:
            x = float(n * half)
            rest = mpmath.mpf(x) - n * half
            small, large = mpmath.sin(rest), mpmath.cos(rest)
            value = ((small, large), (large, -small), (-small, -large), (-large, small))[n % 4]
            found = function(x)
            assert error(found[0], value[0]) < 1.0 and error(found[1], value[1]) < 1.0, n


def test_signs_of_zero_and_what_is_no_number() -> None:
    function = printed_python()
    assert math.copysign(1.0, function(0.0)[0]) == 1.0 and math.copysign(1.0, function(-0.0)[0]) == -1.0
    assert function(0.0)[1] == function(-0.0)[1] == 1.0
    for x in (math.inf, -math.inf, math.nan):
        assert all(v != v for v in function(x))


def test_two_at_once_have_the_same_bits() -> None:
    """Of every pair of the hardest angles and others, zeros and what is no number too."""
    chance, space, both = random.Random(3), printed_names(), [0.0] * 4
    angles = [*HARD, *(-x for x in HARD), 0.0, -0.0, 1e-3, 9e-4, -9e-4, 1e-200, -1e-200, math.inf, math.nan]
    angles += [chance.uniform(-4.0, 4.0) for _ in range(40)]
    for x in angles:
        for y in angles:
            space["sine_cosine_two"](x, y, both)
            assert bits(both) == bits([*space["sine_cosine"](x), *space["sine_cosine"](y)]), (x, y)


@pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not there")
def test_no_value_is_further_than_one_unit(tmp_path: Path) -> None:
    """Against libquadmath, in 113 bits, in 16 ranges."""
    words = ["gcc", "-std=gnu99", "-O2", "-ffp-contract=off"]
    (tmp_path / "b.c").write_text("#include <quadmath.h>\nint main(void) { return sinq(0) != 0; }\n")
    if subprocess.run(["gcc", "b.c", "-lquadmath"], cwd=tmp_path, capture_output=True).returncode:
        pytest.skip("no libquadmath")
    lines = digests([*words, "-DQUAD"], tmp_path, POINTS)
    assert len(lines) == 16
    for line in lines:
        _, _, sine, cosine = line.split()
        assert float(sine) < 0.85 and float(cosine) < 0.85, line


@pytest.mark.sample(1)
@pytest.mark.skipif(not wide(), reason="no gcc for x87 here")
@pytest.mark.parametrize(
    "words",
    ["", "-O0", "-ffloat-store", "-std=c99 -D_GNU_SOURCE", "-fexcess-precision=fast -O3", "-mfpmath=sse+387"],
)
def test_wider_arithmetic_is_no_further_off_than_rounding_twice(words: str, tmp_path: Path) -> None:
    """64 bits within, 53 where values are kept: half a unit more than in doubles alone; and where a rest is
    kept after what rounding took from it was told, half a unit of it, which may be one of its sine."""
    lines = digests(["gcc", "-std=gnu99", "-O2", "-mfpmath=387", *words.split(), "-DQUAD"], tmp_path, POINTS)
    assert len(lines) == 16
    for line in lines:
        _, _, sine, cosine = line.split()
        assert float(sine) < 2.3 and float(cosine) < 2.3, line


@pytest.mark.full
def test_the_same_bits_under_every_compiler_and_in_python(tmp_path: Path) -> None:
    if not compilers():
        pytest.skip("neither gcc nor clang is here")
    found = {
        "\n".join(digests([*words, *STRICT, *level], tmp_path, POINTS))
        for name, words in compilers().items()
        for level in (LEVELS if POINTS > 4000 or name == "gcc" else LEVELS[-1:])
    }
    if present("g++"):
        cpp = ["g++", "-x", "c++", "-std=c++11", "-O2", "-ffp-contract=off", "-Wall", "-Wextra"]
        found.add("\n".join(digests(cpp, tmp_path, POINTS)))
    assert len(found) == 1
    (words, *_) = compilers().values()
    function = printed_python()
    lines = digests([*words, "-O2", "-ffp-contract=off"], tmp_path, min(POINTS, 4000), "all")
    assert len(lines) == 16 * min(POINTS, 4000)
    for line in lines:
        x, *pair = map(float.fromhex, line.split())
        assert function(x) == tuple(pair), line


@pytest.mark.skipif(not machines(), reason="no other machine is here, or LAGC_MACHINES does not ask for them")
def test_the_same_bits_on_every_machine(tmp_path: Path) -> None:
    here = digests([*(clang() or ()), "-O2", "-ffp-contract=off"], tmp_path, POINTS)
    for name, machine in machines().items():
        words = [*machine.compile_, "-ffp-contract=off"]
        assert digests(words, tmp_path, POINTS, under=machine.under) == here, name


def angles(count: int, calls: int) -> Function:
    """A function of sines and cosines of sums of its `count` inputs, `calls` of them."""
    chance = random.Random(calls)
    operations = [Operation("load", (), ("x", k)) for k in range(count)]
    stores = []
    for k in range(calls):
        a, b = chance.randrange(len(operations)), chance.randrange(count)
        operations.append(Operation("add", (a, b)))
        angle = len(operations) - 1 - chance.randrange(0, 2) * (k % 3 == 0)
        operations += [
            Operation(op, (angle,))
            for op in chance.choice((("sin", "cos"), ("cos",), ("sin",), ("cos", "sin")))
        ]
        operations.append(Operation("mul", (len(operations) - 1, chance.randrange(count))))
        stores.append(Store("y", k, len(operations) - chance.randrange(1, 3)))
    return Function("f", ("x",), (("y", calls),), tuple(operations), tuple(stores))


@pytest.mark.sample(0, 2)
@pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not there")
@pytest.mark.parametrize("calls", [1, 5, 40, 700, 2000])
def test_functions_of_a_model_call_it_once_an_angle(calls: int, tmp_path: Path) -> None:
    """Values and calls, in functions that stand whole and in parts; the same in C and Python."""
    import ctypes

    from lagc.codegen.c.functions import function_text

    f = angles(6, calls)
    verify(f)
    names = {("x", k): f"x{k}" for k in range(6)}
    text = function_text(f, names, {}).replace("lagc_real", "double")
    used = {o.operands for o in f.operations if o.op in ("sin", "cos")}
    single, double = (len(re.findall(rf"lagc_{name}\(", text)) for name in SINE_COSINE)
    assert 0 < single + 2 * double <= len(used)
    code = printed_c([text]) + text
    code += "void f(const double *x, double *y);\nvoid f(const double *x, double *y) { lagc_fn_f(x, y); }\n"
    (tmp_path / "f.c").write_text(code)
    words = ["gcc", "-std=c99", *STRICT, "-O1", "-fPIC", "-shared", "f.c", "-o", "f.so", "-lm"]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[:2000]
    space: dict[str, Any] = {}
    exec(
        "\n\n".join(
            [
                ARITHMETIC,
                *functions.sine_cosine(sine_cosine_kernels(CALLS, "python")),
                functions.function_text(f, names),
            ]
        ),
        space,
    )
    x = [random.Random(2).uniform(-4.0, 4.0) for _ in range(6)]
    ours, y = (ctypes.c_double * calls)(), [0.0] * calls
    ctypes.CDLL(str(tmp_path / "f.so")).f((ctypes.c_double * 6)(*x), ours)
    space["fn_f"](x, y)
    value: list[float] = []
    for o in f.operations:
        a = [value[k] for k in o.operands]
        if o.op == "load":
            value.append(x[o.payload[1]])  # type: ignore[index]
        elif o.op in ("sin", "cos"):
            value.append(printed_python()(a[0])[o.op == "cos"])
        else:
            value.append(a[0] + a[1] if o.op == "add" else a[0] * a[1])
    truth = [value[s.value] for s in f.stores]
    assert list(ours) == y == truth
