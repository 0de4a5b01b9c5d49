"""Run a model at many points: swept parameters and initial values, tables of points, random samples.

    lagc sweep pendulum.lag l=0.5:1.5:100 'start(theta)=10:80:8[deg]' --stop 20 -o sweep.csv

AXIS is NAME=1,2,5 or NAME=FIRST:LAST:COUNT (both ends), with :log at equal ratios, and a [unit] at the end;
NAME is a parameter, an input, or start(NAME).  All combinations are run, the last axis fastest.  Finished
runs are kept in FILE.part: after Ctrl-C or a crash the same command goes on."""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from math import inf
from time import perf_counter
from typing import TYPE_CHECKING, Any

from lagc.base.text import entry, whole
from lagc.cli.options import (
    add_backend_option,
    add_list_option,
    add_model_options,
    add_outputs_option,
    add_run_options,
    add_start_option,
    choice_of,
    pairs,
    quantities,
    run_numbers,
)
from lagc.cli.output import (
    DONE,
    FAILED,
    INTERRUPTED,
    LIMITED,
    Bar,
    Unwritten,
    Usage,
    print_json,
    say,
    show_report,
)
from lagc.cli.signals import SIGNALS
from lagc.host.atomic_write import is_straight, may_wait
from lagc.host.budgets import finish_uninterrupted, reached, time_text
from lagc.kernels import METHODS

if TYPE_CHECKING:
    from lagc.study.sweep.plan import Distribution, Values
    from lagc.study.sweep.table import Sweep

INTERMIXED = True  # axes may stand between options
SHOWN = 3  # reasons of failures in the summary


def add_options(parser: argparse.ArgumentParser) -> None:
    # In the order of the help: points, what to keep of a run, the run itself, where it is computed, the
    # table.
    add_model_options(parser)
    parser.add_argument("axes", metavar="AXIS", nargs="*", help="the values of a name, e.g. l=0.5:1.5:100[m]")
    parser.add_argument("--zip", action="store_true", help="the n-th run has the n-th value of each axis")
    parser.add_argument(
        "--table", metavar="POINTS.csv", help="points, a row for each; the header has the names"
    )
    parser.add_argument(
        "--monte-carlo", metavar="N", help="N random points of axes such as 'm=normal(1, 0.05)[kg]'; also "
        "uniform, lognormal, loguniform, triangular",
    )  # fmt: skip
    parser.add_argument("--seed", metavar="S", default="0", help="of the random points; default: 0")
    parser.add_argument(
        "--keep", metavar="WORDS", default="final",
        help="what a row has of each quantity: final, max, min, rms; default: final",
    )  # fmt: skip
    add_start_option(parser)
    about = "where to search for the initial value of a coordinate or speed, which it leaves unstated"
    add_list_option(parser, "--guess", "guesses", "NAME=VALUE[UNIT]", about)
    add_outputs_option(parser)
    add_run_options(parser, "stop")
    parser.add_argument(
        "--until", metavar="CONDITION", help="end a run when this becomes true, e.g. 'x > 3 [m]'"
    )
    add_run_options(parser, "accuracy")
    about = "what the accuracy of a coordinate, speed or output is relative to, instead of its range"
    add_list_option(parser, "--scale", "scales", "NAME=VALUE[UNIT]", about)
    parser.add_argument("--method", choices=METHODS, help="by hand: the integration method")
    add_run_options(parser, "rtol", "atol", "step", "max_step", "every", "points")
    parser.add_argument("--workers", metavar="N", help="processes of this machine; default: one for each CPU")
    parser.add_argument("--dask", metavar="ADDRESS", help="a Dask cluster, e.g. tcp://head:8786")
    parser.add_argument(
        "-o", "--output", metavar="FILE", required=True, help="write the runs: .csv, .parquet or .nc"
    )
    parser.add_argument(
        "--units", action="store_true", help="add units to the header of a .csv file: theta [rad]"
    )
    add_backend_option(parser)


def run(options: argparse.Namespace) -> int:
    from lagc.api import CompiledModel
    from lagc.base.records import replace
    from lagc.cli.deliver import spare
    from lagc.compiler.pipeline import Compilation
    from lagc.host import model_library
    from lagc.simulation.backends.compile import CannotCompile
    from lagc.simulation.formats import CannotSave, check_path
    from lagc.simulation.supervision import MOST_TIME
    from lagc.study.sweep.journal import NotKept
    from lagc.study.sweep.plan import plan_of
    from lagc.study.sweep.table import NEEDS

    # All words are read, and files checked, before anything is computed.
    try:
        check_path(options.output, NEEDS)
    except CannotSave as error:
        raise Usage(str(error)) from None
    check_dask(options)
    axes = axes_of(options)
    samples, seed = _whole(options.monte_carlo, "--monte-carlo"), _whole(options.seed, "--seed")
    choice = replace(choice_of(options), until=options.until)
    compilation = Compilation(model_library.read(options.file), choice)
    model = CompiledModel(compilation, options.backend)
    spare(compilation, options.output)
    request = model.sweep_request(
        {**run_numbers(options), "method": options.method}, quantities(options.starts, "--start"),
        quantities(options.guesses, "--guess"), quantities(options.scales, "--scale"),
    )  # fmt: skip
    plan = plan_of(axes, model.axis_values, options.zip or bool(options.table), samples, seed or 0)
    part = None if is_straight(options.output) else f"{options.output}.part"
    keep = [word.strip() for word in options.keep.split(",")]
    most_time = MOST_TIME if options.max_time is None else inf
    try:
        with workers_of(options) as workers, Bar(1.0, quiet=options.quiet or options.json) as bar:
            found = model.run_sweep(plan, request, keep, workers, part, Watch(bar), most_time=most_time)
    except CannotCompile as error:
        raise Usage(f"{error}; --backend numpy needs no compiler") from None
    except NotKept as error:
        raise Unwritten(
            f"{error}; finished runs are kept: make room, and give the same command again"
        ) from None
    return deliver(found, options, part)


def axes_of(options: argparse.Namespace) -> dict[str, Values | Distribution]:
    """Return the axes of a command, and those of its table.  Raises Usage or Refused."""
    from lagc.api.sweep import axes_in
    from lagc.study.sweep.plan import parse

    found = axes_in(options.table) if options.table else {}
    for name, text in pairs(options.axes, "name=1,2,5 or name=0.5:1.5:100[unit]", found).items():
        found[name] = parse(name, text)
    return found


def check_dask(options: argparse.Namespace) -> None:
    """Raise Usage if the cluster of `--dask` cannot be used."""
    from lagc.host.packages import is_installed

    if options.dask is not None and options.workers is not None:
        raise Usage("`--workers` and `--dask` both say where runs are computed: leave one out")
    if options.dask is not None and not is_installed("distributed"):
        raise Usage("`--dask` needs the package distributed: pip install distributed")


@contextmanager
def workers_of(options: argparse.Namespace) -> Iterator[Any]:
    """Yield the executor of a command: a number of processes, or a client of Dask.  Raises Usage."""
    if options.dask is None:
        workers = _whole(options.workers, "--workers")
        processors = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
        yield max(workers or 1, 1) if workers is not None else processors or 1
        return
    from importlib import import_module

    try:
        client = import_module("distributed").Client(options.dask)
    except (OSError, ValueError) as error:
        raise Usage(f"`--dask {options.dask}`: there is no cluster: {error}") from None
    try:
        yield client
    finally:
        client.close()


def _whole(word: str | None, option: str) -> int | None:
    found = None if word is None else whole(word)
    if word is not None and (found is None or found < 0):
        raise Usage(f"`{option} {word}` is not a whole number")
    return found


class Watch:
    """The progress of a sweep on a bar: runs that are done and failed, and the time that is left."""

    def __init__(self, bar: Bar):
        self.bar = bar
        self.begun: tuple[float, int] | None = None  # time and runs at the first call

    def __call__(self, found: Sweep) -> None:
        counts = found.counts
        done = len(found) - counts.get("not run", 0)
        if self.begun is None:
            self.begun = perf_counter(), done
        since, before = self.begun
        wrong = counts.get("failed", 0) + counts.get("refused", 0)
        words = f"{done:,} of {len(found):,} runs" + (f", {wrong:,} failed" if wrong else "")
        if done > before:
            left = (perf_counter() - since) * (len(found) - done) / (done - before)
            words += f", {time_text(left)} left"
        self.bar.part(done / len(found), words)


def deliver(found: Sweep, options: argparse.Namespace, part: str | None) -> int:
    """Write the table, print the summary, and return the exit code.  The journal `part` stays where the sweep
    was interrupted or the table cannot be written."""
    from lagc.cli.deliver import output_beside
    from lagc.simulation.formats import CannotSave

    finish_uninterrupted()
    quiet = options.quiet or options.json
    try:
        with SIGNALS.patience(not may_wait(options.output)):
            found.save(options.output, units=options.units)
    except CannotSave as error:
        kept = f"; all runs are kept in {part}: the same command writes them" if part else ""
        raise Unwritten(f"{error}{kept}") from None
    if part and found.complete:
        with suppress(OSError):
            os.unlink(part)
    counts = found.counts
    wrong = counts.get("failed", 0) + counts.get("refused", 0)
    with output_beside(options.output):
        if options.json:
            status = "interrupted" if not found.complete else "failed" if wrong else "ok"
            print_json({**found.metadata, "status": status, "runs": len(found), "counts": counts,
                        "reasons": found.common_reasons()})  # fmt: skip
        else:
            show_report(summary(found, options), color=False if options.no_color or quiet else None)
    if not found.complete:
        say("interrupted: the same command goes on" if part else "interrupted", quiet)
        return LIMITED if reached() else INTERRUPTED
    return FAILED if wrong else DONE


def summary(found: Sweep, options: argparse.Namespace) -> str:
    """Return the summary: how many runs have each status, and the most common reasons."""
    counts = ", ".join(f"{count:,} {status}" for status, count in found.counts.items())
    lines = [f"{found.metadata['model']}, scene {found.metadata['scene']}: {len(found):,} runs"]
    lines += entry("runs", counts)
    for count, code, message in found.common_reasons()[:SHOWN]:
        lines += entry("failed", f"{count:,} by {code}, such as: {message}")
    lines += entry("file", options.output)
    return "\n".join(lines) + "\n"
