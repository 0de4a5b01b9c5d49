"""`lagc COMMAND ...`: one file a command, loaded when it is asked for."""

from __future__ import annotations

import argparse
import importlib
import os
import sys
from typing import NoReturn

from lagc.cli.exits import INTERNAL, INTERRUPTED, USAGE, Usage, code_of
from lagc.diagnostics.faults import Refused
from lagc.version import __version__

COMMANDS = {
    "check": "the faults of model files, all of them",
    "fmt": "the one way to lay a model out",
    "explain": "what was inferred from a model",
    "equations": "the equations of motion, as a person would write them",
    "sim": "compile and simulate",
    "build": "generated code for other projects",
    "new": "a model to start from",
}


def main(arguments: list[str] | None = None) -> int:
    """Run one command; the exit code (0 done, 1 refused, 2 usage, 3 failed, 130 interrupted)."""
    words = sys.argv[1:] if arguments is None else list(arguments)
    verbose = "-v" in words or "--verbose" in words
    try:
        return _dispatch(words)
    except Usage as error:
        print(f"lagc: {error}", file=sys.stderr)
        return USAGE
    except Refused as refused:
        _report(refused, words)
        return code_of(refused.faults)
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:
        # The reader of our output went away, as `lagc ... | head` does: nothing is left to say.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except SystemExit as stop:  # argparse has said what it had to say
        return stop.code if isinstance(stop.code, int) else USAGE
    except Exception as error:  # the last resort: nobody gets a traceback
        return _internal_error(error, verbose)


def _dispatch(words: list[str]) -> int:
    if not words or words[0] in ("-h", "--help", "help"):
        print(_overview())
        return 0 if words else USAGE
    if words[0] in ("--version", "-V"):
        print(f"lagc {__version__}")
        return 0
    name = words[0]
    if name not in COMMANDS:
        raise Usage(f"there is no command `{name}`{_similar(name)}; `lagc --help` lists them")
    command = importlib.import_module(f"lagc.cli.{name}")
    parser = Parser(
        prog=f"lagc {name}", description=command.__doc__, allow_abbrev=False,
        formatter_class=Help,
    )  # fmt: skip
    command.add_options(parser)
    code: int = command.run(parser.parse_args(words[1:]))
    sys.stdout.flush()
    return code


class Help(argparse.RawDescriptionHelpFormatter):
    """As wide as the terminal, without the module that argparse loads to find that out."""

    def __init__(self, prog: str):
        try:
            columns = int(os.environ.get("COLUMNS", 0)) or os.get_terminal_size(1).columns
        except (OSError, ValueError):
            columns = 80
        super().__init__(prog, width=max(columns, 40) - 2)


class Parser(argparse.ArgumentParser):
    """Says what is wrong in one line."""

    def error(self, message: str) -> NoReturn:
        raise Usage(f"{message}; `{self.prog} --help` says more")


def _overview() -> str:
    lines = ["usage: lagc COMMAND ...", "", "From a mechanical system to its motion.", ""]
    lines += [f"  {name:10} {summary}" for name, summary in COMMANDS.items()]
    lines += ["", "`lagc COMMAND --help` says more; `lagc --version` prints the version."]
    return "\n".join(lines)


def _similar(name: str) -> str:
    from lagc.diagnostics.suggest import closest

    close = closest(name, COMMANDS)
    return f" (did you mean `{close}`?)" if close else ""


def _report(refused: Refused, words: list[str]) -> None:
    from lagc.cli.output import print_faults, print_json

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

        handle, path = tempfile.mkstemp(prefix="lagc-", suffix=".log", text=True)
        with open(handle, "w", encoding="utf-8") as file:
            traceback.print_exception(error, file=file)
        place = f"; details are in {path}"
    kind = type(error).__name__
    print(
        f"error[LAG0799]: internal error of lagc ({kind}: {error}), please report it{place}", file=sys.stderr
    )
    return INTERNAL


if __name__ == "__main__":
    sys.exit(main())
