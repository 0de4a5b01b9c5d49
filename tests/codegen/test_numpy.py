"""Generated Python modules: they need no other module, and compute the same bits as generated C."""

import ctypes
import math
import random
import re
import subprocess
import sys
import types
from pathlib import Path
from typing import Any

import pytest

from lagc.codegen.c.emit import render as render_c
from lagc.codegen.python.emit import render
from lagc.compiler import pipeline
from lagc.diagnostics.faults import Source
from lagc.lowering.program import Program
from tests.codegen.programs import Builder, pendulum, program
from tests.codegen.test_c import PROGRAMS, tricky
from tests.codegen.tools import bits, call, of_model, present, write

MODELS = ["classic/double_pendulum", "classic/driven_oscillator", "classic/four_bar",
          "classic/andrews_squeezer",
          "classic/sphere_on_turntable", "classic/heavy_top_quaternion", "classic/knife_edge"]  # fmt: skip


def module(made: Program) -> Any:
    """The generated module, imported."""
    ((name, text),) = render(made).items()
    found = types.ModuleType(f"generated_{name[:-3]}")
    sys.modules[found.__name__] = found  # dataclasses look their module up
    exec(compile(text, name, "exec"), found.__dict__)
    return found


def library(made: Program, folder: Path) -> tuple[ctypes.CDLL, str]:
    if not present("gcc"):
        pytest.skip("no gcc")
    files = write(render_c(made), folder)
    call(
        "gcc",
        "-std=c99",
        "-O0",
        "-ffp-contract=off",
        "-shared",
        "-fPIC",
        files[".c"],
        "-o",
        folder / "made.so",
        "-lm",
    )
    return ctypes.CDLL(str(folder / "made.so")), files[".c"].stem


def doubles(values: Any) -> Any:
    values = list(values)
    return (ctypes.c_double * max(len(values), 1))(*values)


def states(python: Any, count: int) -> list[list[float]]:
    rng = random.Random(7)
    start = python.start()
    return [[v + rng.gauss(0, 0.3) for v in start] for _ in range(count)]


@pytest.mark.sample(0, 4)
@pytest.mark.parametrize("name", [*MODELS, "classic/chain"])
def test_every_public_function_agrees_bitwise(name: str, tmp_path: Path) -> None:
    made = of_model(name, n=30) if name == "classic/chain" else of_model(name)
    python = module(made)
    lib, prefix = library(made, tmp_path)
    interface = made.interface
    nx, nv, nc = interface.nx, interface.nv, interface.nc
    p = python.default_params()

    def get(word: str) -> Any:
        return getattr(lib, f"{prefix}_{word}")

    get("work_size").restype = ctypes.c_size_t
    cp, work = doubles([*p, *[0.0] * interface.prepared]), ctypes.create_string_buffer(get("work_size")())
    get("bind")(cp)
    assert bits(cp) == bits(python.equations(p).p)
    for x in states(python, 20):
        t, cx = 0.3, doubles(x)
        model = python.equations(p)
        xdot, lam, out, outlam = [0.0] * nx, [0.0] * nc, doubles([0.0] * nx), doubles([0.0] * nc)
        status = model.rhs(t, x, xdot, lam)
        assert get("rhs")(cp, ctypes.c_double(t), cx, out, outlam, work) == status
        if status in python.FAILED:
            continue
        assert bits(xdot) == bits(out) and bits(lam) == bits(list(outlam)[:nc])
        e, mass, force = doubles([0.0] * 3), doubles([0.0] * (nv * nv)), doubles([0.0] * nv)
        get("energies")(cp, ctypes.c_double(t), cx, e)
        assert bits(e) == bits(python.energies(t, x, p))
        if "system" in made.functions:
            get("mass_matrix")(cp, ctypes.c_double(t), cx, mass, work)
            get("forces")(cp, ctypes.c_double(t), cx, force, work)
            assert bits(mass) == bits(v for row in python.mass_matrix(t, x, p) for v in row)
            assert bits(force) == bits(python.forces(t, x, p))
        if nc:
            phi, psi, g, gamma = (doubles([0.0] * n) for n in (interface.nh, nc, nc * nv, nc))
            get("constraints")(cp, ctypes.c_double(t), cx, phi, psi, g, gamma, work)
            ours = python.constraints(t, x, p)
            assert bits(list(phi)[: interface.nh]) == bits(ours[0]) and bits(psi) == bits(ours[1])
            assert bits(g) == bits(v for row in ours[2] for v in row) and bits(gamma) == bits(ours[3])
        if interface.outputs:
            y = doubles([0.0] * len(interface.outputs))
            get("outputs")(cp, ctypes.c_double(t), cx, y, work)
            assert bits(y) == bits(python.outputs(t, x, p))


def assert_balance(rows: list[list[float]]) -> None:
    """Each row sums to zero.  A row of small terms only has its rounding from the largest one: factors
    are as good as the largest terms that passed through them."""
    largest = max((sum(map(abs, row)) for row in rows), default=0.0)
    for row in rows:
        assert abs(math.fsum(row)) <= 1e-9 * (1e-30 + sum(map(abs, row))) + 1e-13 * largest


@pytest.mark.sample(2)
@pytest.mark.parametrize("name", MODELS)
def test_accelerations_solve_the_equations(name: str) -> None:
    """M a = r + G^T lam and G a = gamma, by their own functions: to the rounding of sums of n terms."""
    made = of_model(name)
    python = module(made)
    for x in states(python, 5):
        try:
            a, lam = python.accelerations(0.1, x)
        except ArithmeticError:
            continue
        mass, r = python.mass_matrix(0.1, x), python.forces(0.1, x)
        _, _, g, gamma = python.constraints(0.1, x) if python.NC else ([], [], [], [])
        rows = [
            [m * b for m, b in zip(mass[i], a)] + [-r[i]] + [-row[i] * f for row, f in zip(g, lam)]
            for i in range(python.NV)
        ]
        assert_balance(rows)
        assert_balance([[c * b for c, b in zip(row, a)] + [-right] for row, right in zip(g, gamma)])


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", MODELS)
def test_many_states_at_once(name: str) -> None:
    """NumPy's functions may differ in the last bit, which a solve magnifies."""
    numpy = pytest.importorskip("numpy")
    python = module(of_model(name))
    x = numpy.array(states(python, 50))
    many = python.rhs_many(0.3, x)
    assert many.shape == x.shape
    for row, result in zip(x, many):
        try:
            alone = python.rhs(0.3, row.tolist())
        except ArithmeticError:
            assert numpy.isnan(result).all()
            continue
        assert numpy.allclose(result, alone, rtol=1e-8, atol=1e-8 * max(map(abs, alone)))


def test_parameters_of_each_state() -> None:
    numpy = pytest.importorskip("numpy")
    python = module(pendulum())
    lengths = numpy.array([0.5, 1.0, 2.0])
    p = numpy.array([python.default_params(l=value) for value in lengths])
    found = python.rhs_many(0.0, numpy.tile([1.0, 0.0], (3, 1)), p)
    assert numpy.allclose(found[:, 1], -9.81 / lengths * math.sin(1.0), rtol=1e-15)


@pytest.mark.full
@pytest.mark.parametrize("name", ["pendulum", "tricky", "loop", "quaternion", "lifted", "looped"])
def test_module_needs_nothing(name: str, tmp_path: Path) -> None:
    """An isolated interpreter, without lagc and without NumPy on its path."""
    made = PROGRAMS[name]()
    files = write(render(made), tmp_path)
    code = (
        "import sys, importlib.util as u; assert u.find_spec('lagc') is None; sys.modules['numpy'] = None\n"
        f"s = u.spec_from_file_location('made', {str(files['.py'])!r}); m = u.module_from_spec(s)\n"
        "sys.modules['made'] = m; s.loader.exec_module(m); x = m.start()\n"
        "run = m.integrate(0, x, [0.01, 0.02]); assert run.status == 0 and run.t == 0.02, run\n"
        "m.energies(0, x); getattr(m, 'mass_matrix', m.energies)(0, x); m.accelerations(0, x)\n"
        "assert len(m.PARAMETERS) == len(m.default_params())"
    )
    subprocess.run([sys.executable, "-I", "-S", "-W", "error", "-c", code], check=True, cwd=tmp_path)


def test_text_is_ascii_and_keeps_strings_of_users_inside_strings() -> None:
    ((_, text),) = render(tricky()).items()
    assert text.isascii() and "lagc.codegen" not in text
    compile(text, "x", "exec")


def test_parameters_by_keyword() -> None:
    python = module(pendulum())
    assert python.default_params(l=2) == [1.0, 2.0, 9.81]
    with pytest.raises(KeyError, match="'n' is not a parameter: m, l, g"):
        python.default_params(n=2)


@pytest.mark.full
def test_exceptions_of_python_become_the_values_of_c(tmp_path: Path) -> None:
    """l = 0: g/l sin(theta) is infinite, for nothing has inertia then, as the status says."""
    made = pendulum()
    python, (lib, prefix) = module(made), library(made, tmp_path)
    p = python.default_params(l=0.0)
    work = ctypes.create_string_buffer(4096)
    for theta in (1.0, 0.0, -1.0):
        model, xdot, out = python.equations(p), [0.0, 0.0], doubles([0.0, 0.0])
        status = model.rhs(0.0, [theta, 1.0], xdot, [])
        assert status == python.SINGULAR_MASS and model.culprit == 0
        assert (
            getattr(lib, f"{prefix}_rhs")(
                doubles(p), ctypes.c_double(0.0), doubles([theta, 1.0]), out, None, work
            )
            == status
        )
        assert bits(xdot) == bits(out)
        with pytest.raises(ArithmeticError, match="singular"):
            python.rhs(0.0, [theta, 1.0], p)


@pytest.mark.full
def test_one_evaluation_of_a_large_function_is_compiled_quickly() -> None:
    """Time grows in proportion: twice the operations, about twice the time of compile()."""
    from time import process_time

    def seconds(size: int) -> float:
        build = Builder("rhs", ("p", "t", "x"), (("xdot", 2), ("lam", 0), ("health", 2)))
        values = [build.load("x", 0), build.load("x", 1)]
        for k in range(size):
            values.append(build.op(("add", "mul", "sub")[k % 3], values[-1], values[k // 2]))
        build.store("xdot", 0, values[-1])
        ((name, text),) = render(program("Large", [build.function()])).items()
        best = math.inf
        for _ in range(3):
            began = process_time()
            compile(text, name, "exec")
            best = min(best, process_time() - began)
        return best

    small, large = seconds(8000), seconds(32000)
    assert large < 8 * small


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", MODELS)
def test_a_module_defines_no_name_twice(name: str) -> None:
    """Kernels, functions of the model and what callers use share one namespace."""
    ((_, text),) = render(of_model(name)).items()
    found = re.findall(r"^(?:def |class )?(\w+)(?: = |\(|:)", text, re.M)
    assert len(found) == len(set(found)) > 50, sorted(n for n in found if found.count(n) > 1)


def test_after_a_failure_the_state_is_at_the_end_of_the_last_step() -> None:
    """x'' = -1 - sqrt(x), from 1: beyond 0 there is no root."""
    text = """model Root
  coordinate Length x(start = 1 [m]);
  body b = Particle(mass = 1 [kg], at = {x, 0, 0});
  force f = {-1 [N]*sqrt(x/1 [m]) - 1 [N], 0, 0} at b;
end Root;"""
    m = module(pipeline.program(Source("root.lag", text), pipeline.Choice()))
    run = m.Integrator(m.equations(), m.Options(), 0.0, [1.0, 0.0])
    assert run.advance(5.0) == m.NOT_FINITE and 1.0 < run.t < 2.0
    ended = run.t
    assert run.advance(5.0) == m.NOT_FINITE and run.t == ended
