"""Deliver the result of a run: write the files, draw the pictures, then print the summary.

The pictures are plots and animations, and show other runs beside it.  The summary goes to standard error if
standard output takes the numbers.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, nullcontext, redirect_stdout
from typing import TYPE_CHECKING

from lagc.base.records import replace
from lagc.cli.options import add_list_option, add_plot_option, quantities, split
from lagc.cli.output import DONE, FAILED, INTERRUPTED, LIMITED, UNWRITTEN, Usage, print_json, say, show_report
from lagc.cli.signals import SIGNALS
from lagc.host.atomic_write import output
from lagc.host.budgets import finish_uninterrupted, reached

if TYPE_CHECKING:
    from lagc.api import CompiledModel
    from lagc.api.run import Run
    from lagc.base.text import Quantity
    from lagc.compiler.pipeline import Compilation
    from lagc.compiler.stages import Choice
    from lagc.lowering.program import Interface
    from lagc.reports.plots.plot import Drawing
    from lagc.simulation.request import Request


Progress = Callable[[float], None]


def add_picture_options(parser: argparse.ArgumentParser) -> None:
    """`--plot --show --animate --overlay`."""
    add_plot_option(parser, "draw the motion into FILE (.png, .svg, .pdf), or on the screen")
    panels = "columns 'theta*', a phase portrait 'theta:der(theta)', path(bob), energy, residuals"
    add_list_option(parser, "--show", "panels", "PANEL", f"a panel of --plot: {panels}")
    parser.add_argument(
        "--animate",
        metavar="FILE",
        nargs="?",
        const="",
        help="show the motion as a page (.html), or a film (.gif, .mp4); default: MODEL_SCENE.html",
    )
    about = (
        "another scene, or other values such as 'l=0.7[m],theta=1', beside the run in --plot and --animate"
    )
    add_list_option(parser, "--overlay", "overlays", "SCENE|NAME=VALUE", about)


def check_pictures(options: argparse.Namespace) -> None:
    """Raise Usage if the pictures cannot be drawn; called before the computation."""
    check_picture(options)
    if options.panels and options.plot is None:
        raise Usage("`--show` chooses the panels of a plot: add --plot, or --plot FILE")
    if options.overlays and options.plot is None and options.animate is None:
        raise Usage("`--overlay` belongs to a picture: add --animate, or --plot with --show")
    if options.overlays and options.animate is None and not options.panels:
        raise Usage("`--overlay` needs panels that show it: add --show, such as --show 'theta*'")
    if options.animate:
        from lagc.api.run import check_animation
        from lagc.host.atomic_write import obstacle

        try:
            check_animation(options.animate)
        except (ValueError, ImportError) as error:
            raise Usage(str(error)) from None
        reason = obstacle(options.animate)
        if reason:
            raise Usage(f"`{options.animate}` cannot be written: {reason}")


def check_picture(options: argparse.Namespace) -> None:
    """Raise Usage if the plot of `--plot` cannot be drawn."""
    if options.plot is not None:
        from lagc.host.packages import PICTURES, is_installed

        if not is_installed("matplotlib"):
            raise Usage(PICTURES)
    if options.plot:
        from lagc.host.atomic_write import obstacle
        from lagc.reports.plots.plot import check_ending

        try:
            check_ending(options.plot)
        except ValueError as error:
            raise Usage(str(error)) from None
        reason = obstacle(options.plot)
        if reason:
            raise Usage(f"`{options.plot}` cannot be drawn: {reason}")


def pictures_of(interface: Interface, options: argparse.Namespace) -> tuple[str, str]:
    """Return the files of the plot and of the animation; "" for none."""
    return picture_of(interface, options.plot), animation_of(interface, options.animate)


def picture_of(interface: Interface, named: str | None) -> str:
    """Return the file for the plot: the one given, one in the current folder if there is no display, or
    ""."""
    if named != "":
        return named or ""
    from lagc.reports.plots.plot import has_display, path_beside

    return "" if has_display() else path_beside(interface)


def animation_of(interface: Interface, named: str | None) -> str:
    """Return the file for the animation: the one given, one in the current folder, or "" for none."""
    if named != "":
        return named or ""
    from lagc.host.atomic_write import fitting

    return f"{fitting(f'{interface.model}_{interface.scene}')}.html"


def check_panels(options: argparse.Namespace, model: CompiledModel) -> None:
    """Compile the expressions of `--show`.  Raise Usage for a name that matches nothing, Refused for an
    expression that is wrong; called before the run."""
    if not options.panels:
        return
    from lagc.reports.plots.panels import expressions, parse
    from lagc.symbolic.leaves import derived

    interface = model.interface
    fields = (*interface.discretes, *interface.outputs)
    names = [
        *model.state_names,
        *map(derived, interface.q_names),
        *(f.name for f in fields),
        *options.expressions,
    ]
    try:
        panels = parse(options.panels, names)
    except ValueError as error:
        raise Usage(str(error)) from None
    for text in expressions(panels, names):
        model.check_expressions([text])


def overlays_of(
    options: argparse.Namespace, model: CompiledModel, choice: Choice, request: Request
) -> dict[str, Callable[[Progress], Run]]:
    """Return a function for each `--overlay` that runs it, by its text. Raises Usage or Refused for one that
    is wrong, before anything runs."""
    found: dict[str, Callable[[Progress], Run]] = {}
    for word in options.overlays:
        if word in found:
            raise Usage(f"`--overlay {word}` is given twice")
        if "=" in word:
            found[word] = _with_values(model, choice, request, quantities(split(word), "--overlay"))
        else:
            found[word] = _of_scene(model, replace(choice, scene=word), request, options.backend)
    return found


def _with_values(
    model: CompiledModel, choice: Choice, request: Request, given: Mapping[str, float | Quantity]
) -> Callable[[Progress], Run]:
    """Return the run with other parameters and initial values."""
    from lagc.simulation.request import bound_parameters, bound_starts
    from lagc.symbolic.leaves import derived

    interface = model.interface
    known = {*model.state_names, *map(derived, interface.q_names), *(d.name for d in interface.discretes)}
    starts = {name: value for name, value in given.items() if name in known}
    others = {name: value for name, value in given.items() if name not in known}
    parameters = bound_parameters(interface, {**choice.parameters, **others}, model.artifact.unused)
    own = replace(request, starts={**request.starts, **bound_starts(interface, starts)}, sensitivity=())
    return lambda progress: model.run(own, parameters, progress)


def _of_scene(
    model: CompiledModel, choice: Choice, request: Request, backend: str
) -> Callable[[Progress], Run]:
    """Return the run of another scene, with the initial values that it has."""
    from lagc.api import CompiledModel
    from lagc.compiler.pipeline import Compilation
    from lagc.simulation.request import bound_parameters

    other = CompiledModel(Compilation(model.compilation.source, choice, model.compilation.roots), backend)
    fields = (*other.interface.parameters, *other.interface.inputs, *other.artifact.unused)
    given = {f.name: choice.parameters[f.name] for f in fields if f.name in choice.parameters}
    parameters = bound_parameters(other.interface, given, other.artifact.unused)
    starts = {name: value for name, value in request.starts.items() if name in other.state_names}
    own = replace(request, starts=starts, guesses={}, scales={}, sensitivity=())
    return lambda progress: other.run(own, parameters, progress)


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
    finish_uninterrupted()
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
    """Return a block whose output goes to standard error if the file `path` is standard output."""
    return redirect_stdout(sys.stderr) if path and output(path) == 1 else nullcontext()


def _print(found: Run, options: argparse.Namespace, more: Mapping[str, object]) -> None:
    if options.json:
        print_json({**found.to_dict(), **more})
    else:
        from lagc.cli.summary import summary

        text = summary(found, options.scene is None, quiet=options.quiet, verbose=options.verbose)
        show_report(text + "\n", color=False if options.no_color or options.quiet else None)


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
    from lagc.host.packages import missing

    return missing(error) or str(error)


def spare(compilation: Compilation, *paths: str | None) -> None:
    """Raise Usage if one of `paths` is a file that the model reads (links are followed)."""
    files = [compilation.source.name, *(compilation.read.paths if compilation.read else ())]
    read = set(map(_real, files))
    for path in paths:
        if path and _real(path) in read:
            raise Usage(f"`{path}` is read by the model and cannot be overwritten: choose another file")


def _real(path: str) -> str:
    """Return the path without links, or itself if the current folder no longer exists."""
    try:
        return os.path.realpath(path)
    except OSError:
        return path
