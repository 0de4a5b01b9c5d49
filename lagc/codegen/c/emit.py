"""Print a Program as one C header and one C source.

The source holds helpers, the functions of the model (`lagc_fn_...`), its kernels and the public functions.
`lagc_` and `LAGC_` are replaced by the prefix of the model in the whole text at the end.
"""

from __future__ import annotations

import re

from lagc.codegen.c import header
from lagc.codegen.c.functions import function_text, helpers
from lagc.codegen.c.public_functions import public_functions
from lagc.codegen.c.runtime import Runtime, sine_cosine
from lagc.codegen.identifiers import local_names, prefix
from lagc.codegen.kernel_compiler.real_types import DOUBLE, Arithmetic
from lagc.codegen.tables import c_tables, numbered
from lagc.codegen.trigonometry import sine_cosine_kernels
from lagc.lowering.program import Interface, Program

_REORDERED = """\
/* Results are the same to the bit with every compiler that does the operations as they are written.  Define
 * LAGC_ANY_ARITHMETIC to compile with wider arithmetic, which is as accurate.
 * -ffast-math is not supported. */
#ifndef LAGC_ANY_ARITHMETIC
#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__) \\
    || defined(_M_FP_FAST) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__ + 0 > 0)
#error "-ffast-math and -Ofast change the order of operations: compile without them"
#endif
"""
_WIDER = """\
#if defined(FLT_EVAL_METHOD) && ({})
#error "x87 arithmetic is wider than its type: compile with -msse2 -mfpmath=sse"
#endif
"""
_FUSED = """\
/* Do not fuse a * b + c into one operation (-ffp-contract=fast of clang overrides this). */
#ifdef __clang__
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__) && (defined(__FP_FAST_FMA) || defined(__FP_FAST_FMAF))
#pragma GCC optimize("fp-contract=off")
#endif
"""


def render(program: Program, complete: bool = True, real: Arithmetic = DOUBLE) -> dict[str, str]:
    """Return the texts of `<model>.h` and `<model>.c` by file name, in C99 and C++. Without `complete` they
    lack the bounds of parameters, texts, and the initialization, which takes long to compile; a run of lagc
    does it by the same kernels in Python, with the same bits."""
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
        *(function.declaration for function in public_functions(runtime.program, runtime.real)),
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
        compiler_guards(real),
        helpers(program),
        *c_tables(numbers, real),
        *sine_cosine(sine_cosine_kernels(functions, DOUBLE.language)),
        *functions,
        *runtime.definitions(),
        *(function.definition for function in public_functions(program, real)),
    ]
    return "\n".join(part for part in parts if part)


def compiler_guards(real: Arithmetic) -> str:
    """Return directives that refuse such options and disable fused operations."""
    wider = _WIDER.format(real.wider) if real.wider else ""
    return f"{_REORDERED}{wider}#endif\n\n{_FUSED}"


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
