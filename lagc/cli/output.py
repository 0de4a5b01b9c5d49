"""What commands print, and where: results on standard output, everything else on standard error."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable
from typing import TextIO

from lagc.diagnostics.faults import Fault


def use_color(stream: TextIO, wanted: bool | None = None) -> bool:
    """Whether to colour what goes to `stream`: on a terminal, unless NO_COLOR is set or
    `wanted` says otherwise."""
    if wanted is not None:
        return wanted
    return not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb" and stream.isatty()


def print_faults(faults: Iterable[Fault], color: bool | None = None, stream: TextIO | None = None) -> None:
    from lagc.diagnostics.report import report

    stream = stream or sys.stderr
    print(report(list(faults), color=use_color(stream, color)), file=stream)


def say(message: str, quiet: bool = False) -> None:
    """A line about what is done, on standard error."""
    if not quiet:
        print(message, file=sys.stderr)


def print_json(value: object) -> None:
    """One JSON object on standard output; numbers that are not finite become null."""
    import json

    print(json.dumps(finite(value), indent=2, ensure_ascii=False, allow_nan=False))


def finite(value: object) -> object:
    """`value` with every infinity and NaN replaced by None: JSON has no word for them."""
    if isinstance(value, float):
        return value if value - value == 0.0 else None
    if isinstance(value, dict):
        return {key: finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(item) for item in value]
    return value
