"""Right-hand sides with iterative refinement, for residuals above round-off."""

import ctypes
import sys
import types
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lagc.codegen.c.emit import render as render_c
from lagc.codegen.python.emit import render
from lagc.lowering.program import Program
from tests.codegen.test_numpy import bits, doubles, states
from tests.codegen.tools import call, of_model, present, write

MODELS = ["classic/four_bar", "classic/andrews_squeezer", "classic/sphere_on_turntable",
          "course/string_pendulum"]  # fmt: skip
ALWAYS = "-1.0"  # a limit that every residual exceeds


def _module(made: Program, limit: str) -> Any:
    """The generated module with another limit of rounding."""
    ((name, text),) = render(made).items()
    assert text.count("REFINED_RESIDUAL = 1e-28") == 1
    found = types.ModuleType(f"refined_{name[:-3]}")
    sys.modules[found.__name__] = found
    exec(
        compile(text.replace("REFINED_RESIDUAL = 1e-28", f"REFINED_RESIDUAL = {limit}"), name, "exec"),
        found.__dict__,
    )
    return found


def _library(made: Program, folder: Path) -> tuple[ctypes.CDLL, str]:
    """The generated C, always refined."""
    texts = {
        name: text.replace(" REFINED_RESIDUAL = 1e-28", f" REFINED_RESIDUAL = {ALWAYS}")
        for name, text in render_c(made).items()
    }
    assert any(f" REFINED_RESIDUAL = {ALWAYS}" in text for text in texts.values())
    files = write(texts, folder)
    flags = ["-std=c99", "-O0", "-ffp-contract=off", "-shared", "-fPIC"]
    call("gcc", *flags, files[".c"], "-o", folder / "made.so", "-lm")
    return ctypes.CDLL(str(folder / "made.so")), files[".c"].stem


@pytest.mark.sample(1)
@pytest.mark.parametrize("work", [True, False])
@pytest.mark.parametrize("name", MODELS)
def test_refinement_agrees_within_roundoff_and_bitwise_in_c(name: str, work: bool, tmp_path: Path) -> None:
    if not present("gcc"):
        pytest.skip("no gcc")
    made = of_model(name, work)
    plain, refined = _module(made, "1e-28"), _module(made, ALWAYS)
    lib, prefix = _library(made, tmp_path)
    size = getattr(lib, f"{prefix}_work_size")
    size.restype = ctypes.c_size_t
    room = ctypes.create_string_buffer(size())
    nx, nc, p = made.interface.nx, made.interface.nc, plain.default_params()
    for x in states(plain, 10):
        found, better = ([0.0] * nx, [0.0] * nc), ([0.0] * nx, [0.0] * nc)
        status = plain.equations(p).rhs(0.3, x, *found)
        equations = refined.equations(p)
        assert equations.rhs(0.3, x, *better) == status == 0
        assert equations.fallbacks == 0
        # factors without pivoting lose a few digits of a random configuration's accelerations
        for ours, theirs in zip(found, better):
            largest = max(map(abs, theirs))
            assert all(abs(a - b) <= 1e-11 * largest for a, b in zip(ours, theirs))
        out, lam = doubles([0.0] * nx), doubles([0.0] * nc)
        rhs = getattr(lib, f"{prefix}_rhs")
        assert rhs(doubles(plain.equations(p).p), ctypes.c_double(0.3), doubles(x), out, lam, room) == 0
        assert bits(out) == bits(better[0]) and bits(lam) == bits(better[1])


@pytest.mark.full
def test_roundoff_of_long_sums_is_not_refined() -> None:
    """In a ladder of n rungs that turns, rows sum forces that grow as n^2: the residual grows as n does, and
    what refinement would change remains what a last place of the state changes."""
    n = 80
    made = of_model("large/truss", n=n)
    straight, refined = _module(made, "1e-20"), _module(made, ALWAYS)
    nc, nx = made.interface.nc, made.interface.nx

    def accelerations(module: Any, x: list[float]) -> np.ndarray:
        xdot = [0.0] * nx
        assert module.equations(module.default_params()).rhs(0.0, x, xdot, [0.0] * nc) == 0
        return np.array(xdot[2 * n : 4 * n])

    x = [0.35] * (2 * n) + [1.0] * (2 * n)
    better = accelerations(refined, x)
    chance = np.random.default_rng(1)
    beside = [accelerations(refined, (np.array(x) * (1.0 + chance.choice((-1, 1), nx) * 2.0**-53)).tolist())
              for _ in range(5)]  # fmt: skip
    known = max(np.abs(other - better).max() for other in beside)
    assert 0.0 < np.abs(accelerations(straight, x) - better).max() < 4.0 * known
    assert straight.NMANY == 2  # 3 n unknowns
