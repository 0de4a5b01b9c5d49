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
    folder = os.path.dirname(path) or "."
    if not os.path.isdir(folder):
        raise CannotSave(f"`{path}` cannot be written: there is no folder `{folder}`")
    if os.path.isdir(path):
        raise CannotSave(f"`{path}` cannot be written: it is a folder")
    if not os.access(path if os.path.exists(path) else folder, os.W_OK):
        raise CannotSave(f"`{path}` cannot be written: permission denied")
    return FORMATS[ending]


def save(solution: Solution, path: str, units: bool = False) -> None:
    """Write `solution`.  Raises CannotSave."""
    module = importlib.import_module(f"{__name__}.{check_path(path)}")
    try:
        module.write(solution, path, units)
    except OSError as error:
        raise CannotSave(f"`{path}` cannot be written: {error.strerror or error}") from None
