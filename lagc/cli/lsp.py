"""Serve an editor over the Language Server Protocol, by standard input and output.

An editor starts it.  It tells faults while a model is written, with fixes; units, values and declarations of
names; it completes, renames and formats.
"""

import argparse

from lagc.cli.output import DONE, Usage

JSON = False  # no option `--json`


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--stdio", action="store_true", help="use standard input and output, as always")


def run(options: argparse.Namespace) -> int:
    from lagc.host.packages import is_installed

    if not is_installed("pygls"):
        raise Usage('the language server needs pygls: pip install "lagc[lsp]"')
    from lagc.editor.server import server

    server.start_io()
    return DONE
