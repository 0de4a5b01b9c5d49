"""Measure what accuracy costs: errors and CPU times of all methods and tolerances on one motion.

Errors are taken against a run in quadruple precision.  The report has the settings that no other beats, the
setting to take for 1e-3, 1e-6, 1e-9 and 1e-12, and the price of one digit more.
"""

from __future__ import annotations

import argparse
import os

from lagc.cli.deliver import kept, spare
from lagc.cli.options import (
    add_general_options,
    add_model_options,
    add_start_option,
    choice_of,
    quantities,
    quantity,
)
from lagc.cli.output import DONE, INTERRUPTED, LIMITED, UNWRITTEN, Usage, print_json, say, show
from lagc.host.budgets import reached, rest

FORMATS = (".html", ".json", ".png", ".svg", ".pdf")


def add_options(parser: argparse.ArgumentParser) -> None:
    add_model_options(parser)
    add_start_option(parser)
    parser.add_argument("--stop", metavar="T", help="the end time; default: that of the scene, or 10 s")
    parser.add_argument("--points", metavar="N", type=int, default=301, help="recorded times; default: 301")
    parser.add_argument(
        "--budget", metavar="T", default="30", help="about the time to spend, in s; default: 30; coarse first"
    )
    parser.add_argument("--all", action="store_true", help="print all settings, not the best alone")
    parser.add_argument(
        "-o", "--output", metavar="FILE", action="append", default=[],
        help="write the report: .html (one stand-alone page), .json, or the picture: .png .svg .pdf",
    )  # fmt: skip
    add_general_options(parser)


def run(options: argparse.Namespace) -> int:
    from lagc.api import CompiledModel
    from lagc.cli.output import Bar
    from lagc.compiler.pipeline import Compilation
    from lagc.host import model_library
    from lagc.reports.cost import text, to_dict

    for path in options.output:
        if os.path.splitext(path)[1].lower() not in FORMATS:
            raise Usage(
                f"`{path}` cannot be written: the ending gives the format, one of {' '.join(FORMATS)}"
            )
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
    rest()
    interface = model.interface
    heading = f"{interface.model}, scene {interface.scene}" if interface.scene else interface.model
    written = [_write(path, found, heading, options) for path in options.output if found.points]
    if options.json:
        print_json({"status": "ok" if found.complete else "interrupted", "model": interface.model,
                    "scene": interface.scene, **to_dict(found)})  # fmt: skip
    else:
        show(text(found, heading, options.all))
    if not found.complete:
        return LIMITED if reached() else INTERRUPTED
    return DONE if all(written) else UNWRITTEN


def _write(path: str, found: object, heading: str, options: argparse.Namespace) -> bool:
    """Write one file; return whether it has the name that was given."""
    from lagc.base.text import json_text
    from lagc.host.atomic_write import write
    from lagc.reports.cost import page, to_dict
    from lagc.study.cost import Study

    assert isinstance(found, Study)
    ending = os.path.splitext(path)[1].lower()
    if ending == ".json":
        data = (json_text(to_dict(found), indent=2) + "\n").encode()
        named = kept(path, lambda name: write(name, data), (OSError,), ".json")
    else:
        from lagc.reports.plots import work_precision

        if ending == ".html":
            data = page(found, heading, work_precision.svg(found, heading)).encode()
            named = kept(path, lambda name: write(name, data), (OSError,), ".html")
        else:
            named = kept(path, lambda name: work_precision.write(found, heading, name), (OSError, ValueError))
    if named is not None:
        say(f"written to {named}", options.quiet or options.json)
    return named == path
