"""NumPy's archive: an array a column, and `metadata` as JSON text."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from lagc.run.solution import Solution


def write(solution: Solution, path: str, units: bool) -> None:
    """Units are in the metadata, whatever `units` is."""
    import numpy

    arrays: dict[str, Any] = {"time": solution.t, **{name: solution[name] for name in solution.columns}}
    arrays["metadata"] = numpy.array(json.dumps(solution.metadata()))
    with open(path, "wb") as file:
        numpy.savez_compressed(file, **arrays)
