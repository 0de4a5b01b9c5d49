"""The files of a study: the picture, the data, or one stand-alone page."""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable, Iterable
from importlib import import_module
from typing import Any

from lagc.cli.deliver import kept
from lagc.cli.output import Usage, say

FORMATS = (".html", ".json", ".png", ".svg", ".pdf")


def add_report_options(parser: argparse.ArgumentParser, points: int) -> None:
    """`--stop --points`, and that of `add_output_option`."""
    parser.add_argument("--stop", metavar="T", help="the end time; default: that of the scene, or 10 s")
    parser.add_argument(
        "--points", metavar="N", type=int, default=points, help=f"recorded times; default: {points}"
    )
    add_output_option(parser)


def add_output_option(parser: argparse.ArgumentParser) -> None:
    """`-o`."""
    parser.add_argument(
        "-o", "--output", metavar="FILE", action="append", default=[],
        help="write the report: .html (one stand-alone page), .json, or the picture: .png .svg .pdf",
    )  # fmt: skip


def check_endings(paths: Iterable[str]) -> None:
    """Raise Usage for a path whose ending is no format."""
    for path in paths:
        if os.path.splitext(path)[1].lower() not in FORMATS:
            raise Usage(
                f"`{path}` cannot be written: the ending gives the format, one of {' '.join(FORMATS)}"
            )


class Report:
    """`data()` is the JSON object, `page(svg)` the HTML text, and `picture` the module of
    `lagc.reports.plots` that draws."""

    def __init__(self, data: Callable[[], dict[str, Any]], page: Callable[[str], str], picture: str):
        self.data, self.page, self.picture = data, page, picture

    def write(self, path: str, found: object, heading: str, quiet: bool) -> bool:
        """Write one file; return whether it has the name that was given."""
        from lagc.base.text import json_text
        from lagc.host.atomic_write import write

        ending = os.path.splitext(path)[1].lower()
        if ending == ".json":
            data = (json_text(self.data(), indent=2) + "\n").encode()
            named = kept(path, lambda name: write(name, data), (OSError,), ".json")
        else:
            picture = import_module(f"lagc.reports.plots.{self.picture}")
            if ending == ".html":
                data = self.page(picture.svg(found, heading)).encode()
                named = kept(path, lambda name: write(name, data), (OSError,), ".html")
            else:
                named = kept(path, lambda name: picture.write(found, heading, name), (OSError, ValueError))
        if named is not None:
            say(f"written to {named}", quiet)
        return named == path
