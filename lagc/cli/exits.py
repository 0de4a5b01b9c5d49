"""Exit codes, and wrong usage."""

from __future__ import annotations

DONE = 0
REFUSED = 1
USAGE = 2
FAILED = 3
INTERNAL = 70  # an error of lagc itself (EX_SOFTWARE of sysexits.h)
INTERRUPTED = 130


class Usage(Exception):
    """The command line is wrong; the message says how."""
