"""The controller of the documentation, as it stands there: in C, in Python, with restarts, by scipy."""

import re
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

import pytest

import lagc
from lagc.cli.main import main
from lagc.simulation.system import Options
from tests.simulation.driven import InC, InPython
from tests.simulation.programs import BACKENDS

pytestmark = pytest.mark.usefixtures("own_cache")
PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "embed-the-c.md"
TEXT = PAGE.read_text(encoding="utf-8")
CALLS = 3000
STEPS = CALLS + 2  # at most: the cart's sizes at rest are none, so that the first call takes three


def block(language: str, number: int = 0) -> str:
    return re.findall(rf"```{language}\n(.*?)```", TEXT, re.S)[number]


@cache
def compiled(backend: str) -> Any:
    return lagc.loads(block("modelica"), "cart_pole.lag").compile(backend=backend).load(backend)


def force(x: Any) -> float:
    u: float = 1.0 * x[0] + 2.5 * x[2] + 25.0 * x[1] + 5.0 * x[3]
    return max(-2.0, min(2.0, u))


@cache
def by_scipy() -> list[float]:
    """Piece by piece, on equations written here by hand."""
    integrate = pytest.importorskip("scipy.integrate")
    from math import cos, pi, sin

    M, m, l, g = 1.0, 0.1, 0.5, 9.81  # noqa: E741

    def rates(_: float, x: Any, u: float) -> list[float]:
        c, s, w = cos(x[1]), sin(x[1]), x[3]
        a = (u + m * l * w * w * s - m * g * s * c) / (M + m * s * s)
        return [x[2], w, a, (g * s - a * c) / l]

    x: Any = [0.0, 5.0 * pi / 180.0, 0.0, 0.0]
    for k in range(CALLS):
        x = integrate.solve_ivp(rates, (0.001 * k, 0.001 * (k + 1)), x, "DOP853", rtol=1e-12, atol=1e-13,
                                args=(force(x),)).y[:, -1]  # fmt: skip
    return [float(a) for a in x]


def printed(program: str, folder: Path, real: str = "double") -> list[str]:
    """What a program of the documentation prints."""
    (folder / "cart_pole.lag").write_text(block("modelica"))
    model = str(folder / "cart_pole.lag")
    options = f"--target c --method dop853,rk4 --real {real} --verified -q"
    assert main(["build", model, *options.split(), "-o", str(folder)]) == 0
    (folder / "controller.c").write_text(program)
    strict = ["-std=c99", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror"]
    if real != "double":
        strict.remove("-Wconversion")  # numbers of the text are doubles
    command = ["gcc", *strict, "controller.c", "cart_pole.c", "-lm", "-o", "controller"]
    subprocess.run(command, cwd=folder, check=True)
    done = subprocess.run(["./controller"], cwd=folder, capture_output=True, text=True, check=True)
    return done.stdout.split()


@pytest.mark.full
@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
def test_the_program_in_c_of_floats(tmp_path: Path) -> None:
    x, theta, *_ = printed(block("c"), tmp_path, "float")
    assert [float(x), float(theta)] == pytest.approx(by_scipy()[:2], rel=1e-2, abs=1e-4)


@pytest.mark.full
@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
def test_the_program_in_c(tmp_path: Path) -> None:
    x, theta, steps, evaluations = printed(block("c"), tmp_path)
    expected = by_scipy()
    assert [float(x), float(theta)] == pytest.approx(expected[:2], rel=1e-7, abs=1e-8)
    assert CALLS <= int(steps) <= STEPS and int(evaluations) <= 13 * int(steps)


@pytest.mark.full
@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
def test_the_program_with_an_input_from_a_table(tmp_path: Path) -> None:
    found = [float(word) for word in printed(block("c", 1), tmp_path)]
    course = ([0.0, 0.2, 0.5], [0.0, 1.5, -2.0], "held")
    system = lagc.loads(block("modelica"), "cart_pole.lag").compile(inputs={"u": course})
    run = system.simulate(0.6, accuracy=1e-11)
    assert [run["x"][-1], run["theta"][-1]] == pytest.approx(found, rel=1e-8)


@pytest.mark.full
@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
def test_the_program_that_knows_its_error(tmp_path: Path) -> None:
    """One second with 0.1 N, against a run a thousand times tighter; rk4 errs by about h^4 there."""
    (program,) = [text for text in re.findall(r"```c\n(.*?)```", TEXT, re.S) if "_verified(" in text]
    words = printed(program, tmp_path)
    theta, known, off = float(words[1].rstrip(",")), float(words[4]), float(words[10])
    system = lagc.loads(block("modelica"), "cart_pole.lag").compile(inputs={"u": 0.1})
    exact = system.simulate(1.0, accuracy=1e-12)["theta"][-1]
    assert abs(theta - exact) <= known <= 2e-9
    assert 0.0 < off < 1e-8


def test_the_module_in_python(tmp_path: Path) -> None:
    (tmp_path / "cart_pole.lag").write_text(block("modelica"))
    assert (
        main(["build", str(tmp_path / "cart_pole.lag"), "--target", "numpy", "-o", str(tmp_path), "-q"]) == 0
    )
    script = block("python") + "\nprint(*run.x, run.steps, run.rhs)\n"
    done = subprocess.run([sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True)
    words = done.stdout.split()
    assert [float(w) for w in words[:4]] == pytest.approx(by_scipy(), rel=1e-7, abs=1e-8), done.stderr
    assert CALLS <= int(words[4]) <= STEPS and int(words[5]) <= 13 * int(words[4])


@pytest.mark.sample(1)
@BACKENDS
def test_against_restarts(backend: str) -> None:
    """A new trajectory each millisecond: the motion is the same, at a fraction of the cost."""
    system, kind = compiled(backend), InC if backend == "c" else InPython
    options = Options(rtol=1e-9, atol=1e-9)
    run, x, cost = kind(system, options, 0.0, system.start()), system.start(), 0
    for k in range(CALLS // 3):
        run.p[-1] = force(run.facts()[1])
        assert run.advance(0.001 * (k + 1)) == 0
        fresh = kind(system, options, 0.001 * k, x)
        fresh.p[-1] = force(x)
        assert fresh.advance(0.001 * (k + 1)) == 0
        x, cost = fresh.facts()[1], cost + fresh.facts()[5]
    assert run.facts()[1] == pytest.approx(x, rel=1e-8, abs=1e-9)
    assert run.facts()[5] < 0.95 * cost


@pytest.mark.full
@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
def test_a_caller_in_another_language(tmp_path: Path) -> None:
    """It finds a parameter by its name: -g/l sin(0.1) for l = 0.7 m."""
    from math import sin

    command = [sys.executable, "-c", block("python", 1)]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert float(done.stdout) == pytest.approx(-9.81 / 0.7 * sin(0.1), rel=1e-12)
