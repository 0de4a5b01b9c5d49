"""The catalogue of faults: the meaning of each code, with a wrong and a right example.

Each module below has a table `ENTRIES`, code -> Entry.  `wrong` and `right` are complete models that tests
run: the first gives the code, the second is accepted.  They are empty if the fault does not come from the
text of a model.
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
    """Return every entry in the order of the codes.  Raises ValueError if a code occurs twice."""
    found: dict[str, Entry] = {}
    for room in ROOMS:
        table: dict[str, Entry] = importlib.import_module(f"{__name__}.{room}").ENTRIES
        for code, entry in table.items():
            if code in found:
                raise ValueError(f"{code} is in the catalogue twice")
            found[code] = entry
    return dict(sorted(found.items()))
