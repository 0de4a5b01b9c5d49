"""Solutions as files: CSV, NumPy archives and Apache Parquet, by the ending of the file name.

A path that is no regular file, such as standard output, takes CSV if its name has no known ending.
"""

from __future__ import annotations

import importlib
import os
from typing import TYPE_CHECKING, Any

from lagc.base.text import json_text, printable
from lagc.host.atomic_write import Files, is_straight, obstacle, output
from lagc.host.packages import is_installed

if TYPE_CHECKING:
    from lagc.simulation.solution import Solution


class CannotSave(Exception):
    """The file cannot be written; the message says why."""

    def __str__(self) -> str:
        return printable(super().__str__())


def check_path(path: str) -> str:
    """Return the ending that gives the format of `path`. Raises CannotSave if the ending is unknown, a
    package is missing or the file cannot be written."""
    ending = os.path.splitext(path)[1].lower()
    if ending not in WRITERS and is_straight(path):
        return ".csv"
    if ending not in WRITERS:
        known = " ".join(WRITERS)
        raise CannotSave(f"`{path}` cannot be written: the ending gives the format, one of {known}")
    if ending == ".parquet" and not is_installed("pyarrow"):
        raise CannotSave(f"`{path}` needs the package pyarrow: pip install pyarrow")
    for each in targets(path):
        reason = obstacle(each)
        if reason:
            raise CannotSave(f"`{each}` cannot be written: {reason}")
    return ending


def targets(path: str) -> tuple[str, ...]:
    """The files that are written when a solution is saved as `path`."""
    return (path, f"{path}.json") if path.lower().endswith(".csv") else (path,)


def save(solution: Solution, path: str, units: bool = False) -> None:
    """Write `solution`; `units` adds the units to the header of a CSV file.  Raises CannotSave."""
    ending = check_path(path)
    try:
        if ending == ".csv":
            write_csv(solution, path, units)
        else:
            WRITERS[ending](solution, path)
    except OSError as error:
        if isinstance(error, BrokenPipeError) and output(path) == 1:
            return  # a reader such as `head` has closed the pipe
        raise CannotSave(f"`{path}` cannot be written: {error.strerror or error}") from None


def write_csv(solution: Solution, path: str, units: bool = False) -> None:
    """Comma-separated values (RFC 4180): `time` first, one column for each quantity, all digits. The metadata
    goes into `PATH.json`, because RFC 4180 has no comments; a path that does not end in .csv, such as a pipe,
    has no such file.  The metadata is in place before the numbers."""
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
    """`text` as a CSV field: in quotes if it contains a comma, a quote or a line end."""
    if any(c in text for c in ',"\r\n'):
        return '"' + text.replace('"', '""') + '"'
    return text


def write_npz(solution: Solution, path: str) -> None:
    """NumPy's archive: one array for each column, and `metadata` as JSON text. If a column has that name, the
    metadata is called `metadata_`.  The same run gives the same bytes."""
    from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

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


def write_parquet(solution: Solution, path: str) -> None:
    """Apache Parquet, written by pyarrow: one column for each quantity, its unit in the field, the metadata
    in the schema."""
    pyarrow = importlib.import_module("pyarrow")
    parquet = importlib.import_module("pyarrow.parquet")

    known = {"time": "s", **solution.units}
    columns = {"time": solution.times, **{name: solution.column(name) for name in solution.columns}}
    fields = [pyarrow.field(n, pyarrow.float64(), metadata={"unit": known[n]}) for n in columns]
    schema = pyarrow.schema(fields, metadata={"lagc": json_text(solution.metadata())})
    with Files() as files:
        parquet.write_table(pyarrow.table(columns, schema=schema), files.open(path))


WRITERS = {".csv": write_csv, ".npz": write_npz, ".parquet": write_parquet}
