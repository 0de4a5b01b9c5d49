"""`lagc COMMAND ...`: one file a command, loaded when it is asked for."""

from __future__ import annotations

import argparse
import importlib
import os
import sys
from contextlib import suppress
from typing import NoReturn

from lagc.cli.output import (
    DONE,
    INTERNAL,
    INTERRUPTED,
    UNWRITTEN,
    USAGE,
    Unwritten,
    Usage,
    begin,
    code,
    code_of,
    print_faults,
    print_json,
    say,
    show,
)
from lagc.cli.signals import SIGNALS
from lagc.diagnostics.faults import Refused
from lagc.version import __version__

COMMANDS = {
    "check": "the faults of model files, those of each stage at once",
    "fmt": "the one way to lay a model out",
    "explain": "what was inferred from a model",
    "equations": "the equations of motion, as a person would write them",
    "sim": "compile and simulate",
    "linearize": "equilibria and linear models",
    "build": "generated code for other projects",
    "new": "a model to start from; --list: those that there are",
    "cache": "what is kept of compiled models: show, verify, clear",
}


def main(arguments: list[str] | None = None) -> int:
    """Run one command; the exit code (`lagc.cli.output`)."""
    words = sys.argv[1:] if arguments is None else list(arguments)
    verbose = "-v" in words or "--verbose" in words
    begin()
    try:
        return code(_dispatch(words))
    except Usage as error:
        say(f"lagc: {error}")
        return USAGE
    except Unwritten as error:
        say(f"lagc: {error}")
        return UNWRITTEN
    except Refused as refused:
        _report(refused, words)
        return code(code_of(refused.faults))
    except KeyboardInterrupt:
        say("interrupted")
        return INTERRUPTED
    except SystemExit as stop:  # argparse has said what it had to say
        return code(stop.code if isinstance(stop.code, int) else USAGE)
    except Exception as error:  # the last resort: nobody gets a traceback
        if SIGNALS.number:  # what was being loaded makes errors of its own of an interruption
            say("interrupted")
            return INTERRUPTED
        return _internal_error(error, verbose)


def _dispatch(words: list[str]) -> int:
    if not words or words[0] in ("-h", "--help", "help"):
        show(_overview() + "\n")
        return DONE if words else USAGE
    if words[0] in ("--version", "-V"):
        show(f"lagc {__version__}\n")
        return DONE
    name = words[0]
    if name not in COMMANDS:
        raise Usage(f"there is no command `{name}`{_similar(name)}; `lagc --help` lists them")
    from lagc.cli.options import limits_of

    command = importlib.import_module(f"lagc.cli.{name}")
    parser = Parser(
        prog=f"lagc {name}", description=command.__doc__, allow_abbrev=False,
        formatter_class=Help,
    )  # fmt: skip
    command.add_options(parser)
    options = parser.parse_args(words[1:])
    try:
        with limits_of(options):
            done: int = command.run(options)
    finally:
        if options.verbose:
            _tell_of_the_cache()
    return done


class Help(argparse.RawDescriptionHelpFormatter):
    """As wide as the terminal, without `shutil`, which argparse loads to ask: 4 % of a short run."""

    def __init__(self, prog: str):
        try:
            columns = int(os.environ.get("COLUMNS", 0)) or os.get_terminal_size(1).columns
        except (OSError, ValueError):
            columns = 80
        super().__init__(prog, width=max(columns, 40) - 2)


class Parser(argparse.ArgumentParser):
    """Says what is wrong in one line."""

    def print_help(self, file: object = None) -> None:
        show(self.format_help())

    def _get_values(self, action: argparse.Action, arg_strings: list[str]) -> object:
        if action.option_strings and "--" in arg_strings:  # which would be taken for no argument
            raise argparse.ArgumentError(action, "`--` is no value")
        return super()._get_values(action, arg_strings)

    def error(self, message: str) -> NoReturn:
        raise Usage(f"{message}; `{self.prog} --help` says more")


def _overview() -> str:
    lines = ["usage: lagc COMMAND ...", "", "From a mechanical system to its motion.", ""]
    lines += [f"  {name:10} {summary}" for name, summary in COMMANDS.items()]
    lines += ["", "`lagc COMMAND --help` says more; `lagc --version` prints the version."]
    return "\n".join(lines)


def _tell_of_the_cache() -> None:
    """What was wrong with it; nobody needs to know, all is made again."""
    from lagc.host import cache

    for note in cache.notes:
        say(f"cache: {note}")


def _similar(name: str) -> str:
    from lagc.diagnostics.suggest import closest

    close = closest(name, COMMANDS)
    return f" (did you mean `{close}`?)" if close else ""


def _report(refused: Refused, words: list[str]) -> None:
    if "--json" in words:
        from lagc.diagnostics.report import as_json

        print_json({"status": "refused", "faults": as_json(refused.faults)})
        return
    print_faults(refused.faults, color=None if "--no-color" not in words else False)


def _internal_error(error: BaseException, verbose: bool) -> int:
    place = ""
    if verbose:
        import tempfile
        import traceback

        with suppress(OSError):
            handle, path = tempfile.mkstemp(prefix="lagc-", suffix=".log", text=True)
            with open(handle, "w", encoding="utf-8", errors="backslashreplace") as file:
                traceback.print_exception(error, file=file)
            place = f"; details are in {path}"
    kind = type(error).__name__
    say(f"error[LAG0799]: internal error of lagc ({kind}: {error}), please report it{place}")
    return INTERNAL
