"""Explain what lagc derived from a model.

Coordinates and speeds, constraints and their types, degrees of freedom, cyclic coordinates and conserved
quantities, the parts of the kinetic energy, effects that are used or left out, and the operation counts of
the generated code.
"""

import argparse

from lagc.cli.options import add_model_options, add_outputs_option, choice_of
from lagc.cli.output import DONE, print_json, show


def add_options(parser: argparse.ArgumentParser) -> None:
    add_model_options(parser)
    add_outputs_option(parser)


def run(options: argparse.Namespace) -> int:
    from lagc.compiler import pipeline, stages
    from lagc.host import model_library
    from lagc.host.budgets import stage
    from lagc.reports.explain import explanation, text

    equations = pipeline.equations(model_library.read(options.file), choice_of(options))
    program = stages.optimize(equations, work=False)
    with stage("examining the equations", stages.PER_PAIR * len(equations.v) ** 2):
        facts = explanation(equations, program, whole=options.json or options.verbose)
    if options.json:
        print_json({"status": "ok", **facts})
    else:
        show(text(facts, verbose=options.verbose) + "\n")
    return DONE
