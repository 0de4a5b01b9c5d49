"""What commands print, and where: results on standard output, everything else on standard error.

All that is printed goes through here.  It never steers a terminal, whatever a model is called, and it
never fails: what standard output did not take is remembered, and told at the end by `code`.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable
from contextlib import suppress
from typing import TextIO

from lagc.base.printable import json_text, one_line, printable
from lagc.cli.exits import DONE, UNWRITTEN
from lagc.diagnostics.faults import Fault

_lost: list[str] = []  # why standard output took no more, where that is a fault


def begin() -> None:
    """Take care that no file is opened where a standard stream was closed."""
    _lost.clear()
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            with suppress(OSError):
                os.open(os.devnull, os.O_RDONLY)  # takes the first free number; not to be written to


def code(done: int) -> int:
    """The exit code of a command that ended with `done`: where all went well but standard output could
    not be written, that is said.  A reader that went away, as in `lagc ... | head`, has all it wanted."""
    if not _lost:
        return done
    say(f"lagc: standard output cannot be written: {_lost[0]}")
    return UNWRITTEN if done == DONE else done


def show(text: str, exact: bool = False) -> None:
    """Print a result.  `exact`: every character as it is, unless a terminal shows it."""
    on_terminal = sys.stdout is not None and sys.stdout.isatty()
    _put(text if exact and not on_terminal else printable(text))


def _put(text: str) -> None:
    stream = sys.stdout
    if _lost:
        return
    if stream is None:
        _lost.append("it is closed")
        return
    try:
        _write(stream, text)
    except BrokenPipeError:
        _silence(stream)
    except (OSError, ValueError) as error:
        _lost.append(getattr(error, "strerror", None) or str(error))
        _silence(stream)


def say(message: str, quiet: bool = False) -> None:
    """A line about what is done, on standard error."""
    if not quiet:
        draw(one_line(message) + "\n")


def draw(text: str) -> None:
    """`text` as it is on standard error, where there is one: whom it does not reach is not there."""
    stream = sys.stderr
    if stream is not None:
        try:
            _write(stream, text)
        except (OSError, ValueError):
            _silence(stream)


def use_color(stream: TextIO | None, wanted: bool | None = None) -> bool:
    """Whether to colour what goes to `stream`: on a terminal, unless NO_COLOR is set or
    `wanted` says otherwise."""
    if wanted is not None or stream is None:
        return bool(wanted)
    return not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb" and stream.isatty()


def print_faults(
    faults: Iterable[Fault], color: bool | None = None, result: bool = False, more: str = ""
) -> None:
    """On standard error or, where they are the `result`, on standard output."""
    from lagc.diagnostics.report import report

    text = report(list(faults), use_color(sys.stdout if result else sys.stderr, color), more) + "\n"
    (_put if result else draw)(text)


def print_json(value: object) -> None:
    """One JSON object on standard output."""
    encoding = getattr(sys.stdout, "encoding", None) or "utf-8"
    _put(json_text(value, indent=2, encoding=encoding) + "\n")


def _write(stream: TextIO, text: str) -> None:
    try:
        stream.write(text)
    except UnicodeEncodeError:  # the terminal has no such letters
        stream.write(text.encode(stream.encoding, "backslashreplace").decode(stream.encoding))
    stream.flush()


def _silence(stream: TextIO) -> None:
    """What is left in its buffer goes nowhere: it would fail again when the process ends."""
    with suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)
