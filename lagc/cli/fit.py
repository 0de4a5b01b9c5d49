"""Find the parameters with which a motion fits measured values best, with confidence intervals.

    lagc fit pendulum.lag swing.csv -p l,air.k --start 'theta=30[deg]' 'theta=angle[deg]' --plot fit.png

QUANTITY=COLUMN pairs a coordinate, speed or output with a column of the data; time=COLUMN names that of the
times.  A unit in brackets, here or in the header, is that of the column.  A name of -p without a value is
found; `start(theta)` is an initial value.
"""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from lagc.cli.deliver import check_picture, spare, write_or_keep
from lagc.cli.options import (
    add_backend_option,
    add_model_options,
    add_run_options,
    add_start_option,
    choice_of,
    pairs,
    quantities,
    quantity,
    run_numbers,
    split,
)
from lagc.cli.output import DONE, FAILED, UNWRITTEN, Bar, Usage, print_json, say, show_report
from lagc.host.budgets import finish_uninterrupted
from lagc.kernels import METHODS

if TYPE_CHECKING:
    from lagc.study.fit import Fit

INTERMIXED = True  # pairs may stand between options


def add_options(parser: argparse.ArgumentParser) -> None:
    add_model_options(parser)
    parser.add_argument("data", metavar="DATA.csv", help="measured values, a column for each, with a header")
    parser.add_argument(
        "pairs", metavar="QUANTITY=COLUMN", nargs="*", help="a measured quantity, e.g. 'theta=angle[deg]'"
    )
    add_start_option(parser)
    parser.add_argument("--confidence", metavar="P", default="0.95", help="of the intervals; default: 0.95")
    add_run_options(parser, "accuracy")
    parser.add_argument("--method", choices=METHODS, help="by hand: the integration method")
    add_run_options(parser, "rtol", "atol", "max_step")
    parser.add_argument("--plot", metavar="FILE", help="draw fit and residuals into FILE (.png, .svg, .pdf)")
    add_backend_option(parser)


def run(options: argparse.Namespace) -> int:
    from lagc.api import CompiledModel
    from lagc.compiler.pipeline import Compilation
    from lagc.host import model_library
    from lagc.host.packages import is_installed
    from lagc.reports.fit import text, to_dict
    from lagc.study.fit import SCIPY

    # Before the model is compiled, which may take longer than reading this message.
    if not is_installed("scipy"):
        raise Usage(SCIPY)
    if options.plot == "":
        raise Usage("`--plot` needs a file")
    check_picture(options)
    # A word with `=` gives a value, one without is the name of a parameter to find; both may be in a list.
    given = [part.strip() for word in options.parameters for part in split(word)]
    vary = [word for word in given if "=" not in word]
    options.parameters = [word for word in given if "=" in word]
    if options.parameters and not vary:
        word = options.parameters[0]
        name = word.partition("=")[0].strip()
        raise Usage(f"no parameter is to be found: `-p {word}` says where its search begins; add `-p {name}`")
    confidence = quantity(options.confidence, "", "--confidence") or 0.0
    if not 0.0 < confidence < 1.0:
        raise Usage(f"`--confidence {options.confidence}` is not between 0 and 1")
    choice, columns = choice_of(options), pairs(options.pairs, "quantity=column, as in 'theta=angle[deg]'")
    compilation = Compilation(model_library.read(options.file), choice)
    model = CompiledModel(compilation, options.backend)
    spare(compilation, options.plot)
    with Bar(1.0, quiet=options.quiet or options.json) as bar:
        found = model.fit(
            options.data, vary, columns, starts=quantities(options.starts, "--start"), confidence=confidence,
            method=options.method, progress=lambda t: bar.part(0.0, "fitting"), **run_numbers(options),
        )  # fmt: skip
    # The result exists: a limit that is reached while it is drawn or printed does not lose it.
    finish_uninterrupted()
    heading = f"{model.interface.model}, scene {model.interface.scene}"
    written = not options.plot or _draw(found, heading, options)
    # With a direction that the data do not determine there is no fit, even if the search has ended.
    if options.json:
        status = "ok" if found.converged and not found.unseen else "failed"
        print_json({"status": status, "model": model.interface.model, "scene": model.interface.scene,
                    **to_dict(found)})  # fmt: skip
    else:
        show_report(text(found, heading), color=False if options.no_color or options.quiet else None)
    if not written:
        return UNWRITTEN
    return DONE if found.converged and not found.unseen else FAILED


def _draw(found: Fit, heading: str, options: argparse.Namespace) -> bool:
    from lagc.reports.plots.fit import draw
    from lagc.reports.plots.plot import save

    figure = draw(found, heading)
    path = write_or_keep(options.plot, lambda name: save(figure, name), (OSError, ValueError))
    if path is not None:
        say(f"plot written to {path}", options.quiet or options.json)
    found_there: bool = path == options.plot
    return found_there
