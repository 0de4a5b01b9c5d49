"""Run the hard cases: motions whose truth is known, with the figures that lagc has to keep.

Without CASE all cases run, in C and in Python; with it, one is explained and run.  The exit code is 3 if a
case misses a figure.
"""

from __future__ import annotations

import argparse
import os
from typing import TYPE_CHECKING

from lagc.cli.options import add_limit_options
from lagc.cli.output import DONE, FAILED, Usage, show
from lagc.cli.study_report import add_output_option, check_reports, deliver

if TYPE_CHECKING:
    from lagc.study.hard.case import Case


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("case", metavar="CASE", nargs="*", help="the names of cases; default: all")
    parser.add_argument("--list", action="store_true", help="list the cases")
    parser.add_argument(
        "--backend", choices=("both", "c", "numpy"), default="both", help="where to run; default: both"
    )
    parser.add_argument("--markdown", action="store_true", help="print the table for a document")
    add_output_option(parser)
    add_limit_options(parser)
    parser.set_defaults(max_time="none")  # the models are known; a busy machine is slow


def run(options: argparse.Namespace) -> int:
    from lagc.api import load
    from lagc.cli.output import Bar
    from lagc.host.model_library import locate
    from lagc.reports import hard as report
    from lagc.study.hard.case import study
    from lagc.study.hard.cases import CASES

    check_reports(options.output)
    if options.list:
        show(report.listing(CASES))
        return DONE
    chosen = _choose(options.case, {case.name: case for case in CASES})
    quiet = options.quiet or options.json
    if options.case and not (quiet or options.markdown):
        for case in chosen:
            show(report.explanation(case, os.path.relpath(locate(case.model))))
    with Bar(1.0, quiet=quiet) as bar:
        found = study(chosen, load, _backends(options.backend), lambda part, doing: bar.part(part, doing))
    heading = "Hard cases" if len(chosen) != 1 else chosen[0].title
    text = report.markdown(found, _machine()) if options.markdown else report.text(found, heading)
    code = deliver(options, found, heading, report, "hard", text, bool(found.rows))
    return code if code != DONE or found.meets_figures else FAILED


def _choose(names: list[str], known: dict[str, Case]) -> list[Case]:
    from lagc.diagnostics.suggest import closest

    for name in names:
        if name not in known:
            close = closest(name, list(known))
            hint = f" (did you mean `{close}`?)" if close else ""
            raise Usage(f"there is no case `{name}`{hint}; `lagc hard --list` lists them")
    return [known[name] for name in names] if names else list(known.values())


def _backends(wanted: str) -> tuple[str, ...]:
    from lagc.cli.output import say
    from lagc.simulation.backends.compile import compiler

    if wanted != "numpy" and compiler() is None:
        if wanted == "c":
            raise Usage("`--backend c` needs a C compiler")
        say("there is no C compiler: the cases run in Python alone")
        return ("numpy",)
    return ("c", "numpy") if wanted == "both" else (wanted,)


def _machine() -> str:
    """Return the date, the processor and the versions."""
    import platform
    from datetime import date

    return f"{date.today()} ({platform.machine()}, {os.cpu_count()} CPUs, Python {platform.python_version()})"
