"""The catalogue of faults: what each code means, with a wrong and a right example.

One table a room (`ENTRIES` of the modules below), code -> Entry.  `wrong` and `right` are
complete model texts; tests run them: the first brings the code, the second is accepted.  They are
empty where a fault is no matter of a model's text (a file that cannot be read).
"""

from __future__ import annotations

import importlib

from lagc.base.records import dataclass

ROOMS = ("syntax", "semantics", "mechanics", "simulation", "files")


@dataclass(frozen=True, slots=True)
class Entry:
    title: str
    explanation: str
    wrong: str = ""
    right: str = ""


def entries() -> dict[str, Entry]:
    """Every entry, in the order of the codes.  Raises ValueError where two rooms claim a code."""
    found: dict[str, Entry] = {}
    for room in ROOMS:
        table: dict[str, Entry] = importlib.import_module(f"{__name__}.{room}").ENTRIES
        for code, entry in table.items():
            if code in found:
                raise ValueError(f"{code} is in the catalogue twice")
            found[code] = entry
    return dict(sorted(found.items()))
