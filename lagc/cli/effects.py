"""Measure what each effect of a scene changes and costs, and find the cheapest scene for an accuracy.

Each effect is left out alone.  For each accuracy, the cheapest set of effects whose absence changes no
compared quantity by more is run and compared with the full scene.
"""

from __future__ import annotations

import argparse
import re
from math import log10
from typing import TYPE_CHECKING

from lagc.cli.deliver import spare
from lagc.cli.options import (
    add_list_option,
    add_model_options,
    add_start_option,
    choice_of,
    quantities,
    quantity,
    split,
)
from lagc.cli.output import Usage
from lagc.cli.study_report import add_report_options, check_reports, deliver

if TYPE_CHECKING:
    from lagc.base.text import Quantity

RANGE = "1e-2..1e-8"


def add_options(parser: argparse.ArgumentParser) -> None:
    add_model_options(parser)
    add_start_option(parser)
    parser.add_argument(
        "--accuracy", metavar="A", default=RANGE,
        help=f"largest changes, of the range of each quantity: one, a list, or a range; default: {RANGE}",
    )  # fmt: skip
    parser.add_argument(
        "--of", metavar="NAMES", help="coordinates and outputs to compare; default: all that every scene has"
    )
    about = "verify the recommended scenes for these initial values too, e.g. --also 'start th=90[deg]'"
    add_list_option(parser, "--also", "also", "'start NAME=VALUE, ...'", about)
    add_report_options(parser, 501)


def run(options: argparse.Namespace) -> int:
    from lagc.api import CompiledModel
    from lagc.cli.output import Bar
    from lagc.compiler.pipeline import Compilation
    from lagc.host import model_library
    from lagc.reports import effects as report

    check_reports(options.output)
    accuracies = accuracies_of(options.accuracy)
    compilation = Compilation(model_library.read(options.file), choice_of(options))
    model = CompiledModel(compilation, "c")
    spare(compilation, *options.output)
    starts = quantities(options.starts, "--start")
    also = {" ".join(words.split()): also_of(words) for words in options.also}
    of = [name.strip() for name in (options.of or "").split(",") if name.strip()]
    with Bar(1.0, quiet=options.quiet or options.json) as bar:
        found = model.effects(
            quantity(options.stop, "s", "--stop"), accuracies=accuracies, points=options.points, of=of,
            starts=starts, also=also, progress=lambda part, doing: bar.part(part, doing),
        )  # fmt: skip
    interface = model.interface
    heading = f"{interface.model}, scene {interface.scene}"
    text, some = report.text(found, heading), bool(found.left_out)
    return deliver(options, found, heading, report, "effects", text, some, model=interface.model)


def also_of(written: str) -> dict[str, float | Quantity]:
    """Return the initial values of `start a=1, b=2[m]`.  Raises Usage."""
    begin, _, rest_ = written.strip().partition(" ")
    if begin != "start" or not rest_.strip():
        raise Usage(f"`--also '{written}'`: write initial values, as in --also 'start th=90[deg], x=0'")
    return quantities([part for part in split(rest_) if part.strip()], "--also")


def accuracies_of(written: str) -> list[float]:
    """Return the accuracies of `1e-3`, of `1e-2,1e-4` or, by powers of ten, of `1e-2..1e-8`.  Raises
    Usage."""
    try:
        parts = [float(part) for part in re.split(r",|\.\.", written)]
    except ValueError:
        parts = []
    if not parts or not all(0.0 < part < 1.0 for part in parts):
        raise Usage(f"`--accuracy {written}`: write numbers between 0 and 1, as 1e-3, 1e-2,1e-4 or {RANGE}")
    if ".." not in written:
        return parts
    first, last = (round(log10(part)) for part in (parts[0], parts[-1]))
    step = -1 if last < first else 1
    return [10.0**k for k in range(first, last + step, step)]
