"""What was computed goes where it was asked for: into files first, then it is printed, on standard error
where standard output has taken the numbers."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext, redirect_stdout
from typing import TYPE_CHECKING

from lagc.cli.output import DONE, FAILED, INTERRUPTED, LIMITED, UNWRITTEN, Usage, print_json, say, show
from lagc.cli.signals import SIGNALS
from lagc.host.atomic_write import output
from lagc.host.budgets import reached, rest

if TYPE_CHECKING:
    from lagc.api import Run
    from lagc.compiler.pipeline import Compilation
    from lagc.lowering.program import Interface


def deliver(found: Run, options: argparse.Namespace) -> int:
    """Write, draw and print `found`, also where the run failed; the exit code.  Of a run that was interrupted
    at its start there is nothing to be kept, and a file that is there stays."""
    rest()
    begun = len(found) > 1 or not found.interrupted
    picture = picture_of(found.system.interface, options.plot) if begun else ""
    with SIGNALS.patience():
        written = not (options.output and begun) or _save(found, options)
        drawn = not picture or _draw(found, picture, options)
    with beside(options.output):
        _print(found, options)
    if options.plot == "" and begun and not picture:
        from lagc.reports.plots.plot import show as show_picture

        show_picture(found)
    if found.interrupted:
        say(found.message, options.quiet)
        return LIMITED if reached() else INTERRUPTED
    if found.status == "failed":
        say(f"error[LAG0620]: {found.message}", options.json)
    if not (written and drawn):
        return UNWRITTEN
    return FAILED if found.status == "failed" else DONE


def beside(path: str | None) -> AbstractContextManager[object]:
    """What is printed within goes to standard error where the file `path` is standard output."""
    return redirect_stdout(sys.stderr) if path and output(path) == 1 else nullcontext()


def _print(found: Run, options: argparse.Namespace) -> None:
    if options.json:
        print_json(found.to_dict())
    else:
        from lagc.cli.summary import summary

        show(summary(found, options.scene is None, quiet=options.quiet, verbose=options.verbose) + "\n")


def _save(found: Run, options: argparse.Namespace) -> bool:
    from lagc.simulation.formats import CannotSave

    wanted: str = options.output
    path = kept(wanted, lambda name: found.save(name, units=options.units), (CannotSave, OSError))
    if path is not None:
        say(f"{len(found)} points written to {path}", options.quiet or options.json)
    return path == wanted


def picture_of(interface: Interface, named: str | None) -> str:
    """The file that is drawn into: the one named or, where there is no screen, one beside; else none."""
    if named != "":
        return named or ""
    from lagc.reports.plots.plot import has_display, path_beside

    return "" if has_display() else path_beside(interface)


def _draw(found: Run, wanted: str, options: argparse.Namespace) -> bool:
    from lagc.reports.plots.plot import plot

    path = kept(wanted, lambda name: plot(found, path=name), (OSError, ValueError, ArithmeticError))
    if path is not None:
        say(f"picture written to {path}", options.quiet or options.json)
    return path == wanted


def kept(
    path: str, write: Callable[[str], object], failures: tuple[type[Exception], ...], usual: str = ".csv"
) -> str | None:
    """Let `write` make the file `path` or, where that fails in the end, one of a new name in the current
    folder or in that of temporary files, of the `usual` ending where it has none, and say so; the name of
    what was written.  What waits for others is given up where a signal comes."""
    from lagc.host.atomic_write import may_wait, shortened

    waiting = may_wait(path)
    try:
        with SIGNALS.patience(not waiting):
            write(path)
        return path
    except failures as error:
        say(f"lagc: {_reason(path, error)}")
    except KeyboardInterrupt:
        if not waiting:
            raise
        say(f"lagc: `{path}` is not written: interrupted")
    import tempfile

    stem, ending = os.path.splitext(os.path.basename(path))
    name = f"{shortened(stem)}-{os.urandom(4).hex()}{ending or usual}"
    for folder in (os.getcwd, tempfile.gettempdir):
        try:
            other = os.path.join(folder(), name)
            write(other)
        except failures:
            continue
        say(f"lagc: it is kept in {other}")
        return other
    say("lagc: it could not be kept elsewhere")
    return None


def _reason(path: str, error: Exception) -> str:
    if isinstance(error, OSError):
        return f"`{path}` cannot be written: {error.strerror or error}"
    return str(error)


def spare(compilation: Compilation, *paths: str | None) -> None:
    """Raises Usage where one of these is the file of the model, or one that it reads, links followed."""
    files = [compilation.source.name, *(compilation.read.paths if compilation.read else ())]
    read = set(map(_real, files))
    for path in paths:
        if path and _real(path) in read:
            raise Usage(f"`{path}` is read by the model, and not written over: name another file")


def _real(path: str) -> str:
    """Itself where the folder that it is relative to is gone."""
    try:
        return os.path.realpath(path)
    except OSError:
        return path
