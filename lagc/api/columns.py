"""Columns of numbers in a CSV file, with units in its header."""

import re
from math import nan
from typing import Any

from lagc.api.values import real
from lagc.base.text import number
from lagc.diagnostics.faults import Fault, Refused


def read_columns(path: str) -> tuple[dict[str, list[str]], list[str]]:
    """Return the columns of a CSV file by the names in its header, and the place of each row in words.
    Raises Refused: LAG0702, LAG0602 for a line of another length or other separators than commas."""
    import csv

    try:
        with open(path, encoding="utf-8-sig", newline="") as file:
            rows = csv.reader(file)
            (_, head), *lines = [(f"`{path}`, line {rows.line_num}", line) for line in rows if line]
    except (OSError, ValueError, csv.Error) as error:
        reason = getattr(error, "strerror", None) or "it is no table with a header"
        raise Refused([Fault("LAG0702", f"`{path}` cannot be read: {reason}")]) from None
    if len(head) == 1 and any(separator in head[0] for separator in ";\t"):
        message = f"`{path}` has one column, {head[0]!r}"
        raise Refused([Fault("LAG0602", message, remedy="separate columns by commas")])
    for place, line in lines:
        if len(line) != len(head):
            message = f"{place}: {len(line)} values for {len(head)} columns"
            raise Refused([Fault("LAG0602", message)])
    columns = {name.strip(): [line[k] for _, line in lines] for k, name in enumerate(head)}
    return columns, [place for place, _ in lines]


def name_and_unit(word: str) -> tuple[str, str | None]:
    """Return the name and the unit of `angle[deg]` or `angle [deg]`; None without one."""
    found = re.fullmatch(r"\s*(.*?)\s*\[([^\[\]]*)\]\s*", word)
    return (found[1], found[2].strip()) if found else (word.strip(), None)


def reading(name: str, value: Any, place: str = "") -> float:
    """Return a number of the column `name`; NaN if it is empty.  Raises Refused (LAG0602) with its place."""
    if value is None or (isinstance(value, str) and not value.strip()):
        return nan
    found = number(value.strip()) if isinstance(value, str) else real(name, value)
    if found is None:
        message = f"the column `{name}` has {value!r}, which is not a number"
        raise Refused([Fault("LAG0602", f"{place}: {message}" if place else message)])
    return found
