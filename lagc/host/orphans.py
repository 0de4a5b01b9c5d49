"""What processes have left behind that were killed, recognized by its name: `...PROCESS-XXXXXXXXXXXX...`."""

from __future__ import annotations

import os
import stat
from contextlib import suppress
from time import time

SOON = 3600.0  # s in which whatever is being written is done, on any machine that shares the folder
FILES = (".", ".lagc-tmp")  # what their names begin and end with
FOLDERS = ("lagc-", "")


def mark() -> str:
    """What tells this process, and this file of it, from all others."""
    return f"{os.getpid()}-{os.urandom(6).hex()}"


def sweep(folder: str, kind: tuple[str, str]) -> None:
    """Remove what was left in `folder` where nobody uses it: it is this user's, nothing has changed in it
    for long, and the process that made it is gone."""
    with suppress(OSError), os.scandir(folder) as found:
        for entry in found:
            with suppress(OSError):
                if _is_left(entry, kind):
                    _remove(entry)


def gone(process: int) -> bool:
    """Whether there is no such process; False where that cannot be told."""
    if os.name != "posix":  # elsewhere, to ask is to end it
        return False
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return True
    except (OSError, OverflowError):
        return False
    return False


def _is_left(entry: os.DirEntry[str], kind: tuple[str, str]) -> bool:
    begin, end = kind
    if not (entry.name.startswith(begin) and entry.name.endswith(end)):
        return False
    name, _, mark = entry.name[len(begin) : len(entry.name) - len(end)].rpartition(".")
    process, _, number = mark.partition("-")
    if not (process.isascii() and process.isdigit() and len(number) == 12) or (name != "") != (kind == FILES):
        return False
    status = entry.stat(follow_symlinks=False)
    right = stat.S_ISDIR if kind == FOLDERS else stat.S_ISREG
    own = hasattr(os, "geteuid") and status.st_uid == os.geteuid()
    return right(status.st_mode) and own and time() - status.st_mtime > SOON and gone(int(process))


def _remove(entry: os.DirEntry[str]) -> None:
    if entry.is_dir(follow_symlinks=False):
        import shutil

        shutil.rmtree(entry.path, ignore_errors=True)
    else:
        os.unlink(entry.path)
