"""The header of the generated C: sizes, names, types and the functions that a caller sees."""

from __future__ import annotations

import math
from collections.abc import Iterable

from lagc.codegen.heading import ABI_VERSION, LICENCE, SPDX, equation, origin
from lagc.codegen.identifiers import Names, comment, prefix
from lagc.codegen.kernel_compiler.linker import sizes_of
from lagc.codegen.kernel_compiler.real_types import Arithmetic
from lagc.lowering.program import Field, Interface


def banner(interface: Interface, file: str) -> str:
    about = ("SI units throughout.  Nothing here allocates, prints or keeps a state of its own; any",
             "number of threads may call, each with a workspace and states of its own.")  # fmt: skip
    lines = [SPDX, *LICENCE, "", *(f"    {line}" for line in equation(interface)), "", *about]
    return (
        f"/* {origin(interface, file)}\n *\n"
        + "".join(f" * {line}".rstrip() + "\n" for line in lines)
        + " */\n"
    )


_USE = """\
/* What every function demands and promises:
 * No pointer is NULL but where it is said that it may be.  What is written overlaps nothing else that the
 * call is given; what is const is only read, and may be shared by any calls.  Everything is aligned as its
 * type, and *w was filled with zeros before its first use.
 * Any thread may call, also from within a callback or a signal: nothing is kept here.  *w and *s belong to
 * one call at a time.
 * OK and REDUNDANT are successes.  With another status, what was to be written has no meaning; what is said
 * of *s stands with the functions that move it.  Functions without a status give numbers that are not finite
 * where the parameters or the state lead to them.
 * lagc_check tells whether parameters and options make sense; the functions that evaluate at one state
 * do not ask, those that integrate do, once a call.
 */

/* In short (the functions are explained below):
 *     static lagc_work w;                     zeros; one for each thread
 *     lagc_params p = lagc_default_params();
{bind} *     lagc_options o = lagc_default_options();
 *     static lagc_state s;                    one for each trajectory
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
 *         ... there is no start: see c.culprit
"""


_BIND = """\
 *     p.... = ...;                            as you like
 *     lagc_bind(&p);                          once they are set; again where a parameter, no input, changes
"""


def stacked(interface: Interface) -> str:
    """Where in the rows of derivatives each part begins."""
    if not interface.differentiated:
        return ""
    title = "/* What is differentiated: the first row of each part; see lagc_stack */\n"
    rows = [f"    LAGC_D_{name.upper()} = {part.start}," for name, part in interface.stack.items()]
    last = f"    LAGC_D_END = {max(part.stop for part in interface.stack.values())}"
    return title + "enum {\n" + "\n".join([*rows, last]) + "\n};\n"


def use(consistency: bool, prepared: bool) -> str:
    """From the parameters to a motion in a few lines."""
    text = _USE.replace("{bind}", _BIND if prepared else "")
    return text.replace("{consistent}", _CONSISTENT if consistency else "")


_TYPES = {
    "double": "",
    "float": """\
/* Numbers are floats, of 7 digits: tolerances are 1e-4 unless o.rtol says another. */
""",
    "__float128": """\
/* Numbers are __float128, of 34 digits: for gcc, or g++ in GNU mode (-std=gnu++17), with -lquadmath -lm;
 * tolerances are 1e-22 unless o.rtol says another.  What the model computes of numbers alone was computed in
 * double precision: decimals of up to 12 digits, quotients of small whole numbers (1/3) and such multiples
 * of pi (30 degrees) have all digits here, others 16.  Parameters may be set to more. */
""",
}


def about(real: Arithmetic) -> str:
    """The type of numbers, and what there is to know of one that is not double."""
    return f"{_TYPES[real.name]}typedef {real.name} lagc_real;\n"


def constants(interface: Interface) -> str:
    """Sizes as macros, so that the preprocessor knows them, then what the names stand for."""
    text = [
        f"#define LAGC_ABI_VERSION {ABI_VERSION}",
        f'#define LAGC_MODEL_HASH "{comment(interface.model_hash)}"',
        "",
    ]
    text += [f"#define LAGC_{name:5s} {value:<4d} /* {note} */" for name, value, note in sizes(interface)]
    return "\n".join(text) + "\n\n" + "".join(_indices(interface))


_SIZES = {
    "NQ": "coordinates q", "NV": "speeds v", "NZ": "integral of power, the last of x",
    "NX": "state x = (q, v, z)", "NC": "rows of constraints, multipliers lambda",
    "NH": "of these holonomic, the first", "NP": "parameters and inputs",
    "NGROUP": "scaling groups: coordinates, or speeds, of one unit", "NWORK": "entries of the factors",
    "NY": "outputs y", "NQUAT": "unit quaternions in q",
}  # fmt: skip
_PREPARED = {"NPREPARED": "numbers that are prepared of the parameters"}
_LIMITED = {"NLIMITS": "values made of parameters that have bounds"}
_OF_START = {
    "NU": "unknowns of the start: q, v, stated rates that are no speeds",
    "NE": "conditions of the start",
}


def sizes(interface: Interface) -> list[tuple[str, int, str]]:
    """Name, value and what it is."""
    values = {**sizes_of(interface), "NY": len(interface.outputs)}
    prepared = _PREPARED if interface.prepared else {}
    limited = _LIMITED if interface.limits else {}
    notes = {**_SIZES, **prepared, **limited, **(_OF_START if interface.needs_consistency else {})}
    return [(name, values[name], note) for name, note in notes.items()]


def _indices(interface: Interface) -> Iterable[str]:
    groups = (
        ("Q", "indices into q, which is x[0] and on", interface.q_names, interface.q_units),
        ("V", "indices into v, which is x[LAGC_NQ] and on, and into a", interface.v_names, interface.v_units),
        ("C", "indices into lambda and rows of G", interface.row_labels, interface.row_units),
        (
            "Y",
            "indices into y",
            tuple(f.name for f in interface.outputs),
            tuple(f.unit for f in interface.outputs),
        ),
    )
    for letter, title, names, units in groups:
        if not names:
            continue
        given = Names()
        entries = [(given.give(name), name, unit) for name, unit in zip(names, units)]
        ends = ["," if k < len(entries) - 1 else "" for k in range(len(entries))]
        yield f"enum {{ /* {title} */\n"
        for k, (spelled, name, unit) in enumerate(entries):
            note = comment(f"{name} [{unit}]" if unit else name)
            yield f"    LAGC_{letter}_{spelled} = {k}{ends[k]} /* {note} */\n"
        yield "};\n\n"


def members(interface: Interface) -> list[str]:
    """The struct member of each parameter, then of each input."""
    names = Names(("prepared",), prefixes=("LAGC_", f"{prefix(interface.model).upper()}_"))  # no macro's name
    found = [names.give(f.name) for f in (*interface.parameters, *interface.inputs)]
    return found or ["none"]


def places(interface: Interface) -> dict[int, str]:
    """Where in the struct each entry of p is: behind these, what is prepared."""
    prepared = (f"prepared[{k}]" for k in range(interface.prepared))
    return dict(enumerate([*members(interface), *prepared]))


def parameters(interface: Interface) -> str:
    """The struct of parameters and inputs: all of them reals, in the order of p."""
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
        text.append(
            "    lagc_real prepared[LAGC_NPREPARED]; /* of the parameters by lagc_bind, not by callers */"
        )
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
