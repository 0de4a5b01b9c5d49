"""Print the equations of motion as a person would write them.

One equation for each generalized speed, then the constraints; a prime is a time derivative.  A model with
contacts has a system for each mode, or one with the laws of all.  `--format latex` prints text for a
document that uses the package amsmath, `--format sympy` a Python script that builds the equations with SymPy.
"""

import argparse

from lagc.cli.options import add_model_options, choice_of
from lagc.cli.output import DONE, Usage, print_faults, print_json, say, show


def add_options(parser: argparse.ArgumentParser) -> None:
    add_model_options(parser)
    parser.add_argument(
        "--format", choices=("text", "latex", "sympy"), default="text", help="the format of the equations"
    )
    about = (
        "the form: divided by common factors, as derived, solved for the accelerations, the entries of M, h, "
    )
    about += "Q and G, or Hamilton's equations"
    forms = ("divided", "undivided", "solved", "matrix", "hamilton")
    parser.add_argument("--form", choices=forms, default="divided", help=about)
    parser.add_argument("--full", action="store_true", help="print every term, also of large models")


def run(options: argparse.Namespace) -> int:
    from lagc.compiler import pipeline, stages
    from lagc.host import model_library
    from lagc.host.budgets import stage
    from lagc.reports.equations.forms import NoForm
    from lagc.reports.equations.write import write

    equations = pipeline.equations(model_library.read(options.file), choice_of(options))
    with stage("writing the equations", stages.PER_PAIR * len(equations.v) ** 2):
        try:
            text = write(equations, options.format, options.full, options.form)
        except NoForm as reason:
            raise Usage(str(reason)) from None
    if options.json:
        model = equations.model
        print_json({"status": "ok", "model": model.name, "scene": model.scene,
                    "effects": [e.name for e in model.effects if e.used],
                    "format": options.format, "form": options.form, "equations": text})  # fmt: skip
        return DONE
    if equations.warnings and not options.quiet:
        print_faults(equations.warnings, color=False if options.no_color else None)
    for note in equations.model.notes:
        say(note, options.quiet)
    show(text + "\n")
    return DONE
