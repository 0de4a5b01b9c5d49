"""Write generated code for other projects: self-contained C99, or a NumPy module.

The code needs no lagc, and belongs to you (see LICENSE).
"""

from __future__ import annotations

import argparse
import os

from lagc.base.text import one_line
from lagc.cli.deliver import spare
from lagc.cli.options import add_model_options, add_outputs_option, choice_of
from lagc.cli.output import DONE, Usage, cannot_write, print_json, say, show
from lagc.cli.signals import SIGNALS
from lagc.host.atomic_write import Files, folder, no_folder
from lagc.kernels import DEFAULT_METHOD, METHODS


def add_options(parser: argparse.ArgumentParser) -> None:
    add_model_options(parser)
    add_outputs_option(parser)
    parser.add_argument("--target", choices=("c", "numpy"), default="c", help="the language of the code")
    parser.add_argument(
        "--real", choices=("double", "float", "quad"), default="double",
        help="the type of numbers in C (quad: __float128 of GCC)",
    )  # fmt: skip
    parser.add_argument(
        "-o",
        "--output",
        metavar="DIR",
        default=".",
        help="the folder for the files; created if it does not exist",
    )
    parser.add_argument(
        "--derivatives", action="store_true", help="add exact derivatives by state, parameters and inputs"
    )
    parser.add_argument(
        "--method",
        metavar="NAME,...",
        default=DEFAULT_METHOD,
        type=methods,
        help=f"the methods of integration that the code has: some of {', '.join(METHODS)}",
    )


def methods(text: str) -> tuple[str, ...]:
    """Return the names in a list with commas, in the order of METHODS.  Raises ArgumentTypeError."""
    names = [name.strip() for name in text.split(",")]
    for name in names:
        if name not in METHODS:
            known = ", ".join(METHODS)
            raise argparse.ArgumentTypeError(f"{name!r} is no method; choose from {known}")
    return tuple([name for name in METHODS if name in names])


def run(options: argparse.Namespace) -> int:
    from lagc.compiler import pipeline, stages
    from lagc.host import model_library
    from lagc.simulation.request import warnings_of

    if options.real != "double" and options.target != "c":
        raise Usage("--real needs --target c")
    if not options.output:
        raise Usage("-o needs the name of a folder")
    if file := no_folder(options.output):
        raise Usage(f"`{file}` is no folder: -o needs the name of a folder")
    # Nothing is written before all code exists and no file that the model reads would be replaced.
    compilation = pipeline.Compilation(model_library.read(options.file), choice_of(options))
    program = pipeline.delivered(compilation, options.derivatives, options.method)
    files = stages.render(program, options.target, real=options.real)
    spare(compilation, *(os.path.join(options.output, name) for name in files))
    paths = write(files, options.output)
    warnings = warnings_of(program.interface, {**compilation.choice.inputs, **compilation.choice.parameters})
    if options.json:
        interface = program.interface
        facts = {name: getattr(interface, name) for name in ("model", "scene", "effects")}
        facts |= {"target": options.target, "files": paths, "operations": interface.operations}
        print_json({"status": "ok", **facts, "warnings": warnings, "dropped": interface.dropped})
    elif not options.quiet:
        for warning in warnings:
            say(f"warning: {warning}")
        for note in program.interface.notes:
            say(note)
        show("".join(f"{one_line(path)}\n" for path in paths))
    return DONE


def write(files: dict[str, str], where: str) -> list[str]:
    """Write all files, or none if one cannot be written, and return their paths.  Raises Usage or
    Unwritten."""
    paths = {name: os.path.join(where, name) for name in files}
    try:
        with SIGNALS.patience(), folder(where), Files() as written:
            for name, text in files.items():
                written.open(paths[name]).write(text.encode())
    except OSError as error:
        raise cannot_write(where, error) from None
    return list(paths.values())
