"""Solutions as files: the ending of the name says the format, one file here a format.  What is no regular
file, as the standard output, takes CSV where its name does not say."""

from __future__ import annotations

import importlib
import os
from importlib.util import find_spec
from typing import TYPE_CHECKING

from lagc.base.printable import printable
from lagc.host.atomic_write import is_straight, obstacle, output

if TYPE_CHECKING:
    from lagc.simulation.solution import Solution

FORMATS = {".csv": "csv", ".npz": "npz", ".parquet": "parquet"}


class CannotSave(Exception):
    """The file cannot be written; the message says why."""

    def __str__(self) -> str:
        return printable(super().__str__())


def check_path(path: str) -> str:
    """The format's module name.  Raises CannotSave where the ending is unknown, or something is
    in the way."""
    ending = os.path.splitext(path)[1].lower()
    if ending not in FORMATS and is_straight(path):
        return "csv"
    if ending not in FORMATS:
        known = " ".join(FORMATS)
        raise CannotSave(f"`{path}` cannot be written: the ending says the format; there are {known}")
    if ending == ".parquet" and find_spec("pyarrow") is None:
        raise CannotSave(f"`{path}` needs the package pyarrow: pip install pyarrow")
    for each in targets(path):
        reason = obstacle(each)
        if reason:
            raise CannotSave(f"`{each}` cannot be written: {reason}")
    return FORMATS[ending]


def targets(path: str) -> tuple[str, ...]:
    """What is written where a solution becomes the file `path`."""
    return (path, f"{path}.json") if path.lower().endswith(".csv") else (path,)


def save(solution: Solution, path: str, units: bool = False) -> None:
    """Write `solution`.  Raises CannotSave."""
    module = importlib.import_module(f"{__name__}.{check_path(path)}")
    try:
        module.write(solution, path, units)
    except OSError as error:
        if isinstance(error, BrokenPipeError) and output(path) == 1:
            return  # the reader, as `head`, has all it wanted
        raise CannotSave(f"`{path}` cannot be written: {error.strerror or error}") from None
