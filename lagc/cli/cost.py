"""Measure what accuracy costs: errors and CPU times of all methods and tolerances on one motion.

Errors are taken against a run in quadruple precision.  The report has the settings that no other beats, the
setting to take for 1e-3, 1e-6, 1e-9 and 1e-12, and the price of one digit more.
"""

import argparse

from lagc.cli.deliver import spare
from lagc.cli.options import add_model_options, add_start_option, choice_of, quantities, quantity
from lagc.cli.output import Usage
from lagc.cli.study_report import add_report_options, check_reports, deliver


def add_options(parser: argparse.ArgumentParser) -> None:
    add_model_options(parser)
    add_start_option(parser)
    parser.add_argument(
        "--budget", metavar="T", default="30", help="about the time to spend, in s; default: 30; coarse first"
    )
    parser.add_argument("--all", action="store_true", help="print all settings, not the best alone")
    add_report_options(parser, 301)


def run(options: argparse.Namespace) -> int:
    from lagc.api import CompiledModel
    from lagc.cli.output import Bar
    from lagc.compiler.pipeline import Compilation
    from lagc.host import model_library
    from lagc.reports import cost as report

    check_reports(options.output)
    budget = quantity(options.budget, "s", "--budget") or 0.0
    if not budget > 0.0:
        raise Usage("`--budget` needs a positive time")
    compilation = Compilation(model_library.read(options.file), choice_of(options))
    model = CompiledModel(compilation, "c")
    spare(compilation, *options.output)
    starts = quantities(options.starts, "--start")
    with Bar(1.0, quiet=options.quiet or options.json) as bar:
        found = model.cost(
            quantity(options.stop, "s", "--stop"), points=options.points, budget=budget, starts=starts,
            progress=lambda part, doing: bar.part(part, doing),
        )  # fmt: skip
    interface = model.interface
    heading = f"{interface.model}, scene {interface.scene}" if interface.scene else interface.model
    text = report.text(found, heading, options.all)
    facts = {"model": interface.model, "scene": interface.scene}
    some = bool(found.points)
    return deliver(options, found, heading, report, "work_precision", text, some, found.late, **facts)
