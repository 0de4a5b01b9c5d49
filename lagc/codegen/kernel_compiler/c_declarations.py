"""Declarations, comments and long lines in C: what printers of a model share with that of kernels."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from lagc.codegen.kernel_compiler.real_types import Arithmetic

WIDTH = 98  # of a line
COPIES = {"copy": "lagc_real", "copy_numbers": "int"}  # of vectors: function, type of an entry
_BREAKS = (" + ", " - ", " || ", " && ", " : ", " = ")


class CDeclarations:
    """Prints with `lagc_` and `LAGC_` before each name of the interface. `numbers`: sizes without a name."""

    def __init__(self, real: Arithmetic, numbers: Mapping[str, str]):
        self.real, self.numbers = real, numbers

    def ctype(self, kind: tuple[str, ...]) -> str:
        name = {
            "Real": self.real.name, "Vec": self.real.name, "Mat": self.real.name, "Rows": self.real.name,
            "int": "int", "IVec": "int", "bool": "bool", "Count": "long", "Length": "size_t", "None": "void",
            "Status": "lagc_status", "Params": "lagc_params", "Pair": "void",
        }.get(kind[0])  # fmt: skip
        if kind[0] == "Cell":
            return self.ctype(("int" if kind[1] == "bool" else kind[1],))
        return (f"lagc_{snake(kind[1])}" if name is None else name) + " "

    def size(self, name: str) -> str:
        return self.numbers.get(name, f"LAGC_{name}")

    def member(self, kind: tuple[str, ...], name: str) -> str:
        """Return the declaration of a member; truth values are ints for callers in other languages."""
        return self.declared(("int",) if kind[0] == "bool" else kind, name)

    def declared(self, kind: tuple[str, ...], name: str) -> str:
        """Return the declaration of a variable."""
        lengths = kind[1:] if kind[0] in ("Vec", "IVec", "Mat") else ()
        return self.ctype(kind) + name + "".join(f"[{self.size(n)}]" for n in lengths)


def block_comment(text: str) -> str:
    if not text:
        return ""
    lines = text.splitlines()
    return "/* " + "\n".join([lines[0], *((" * " + line.strip()).rstrip() for line in lines[1:])]) + " */\n"


def copies(text: str) -> list[str]:
    """Return the definitions of the COPIES that a text calls."""
    return [
        f"static void lagc_{name}({kind} *to, const {kind} *from, int n)\n{{\n"
        "    (void)memmove(to, from, (size_t)n * sizeof *to);\n}\n"
        for name, kind in COPIES.items()
        if f"lagc_{name}(" in text
    ]


def first_sentence(text: str) -> str:
    """Return the first sentence of a description, on one line."""
    return re.split(r"(?<=[^A-Z][.:])\s+(?=[A-Z`])", " ".join(text.split()), maxsplit=1)[0]


def ignored(names: Iterable[str]) -> str:
    """Return statements that say that parameters are not used, on one line."""
    return " ".join(f"(void){name};" for name in names)


def folded(line: str) -> str:
    """Break a long line before an operator or after a comma. Its indentation will be half of what it is."""
    lead = len(line) - len(line.lstrip())
    indent, width = " " * (lead + 8), WIDTH + lead // 2
    rows = []
    while len(line) > width:
        cuts = [line.rfind(sign, len(indent) + 12, width) for sign in _BREAKS]
        cut = max(*cuts, line.rfind(", ", len(indent) + 12, width) + 1)
        if cut < 1:
            break
        rows.append(line[:cut])
        line = indent + line[cut + 1 :]
    return "\n".join([*rows, line])


def snake(name: str) -> str:
    """Return the name of a record in C: start_work for StartWork."""
    return "".join(f"_{c.lower()}" if c.isupper() else c for c in name).lstrip("_")
