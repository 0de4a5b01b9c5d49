"""Rendered modules and libraries at work: both give the same bits, and see what is wrong with a system."""

from __future__ import annotations

import shutil
import subprocess
import sys
from functools import cache
from importlib.util import find_spec
from math import isclose, sqrt
from pathlib import Path
from typing import Any

import pytest

import lagc
from lagc.codegen.c.emit import render as render_c
from lagc.codegen.python.emit import render as render_python
from lagc.lowering.program import Program
from lagc.simulation.backends import load
from lagc.simulation.backends.compile import compiler
from lagc.simulation.system import INCONSISTENT, NOT_FINITE, OK, REDUNDANT, SINGULAR_MASS, Options, System
from tests.simulation.generated import body_on_a_pivot, double_pendulum, masses, pendulum

PROGRAMS = {
    "double pendulum": double_pendulum(),
    "pendulum": pendulum(),
    "pendulum, dense": pendulum(straight=False),
    "pendulum twice": pendulum((1.0, 1.0)),
    "pendulum three times, dense": pendulum((1.0, -2.0, 0.5), straight=False),
    "body": body_on_a_pivot(),
    "masses": masses((2.0, 0.5, 1.0), lambda x: (-x[0], -(3.0 * x[1]))),
}
needs_compiler = pytest.mark.skipif(compiler() is None, reason="there is no C compiler")
BACKENDS = pytest.mark.parametrize("backend", ["numpy", pytest.param("c", marks=needs_compiler)])


def build(program: Program, backend: str) -> System:
    sources = render_c(program) if backend == "c" else render_python(program)
    return load(program.interface, sources, backend)


@cache
def built(name: str, backend: str) -> System:
    return build(PROGRAMS[name], backend)


def rates(system: System, x: list[float], t: float = 0.0) -> tuple[int, list[float], list[float]]:
    xdot, lam = [0.0] * system.nx, [0.0] * system.nc
    return system.rhs(t, x, xdot, lam), xdot, lam


@pytest.mark.sample(1, 12)
@needs_compiler
@pytest.mark.parametrize("name", PROGRAMS)
@pytest.mark.parametrize(
    "options",
    [
        Options(),
        Options(method="dopri5", rtol=1e-6, atol=1e-8),
        Options(step=0.02),
        Options(method="dopri5", step=0.02, project=False),
        Options(rtol=1e-4, atol=1e-4, max_steps=5),
        Options(first_step=0.3, max_step=0.1),
    ],
    ids=["default", "dopri5", "fixed", "drifting", "limited", "bounded"],
)
def test_c_and_python_agree_bitwise(name: str, options: Options) -> None:
    c, python = built(name, "c"), built(name, "numpy")
    x = c.start()
    assert x == python.start()
    times = [0.05 * i for i in range(41)]
    one, other = (vars(s.integrate(options, 0.0, x, times)) for s in (c, python))
    assert repr(one) == repr(other)
    assert len(one["times"]) == 41 or options.max_steps


@pytest.mark.sample(4)
@needs_compiler
@pytest.mark.parametrize("name", PROGRAMS)
def test_going_back_agrees_too(name: str) -> None:
    c, python = built(name, "c"), built(name, "numpy")
    x = c.start()
    one, other = (s.integrate(Options(), 1.0, x, [0.7, 0.0]) for s in (c, python))
    assert one.status == OK and repr(one.states) == repr(other.states)


COMPILERS = {"gcc": ["gcc", "-std=c99", "-O1"], "g++": ["g++", "-x", "c++", "-O0"], "zig": ["zig"]}


@pytest.mark.sample(0, 7)
@pytest.mark.parametrize("compile_", COMPILERS.values(), ids=COMPILERS)
@pytest.mark.parametrize("name", PROGRAMS)
def test_the_text_compiles_without_a_warning(name: str, compile_: Any, tmp_path: Path) -> None:
    if compile_ == ["zig"]:
        if find_spec("ziglang") is None or name not in ("pendulum twice", "body"):
            pytest.skip("zig is slow" if find_spec("ziglang") else "ziglang is not installed")
        compile_ = [sys.executable, "-m", "ziglang", "cc", "-std=c99", "-O0", "-fno-sanitize=all"]
    elif shutil.which(compile_[0]) is None:
        pytest.skip(f"no {compile_[0]}")
    sources = render_c(PROGRAMS[name])
    for file, text in sources.items():
        (tmp_path / file).write_text(text)
    unit = next(str(tmp_path / file) for file in sources if file.endswith(".c"))
    strict = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror"]
    done = subprocess.run(
        [*compile_, *strict, "-c", unit, "-o", str(tmp_path / "unit.o")], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr


def test_only_what_a_model_needs_is_written() -> None:
    plain = "".join(render_c(PROGRAMS["double pendulum"]).values())
    for word in ("project(", "orthogonalise", "normalise", "#if LAGC", "malloc"):
        assert word not in plain, word
    assert "pendulum_project(" in "".join(render_c(PROGRAMS["pendulum"]).values())
    assert "normalise" in "".join(render_c(PROGRAMS["body"]).values())


@BACKENDS
def test_energy_of_the_double_pendulum(backend: str) -> None:
    system = built("double pendulum", backend)
    x = system.start()
    run = system.integrate(Options(rtol=1e-12, atol=1e-12), 0.0, x, [5.0])
    before, after = system.energies(0.0, x)[2], system.energies(5.0, run.x)[2]
    assert after == pytest.approx(before, abs=1e-9)


@BACKENDS
def test_a_body_on_a_pivot_keeps_its_energy_and_place(backend: str) -> None:
    """Nine equations with a quaternion, three constraints and the work of gravity."""
    system = built("body", backend)
    x = system.start()
    run = system.integrate(Options(rtol=1e-11, atol=1e-11), 0.0, x, [0.1 * i for i in range(1, 51)])
    assert run.status == OK and run.position_drift <= 1e-14 and run.velocity_drift <= 1e-14
    assert system.energies(0.0, run.x)[2] == pytest.approx(system.energies(0.0, x)[2], abs=1e-8)
    work = system.energies(0.0, x)[1] - system.energies(0.0, run.x)[1]
    assert run.x[13] == pytest.approx(work, abs=1e-8)
    for state in run.states:
        assert isclose(sum(a * a for a in state[3:7]), 1.0, abs_tol=1e-15)
        assert max(abs(a) for a in system.position(0.0, state)) <= 1e-15


@pytest.mark.sample(2)
@BACKENDS
@pytest.mark.parametrize("copies", [(1.0, 1.0), (1.0, -2.0, 0.5)])
@pytest.mark.parametrize("straight", [True, False])
def test_a_repeated_constraint_changes_no_motion(backend: str, copies: Any, straight: bool) -> None:
    """The multipliers are the shortest that give the rod's force: in proportion to the factors."""
    once = built("pendulum", backend)
    often = build(pendulum(copies, straight), backend)
    x = once.start()
    _, rate, (force,) = rates(once, x)
    status, same, lam = rates(often, x)
    assert status == REDUNDANT
    assert same == pytest.approx(rate, rel=1e-13)
    square = sum(c * c for c in copies)
    assert lam == pytest.approx([force * c / square for c in copies], rel=1e-12)
    one = once.integrate(Options(rtol=1e-11, atol=1e-11), 0.0, x, [5.0])
    other = often.integrate(Options(rtol=1e-11, atol=1e-11), 0.0, x, [5.0])
    assert other.status == OK and other.x == pytest.approx(one.x, abs=1e-9)
    assert len(other.redundant_rows) == len(copies) - 1
    assert other.position_drift <= 1e-14 and other.velocity_drift <= 1e-14
    assert (other.fallbacks > 0) == straight


@pytest.mark.sample(1)
@BACKENDS
def test_contradicting_rows_are_named(backend: str) -> None:
    """The second row's acceleration leaves the first's by 3 m^2/s^2 a second."""
    system = build(pendulum((1.0, 1.0), gamma=(0.0, 3.0)), backend)
    x = system.start()
    assert rates(system, x)[0] == REDUNDANT
    status, _, _ = rates(system, x, t=1.0)
    assert status == INCONSISTENT and system.culprit == 1
    run = system.integrate(Options(), 0.0, x, [2.0])
    assert run.status == INCONSISTENT and run.culprit == 1 and run.t < 0.1


@pytest.mark.sample(1)
@BACKENDS
def test_a_singular_mass_matrix_is_named(backend: str) -> None:
    system = build(masses((1.0, 0.0, 0.0), lambda x: (-x[0], 1.0)), backend)
    assert rates(system, [1.0, 1.0, 0.0, 0.0])[0] == SINGULAR_MASS
    assert system.culprit == 1
    run = system.integrate(Options(), 0.0, [1.0, 1.0, 0.0, 0.0], [1.0])
    assert (run.status, run.culprit, run.t, run.states) == (SINGULAR_MASS, 1, 0.0, [])


@pytest.mark.sample(1)
@BACKENDS
def test_what_is_not_a_number_is_named(backend: str) -> None:
    system = build(masses((1.0, 0.0, 1.0), lambda x: (-x[0], x[1] / (x[0] - x[0]))), backend)
    assert rates(system, [1.0, 1.0, 0.0, 0.0])[0] == NOT_FINITE
    assert system.culprit == 3


@pytest.mark.sample(1)
@BACKENDS
def test_a_run_ends_at_the_border_of_its_equations(backend: str) -> None:
    """sqrt(x) where x falls through 0 at t = 1."""
    system = build(masses((1.0, 0.0, 1.0), lambda x: (0.0 * x[0], x[0].call("sqrt"))), backend)
    run = system.integrate(Options(), 0.0, [1.0, 1.0, -1.0, 0.0], [0.5, 2.0])
    assert run.status == NOT_FINITE and run.culprit == 3
    assert run.t == pytest.approx(1.0, abs=1e-3) and run.times == [0.5]
    assert run.states[0][0] == pytest.approx(0.5, abs=1e-8)


@BACKENDS
def test_the_drive_of_a_rod_follows_the_closed_form(backend: str) -> None:
    """A small swing of the pendulum has the period 2 pi sqrt(l/g) (1 + a^2/16)."""
    system = built("pendulum", backend)
    a = 0.02
    x = [a, -sqrt(1.0 - a * a), 0.0, 0.0]
    period = 2.0 * 3.141592653589793 / sqrt(9.81) * (1.0 + a * a / 16.0 + 11.0 * a**4 / 3072.0)
    run = system.integrate(Options(rtol=1e-12, atol=1e-12), 0.0, x, [period])
    assert run.x[0] == pytest.approx(a, abs=1e-9) and run.x[2] == pytest.approx(0.0, abs=1e-7)


@pytest.mark.sample(5)
@BACKENDS
@pytest.mark.parametrize("options", [{"step": 0.5, "method": name} for name in ("rk4", "dop853", "dopri5")]
                         + [{"rtol": 1e-6, "method": "dopri5"}])  # fmt: skip
def test_a_place_beyond_all_numbers_ends_a_motion_though_nothing_depends_on_it(
    options: dict[str, Any], backend: str
) -> None:
    text = "model F coordinate Length y; body b = Particle(mass = 1, at = {y, 0, 0}); end F;"
    system = lagc.loads(text).compile(backend=backend).system
    found = system.integrate(Options(**options), 0.0, [1.0, 1e308], [0.0, 1.0, 10.0], None)
    assert found.status == NOT_FINITE
    assert found.times[-1] < 10.0
    slow = system.integrate(Options(**options), 0.0, [1.0, 1e300], [0.0, 10.0], None)
    assert slow.status == OK and slow.states[-1][0] == pytest.approx(1e301, rel=1e-12)
