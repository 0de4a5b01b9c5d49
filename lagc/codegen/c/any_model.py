"""Functions and tables with which a caller uses any model without knowing it: functions that have nothing to
do in this one, and the members of the structs for other languages."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence

from lagc.codegen.c.header import members
from lagc.codegen.c.public_functions import POINT, PublicFunction
from lagc.codegen.kernel_compiler.c_declarations import ignored
from lagc.lowering.program import Interface

START_WORK = """\
/* Workspace of lagc_consistent, which has nothing to do in this model. */
typedef struct {
    int culprit;
} lagc_start_work;
"""
TABLE = """\
/* A member of a struct, or an entry of an array, for callers in other languages. */
typedef struct {
    const char *record; /* "params", "options", "state", "work"; "x", "y", "lambda" for arrays of reals */
    const char *name; /* in x, y, lambda and params that of the model */
    const char *unit; /* in SI; "" for numbers */
    const char *type; /* "real", "int" or "long" */
    size_t offset; /* in bytes, from the beginning of the struct or array */
    size_t length; /* entries; 1 if the member is no array */
} lagc_member;
"""


_STATE = "const lagc_params *p, lagc_real t, lagc_real *x"
_IDLE = {  # name: why it has nothing to do, result, arguments
    "bind": ("prepares no numbers", "void", "lagc_params *p"),
    "consistent": ("has consistent start values", "lagc_status",
                   f"{_STATE}, const int *levels, lagc_start_work *w"),
    "outputs": ("has no outputs", "lagc_status", f"{POINT}, lagc_real *y, lagc_work *w"),
    "constraints": ("has no constraint equations", "void",
                    f"{POINT}, lagc_real *phi, lagc_real *psi, lagc_real *G, lagc_real *gamma, lagc_work *w"),
    "hold": ("has no relations", "void", f"{POINT}, lagc_work *w"),
    "gaps": ("has no contacts", "void", f"{POINT}, lagc_real *g"),
    "seated": ("has no contacts", "void", f"{_STATE}, lagc_work *w"),
}  # fmt: skip


def functions_without_work(interface: Interface) -> list[PublicFunction]:
    """Return the functions that other models need, with nothing to do in this one."""
    needed = {
        "bind": interface.prepared, "consistent": interface.needs_consistency, "outputs": interface.outputs,
        "constraints": interface.nc, "hold": interface.relations, "gaps": interface.contacts,
        "seated": interface.contacts,
    }  # fmt: skip
    found = [_idle(name, *_IDLE[name]) for name, need in needed.items() if not need]
    if "displace" not in interface.functions:
        found.append(PublicFunction(
            "dq[NQ] = d[NV]: the speeds are the rates of the coordinates.",
            f"void lagc_displace({POINT}, const lagc_real *d, lagc_real *dq)",
            "    int i;\n    (void)p; (void)t; (void)x;\n"
            "    for (i = 0; i < LAGC_NQ; i++) {\n        dq[i] = d[i];\n    }\n"))  # fmt: skip
    return found


def _idle(name: str, why: str, result: str, arguments: str) -> PublicFunction:
    """Return a function that ignores its arguments."""
    body = f"    {ignored(re.split(r'[ *]', given)[-1] for given in arguments.split(', '))}\n"
    does, end = ("Do nothing", "") if result == "void" else ("Return OK", "    return LAGC_OK;\n")
    return PublicFunction(f"{does}: this model {why}.", f"{result} lagc_{name}({arguments})", body + end)


def member_table(
    interface: Interface, records: Mapping[str, Sequence[tuple[str, str, int]]]
) -> list[PublicFunction]:
    """Return the functions that tell the sizes and members of the structs.  `records`: name, type and length
    of the members of each struct but that of the parameters."""
    rows = _entries("x", [*zip(interface.state_names, interface.state_units)])
    first = interface.nx - len(interface.discretes)
    rows += _entries("x", [(field.name, field.unit) for field in interface.discretes], first)
    rows += _entries("y", [(field.name, field.unit) for field in interface.outputs])
    rows += _entries("lambda", [*zip(interface.row_labels, interface.row_units)])
    fields = (*interface.parameters, *interface.inputs)
    rows += [_row("params", field.name, field.unit, "real", f"offsetof(lagc_params, {member})", "1")
             for member, field in zip(members(interface), fields)]  # fmt: skip
    for record, found in records.items():
        rows += [_row(record, name, "", kind, f"offsetof(lagc_{record}, {name})", str(length))
                 for name, kind, length in found]  # fmt: skip
    body = "".join(f"        {row},\n" for row in rows)
    return [
        PublicFunction("Return the size of lagc_params in bytes.", "size_t lagc_params_size(void)",
                       "    return sizeof(lagc_params);\n"),
        PublicFunction("Return a table, whose last row has the name NULL.",
                       "const lagc_member *lagc_members(void)",
                       f"    static const lagc_member rows[] = {{\n{body}"
                       "        {NULL, NULL, NULL, NULL, 0, 0}\n    };\n    return rows;\n")]  # fmt: skip


def _entries(array: str, named: Iterable[tuple[str, str]], first: int = 0) -> list[str]:
    return [_row(array, name, unit, "real", f"{k} * sizeof(lagc_real)", "1")
            for k, (name, unit) in enumerate(named, first)]  # fmt: skip


def _row(record: str, name: str, unit: str, kind: str, offset: str, length: str) -> str:
    return f'{{"{record}", {quoted(name)}, {quoted(unit)}, "{kind}", {offset}, {length}}}'


def quoted(text: str) -> str:
    """Return a string of C in ASCII with the bytes of `text` in UTF-8.  It has no trigraph, and no prefix
    that becomes that of the model."""
    spelled = [chr(c) if 32 <= c < 127 and chr(c) not in '"\\?' else f"\\{c:03o}" for c in text.encode()]
    return '"' + re.sub(r"[lL](?=agc_|AGC_)", lambda found: f"\\{ord(found[0]):03o}", "".join(spelled)) + '"'
