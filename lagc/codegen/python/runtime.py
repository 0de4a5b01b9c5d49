"""The runtime of a model in Python: the kernels that it calls, its sizes and tables."""

from __future__ import annotations

import os
from collections.abc import Collection, Iterable, Sequence
from functools import cache
from typing import Any

from lagc.codegen.heading import rates, statuses
from lagc.codegen.kernel_compiler.linker import (
    Chosen,
    Part,
    chosen,
    codes,
    flags_of,
    methods_of,
    sizes_of,
    tables_of,
)
from lagc.codegen.kernel_compiler.shipped import parts
from lagc.codegen.python.classes import EQUATIONS, states
from lagc.kernels import DEFAULT_METHOD, METHODS
from lagc.lowering.program import Interface, Program

MARK = "# -- what follows is part of generated modules --\n"
SUPPORT = ("base.py", "slices.py")  # runs of lagc use them too
OF_CONTACTS = ("contacts.py",)
# Kernels of every model, and of models with constraints.
ROOTS = ("begin", "step", "dense", "advance", "record", "verified", "factor_safely", "system_at")
OF_SYSTEM = ("system_at",)  # if the program has the dense system
OF_ANY_RANK = ("factor_safely",)  # if it has the dense system or constraints
OF_ROWS = ("assemble_at", "solve_at")
SEARCH = ("prepare", "reach_start")  # initialization
GIVEN = ("Options",)  # records that are not printed: `support` has them
_COPY_STATE = """\
def fn_copy_state(s, kept):
    for name in State.__slots__:
        value = getattr(s, name)
        if isinstance(value, list):
            value = [part[:] if isinstance(part, list) else part for part in value]
        setattr(kept, name, value)
"""
_CONVOLVE = """\
def fn_convolve(k, left, right, squares, sums):
    found = [0.0] * NLANE
    for j in [*range(2, k - 1), *((1, k - 1) if k > 2 else (1,) if k > 1 else ())]:
        found = [s + a * b for s, a, b in zip(found, left[j], right[k - j])]
    half = [0.0] * NSQUARE
    for j in [*range(2, (k + 1) // 2), *((1,) if k > 2 else ())]:
        half = [s + a * b for s, a, b in zip(half, squares[j], squares[k - j])]
    half = [s + s for s in half]
    if k % 2 == 0:
        half = [s + a * a for s, a in zip(half, squares[k // 2])]
    sums[:] = found + half
"""
NUMBERS = ("int", "Real", "Code", "Method")  # kinds of parts
PUBLIC = ("NQ", "NV", "NZ", "NX", "NC", "NH", "NP", "NALL", "NY", "NWORK", "NMODE", "NWHEN")


def definitions(program: Program, complete: bool, given: frozenset[str]) -> list[str]:
    """Return sizes, tables, statuses, records, kernels and the classes that call them."""
    search = SEARCH if complete and program.interface.needs_consistency else ()
    checks = ("is_bound",) if complete and program.interface.prepared else ()
    use = _needed(program.interface, (*ROOTS, *search, *checks), complete)
    interface = program.interface
    more = support(OF_CONTACTS) if interface.contacts else ()
    return [_constants(interface, use, given), *_support(interface), *more, _work(program), *kernels(use),
            *([_CONVOLVE] if "fn_convolve" in use.names else ()),
            *([_observe(program)] if "fn_observe" in use.names else ()),
            *([_COPY_STATE] if "fn_copy_state" in use.names else ()), _equations(interface),
            states(bool(interface.contacts))]  # fmt: skip


def _equations(interface: Interface) -> str:
    return EQUATIONS.replace("rhs_at(", f"{rates(interface)}(")


def _support(interface: Interface) -> tuple[str, ...]:
    """Return the text of the support files, with a method that the module has as the default."""
    methods = methods_of(interface)
    if DEFAULT_METHOD in methods:
        return support()
    return tuple([text.replace(f'method: str = "{DEFAULT_METHOD}"', f'method: str = "{methods[0]}"')
                  for text in support()])  # fmt: skip


def evaluation(program: Program, given: frozenset[str]) -> list[str]:
    """Return the constants of the model, and the kernels that evaluate one state."""
    use = _needed(program.interface, ("factor_safely", "system_at"), False)
    own = "\n\n".join([_constants(program.interface, use, given), _work(program)])
    return [own, *kernels(use), _equations(program.interface)]


def _needed(interface: Interface, roots: Iterable[str], complete: bool) -> Chosen:
    more = (*(OF_ROWS if interface.nc else ()), *(("bind",) if interface.prepared else ()))
    if interface.follows:
        more += ("follow",)
    more += ("hold",) if interface.relations else ()
    more += ("seated",) if interface.contacts else ()
    more += ("assemble_slopes",) if interface.part_ends else ()
    dense = "system" in interface.functions
    more += (rates(interface),)
    without = {*(() if dense else OF_SYSTEM), *(() if dense or interface.nc else OF_ANY_RANK)}
    there = [root for root in roots if root not in without]
    return chosen(parts(), flags_of(interface, complete), (*there, *more), methods_of(interface))


def _constants(interface: Interface, use: Chosen, given: frozenset[str]) -> str:
    """Return sizes, tables, statuses and constants of kernels, without those that are `given`."""
    kinds = [kind for _, members in _records(use) for _, kind, *_ in members]
    used = {*use.names, *PUBLIC, *(size for kind in kinds for size in kind)}
    used |= (
        {part["name"] for part in codes(parts(), "initialization/workspace")}
        if "prepare" in use.names
        else set()
    )
    used -= given
    sizes = {**sizes_of(interface), "NY": len(interface.outputs)}
    text = "".join(f"{name} = {value}\n" for name, value in sizes.items() if name in used)
    text += f"STRAIGHT = {interface.solve == 'straight'}\n"
    text += f"NOTED = {interface.noted!r}\n" if interface.relations else ""
    text += "".join(f"{name} = {tuple(v)!r}\n" for name, v in tables_of(interface).items() if name in used)
    methods = {name: METHODS.index(name) for name in methods_of(interface)}
    used |= {part["name"] for part in statuses(interface)}
    return text + f"METHODS = {methods!r}\n" + numbers(used)


def numbers(used: Collection[str]) -> str:
    """Return the statuses and constants in `used`."""
    text = ""
    for part in parts():
        if (part["kind"] == "Status" and part["name"] in used) or (
            part["kind"] in NUMBERS and part["name"] in used
        ):
            text += f"{part['name']} = {part['python']}" + (f"  # {part['note']}\n" if part["note"] else "\n")
    return text


def kernels(use: Chosen) -> list[str]:
    """Return records and functions."""
    records = [_record(part["name"], part["doc"], members) for part, members in _records(use)]
    return [*records, *(leaf["python"] for _, leaf in use.functions)]


def _records(use: Chosen) -> list[tuple[Part, tuple[Sequence[Any], ...]]]:
    return [(part, members) for part, members in use.records if part["name"] not in GIVEN]


@cache
def support(names: tuple[str, ...] = SUPPORT) -> tuple[str, ...]:
    """Return the text of each support file from MARK on."""
    folder = os.path.join(os.path.dirname(os.path.abspath(__file__)), "support")
    found = []
    for name in names:
        with open(os.path.join(folder, name), encoding="utf-8") as file:
            found.append(file.read().partition(MARK)[2].strip("\n") + "\n")
    return tuple(found)


def _record(name: str, doc: str, members: Sequence[Sequence[Any]]) -> str:
    """Return a class with slots, filled with zeros."""
    about = "\n    ".join(doc.splitlines())
    slots = "".join(f'        "{m}",\n' for m, *_ in members)
    zeros = "".join(f"        self.{m} = {_zero(kind)}\n" for m, kind, *_ in members)
    head = f'class {name}:\n    """{about}"""\n\n    __slots__ = (\n{slots}    )\n'
    return f"{head}\n    def __init__(self):\n{zeros}"


def _zero(kind: Sequence[str]) -> str:
    if kind[0] == "Mat":
        return f"[[0.0] * {kind[2]} for _ in range({kind[1]})]"
    plain = {"Vec": f"[0.0] * {kind[-1]}", "IVec": f"[0] * {kind[-1]}", "Params": "[0.0] * NALL",
             "Real": "0.0"}  # fmt: skip
    plain["Record"] = f"{kind[-1]}()"
    return plain.get(kind[0], "False" if kind[0] == "bool" else "0")


def _observe(program: Program) -> str:
    """Return the function of the outputs at one state, with the arguments of the kernels."""
    function = program.functions["outputs"]
    given = {"a": "w.xdot[NQ : NQ + NV]", "lam": "w.lam", "modes": "w.modes",
             "contact_forces": "w.contact_forces"}  # fmt: skip
    first = "    e = [0.0] * 3\n    fn_energies(p, t, x, e)\n" if "e" in function.inputs else ""
    values = ", ".join(given.get(name, name) for name in function.inputs)
    return (f"def fn_observe(p, t, x, y, w):\n    {rates(program.interface)}(p, t, x, w.xdot, w.lam, w)\n"
            f"{first}    fn_{function.spelled}({values}, y)\n")  # fmt: skip


def _work(program: Program) -> str:
    """Return the rate of the work integral, with the arguments of the kernels."""
    if not program.interface.nz:
        return ""
    power = program.functions.get("power")
    body = f"fn_{power.spelled}({', '.join(power.inputs)}, e)" if power is not None else "e[0] = 0.0"
    name, modes = ("work_on", "modes, ") if program.interface.relations else ("work", "")
    forces = "contact_forces, " if program.interface.pushed_contacts else ""
    name = f"pushed_{name}" if forces else name
    return f"def fn_{name}(p, t, x, {modes}a, lam, {forces}e):\n    {body}\n"
