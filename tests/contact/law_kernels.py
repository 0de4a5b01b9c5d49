"""The contact kernels alone, compiled from their C text or run as their Python text."""

import ctypes
import subprocess
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from lagc.codegen.kernel_compiler.c import CPrinter, copies, snake
from lagc.codegen.kernel_compiler.compiler import definitions
from lagc.codegen.kernel_compiler.library import library
from lagc.codegen.kernel_compiler.real_types import DOUBLE
from lagc.codegen.python.functions import ARITHMETIC
from lagc.codegen.python.runtime import numbers
from lagc.codegen.sizes import DERIVED, SPELLED

OPEN, SLIPS, STICKS = 0, 1, 2
ONE, FOUND, NONE, SEVERAL, FAILED = range(5)
ROOTS = ("set_law", "solve_frozen", "impact")
_CTYPES = {"Real": ctypes.c_double, "Vec": ctypes.c_double, "int": ctypes.c_int, "IVec": ctypes.c_int,
           "bool": ctypes.c_int}  # fmt: skip
FLAGS = ("-std=c99", "-O2", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-ffp-contract=off")


class Kernels:
    """The kernels for at most `contacts` contacts with `slips` slip rows in all."""

    def __init__(self, contacts: int, slips: int):
        own = {"NCON": contacts, "NSLIP": slips, "NSPACE": slips // 2, "NPOISSON": 1, "NBESIDE": 1}
        derived = ("NCROW", "NDELASSUS", "NDIRECT")
        own.update({name: DERIVED[name](own) for name in derived})
        self.flags = {flag: flag in own for flag in definitions().sizes}
        self.sizes = {**own, "TWO": 2}
        self.use = library("double").chosen(ROOTS, self.flags)
        self.members = {
            part.name: [(n, tuple(kind)) for n, kind, *_ in part.members] for part in self.use.records
        }

    def python(self) -> dict[str, Any]:
        """Return the kernels in Python, with `make`, which returns a workspace."""
        space: dict[str, Any] = {**self.sizes, "make": lambda: Workspace(self._fields)}
        use = library("python").chosen(ROOTS, self.flags)
        text = [ARITHMETIC, numbers(use.constants), *(part.text for part in use.functions)]
        exec("\n".join(text), space)
        return {**space, **{name: _called(space[name], name) for name in ROOTS}}

    def _fields(self, record: str) -> Any:
        """Return a record of Python, of zeros."""
        found = SimpleNamespace()
        for name, kind in self.members[record]:
            zero: Any = 0.0 if kind[0] in ("Real", "Vec") else 0
            plain = self._fields(kind[1]) if kind[0] == "Record" else zero
            setattr(
                found, name, plain if len(kind) == 1 or kind[0] == "Record" else [zero] * self.sizes[kind[1]]
            )
        return found

    def c(self, folder: Path) -> dict[str, Any]:
        """Return the kernels compiled by gcc, likewise."""
        printer = CPrinter(DOUBLE, SPELLED, {})
        numbers = dict[str, Any](self.sizes)
        numbers.update({part.name: part.text for part in self.use.constants})
        text = [DOUBLE.includes + "#include <stddef.h>"]
        text += [f"#define LAGC_{name} {value}" for name, value in numbers.items()]
        for record, members in self.members.items():
            text += ["typedef struct {"]
            text += [f"    {printer.member(kind, name)};" for name, kind in members]
            text += [f"}} lagc_{snake(record)};"]
        kernels = "".join(part.text for part in self.use.functions)
        text += [*(own.replace("lagc_real", "double") for own in copies(kernels)), kernels]
        for name in ROOTS:
            more = ", lagc_impact_work *a" if name == "impact" else ""
            given = "law, a" if name == "impact" else "law"
            head = f"int {name}(lagc_contact_law *law{more})"
            text += [f"{head};\n{head} {{ return lagc_{name}({given}); }}"]
        (folder / "law.c").write_text("\n".join(text) + "\n")
        words = ["gcc", *FLAGS, "-fPIC", "-shared", "law.c", "-o", "law.so", "-lm"]
        done = subprocess.run(words, cwd=folder, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        compiled = ctypes.CDLL(str(folder / "law.so"))
        records: dict[str, Any] = {}
        for record, members in self.members.items():
            fields = [(n, _ctype(kind, self.sizes, records)) for n, kind in members]
            records[record] = type(record, (ctypes.Structure,), {"_fields_": fields})

        def function(name: str) -> Any:
            return lambda *given: getattr(compiled, name)(*map(ctypes.byref, given))

        made = {"make": lambda: Workspace(lambda record: records[record]())}
        return {**made, **{name: _called(function(name), name) for name in ROOTS}}


def _called(kernel: Any, name: str) -> Any:
    """Return a kernel as a function of a workspace."""
    return lambda work: kernel(work.law, work.impact) if name == "impact" else kernel(work.law)


def _ctype(kind: tuple[str, ...], sizes: dict[str, int], records: dict[str, Any]) -> Any:
    if kind[0] == "Record":
        return records[kind[1]]
    plain: Any = _CTYPES[kind[0]]
    return plain * sizes[kind[1]] if len(kind) > 1 else plain


class Workspace:
    """The law of some contacts, and their impact."""

    def __init__(self, record: Callable[[str], Any]):
        self.law, self.impact = record("ContactLaw"), record("ImpactWork")


KERNELS = Kernels(8, 16)


@cache
def in_python() -> dict[str, Any]:
    return KERNELS.python()


def fill(w: Any, W: Any, b: Any, slips: Sequence[int], mu: Sequence[float], **more: Any) -> None:
    """Put a problem into a workspace. `more`: static, moves, direction, two_sided, restitution, poisson,
    mode, unit, by contact."""
    n, m = len(slips), len(b)
    assert m == n + sum(slips)
    law = w.law
    law.count, law.rows = n, m
    first = 0
    for i in range(n):
        law.unit[i] = more["unit"][i] if "unit" in more else 0
        law.first[i], law.slips[i], law.friction[i] = first, slips[i], mu[i]
        law.static_friction[i] = more["static"][i] if "static" in more else mu[i]
        law.sign[i] = 1
        law.mode[i] = more["mode"][i] if "mode" in more else -1
        for name in ("moves", "two_sided"):
            getattr(law, name)[i] = more[name][i] if name in more else 0
        for name in ("restitution", "poisson"):
            getattr(w.impact, name)[i] = more[name][i] if name in more else 0
        for k in range(2):
            law.direction[2 * i + k] = float(more["direction"][i][k]) if "direction" in more else 0.0
        first += 1 + slips[i]
    for j in range(m):
        law.b[j], law.terms[j] = float(b[j]), 0.0
        for k in range(m):
            law.W[j * m + k] = float(W[j][k])


def values(w: Any) -> dict[str, Any]:
    """Return what kernels found, of the contacts and rows of the problem."""
    law, n, m = w.law, w.law.count, w.law.rows
    return {
        "mode": list(law.mode[:n]), "p": np.array(law.p[:m]), "u": np.array(law.u[:m]),
        "direction": np.array(law.direction[: 2 * n]).reshape(n, 2),
        "loss": np.array(w.impact.loss[:n]), "rounds": w.impact.rounds,
    }  # fmt: skip
