"""The parts of the hand-written support (`support/`) that a model needs, as text.

`#if LAGC_...` in them asks for sizes of the model; what does not apply is left out here, so that
generated files hold no dead code.
"""

from __future__ import annotations

import os
import re

from lagc.optimize.program import Interface, Program
from lagc.render.stages import c_functions, c_parts
from lagc.render.tableaus import DOP853, TABLEAUS

_FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "support")


def types(interface: Interface) -> str:
    """lagc_work, lagc_options, lagc_state: for the header."""
    return resolve(_read("types.h"), interface)


def declarations() -> str:
    """The functions that integrate: for the header."""
    return _read("integrate.h")


def definitions(program: Program) -> list[str]:
    """Everything behind them, and `lagc_rhs_`, `lagc_system_`, `lagc_assemble_`, `lagc_solve_`."""
    interface = program.interface
    names = ["dense.c"]
    names += ["fallback.c"] if interface.nc else []
    names += ["rhs.c"]
    names += ["projection.c"] if interface.nc or interface.quaternions else []
    parts = [_power(program), *(resolve(_read(name), interface) for name in names)]
    parts += [text for tableau in TABLEAUS for text in c_functions(tableau)]
    parts += [c_parts(DOP853)] if interface.nh else []
    parts += [resolve(_read(name), interface) for name in ("integrate.c", "record.c")]
    return [part for part in parts if part]


def sizes(interface: Interface) -> dict[str, int]:
    """What `#if` may ask for."""
    return {
        "NC": interface.nc, "NH": interface.nh, "NZ": interface.nz, "NQUAT": len(interface.quaternions),
        "NWORK": interface.work_size, "STRAIGHT": int(interface.solve == "straight"),
        "HAS_DISPLACE": int("displace" in interface.functions),
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
    found = "".join(lines).replace("LAGC_NWORK", str(interface.work_size))
    found = found.replace("LAGC_QUATERNIONS", ", ".join(str(i) for i in interface.quaternions))
    return re.sub(r"\n{3,}", "\n\n", found).lstrip("\n")


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
