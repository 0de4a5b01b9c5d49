"""Comma-separated values, RFC 4180: `time` first, a column a quantity, every digit.

A reader takes the first line for the header; what else is known of the run goes into
`NAME.csv.json` beside it, for RFC 4180 has no comments.  A pipe of another name has nothing beside it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from lagc.base.printable import json_text
from lagc.host.atomic_write import Files

if TYPE_CHECKING:
    from lagc.simulation.solution import Solution


def write(solution: Solution, path: str, units: bool) -> None:
    """`units`: in the header, after each name.  The numbers take their place last: where there are new
    ones, there is also what is known of them."""
    names = solution.columns
    known = {"time": "s", **solution.units}
    header = [f"{n} [{known[n]}]" if units and known[n] else n for n in ("time", *names)]
    columns = [solution.times, *(solution.column(name) for name in names)]
    with Files() as files:
        if path.lower().endswith(".csv"):
            files.open(f"{path}.json").write(f"{json_text(solution.metadata(), indent=1)}\n".encode())
        numbers = files.open(path)
        numbers.write(f"{','.join(quoted(name) for name in header)}\r\n".encode())
        for row in zip(*columns):
            numbers.write(f"{','.join(map(repr, row))}\r\n".encode())


def quoted(text: str) -> str:
    """`text` as a field: in quotes where it holds a comma, a quote or a line end."""
    if any(c in text for c in ',"\r\n'):
        return '"' + text.replace('"', '""') + '"'
    return text
