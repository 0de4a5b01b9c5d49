"""Print equilibria, and linear models about them or about a motion.

The linear model satisfies the constraints: its states are independent coordinates and speeds.  Without --at
or --equilibrium it is about the initial state.
"""

from __future__ import annotations

import argparse
import os
from typing import TYPE_CHECKING, Any

from lagc.cli.deliver import spare
from lagc.cli.options import (
    add_model_options,
    add_plot_option,
    add_start_option,
    choice_of,
    quantities,
    quantity,
)
from lagc.cli.output import DONE, FAILED, UNWRITTEN, Usage, print_json, say, show

if TYPE_CHECKING:
    from lagc.api import CompiledModel
    from lagc.base.text import Quantity
    from lagc.lowering.program import Interface
    from lagc.simulation.linearization.linear_model import Linear

FORMATS = (".json", ".npz")
MOST, LARGE = 8, 3  # equilibria that are shown without --verbose, in general and for large models


def add_options(parser: argparse.ArgumentParser) -> None:
    add_model_options(parser)
    add_start_option(parser)
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--at", metavar="T", help="linearize about the motion at this time: 2, '100[ms]'")
    where.add_argument(
        "--equilibrium",
        action="store_true",
        help="find equilibria, from the initial state and from random states",
    )
    parser.add_argument("-o", "--output", metavar="FILE", help="write the matrices: .json or .npz")
    add_plot_option(parser, "draw the modes: .png, .svg or .pdf")


def run(options: argparse.Namespace) -> int:
    from lagc.api import CompiledModel
    from lagc.cli.deliver import check_picture, output_beside
    from lagc.compiler.pipeline import Compilation
    from lagc.host import model_library

    _check_output(options.output)
    check_picture(options)
    time = quantity(options.at, "s", "--at") or 0.0
    starts = quantities(options.starts, "--start")
    compilation = Compilation(model_library.read(options.file), choice_of(options))
    # A long motion runs in C, without derivatives; discrete variables and modes of contacts are no states of
    # the derivatives.
    held = ("discrete", ">=", "<=", "friction", "import")
    runs = time or any(word in compilation.source.text for word in held)
    model = CompiledModel(compilation if runs else compilation.differentiated, "auto" if time else "numpy")
    spare(compilation, options.output, _picture(model.interface, options.plot))
    try:
        linear_models = (
            model.equilibria(starts=starts)
            if options.equilibrium
            else [_linearize_at(model, time, starts, options)]
        )
    except ArithmeticError as error:
        return _report_none(str(error), options)
    if not linear_models:
        return _report_none(
            "no equilibrium was found, neither from the initial state nor from random states", options
        )
    interface = model.interface
    facts = {"status": "ok", "model": interface.model, "scene": interface.scene,
             "effects": list(interface.effects)}  # fmt: skip
    written = _deliver(linear_models, facts, options)
    with output_beside(options.output):
        if options.json:
            print_json(_document(linear_models, facts))
        else:
            show(_text(linear_models, options))
    return DONE if written else UNWRITTEN


def _linearize_at(
    model: CompiledModel, time: float, starts: dict[str, float | Quantity], options: argparse.Namespace
) -> Linear:
    """Linearize at a time; a motion that takes too long is refused as by `lagc sim`."""
    if not time:
        return model.linearize(starts=starts)
    from lagc.cli.output import Bar
    from lagc.simulation.supervision import Forecast

    with Bar(time, quiet=options.quiet or options.json) as bar:
        progress = Forecast(bar, time) if options.max_time is None else bar
        return model.linearize(time, starts=starts, progress=progress)


def _report_none(message: str, options: argparse.Namespace) -> int:
    if options.json:
        print_json({"status": "failed", "message": message})
    say(f"error[LAG0621]: {message}", options.json)
    return FAILED


def _text(found: list[Linear], options: argparse.Namespace) -> str:
    from lagc.reports.linear import heading, large, text

    interface = found[0].system.interface
    effects = f" with {', '.join(interface.effects)}" if interface.effects else ""
    parts = [f"{interface.model}, scene {interface.scene}{effects}"]
    most = LARGE if large(found[0]) and len(found) > 1 else MOST
    shown = found if options.verbose else found[:most]
    for k, linear in enumerate(shown):
        number = f"{k + 1} of {len(found)} found: " if options.equilibrium else "about "
        parts += [f"{number}{heading(linear)}", text(linear, options.verbose, len(shown))]
    parts += (
        [f"and {len(found) - len(shown)} more: --json or -v shows them"] if len(shown) < len(found) else []
    )
    return "\n".join([*parts, *(f"note: {note}" for note in _notes(found)), ""])


def _document(found: list[Linear], facts: dict[str, Any]) -> dict[str, Any]:
    return {**facts, "linear": [linear.to_dict() for linear in found], "notes": _notes(found)}


def _notes(found: list[Linear]) -> list[str]:
    return list(dict.fromkeys(note for linear in found for note in linear.notes))


def _check_output(path: str | None) -> None:
    """Raise Usage if the matrices cannot be written to `path`.

    A path that is no regular file, such as standard output, takes JSON if its name has no known ending.
    """
    from lagc.host.atomic_write import is_straight, obstacle

    if path is not None:
        if os.path.splitext(path)[1].lower() not in FORMATS and not is_straight(path):
            raise Usage(
                f"`{path}` cannot be written: the ending gives the format, one of {' '.join(FORMATS)}"
            )
        reason = obstacle(path)
        if reason:
            raise Usage(f"`{path}` cannot be written: {reason}")


def _deliver(found: list[Linear], facts: dict[str, Any], options: argparse.Namespace) -> bool:
    """Write the file and the plot; return whether both have the names that were given."""
    from lagc.cli.deliver import write_or_keep

    written = True
    if options.output:
        data = _content(found, facts, options.output)
        from lagc.host.atomic_write import write

        path = write_or_keep(options.output, lambda name: write(name, data), (OSError,), ".json")
        written = path == options.output
        if path is not None:
            say(f"written to {path}", options.quiet or options.json)
    if options.plot is not None:
        from lagc.reports.linear import heading
        from lagc.reports.plots.plot import plot_modes

        interface = found[0].system.interface
        wanted = _picture(interface, options.plot)
        title = f"{interface.model}, scene {interface.scene}: {heading(found[0])}"
        path = write_or_keep(wanted, lambda name: plot_modes(found[0], title, name), (OSError, ValueError))
        written = written and path == wanted
        if path is not None:
            say(f"plot written to {path}", options.quiet or options.json)
    return written


def _picture(interface: Interface, named: str | None) -> str:
    """Return the file for the plot of the modes: the one given, or one in the current folder, or ""."""
    from lagc.host.atomic_write import fitting

    beside = f"{fitting(f'{interface.model}_{interface.scene}_modes')}.png"
    return beside if named == "" else named or ""


def _content(found: list[Linear], facts: dict[str, Any], path: str) -> bytes:
    """Return the content of the file: JSON, or arrays A B C D eigenvalues modes x, with the suffix _2 for the
    second model."""
    if not path.lower().endswith(".npz"):
        from lagc.base.text import json_text

        return (json_text(_document(found, facts), indent=2) + "\n").encode()
    import io

    import numpy

    arrays: dict[str, Any] = {}
    for k, linear in enumerate(found):
        end = f"_{k + 1}" if k else ""
        for name in ("A", "B", "C", "D", "eigenvalues", "modes", "x", "states", "inputs", "outputs"):
            arrays[f"{name}{end}"] = numpy.array(getattr(linear, name))
    buffer = io.BytesIO()
    numpy.savez_compressed(buffer, **arrays)
    return buffer.getvalue()
