"""The contact kernels alone, compiled from their C text or run as their Python text."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from lagc.codegen.kernel_compiler.c import CPrinter
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
        own = {"NCON": contacts, "NSLIP": slips, "NPOISSON": 1}
        derived = ("NCROW", "NDELASSUS", "NDIRECT", "NLAW", "NLAWS")
        own.update({name: DERIVED[name](own) for name in derived})
        self.flags = {flag: flag in own for flag in definitions().sizes}
        self.sizes = {**own, "TWO": 2}
        (record,) = library("double").chosen(ROOTS, self.flags).records
        members = record.members
        self.members = [(n, tuple(kind)) for n, kind, *_ in members if n.startswith(("law_", "impact_"))]

    def python(self) -> dict[str, Any]:
        """Return the kernels in Python, with `make`, which returns a workspace."""
        space: dict[str, Any] = {**self.sizes, "make": lambda: _Fields(self.members, self.sizes)}
        use = library("python").chosen(ROOTS, self.flags)
        text = [ARITHMETIC, numbers(use.constants), *(part.text for part in use.functions)]
        exec("\n".join(text), space)
        return space

    def c(self, folder: Path) -> dict[str, Any]:
        """Return the kernels compiled by gcc, likewise."""
        printer, use = CPrinter(DOUBLE, SPELLED, {}), library("double").chosen(ROOTS, self.flags)
        numbers = {"NCON": self.sizes["NCON"], "NSLIP": self.sizes["NSLIP"]}
        numbers.update({part.name: part.text for part in use.constants})
        text = ["#include <math.h>", "#include <stddef.h>"]
        text += [f"#define LAGC_{name} {value}" for name, value in numbers.items()]
        text += ["typedef struct {"]
        text += [f"    {printer.declared(kind, name)};" for name, kind in self.members]
        text += ["} lagc_work;", *(part.text for part in use.functions)]
        text += [f"int {n}(lagc_work *w);\nint {n}(lagc_work *w) {{ return lagc_{n}(w); }}" for n in ROOTS]
        (folder / "law.c").write_text("\n".join(text) + "\n")
        words = ["gcc", *FLAGS, "-fPIC", "-shared", "law.c", "-o", "law.so", "-lm"]
        done = subprocess.run(words, cwd=folder, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        compiled = ctypes.CDLL(str(folder / "law.so"))
        fields = [(n, _ctype(kind, self.sizes)) for n, kind in self.members]
        work = type("Work", (ctypes.Structure,), {"_fields_": fields})

        def call(name: str) -> Any:
            return lambda w: getattr(compiled, name)(ctypes.byref(w))

        return {"make": work, **{name: call(name) for name in ROOTS}}


def _ctype(kind: tuple[str, ...], sizes: dict[str, int]) -> Any:
    plain: Any = _CTYPES[kind[0]]
    return plain * sizes[kind[1]] if len(kind) > 1 else plain


class _Fields:
    def __init__(self, members: Sequence[tuple[str, tuple[str, ...]]], sizes: dict[str, int]):
        for name, kind in members:
            zero: Any = 0.0 if kind[0] in ("Real", "Vec") else 0
            setattr(self, name, [zero] * sizes[kind[1]] if len(kind) > 1 else zero)


KERNELS = Kernels(8, 16)


@cache
def in_python() -> dict[str, Any]:
    return KERNELS.python()


def fill(w: Any, W: Any, b: Any, slips: Sequence[int], mu: Sequence[float], **more: Any) -> None:
    """Put a problem into a workspace. `more`: static, moves, direction, two_sided, restitution, poisson,
    mode, by contact."""
    n, m = len(slips), len(b)
    assert m == n + sum(slips)
    w.law_count, w.law_rows = n, m
    first = 0
    for i in range(n):
        w.law_unit[i] = 0
        w.law_first[i], w.law_slips[i], w.law_friction[i] = first, slips[i], mu[i]
        w.law_static[i] = more["static"][i] if "static" in more else mu[i]
        w.law_sign[i] = 1
        w.law_mode[i] = more["mode"][i] if "mode" in more else -1
        for name in ("moves", "two_sided", "restitution", "poisson"):
            getattr(w, f"law_{name}")[i] = more[name][i] if name in more else 0
        for k in range(2):
            w.law_direction[2 * i + k] = float(more["direction"][i][k]) if "direction" in more else 0.0
        first += 1 + slips[i]
    for j in range(m):
        w.law_b[j], w.law_sizes[j] = float(b[j]), 0.0
        for k in range(m):
            w.law_w[j * m + k] = float(W[j][k])


def values(w: Any) -> dict[str, Any]:
    """Return what kernels found, of the contacts and rows of the problem."""
    n, m = w.law_count, w.law_rows
    return {
        "mode": list(w.law_mode[:n]), "p": np.array(w.law_p[:m]), "u": np.array(w.law_u[:m]),
        "direction": np.array(w.law_direction[: 2 * n]).reshape(n, 2), "impulse": np.array(w.law_impulse[:m]),
        "loss": np.array(w.law_loss[:n]), "rounds": w.law_rounds,
    }  # fmt: skip
