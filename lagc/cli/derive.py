"""Write the worked solution of a model, from its declarations to its equations.

Parameters, constraints, velocities, kinetic energy, the virtual power of each action, forces of constraints,
and Lagrange's equations with every term named; the last lines are those of `lagc equations`.  Without -o it
is printed in Markdown; the ending of the file chooses Markdown (.md), LaTeX (.tex), HTML (.html) or PDF
(.pdf), which needs a LaTeX.  `--to motion` adds a run with its plot.
"""

from __future__ import annotations

import argparse
import os
from importlib.util import find_spec
from typing import TYPE_CHECKING

from lagc.cli.options import add_model_options, choice_of
from lagc.cli.output import DONE, Usage, cannot_write, print_faults, print_json, say, show
from lagc.cli.signals import SIGNALS

if TYPE_CHECKING:
    from lagc.reports.derivation.derivation import Derivation

ENDINGS = (".md", ".tex", ".html", ".pdf")


def add_options(parser: argparse.ArgumentParser) -> None:
    add_model_options(parser)
    about = "where the solution ends: at the equations, or with a run and its plot"
    parser.add_argument("--to", choices=("equations", "motion"), default="equations", help=about)
    about = "the language of the sentences"
    parser.add_argument("--language", choices=("en", "fr", "de"), default="en", help=about)
    parser.add_argument("--full", action="store_true", help="write all terms of long formulas")
    about = "the file to write, .md, .tex, .html or .pdf; - prints Markdown"
    parser.add_argument("-o", "--output", metavar="FILE", default="-", help=about)


def run(options: argparse.Namespace) -> int:
    from lagc.compiler import pipeline, stages
    from lagc.host import model_library
    from lagc.host.budgets import stage
    from lagc.reports.derivation.derivation import derivation_of

    ending = os.path.splitext(options.output)[1].lower()
    if options.output != "-" and ending not in ENDINGS:
        raise Usage(f"`{options.output}` ends in none of {', '.join(ENDINGS)}")
    source, choice = model_library.read(options.file), choice_of(options)
    equations = pipeline.equations(source, choice)
    if equations.warnings and not (options.quiet or options.json):
        print_faults(equations.warnings, color=False if options.no_color else None)
    with stage("writing the solution", stages.PER_PAIR * len(equations.v) ** 2):
        solution = derivation_of(equations, options.language, options.full)
    if options.to == "motion":
        from lagc.api import CompiledModel
        from lagc.compiler.pipeline import Compilation
        from lagc.reports.derivation.derivation import with_motion

        if find_spec("matplotlib") is None:
            raise Usage("a plot needs matplotlib: pip install matplotlib")
        solution = with_motion(solution, CompiledModel(Compilation(source, choice)).simulate())
    if options.json:
        print_json({"status": "ok", "model": equations.model.name, "scene": equations.model.scene,
                    "language": options.language, "solution": solution.markdown})  # fmt: skip
    elif options.output == "-":
        show(solution.markdown)
    else:
        _write(solution, options.output, ending)
        say(f"{options.output} written", options.quiet)
    return DONE


def _write(found: Derivation, path: str, ending: str) -> None:
    """Write the solution, and beside it the plot that Markdown and LaTeX refer to.  Raises Usage if there is
    no LaTeX for a PDF."""
    from lagc.host import atomic_write
    from lagc.reports.derivation.formats import NoLatex

    try:
        if ending == ".pdf":
            data = found.pdf
        else:
            data = {".md": found.markdown, ".tex": found.latex, ".html": found.html}[ending].encode()
    except NoLatex as missing:
        raise Usage(str(missing)) from None
    folder = os.path.dirname(path)
    files = {path: data, **{os.path.join(folder, name): x for name, x in found.pictures(ending).items()}}
    try:
        with SIGNALS.patience():
            for name, data in files.items():
                atomic_write.write(name, data)
    except OSError as error:
        raise cannot_write(path, error) from None
