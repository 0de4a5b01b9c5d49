"""Exit codes, and wrong usage."""

from __future__ import annotations

from collections.abc import Iterable

from lagc.diagnostics.faults import Fault

DONE = 0
REFUSED = 1
USAGE = 2
FAILED = 3
INTERNAL = 70  # an error of lagc itself (EX_SOFTWARE of sysexits.h)
INTERRUPTED = 130


def code_of(faults: Iterable[Fault]) -> int:
    """REFUSED where a fault is the model's: it has a place in a file, or is one of its mechanics,
    of its generated code, or of its start.  Else what was asked for is wrong: USAGE."""
    of_model = any(f.span is not None or f.code.startswith(("LAG04", "LAG05", "LAG061")) for f in faults)
    return REFUSED if of_model else USAGE


class Usage(Exception):
    """The command line is wrong; the message says how."""
