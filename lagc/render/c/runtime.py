"""The runtime of a model in C: the kernels that it needs, with its sizes and tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite
from textwrap import fill
from typing import Any

from lagc.kernels import METHODS
from lagc.optimize.program import Interface, Program
from lagc.render.c import header
from lagc.render.kernels.arithmetic import DOUBLE, Arithmetic
from lagc.render.kernels.assembly import DERIVED, Chosen, chosen, sizes_of, switches_of, tables_of
from lagc.render.kernels.names import snake
from lagc.render.kernels.shipped import parts
from lagc.render.statuses import STATUSES
from lagc.render.turning import turning

# Public kernels that every model has; those of a run of lagc's own are the last.
ROOTS = ("begin", "step", "dense", "advance", "record", "check")
OF_VERBS = ("rhs_at", "system_at", "assemble_at", "solve_at")  # called by what `verbs` writes
PUBLIC_RECORDS = ("Work", "Options", "State", "StartWork")


def needed(program: Program, complete: bool, real: Arithmetic = DOUBLE) -> Chosen:
    functions = program.functions
    roots = [name for name in ROOTS if complete or name != "check"]
    roots += ["consistent"] if complete and program.interface.needs_consistency else []
    roots += [name for name in OF_VERBS[:2] if name != "system_at" or "system" in functions]
    roots += OF_VERBS[2:] if program.interface.nc and "scales" in functions else []
    return chosen(parts(real), switches_of(program.interface, complete), roots)


def types(interface: Interface, complete: bool, real: Arithmetic = DOUBLE) -> str:
    """lagc_work, lagc_method, lagc_options, lagc_state, the culprits of INVALID, and what the search for a
    start has: for the header."""
    found = [_record("Work", interface, real), _methods(), _record("Options", interface, real)]
    found += [_codes("records"), _record("State", interface, real)]
    if complete and interface.needs_consistency:
        found += [_codes("startrecords"), _record("StartWork", interface, real)]
    return "\n".join(found)


def declarations(program: Program, complete: bool, real: Arithmetic = DOUBLE) -> str:
    """The functions that integrate: for the header."""
    found = ["lagc_options lagc_default_options(void);\n"
             "size_t lagc_work_size(void);\nsize_t lagc_state_size(void);\n"]  # fmt: skip
    found += ["/* What a status means, in English; of a number that is none, too. */\n"
              "const char *lagc_status_text(int status);\n"] if complete else []  # fmt: skip
    for part, _ in needed(program, complete, real).parts:
        if part["public"]:
            lead = _comment("\n".join(part["lead"]))
            found.append((lead + "\n" if lead else "") + _comment(part["doc"]) + part["head"] + ";\n")
    return "\n".join(found)


def definitions(program: Program, complete: bool, real: Arithmetic = DOUBLE) -> list[str]:
    """Everything behind them."""
    interface, use = program.interface, needed(program, complete, real)
    values = tables_of(interface)
    sizes, public = sizes_of(interface), {name for name, _, _ in header.sizes(interface)}
    own = [n for n in sizes if n in use.names and n not in public and n not in DERIVED]
    found = ["".join(f"#define LAGC_{name} {sizes[name]}\n" for name in own), _work(program)]
    found += [_table(name, values[name]) for name in values if name in use.names]
    records = [p["name"] for p in parts(real) if p["kind"] == "record" and p["name"] not in PUBLIC_RECORDS]
    found += [_record(name, interface, real) for name in records
              if any(f"lagc_{snake(name)} " in leaf["c"] for _, leaf in use.parts)]  # fmt: skip
    found += _printed(use, real)
    found.append(_defaults(complete, real))
    return [part for part in found if part]


def sine_cosine(program: Program, real: Arithmetic = DOUBLE) -> list[str]:
    """The kernel that functions of the model call for their sines and cosines."""
    return _printed(turning(program), real) if real == DOUBLE else []


def _printed(use: Chosen, real: Arithmetic) -> list[str]:
    """Constants and functions, each file with its title."""
    found = list[str]()
    chosen_texts = {part["name"]: leaf["c"] for part, leaf in use.parts}
    section, held = "", list[str]()
    for part in parts(real):
        if part["kind"] == "file":
            found += [section, "".join(held)] if held else []
            section = _section(part["title"], part["text"])
            held = []
        elif part["kind"] in ("int", "Real", "Reals") and part["name"] in use.names:
            held.append(_constant(part))
        elif part["kind"] == "function" and part["name"] in chosen_texts:
            found += [section] if section else []
            found += ["".join(held)] if held else []
            found.append(chosen_texts[part["name"]])
            section, held = "", []
    return found


def _table(name: str, values: Sequence[Any]) -> str:
    if name in ("bounds", "derived_bounds"):
        rows = ",\n    ".join(f"{{{_bound(low)}, {_bound(high)}}}" for low, high in values)
        return f"static const lagc_real lagc_{name}[][2] = {{\n    {rows}\n}};\n"
    rows = ",\n    ".join(", ".join(map(str, values[k : k + 16])) for k in range(0, len(values), 16))
    inner = f"\n    {rows}\n" if "\n" in rows else rows
    return f"static const int lagc_{name}[] = {{{inner}}};\n"


def _bound(value: float) -> str:
    return repr(float(value)) if isfinite(value) else "-HUGE_VAL" if value < 0.0 else "HUGE_VAL"


def _record(name: str, interface: Interface, real: Arithmetic) -> str:
    """A struct; C has no arrays of nothing."""
    part = next(p for p in parts(real) if p["kind"] == "record" and p["name"] == name)
    switches, public = switches_of(interface, True), {name for name, _, _ in header.sizes(interface)}
    sizes = {
        n: max(size, 1)
        for n, size in sizes_of(interface).items()
        if size == 0 or n not in {*public, *DERIVED}
    }
    lines = []
    for member, kind, when, lead, trail in part["members"]:
        if all(switches[switch] == value for switch, value in when):
            lines += [f"    {line}" for line in _comment("\n".join(lead)).splitlines()]
            lines.append(f"    {_room(kind, member, sizes, real)};" + (f" /* {trail} */" if trail else ""))
    body = "\n".join(lines)
    return f"{_comment(part['doc'])}typedef struct {{\n{body}\n}} lagc_{snake(name)};\n"


def _room(kind: Sequence[str], name: str, sizes: Mapping[str, int], real: Arithmetic) -> str:
    """`sizes`: those that are written as numbers."""
    from lagc.render.kernels.c import CPrinter

    printer = CPrinter(real, {**DERIVED, **{n: str(size) for n, size in sizes.items()}}, {})
    return printer.room(tuple(kind), name)


def _methods() -> str:
    found = [part for part in parts() if part["kind"] == "Method"]
    ends = ["," if part is not found[-1] else "" for part in found]
    rows = [f"    LAGC_{part['name']} = {part['value']}{end} /* {part['note']} */\n"
            for part, end in zip(found, ends)]  # fmt: skip
    return f"typedef enum {{\n{''.join(rows)}}} lagc_method;\n"


def _codes(file: str) -> str:
    """The enumeration of a kernel file."""
    rows: list[tuple[str, str]] = []
    head = now = ""
    for part in parts():
        now = part["name"] if part["kind"] == "file" else now
        if part["kind"] == "Code" and now == file:
            head = head or part["note"]
            rows.append(
                (f"LAGC_{part['name']} = {part['value']}", "" if part["note"] == head else part["note"])
            )
    lines = [f"    {text}{',' if k < len(rows) - 1 else ''}" + (f" /* {note} */" if note else "")
             for k, (text, note) in enumerate(rows)]  # fmt: skip
    return f"{_comment(fill(head, 98))}enum {{\n" + "\n".join(lines) + "\n};\n"


def _constant(part: Mapping[str, Any]) -> str:
    if part["kind"] == "Reals":
        values = part["value"]
        rows = ",\n    ".join(", ".join(values[k : k + 8]) for k in range(0, len(values), 8))
        head = f"static const lagc_real lagc_{part['name'].lower()}[]"
        return f"{_comment(part['note'])}{head} = {{\n    {rows}\n}};\n"
    text, note = f"#define LAGC_{part['name']} {part['value']}", part["note"]
    if not note:
        return text + "\n"
    return f"{text} /* {note} */\n" if len(text) + len(note) < 92 else f"{_comment(note)}{text}\n"


def _section(title: str, text: str) -> str:
    lines = text.splitlines()
    if not lines:
        return f"/* -- {title} -- */\n"
    return f"/* -- {title} --\n" + "\n".join(f" * {line}".rstrip() for line in lines) + " */\n"


def _comment(text: str) -> str:
    lines = text.splitlines()
    return (
        "/* " + "\n".join([*lines[:1], *((" * " + line).rstrip() for line in lines[1:])]) + " */\n"
        if lines
        else ""
    )


def _work(program: Program) -> str:
    """The rate of the work integral, with all that the model's function of it may read."""
    if not program.interface.nz:
        return ""
    power = program.functions.get("power")
    used = power.inputs if power is not None else ()
    unused = "".join(f"    (void){name};\n" for name in ("p", "t", "x", "a", "lam") if name not in used)
    body = f"    lagc_fn_power({', '.join(used)}, e);\n" if power is not None else "    e[0] = 0.0;\n"
    return (
        "static void lagc_fn_work(const lagc_params *p, lagc_real t, const lagc_real *x, const lagc_real *a, "
        f"const lagc_real *lam, lagc_real *e)\n{{\n{unused}{body}}}\n"
    )


def _defaults(complete: bool, real: Arithmetic) -> str:
    """What the subset cannot say: structs by value, their sizes, texts."""
    rtol = real.literal((1e-4, 1e-9, 1e-22)[real.column])
    values = {"method": f"LAGC_{METHODS[0].upper()}", "project": "1", "max_steps": "100000000", "rtol": rtol,
              "atol": "0.0", "step": "0.0", "first_step": "0.0", "max_step": "0.0"}  # fmt: skip
    lines = "".join(f"    o.{name} = {value};\n" for name, value in values.items())
    text = f"lagc_options lagc_default_options(void)\n{{\n    lagc_options o;\n{lines}    return o;\n}}\n\n"
    text += "".join(
        f"size_t lagc_{n}_size(void) {{ return sizeof(lagc_{n}); }}\n\n" for n in ("work", "state")
    )
    if not complete:
        return text
    texts = ",\n        ".join(f'"{text}"' for _, text, _ in STATUSES)
    return text + (
        "const char *lagc_status_text(int status)\n{\n    static const char *const texts[] = {\n"
        f"        {texts}\n    }};\n"
        '    return status >= 0 && status <= LAGC_INVALID ? texts[status] : "no status";\n}\n'
    )
