"""Layout of printed C: comments, long lines, names of structs."""

from __future__ import annotations

from collections.abc import Sequence

WIDTH = 98  # of a line


def block_comment(text: str) -> str:
    if not text:
        return ""
    lines = text.splitlines()
    return "/* " + "\n".join([lines[0], *((" * " + line.strip()).rstrip() for line in lines[1:])]) + " */\n"


def folded(line: str) -> str:
    """Break a long line before an operator or after a comma."""
    code, mark, note = line.partition(" /* ") if not line.lstrip().startswith("/*") else (line, "", "")
    if len(code) > WIDTH and mark:
        lead = code[: len(code) - len(code.lstrip())]
        return f"{lead}/* {note}\n{folded(code)}"
    indent = " " * (len(line) - len(line.lstrip()) + 4)
    rows = []
    while len(line) > WIDTH and not line.lstrip().startswith("/*"):
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
