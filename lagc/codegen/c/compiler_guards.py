"""Guards against compiler options that change the arithmetic of generated C."""

from __future__ import annotations

from lagc.codegen.kernel_compiler.real_types import Arithmetic

_REORDERED = """\
/* Results are the same to the bit with every compiler that does the operations as they are written.  Define
 * LAGC_ANY_ARITHMETIC to compile with wider arithmetic, which is as accurate.  -ffast-math is not supported. */
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


def demands(real: Arithmetic) -> str:
    """Return directives that refuse such options and disable fused operations."""
    wider = _WIDER.format(real.wider) if real.wider else ""
    return f"{_REORDERED}{wider}#endif\n\n{_FUSED}"
