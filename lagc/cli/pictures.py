"""The pictures of a run: plots, animations, and the other runs that they show beside it."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from lagc.base.records import replace
from lagc.cli.options import add_list_option, add_plot_option, quantities, split
from lagc.cli.output import Usage

if TYPE_CHECKING:
    from lagc.api import CompiledModel
    from lagc.api_run import Run
    from lagc.base.text import Quantity
    from lagc.compiler.stages import Choice
    from lagc.lowering.program import Interface
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
        from lagc.api_run import check_animation
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
    """The files of the plot and of the animation; "" for none."""
    return picture_of(interface, options.plot), animation_of(interface, options.animate)


def picture_of(interface: Interface, named: str | None) -> str:
    """The file for the plot: the one given, one in the current folder if there is no display, or ""."""
    if named != "":
        return named or ""
    from lagc.reports.plots.plot import has_display, path_beside

    return "" if has_display() else path_beside(interface)


def animation_of(interface: Interface, named: str | None) -> str:
    """The file for the animation: the one given, one in the current folder, or "" for none."""
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
