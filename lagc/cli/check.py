"""The faults of model files: of each stage all that one can see."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from lagc.cli.options import add_general_options, add_limit_options, add_parameter_option, quantities
from lagc.cli.output import DONE, Usage, code_of, print_faults, print_json, say, show
from lagc.diagnostics.faults import Fault, Refused

if TYPE_CHECKING:
    from lagc.compiler.checking import Checked


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "files", metavar="FILE", nargs="*", help="model files, models of the library, or - for standard input"
    )
    parser.add_argument(
        "--format", choices=("text", "json"), default="text", help="how the faults are printed"
    )
    parser.add_argument("--scene", metavar="S", help="check this scene only; without it, every scene")
    parser.add_argument("--model", metavar="M", help="which model, where a file has several")
    add_parameter_option(parser)
    parser.add_argument("--explain", metavar="CODE", help="what a fault's code means, with an example")
    add_limit_options(parser)
    add_general_options(parser)


def run(options: argparse.Namespace) -> int:
    if options.explain:
        return explain(options.explain)
    if not options.files:
        raise Usage("which file? `lagc check FILE...`")
    if options.files.count("-") > 1:
        raise Usage("standard input, `-`, is read once")
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
        from lagc.diagnostics.report import as_json

        print_json({"status": "refused" if wrong else "ok", "faults": as_json(faults), "unseen": unseen})
    elif faults:
        last = f"{', '.join(unseen[:-1])} and {unseen[-1]}" if len(unseen) > 1 else "".join(unseen)
        more = f"{last} are looked at once there are none" if unseen else ""
        print_faults(faults, color=False if options.no_color else None, result=True, more=more)
    elif not options.quiet:
        say("no faults in " + (f"{len(options.files)} files" if len(options.files) > 1 else options.files[0]))
    return code_of(wrong) if wrong else DONE


def look_at(name: str, options: argparse.Namespace) -> Checked:
    from lagc.compiler import checking, pipeline
    from lagc.host import model_library

    try:
        source = model_library.read(name)
    except Refused as refused:
        return checking.Checked(list(refused.faults), checking.STAGES)
    given = quantities(options.parameters, "-p")
    choice = pipeline.Choice(model=options.model, scene=options.scene, parameters=given)
    try:
        return checking.look(source, choice)
    except Refused as refused:  # of what was given
        return checking.Checked(list(refused.faults), ())


def explain(code: str) -> int:
    """Print the catalogue's entry of a fault code."""
    from lagc.diagnostics.catalogue import entries

    code = code.upper()
    entry = entries().get(code)
    if entry is None:
        raise Usage(f"there is no fault `{code}`")
    show(f"{code}: {entry.title}\n\n{entry.explanation}\n")
    for title, text in (("wrong", entry.wrong), ("right", entry.right)):
        if text:
            lines = "".join(f"    {line}\n" for line in text.strip("\n").splitlines())
            show(f"\n{title}:\n\n{lines}")
    return DONE
