"""Exit codes, and wrong usage."""

from __future__ import annotations

import errno
from collections.abc import Iterable

from lagc.diagnostics.faults import Fault

DONE = 0
REFUSED = 1
USAGE = 2
FAILED = 3
LIMITED = 4  # a limit of time or memory was reached, or would be
INTERNAL = 70  # an error of lagc itself (EX_SOFTWARE of sysexits.h)
UNWRITTEN = 74  # a file or standard output could not be written (EX_IOERR)
INTERRUPTED = 130  # by Ctrl-C; 128 + its number by another signal

# What the user can see before: there is no such folder, it is a file, it may not be written.
_WRONG_PATH = {errno.ENOENT, errno.ENOTDIR, errno.EISDIR, errno.EEXIST, errno.EACCES, errno.EPERM,
               errno.EROFS, errno.ENAMETOOLONG, errno.ELOOP, errno.EINVAL}  # fmt: skip


def code_of(faults: Iterable[Fault]) -> int:
    """LIMITED where a limit was reached; REFUSED where a fault is the model's: it has a place in its text, or
    is one of its mechanics, its generated code, or its start.  Else what was asked for is wrong: USAGE."""
    faults = tuple(faults)
    if any(f.code.startswith("LAG08") for f in faults):
        return LIMITED
    return REFUSED if any(map(_of_model, faults)) else USAGE


def _of_model(fault: Fault) -> bool:
    placed = fault.span is not None and not fault.span.source.asked
    return placed or fault.code.startswith(("LAG04", "LAG05", "LAG061"))


class Usage(Exception):
    """The command line is wrong; the message says how."""


class Unwritten(Exception):
    """A file could not be written, though it was asked for rightly; the message says which."""


def cannot_write(path: str, error: OSError) -> Usage | Unwritten:
    """What is wrong where `path` cannot be written: the path, or the disk."""
    message = f"`{path}` cannot be written: {error.strerror or error}"
    return Usage(message) if error.errno in _WRONG_PATH else Unwritten(message)
