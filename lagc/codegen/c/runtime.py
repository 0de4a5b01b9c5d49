"""The runtime of a model in C: the kernels that it calls, its sizes and tables."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from functools import cached_property
from itertools import takewhile
from textwrap import fill
from typing import Any, TypeAlias

from lagc.codegen.c import header
from lagc.codegen.c.any_model import START_WORK, TABLE, functions_without_work, member_table
from lagc.codegen.c.convolution import convolution
from lagc.codegen.c.public_functions import public_functions
from lagc.codegen.heading import rates, status_texts, statuses
from lagc.codegen.kernel_compiler.c import CPrinter, block_comment, copies, snake
from lagc.codegen.kernel_compiler.library import Chosen, Library, library
from lagc.codegen.kernel_compiler.parts import FUNCTION, Part
from lagc.codegen.kernel_compiler.real_types import DOUBLE, Arithmetic
from lagc.codegen.python.support.base import Options
from lagc.codegen.sizes import SPELLED, flags_of, methods_of, sizes_of, tables_of
from lagc.lowering.program import Interface, Program

# Public kernels of every model; a run of lagc does the last ones itself.
ROOTS = ("begin", "step", "dense", "advance", "record", "verified", "check")
EMBEDDED = ("check",)  # of these the kernels that a run of lagc does itself
ASKED = ("verified",)  # of these the kernels that other code has with `verified`
CALLED = ("system_at", "assemble_at", "solve_at", "assemble_slopes")  # by public functions, as the rates
ALWAYS = ("default_params", "bind")  # functions of code that evaluates only
SHARE = 20  # least length of code over that of its explanation
READ = ("Options", "State", "Work")  # structs whose members callers read
PRIVATE = "Private from here on"
PLAIN = {"Real": "real", "Vec": "real", "Count": "long", "int": "int", "bool": "int", "IVec": "int"}
NUMBERS = ("int", "Real", "Reals")  # kinds of constants that are not in the header
IMPORTED = ("hold_modes", "indicators", "event", "next_event", "project_state")  # with `events`
FOLLOWING = ("follow", "event_facts")  # with sensitivities
_COPY_STATE = """\
static void lagc_fn_copy_state(const lagc_state *s, lagc_state *kept)
{
    *kept = *s;
}
"""
OF_VERIFIED = ("Goal", "Report", "Verification")
Member: TypeAlias = "tuple[str, Sequence[str], Sequence[str], str]"  # name, type, comments before and beside
PUBLIC_RECORDS = ("TangentWork", "Work", "Options", "State", "StartWork", *OF_VERIFIED)
_OBSERVE = """\
static void lagc_fn_observe(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *y, lagc_work *w)
{
    (void)lagc_outputs(p, t, x, y, w);
}
"""


def evaluations(program: Program) -> list[str]:
    """Return the names of the public functions that evaluate, without an integrator."""
    named = [*public_functions(program), *functions_without_work(program.interface)]
    has = evaluating_kernels(program.interface, True)
    return [*(function.name for function in named), *(name for name, there in has.items() if there)]


def evaluating_kernels(interface: Interface, complete: bool) -> dict[str, bool]:
    """Return the public kernels that evaluate, and whether a model has them."""
    return {
        "bind": interface.prepared > 0, "hold": bool(interface.relations),
        "seated": bool(interface.contacts), "consistent": complete and interface.needs_consistency,
    }  # fmt: skip


class Runtime:
    """The kernels and public functions of a model.  Without `complete`, a run of lagc does checks and
    initialization itself.  `only` names public functions that evaluate; it has these, and no integrator."""

    def __init__(self, program: Program, complete: bool, real: Arithmetic = DOUBLE, only: Sequence[str] = ()):
        self.program, self.complete, self.real, self.only = program, complete, real, only
        interface, kept = program.interface, {*only, *ALWAYS}
        direct = [f for f in public_functions(program, real) if not only or f.name in kept]
        self.searches = complete and interface.needs_consistency
        left_out = (() if interface.verified else ASKED) if complete else EMBEDDED
        roots = [] if only else [name for name in ROOTS if name not in left_out]
        roots += [
            name
            for name, has in evaluating_kernels(interface, complete).items()
            if has and (not only or name in kept)
        ]
        bodies = "".join(function.body for function in direct)
        roots += [name for name in (rates(interface), *CALLED) if f"lagc_{name}(" in bodies]
        roots += IMPORTED if interface.events else ()
        roots += [
            name for name in FOLLOWING if interface.follows and (name != "event_facts" or interface.relations)
        ]
        self.kernels = library(real.language)
        self.flags = flags_of(interface, complete)
        self.use = self.kernels.chosen(roots, self.flags)
        self.sizes = sizes_of(interface)
        self.public = {name for name, _, _ in header.sizes(interface)}
        self.functions = direct
        if complete:
            self.functions += [f for f in functions_without_work(interface) if not only or f.name in kept]
            self.functions += [] if only else member_table(interface, self._members())

    def _members(self) -> dict[str, list[tuple[str, str, int]]]:
        """Return name, type and length of the public members of the structs that callers read."""
        found: dict[str, list[tuple[str, str, int]]] = {}
        for part in self.use.records:
            if part.name in READ:
                members = takewhile(lambda member: not member[2] or PRIVATE not in member[2][0], part.members)
                found[snake(part.name)] = [(name, *self._plain(kind)) for name, kind, *_ in members]
        return found

    def _plain(self, kind: Sequence[str]) -> tuple[str, int]:
        """Return the type of a member, and the number of its entries."""
        return PLAIN[kind[0]], max(self.sizes[kind[1]], 1) if len(kind) > 1 else 1

    @property
    def constants(self) -> frozenset[str]:
        """The names of constants, sizes, statuses and tables."""
        found = statuses(self.kernels, self.program.interface)
        named = {part.name for part in (*self.use.constants, *found)}
        return frozenset({*named, *self.sizes, *tables_of(self.program.interface)})

    def types(self) -> str:
        """Return enumerations and structs for the header."""
        records, public = self._records(), self._public()
        roots = {name: text for name, text in records.items() if name in PUBLIC_RECORDS}
        inner, used = list[str](), "".join(roots.values())
        for name, text in reversed(records.items()):  # each record stands before those that hold it
            if name in public and name not in roots and f"lagc_{snake(name)} " in used:
                inner.insert(0, text)
                used += text
        found = [self._enumeration("Status"), *inner, records["Work"]]
        if "Options" in records:
            found += [self._enumeration("Method"), records["Options"]]
            found.append(_codes(self.kernels.constants("language/records", "Code")))
        found += [records[name] for name in ("State", *OF_VERIFIED, "TangentWork") if name in records]
        if self.complete and (not self.only or "consistent" in self.only):
            found.append(_codes(self.kernels.constants("initialization/workspace", "Code")))
            found.append(records.get("StartWork", START_WORK))
            found += [] if self.only else [TABLE]
        return "\n".join(found)

    def declarations(self) -> str:
        """Return the declarations of the functions that integrate, for the header."""
        found = [] if self.only else ["lagc_options lagc_default_options(void);\n"]
        found.append("".join(f"size_t lagc_{name}_size(void);\n" for name in self._sized()))
        if self.complete and not self.only:
            found.append("/* Return the meaning of a status, for any number. */\n"
                         "const char *lagc_status_text(int status);\n")  # fmt: skip
        for part in self.use.functions:
            if part.head:
                found += [block_comment(part.lead)] if part.lead else []
                found.append(block_comment(part.note) + part.head + ";\n")
        return "\n".join(found)

    def definitions(self, header: str) -> list[str]:
        """Return constants, tables and functions for the source, without constants of the header."""
        values, names = tables_of(self.program.interface), self.use.names
        text = "".join([*(part.text for part in self.use.functions), *(f.body for f in self.functions)])
        used = set(re.findall(r"LAGC_(\w+)", text)) - self.public
        own = [name for name in self.sizes if name in used]
        sizes = fill(", ".join(f"LAGC_{n} = {self.sizes[n]}" for n in own), 98, initial_indent="    ",
                     subsequent_indent="    ")  # fmt: skip
        found = [f"enum {{ /* sizes */\n{sizes}\n}};\n" if own else "", _work(self.program)]
        found += [_table(name, values[name], self.real) for name in values if name in names]
        public = self._public()
        found += [text for name, text in self._records().items() if name not in public]
        if "fn_convolve" in names:
            found.append(convolution(self.sizes["NLANE"], self.sizes["NSQUARE"], self.real))
        found += copies(text)
        found += [_OBSERVE] if "fn_observe" in names else []
        found += [_COPY_STATE] if "fn_copy_state" in names else []
        declared = set(re.findall(r"LAGC_(\w+)", header))
        constants = [part for part in self.use.constants if part.name not in declared]
        found += _printed(self.kernels, constants, self.use.functions)
        # Not in the subset of kernels: structs by value, their sizes, texts.
        for options in [part for part in self.use.records if part.name == "Options"]:
            found.append(_default_options(options.members, self.real, methods_of(self.program.interface)))
        found += [f"size_t lagc_{n}_size(void) {{ return sizeof(lagc_{n}); }}\n" for n in self._sized()]
        texts = status_texts(self.kernels, self.program.interface)
        found += [_status_text(texts)] if self.complete and not self.only else []
        return [part for part in found if part]

    def _sized(self) -> list[str]:
        """Return the records whose size the caller may ask."""
        named = {"work": "Work", "state": "State", "verification": "Verification",
                 "tangent_work": "TangentWork"}  # fmt: skip
        records = {part.name for part in self.use.records}
        return [name for name, record in named.items() if record in records]

    def _public(self) -> frozenset[str]:
        """Return the records of the header: those that callers hold, and those inside of them."""
        found, wanted = set[str](), [part.name for part in self.use.records if part.name in PUBLIC_RECORDS]
        while wanted:
            found.add(wanted[-1])
            wanted += self.kernels.part(wanted.pop(), self.flags).needs
        return frozenset(found)

    def _records(self) -> dict[str, str]:
        """Return the struct of each record; C has no arrays of size 0, so these get size 1."""
        numbers = {n: str(max(size, 1)) for n, size in self.sizes.items() if not (size and n in self.public)}
        printer = CPrinter(self.real, {**SPELLED, **numbers}, {})
        found = {}
        for part in self.use.records:
            lines = []
            for name, kind, lead, trail in self._members_in_use(part):
                lines += [f"    {line}" for line in block_comment("\n".join(lead)).splitlines()]
                lines += _annotated(f"    {printer.member(tuple(kind), name)};", trail)
            head, body = block_comment(part.note), "\n".join(lines)
            found[part.name] = f"{head}typedef struct {{\n{body}\n}} lagc_{snake(part.name)};\n"
        return found

    @cached_property
    def _used(self) -> frozenset[str]:
        """The names of the members of records that functions use."""
        bodies = [function.text for function in self.use.functions] + [f.body for f in self.functions]
        return frozenset(re.findall(r"(?:->|\.)([A-Za-z]\w*)", "".join(bodies)))

    def _members_in_use(self, part: Part) -> list[Member]:
        """Return the members of a record: the public ones, those that functions use, and at least one. A
        comment before members that are left out stands before the next one."""
        is_public = part.name in PUBLIC_RECORDS and not (self.only and part.name == "Work")
        found, title = list[Member](), list[str]()
        for name, kind, lead, trail in part.members:
            is_public = is_public and not any(PRIVATE in line for line in lead)
            title = [*title, *lead] if any(PRIVATE in line for line in title) else [*lead] or title
            if is_public or name in self._used or name == "culprit":
                found.append((name, kind, title, trail))
                title = []
        return found or [*part.members[:1]]

    def _enumeration(self, kind: str) -> str:
        interface = self.program.interface
        if kind == "Status":
            found = statuses(self.kernels, interface)
        else:
            found = [self.kernels.part(name.upper(), {}) for name in methods_of(interface)]
        rows = [f"LAGC_{part.name} = {part.text}" for part in found]
        lines = list[str]()
        for row, part in zip(rows, found):
            lines += _annotated(f"    {row}{',' if row is not rows[-1] else ''}", part.note)
        body = "\n".join(lines)
        return f"typedef enum {{\n{body}\n}} lagc_{snake(kind)};\n"


def sine_cosine(use: Chosen) -> list[str]:
    """Return the sine and cosine kernels that functions of the model call, in double precision."""
    return [text.replace("lagc_real", "double") for text in
            _printed(library(DOUBLE.language), use.constants, use.functions)]  # fmt: skip


def _printed(kernels: Library, constants: Iterable[Part], functions: Iterable[Part]) -> list[str]:
    """Return constants and functions, with the title of each file."""
    parts = [*(part for part in constants if part.kind in NUMBERS), *functions]
    found = list[str]()
    for place in sorted({tuple(part.place[:2]) for part in parts}):
        title, own = kernels.title(place), [part for part in parts if tuple(part.place[:2]) == place]
        # An explanation stands before much code; else it tells of more than this model has.
        is_apt = SHARE * len(title.note) < sum(len(part.text) for part in own)
        found += [_section(title.text, title.note * is_apt), *_constants(own)]
        found += [part.text for part in own if part.kind == FUNCTION]
    return found


def _annotated(line: str, note: str) -> list[str]:
    """Return a line with its comment beside it, or above it where that is too long."""
    if not note:
        return [line]
    if len(line) + len(note) <= 92:
        return [f"{line} /* {note} */"]
    indent = line[: len(line) - len(line.lstrip())]
    text = block_comment(fill(note, 94 - len(indent)))
    return [*(indent + row for row in text.splitlines()), line]


def _table(name: str, values: Sequence[Any], real: Arithmetic) -> str:
    """Return the declaration of a table. C has no empty ones: a loop of no turn gets a zero."""
    if name in ("bounds", "derived_bounds"):
        rows = ",\n    ".join(f"{{{real.bound(low)}, {real.bound(high)}}}" for low, high in values)
        return f"static const lagc_real lagc_{name}[][2] = {{\n    {rows}\n}};\n"
    values = values or (0,)
    rows = ",\n    ".join(", ".join(map(str, values[k : k + 16])) for k in range(0, len(values), 16))
    inner = f"\n    {rows}\n" if "\n" in rows else rows
    return f"static const int lagc_{name}[] = {{{inner}}};\n"


def _codes(found: Sequence[Part]) -> str:
    """Return an enumeration; the note of its first value is its comment."""
    head = found[0].note
    lines = []
    for part in found:
        comma = "," if part is not found[-1] else ""
        note = "" if part.note in ("", head) else f" /* {part.note} */"
        lines.append(f"    LAGC_{part.name} = {part.text}{comma}{note}\n")
    return f"{block_comment(fill(head, 98))}enum {{\n{''.join(lines)}}};\n"


def _constants(parts: Sequence[Part]) -> list[str]:
    """Return the declarations of the constants among `parts`, one for each type, and of tables."""
    found = list[str]()
    for kind, name in (("Real", "lagc_real"), ("int", "int")):
        own, lines = [part for part in parts if part.kind == kind], [f"static const {name}"]
        for part in own:
            lines += _annotated(
                f"    LAGC_{part.name} = {part.text}{';' if part is own[-1] else ','}", part.note
            )
        found += ["\n".join(lines) + "\n"] if own else []
    for part in parts:
        if part.kind == "Reals":
            rows = fill(part.text, 98, initial_indent="    ", subsequent_indent="    ")
            head = f"static const lagc_real lagc_{part.name.lower()}[]"
            found.append(f"{block_comment(part.note)}{head} = {{\n{rows}\n}};\n")
    return found


def _section(title: str, text: str) -> str:
    lines = text.splitlines()
    if not lines:
        return f"/* -- {title} -- */\n"
    return f"/* -- {title} --\n" + "\n".join(f" * {line}".rstrip() for line in lines) + " */\n"


def _work(program: Program) -> str:
    """Return the rate of the work integral, with the arguments of the kernels."""
    if not program.interface.nz:
        return ""
    power = program.functions.get("power")
    used = power.inputs if power is not None else ()
    modes = ("modes",) if program.interface.relations else ()
    forces = ("contact_forces",) if program.interface.pushed_contacts else ()
    given = ("p", "t", "x", *modes, "a", "lam", *forces)
    unused = "".join(f"    (void){name};\n" for name in given if name not in used)
    body = "    e[0] = 0.0;\n"
    if power is not None:
        body = f"    lagc_fn_{power.spelled}({', '.join(used)}, e);\n"
    formal = {"p": "const lagc_params *p", "t": "lagc_real t"}
    head = ", ".join(formal.get(name, f"const lagc_real *{name}") for name in given)
    name = ("pushed_" if forces else "") + ("work_on" if modes else "work")
    return f"static void lagc_fn_{name}({head}, lagc_real *e)\n{{\n{unused}{body}}}\n"


def _default_options(members: Sequence[Sequence[Any]], real: Arithmetic, methods: Sequence[str]) -> str:
    usual, lines = Options(), ""
    usual.method = usual.method if usual.method in methods else methods[0]
    usual.rtol = (1e-4, usual.rtol, 1e-22)[real.column]
    for name, (kind,), *_ in members:
        value = getattr(usual, name)
        text = (
            real.literal(value)
            if kind == "Real"
            else f"LAGC_{value.upper()}"
            if name == "method"
            else int(value)
        )
        lines += f"    o.{name} = {text};\n"
    return f"lagc_options lagc_default_options(void)\n{{\n    lagc_options o;\n{lines}    return o;\n}}\n"


def _status_text(texts: Sequence[str]) -> str:
    meanings = ",\n        ".join(f'"{text}"' for text in texts)
    return (
        "const char *lagc_status_text(int status)\n{\n    static const char *const texts[] = {\n"
        f"        {meanings}\n    }};\n"
        f"    return ((status >= 0) && (status < {len(texts)})) "
        '? texts[status] : "No such status.";\n}\n'
    )
