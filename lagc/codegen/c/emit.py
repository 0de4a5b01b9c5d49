"""Program -> one C header and one C source.

The source holds, in this order: functions that the model uses (HELPERS), the model's own
functions (`lagc_fn_...`), the kernels that it needs, and the public
functions.  `lagc_` and `LAGC_` become the model's prefix over the whole text at the end.
"""

from __future__ import annotations

import re

from lagc.codegen.c import header
from lagc.codegen.c.compiler_guards import demands
from lagc.codegen.c.functions import function_text, helpers
from lagc.codegen.c.public_functions import verbs
from lagc.codegen.c.runtime import Runtime, sine_cosine
from lagc.codegen.identifiers import prefix
from lagc.codegen.kernel_compiler.real_types import DOUBLE, Arithmetic
from lagc.codegen.locals import local_names
from lagc.codegen.tables import c_tables, numbered
from lagc.codegen.trigonometry import turning
from lagc.lowering.program import Interface, Program


def render(program: Program, complete: bool = True, real: Arithmetic = DOUBLE) -> dict[str, str]:
    """File name -> text: `<model>.h` and `<model>.c`, C99 and C++.

    Unless `complete` they lack what a run of `lagc` does itself: the search for a consistent start, which
    takes a compiler as long as much of the rest, by the same kernels in Python, to the same bits; the
    bounds of parameters; texts.
    """
    program = program.shipped
    interface, runtime = program.interface, Runtime(program, complete, real)
    name = prefix(interface.model)
    return {
        f"{name}.h": _prefixed(_header(runtime, f"{name}.h"), interface, real),
        f"{name}.c": _prefixed(_source(runtime, f"{name}.c", f"{name}.h"), interface, real),
    }


def _header(runtime: Runtime, file: str) -> str:
    interface = runtime.program.interface
    guard = "LAGC_H_"
    parts = [
        header.banner(interface, file) + f"#ifndef {guard}\n#define {guard}\n\n#include <stddef.h>\n",
        header.about(runtime.real),
        header.use(runtime.searches, interface.prepared > 0),
        header.constants(interface).rstrip("\n") + "\n",
        header.stacked(interface),
        '#ifdef __cplusplus\nextern "C" {\n#endif\n',
        header.parameters(interface),
        runtime.types(),
        *(verb.declaration for verb in verbs(runtime.program, runtime.real)),
        runtime.declarations(),
        f"#ifdef __cplusplus\n}}\n#endif\n\n#endif /* {guard} */\n",
    ]
    return "\n".join(part for part in parts if part)


def _source(runtime: Runtime, file: str, own_header: str) -> str:
    program, real = runtime.program, runtime.real
    interface = program.interface
    names = local_names(program, ())
    fields = header.places(interface)
    numbers = numbered(program)
    functions = [function_text(f, names, fields, real, numbers) for f in program.functions.values()]
    parts = [
        header.banner(interface, file) + f'#include "{own_header}"\n\n' + real.includes,
        demands(real),
        helpers(program),
        *c_tables(numbers, real),
        *sine_cosine(turning(functions)),
        *functions,
        *runtime.definitions(),
        *(verb.definition for verb in verbs(program, real)),
    ]
    return "\n".join(part for part in parts if part)


def _prefixed(text: str, interface: Interface, real: Arithmetic) -> str:
    own = prefix(interface.model)
    text = re.sub(r"\blagc_real\b(?!;)", real.name, text)  # but where the header declares it
    text = re.sub(r"\bLAGC_", f"{own.upper()}_", re.sub(r"\blagc_", f"{own}_", text))
    return _HEAD.sub(_wrapped, text)


_HEAD = re.compile(r"^[a-z][\w *]*\([^()]*\)(?=;$|\n\{)", re.M)  # of a function


def _wrapped(match: re.Match[str]) -> str:
    """The head of a function on lines of at most 98 characters, broken between parameters."""
    head = " ".join(match[0].split())
    indent = " " * (head.index("(") + 1)
    rows = [""]
    for part in re.split(r"(?<=,) ", head):
        if rows[-1].strip() and len(rows[-1]) + len(part) > 97:
            rows.append(indent)
        rows[-1] += f" {part}" if rows[-1].strip() else part
    return "\n".join(rows)
