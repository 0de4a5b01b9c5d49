"""Generated code for other projects: self-contained C99, or a NumPy module.

What is written needs no lagc, and belongs to you (see LICENSE).
"""

from __future__ import annotations

import argparse
import os

from lagc.cli.exits import DONE, Usage
from lagc.cli.options import add_general_options, add_model_options, choice_of
from lagc.cli.output import print_json, say


def add_options(parser: argparse.ArgumentParser) -> None:
    add_model_options(parser)
    parser.add_argument("--target", choices=("c", "numpy"), default="c", help="what is generated")
    parser.add_argument(
        "-o", "--output", metavar="DIR", default=".", help="the folder that receives it; made where absent"
    )
    add_general_options(parser)


def run(options: argparse.Namespace) -> int:
    from lagc import compiler, library

    source = library.read(options.file)
    program = compiler.program(source, choice_of(options))
    files = compiler.render(program, options.target)
    paths = write(files, options.output)
    if options.json:
        interface = program.interface
        print_json(
            {
                "status": "ok",
                "model": interface.model,
                "scene": interface.scene,
                "effects": interface.effects,
                "target": options.target,
                "files": paths,
                "operations": interface.operations,
                "warnings": interface.warnings,
                "dropped": interface.dropped,
            }
        )
    elif not options.quiet:
        for warning in program.interface.warnings:
            say(f"warning: {warning}")
        for note in program.interface.notes:
            say(note)
        print("\n".join(paths))
    return DONE


def write(files: dict[str, str], folder: str) -> list[str]:
    """Write each text; the paths.  Raises Usage where that cannot be done."""
    paths = []
    try:
        os.makedirs(folder, exist_ok=True)
        for name, text in files.items():
            path = os.path.join(folder, name)
            with open(path, "w", encoding="utf-8", newline="\n") as file:
                file.write(text)
            paths.append(path)
    except OSError as error:
        raise Usage(f"`{folder}` cannot be written: {error.strerror}") from None
    return paths
