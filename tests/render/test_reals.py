"""Generated C for other types of reals: float to its own accuracy, quad against many digits."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import mpmath
import pytest

import lagc
from lagc.cli.main import main
from lagc.render.c.render import render
from lagc.render.kernels.arithmetic import QUAD, SINGLE, Arithmetic
from lagc.render.names import prefix
from tests.render.tools import MODELS, call, of_model

pytestmark = pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not there")
HERE = Path(__file__).parent
WARNINGS = ["-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror", "-ffp-contract=off"]


def built(name: str, real: Arithmetic, folder: Path) -> Path:
    """The program of `reals.c` for a model of the library."""
    program = of_model(name)
    own = prefix(program.interface.model)
    for file, text in render(program, False, real).items():
        (folder / file).write_text(text)
    header, more = f"{own}.h", ["-Wpedantic", "-Wdouble-promotion"]
    libraries = ["-lm"]
    if real == QUAD:
        more, libraries = ["-DQUAD"], ["-lquadmath", "-lm"]
    words = [f"-DPREFIX={own}", f"-DUPPER={own.upper()}", f"-DREAL={real.name}", "-include", folder / header]
    words += ["-DPREPARED"] if program.interface.prepared else []
    source = folder / header.replace(".h", ".c")
    # the driver prints doubles
    call("gcc", "-std=c99", "-O1", *WARNINGS, *more, "-c", source, "-o", folder / "model.o")
    call("gcc", "-std=gnu99", "-O1", *words, *more[-1:], "-c", HERE / "reals.c", "-o", folder / "main.o")
    call("gcc", folder / "main.o", folder / "model.o", *libraries, "-o", folder / "run")
    return folder / "run"


def end(run: Path, t1: float, rtol: str, x: list[str], method: int = 0) -> list[str]:
    status, *found = call(run, str(t1), rtol, str(method), *x).split()
    assert status == "0"
    return found


def kepler(e: str, t: str) -> list[mpmath.mpf]:
    """x, y and their rates at t of a planet with G M = a = 1 that starts where it is nearest."""
    e_, t_ = mpmath.mpf(e), mpmath.mpf(t)
    u = mpmath.findroot(lambda u: u - e_ * mpmath.sin(u) - t_, t_)
    short, rate = mpmath.sqrt(1 - e_**2), 1 / (1 - e_ * mpmath.cos(u))
    return [mpmath.cos(u) - e_, short * mpmath.sin(u), -mpmath.sin(u) * rate, short * mpmath.cos(u) * rate]


def test_quad_follows_a_closed_form_to_25_digits(tmp_path: Path) -> None:
    run = built("classic/kepler", QUAD, tmp_path)
    with mpmath.workdps(50):
        truth = kepler("0.6", "0.75")
        found = [mpmath.mpf(x) for x in end(run, 0.75, "1e-28", ["0.4", "0", "0", "2"])]
        assert max(abs(a - b) for a, b in zip(found, truth)) < 1e-25


def test_quad_keeps_a_constrained_motion_on_its_constraint(tmp_path: Path) -> None:
    """A mass on a string of 0.5 m, from rest at x = 0.3 m: its length and its energy."""
    run = built("course/string_pendulum", QUAD, tmp_path)
    with mpmath.workdps(50):
        x, z, vx, vz = (mpmath.mpf(v) for v in end(run, 0.75, "1e-28", ["0.3", "-0.4", "0", "0"])[:4])
        assert abs(x**2 + z**2 - 0.25) < 1e-31 and abs(x * vx + z * vz) < 1e-31
        assert abs((vx**2 + vz**2) / 2 + mpmath.mpf("9.81") * (z + mpmath.mpf("0.4"))) < 1e-25


# LAGC_ALL=1: with every model of the library.
NAMES = sorted(p.stem for p in (MODELS / "classic").glob("*.lag"))[:: 1 if os.environ.get("LAGC_ALL") else 6]


@pytest.mark.parametrize("name", NAMES)
def test_float_runs_the_library_on_its_own_tolerances(name: str, tmp_path: Path) -> None:
    """A part of the motion of a scene, with floats to 1e-5: the states of doubles to a few 1e-3 of the
    largest of their kind (a few hundred steps of rounding by 6e-8, and what the motion makes of them)."""
    model = lagc.load(f"classic/{name}").compile(backend="numpy")
    stop = min(0.3, 0.3 * model.program.interface.simulate["stop"])
    truth = model.simulate(stop=stop, accuracy=1e-6)
    run = built(f"classic/{name}", SINGLE, tmp_path)
    found = [float(x) for x in end(run, float(truth.times[-1]), "1e-5", [repr(x) for x in truth.states[0]])]
    interface = model.program.interface
    n = interface.nq + interface.nv
    size = [0.0] * (max(interface.kinds) + 1)
    for x in truth.states:
        for kind, value in zip(interface.kinds, x[:n]):
            size[kind] = max(size[kind], abs(value))
    for kind, a, b in zip(interface.kinds, found, truth.states[-1]):
        assert abs(a - b) <= 5e-3 * size[kind]


def test_the_command_line_builds_for_floats(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["build", "double_pendulum", "--real", "float", "-o", str(tmp_path), "-q"]) == 0
    text = (tmp_path / "double_pendulum.h").read_text() + (tmp_path / "double_pendulum.c").read_text()
    assert "double " not in "\n".join(line for line in text.splitlines() if "*" not in line[:3])
    assert (
        main(["build", "double_pendulum", "--real", "float", "--target", "numpy", "-o", str(tmp_path)]) == 2
    )
    assert "--target c" in capsys.readouterr().err
