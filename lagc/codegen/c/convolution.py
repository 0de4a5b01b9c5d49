"""The sums of products that Taylor series are made of (`lagc.lowering.series`), as C.

All lanes go side by side through one loop over the orders, two by two in vectors of the compiler where it has
them.  Lanes are independent, so the bits are those of a loop for each lane.
"""

from __future__ import annotations

from collections.abc import Iterator

from lagc.codegen.kernel_compiler.real_types import DOUBLE, Arithmetic

MOST = 12  # sums that are kept in registers at once
_PAIRS = """\
/* Two lanes: a vector where the compiler has vectors. */
#ifdef __GNUC__
typedef double lagc_pair __attribute__((vector_size(16), aligned(8), may_alias));
#define LAGC_ADD_PAIR(s, a, b) s += *(const lagc_pair *)(a) * *(const lagc_pair *)(b)
#define LAGC_DOUBLE_PAIR(s) s += s
#define LAGC_STORE_PAIR(s, a) *(lagc_pair *)(a) = s
#else
typedef struct { double one, two; } lagc_pair;
#define LAGC_ADD_PAIR(s, a, b) s.one += (a)[0] * (b)[0]; s.two += (a)[1] * (b)[1]
#define LAGC_DOUBLE_PAIR(s) s.one += s.one; s.two += s.two
#define LAGC_STORE_PAIR(s, a) (a)[0] = s.one; (a)[1] = s.two
#endif
"""


def convolution(lanes: int, squares: int, real: Arithmetic) -> str:
    """Return the function of the model that computes `lanes` and `squares` sums."""
    paired = real == DOUBLE
    body = []
    for sums in _blocks(lanes, paired):
        body += _block(sums, 0, ["left[j]", "right[k - j]"], _ORDERS, False)
    for sums in _blocks(squares, paired):
        body += _block(sums, lanes, ["squares[j]", "squares[k - j]"], _HALF, True)
    unused = [name for name, n in (("left", lanes), ("right", lanes), ("squares", squares)) if not n]
    unused += [] if body else ["k", "sums"]
    text = "\n".join(f"    {line}" for line in [*(f"(void){name};" for name in unused), *body])
    rows = [(name, max(n, 1)) for name, n in (("left", lanes), ("right", lanes), ("squares", squares))]
    arguments = ", ".join(f"lagc_real (*{name})[{n}]" for name, n in rows)
    about = "/* Sums of the products of coefficients of order k; the newest ones are added last. */\n"
    return (
        (_PAIRS if paired and lanes + squares > 1 else "")
        + about
        + (f"static void lagc_fn_convolve(long k, {arguments}, lagc_real *sums)\n{{\n{text}\n}}\n")
    )


_ORDERS = ("for (long j = 2; j < k - 1; j++)", "if (k > 2)", "if (k > 1)")
_AT = ("", "const long j = 1;", "const long j = k - 1;")
_HALF = ("for (long j = 2; 2 * j < k; j++)", "if (k > 2)")


def _blocks(count: int, paired: bool) -> Iterator[list[tuple[int, bool]]]:
    """Yield the sums of each block: the first lane of each, and whether it is a pair."""
    found = [(i, True) for i in range(0, count - 1, 2)] if paired else []
    found += [(i, False) for i in range(2 * len(found), count)]
    for first in range(0, len(found), MOST):
        yield found[first : first + MOST]


def _block(
    sums: list[tuple[int, bool]], place: int, factors: list[str], loops: tuple[str, ...], half: bool
) -> list[str]:
    """Return the lines of one block. Those that are `half` belong to squares."""
    pairs, singles = [i for i, pair in sums if pair], [i for i, pair in sums if not pair]
    out = ["{"]
    if pairs:
        out.append(f"    lagc_pair {', '.join(f's{i} = {{0.0, 0.0}}' for i in pairs)};")
    if singles:
        out.append(f"    lagc_real {', '.join(f's{i} = 0.0' for i in singles)};")
    adding = [f"LAGC_ADD_PAIR(s{i}, a + {i}, b + {i});" for i in pairs]
    adding += [f"s{i} += a[{i}] * b[{i}];" for i in singles]

    def turn(head: str, before: str) -> None:
        out.append(f"    {head} {{")
        out.extend([f"        {before}"] if before else [])
        out.append(f"        const lagc_real *a = {factors[0]}, *b = {factors[1]};")
        out.extend(f"        {line}" for line in adding)
        out.append("    }")

    for head, before in zip(loops, _AT):
        turn(head, before)
    if half:
        out.extend(f"    LAGC_DOUBLE_PAIR(s{i});" for i in pairs)
        out.extend(f"    s{i} += s{i};" for i in singles)
        turn("if (k % 2 == 0)", "const long j = k / 2;")
    out.extend(f"    LAGC_STORE_PAIR(s{i}, sums + {place + i});" for i in pairs)
    out.extend(f"    sums[{place + i}] = s{i};" for i in singles)
    return [*out, "}"]
