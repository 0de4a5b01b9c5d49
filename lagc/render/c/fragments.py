"""The parts of the hand-written support (`support/`) that a model needs, as text.

`#if LAGC_...` in them asks for sizes of the model; what does not apply is left out here, so that
generated files hold no dead code.
"""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from math import isfinite

from lagc.optimize.program import Interface

START = (
    "leastnorm.c", "startrows.c", "starttable.c", "startalone.c", "startsteps.c", "startchoice.c",
    "startsearch.c", "start.c",
)  # fmt: skip
_FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "support")


def start_declarations(interface: Interface) -> str:
    """The function that makes a start consistent: for the header."""
    return resolve(_read("start.h"), interface)


def start_definitions(interface: Interface) -> list[str]:
    names = [name for name in START if name != "startalone.c" or sizes(interface)["NPOSITION"]]
    return [resolve(_read(name), interface) for name in names]


def sizes(interface: Interface) -> dict[str, int]:
    """What `#if` may ask for."""
    columns, begins = interface.condition_columns, (0, *interface.condition_ends)
    rows = [columns[begin:end] for begin, end in zip(begins, interface.condition_ends)]
    return {
        "NC": interface.nc, "NH": interface.nh, "NZ": interface.nz, "NQUAT": len(interface.quaternions),
        "NWORK": interface.work_size, "STRAIGHT": int(interface.solve == "straight"),
        "HAS_DISPLACE": int("displace" in interface.functions),
        "NCOND": len(interface.condition_ends), "NRATE": len(interface.rate_names),
        "NPOSITION": sum(max(row, default=0) < interface.nq for row in rows),
        "NBOUNDED": len(_bounded(interface)),
        "NLIMITS": len(interface.limits),
    }  # fmt: skip


def resolve(text: str, interface: Interface, complete: bool = True) -> str:
    """`text` without its #if, #else and #endif: only the branches that hold; and with the few
    numbers that only the support uses.  `complete`: with what a run of lagc does itself."""
    known = {**sizes(interface), "COMPLETE": int(complete)}
    lines: list[str] = []
    open_: list[bool] = []
    for line in text.splitlines(keepends=True):
        if line.startswith("#if "):
            open_.append(_holds(line[4:], known))
        elif line.startswith("#else"):
            open_[-1] = not open_[-1]
        elif line.startswith("#endif"):
            open_.pop()
        elif all(open_):
            lines.append(line)
    found = "".join(lines)
    for name, values in _numbers(interface).items():
        found = found.replace(f"LAGC_{name}", _wrapped(values))
    return re.sub(r"\n{3,}", "\n\n", found).lstrip("\n")


def _bounded(interface: Interface) -> list[int]:
    """The places of parameters that have bounds."""
    fields = (*interface.parameters, *interface.inputs)
    return [i for i, f in enumerate(fields) if isfinite(f.minimum) or isfinite(f.maximum)]


def _bound(value: float) -> str:
    return repr(float(value)) if isfinite(value) else "-HUGE_VAL" if value < 0.0 else "HUGE_VAL"


def _numbers(interface: Interface) -> dict[str, Sequence[int] | Sequence[str]]:
    """The numbers, and texts, that only the support uses."""
    fields, bounded = (*interface.parameters, *interface.inputs), _bounded(interface)
    ends, columns = list(interface.condition_ends), list(interface.condition_columns)
    for k in interface.quaternions:
        ends.append(len(columns) + 4)
        columns += range(k, k + 4)
    columns = columns or [0]  # C knows no empty array
    unknowns = range(len(interface.start_levels))
    return {
        "NJ": [len(columns)],
        "NCOND": [len(interface.condition_ends)], "NRATE": [len(interface.rate_names)],
        "START_LEVELS": interface.start_levels, "START_UNITS": interface.start_units,
        "START_ANGLES": [int(i in interface.angles) for i in unknowns],
        "START_ENDS": ends, "START_COLUMNS": columns,
    }  # fmt: skip


def _wrapped(values: Sequence[int] | Sequence[str]) -> str:
    """Numbers, or texts, with commas between, on lines that stay short."""
    few = 16 if values and isinstance(values[0], int) else 2
    lines = [", ".join(map(str, values[k : k + few])) for k in range(0, len(values), few)]
    return ",\n    ".join(lines)


def _holds(condition: str, known: dict[str, int]) -> bool:
    """`A || B` of sizes that are not zero."""
    return any(known[name.strip().removeprefix("LAGC_")] != 0 for name in condition.split("||"))


def _read(name: str) -> str:
    with open(os.path.join(_FOLDER, name), encoding="utf-8") as file:
        return file.read()
