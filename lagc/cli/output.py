"""What commands print, and where: results on standard output, everything else on standard error.

All that is printed goes through here.  It never steers a terminal, whatever a model is called, and it
never fails: what standard output did not take is remembered, and told at the end by `code`.
"""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Iterable
from contextlib import suppress
from time import perf_counter
from typing import TextIO

from lagc.base.text import json_text, one_line, printable
from lagc.cli.signals import SIGNALS
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


PATIENCE = 1.0  # s before the bar appears
REDRAW = 0.1  # s between two drawings
WIDTH = 30


class Bar:
    """Called with the time reached.  A run may begin again from 0: the bar follows.

    A signal waits for the next call, so that the run ends with all that it computed; the second one
    does not wait, nor one that comes where nothing was computed yet.
    """

    def __init__(self, stop: float, quiet: bool = False):
        self.stop = stop
        self.shown = False
        self.wanted = not quiet and sys.stderr is not None and sys.stderr.isatty()
        self.next = perf_counter() + PATIENCE

    def __enter__(self) -> Bar:
        return self

    def __exit__(self, *_: object) -> None:
        SIGNALS.patient = False
        if self.shown:
            draw("\r\033[K")

    def __call__(self, t: float) -> None:
        if SIGNALS.noted:
            raise KeyboardInterrupt
        SIGNALS.patient = t > 0.0
        if not self.wanted or perf_counter() < self.next:
            return
        self.next = perf_counter() + REDRAW
        self.shown = True
        part = min(max(t / self.stop, 0.0), 1.0) if self.stop > 0.0 else 1.0
        done = int(WIDTH * part)
        bar = "#" * done + "." * (WIDTH - done)
        draw(f"\r[{bar}] {100 * part:3.0f} %  t = {t:.4g} s of {self.stop:.4g} s\033[K")
