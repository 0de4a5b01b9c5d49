"""Tables of a Program: names and text in C and Python."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from lagc.codegen.kernel_compiler.real_types import Arithmetic
from lagc.lowering.program import Program, tables
from lagc.symbolic.leaves import Table

Numbers = Mapping[Table, int]
NONE: Numbers = {}
_WIDTH = 96

# The last index whose number is at most x, or 0, by the same bisection as Python's `bisect`.
_SEARCH = """\
static lagc_real lagc_piece(const lagc_real *table, long size, lagc_real x)
{
    long low = 0, high = size;
    while (low < high) {
        const long middle = (low + high) / 2;
        if (x < table[middle]) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    return (lagc_real)((low > 0) ? (low - 1) : 0);
}
"""

_PYTHON = '''\
from bisect import bisect_right as _bisect_right


def piece(table, a):
    """Return the last index whose number is at most a, or 0."""
    return float(max(_bisect_right(table, a) - 1, 0))


def entry(table, place):
    return table[int(place)]


_CAREFUL["TABLES"] = TABLES
_CAREFUL["piece"] = lambda table, a: _Ieee(piece(table, a))
_CAREFUL["entry"] = lambda table, place: _Ieee(entry(table, place))
'''


def numbered(program: Program) -> Numbers:
    return {table: k for k, table in enumerate(tables(program.functions.values()))}


def c_look_up(numbers: Numbers, op: str, table: Table, at: str) -> str:
    name = f"lagc_table{numbers[table]}"
    return f"lagc_piece({name}, {len(table)}, {at})" if op == "piece" else f"{name}[(long)({at})]"


def python_look_up(numbers: Numbers, op: str, table: Table, at: str) -> str:
    return f"{op}(TABLES[{numbers[table]}], {at})"


def c_tables(numbers: Numbers, real: Arithmetic) -> list[str]:
    """Return the tables and the search in them."""
    if not numbers:
        return []
    found = []
    for table, k in numbers.items():
        rows = "\n".join(_rows([f"{real.literal(x)}," for x in table]))
        found.append(f"static const lagc_real lagc_table{k}[{len(table)}] = {{\n{rows}\n}};\n")
    return [*found, _SEARCH]


def python_tables(numbers: Numbers) -> list[str]:
    """Return TABLES and the search. A text that is split is read ten times as fast as a tuple of numbers."""
    if not numbers:
        return []
    found = ["TABLES = ("]
    for table in numbers:
        found += ['    tuple(map(float, """', *_rows([repr(x) for x in table]), '    """.split())),']
    return ["\n".join([*found, ")\n"]), _PYTHON]


def _rows(words: Sequence[str]) -> list[str]:
    """Return lines of as many words as fit."""
    each = max(1, _WIDTH // (1 + max(map(len, words))))
    return [f"    {' '.join(words[k : k + each])}" for k in range(0, len(words), each)]
