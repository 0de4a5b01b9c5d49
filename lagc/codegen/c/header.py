"""The header of generated C: sizes, names, types and public functions."""

from __future__ import annotations

import math
from collections.abc import Iterable

from lagc.codegen.heading import ABI_VERSION, LICENCE, SPDX, equation, origin
from lagc.codegen.identifiers import Names, comment, prefix
from lagc.codegen.kernel_compiler.real_types import Arithmetic
from lagc.codegen.sizes import sizes_of
from lagc.lowering.program import Field, Interface


def banner(interface: Interface, file: str) -> str:
    about = ("SI units throughout.  No function allocates, prints or keeps a state of its own.  Any number",
             "of threads may call, each with its own workspace and states.")  # fmt: skip
    lines = [SPDX, *LICENCE, "", *(f"    {line}" for line in equation(interface)), "", *about]
    return (
        f"/* {origin(interface, file)}\n *\n"
        + "".join(f" * {line}".rstrip() + "\n" for line in lines)
        + " */\n"
    )


_USE = """\
/* Rules for all functions:
 * A pointer is not NULL unless its function says that it may be.  Outputs overlap no other argument.  Const
 * arguments are only read; several calls may share them.  All arguments are aligned as their types.  *w is
 * filled with zeros before its first use.
 * Functions are reentrant: any thread, callback or signal handler may call them.  One call at a time uses
 * *w and *s.
 * OK and REDUNDANT are successes.  After another status the outputs have no meaning; the functions that
 * integrate say what *s holds then.  Functions without a status return numbers that are not finite where the
 * parameters or the state lead to them.
 * lagc_check checks parameters and options.  Functions that integrate check them once a call; functions that
 * evaluate at one state do not.
 */

/* Example (see below for the functions):
 *     static lagc_work w;                     zeros; one per thread
 *     lagc_params p = lagc_default_params();
 *     p.... = ...;                            set parameters
 *     lagc_bind(&p);                          after parameters are set or changed; not after inputs
 *     lagc_options o = lagc_default_options();
 *     static lagc_state s;                    one per trajectory
 *     lagc_real x[LAGC_NX];
 *     lagc_start(&p, x);
{consistent} *     lagc_begin(&s, 0.0, x);
 *     if (lagc_advance(&p, &s, 1.0, &o, &w) == LAGC_OK)
 *         ... s.x is the state at t = 1
 */
"""


_CONSISTENT = """\
 *     static lagc_start_work c;
 *     if (lagc_consistent(&p, 0.0, x, NULL, &c) != LAGC_OK)
 *         ... no consistent initial state: see c.culprit
"""


def stacked(interface: Interface) -> str:
    """Return the first row of each part of the differentiated stack, as an enumeration."""
    if not interface.differentiated:
        return ""
    title = "/* First row of each part of the differentiated functions; see lagc_stack */\n"
    rows = [f"    LAGC_D_{name.upper()} = {part.start}," for name, part in interface.stack.items()]
    last = f"    LAGC_D_END = {max(part.stop for part in interface.stack.values())}"
    return title + "enum {\n" + "\n".join([*rows, last]) + "\n};\n"


def use(consistency: bool, integrates: bool) -> str:
    """Return the rules for all functions and, of code that integrates, a short example."""
    if not integrates:
        return _USE.partition(" * lagc_check")[0] + " */\n"
    return _USE.replace("{consistent}", _CONSISTENT if consistency else "")


_TYPES = {
    "double": "",
    "float": """\
/* Reals are floats with 7 digits; the default of o.rtol is 1e-4. */
""",
    "__float128": """\
/* Reals are __float128 with 34 digits, for gcc, or g++ in GNU mode (-std=gnu++17), with -lquadmath -lm; the
 * default of o.rtol is 1e-22.  Constants of the model were computed in double precision: decimals with up to
 * 12 digits, quotients of small integers (1/3) and such multiples of pi (30 degrees) have all digits, others
 * have 16.  Parameters may be set to more digits. */
""",
}


def about(real: Arithmetic) -> str:
    """Return the type of reals, with notes if it is not double."""
    return f"{_TYPES[real.name]}typedef {real.name} lagc_real;\n"


def constants(interface: Interface) -> str:
    """Return sizes as macros, which the preprocessor can use, and the indices of names."""
    text = [
        f"#define LAGC_ABI_VERSION {ABI_VERSION}",
        f'#define LAGC_MODEL_HASH "{comment(interface.model_hash)}"',
        "",
    ]
    text += [f"#define LAGC_{name:5s} {value:<4d} /* {note} */" for name, value, note in sizes(interface)]
    kinds = _CONTACT_KINDS if interface.contacts else ""
    return "\n".join(text) + "\n\n" + "".join(_indices(interface)) + kinds


_SIZES = {
    "NQ": "coordinates q", "NV": "speeds v", "NZ": "work integral, the last of x",
    "NX": "state x = (q, v, z)", "NC": "constraint equations, multipliers lambda",
    "NH": "holonomic ones, the first of these", "NP": "parameters and inputs",
    "NGROUP": "scaling groups: coordinates, or speeds, of one unit", "NWORK": "entries of the sparse factors",
    "NY": "outputs y",
    "NQUAT": "unit quaternions in q",
}  # fmt: skip
_DISCRETE = {
    "NZ": "work integral, after q and v", "NX": "state x = (q, v, z, d)",
    "NINT": "integrated states q, v, z, the first of x",
    "NDISC": "discrete variables d, the last of x: only when clauses change them",
}  # fmt: skip
_CONTACTS = {
    "NCON": "contacts; the last of d: 0 open, 1 touches; with friction 1, -1 slips, 2 sticks",
    "NSLIP": "slip rows of contacts",
}
_CONTACT_KINDS = """\
enum { /* what a contact did at an event: contact_kinds of the state; 0: nothing */
    LAGC_CONTACT_STRIKES = 1,
    LAGC_CONTACT_RESTS = 2, /* from rest_times on: bounces until then are not followed */
    LAGC_CONTACT_CLOSES = 3,
    LAGC_CONTACT_OPENS = 4,
    LAGC_CONTACT_STICKS = 5,
    LAGC_CONTACT_SLIPS = 6
};

"""
_VERIFIED = {"NQUANTITY": "compared by lagc_verified: q, v, y, discrete variables"}
_FREE = {"NFREE": "event indicators that depend on the state"}
_PREPARED = {"NPREPARED": "numbers that lagc_bind computes from the parameters"}
_LIMITED = {"NLIMITS": "bounded values computed from parameters"}
_NEWTON = {
    "NNEWTON": "unknowns of a stage of an implicit method: q, v, lambda without contacts",
    "NLINEAR": "of these the ones of its linear systems",
}
_OF_START = {
    "NU": "unknowns of the initialization: q, v, other stated rates",
    "NE": "equations of the initialization",
}


def sizes(interface: Interface) -> list[tuple[str, int, str]]:
    """Return name, value and meaning of each size."""
    values = {**sizes_of(interface), "NY": len(interface.outputs)}
    prepared = _PREPARED if interface.prepared else {}
    limited = _LIMITED if interface.limits else {}
    newton = _NEWTON if interface.stiff else {}
    discrete = _DISCRETE if interface.discretes else {}
    notes = {
        **_SIZES,
        **discrete,
        **(_CONTACTS if interface.contacts else {}),
        **(_VERIFIED if interface.verified else {}),
        **(_FREE if interface.events else {}),
        **prepared,
        **limited,
        **newton,
        **(_OF_START if interface.needs_consistency else {}),
    }
    return [(name, values[name], note) for name, note in notes.items()]


def _indices(interface: Interface) -> Iterable[str]:
    groups = (
        ("Q", "indices into q, which begins at x[0]", interface.q_names, interface.q_units),
        ("V", "indices into a and into v, which begins at x[LAGC_NQ]", interface.v_names, interface.v_units),
        (
            "X",
            "indices of discrete variables into x; lagc_start sets them, and you may change them in s.x",
            tuple(f.name for f in interface.discretes),
            tuple(_kind(f, truth) for f, truth in zip(interface.discretes, interface.booleans)),
        ),
        ("C", "indices into lambda and rows of G", interface.row_labels, interface.row_units),
        (
            "Y",
            "indices into y",
            tuple(f.name for f in interface.outputs),
            tuple(f.unit for f in interface.outputs),
        ),
    )
    first = interface.nx - len(interface.discretes)
    for letter, title, names, units in groups:
        if not names:
            continue
        given = Names()
        entries = [(given.give(name), name, unit) for name, unit in zip(names, units)]
        begin = first if letter == "X" else 0
        ends = ["," if k < len(entries) - 1 else "" for k in range(len(entries))]
        yield f"enum {{ /* {title} */\n"
        for k, (spelled, name, unit) in enumerate(entries):
            note = comment(f"{name} [{unit}]" if unit else name)
            yield f"    LAGC_{letter}_{spelled} = {begin + k}{ends[k]} /* {note} */\n"
        yield "};\n\n"


def _kind(variable: Field, truth: int) -> str:
    return "0 or 1" if truth else variable.unit


def members(interface: Interface) -> list[str]:
    """Return the struct member of each parameter, then of each input."""
    names = Names(("prepared",), prefixes=("LAGC_", f"{prefix(interface.model).upper()}_"))  # no macro's name
    found = [names.give(f.name) for f in (*interface.parameters, *interface.inputs)]
    return found or ["none"]


def places(interface: Interface) -> dict[int, str]:
    """Return the struct member of each entry of p: parameters, inputs, prepared numbers."""
    prepared = (f"prepared[{k}]" for k in range(interface.prepared))
    return dict(enumerate([*members(interface), *prepared]))


def parameters(interface: Interface) -> str:
    """Return the struct of parameters and inputs: reals in the order of p."""
    names = members(interface)
    fields = [*interface.parameters, *interface.inputs]
    text = ["typedef struct {"]
    if not fields:
        text.append("    lagc_real none; /* this model has no parameters */")
    for k, (name, field) in enumerate(zip(names, fields)):
        if k == len(interface.parameters):
            text.append("    /* inputs */")
        text.append(f"    lagc_real {name}; /* {_note(name, field)} */")
    if interface.prepared:
        text.append("    lagc_real prepared[LAGC_NPREPARED]; /* private: computed by lagc_bind */")
    return "\n".join([*text, "} lagc_params;"]) + "\n"


def _note(member: str, field: Field) -> str:
    parts = [field.unit or "1"]
    if member != field.name:
        parts.insert(0, f"`{field.name}`")
    if math.isfinite(field.minimum):
        parts.append(f">= {field.minimum!r}")
    if math.isfinite(field.maximum):
        parts.append(f"<= {field.maximum!r}")
    parts += [part for part in (field.description, field.place) if part]
    return comment("  ".join(parts))
