"""Compiler options that change the arithmetic are refused, or do not change the results."""

import re
import shutil
import subprocess
from functools import cache
from pathlib import Path

import mpmath
import pytest

from lagc.codegen.c.emit import render
from lagc.codegen.kernel_compiler.real_types import QUAD, TYPES
from tests.codegen.everywhere import clang, wide
from tests.codegen.tools import call, of_model, write

pytestmark = pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not there")
REORDERED = [
    "-ffast-math", "-Ofast", "-funsafe-math-optimizations", "-ffinite-math-only", "-freciprocal-math",
]  # fmt: skip
WIDER = ["-mfpmath=387", "-mfpmath=387 -std=c99", "-mfpmath=sse+387"]
KNOWN = "-DSIMPLE_PENDULUM_ANY_ARITHMETIC"
FUSED = re.compile(r"\bvfn?m(?:add|sub)\w+")
PROBE = (
    "double f(double a, double b, double c);\ndouble f(double a, double b, double c) { return a * b + c; }\n"
)


def said(folder: Path, *words: str) -> str:
    """What gcc has to say of the pendulum, compiled with `words`."""
    command = ["gcc", *words, "-fsyntax-only", "simple_pendulum.c"]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True).stderr


@pytest.mark.full
@pytest.mark.parametrize("real", TYPES)
def test_arithmetic_that_is_not_of_the_type_is_refused(real: str, tmp_path: Path) -> None:
    write(render(of_model("course/simple_pendulum"), real=TYPES[real]), tmp_path)
    assert said(tmp_path) == ""
    for words in REORDERED:
        assert "compile without them" in said(tmp_path, *words.split()), words
        assert said(tmp_path, *words.split(), KNOWN) == ""
    for words in WIDER if wide() else ():
        assert ("wider than its type" in said(tmp_path, *words.split())) == (TYPES[real] != QUAD), words
        assert said(tmp_path, *words.split(), KNOWN) == ""


MAIN = """
#include "simple_pendulum.h"
#include <stdio.h>
int main(void)
{
    static simple_pendulum_work w;
    static simple_pendulum_state s;
    simple_pendulum_params p = simple_pendulum_default_params();
    simple_pendulum_options o = simple_pendulum_default_options();
    const double x[SIMPLE_PENDULUM_NX] = {2.5};
    int k;
#ifdef SIMPLE_PENDULUM_NPREPARED
    simple_pendulum_bind(&p);
#endif
    o.rtol = 1e-12;
    simple_pendulum_begin(&s, 0.0, x);
    for (k = 1; k <= 20; k++) {
        if (simple_pendulum_advance(&p, &s, 0.25 * k, &o, &w) != SIMPLE_PENDULUM_OK)
            return 1;
        printf("%.17g %.17g\\n", s.x[0], p.l);
    }
    return 0;
}
"""


@pytest.mark.sample(1)
@pytest.mark.skipif(not wide(), reason="no gcc for x87 here")
@pytest.mark.parametrize("words", WIDER)
def test_wider_arithmetic_can_be_allowed(words: str, tmp_path: Path) -> None:
    """A pendulum from rest at 2.5 rad against its closed form, by elliptic functions."""
    write(render(of_model("course/simple_pendulum")), tmp_path)
    (tmp_path / "main.c").write_text(MAIN)
    files = [tmp_path / "main.c", tmp_path / "simple_pendulum.c"]
    call("gcc", "-O2", *words.split(), KNOWN, *files, "-o", tmp_path / "run", "-lm")
    lines = call(tmp_path / "run").splitlines()
    assert len(lines) == 20
    for k, line in enumerate(lines, 1):
        theta, length = map(float, line.split())
        modulus, pace = mpmath.sin(1.25), mpmath.sqrt(9.81 / length)
        sn = mpmath.ellipfun("sn", mpmath.ellipk(modulus**2) - pace * k * 0.25, m=modulus**2)
        assert abs(theta - 2 * mpmath.asin(modulus * sn)) < 1e-9


@cache
def compilers() -> dict[str, list[str]]:
    """Those that fuse a product and a sum if they are not told."""
    found = {"gcc": ["gcc", "-std=gnu99"], "g++": ["g++", "-x", "c++", "-std=c++17"]}
    there = {name: words for name, words in found.items() if shutil.which(words[0])}
    return {**there, "clang": [*(clang() or ()), "-std=c99", "-ffp-contract=on"]} if clang() else there


@pytest.mark.full
@pytest.mark.parametrize("name", ["gcc", "g++", "clang"])
def test_no_product_is_fused_with_a_sum(name: str, tmp_path: Path) -> None:
    if name not in compilers():
        pytest.skip(f"no {name}")

    def fused(source: Path) -> bool:
        call(*compilers()[name], "-O3", "-mfma", "-S", source, "-o", tmp_path / "made.s")
        return bool(FUSED.search((tmp_path / "made.s").read_text(errors="replace")))

    (tmp_path / "probe.c").write_text(PROBE)
    if not fused(tmp_path / "probe.c"):
        pytest.skip(f"{name} fuses nothing")
    assert not fused(write(render(of_model("classic/double_pendulum")), tmp_path)[".c"])
