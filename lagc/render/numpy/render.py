"""Program -> one Python module that needs only Python's own library (NumPy for many states at once).

Layout of the module: what it is, sizes and names, functions of the model (printed from the
Program), the support text that every model shares (the files of `support`, from the line
MARK on), and the verbs of `verbs.py` that a caller uses.
"""

from __future__ import annotations

import os
from functools import cache

from lagc.optimize.program import Field, Interface, Program
from lagc.render.heading import ABI_VERSION, LICENCE, SPDX, equation, origin
from lagc.render.locals import local_names
from lagc.render.names import Names, prefix
from lagc.render.numpy.functions import ARITHMETIC, CALLS, function_text
from lagc.render.numpy.verbs import verbs

MARK = "# -- what follows is part of generated modules --\n"
SUPPORT = ("base.py", "fallback.py", "sizes.py", "linear.py", "stages.py", "quaternions.py", "projection.py",
           "listening.py", "integrate.py", "record.py")  # fmt: skip
START = ("leastnorm.py", "startrows.py", "starttable.py", "startalone.py", "startsteps.py", "startchoice.py",
         "start.py")  # fmt: skip
_IMPORTS = """\
from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple
"""


def render(program: Program, complete: bool = True) -> dict[str, str]:
    """File name -> text; one file, `<model>.py`.  Unless `complete` it lacks what a run of `lagc` has
    already: the search for a consistent start, the bounds of parameters."""
    file = f"{prefix(program.interface.model)}.py"
    names = local_names(program, (*CALLS.values(), "ArithmeticError", "ValueError"))
    parts = [_banner(program.interface, file), _IMPORTS + ARITHMETIC, _constants(program.interface)]
    parts += [function_text(f, names) for f in program.functions.values()]
    consistency = complete and program.interface.needs_consistency
    if complete:
        parts.append(_bounds(program.interface))
    if consistency:
        parts.append(_start_tables(program.interface))
    support = _support((*SUPPORT, *START) if consistency else SUPPORT)
    return {file: "\n\n".join([*parts, *support, *verbs(program, complete)])}


def functions(program: Program) -> str:
    """The sizes and functions of the model alone, for whoever has the support as modules."""
    names = local_names(program, (*CALLS.values(), "ArithmeticError", "ValueError"))
    parts = [_IMPORTS + ARITHMETIC, _constants(program.interface)]
    parts += [function_text(f, names) for f in program.functions.values()]
    return "\n\n".join(parts)


def _banner(interface: Interface, file: str) -> str:
    about = [*LICENCE, "", *(f"    {line}" for line in equation(interface)), ""]
    about.append("SI units throughout.  States are lists x = (q, v, z).")
    title = origin(interface, file).replace('"', "'")
    return "\n".join([f"# {SPDX}", f'"""{title}', "", *about, '"""']) + "\n"


def member_names(interface: Interface) -> list[str]:
    """Keywords of `default_params`: the parameters', then the inputs'."""
    names = Names()
    return [names.give(f.name) for f in (*interface.parameters, *interface.inputs)]


def _constants(interface: Interface) -> str:
    sizes = {
        "NQ": interface.nq, "NV": interface.nv, "NZ": interface.nz, "NX": interface.nx, "NC": interface.nc,
        "NH": interface.nh, "NY": len(interface.outputs), "NWORK": interface.work_size,
        "STRAIGHT": int(interface.solve == "straight"),
        "HAS_DISPLACE": int("displace" in interface.functions),
    }  # fmt: skip
    text = [f"ABI_VERSION = {ABI_VERSION}", f"MODEL_HASH = {interface.model_hash!r}"]
    text += [f"{name} = {value}" for name, value in sizes.items()]
    text.append(f"QUATERNIONS = {interface.quaternions!r}")
    text.append(f"KINDS = {interface.kinds!r}")
    text += _table("Q_NAMES", interface.q_names) + _table("V_NAMES", interface.v_names)
    text += _table("ROWS", interface.row_labels) + _table("Y_NAMES", [f.name for f in interface.outputs])
    fields = [*interface.parameters, *interface.inputs]
    text.append("PARAMETERS = {  # keyword: (value, unit, name in the model, what it is)")
    text += [f"    {n!r}: {_row(f)}," for n, f in zip(member_names(interface), fields)]
    return "\n".join([*text, "}"]) + "\n"


def _start_tables(interface: Interface) -> str:
    """What the search for a consistent start knows of the model (see `Conditions`)."""
    return "".join(
        f"{name} = {values!r}\n"
        for name, values in (
            ("LEVELS", interface.start_levels),
            ("UNITS", interface.start_units),
            ("ANGLES", interface.angles),
            ("CONDITION_ENDS", interface.condition_ends),
            ("CONDITION_COLUMNS", interface.condition_columns),
        )
    )


def _bounds(interface: Interface) -> str:
    fields = [*interface.parameters, *interface.inputs]
    rows = [f"    {n!r}: ({f.minimum!r}, {f.maximum!r}),\n" for n, f in zip(member_names(interface), fields)]
    derived = [f"    {f.name!r}: ({f.minimum!r}, {f.maximum!r}),\n" for f in interface.limits]
    text = ["BOUNDS = {  # keyword: (least, largest)\n", *rows, "}\n"]
    if derived:
        text += ["LIMITS = {  # value made of parameters: (least, largest)\n", *derived, "}\n"]
    return "".join(text)


def _row(field: Field) -> str:
    value = "nan" if field.value is None else repr(float(field.value))
    return f"({value}, {field.unit!a}, {field.name!a}, {field.description!a})"


def _table(name: str, values: tuple[str, ...] | list[str]) -> list[str]:
    if len(values) <= 4:
        return [f"{name} = {tuple(values)!a}"]
    return [f"{name} = (", *(f"    {value!a}," for value in values), ")"]


@cache
def _support(names: tuple[str, ...]) -> tuple[str, ...]:
    """The shared text; each file from MARK on, without the protocol, which generated modules do not hold."""
    folder = os.path.join(os.path.dirname(os.path.abspath(__file__)), "support")
    parts = []
    for name in names:
        with open(os.path.join(folder, name), encoding="utf-8") as file:
            text = file.read().partition(MARK)[2].strip("\n") + "\n"
        parts.append(text.replace(": Problem", ""))
    return tuple(parts)
