"""`python -m tests.security.watched COMMAND ...`: lagc under an audit hook.

What Python was about to do, its imports apart, goes to the file that WATCHED names: a JSON list of
pairs of an event and its arguments.
"""

import json
import os
import sys
from pathlib import Path
from typing import Any

QUIET = (
    *("import", "object.", "sys._getframe", "sys._current", "sys.unraisablehook", "sys.excepthook"),
    *("ctypes.dlsym", "ctypes.addressof", "ctypes.cdata", "marshal.loads"),
    *("code.__new__", "array.__new__", "gc.", "cpython.", "builtins.id"),
)


def plain(argument: Any) -> Any:
    """What JSON can hold of an argument."""
    if isinstance(argument, str | int | None):
        return argument
    if isinstance(argument, bytes):
        return os.fsdecode(argument)
    if isinstance(argument, list | tuple):
        return [plain(item) for item in argument]
    return getattr(argument, "co_filename", type(argument).__name__)


def main() -> int:
    seen: list[Any] = []
    watching = True

    def note(event: str, arguments: tuple[Any, ...]) -> None:
        if watching and not event.startswith(QUIET):
            seen.append([event, [plain(argument) for argument in arguments]])

    sys.addaudithook(note)
    from lagc.cli.main import main as lagc

    try:
        return lagc(sys.argv[1:])
    finally:
        watching = False
        Path(os.environ["WATCHED"]).write_text(json.dumps(seen))


if __name__ == "__main__":
    sys.exit(main())
