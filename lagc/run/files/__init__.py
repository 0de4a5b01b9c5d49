"""Solutions as files: the ending of the name says the format, one file here a format."""

from __future__ import annotations

import importlib
import os
from importlib.util import find_spec
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from lagc.run.solution import Solution

FORMATS = {".csv": "csv", ".npz": "npz", ".parquet": "parquet"}
PLANNED = (".h5", ".mat")


class CannotSave(Exception):
    """The file cannot be written; the message says why."""


def check_path(path: str) -> str:
    """The format's module name.  Raises CannotSave where the ending is unknown, or the folder is absent."""
    ending = os.path.splitext(path)[1].lower()
    if ending not in FORMATS:
        known = " ".join(FORMATS)
        reason = f"{ending} is not built yet" if ending in PLANNED else "the ending says the format"
        raise CannotSave(f"`{path}` cannot be written: {reason}; there are {known}")
    if ending == ".parquet" and find_spec("pyarrow") is None:
        raise CannotSave(f"`{path}` needs the package pyarrow: pip install 'lagc[parquet]'")
    for each in (path, f"{path}.json") if ending == ".csv" else (path,):
        reason = _obstacle(each)
        if reason:
            raise CannotSave(f"`{each}` cannot be written: {reason}")
    return FORMATS[ending]


def _obstacle(path: str) -> str:
    """Why `path` cannot be written, as far as can be seen; empty where nothing is in the way."""
    folder = os.path.dirname(path if not os.path.islink(path) else os.path.realpath(path)) or "."
    if not os.path.isdir(folder):
        return f"there is no folder `{folder}`"
    if os.path.isdir(path):
        return "it is a folder"
    beside = [] if os.path.exists(path) and not os.path.isfile(path) else [folder]
    if not all(os.access(each, os.W_OK) for each in (path, *beside) if os.path.exists(each)):
        return "permission denied"
    return ""


def save(solution: Solution, path: str, units: bool = False) -> None:
    """Write `solution`.  Raises CannotSave."""
    module = importlib.import_module(f"{__name__}.{check_path(path)}")
    try:
        module.write(solution, path, units)
    except OSError as error:
        raise CannotSave(f"`{path}` cannot be written: {error.strerror or error}") from None
