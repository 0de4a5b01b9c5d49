"""Tables as files: CSV, NumPy archives and Apache Parquet, by the ending of the file name.

A path that is no regular file, such as standard output, takes CSV if its name has no known ending.
"""

from __future__ import annotations

import importlib
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from lagc.base.records import dataclass
from lagc.base.text import json_text, printable
from lagc.host.atomic_write import Files, is_straight, obstacle, output
from lagc.host.packages import is_installed

if TYPE_CHECKING:
    from lagc.simulation.solution import Solution


class CannotSave(Exception):
    """The file cannot be written; the message says why."""

    def __str__(self) -> str:
        return printable(super().__str__())


@dataclass(frozen=True)
class Table:
    """Columns of numbers or texts by their names, and units of some; `metadata` is plain data.  `missing` is
    the text of NaN in a CSV file."""

    columns: Mapping[str, Sequence[Any]]
    units: Mapping[str, str]
    metadata: Mapping[str, object]
    missing: str = "nan"


def check_path(path: str, needs: Mapping[str, Sequence[str]] | None = None) -> str:
    """Return the ending that gives the format of `path`.  `needs` has the packages of each ending; default:
    those of a run.  Raises CannotSave if the ending is unknown, a package is missing or the file cannot be
    written."""
    ending, needs = os.path.splitext(path)[1].lower(), needs or NEEDS
    if ending not in needs and is_straight(path):
        return ".csv"
    if ending not in needs:
        known = " ".join(needs)
        raise CannotSave(f"`{path}` cannot be written: the ending gives the format, one of {known}")
    for package in needs[ending]:
        if not is_installed(package):
            raise CannotSave(f"`{path}` needs the package {package}: pip install {package}")
    for each in targets(path):
        reason = obstacle(each)
        if reason:
            raise CannotSave(f"`{each}` cannot be written: {reason}")
    return ending


def targets(path: str) -> tuple[str, ...]:
    """The files that are written when a table is saved as `path`."""
    return (path, f"{path}.json") if path.lower().endswith(".csv") else (path,)


def save(solution: Solution, path: str, units: bool = False) -> None:
    """Write `solution`; `units` adds the units to the header of a CSV file.  Raises CannotSave."""
    ending = check_path(path)
    columns = {"time": solution.times, **{name: solution.column(name) for name in solution.columns}}
    found = Table(columns, {"time": "s", **solution.units}, solution.metadata())
    with writing(path) as files:
        write(found, files, path, ending, units)


@contextmanager
def writing(path: str) -> Iterator[Files]:
    """Yield the files that are written for a table `path`.  Raises CannotSave."""
    try:
        with Files() as files:
            yield files
    except OSError as error:
        if isinstance(error, BrokenPipeError) and output(path) == 1:
            return  # a reader such as `head` has closed the pipe
        raise CannotSave(f"`{path}` cannot be written: {error.strerror or error}") from None


def write(table: Table, files: Files, path: str, ending: str, units: bool = False) -> None:
    """Write a table in the format of an ending.  Raises OSError."""
    if ending == ".csv":
        _write_csv(table, files, path, units)
    elif ending == ".npz":
        _write_npz(table, files.open(path))
    else:
        _write_parquet(table, files.open(path))


def _write_csv(table: Table, files: Files, path: str, units: bool) -> None:
    """Comma-separated values (RFC 4180), all digits. The metadata goes into `PATH.json`, because RFC 4180 has
    no comments; a path that does not end in .csv, such as a pipe, has no such file.  The metadata is in place
    before the numbers."""
    known = table.units if units else {}
    header = [quoted(f"{name} [{known[name]}]" if known.get(name) else name) for name in table.columns]
    for beside in targets(path)[1:]:
        files.open(beside).write(f"{json_text(table.metadata, indent=1)}\n".encode())
    numbers = files.open(path)
    numbers.write(f"{','.join(header)}\r\n".encode())
    for row in zip(*[_cells(column, table.missing) for column in table.columns.values()]):
        numbers.write(f"{','.join(row)}\r\n".encode())


def _cells(column: Sequence[Any], missing: str) -> Iterable[str]:
    if len(column) and isinstance(column[0], str):
        return map(quoted, column)
    return (float.__repr__(x) if x == x else missing for x in column)


def quoted(text: str) -> str:
    """`text` as a CSV field: in quotes if it contains a comma, a quote or a line end."""
    if any(c in text for c in ',"\r\n'):
        return '"' + text.replace('"', '""') + '"'
    return text


def _write_npz(table: Table, file: Any) -> None:
    """NumPy's archive: one array for each column, and `metadata` as JSON text. If a column has that name, the
    metadata is called `metadata_`.  The same run gives the same bytes."""
    from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

    import numpy

    arrays: dict[str, Any] = {name: numpy.array(column) for name, column in table.columns.items()}
    own = "metadata"
    while own in arrays:
        own += "_"
    arrays[own] = numpy.array(json_text(table.metadata))
    with ZipFile(file, "w") as archive:
        for name, array in arrays.items():
            entry = ZipInfo(f"{name}.npy")  # without a date
            entry.compress_type = ZIP_DEFLATED
            with archive.open(entry, "w", force_zip64=True) as part:
                numpy.lib.format.write_array(part, array, allow_pickle=False)


def _write_parquet(table: Table, file: Any) -> None:
    """Apache Parquet, written by pyarrow: units are in the fields of columns, the metadata in the schema."""
    pyarrow = importlib.import_module("pyarrow")
    parquet = importlib.import_module("pyarrow.parquet")
    columns = {name: pyarrow.array(column) for name, column in table.columns.items()}
    units = table.units
    fields = [pyarrow.field(n, c.type, metadata={"unit": units.get(n, "")}) for n, c in columns.items()]
    schema = pyarrow.schema(fields, metadata={"lagc": json_text(table.metadata)})
    parquet.write_table(pyarrow.table(columns, schema=schema), file)


NEEDS: Mapping[str, Sequence[str]] = {".csv": (), ".npz": (), ".parquet": ("pyarrow",)}
