"""The runtime of a model in Python: the kernels that it calls, its sizes and tables."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from functools import cache

from lagc.codegen.heading import rates, statuses
from lagc.codegen.kernel_compiler.library import Chosen, library
from lagc.codegen.kernel_compiler.parts import Part
from lagc.codegen.sizes import flags_of, methods_of, sizes_of, tables_of
from lagc.kernels import DEFAULT_METHOD, METHODS
from lagc.lowering.program import Interface, Program

PYTHON = "python"  # the language
MARK = "# -- what follows is part of generated modules --\n"
SUPPORT = ("base.py", "slices.py")  # runs of lagc use them too
# Kernels of every model, and of models with constraints.
ROOTS = ("begin", "step", "dense", "advance", "record", "verified", "factor_safely", "system_at")
OF_SYSTEM = ("system_at",)  # if the program has the dense system
OF_ANY_RANK = ("factor_safely",)  # if it has the dense system or constraints
OF_ROWS = ("assemble_at", "solve_at")
SEARCH = ("prepare", "reach_start")  # initialization
GIVEN = ("Options",)  # records that are not printed: `support` has them
_COPY_STATE = """\
def fn_copy_state(s, kept):
    for name in s.__slots__:
        value, place = getattr(s, name), getattr(kept, name)
        if hasattr(value, "__slots__"):
            fn_copy_state(value, place)
        elif not isinstance(value, list):
            setattr(kept, name, value)
        elif value and isinstance(value[0], list):
            for row, other in zip(place, value):
                row[:] = other
        else:
            place[:] = value
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
PUBLIC = ("NQ", "NV", "NZ", "NX", "NC", "NH", "NP", "NALL", "NY", "NWORK", "NMODE", "NWHEN", "NHEALTH")


def definitions(program: Program, complete: bool, given: frozenset[str]) -> list[str]:
    """Return sizes, tables, statuses, records, kernels and the classes that call them."""
    search = SEARCH if complete and program.interface.needs_consistency else ()
    checks = ("is_bound",) if complete and program.interface.prepared else ()
    use = _needed(program.interface, (*ROOTS, *search, *checks), complete)
    interface = program.interface
    more = support(("contacts.py" if interface.contacts else "plain.py",))
    return [_constants(interface, use, given), *_support(interface), *more, _work(program), *kernels(use),
            *([_CONVOLVE] if "fn_convolve" in use.names else ()),
            *([_observe(program)] if "fn_observe" in use.names else ()),
            *([_COPY_STATE] if "fn_copy_state" in use.names else ()), _equations(interface),
            *support(("integrator.py",))]  # fmt: skip


def _equations(interface: Interface) -> str:
    (text,) = support(("equations.py",))
    return text.replace("rhs_at(", f"{rates(interface)}(")


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
    return library(PYTHON).chosen((*there, *more), flags_of(interface, complete))


def _constants(interface: Interface, use: Chosen, given: frozenset[str]) -> str:
    """Return sizes, tables, statuses and constants of kernels, without those that are `given`."""
    kernels = library(PYTHON)
    kinds = [kind for part in _records(use) for _, kind, *_ in part.members]
    used = {*use.names, *PUBLIC, *(size for kind in kinds for size in kind)} - given
    constants = [part for part in use.constants if part.name not in given]
    if "prepare" in use.names:
        constants += kernels.constants("initialization/workspace", "Code")
    sizes = {**sizes_of(interface), "NY": len(interface.outputs)}
    text = "".join(f"{name} = {value}\n" for name, value in sizes.items() if name in used)
    text += f"STRAIGHT = {interface.solve == 'straight'}\n"
    text += f"NOTED = {interface.noted!r}\n" if interface.relations else ""
    text += "".join(f"{name} = {tuple(v)!r}\n" for name, v in tables_of(interface).items() if name in used)
    methods = {name: METHODS.index(name) for name in methods_of(interface)}
    return text + f"METHODS = {methods!r}\n" + numbers([*constants, *statuses(kernels, interface)])


def numbers(constants: Iterable[Part]) -> str:
    """Return constants and statuses, in the order of the files."""
    text = ""
    named = {part.name: part for part in constants}
    for part in sorted(named.values(), key=lambda part: tuple(part.place)):
        text += f"{part.name} = {part.text}" + (f"  # {part.note}\n" if part.note else "\n")
    return text


def kernels(use: Chosen) -> list[str]:
    """Return records and functions."""
    return [*map(_record, _records(use)), *(part.text for part in use.functions)]


def _records(use: Chosen) -> list[Part]:
    return [part for part in use.records if part.name not in GIVEN]


@cache
def support(names: tuple[str, ...] = SUPPORT) -> tuple[str, ...]:
    """Return the text of each support file from MARK on."""
    folder = os.path.join(os.path.dirname(os.path.abspath(__file__)), "support")
    found = []
    for name in names:
        with open(os.path.join(folder, name), encoding="utf-8") as file:
            found.append(file.read().partition(MARK)[2].strip("\n") + "\n")
    return tuple(found)


def _record(part: Part) -> str:
    """Return a class with slots, filled with zeros."""
    about = "\n    ".join(part.note.splitlines())
    slots = "".join(f'        "{m}",\n' for m, *_ in part.members)
    zeros = "".join(f"        self.{m} = {_zero(kind)}\n" for m, kind, *_ in part.members)
    head = f'class {part.name}:\n    """{about}"""\n\n    __slots__ = (\n{slots}    )\n'
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
             "contact_forces": "w.contacts.forces"}  # fmt: skip
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
