"""What the generated C demands of its compiler: arithmetic as it is written."""

from __future__ import annotations

from lagc.codegen.kernel_compiler.real_types import Arithmetic

_REORDERED = """\
/* Results are those of the operations as they are written, to the bit.  Whoever can do without defines
 * LAGC_ANY_ARITHMETIC: wider arithmetic is as accurate; what -ffast-math leaves, nobody knows. */
#ifndef LAGC_ANY_ARITHMETIC
#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__) \\
    || defined(_M_FP_FAST) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__ + 0 > 0)
#error "-ffast-math, -Ofast and the like change sums and tests that results rest on: compile without them"
#endif
"""
_WIDER = """\
#if defined(FLT_EVAL_METHOD) && ({})
#error "arithmetic is wider than its type (x87): results would depend on the compiler; -msse2 -mfpmath=sse"
#endif
"""
_FUSED = """\
/* a * b + c is two operations, whatever the machine offers (clang's -ffp-contract=fast overrides this). */
#ifdef __clang__
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__) && (defined(__FP_FAST_FMA) || defined(__FP_FAST_FMAF))
#pragma GCC optimize("fp-contract=off")
#endif
"""


def demands(real: Arithmetic) -> str:
    """Directives that refuse compilers told to compute something else, and those told nothing to fuse."""
    wider = _WIDER.format(real.wider) if real.wider else ""
    return f"{_REORDERED}{wider}#endif\n\n{_FUSED}"
