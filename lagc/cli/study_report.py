"""The files of a study: the picture, the data, or one stand-alone page."""

import argparse
import os
from collections.abc import Iterable
from importlib import import_module
from typing import Any

from lagc.cli.deliver import write_or_keep
from lagc.cli.options import add_list_option
from lagc.cli.output import DONE, INTERRUPTED, LIMITED, UNWRITTEN, Usage, print_json, say, show_report
from lagc.host.budgets import finish_uninterrupted, reached
from lagc.host.packages import PICTURES, is_installed

ENDINGS = (".png", ".svg", ".pdf")  # of pictures
FORMATS = (".html", ".json", *ENDINGS)


def add_report_options(parser: argparse.ArgumentParser, points: int) -> None:
    """`--stop --points`, and that of `add_output_option`."""
    parser.add_argument("--stop", metavar="T", help="the end time; default: that of the scene, or 10 s")
    parser.add_argument(
        "--points", metavar="N", type=int, default=points, help=f"recorded times; default: {points}"
    )
    add_output_option(parser)


def add_output_option(parser: argparse.ArgumentParser) -> None:
    """`-o`."""
    about = "write the report: .html (one stand-alone page), .json, or the picture: .png .svg .pdf"
    add_list_option(parser, "--output", "output", "FILE", about, "-o")


def check_reports(paths: Iterable[str]) -> None:
    """Raise Usage for a path whose ending is no format, or needs a package; called before the study. A page
    needs none: without matplotlib it has no picture."""
    for path in paths:
        ending = os.path.splitext(path)[1].lower()
        if ending in ENDINGS and not is_installed("matplotlib"):
            raise Usage(f"`{path}` cannot be drawn: {PICTURES}")
        if ending not in FORMATS:
            raise Usage(
                f"`{path}` cannot be written: the ending gives the format, one of {' '.join(FORMATS)}"
            )


def deliver(
    options: argparse.Namespace, found: Any, heading: str, report: Any, picture: str, text: str, some: bool,
    late: bool = False, **facts: str,
) -> int:  # fmt: skip
    """Write the files if there are `some` results, print the result, and return the exit code.  `report` is a
    module of `lagc.reports`, whose `to_dict` with `facts` is the JSON object; `picture` names one of
    `lagc.reports.plots`; `late`: the study has reached its own limit."""
    finish_uninterrupted()
    quiet = options.quiet or options.json
    data = {**facts, **report.to_dict(found)}
    written = [_write(path, found, heading, report, picture, quiet) for path in options.output if some]
    if options.json:
        print_json({"status": "ok" if found.complete else "interrupted", **data})
    else:
        show_report(text, color=False if options.no_color else None)
    if not found.complete:
        return LIMITED if late or reached() else INTERRUPTED
    return DONE if all(written) else UNWRITTEN


def _write(path: str, found: Any, heading: str, report: Any, picture: str, quiet: bool) -> bool:
    """Write one file; return whether it has the name that was given."""
    from lagc.base.text import json_text
    from lagc.host.atomic_write import write
    from lagc.reports.plots.plot import save

    ending = os.path.splitext(path)[1].lower()
    drawn = None if ending == ".json" else import_module(f"lagc.reports.plots.{picture}")
    if drawn is None or ending == ".html":
        data = json_text(report.to_dict(found), indent=2) + "\n"
        if drawn is not None:
            data = report.page(found, heading, _picture(path, drawn, found, heading))
        named = write_or_keep(path, lambda name: write(name, data.encode()), (OSError,), ending)
    else:
        named = write_or_keep(
            path, lambda name: save(drawn.draw(found, heading), name), (OSError, ValueError)
        )
    if named is not None:
        say(f"written to {named}", quiet)
    return named == path


def _picture(path: str, drawn: Any, found: Any, heading: str) -> str:
    """Return the picture of a page, or a line that says what it needs."""
    from html import escape

    from lagc.reports.plots.plot import svg

    try:
        return svg(drawn.draw(found, heading))
    except ImportError as error:
        say(f"lagc: `{path}` has no picture: {error}")
        return f"<p>{escape(str(error))}</p>"
