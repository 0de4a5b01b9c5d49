"""Format model files; comments are kept.

Files are rewritten in place; `-` formats standard input to standard output.
"""

import argparse
import os

from lagc.cli.options import add_limit_options
from lagc.cli.output import DONE, REFUSED, Usage, cannot_write, say, show
from lagc.cli.signals import SIGNALS
from lagc.host import atomic_write, model_library

JSON = False  # no option `--json`


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("files", metavar="FILE", nargs="+", help="model files, or - for standard input")
    parser.add_argument(
        "--check", action="store_true", help="change nothing; exit code 1 if a file is not formatted"
    )
    add_limit_options(parser)


def run(options: argparse.Namespace) -> int:
    from lagc.syntax.formatter import format_source

    differs = False
    for name in options.files:
        if name != "-" and not os.path.isfile(name):
            there = os.path.exists(name)
            raise Usage(f"`{name}` is not a regular file" if there else f"there is no file `{name}`")
        source = model_library.read(name)
        text = format_source(source)
        if name == "-" and not options.check:
            show(text, exact=True)
        elif text != source.text:
            differs = True
            if options.check:
                say(f"{name} is not formatted", options.quiet)
            else:
                replace(name, text)
                say(f"{name} formatted", options.quiet)
    return REFUSED if options.check and differs else DONE


def replace(path: str, text: str) -> None:
    """Replace the file `path` by `text`, completely or not at all."""
    try:
        with SIGNALS.patience():
            atomic_write.write(path, text.encode())
    except OSError as error:
        raise cannot_write(path, error) from None
