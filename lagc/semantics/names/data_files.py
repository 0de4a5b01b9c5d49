"""Columns of numbers from files of comma-separated values (RFC 4180)."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

from lagc.base.records import dataclass

MOST_ROWS = 1_000_000
_INDEX = re.compile(r"\s*\d+(?:\s*,\s*\d+)*\s*", re.ASCII)
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)


class Unfit(Exception):
    """A file without columns of numbers; the message follows the name of the file."""

    def __init__(self, message: str, remedy: str | None = None):
        super().__init__(message)
        self.remedy = remedy


@dataclass(frozen=True)
class Columns:
    """`heads`: name and unit (None if absent) of each column."""

    heads: Sequence[tuple[str, str | None]]
    rows: Sequence[tuple[int, list[str]]]  # line and cells

    def place(self, name: str) -> int | None:
        """Return the index of the column called `name`, or None."""
        return next((k for k, (head, _) in enumerate(self.heads) if head == name), None)

    def numbers(self, k: int) -> list[float]:
        """Return the numbers of column k in its unit.  Raises Unfit."""
        found = []
        for line, cells in self.rows:
            cell = cells[k].strip()
            if not _NUMBER.fullmatch(cell) or not math.isfinite(float(cell)):
                shown = f"`{cell}` is not a finite number" if cell else "the cell is empty"
                raise Unfit(f"has no value of `{self.heads[k][0]}` in line {line}: {shown}")
            found.append(float(cell))
        return found


def columns(text: str) -> Columns:
    """Read a line of column names, some with a unit (`u [N]`), and lines with as many numbers.  Raises
    Unfit."""
    import csv  # where a model looks numbers up

    reader = csv.reader(text.splitlines(), strict=True)
    rows: list[tuple[int, list[str]]] = []
    try:
        for cells in reader:
            if len(rows) > MOST_ROWS:
                raise Unfit(f"has more than {MOST_ROWS:,} rows")
            rows.append((reader.line_num, cells))
    except csv.Error as error:
        raise Unfit(f"is not a file of comma-separated values: {error} in line {reader.line_num}") from None
    while rows and not rows[-1][1]:
        rows.pop()
    if not rows:
        raise Unfit("is empty", "name the columns in the first line: `time,u`")
    (_, names), *rows = rows
    heads = [_head(name) for name in names]
    if any(_NUMBER.fullmatch(name) for name, _ in heads):
        raise Unfit("has no column names", "name the columns in the first line: `time,u` or `time [s],u [N]`")
    for k, (name, _) in enumerate(heads):
        if name in [other for other, _ in heads[:k]]:
            raise Unfit(f"has two columns called `{name}`")
    for line, cells in rows:
        if len(cells) != len(heads):
            message = f"has {len(heads)} columns, but {len(cells)} values in line {line}"
            raise Unfit(message, "separate the numbers by commas and write decimals with a point")
    return Columns(heads, rows)


def _head(written: str) -> tuple[str, str | None]:
    """Return name and unit.  An index right after a name belongs to the name: `th[1]`, `K[1,2] [N/m]`."""
    text = written.strip()
    name, bracket, inner = text[:-1].rpartition("[")
    if not (text.endswith("]") and bracket) or "]" in inner:
        return text, None
    if name[-1:].strip() and _INDEX.fullmatch(inner):
        return text, None
    return name.rstrip(), inner
