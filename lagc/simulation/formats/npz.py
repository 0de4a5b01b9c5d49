"""NumPy's archive: an array a column, and `metadata` as JSON text; that is `metadata_` where a column
has the name."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from lagc.base.printable import json_text
from lagc.host.atomic_write import Files

if TYPE_CHECKING:
    from lagc.simulation.solution import Solution


def write(solution: Solution, path: str, units: bool) -> None:
    """Units are in the metadata, whatever `units` is.  The same run gives the same bytes."""
    import numpy

    arrays: dict[str, Any] = {"time": solution.t, **{name: solution[name] for name in solution.columns}}
    own = "metadata"
    while own in arrays:
        own += "_"
    arrays[own] = numpy.array(json_text(solution.metadata()))
    with Files() as files, ZipFile(files.open(path), "w") as archive:
        for name, array in arrays.items():
            entry = ZipInfo(f"{name}.npy")  # without a date
            entry.compress_type = ZIP_DEFLATED
            with archive.open(entry, "w", force_zip64=True) as file:
                numpy.lib.format.write_array(file, array, allow_pickle=False)
