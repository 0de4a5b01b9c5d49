"""Deliver the result of a run: write the files, draw the plot, then print the summary.

The summary goes to standard error if standard output takes the numbers.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, nullcontext, redirect_stdout
from typing import TYPE_CHECKING

from lagc.cli.output import DONE, FAILED, INTERRUPTED, LIMITED, UNWRITTEN, Usage, print_json, say, show
from lagc.cli.pictures import animation_of, picture_of
from lagc.cli.signals import SIGNALS
from lagc.host.atomic_write import output
from lagc.host.budgets import reached, rest

if TYPE_CHECKING:
    from lagc.api_run import Run
    from lagc.compiler.pipeline import Compilation
    from lagc.reports.plots.plot import Drawing


def deliver(
    found: Run,
    options: argparse.Namespace,
    more: Mapping[str, object] | None = None,
    others: Mapping[str, Run] | None = None,
) -> int:
    """Write, draw and print the result, also of a failed run, and return the exit code.  `more` is a part of
    the JSON object, `others` are runs by their labels that pictures show beside it.

    A run that was interrupted at its initial state writes no file, and leaves existing files alone.
    """
    rest()
    begun = len(found) > 1 or not found.interrupted
    picture = picture_of(found.system.interface, options.plot) if begun else ""
    with SIGNALS.patience():
        written = not (options.output and begun) or _save(found, options)
        drawn = not picture or _draw(found, picture, options, others or {})
        film = animation_of(found.system.interface, options.animate) if begun and found.times else ""
        drawn = (not film or _animate(found, film, options, others or {})) and drawn
    with output_beside(options.output):
        _print(found, options, more or {})
    if options.plot == "" and begun and not picture:
        from lagc.reports.plots.plot import show as show_picture

        show_picture(found, drawing_of(found, options, others or {}))
    if found.interrupted:
        say(found.message, options.quiet)
        return LIMITED if reached() else INTERRUPTED
    if found.status == "failed":
        say(f"error[LAG0620]: {found.message}", options.json)
    if not (written and drawn):
        return UNWRITTEN
    return FAILED if found.status == "failed" else DONE


def output_beside(path: str | None) -> AbstractContextManager[object]:
    """A block whose output goes to standard error if the file `path` is standard output."""
    return redirect_stdout(sys.stderr) if path and output(path) == 1 else nullcontext()


def _print(found: Run, options: argparse.Namespace, more: Mapping[str, object]) -> None:
    if options.json:
        print_json({**found.to_dict(), **more})
    else:
        from lagc.cli.summary import summary

        show(summary(found, options.scene is None, quiet=options.quiet, verbose=options.verbose) + "\n")


def _save(found: Run, options: argparse.Namespace) -> bool:
    from lagc.simulation.formats import CannotSave

    wanted: str = options.output
    path = write_or_keep(wanted, lambda name: found.save(name, units=options.units), (CannotSave, OSError))
    if path is not None:
        say(f"{len(found)} points written to {path}", options.quiet or options.json)
    return path == wanted


def _draw(found: Run, wanted: str, options: argparse.Namespace, others: Mapping[str, Run]) -> bool:
    from lagc.reports.plots.plot import plot

    drawing = drawing_of(found, options, others)
    path = write_or_keep(
        wanted, lambda name: plot(found, path=name, drawing=drawing), (OSError, ValueError, ArithmeticError)
    )
    if path is not None:
        say(f"plot written to {path}", options.quiet or options.json)
    return path == wanted


def drawing_of(found: Run, options: argparse.Namespace, others: Mapping[str, Run]) -> Drawing | None:
    """Return the function that draws the panels of `--show`; None without them."""
    if not options.panels:
        return None
    from lagc.reports.plots.panels import Plotted, draw, parse

    panels = parse(options.panels, found.names)
    plotted = [
        Plotted(label, run, run.evaluate, run.unit, run.scene) for label, run in {"": found, **others}.items()
    ]
    return lambda figure: draw(plotted, panels, figure)


def _animate(found: Run, wanted: str, options: argparse.Namespace, others: Mapping[str, Run]) -> bool:
    path = write_or_keep(
        wanted, lambda name: found.animate(name, overlay=others), (OSError, ValueError), ".html"
    )
    if path is not None:
        say(f"animation written to {path}", options.quiet or options.json)
    return path == wanted


def write_or_keep(
    path: str, write: Callable[[str], object], refused: tuple[type[Exception], ...], usual: str = ".csv"
) -> str | None:
    """Let `write` make the file `path` and return its name. It may raise `refused`, or ImportError where a
    package is broken.

    If that fails, write a file with a new name in the current folder or in that for temporary files (with
    the ending `usual` if `path` has none), and say so; None if this fails too.  A signal ends the wait for
    the reader of a pipe.
    """
    from lagc.host.atomic_write import may_wait, shortened

    failures: tuple[type[Exception], ...] = (*refused, ImportError)
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
    # The result of a long run is not lost: it goes to another file under a name that nobody has.
    import tempfile

    stem, ending = os.path.splitext(os.path.basename(path))
    name = f"{shortened(stem)}-{os.urandom(4).hex()}{ending or usual}"
    for folder in (os.getcwd, tempfile.gettempdir):
        try:
            other = os.path.join(folder(), name)
            write(other)
        except failures:
            continue
        say(f"lagc: the result is kept in {other}")
        return other
    say("lagc: the result could not be kept elsewhere")
    return None


def _reason(path: str, error: Exception) -> str:
    if isinstance(error, OSError):
        return f"`{path}` cannot be written: {error.strerror or error}"
    return str(error)


def spare(compilation: Compilation, *paths: str | None) -> None:
    """Raise Usage if one of `paths` is a file that the model reads (links are followed)."""
    files = [compilation.source.name, *(compilation.read.paths if compilation.read else ())]
    read = set(map(_real, files))
    for path in paths:
        if path and _real(path) in read:
            raise Usage(f"`{path}` is read by the model and cannot be overwritten: choose another file")


def _real(path: str) -> str:
    """The path without links, or itself if the current folder no longer exists."""
    try:
        return os.path.realpath(path)
    except OSError:
        return path
