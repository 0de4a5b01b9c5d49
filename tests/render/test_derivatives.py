"""Derivatives in generated code: C and Python agree bit by bit, and who does not ask has none of them."""

from __future__ import annotations

import ctypes
import importlib.util
import random
from pathlib import Path
from typing import Any

import pytest

from lagc import compiler
from lagc.diagnostics.faults import Source
from lagc.mechanics.derive import derive
from lagc.optimize.optimize import optimize
from lagc.optimize.program import Program
from lagc.render.c.render import render as render_c
from lagc.render.numpy.render import render as render_numpy
from tests.mechanics.models import entangled
from tests.render.tools import COMPILERS, MODELS, STRICT, bits, call, present, write

NAMES = [
    "simple_pendulum",
    "classic/four_bar",
    "classic/sphere_on_turntable",
    "classic/moving_rail",
    "classic/chain",
]
SWITCHED = """
model Switched "conditions of time, states and parameters, one within another"
  parameter Mass m = 2 [kg];
  parameter Length d = 0.3 [m];
  parameter Time T = 0.7 [s];
  parameter Force F = 3 [N];
  coordinate Length x(start = 0.5 [m]), y(start = -0.2 [m]);
  body b = Particle(mass = m, at = {x, y, 0});
  force pulse = {if mod(time, T) < 0.2*T then F else -F*floor(x/d), 0, 0} at b;
  force wall = {0, if abs(y) > d then -F*sign(y)*(1 + max(x, y)/d) else 0 [N], 0} at b;
  output Force pushed = F*abs(x)/d;
end Switched;
"""


def _equations(name: str) -> Any:
    path = MODELS / (f"{name}.lag" if "/" in name else f"course/{name}.lag")
    source = Source(name, SWITCHED) if name == "switched" else Source(path.name, path.read_text())
    return compiler.derive(compiler.resolve(compiler.parse(source), compiler.Choice()))


def _program(name: str) -> Program:
    return optimize(derive(entangled(25)) if name == "looped" else _equations(name), differentiate=True)


def _module(program: Program, folder: Path) -> Any:
    (path,) = write(render_numpy(program), folder).values()
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.skipif(not present("gcc"), reason="no gcc")
@pytest.mark.parametrize("name", [*NAMES, "looped", "switched"])
def test_c_and_python_agree(name: str, tmp_path: Path) -> None:
    program = _program(name)
    program.verify()
    module, files = _module(program, tmp_path), write(render_c(program), tmp_path)
    library = tmp_path / "model.so"
    call(*COMPILERS["gcc"], *STRICT, "-O1", "-fPIC", "-shared", "-o", library, files[".c"], "-lm")
    c, own, interface = ctypes.CDLL(str(library)), files[".c"].stem, program.interface
    chance = random.Random(name)
    p = module.equations().p
    t, x = chance.random(), [a + chance.uniform(-0.1, 0.1) for a in module.start()]
    a, lam = ([chance.uniform(-1, 1) for _ in range(n)] for n in (interface.nv, interface.nc))

    def numbers(values: list[float]) -> Any:
        return (ctypes.c_double * max(len(values), 1))(*values)

    given = numbers(p), ctypes.c_double(t), numbers(x), numbers(a), numbers(lam)
    size = max(rows.stop for rows in module.STACK.values())
    s = numbers([0.0] * size)
    c[f"{own}_stack"](*given, s)
    assert bits(s[:size]) == bits(module.stack(t, x, a, lam))
    assert interface.stack == module.STACK and any(interface.derivatives.values())
    for group, pattern in interface.derivatives.items():
        assert module.PATTERNS[group] == list(pattern)
        if not pattern:
            assert not hasattr(c, f"{own}_by_{group}")
            continue
        entries = numbers([0.0] * len(pattern))
        c[f"{own}_by_{group}"](*given, entries)
        assert bits(entries) == bits(module.derivatives(group, t, x, a, lam))
        rows, columns = ctypes.POINTER(ctypes.c_int)(), ctypes.POINTER(ctypes.c_int)()
        count = c[f"{own}_by_{group}_pattern"](ctypes.byref(rows), ctypes.byref(columns))
        assert tuple(zip(rows[:count], columns[:count])) == pattern


@pytest.mark.parametrize("name", [*NAMES[:3], "switched"])
def test_it_compiles_as_cpp_without_a_warning(name: str, tmp_path: Path) -> None:
    if not present("g++"):
        pytest.skip("no g++")
    files = write(render_c(_program(name)), tmp_path)
    call(*COMPILERS["g++"], *STRICT, "-c", "-o", tmp_path / "m.o", files[".c"])


@pytest.mark.parametrize("name", [*NAMES, "switched"])
def test_who_does_not_ask_pays_nothing(name: str) -> None:
    with_them, without = _program(name), optimize(_equations(name))
    assert (
        not without.interface.derivatives and without.interface.model_hash != with_them.interface.model_hash
    )
    more = {
        "stack",
        *(f"by_{group}" for group, pattern in with_them.interface.derivatives.items() if pattern),
    }
    assert set(with_them.functions) - set(without.functions) <= {*more, "bind"}
    for text in (*render_c(without).values(), *render_numpy(without).values()):
        assert "by_state" not in text and "stack(" not in text and "PATTERNS" not in text
    for name in set(without.functions) - {"bind"}:
        assert without.functions[name].cost == with_them.functions[name].cost
