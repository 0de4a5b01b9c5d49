"""Exit codes, messages and printing: results go to standard output, everything else to standard error.

All output passes through this file.  It contains no control characters, and printing never fails: an error
of standard output is remembered and reported at the end by `code`.
"""

from __future__ import annotations

import errno
import os
import re
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

# Errors of the path itself: the folder does not exist, the path is a folder, it is not writable.
_WRONG_PATH = {errno.ENOENT, errno.ENOTDIR, errno.EISDIR, errno.EEXIST, errno.EACCES, errno.EPERM,
               errno.EROFS, errno.ENAMETOOLONG, errno.ELOOP, errno.EINVAL}  # fmt: skip


def code_of(faults: Iterable[Fault]) -> int:
    """Return the exit code for faults: LIMITED for a limit, REFUSED for a fault of the model, USAGE for a
    wrong request.

    A fault is the model's if it has a place in its text, or concerns its mechanics, code or initial state.
    """
    faults = tuple(faults)
    if any(f.code.startswith("LAG08") for f in faults):
        return LIMITED
    return REFUSED if any(map(_of_model, faults)) else USAGE


def _of_model(fault: Fault) -> bool:
    placed = fault.span is not None and not fault.span.source.asked
    return placed or fault.code.startswith(("LAG04", "LAG05", "LAG061"))


class Usage(Exception):
    """The command line is wrong; the message tells how."""


class Unwritten(Exception):
    """A file could not be written although the request is valid; the message tells which."""


def cannot_write(path: str, error: OSError) -> Usage | Unwritten:
    """Return the error for a `path` that cannot be written: wrong path (Usage) or full disk (Unwritten)."""
    from lagc.host.atomic_write import obstacle

    reason = obstacle(path) if error.errno == errno.ENOENT else ""
    message = f"`{path}` cannot be written: {reason or error.strerror or error}"
    return Usage(message) if error.errno in _WRONG_PATH else Unwritten(message)


_lost: list[str] = []  # why standard output cannot be written, if it is an error


def begin() -> None:
    """Open the null device for closed standard streams, so that no other file takes their numbers."""
    _lost.clear()
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            with suppress(OSError):
                os.open(os.devnull, os.O_RDONLY)  # takes the first free number; not to be written to


def code(done: int) -> int:
    """Return the exit code of a command that ended with `done`; reports an error of standard output.

    A reader that closed the pipe, as in `lagc ... | head`, is no error.
    """
    if not _lost:
        return done
    say(f"lagc: standard output cannot be written: {_lost[0]}")
    return UNWRITTEN if done == DONE else done


def show(text: str, exact: bool = False) -> None:
    """Print a result.  `exact`: without replacing characters, unless it goes to a terminal."""
    on_terminal = sys.stdout is not None and sys.stdout.isatty()
    _write_out(text if exact and not on_terminal else printable(text))


def show_report(text: str, color: bool | None = None) -> None:
    """Print a report: in colour its first line is bold, and the words that begin a line have one; those that
    tell of a failure are red."""
    text = printable(text)
    if use_color(sys.stdout, color):
        title, end, rest = text.partition("\n")
        rest = re.sub(r"(?m)^  (failed|warning)\b", "  \033[1;31m\\1\033[0m", rest)
        text = f"\033[1m{title}\033[0m{end}" + re.sub(
            r"(?m)^  ([a-z][a-z ]*?)(?=  )", "  \033[36m\\1\033[0m", rest
        )
    _write_out(text)


def _write_out(text: str) -> None:
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
    """Print a line about progress on standard error."""
    if not quiet:
        draw(one_line(message) + "\n")


def draw(text: str) -> None:
    """Write `text` to standard error as it is; errors are ignored."""
    stream = sys.stderr
    if stream is not None:
        try:
            _write(stream, text)
        except (OSError, ValueError):
            _silence(stream)


def use_color(stream: TextIO | None, wanted: bool | None = None) -> bool:
    """Return whether to colour the text for `stream`: on a terminal, unless NO_COLOR is set or `wanted`
    decides."""
    if wanted is not None or stream is None:
        return bool(wanted)
    return not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb" and stream.isatty()


def print_faults(
    faults: Iterable[Fault], color: bool | None = None, result: bool = False, more: str = ""
) -> None:
    """Print faults on standard error, or on standard output if they are the `result`."""
    from lagc.diagnostics.faults import report

    text = report(list(faults), use_color(sys.stdout if result else sys.stderr, color), more) + "\n"
    (_write_out if result else draw)(text)


def print_json(value: object) -> None:
    """One JSON object on standard output."""
    encoding = getattr(sys.stdout, "encoding", None) or "utf-8"
    _write_out(json_text(value, indent=2, encoding=encoding) + "\n")


def _write(stream: TextIO, text: str) -> None:
    try:
        stream.write(text)
    except UnicodeEncodeError:  # the encoding lacks these characters
        stream.write(text.encode(stream.encoding, "backslashreplace").decode(stream.encoding))
    stream.flush()


def _silence(stream: TextIO) -> None:
    """Redirect a broken stream to the null device, so that it does not fail again at exit."""
    with suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)


PATIENCE = 1.0  # s before the bar appears
REDRAW = 0.1  # s between two updates
WIDTH = 30


class Bar:
    """A progress bar on a terminal, for runs longer than a second; called with the time reached.

    A signal waits for the next call, so that the run ends with all its results.  A second signal, or one
    before the first step, does not wait.
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
        part = min(max(t / self.stop, 0.0), 1.0) if self.stop > 0.0 else 1.0
        self.part(part, f"t = {t:.4g} s of {self.stop:.4g} s")

    def part(self, part: float, doing: str) -> None:
        """Draw a part done, from 0 to 1, and what is being done."""
        if SIGNALS.noted:
            raise KeyboardInterrupt
        SIGNALS.patient = part > 0.0
        if not self.wanted or perf_counter() < self.next:
            return
        self.next = perf_counter() + REDRAW
        self.shown = True
        done = int(WIDTH * part)
        bar = "#" * done + "." * (WIDTH - done)
        draw(f"\r[{bar}] {100 * part:3.0f} %  {doing}\033[K")
