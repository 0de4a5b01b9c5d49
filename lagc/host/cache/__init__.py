"""The user's cache folder: entries that may vanish, be damaged or refuse to be written at any time.

An entry is a file `KIND-KEY`: see `Folder`.  It is never changed, only replaced.  Nothing here is ever an
error; `notes` says what was found.
"""

from __future__ import annotations

import marshal
import os
import sys
from collections.abc import Callable, Iterator, Mapping
from functools import lru_cache
from stat import S_ISREG
from time import time
from types import CodeType
from typing import TypeVar

from lagc.host.cache.folders import Folder, Unfit, hashed, note, notes, reason

__all__ = [
    "PYTHON",
    "Folder",
    "code",
    "digest",
    "folder",
    "holds",
    "key",
    "load",
    "notes",
    "opened",
    "reason",
    "store",
]

T = TypeVar("T")
PYTHON = f"{sys.implementation.cache_tag} {sys.hexversion:x}"  # to which code belongs


def folder() -> str | None:
    """`LAGC_CACHE`, else `lagc` in the platform's cache folder; None where there is none (an
    empty `LAGC_CACHE` turns the cache off)."""
    own = os.environ.get("LAGC_CACHE")
    if own is not None:
        return os.path.expanduser(own) or None
    xdg = os.environ.get("XDG_CACHE_HOME")
    if xdg and os.path.isabs(xdg):
        return os.path.join(xdg, "lagc")
    user = os.path.expanduser("~")
    if os.environ.get("HOME") == "" or not os.path.isabs(user):  # a relative one is where one stands
        return None
    if sys.platform == "win32":
        local = os.environ.get("LOCALAPPDATA", "")
        local = local if os.path.isabs(local) else os.path.join(user, "AppData", "Local")
        return os.path.join(local, "lagc", "cache")
    if sys.platform == "darwin":
        return os.path.join(user, "Library", "Caches", "lagc")
    return os.path.join(user, ".cache", "lagc")


def key(*parts: str) -> str:
    """One name for all of `parts`: where any differs, it differs."""
    found = hashed(b"")
    for part in parts:
        data = part.encode("utf-8", "surrogatepass")
        found.update(len(data).to_bytes(8, "little"))
        found.update(data)
    return found.hexdigest()


def digest(data: bytes) -> str:
    """A name for `data`, and for no other."""
    return hashed(data).hexdigest()


def load(kind: str, key: str, read: Callable[[bytes], T]) -> T | None:
    """What `read` makes of the entry; None where there is none that is whole, or where `read` fails."""
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
    """Whether there is such an entry; whether it is whole is found by loading it."""
    place = opened()
    if place is None:
        return False
    with place:
        try:
            return S_ISREG(place.status(f"{kind}-{key}").st_mode)
        except OSError:
            return False


def store(kind: str, key: str, body: bytes) -> None:
    """Keep `body`, whole or not at all; now and then, see to the size of the cache."""
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
        return  # the folder has just been taken away
    except (OSError, Unfit) as error:
        note(f"{name} is not kept: {reason(error)}")


def code(text: Callable[[], str], file: str, *parts: str) -> CodeType:
    """`text()` as code, which is kept under `parts`: they stand for the text."""
    name = key(PYTHON, *parts)
    found: CodeType | None = load("code", name, marshal.loads)
    if found is None:
        found = compile(text(), file, "exec", dont_inherit=True)
        store("code", name, marshal.dumps(found))
    return found


def opened(make: bool = False) -> Folder | None:
    """The folder; made where it is missing and `make` says so.  None where there is none to be used."""
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
ENDINGS = (".py", ".c", ".h", ".lark", ".json")
FRESH = 2.0  # s in which a file may change without a change of its times


def grammar_path() -> str:
    """`grammar/lag.lark`: inside the package where it was installed, beside it in a checkout."""
    inside = os.path.join(PACKAGE, "grammar", "lag.lark")
    return inside if os.path.exists(inside) else os.path.join(os.path.dirname(PACKAGE), "grammar", "lag.lark")


@lru_cache(maxsize=1)
def tool_fingerprint() -> str:
    """The hash of all sources.  It is kept for their sizes and times, so that they are read again only
    where one of them may have changed."""
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
    except OSError:  # one of them went while it was looked at: nothing is known of this tool
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
    """The hash of files and their names, read as fast as they can be."""
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
