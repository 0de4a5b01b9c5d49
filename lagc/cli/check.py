"""Report the errors of model files, as many as each stage can find.

The stages are the syntax, names and dimensions, the equations, and the initial conditions.
"""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from lagc.cli.options import add_limit_options, add_parameter_option, quantities
from lagc.cli.output import DONE, Usage, code_of, print_faults, print_json, say, show
from lagc.diagnostics.faults import Fault, Refused

if TYPE_CHECKING:
    from lagc.compiler.checking import Checked


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "files", metavar="FILE", nargs="*", help="model files, models of the library, or - for standard input"
    )
    parser.add_argument("--format", choices=("text", "json"), default="text", help="the format of the report")
    parser.add_argument("--scene", metavar="S", help="check only this scene; default: every scene")
    parser.add_argument("--model", metavar="M", help="the model, if a file has several")
    add_parameter_option(parser)
    parser.add_argument("--explain", metavar="CODE", help="explain an error code, with an example")
    add_limit_options(parser)


def run(options: argparse.Namespace) -> int:
    if options.explain:
        return explain(options.explain)
    if not options.files:
        raise Usage("FILE is missing: `lagc check FILE...`")
    if options.files.count("-") > 1:
        raise Usage("standard input, `-`, can be given only once")
    from lagc.compiler.checking import STAGES

    faults: list[Fault] = []
    left: set[str] = set()
    for name in options.files:
        found = look_at(name, options)
        faults += found.faults
        left.update(found.unseen)
    unseen = [stage for stage in STAGES if stage in left]
    wrong = [f for f in faults if f.severity == "error"]
    if options.json or options.format == "json":
        from lagc.diagnostics.faults import as_json

        print_json({"status": "refused" if wrong else "ok", "faults": as_json(faults), "unseen": unseen})
    elif faults:
        last = f"{', '.join(unseen[:-1])} and {unseen[-1]}" if len(unseen) > 1 else "".join(unseen)
        more = f"fix this to check {last}" if unseen else ""
        print_faults(faults, color=False if options.no_color else None, result=True, more=more)
    elif not options.quiet:
        say("no errors in " + (f"{len(options.files)} files" if len(options.files) > 1 else options.files[0]))
    return code_of(wrong) if wrong else DONE


def look_at(name: str, options: argparse.Namespace) -> Checked:
    """Check one file; a file that cannot be read counts as an error."""
    from lagc.compiler import checking, stages
    from lagc.host import model_library

    try:
        source = model_library.read(name)
    except Refused as refused:
        return checking.Checked(list(refused.faults), checking.STAGES)
    given = quantities(options.parameters, "-p")
    choice = stages.Choice(model=options.model, scene=options.scene, parameters=given)
    try:
        return checking.look(source, choice)
    except Refused as refused:  # an option is wrong
        return checking.Checked(list(refused.faults), ())


def explain(code: str) -> int:
    """Print the explanation of an error code."""
    from lagc.diagnostics.catalogue import entries
    from lagc.host.model_library import messages_folder

    code = code.upper()
    entry = entries(messages_folder()).get(code)
    if entry is None:
        raise Usage(f"there is no error code `{code}`")
    show(entry.shown(code))
    return DONE
