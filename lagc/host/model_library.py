"""Model files: from a name to a text."""

import os
import sys
from collections.abc import Iterable, Sequence
from contextlib import suppress
from stat import S_ISDIR, S_ISFIFO, S_ISREG

from lagc.diagnostics.faults import Fault, Refused, Source
from lagc.host import cache

SUFFIX = ".lag"
LARGEST = 4_000_000  # bytes of one model file
LARGEST_DATA = 40_000_000  # bytes of one data file
_READ = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0) | getattr(os, "O_BINARY", 0)
_FOLDER = getattr(os, "O_PATH", os.O_RDONLY) | getattr(os, "O_DIRECTORY", 0)


def models_folder() -> str:
    """Return the folder of the library models: beside the package in a checkout, inside it if installed."""
    return _data_folder("models", "models")


def references_folder() -> str:
    """Return the folder of published values: in the tests of a checkout, inside the package if installed."""
    return _data_folder("references", os.path.join("tests", "references"))


def messages_folder() -> str:
    """Return the folder of the catalogue: in the documents of a checkout, inside the package if installed."""
    return _data_folder("messages", os.path.join("docs", "reference", "messages"))


def _data_folder(installed: str, checkout: str) -> str:
    package = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    inside = os.path.join(package, installed)
    return inside if os.path.isdir(inside) else os.path.join(os.path.dirname(package), checkout)


def library_models() -> list[str]:
    """Return the names of the library models, `course/simple_pendulum` and so on, sorted."""
    root = models_folder()
    found = []
    for folder, _, files in os.walk(root):
        for file in files:
            if file.endswith(SUFFIX):
                path = os.path.relpath(os.path.join(folder, file), root)
                found.append(path.removesuffix(SUFFIX).replace(os.sep, "/"))
    return sorted(found)


def locate(name: str) -> str:
    """Return the path of a model: a path, or a library model (`simple_pendulum`, `course/simple_pendulum`),
    which a folder of that name does not hide.  Raises Refused if there is none."""
    if os.path.exists(name) and not os.path.isdir(name):
        return name
    wanted = name.removesuffix(SUFFIX)
    root = models_folder()
    direct = os.path.join(root, *wanted.split("/")) + SUFFIX
    if ".." not in wanted.split("/") and os.path.isfile(direct):
        return direct
    models = library_models()
    matches = [m for m in models if m.rpartition("/")[2] == wanted]
    if len(matches) == 1:
        return os.path.join(root, *matches[0].split("/")) + SUFFIX
    if os.path.isdir(name):
        return name  # reading it names the reason
    raise Refused([_not_found(name, wanted, matches, models)])


def _not_found(name: str, wanted: str, matches: list[str], models: list[str]) -> Fault:
    if matches:
        message = f"several models are called `{name}`"
        return Fault("LAG0701", message, remedy="write " + " or ".join(matches))
    message = f"there is no file `{name}`, and no model of that name in the library"
    if os.path.isfile(name + SUFFIX):
        return Fault("LAG0701", message, remedy=f"did you mean the file `{name}{SUFFIX}`?")
    from lagc.diagnostics.suggest import closest

    folder, file = os.path.split(name)
    if folder or file.endswith(SUFFIX):  # the name looks like a path
        with suppress(OSError, ValueError):
            close = closest(file, sorted(f for f in os.listdir(folder or ".") if f.endswith(SUFFIX)))
            if close:
                found = os.path.join(folder, close)
                return Fault("LAG0701", message, remedy=f"did you mean the file `{found}`?")
    if file.endswith(SUFFIX):
        return Fault("LAG0701", message)
    short = [m.rpartition("/")[2] for m in models]
    close = closest(wanted, short + models)
    return Fault("LAG0701", message, remedy=f"did you mean the library model `{close}`?" if close else None)


def folder_of(name: str) -> str:
    """Return the folder of a file with links resolved; the current folder for a plain name, or "" if it is
    removed."""
    try:
        return os.path.realpath(os.path.dirname(name))
    except OSError:
        return ""


def read(name: str) -> Source:
    """Return the text of a file or library model; `-` is standard input.  Raises Refused if it is not UTF-8
    text."""
    try:
        if name == "-":
            return Source("<stdin>", decoded(standard_input()))
        path = locate(name)
        return Source(path, decoded(content(path, pipes=True)))
    except Unreadable as error:
        shown = "standard input" if name == "-" else f"`{name}`"
        raise Refused([Fault(error.code, f"{shown} {error}", remedy=error.remedy)]) from None


class Unreadable(Exception):
    """A file that cannot be read; the message follows its name."""

    def __init__(self, code: str, message: str, remedy: str | None = None):
        super().__init__(message)
        self.code, self.remedy = code, remedy


class Outside(Unreadable):
    """A file that is in none of the folders that may be read."""


def content(
    path: str, pipes: bool = False, largest: int = LARGEST, roots: Sequence[str] | None = None
) -> bytes:
    """Return all bytes of a regular file, at most `largest`; with `pipes`, also of a pipe such as `<(...)`;
    with `roots`, only of a file that is in one of these folders behind all links. Raises Unreadable,
    Outside."""
    try:
        # Does not wait for a pipe.
        found = os.open(path, _READ) if roots is None else _open_within(path, roots)
        with open(found, "rb") as file:
            mode = os.fstat(found).st_mode
            if not S_ISREG(mode):
                if not (pipes and S_ISFIFO(mode)):
                    kind = "a folder" if S_ISDIR(mode) else "not a regular file"
                    raise Unreadable("LAG0702", f"cannot be read: it is {kind}")
                os.set_blocking(found, True)
            data = file.read(largest + 1) or b""  # None if a system file would block
    except (OSError, ValueError) as error:
        raise Unreadable("LAG0702", f"cannot be read: {cache.reason(error)}") from None
    if S_ISFIFO(mode) and not data:
        raise Unreadable("LAG0702", "cannot be read: it is a pipe that nothing is written to")
    return _bounded(data, largest)


def is_within(real: str, roots: Iterable[str]) -> bool:
    """Return whether a path without links is below one of the folders."""
    return any(real.startswith(root.rstrip(os.sep) + os.sep) for root in roots)


def _open_within(path: str, roots: Sequence[str]) -> int:
    """Open a file that is in one of the folders. Raises Outside, OSError.

    The file that is checked is the one that is opened: no folder on the way is opened through a link, so that
    a link that another process puts there meanwhile is an error."""
    real = os.path.realpath(path)
    if not is_within(real, roots):
        raise Outside("LAG0217", "is outside the folders that may be imported from")
    if os.open not in os.supports_dir_fd:  # Windows, where links need a privilege
        return os.open(real, _READ)
    *folders, file = real.split(os.sep)[1:]
    here = os.open(os.sep, _FOLDER)
    try:
        for folder in folders:
            inner = os.open(folder, _FOLDER | os.O_NOFOLLOW, dir_fd=here)
            os.close(here)
            here = inner
        return os.open(file, _READ | os.O_NOFOLLOW, dir_fd=here)
    finally:
        os.close(here)


def decoded(data: bytes) -> str:
    """Return the text of a model file.  Raises Unreadable."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        message = f"is not UTF-8 text: byte {error.start}, in line {line}, is 0x{data[error.start]:02x}"
        raise Unreadable("LAG0703", message, "save the file as UTF-8") from None


def fingerprint(path: str, data: bytes) -> str:
    """Return a key of the file behind all links and of its content."""
    return cache.key(os.path.realpath(path), cache.digest(data))


def standard_input() -> bytes:
    if sys.stdin is None:
        raise Unreadable("LAG0702", "cannot be read: it is closed")
    try:
        with suppress(AttributeError, OSError):  # no descriptor, or one without this option
            os.set_blocking(sys.stdin.fileno(), True)
        return _bounded(sys.stdin.buffer.read(LARGEST + 1) or b"")
    except (OSError, ValueError) as error:
        raise Unreadable("LAG0702", f"cannot be read: {cache.reason(error)}") from None


def _bounded(data: bytes, largest: int = LARGEST) -> bytes:
    if len(data) > largest:
        size, kind = largest // 1_000_000, "model file" if largest == LARGEST else "data file"
        raise Unreadable("LAG0704", f"is larger than {size} MB, the maximum for a {kind}")
    return data
