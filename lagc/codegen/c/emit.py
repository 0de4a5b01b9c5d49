"""Print a Program as one C header and one C source.

The source holds helpers, the functions of the model (`lagc_fn_...`), its kernels and the public functions.
`lagc_` and `LAGC_` are replaced by the prefix of the model in the whole text at the end.
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
    """Return the texts of `<model>.h` and `<model>.c` by file name, in C99 and C++.

    Without `complete` they lack the bounds of parameters, texts, and the initialization, which takes long to
    compile; a run of lagc does it by the same kernels in Python, with the same bits.
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
    text = re.sub(r"\blagc_real\b(?!;)", real.name, text)  # except where the header declares it
    text = re.sub(r"\bLAGC_", f"{own.upper()}_", re.sub(r"\blagc_", f"{own}_", text))
    return _HEAD.sub(_wrapped, text)


_HEAD = re.compile(r"^[a-z][\w *]*\([^()]*\)(?=;$|\n\{)", re.M)  # of a function


def _wrapped(match: re.Match[str]) -> str:
    """Break the head of a function between parameters, into lines of at most 98 characters."""
    head = " ".join(match[0].split())
    indent = " " * (head.index("(") + 1)
    rows = [""]
    for part in re.split(r"(?<=,) ", head):
        if rows[-1].strip() and len(rows[-1]) + len(part) > 97:
            rows.append(indent)
        rows[-1] += f" {part}" if rows[-1].strip() else part
    return "\n".join(rows)
