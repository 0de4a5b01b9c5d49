"""Write generated code for other projects: self-contained C99, a NumPy module, or an FMU.

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
from lagc.host.packages import is_installed
from lagc.kernels import DEFAULT_METHOD, METHODS

if TYPE_CHECKING:
    from lagc.compiler.pipeline import Compilation
    from lagc.lowering.program import Interface, Program
    from lagc.simulation.backends.cross import Platform


FMUS = {"fmu3": 3, "fmu2": 2}  # targets, with their version of FMI


def add_options(parser: argparse.ArgumentParser) -> None:
    add_model_options(parser)
    add_outputs_option(parser)
    # The kind of code, and where it goes.
    parser.add_argument(
        "--target", choices=("c", "numpy", *FMUS), default="c",
        help="C, a Python module, or a Functional Mock-up Unit of FMI 3.0 or 2.0",
    )  # fmt: skip
    parser.add_argument(
        "-o", "--output", metavar="DIR", default=".",
        help="the folder for the files; created if it does not exist",
    )  # fmt: skip
    # The functions that it has.
    parser.add_argument(
        "--method", metavar="NAME,...", default=DEFAULT_METHOD, type=methods,
        help=f"the methods of integration that the code has: some of {', '.join(METHODS)}",
    )  # fmt: skip
    for name, about in {
        "--derivatives": "add exact derivatives by state, parameters and inputs",
        "--events": "add functions of events for integrators of your own, in C",
        "--verified": "add the run to a global accuracy that returns its error, in C",
        "--cmake": "add files for CMake and pkg-config",
        "--no-binaries": "an FMU of sources alone",
    }.items():
        parser.add_argument(name, action="store_true", help=about)
    parser.add_argument(
        "--only", metavar="NAME,...", type=lambda text: tuple(name.strip() for name in text.split(",")),
        default=(), help="the functions that the C has, such as rhs,outputs, without integrators",
    )  # fmt: skip
    # Options of one target.
    parser.add_argument(
        "--real", choices=("double", "float", "quad"), default="double",
        help="the type of numbers in C (quad: __float128 of GCC)",
    )  # fmt: skip
    parser.add_argument("--version", metavar="1.2.0", type=version,
                        help="of the package of --cmake (default: 1.0.0)")  # fmt: skip
    parser.add_argument(
        "--platforms", metavar="NAME,...", type=platforms,
        help="the machines that an FMU has libraries for, such as linux64,win64; default: this one",
    )  # fmt: skip


def version(text: str) -> str:
    """Return a version of CMake: up to four numbers.  Raises ArgumentTypeError."""
    numbers = text.split(".")
    if len(numbers) > 4 or not all(number.isascii() and number.isdigit() for number in numbers):
        raise argparse.ArgumentTypeError(f"{text!r} is no version such as 1.2.0")
    return text


def chosen(text: str, known: Sequence[str], what: str) -> list[str]:
    """Return the names in a list with commas.  Raises ArgumentTypeError for one that is not known."""
    names = [name.strip() for name in text.split(",")]
    for name in names:
        if name not in known:
            raise argparse.ArgumentTypeError(f"{name!r} is no {what}; choose from {', '.join(known)}")
    return names


def methods(text: str) -> tuple[str, ...]:
    """Return the names in a list with commas, in the order of METHODS.  Raises ArgumentTypeError."""
    names = chosen(text, METHODS, "method")
    return tuple([name for name in METHODS if name in names])


def platforms(text: str) -> tuple[Platform, ...]:
    """Return the platforms in a list of names with commas.  Raises ArgumentTypeError."""
    from lagc.simulation.backends.cross import PLATFORMS

    known = {name: p for p in PLATFORMS for name in (p.old_name, p.name)}
    return tuple({known[name]: None for name in chosen(text, [*known], "platform")})


def check(options: argparse.Namespace) -> None:
    """Raise Usage for options that do not belong together, and for an output that is no folder."""
    is_c, is_fmu = options.target == "c", options.target in FMUS
    integrating = {"--events": options.events, "--verified": options.verified}
    of_c = {
        "--real": options.real != "double",
        "--only": options.only,
        "--cmake": options.cmake,
        **integrating,
    }
    # The first message whose condition holds.
    found = [f"{name} needs --target c" for name, given in of_c.items() if given and not is_c]
    if (options.platforms or options.no_binaries) and not is_fmu:
        found.append("--platforms and --no-binaries need --target fmu3 or fmu2")
    if options.derivatives and is_fmu:
        found.append("an FMU has directional derivatives: leave --derivatives out")
    if options.version and not options.cmake:
        found.append("--version needs --cmake")
    if options.only:
        found += [f"--only leaves out what integrates, which {name} is for: give one of them"
                  for name, given in integrating.items() if given]  # fmt: skip
    if options.platforms and not is_installed("ziglang"):
        found.append("--platforms needs ziglang: pip install ziglang")
    if not options.output:
        found.append("-o needs the name of a folder")
    elif options.output.endswith(".fmu"):
        found.append(f"-o names the folder, not the file: `{options.output}`")
    elif file := no_folder(options.output):
        found.append(f"`{file}` is no folder: -o needs the name of a folder")
    if found:
        raise Usage(found[0])


def check_only(program: Program, names: Sequence[str]) -> None:
    """Raise Usage for names of no function that evaluates the model."""
    from lagc.codegen.c.runtime import evaluations

    known = evaluations(program)
    for name in names:
        if name not in known:
            raise Usage(
                f"--only: `{name}` is no function that evaluates this model; choose from {', '.join(known)}"
            )


def generated(options: argparse.Namespace, compilation: Compilation) -> tuple[Interface, dict[str, bytes]]:
    """Return the interface of the model, and its files by name.  Raises Usage without a C compiler."""
    from lagc.codegen.c.cmake import package
    from lagc.codegen.identifiers import prefix
    from lagc.compiler import pipeline, stages

    if options.target in FMUS:
        from lagc.compiler.fmu import fmu
        from lagc.simulation.backends.compile import CannotCompile

        places = () if options.no_binaries else options.platforms
        try:
            return fmu(compilation, FMUS[options.target], options.method, places)
        except CannotCompile as error:
            raise Usage(f"{error}; --no-binaries writes an FMU of sources alone") from None
    contents = pipeline.Contents(options.method, options.derivatives, False, options.events, options.verified)
    program = pipeline.delivered(compilation, contents)
    check_only(program, options.only)
    texts = stages.render(program, options.target, real=options.real, only=options.only)
    if options.cmake:
        texts |= package(prefix(program.interface.model), options.version or "1.0.0", options.real)
    return program.interface, {name: text.encode() for name, text in texts.items()}


def run(options: argparse.Namespace) -> int:
    from lagc.codegen.description import describe
    from lagc.compiler import pipeline
    from lagc.host import model_library
    from lagc.simulation.request import warnings_of

    check(options)
    # Nothing is written before all code exists and no file that the model reads would be replaced.
    compilation = pipeline.Compilation(model_library.read(options.file), choice_of(options))
    interface, files = generated(options, compilation)
    spare(compilation, *(os.path.join(options.output, name) for name in files))
    paths = write(files, options.output)
    warnings = warnings_of(interface, {**compilation.choice.inputs, **compilation.choice.parameters})
    if options.json:
        facts = {name: getattr(interface, name) for name in ("model", "scene", "effects")}
        facts |= {"target": options.target, "files": paths, "operations": interface.operations}
        if options.target not in FMUS:
            header = next((text.decode() for name, text in files.items() if name.endswith(".h")), None)
            facts |= describe(interface, header, options.real)
        print_json({"status": "ok", **facts, "warnings": warnings, "dropped": interface.dropped})
    elif not options.quiet:
        for warning in warnings:
            say(f"warning: {warning}")
        for note in interface.notes:
            say(note)
        show("".join(f"{one_line(path)}\n" for path in paths))
    return DONE


def write(files: dict[str, bytes], where: str) -> list[str]:
    """Write all files, or none if one cannot be written, and return their paths.  Raises Usage or
    Unwritten."""
    paths = {name: os.path.join(where, name) for name in files}
    try:
        with SIGNALS.patience(), folder(where), Files() as written:
            for name, data in files.items():
                written.open(paths[name]).write(data)
    except OSError as error:
        raise cannot_write(where, error) from None
    return list(paths.values())
