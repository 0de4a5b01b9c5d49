"""`lagc COMMAND ...`: one file for each command, loaded when it is used."""

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
    "check": "report the errors of model files",
    "fmt": "format model files",
    "explain": "explain what was derived from a model",
    "equations": "print the equations of motion",
    "derive": "write the worked solution, from the declarations to the equations",
    "sim": "compile and simulate a model",
    "sweep": "run a model at many points",
    "fit": "find the parameters that fit measured values",
    "cost": "measure what accuracy costs in time",
    "compare": "run scenes side by side",
    "effects": "measure what each effect changes and costs",
    "hard": "run the hard cases, whose truth is known",
    "linearize": "find equilibria and linear models",
    "build": "write generated code for other projects",
    "import": "write the model of a robot, from URDF or MJCF",
    "new": "write a model to start from; --list: models of the library",
    "lsp": "serve an editor: faults, completion, units, fixes",
    "cache": "show, verify or clear the cache of compiled models",
}


# Verbs of other tools -> the command that does it.
VERBS = {
    **dict.fromkeys(("run", "simulate", "solve", "integrate"), "sim"), "plot": "sim FILE --plot",
    **dict.fromkeys(("compile", "generate", "codegen", "export", "make"), "build"),
    **dict.fromkeys(("lint", "validate", "verify", "test"), "check"), "format": "fmt",
    **dict.fromkeys(("init", "create"), "new"),
    **dict.fromkeys(("list", "ls", "library", "models"), "new --list"),
    **dict.fromkeys(("eq", "latex"), "equations"), "describe": "explain", "info": "explain",
    **dict.fromkeys(("linearise", "modes", "eigenvalues", "equilibrium"), "linearize"),
    "clean": "cache --clear",
}  # fmt: skip


def main(arguments: list[str] | None = None) -> int:
    """Run one command and return the exit code (see `lagc.cli.output`)."""
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
    except SystemExit as stop:  # argparse has printed its message
        return code(stop.code if isinstance(stop.code, int) else USAGE)
    except Exception as error:  # no user sees a traceback
        if SIGNALS.number:  # an interrupted import raises other errors
            say("interrupted")
            return INTERRUPTED
        from lagc.host.packages import missing

        if package := missing(error):
            say(f"lagc: {package}")
            return USAGE
        return _internal_error(error, verbose)


def _dispatch(words: list[str]) -> int:
    if words[:1] == ["help"] and len(words) > 1:  # `lagc help sim`
        words = [words[1], "--help"]
    if not words or words[0] in ("-h", "--help", "help"):
        show(_overview() + "\n")
        return DONE if words else USAGE
    if words[0] in ("--version", "-V", "version"):
        show(f"lagc {__version__}\n")
        return DONE
    name = words[0]
    if name not in COMMANDS:
        raise Usage(f"there is no command `{name}`{_similar(name)}; `lagc --help` lists them")
    from lagc.cli.options import add_general_options, limits_of

    command = importlib.import_module(f"lagc.cli.{name}")
    parser = Parser(
        prog=f"lagc {name}", description=command.__doc__, allow_abbrev=False,
        formatter_class=Help,
    )  # fmt: skip
    command.add_options(parser)
    add_general_options(parser, json=getattr(command, "JSON", True))
    intermixed = getattr(command, "INTERMIXED", False)
    options = (parser.parse_intermixed_args if intermixed else parser.parse_args)(words[1:])
    try:
        with limits_of(options):
            done: int = command.run(options)
    finally:
        if options.verbose:
            _tell_of_the_cache()
    return done


class Help(argparse.RawDescriptionHelpFormatter):
    """Help text as wide as the terminal, without `shutil`, whose import takes 4 % of a short run."""

    def __init__(self, prog: str):
        try:
            columns = int(os.environ.get("COLUMNS", 0)) or os.get_terminal_size(1).columns
        except (OSError, ValueError):
            columns = 80
        super().__init__(prog, width=max(columns, 40) - 2)


class Parser(argparse.ArgumentParser):
    """An argument parser that reports an error in one line."""

    def print_help(self, file: object = None) -> None:
        show(self.format_help())

    def _get_values(self, action: argparse.Action, arg_strings: list[str]) -> object:
        if action.option_strings and "--" in arg_strings:  # argparse would take it for no argument
            raise argparse.ArgumentError(action, "`--` is not a value")
        return super()._get_values(action, arg_strings)

    def error(self, message: str) -> NoReturn:
        raise Usage(f"{message}; `{self.prog} --help` lists the options")


def _overview() -> str:
    lines = ["usage: lagc COMMAND ...", "", "From a mechanical system to its motion.", ""]
    lines += [f"  {name:10} {summary}" for name, summary in COMMANDS.items()]
    lines += [
        "",
        "`lagc COMMAND --help` lists the options of a command; `lagc --version` prints the version.",
    ]
    return "\n".join(lines)


def _tell_of_the_cache() -> None:
    """Print problems of the cache; they do not change any result."""
    from lagc.host import cache

    for note in cache.notes:
        say(f"cache: {note}")


def _similar(name: str) -> str:
    from lagc.diagnostics.suggest import closest

    if name.endswith(".lag"):
        return f" (did you mean `lagc sim {name}`?)"
    close = VERBS.get(name.lower()) or closest(name, COMMANDS)
    return f" (did you mean `{close}`?)" if close else ""


def _report(refused: Refused, words: list[str]) -> None:
    if "--json" in words:
        from lagc.diagnostics.faults import as_json

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
