"""Comma-separated values, RFC 4180: `time` first, a column a quantity, every digit.

A reader takes the first line for the header; what else is known of the run goes into
`NAME.csv.json` beside it, for RFC 4180 has no comments.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from lagc.run.solution import Solution


def write(solution: Solution, path: str, units: bool) -> None:
    """`units`: in the header, after each name."""
    names = solution.columns
    known = {"time": "s", **solution.units}
    header = [f"{n} [{known[n]}]" if units and known[n] else n for n in ("time", *names)]
    columns = [solution.times, *(solution.column(name) for name in names)]
    with open(path, "w", encoding="utf-8", newline="") as file:
        file.write(",".join(quoted(name) for name in header) + "\r\n")
        for row in zip(*columns):
            file.write(",".join(map(repr, row)) + "\r\n")
    with open(path + ".json", "w", encoding="utf-8") as file:
        json.dump(solution.metadata(), file, indent=1, ensure_ascii=False)
        file.write("\n")


def quoted(text: str) -> str:
    """`text` as a field: in quotes where it holds a comma, a quote or a line end."""
    if any(c in text for c in ',"\r\n'):
        return '"' + text.replace('"', '""') + '"'
    return text
