"""Derivatives in generated code: C and Python agree bit by bit; without the option there are none."""

import ctypes
import importlib.util
import random
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from lagc.codegen.c.emit import render as render_c
from lagc.codegen.python.emit import render as render_numpy
from lagc.compiler import pipeline
from lagc.diagnostics.faults import Source
from lagc.lowering import jacobians
from lagc.lowering.lower_equations import optimize
from lagc.lowering.program import Interface, Program
from lagc.mechanics.derive import derive
from tests.codegen.tools import COMPILERS, MODELS, STRICT, bits, call, present, write
from tests.invariants import verify
from tests.mechanics.models import entangled

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
    return pipeline.derive(pipeline.resolve(pipeline.parse(source), pipeline.Choice()))


def _program(name: str) -> Program:
    return optimize(derive(entangled(25)) if name == "looped" else _equations(name), differentiate=True)


def _module(program: Program, folder: Path) -> Any:
    (path,) = write(render_numpy(program), folder).values()
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class Both(NamedTuple):
    """A program in Python and in C, with a point for both."""

    interface: Interface
    module: Any
    library: Any
    prefix: str
    point: tuple[Any, ...]  # t, x, a, lam

    def c(self, verb: str, *last: Any) -> Any:
        t, *vectors = self.point
        given = _numbers(self.module.equations().p), ctypes.c_double(t), *map(_numbers, vectors)
        return self.library[f"{self.prefix}_{verb}"](*given, *last)


def _numbers(values: Sequence[float]) -> Any:
    return (ctypes.c_double * max(len(values), 1))(*values)


def _both(program: Program, folder: Path, seed: str) -> Both:
    verify(program)
    module, files = _module(program, folder), write(render_c(program), folder)
    library = folder / "model.so"
    call(*COMPILERS["gcc"], *STRICT, "-O1", "-fPIC", "-shared", "-o", library, files[".c"], "-lm")
    chance, interface = random.Random(seed), program.interface
    t, x = chance.random(), [a + chance.uniform(-0.1, 0.1) for a in module.start()]
    a, lam = ([chance.uniform(-1, 1) for _ in range(n)] for n in (interface.nv, interface.nc))
    return Both(interface, module, ctypes.CDLL(str(library)), files[".c"].stem, (t, x, a, lam))


@pytest.mark.sample(0, 2)
@pytest.mark.skipif(not present("gcc"), reason="no gcc")
@pytest.mark.parametrize("name", [*NAMES, "looped", "switched"])
def test_c_and_python_agree(name: str, tmp_path: Path) -> None:
    interface, module, c, own, point = both = _both(_program(name), tmp_path, name)
    s = _numbers([0.0] * max(rows.stop for rows in module.STACK.values()))
    both.c("stack", s)
    assert bits(s) == bits(module.stack(*point))
    assert interface.stack == module.STACK and any(interface.derivatives.values())
    for group, pattern in interface.derivatives.items():
        assert module.PATTERNS[group] == list(pattern)
        if not pattern:
            assert not hasattr(c, f"{own}_by_{group}")
            continue
        entries = _numbers([0.0] * len(pattern))
        both.c(f"by_{group}", entries)
        assert bits(entries) == bits(module.derivatives(group, *point))
        rows, columns = ctypes.POINTER(ctypes.c_int)(), ctypes.POINTER(ctypes.c_int)()
        count = c[f"{own}_by_{group}_pattern"](ctypes.byref(rows), ctypes.byref(columns))
        assert tuple(zip(rows[:count], columns[:count])) == pattern


@pytest.mark.sample(0, 2)
@pytest.mark.skipif(not present("gcc"), reason="no gcc")
@pytest.mark.parametrize("name", [*NAMES, "looped", "switched"])
def test_very_many_are_along_directions(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In C and in Python the same bits, and those by groups one column at a time and all at once."""
    few = _module(_program(name), tmp_path)
    monkeypatch.setattr(jacobians, "MOST", 0)
    both = _both(_program(name), tmp_path, name)
    interface, module, _, _, point = both
    assert not interface.derivatives and not hasattr(module, "PATTERNS")
    width, height = (max(p.stop for p in parts.values()) for parts in (interface.groups, interface.stack))
    chance = random.Random(f"{name} along")
    d = [chance.uniform(-1, 1) for _ in range(width)]
    s = _numbers([0.0] * height)
    both.c("along", _numbers(d), s)
    assert bits(s) == bits(module.along(*point, d))
    assert np.allclose(module.stack(*point), few.stack(*point), rtol=1e-12, atol=1e-12)
    together = np.array([entry + np.zeros(width) for entry in module.along(*point, list(np.eye(width)))])
    table = np.zeros((height, width))
    for group, columns in interface.groups.items():
        if pattern := few.PATTERNS[group]:
            rows, places = np.array(pattern).T
            table[rows, columns.start + places] = few.derivatives(group, *point)
    rounding = 1e-13 * np.abs(table).max()
    assert np.abs(together - table).max() <= rounding
    assert np.abs(table @ d - s).max() <= rounding * np.sqrt(width)


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", [*NAMES[:3], "switched"])
def test_it_compiles_as_cpp_without_a_warning(name: str, tmp_path: Path) -> None:
    if not present("g++"):
        pytest.skip("no g++")
    files = write(render_c(_program(name)), tmp_path)
    call(*COMPILERS["g++"], *STRICT, "-c", "-o", tmp_path / "m.o", files[".c"])


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", [*NAMES, "switched"])
def test_without_the_option_there_are_no_derivatives(name: str) -> None:
    with_them, without = _program(name), optimize(_equations(name))
    assert (
        not without.interface.derivatives and without.interface.model_hash != with_them.interface.model_hash
    )
    by = {f"by_{group}" for group, pattern in with_them.interface.derivatives.items() if pattern}
    more = {"stack", "assemble", "factor", "solve", *by}
    assert set(with_them.functions) - set(without.functions) <= {*more, "bind"}
    for text in (*render_c(without).values(), *render_numpy(without).values()):
        assert "by_state" not in text and "stack(" not in text and "PATTERNS" not in text
    for name in set(without.functions) - {"bind"}:
        assert without.functions[name].cost == with_them.functions[name].cost
