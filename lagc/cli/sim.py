"""Compile a model and simulate it.

`--accuracy` is that of the values at the recorded times: lagc chooses method and tolerance, and estimates
their global error by comparing runs.  `--method`, `--rtol`, `--atol` and `--step` choose them by hand.
"""

from __future__ import annotations

import argparse
import marshal
import re
from collections.abc import Mapping
from math import inf
from typing import TYPE_CHECKING, Any

from lagc.base.records import replace
from lagc.cli.deliver import (
    add_picture_options,
    check_panels,
    check_pictures,
    deliver,
    overlays_of,
    pictures_of,
    spare,
)
from lagc.cli.options import (
    add_backend_option,
    add_list_option,
    add_model_options,
    add_outputs_option,
    add_run_options,
    add_start_option,
    choice_of,
    limits_of,
    quantities,
    run_numbers,
    split,
)
from lagc.cli.output import Unwritten, Usage
from lagc.host import cache
from lagc.host.cache import tool_fingerprint
from lagc.kernels import METHODS

if TYPE_CHECKING:
    from lagc.api import CompiledModel
    from lagc.compiler.stages import Choice
    from lagc.semantics.model import Model
    from lagc.simulation.request import Request


def add_options(parser: argparse.ArgumentParser) -> None:
    add_model_options(parser)
    add_start_option(parser)
    add_outputs_option(parser)
    about = "where to search for the initial value of a coordinate or speed, which it leaves unstated"
    add_list_option(parser, "--guess", "guesses", "NAME=VALUE[UNIT]", about)
    add_run_options(parser, "stop")
    parser.add_argument(
        "--until", metavar="CONDITION", action="append", help="end when this becomes true, e.g. 'x > 3 [m]'"
    )
    add_run_options(parser, "accuracy")
    about = "what the accuracy of a coordinate, speed or output is relative to, instead of its range"
    add_list_option(parser, "--scale", "scales", "NAME=VALUE[UNIT]", about)
    parser.add_argument("--method", choices=METHODS, help="by hand: the integration method")
    add_run_options(parser, "rtol", "atol", "step", "max_step", "every", "points")
    about = "derivatives of the motion by parameters and initial values, e.g. 'l,m,start(theta)'"
    add_list_option(parser, "--sensitivity", "sensitivity", "NAMES", about)
    about = (
        "write the recorded points: .csv, .npz or .parquet; or an expression in brackets for a "
        "further column, such as 'norm(velocity(bob))'"
    )
    parser.add_argument(
        "-o", "--output", metavar="FILE", dest="outputs_given", action="append", default=[], help=about
    )
    parser.add_argument(
        "--units", action="store_true", help="add units to the header of a .csv file: theta [rad]"
    )
    add_picture_options(parser)
    parser.add_argument(
        "--prune",
        action="store_true",
        help="leave out effects that the accuracy lets go (see `lagc effects`)",
    )
    add_backend_option(parser)


def run(options: argparse.Namespace) -> int:
    from lagc.cli.output import Bar
    from lagc.simulation.backends.compile import CannotCompile
    from lagc.simulation.request import (
        bound_guesses,
        bound_parameters,
        bound_scales,
        bound_starts,
        warnings_of,
    )
    from lagc.simulation.supervision import Forecast

    # All words are read, and files checked, before anything is computed.
    check_files(options)
    request = request_of(options)
    start_values, guesses = quantities(options.starts, "--start"), quantities(options.guesses, "--guess")
    scales = quantities(options.scales, "--scale")
    choice = replace(choice_of(options), until=until_of(options))
    model, stop = compiled(options, request, choice)
    more: dict[str, object] = {}
    note = ""
    if options.prune:
        bound_starts(model.interface, start_values)
        quiet = options.quiet or options.json
        model, request, note, more["pruned"] = prune(model, request, start_values, guesses, quiet)
        # The pruned model may lack what was given values.
        start_values = {name: value for name, value in start_values.items() if name in model.state_names}
        guesses = {name: value for name, value in guesses.items() if name in model.state_names}
        own = {f.name for f in (*model.interface.parameters, *model.interface.inputs, *model.artifact.unused)}
        choice = replace(choice, parameters={n: v for n, v in choice.parameters.items() if n in own})
    starts = bound_starts(model.interface, start_values)
    parameters = bound_parameters(model.interface, choice.parameters, model.artifact.unused)
    request = replace(request, starts=starts, guesses=bound_guesses(model.interface, guesses, start_values))
    request = replace(request, scales=bound_scales(model.interface, scales) if scales else {})
    # The runs that pictures show beside it are bound now, and run after it.
    others = overlays_of(options, model, choice, request)
    with Bar(stop, quiet=options.quiet or options.json) as bar:
        try:
            progress = Forecast(bar, stop) if options.max_time is None else bar
            found = model.run(request, parameters, progress)
            runs = {} if found.interrupted else {label: again(bar) for label, again in others.items()}
        except CannotCompile as error:
            if error.starved:
                raise MemoryError from None
            wrong = Unwritten if error.full else Usage
            raise wrong(f"{error}; --backend numpy needs no compiler") from None
    if note:
        found.notes = (note, *found.notes)
    found.warnings = warnings_of(model.interface, {**choice.inputs, **choice.parameters, **start_values})
    found.add_columns(*options.expressions)
    return deliver(found, options, more, runs)


def compiled(options: argparse.Namespace, request: Request, choice: Choice) -> tuple[CompiledModel, float]:
    """Return the compiled model and the end time.  Raises Usage or Refused if the run would need too much
    memory, would overwrite a file of the model, or if a picture or a column is wrong."""
    from lagc.api import CompiledModel
    from lagc.compiler.pipeline import Compilation
    from lagc.host import model_library
    from lagc.simulation.formats import targets
    from lagc.simulation.supervision import MOST_MEMORY, check_memory

    source = model_library.read(options.file)
    most = MOST_MEMORY if options.max_memory is None else limits_of(options).memory or inf

    def look(resolved: Model) -> None:
        check_memory(request.completed(resolved.simulate), resolved.states, most)

    compilation = Compilation(source, choice, look=look)
    model = CompiledModel(compilation, options.backend)
    complete = request.completed(model.interface.simulate)
    check_memory(complete, model.interface.nx, most)
    written = targets(options.output) if options.output else ()
    spare(compilation, *written, *pictures_of(model.interface, options))
    model.check_expressions(options.expressions)
    check_panels(options, model)
    return model, complete.stop or 0.0


def until_of(options: argparse.Namespace) -> str | None:
    """Return the condition that ends the run.  Raises Usage."""
    until = options.until or [None]
    if len(until) > 1:
        raise Usage(f"`--until` is given twice: combine the conditions, as in '{' or '.join(until)}'")
    if until[0] is not None and not until[0].strip():
        raise Usage("`--until` needs a condition, such as 'x > 3[m]'")
    found: str | None = until[0]
    return found


def check_files(options: argparse.Namespace) -> None:
    """Part `--output` into a file and expressions.  Raise Usage if the output files cannot be written; called
    before the computation."""
    part_outputs(options)
    if options.output is not None:
        from lagc.simulation.formats import CannotSave, check_path

        try:
            check_path(options.output)
        except CannotSave as error:
            raise Usage(str(error)) from None
    check_pictures(options)


def part_outputs(options: argparse.Namespace) -> None:
    """Set `output`, the file, and `expressions`: words with a sign of an operation or a bracket, and without
    an ending of a file.  Raises Usage for two files."""
    from lagc.host.atomic_write import is_straight
    from lagc.simulation.formats import NEEDS

    options.expressions = [
        word
        for word in options.outputs_given
        if re.search(r"[()\[\]{}^*+<>=,]", word)
        and not word.lower().endswith(tuple(NEEDS))
        and not is_straight(word)
    ]
    paths = [word for word in options.outputs_given if word not in options.expressions]
    if len(paths) > 1:
        raise Usage(f"`--output {paths[1]}`: one file takes the recorded points, and that is `{paths[0]}`")
    options.output = paths[0] if paths else None


def request_of(options: argparse.Namespace) -> Request:
    """Return the request without initial values.  Raises Usage if a word is not a number."""
    from lagc.simulation.request import Request

    sensitivity = tuple([name for word in options.sensitivity for name in split(word)])
    return Request(method=options.method, sensitivity=sensitivity, **run_numbers(options))


SHARE = 0.5  # of the accuracy, for the error of the run; the rest is for what is left out


def prune(
    model: CompiledModel, request: Request, starts: Mapping[str, Any], guesses: Mapping[str, Any], quiet: bool
) -> tuple[CompiledModel, Request, str, dict[str, object]]:
    """Return the model without these effects, the request for it, a note, and the object `pruned` of the
    JSON. Raises Usage if a method or tolerances were chosen by hand, Refused as `CompiledModel.effects`."""
    if request.by_hand:
        raise Usage("`--prune` needs an accuracy, and no method, tolerance or step of your own")
    complete = request.completed(model.interface.simulate)
    accuracy, stop = complete.accuracy or 1e-6, complete.stop or 0.0
    said: dict[str, object] = {"left_out": [], "error": 0.0, "bar": 0.0, "asked": accuracy}
    if not model.interface.effects:
        return model, request, "nothing is left out: the scene uses no effect", said
    left_out, change, bar, took = _set_arguments(model, accuracy, stop, starts, guesses, quiet)
    if not left_out:
        words = f"nothing is left out at {accuracy:.0e}: each effect counts, or saves nothing"
        return model, request, words, said
    compared = model.operations
    model = model.without(left_out)
    words = f"left out {', '.join(left_out)}: the compared quantities change by {change:.1e} of their ranges "
    words += f"(asked {accuracy:.0e}; measured, for this initial state and end time{took}); "
    words += f"{model.operations} of {compared} operations"
    said.update(left_out=list(left_out), error=change, bar=bar)
    return model, replace(request, accuracy=SHARE * accuracy), words, said


def _set_arguments(
    model: CompiledModel,
    accuracy: float,
    stop: float,
    starts: Mapping[str, Any],
    guesses: Mapping[str, Any],
    quiet: bool,
) -> tuple[tuple[str, ...], float, float, str]:
    """Return the effects to leave out, the change, its error bar, and how long it took to find them; "" if
    they were known."""
    from lagc.cli.output import Bar

    begin = [sorted(starts.items()), sorted(guesses.items())]
    values = [repr(v) for v in (accuracy, stop, begin, list(model.system.parameters))]
    name = cache.key(
        "effects 2", tool_fingerprint(), model.interface.model_hash, model.interface.scene, *values
    )
    known = cache.load("effects", name, marshal.loads)
    if known is not None:
        return tuple(known[0]), known[1], known[2], ""
    with Bar(1.0, quiet=quiet) as bar:
        found = model.effects(stop, accuracies=(accuracy,), starts=starts, guesses=guesses,
                              progress=lambda part, doing: bar.part(part, doing))  # fmt: skip
    if not found.complete:
        raise KeyboardInterrupt
    (choice,) = found.sets
    cache.store("effects", name, marshal.dumps((list(choice.left_out), choice.change, choice.bar)))
    return choice.left_out, choice.change, choice.bar, f"; found in {found.spent:.0f} s"
