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
from lagc.kernels import DEFAULT_METHOD, METHODS

if TYPE_CHECKING:
    from lagc.compiler.pipeline import Compilation
    from lagc.lowering.program import Interface, Program
    from lagc.simulation.backends.cross import Platform


FMUS = {"fmu3": 3, "fmu2": 2}  # targets, with their version of FMI


def add_options(parser: argparse.ArgumentParser) -> None:
    add_model_options(parser)
    add_outputs_option(parser)
    parser.add_argument(
        "--target", choices=("c", "numpy", *FMUS), default="c",
        help="C, a Python module, or a Functional Mock-up Unit of FMI 3.0 or 2.0",
    )  # fmt: skip
    parser.add_argument(
        "--platforms", metavar="NAME,...", type=platforms,
        help="the machines that an FMU has libraries for, such as linux64,win64; default: this one",
    )  # fmt: skip
    parser.add_argument("--no-binaries", action="store_true", help="an FMU of sources alone")
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
        "--events", action="store_true", help="add functions of events for integrators of your own, in C"
    )
    parser.add_argument(
        "--verified",
        action="store_true",
        help="add the run to a global accuracy that returns its error, in C",
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
    for name, given in (("--events", options.events), ("--verified", options.verified)):
        if given and options.target != "c":
            raise Usage(f"{name} needs --target c")
        if given and options.only:
            raise Usage(f"--only leaves out what integrates, which {name} is for: give one of them")


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


def platforms(text: str) -> tuple[Platform, ...]:
    """Return the platforms in a list of names with commas.  Raises ArgumentTypeError."""
    from lagc.simulation.backends.cross import PLATFORMS, named

    found = {name: named(name.strip()) for name in text.split(",")}
    for name, platform in found.items():
        if platform is None:
            known = ", ".join(p.old_name for p in PLATFORMS)
            raise argparse.ArgumentTypeError(f"{name!r} is no platform; choose from {known}")
    return tuple([platform for platform in found.values() if platform is not None])


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
    program = pipeline.delivered(compilation, options.derivatives, options.method, options.events,
                                 verified=options.verified)  # fmt: skip
    check_only(program, options.only)
    texts = stages.render(program, options.target, real=options.real, only=options.only)
    if options.cmake:
        texts |= package(prefix(program.interface.model), options.version or "1.0.0", options.real)
    return program.interface, {name: text.encode() for name, text in texts.items()}


def check(options: argparse.Namespace) -> None:
    """Raise Usage for options that do not belong together."""
    if options.platforms:
        from lagc.host.packages import is_installed

        if not is_installed("ziglang"):
            raise Usage("--platforms needs ziglang: pip install ziglang")
    is_fmu = options.target in FMUS
    if (options.platforms or options.no_binaries) and not is_fmu:
        raise Usage("--platforms and --no-binaries need --target fmu3 or fmu2")
    if options.derivatives and is_fmu:
        raise Usage("an FMU has directional derivatives: leave --derivatives out")


def run(options: argparse.Namespace) -> int:
    from lagc.codegen.description import describe
    from lagc.compiler import pipeline
    from lagc.host import model_library
    from lagc.simulation.request import warnings_of

    check(options)
    if options.real != "double" and options.target != "c":
        raise Usage("--real needs --target c")
    check_c_options(options)
    if not options.output:
        raise Usage("-o needs the name of a folder")
    if options.output.endswith(".fmu"):
        raise Usage(f"-o names the folder, not the file: `{options.output}`")
    if file := no_folder(options.output):
        raise Usage(f"`{file}` is no folder: -o needs the name of a folder")
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
