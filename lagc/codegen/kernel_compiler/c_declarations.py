"""Declarations, comments and long lines in C: what printers of a model share with that of kernels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from lagc.codegen.kernel_compiler.real_types import Arithmetic

CHOICE, OR, AND, BITS, EQUAL, COMPARE, SHIFT, SUM, PRODUCT, SIGN, ATOM = range(1, 12)
WIDTH = 98  # of a line


class CDeclarations:
    """Prints with `lagc_` and `LAGC_` before each name of the interface. `derived`: sizes that are
    expressions of others."""

    def __init__(self, real: Arithmetic, derived: Mapping[str, str]):
        self.real, self.derived = real, derived

    def ctype(self, kind: Sequence[str]) -> str:
        name = {
            "Real": self.real.name, "Vec": self.real.name, "Mat": self.real.name, "Rows": self.real.name,
            "int": "int", "IVec": "int", "bool": "int", "Count": "long", "Length": "size_t", "None": "void",
            "Status": "lagc_status", "Params": "lagc_params", "Pair": "void",
        }.get(kind[0])  # fmt: skip
        if kind[0] == "Cell":
            return self.ctype((kind[1],))
        return (f"lagc_{snake(kind[1])}" if name is None else name) + " "

    def size(self, name: str) -> str:
        return self.named(name)[0]

    def named(self, name: str) -> tuple[str, int]:
        if name in self.derived:
            text = self.derived[name]
            return text, PRODUCT if "*" in text else SUM if " " in text else ATOM
        return f"LAGC_{name}", ATOM

    def declared(self, kind: Sequence[str], name: str) -> str:
        """Return the declaration of a variable or member."""
        lengths = kind[1:] if kind[0] in ("Vec", "IVec", "Mat") else ()
        return self.ctype(kind) + name + "".join(f"[{self.size(n)}]" for n in lengths)


def block_comment(text: str) -> str:
    if not text:
        return ""
    lines = text.splitlines()
    return "/* " + "\n".join([lines[0], *((" * " + line.strip()).rstrip() for line in lines[1:])]) + " */\n"


def folded(line: str) -> str:
    """Break a long line before an operator or after a comma."""
    indent = " " * (len(line) - len(line.lstrip()) + 8)
    rows = []
    while len(line) > WIDTH:
        cuts = [
            line.rfind(sign, len(indent) + 12, WIDTH) for sign in (" + ", " - ", " || ", " && ", " : ", " = ")
        ]
        cut = max(*cuts, line.rfind(", ", len(indent) + 12, WIDTH) + 1)
        if cut < 1:
            break
        rows.append(line[:cut])
        line = indent + line[cut + 1 :]
    return "\n".join([*rows, line])


def wrapped(start: str, parts: Sequence[str]) -> str:
    """Return a function head with its parameters on short lines."""
    rows = [start]
    for k, part in enumerate(parts):
        text = part + ("," if k < len(parts) - 1 else ")")
        if rows[-1] != start and len(rows[-1]) + len(text) > WIDTH:
            rows[-1] = rows[-1].rstrip()
            rows.append(" " * len(start))
        rows[-1] += text + (" " if k < len(parts) - 1 else "")
    return "\n".join(rows)


def snake(name: str) -> str:
    """Return the name of a record in C: start_work for StartWork."""
    return "".join(f"_{c.lower()}" if c.isupper() else c for c in name).lstrip("_")
