"""The parts of the hand-written support (`support/`) that a model needs, as text.

`#if LAGC_...` in them asks for sizes of the model; what does not apply is left out here, so that
generated files hold no dead code.
"""

from __future__ import annotations

import os
import re
from collections.abc import Sequence

from lagc.optimize.program import Interface, Program
from lagc.render.stages import c_functions, c_parts
from lagc.render.tableaus import DOP853, TABLEAUS

START = (
    "leastnorm.c", "startrows.c", "starttable.c", "startalone.c", "startsteps.c", "startchoice.c",
    "startsearch.c", "start.c",
)  # fmt: skip
_FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "support")


def types(interface: Interface) -> str:
    """lagc_work, lagc_options, lagc_state: for the header."""
    return resolve(_read("types.h"), interface)


def declarations() -> str:
    """The functions that integrate: for the header."""
    return _read("integrate.h")


def start_declarations(interface: Interface) -> str:
    """The function that makes a start consistent: for the header."""
    return resolve(_read("start.h"), interface)


def start_definitions(interface: Interface) -> list[str]:
    names = [name for name in START if name != "startalone.c" or sizes(interface)["NPOSITION"]]
    return [resolve(_read(name), interface) for name in names]


def definitions(program: Program) -> list[str]:
    """Everything behind them, and `lagc_rhs_`, `lagc_system_`, `lagc_assemble_`, `lagc_solve_`."""
    interface = program.interface
    names = ["sizes.c", "dense.c"]
    names += ["fallback.c"] if interface.nc else []
    names += ["rhs.c"]
    names += ["quaternions.c"] if interface.quaternions else []
    names += ["projection.c"] if interface.nc or interface.quaternions else []
    parts = [_power(program), *(resolve(_read(name), interface) for name in names)]
    parts += [text for tableau in TABLEAUS for text in c_functions(tableau)]
    parts += [c_parts(DOP853)] if interface.nh else []
    parts += [resolve(_read(name), interface) for name in ("weights.c", "integrate.c", "record.c")]
    return [part for part in parts if part]


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
    }  # fmt: skip


def resolve(text: str, interface: Interface) -> str:
    """`text` without its #if, #else and #endif: only the branches that hold; and with the few
    numbers that only the support uses."""
    known = sizes(interface)
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


def _numbers(interface: Interface) -> dict[str, Sequence[int]]:
    """The numbers that only the support uses."""
    ends, columns = list(interface.condition_ends), list(interface.condition_columns)
    for k in interface.quaternions:
        ends.append(len(columns) + 4)
        columns += range(k, k + 4)
    columns = columns or [0]  # C knows no empty array
    unknowns = range(len(interface.start_levels))
    return {
        "KINDS_OF_X": interface.kinds, "KINDS": [max(interface.kinds) + 1],
        "NWORK": [interface.work_size], "QUATERNIONS": interface.quaternions, "NJ": [len(columns)],
        "NCOND": [len(interface.condition_ends)], "NRATE": [len(interface.rate_names)],
        "START_LEVELS": interface.start_levels, "START_UNITS": interface.start_units,
        "START_ANGLES": [int(i in interface.angles) for i in unknowns],
        "START_ENDS": ends, "START_COLUMNS": columns,
    }  # fmt: skip


def _wrapped(values: Sequence[int]) -> str:
    """Numbers with commas between, on lines that stay short."""
    lines = [", ".join(map(str, values[k : k + 16])) for k in range(0, len(values), 16)]
    return ",\n    ".join(lines)


def _holds(condition: str, known: dict[str, int]) -> bool:
    """`A || B` of sizes that are not zero."""
    return any(known[name.strip().removeprefix("LAGC_")] != 0 for name in condition.split("||"))


def _power(program: Program) -> str:
    """How the support finds the rate of the work integral, from inside `lagc_rhs_dense`."""
    if not program.interface.nz:
        return ""
    power = program.functions.get("power")
    if power is None:
        return "#define LAGC_POWER(e) ((e)[0] = 0.0)\n"
    return f"#define LAGC_POWER(e) lagc_fn_power({', '.join(power.inputs)}, e)\n"


def _read(name: str) -> str:
    with open(os.path.join(_FOLDER, name), encoding="utf-8") as file:
        return file.read()
