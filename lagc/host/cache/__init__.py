"""The user's cache folder.  Entries may vanish, be damaged or be refused at any time.

An entry is a file `KIND-KEY` (see `Folder`) that is never changed, only replaced.  No function raises an
error; `notes` collects the problems.

`tool_fingerprint` identifies the sources of lagc, which change under the same version in a checkout.
"""

import marshal
import os
import sys
from _thread import _local as Local
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import lru_cache
from stat import S_ISREG
from time import time
from types import CodeType
from typing import TypeVar

from lagc.host.cache.folders import Folder, Unfit, hashed, note, notes, reason

__all__ = [
    "PYTHON", "Folder", "code", "digest", "folder", "holds", "key", "load", "notes", "opened", "reason",
    "store", "unused",
]  # fmt: skip

T = TypeVar("T")
PYTHON = f"{sys.implementation.cache_tag} {sys.hexversion:x}"  # the interpreter that code belongs to


class _Off(Local):
    """Blocks of this thread that turn the cache off."""

    depth = 0


_off = _Off()


@contextmanager
def unused() -> Iterator[None]:
    """Turn the cache off inside the block."""
    _off.depth += 1
    try:
        yield
    finally:
        _off.depth -= 1


def folder() -> str | None:
    """Return `LAGC_CACHE`, or else `lagc` in the platform's cache folder, or None. An empty `LAGC_CACHE`
    turns the cache off."""
    if _off.depth:
        return None
    own = os.environ.get("LAGC_CACHE")
    if own is not None:
        return os.path.expanduser(own) or None
    xdg = os.environ.get("XDG_CACHE_HOME")
    if xdg and os.path.isabs(xdg):
        return os.path.join(xdg, "lagc")
    user = os.path.expanduser("~")
    if os.environ.get("HOME") == "" or not os.path.isabs(user):  # not a relative path
        return None
    if sys.platform == "win32":
        local = os.environ.get("LOCALAPPDATA", "")
        local = local if os.path.isabs(local) else os.path.join(user, "AppData", "Local")
        return os.path.join(local, "lagc", "cache")
    if sys.platform == "darwin":
        return os.path.join(user, "Library", "Caches", "lagc")
    return os.path.join(user, ".cache", "lagc")


def key(*parts: str) -> str:
    """Return a hash of all `parts`."""
    found = hashed(b"")
    for part in parts:
        data = part.encode("utf-8", "surrogatepass")
        found.update(len(data).to_bytes(8, "little"))
        found.update(data)
    return found.hexdigest()


def digest(data: bytes) -> str:
    return hashed(data).hexdigest()


def load(kind: str, key: str, read: Callable[[bytes], T]) -> T | None:
    """Return `read` of the entry, or None if there is no valid entry or `read` fails."""
    name, place = f"{kind}-{key}", opened()
    if place is None:
        return None
    try:
        with place:
            body = place.read(name)
        return read(body)
    except FileNotFoundError:
        return None
    except Exception as error:
        note(f"{name} is created again: {reason(error)}")
        return None


def holds(kind: str, key: str) -> bool:
    """Return whether the entry exists; `load` checks whether it is valid."""
    place = opened()
    if place is None:
        return False
    with place:
        try:
            return S_ISREG(place.status(f"{kind}-{key}").st_mode)
        except OSError:
            return False


def store(kind: str, key: str, body: bytes) -> None:
    """Store `body` completely or not at all; sometimes check the size of the cache."""
    name, place = f"{kind}-{key}", opened(make=True)
    if place is None:
        return
    try:
        with place:
            place.write(name, body)
            if key.startswith("00"):  # one in 256
                from lagc.host.cache.upkeep import shrink

                shrink(place)
    except FileNotFoundError:
        return  # the folder was just removed
    except (OSError, Unfit) as error:
        note(f"{name} is not kept: {reason(error)}")


def code(text: Callable[[], str], file: str, *parts: str) -> CodeType:
    """Return the compiled code of `text()`, cached under `parts`."""
    name = key(PYTHON, *parts)
    found: CodeType | None = load("code", name, marshal.loads)
    if found is None:
        found = compile(text(), file, "exec", dont_inherit=True)
        store("code", name, marshal.dumps(found))
    return found


def opened(make: bool = False) -> Folder | None:
    """Open the folder, and create it if `make`.  Return None if it cannot be used."""
    path = folder()
    if path is None:
        return None
    try:
        if make:
            os.makedirs(path, mode=0o700, exist_ok=True)
        return Folder(path)
    except FileNotFoundError:
        return None
    except (OSError, Unfit) as error:
        note(f"the cache folder {path} is not used: {reason(error)}")
        return None


PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
ENDINGS = (".py", ".c", ".h", ".lark", ".json", ".txt")
FRESH = 2.0  # s within which a file may change without a change of its times


def grammar_path() -> str:
    """Return the path of `grammar/lag.lark`: in the package if installed, beside it in a checkout."""
    inside = os.path.join(PACKAGE, "grammar", "lag.lark")
    return inside if os.path.exists(inside) else os.path.join(os.path.dirname(PACKAGE), "grammar", "lag.lark")


@lru_cache(maxsize=1)
def tool_fingerprint() -> str:
    """Return the hash of all sources. It is cached by their sizes and times, so that they are only read again
    after a change."""
    try:
        found = dict(sorted(_files()))
        stamps = [f"{path}:{s.st_size}:{s.st_mtime_ns}:{s.st_ctime_ns}" for path, s in found.items()]
        stamp = key("\n".join(stamps))
        if folder() is None:
            return stamp
        kept = load("sources", stamp, bytes.decode)
        if kept is None:
            kept = _contents(found)
            if all(abs(time() - max(s.st_mtime, s.st_ctime)) > FRESH for s in found.values()):
                store("sources", stamp, kept.encode())
        return kept
    except OSError:  # a file vanished: use a key that matches nothing
        return os.urandom(32).hex()


def _files() -> Iterator[tuple[str, os.stat_result]]:
    folders = [PACKAGE]
    for folder in folders:  # which grows
        with os.scandir(folder) as entries:
            for entry in entries:
                if entry.name.endswith(ENDINGS):
                    yield entry.path, entry.stat()
                elif not entry.name.startswith(("__", ".")) and entry.is_dir():
                    folders.append(entry.path)
    grammar = grammar_path()
    if os.path.exists(grammar):
        yield grammar, os.stat(grammar)


def _contents(found: Mapping[str, os.stat_result]) -> str:
    """Return the hash of files and their names."""
    whole = hashed(b"")
    for path, status in found.items():
        file = os.open(path, os.O_RDONLY | getattr(os, "O_BINARY", 0))
        try:
            data = os.read(file, status.st_size + 1)
        finally:
            os.close(file)
        if len(data) != status.st_size:
            raise OSError
        name = path.removeprefix(PACKAGE) if path.startswith(PACKAGE) else os.path.basename(path)
        whole.update(f"{name}\n{len(data)}\n".encode("utf-8", "surrogatepass"))
        whole.update(data)
    return whole.hexdigest()
