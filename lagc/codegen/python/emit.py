"""Print a Program as one Python module.  It needs the standard library alone, and NumPy for `rhs_many`.

The module holds names, the functions of the model, the kernels (`runtime`) and public functions.
"""

from __future__ import annotations

from lagc.codegen.heading import ABI_VERSION, LICENCE, SPDX, equation, origin
from lagc.codegen.identifiers import Names, local_names, prefix
from lagc.codegen.kernel_compiler.library import sine_cosine_kernels
from lagc.codegen.python import runtime
from lagc.codegen.python.functions import ARITHMETIC, CALLS, function_text, sine_cosine
from lagc.codegen.python.public_functions import public_functions
from lagc.codegen.tables import numbered, python_tables
from lagc.lowering.program import Field, Interface, Program

_IMPORTS = """\
from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple
"""


def render(program: Program, complete: bool = True) -> dict[str, str]:
    """Return the text of `<model>.py` by file name.  Without `complete` it lacks the initialization and the
    bounds of parameters, which a run of lagc has."""
    program = program.shipped if complete else program
    file = f"{prefix(program.interface.model)}.py"
    names = local_names(program, (*CALLS.values(), "ArithmeticError", "ValueError"))
    numbers = numbered(program)
    parts = [_banner(program.interface, file), _IMPORTS + ARITHMETIC, _names(program.interface)]
    own = [function_text(f, names, numbers) for f in program.functions.values()]
    turn = sine_cosine_kernels(own, runtime.PYTHON)
    parts += [*python_tables(numbers), *sine_cosine(turn), *own]
    parts += runtime.definitions(program, complete, turn.names)
    if complete:
        parts.append(_bounds(program.interface))
    return {file: "\n\n".join([*filter(None, parts), *public_functions(program, complete)])}


def evaluation(program: Program) -> tuple[str, str]:
    """Return the texts of the functions of the model, and of the kernels that evaluate one state."""
    names = local_names(program, (*CALLS.values(), "ArithmeticError", "ValueError"))
    numbers = numbered(program)
    own = [function_text(f, names, numbers) for f in program.functions.values()]
    turn = sine_cosine_kernels(own, runtime.PYTHON)
    sizes, *shared = runtime.evaluation(program, turn.names)
    data, *search = python_tables(numbers) or [""]
    kernels = [ARITHMETIC, *search, *sine_cosine(turn), *shared]
    return "\n\n".join(filter(None, [_IMPORTS, data, sizes, *own])), "\n\n".join(kernels)


def _banner(interface: Interface, file: str) -> str:
    about = [*LICENCE, "", *(f"    {line}" for line in equation(interface)), ""]
    state = "x = (q, v, z, d), with discrete variables d" if interface.discretes else "x = (q, v, z)"
    about.append(f"SI units throughout.  A state is a list {state}.")
    title = origin(interface, file).replace('"', "'")
    return "\n".join([f"# {SPDX}", f'"""{title}', "", *about, '"""']) + "\n"


def member_names(interface: Interface) -> list[str]:
    """Return the keywords of `default_params`, of parameters, then inputs."""
    names = Names()
    return [names.give(f.name) for f in (*interface.parameters, *interface.inputs)]


def _names(interface: Interface) -> str:
    text = [f"ABI_VERSION = {ABI_VERSION}", f"MODEL_HASH = {interface.model_hash!r}"]
    text += _table("Q_NAMES", interface.q_names) + _table("V_NAMES", interface.v_names)
    if interface.discretes:
        text += _table("D_NAMES", [f.name for f in interface.discretes])
    text += _table("ROWS", interface.row_labels) + _table("Y_NAMES", [f.name for f in interface.outputs])
    fields = [*interface.parameters, *interface.inputs]
    text.append("PARAMETERS = {  # keyword: (value, unit, name in the model, description)")
    text += [f"    {n!r}: {_row(f)}," for n, f in zip(member_names(interface), fields)]
    return "\n".join([*text, "}"]) + "\n"


def _bounds(interface: Interface) -> str:
    fields = [*interface.parameters, *interface.inputs]
    rows = [f"    {n!r}: ({f.minimum!r}, {f.maximum!r}),\n" for n, f in zip(member_names(interface), fields)]
    derived = [f"    {f.name!r}: ({f.minimum!r}, {f.maximum!r}),\n" for f in interface.limits]
    text = ["BOUNDS = {  # keyword: (minimum, maximum)\n", *rows, "}\n"]
    if derived:
        text += ["LIMITS = {  # value computed from parameters: (minimum, maximum)\n", *derived, "}\n"]
    return "".join(text)


def _row(field: Field) -> str:
    value = "nan" if field.value is None else repr(float(field.value))
    return f"({value}, {field.unit!a}, {field.name!a}, {field.description!a})"


def _table(name: str, values: tuple[str, ...] | list[str]) -> list[str]:
    if len(values) <= 4:
        return [f"{name} = {tuple(values)!a}"]
    return [f"{name} = (", *(f"    {value!a}," for value in values), ")"]
