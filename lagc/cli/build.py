"""Write generated code for other projects: self-contained C99, or a NumPy module.

The code needs no lagc, and belongs to you (see LICENSE).
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Sequence
from typing import TYPE_CHECKING

from lagc.base.text import one_line
from lagc.cli.deliver import spare
from lagc.cli.options import add_model_options, add_outputs_option, choice_of
from lagc.cli.output import DONE, Usage, cannot_write, print_json, say, show
from lagc.cli.signals import SIGNALS
from lagc.host.atomic_write import Files, folder, no_folder
from lagc.kernels import DEFAULT_METHOD, METHODS

if TYPE_CHECKING:
    from lagc.lowering.program import Program


def add_options(parser: argparse.ArgumentParser) -> None:
    add_model_options(parser)
    add_outputs_option(parser)
    parser.add_argument("--target", choices=("c", "numpy"), default="c", help="the language of the code")
    parser.add_argument(
        "--real", choices=("double", "float", "quad"), default="double",
        help="the type of numbers in C (quad: __float128 of GCC)",
    )  # fmt: skip
    add_c_options(parser)
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


def add_c_options(parser: argparse.ArgumentParser) -> None:
    """Options of --target c."""
    parser.add_argument(
        "--only", metavar="NAME,...", type=lambda text: tuple(name.strip() for name in text.split(",")),
        default=(), help="the functions that the C has, such as rhs,outputs, without integrators",
    )  # fmt: skip
    parser.add_argument("--cmake", action="store_true", help="add files for CMake and pkg-config")
    parser.add_argument("--version", metavar="1.2.0", type=version, help="of that package (default: 1.0.0)")


def version(text: str) -> str:
    """Return a version of CMake: up to four numbers.  Raises ArgumentTypeError."""
    numbers = text.split(".")
    if len(numbers) > 4 or not all(number.isascii() and number.isdigit() for number in numbers):
        raise argparse.ArgumentTypeError(f"{text!r} is no version such as 1.2.0")
    return text


def check_c_options(options: argparse.Namespace) -> None:
    """Raise Usage for options of C that do not belong to the others."""
    for name, given in (("--only", options.only), ("--cmake", options.cmake)):
        if given and options.target != "c":
            raise Usage(f"{name} needs --target c")
    if options.version and not options.cmake:
        raise Usage("--version needs --cmake")
    if options.only and options.derivatives:
        raise Usage("--derivatives adds functions: name them in --only")


def check_only(program: Program, names: Sequence[str]) -> None:
    """Raise Usage for names of no function that evaluates the model."""
    from lagc.codegen.c.runtime import evaluations

    known = evaluations(program)
    for name in names:
        if name not in known:
            raise Usage(
                f"--only: `{name}` is no function that evaluates this model; choose from {', '.join(known)}"
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
    from lagc.codegen.c.cmake import package
    from lagc.codegen.description import describe
    from lagc.codegen.identifiers import prefix
    from lagc.compiler import pipeline, stages
    from lagc.host import model_library
    from lagc.simulation.request import warnings_of

    if options.real != "double" and options.target != "c":
        raise Usage("--real needs --target c")
    check_c_options(options)
    if not options.output:
        raise Usage("-o needs the name of a folder")
    if file := no_folder(options.output):
        raise Usage(f"`{file}` is no folder: -o needs the name of a folder")
    # Nothing is written before all code exists and no file that the model reads would be replaced.
    compilation = pipeline.Compilation(model_library.read(options.file), choice_of(options))
    program = pipeline.delivered(compilation, options.derivatives, options.method)
    check_only(program, options.only)
    files = stages.render(program, options.target, real=options.real, only=options.only)
    if options.cmake:
        files |= package(prefix(program.interface.model), options.version or "1.0.0", options.real)
    spare(compilation, *(os.path.join(options.output, name) for name in files))
    paths = write(files, options.output)
    warnings = warnings_of(program.interface, {**compilation.choice.inputs, **compilation.choice.parameters})
    if options.json:
        interface = program.interface
        facts = {name: getattr(interface, name) for name in ("model", "scene", "effects")}
        facts |= {"target": options.target, "files": paths, "operations": interface.operations}
        facts |= describe(interface, files, options.target, options.real)
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
