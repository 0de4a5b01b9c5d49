"""Run scenes of a model side by side, and show how they differ from the first."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from copy import copy
from typing import TYPE_CHECKING, TypeVar

from lagc.cli.deliver import check_picture, spare, write_or_keep
from lagc.cli.options import (
    add_backend_option,
    add_model_options,
    add_start_option,
    choice_of,
    quantities,
    quantity,
)
from lagc.cli.output import DONE, FAILED, INTERRUPTED, LIMITED, UNWRITTEN, Usage, print_json, say, show_report
from lagc.host.budgets import finish_uninterrupted, reached

if TYPE_CHECKING:
    from lagc.api import CompiledModel
    from lagc.api.run import Run

T = TypeVar("T")


def add_options(parser: argparse.ArgumentParser) -> None:
    add_model_options(parser, many_scenes=True)
    add_start_option(parser)
    parser.add_argument("--stop", metavar="T", help="the end time; default: that of the first scene, or 10 s")
    parser.add_argument("--accuracy", metavar="A", help="the global relative error; default: 1e-6")
    parser.add_argument("--points", metavar="N", type=int, default=501, help="recorded times; default: 501")
    parser.add_argument("--plot", metavar="FILE", help="draw the scenes into FILE (.png, .svg, .pdf)")
    add_backend_option(parser)


def run(options: argparse.Namespace) -> int:
    from lagc.api import CompiledModel
    from lagc.compiler.pipeline import Compilation
    from lagc.host import model_library
    from lagc.reports.compare import compare, text, to_dict
    from lagc.simulation.request import Request

    if options.plot == "":
        raise Usage("`--plot` needs a file")
    check_picture(options)
    source = model_library.read(options.file)
    accuracy, stop = quantity(options.accuracy, "", "--accuracy"), quantity(options.stop, "s", "--stop")
    starts = quantities(options.starts, "--start")
    # Every scene is compiled before one runs, so that a fault in any of them is reported at once.
    first = Compilation(source, choice_of(_with(options, None)))
    choices = [choice_of(_with(options, scene)) for scene in options.scene or first.model.scenes or [None]]
    models = [CompiledModel(Compilation(source, choice), options.backend) for choice in choices]
    scenes = [model.interface.scene for model in models]
    spare(first, *([options.plot] if options.plot else []))
    stop = Request(stop=stop).completed(models[0].interface.simulate).stop
    # Each scene takes the values that it has; a name that none has is refused.
    parameters = [_parameters(model) for model in models]
    given = choices[0].parameters
    bound = [model.without(()).bind(_known_values(given, parameters, k)) for k, model in enumerate(models)]
    states = [model.state_names for model in models]
    runs: list[Run] = []
    try:
        for k, model in enumerate(bound):
            given_starts = _known_values(starts, states, k)
            run = model.simulate(stop, accuracy=accuracy, points=options.points, starts=given_starts)
            runs.append(run)
            if run.interrupted:
                break
    except KeyboardInterrupt:
        if not runs:
            raise
    # An interruption keeps the runs so far.
    finish_uninterrupted()
    comparison = compare(scenes[: len(runs)], runs)
    interrupted = len(runs) < len(bound) or runs[-1].interrupted
    written = True
    if options.plot:
        from lagc.reports.plots.compare import draw
        from lagc.reports.plots.plot import save

        path = write_or_keep(options.plot, lambda name: save(draw(comparison), name), (OSError, ValueError))
        written = path == options.plot
        if path is not None:
            say(f"written to {path}", options.quiet or options.json)
    if options.json:
        print_json({"status": "interrupted" if interrupted else "ok", **to_dict(comparison)})
    else:
        show_report(text(comparison, options.verbose), color=False if options.no_color else None)
    if interrupted:
        say("interrupted: these are the runs until then", options.quiet or options.json)
        return LIMITED if reached() else INTERRUPTED
    if not written:
        return UNWRITTEN
    return FAILED if any(run.status == "failed" for run in runs) else DONE


def _with(options: argparse.Namespace, scene: str | None) -> argparse.Namespace:
    own = copy(options)
    own.scene = scene
    return own


def _parameters(model: CompiledModel) -> list[str]:
    interface, artifact = model.interface, model.artifact
    fields = (*interface.parameters, *interface.inputs, *artifact.unused)
    return [*(f.name for f in fields), *artifact.built_in]


def _known_values(given: Mapping[str, T], known: Sequence[Sequence[str]], k: int) -> dict[str, T]:
    """Return the given values that model k has; also those that none has, so that it refuses them."""
    others = {name for names in known for name in names}
    return {name: value for name, value in given.items() if name in known[k] or name not in others}
