"""Print a Program as one C header and one C source.

The source holds helpers, the functions of the model (`fn_...`), its kernels and the public functions.  Names
get their final form at the end (`names`).
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from lagc.codegen.c import header
from lagc.codegen.c.functions import function_text, helpers
from lagc.codegen.c.names import PLACE, in_header, in_source
from lagc.codegen.c.runtime import Runtime, sine_cosine
from lagc.codegen.identifiers import local_names, prefix
from lagc.codegen.kernel_compiler.library import sine_cosine_kernels
from lagc.codegen.kernel_compiler.real_types import DOUBLE, Arithmetic
from lagc.codegen.tables import c_tables, numbered
from lagc.lowering.program import Program

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


def render(
    program: Program, complete: bool = True, real: Arithmetic = DOUBLE, only: Sequence[str] = ()
) -> dict[str, str]:
    """Return the texts of `<model>.h` and `<model>.c` by file name, in C99 and C++. Without `complete` they
    lack the bounds of parameters, texts, and the initialization, which takes long to compile; a run of lagc
    does it by the same kernels in Python, with the same bits.  `only` names public functions that evaluate:
    there are these, and no integrator."""
    program = program.shipped
    interface, runtime = program.interface, Runtime(program, complete, real, only)
    name = prefix(interface.model)
    header = _header(runtime, f"{name}.h")
    source = _source(runtime, f"{name}.c", f"{name}.h", header)
    return {
        f"{name}.h": _laid_out(in_header(_real(header, real), name)),
        f"{name}.c": _laid_out(in_source(_real(source, real), header, name)),
    }


def _header(runtime: Runtime, file: str) -> str:
    interface = runtime.program.interface
    guard = "LAGC_H_"
    parts = [
        header.banner(interface, file) + f"#ifndef {guard}\n#define {guard}\n\n#include <stddef.h>\n",
        header.about(runtime.real),
        header.use(runtime.searches, not runtime.only),
        header.constants(interface).rstrip("\n") + "\n",
        header.stacked(interface),
        '#ifdef __cplusplus\nextern "C" {\n#endif\n',
        header.parameters(interface),
        runtime.types(),
        *(function.declaration for function in runtime.functions),
        runtime.declarations(),
        f"#ifdef __cplusplus\n}}\n#endif\n\n#endif /* {guard} */\n",
    ]
    return "\n".join(part for part in parts if part)


def _source(runtime: Runtime, file: str, own_header: str, declared: str) -> str:
    program, real = runtime.program, runtime.real
    interface = program.interface
    taken = {"sine_cosine", "sine_cosine_two", "piece", *runtime.constants}
    names = local_names(program, taken)
    fields = header.places(interface)
    numbers = numbered(program)
    runs = [*runtime.definitions(declared), *(f.definition for f in runtime.functions)]
    called = set(re.findall(r"\blagc_fn_(\w+)", "\n".join(runs)))
    printed = [f for f in program.functions.values() if f.spelled in called]
    functions = [function_text(f, names, fields, real, numbers) for f in printed]
    parts = [
        header.banner(interface, file) + f'#include "{own_header}"\n\n' + real.includes,
        compiler_guards(real),
        PLACE,
        helpers(printed),
        *c_tables(numbers, real),
        *sine_cosine(sine_cosine_kernels(functions, DOUBLE.language)),
        *functions,
        *runs,
    ]
    return "\n".join(part for part in parts if part)


def compiler_guards(real: Arithmetic) -> str:
    """Return directives that refuse such options and disable fused operations."""
    wider = _WIDER.format(real.wider) if real.wider else ""
    return f"{_REORDERED}{wider}#endif\n\n{_FUSED}"


def _real(text: str, real: Arithmetic) -> str:
    return re.sub(r"\blagc_real\b(?!;)", real.name, text)  # except where the header declares it


_HEAD = re.compile(r"^[A-Za-z][\w *]*\([^()]*\)(?=;$|\n\{)", re.M)  # of a function


_INDENT = re.compile(r"^(?: {4})+", re.M)


def _laid_out(text: str) -> str:
    """Indent by two spaces, and break the heads of functions into lines of at most 98 characters."""
    return _HEAD.sub(_rows, _INDENT.sub(lambda match: match[0][::2], text))


def _rows(match: re.Match[str]) -> str:
    head, indent, rows = " ".join(match[0].split()), " " * 4, [""]
    for part in re.split(r"(?<=,) ", head):
        if rows[-1].strip() and len(rows[-1]) + len(part) > 97:
            rows.append(indent)
        rows[-1] += f" {part}" if rows[-1].strip() else part
    return "\n".join(rows)
