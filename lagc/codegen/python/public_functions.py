"""The public functions of a generated module: those of `support/evaluations.py` that apply to its model."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from lagc.codegen.heading import status_texts
from lagc.codegen.kernel_compiler.library import library
from lagc.codegen.python.runtime import PYTHON, support
from lagc.lowering.program import Interface, Program

ALWAYS = ("default_params", "rhs", "accelerations", "integrate", "equations", "_solved", "_floats", "_state",
          "rhs_many", "_vectorised")  # fmt: skip
WITH = {  # function of the program -> public functions
    "start": ("start",), "system": ("mass_matrix", "forces"), "energies": ("energies",),
    "outputs": ("outputs",), "along": ("along",),
}  # fmt: skip


def public_functions(program: Program, complete: bool) -> list[str]:
    """Return the texts of tables and functions; `complete` adds those that no run of lagc calls."""
    interface = program.interface
    wanted = {*ALWAYS}.union(*(names for function, names in WITH.items() if function in program.functions))
    if complete:
        wanted |= {"check", "consistent"} if interface.needs_consistency else {"check"}
    if interface.nc and "system" in program.functions:
        wanted.add("constraints")
    if interface.differentiated:
        wanted |= {"stack", "_at_state", "derivatives"} if interface.derivatives else {"stack", "_at_state"}
    (text,) = support(("evaluations.py",))
    # Two empty lines are between functions, and nowhere else. To parse the file would take longer.
    found = {re.search(r"\w+(?=\()", part)[0]: part for part in text.split("\n\n\n")}  # type: ignore[index]
    return [_tables(interface), *(part.strip("\n") + "\n" for name, part in found.items() if name in wanted)]


def _tables(interface: Interface) -> str:
    """Return the meanings of statuses, and the rows and places of derivatives."""
    texts = status_texts(library(PYTHON), interface)
    text = "".join(["STATUSES = (\n", *(f"    {text!r},\n" for text in texts), ")\n"])
    if interface.differentiated:
        parts = [f"    {name!r}: {part!r},\n" for name, part in interface.stack.items()]
        text += "".join(["STACK = {  # rows of the derivatives\n", *parts, "}\n"])
    return text + (_patterns(interface.derivatives) if interface.derivatives else "")


def _patterns(patterns: Mapping[str, Sequence[tuple[int, int]]]) -> str:
    from textwrap import fill  # only for models with derivatives

    text = ["PATTERNS = {  # (row, column) of each\n"]
    for name, pattern in patterns.items():
        places = fill(", ".join(map(repr, pattern)), 100, initial_indent=" " * 8, subsequent_indent=" " * 8)
        text.append(f"    {name!r}: [\n{places}\n    ],\n" if pattern else f"    {name!r}: [],\n")
    return "".join([*text, "}\n"])
