"""Consistent starts by the generated code: the C function and its twin in the generated Python module."""

import ctypes
import random
import subprocess
from collections.abc import Sequence
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

from lagc.codegen.c.emit import render as render_c
from lagc.codegen.identifiers import prefix
from lagc.codegen.python.emit import render as render_python
from lagc.compiler import pipeline
from lagc.diagnostics.faults import Source
from lagc.host.model_library import read
from lagc.lowering.program import Program
from lagc.simulation.backends.python import NumpyModel
from lagc.simulation.initialization.initialize import consistent_start
from lagc.simulation.initialization.result import Start
from lagc.simulation.system import System

FIXED = 4


def compilation_of(text: str, scene: str | None = None) -> pipeline.Compilation:
    """Of a text, or of a model of the library."""
    source = Source("m.lag", text) if "\n" in text else read(text)
    return pipeline.Compilation(source, pipeline.Choice(scene=scene))


def program_of(text: str, scene: str | None = None) -> Program:
    return compilation_of(text, scene).program


def system_of(text: str, scene: str | None = None) -> System:
    program = program_of(text, scene)
    model = NumpyModel(program.interface, render_python(program))
    return model.bind(model.defaults())


def start_of(text: str, **given: float) -> dict[str, float]:
    """The consistent start of a text by name; a coordinate's rate is `der(x)`."""
    system = system_of(text)
    found = consistent_start(system, 0.0, given)
    assert not found.unmet, found.unmet
    return dict(zip((*system.interface.q_names, *system.interface.v_names), found.x))


def stated_moves(start: Start) -> list[str]:
    """The stated values that moved, by name."""
    assert not start.unmet, start.unmet
    return [c.name for c in start.changes if c.stated]


class Starts:
    """The two searches for a consistent start that the generated code of `program` has."""

    def __init__(self, program: Program):
        self.interface = program.interface
        ((_, text),) = render_python(program).items()
        self.module: dict[str, Any] = {"__name__": "generated"}
        exec(compile(text, "generated", "exec"), self.module)
        self.model = self.module["equations"]()
        self.library, self.prefix = _library(program), prefix(program.interface.model)
        self.n = program.interface.nq + program.interface.nv
        size = self.library.room
        size.restype = ctypes.c_size_t
        self.room = ctypes.create_string_buffer(size())

    @property
    def guess(self) -> list[float]:
        found: list[float] = self.module["start"]()
        return found

    def checked(self, p: Sequence[float]) -> int | None:
        """Which of the parameters, then of the values made of them, `check` refuses, in C and in Python."""
        found, prepared = ctypes.c_int(-1), self.interface.prepared
        given = (ctypes.c_double * (len(p) + prepared))(*p)
        if prepared:
            getattr(self.library, f"{self.prefix}_bind")(given)
        status = getattr(self.library, f"{self.prefix}_check")(given, None, ctypes.byref(found))
        try:
            self.module["check"](list(p))
        except ValueError:
            assert status != 0
            return found.value - 16  # BAD_PARAMETER
        assert status == 0
        return None

    def by_python(self, t: float, x: Sequence[float], levels: Sequence[int]) -> tuple[int, int, list[float]]:
        """Status, culprit where it failed, and x."""
        room = self.module["StartWork"]()
        status = self.module["prepare"](self.model.p, t, x, levels, room)
        if status == 0:
            status = self.module["reach_start"](self.model.p, t, room)
        y = [*room.y[: self.n], *x[self.n :]] if status == 0 else list(x)
        return status, room.culprit if status else 0, y

    def by_c(
        self, t: float, x: Sequence[float], levels: Sequence[int] | None
    ) -> tuple[int, int, list[float]]:
        p = (ctypes.c_double * max(len(self.model.p), 1))(*self.model.p)
        y = (ctypes.c_double * len(x))(*x)
        given = None if levels is None else (ctypes.c_int * len(levels))(*levels)
        call = getattr(self.library, f"{self.prefix}_consistent")
        status = call(p, ctypes.c_double(t), y, given, self.room)
        culprit = ctypes.c_int.from_buffer(self.room).value
        return status, culprit if status else 0, list(y)


def _library(program: Program) -> ctypes.CDLL:
    folder = Path(mkdtemp())
    files = render_c(program)
    for name, text in files.items():
        (folder / name).write_text(text)
    unit = next(name for name in files if name.endswith(".c"))
    size = f"sizeof({prefix(program.interface.model)}_start_work)"
    (folder / "all.c").write_text(f'#include "{unit}"\nsize_t room(void) {{ return {size}; }}\n')
    command = [
        "gcc", "-std=c99", "-O0", "-ffp-contract=off", "-fPIC", "-shared", "all.c", "-lm", "-o", "all.so",
    ]  # fmt: skip
    subprocess.run(command, cwd=folder, check=True)
    return ctypes.CDLL(str(folder / "all.so"))


def random_levels(n: int, dice: random.Random) -> list[int]:
    return [dice.choice((0, 0, 0, 1, 1, 2, 3, FIXED)) for _ in range(n)]
