"""The user's cache folder: entries that may vanish, be damaged or refuse to be written at any time.

An entry is a file `KIND-KEY`, which begins with the hash of its name and of what follows: one that was
changed, cut off or renamed is as good as absent, and made again.  Entries hold code, so that only
what this user alone may write is taken, by the open folder and the open file, whose names are
looked up once: whoever may rename them can put nothing in their place that is this user's.
An entry is never changed, only replaced.  Nothing here is ever an error; `notes` says what was
found.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from importlib import import_module
from stat import S_ISREG
from time import time
from typing import Any, TypeVar

T = TypeVar("T")

MAGIC = b"lagc-cache-2 "
HEAD = len(MAGIC) + 64 + 1  # with the hash and the end of the line
LARGEST = 1 << 28  # bytes of an entry; a larger one is not taken
DAY = 86_400.0  # s
BY_DESCRIPTOR = os.open in os.supports_dir_fd
_FOLDER = getattr(os, "O_DIRECTORY", 0)
_BINARY = getattr(os, "O_BINARY", 0) | getattr(os, "O_NOFOLLOW", 0)
_READ = os.O_RDONLY | _BINARY | getattr(os, "O_NONBLOCK", 0)
_WRITE = os.O_WRONLY | os.O_CREAT | os.O_EXCL | _BINARY

notes: list[str] = []  # what was wrong with folder and entries, for whoever wants to know


def _hasher() -> Callable[[bytes], Any]:
    """SHA-256, Python's own: to load OpenSSL, as hashlib does, takes longer than all that is hashed."""
    for name in ("_sha2", "_sha256"):  # since Python 3.12, before
        try:
            return import_module(name).sha256  # type: ignore[no-any-return]
        except ImportError:
            continue
    from hashlib import sha256

    return sha256


sha256 = _hasher()


class Unfit(Exception):
    """A folder or an entry that is not taken; the message says why."""


def folder() -> str | None:
    """`LAGC_CACHE`, else `lagc` in the platform's cache folder; None where there is none (an
    empty `LAGC_CACHE` turns the cache off)."""
    own = os.environ.get("LAGC_CACHE")
    if own is not None:
        return os.path.expanduser(own) or None
    xdg = os.environ.get("XDG_CACHE_HOME")
    if xdg and os.path.isabs(xdg):
        return os.path.join(xdg, "lagc")
    home = os.path.expanduser("~")
    if os.environ.get("HOME") == "" or not os.path.isabs(home):  # a relative one is where one stands
        return None
    if sys.platform == "win32":
        local = os.environ.get("LOCALAPPDATA", "")
        local = local if os.path.isabs(local) else os.path.join(home, "AppData", "Local")
        return os.path.join(local, "lagc", "cache")
    if sys.platform == "darwin":
        return os.path.join(home, "Library", "Caches", "lagc")
    return os.path.join(home, ".cache", "lagc")


def key(*parts: str) -> str:
    """One name for all of `parts`: where any differs, it differs."""
    hashed = sha256(b"")
    for part in parts:
        data = part.encode("utf-8", "surrogatepass")
        hashed.update(len(data).to_bytes(8, "little"))
        hashed.update(data)
    return str(hashed.hexdigest())


def digest(data: bytes) -> str:
    """The SHA-256 of `data`."""
    return str(sha256(data).hexdigest())


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
        note(f"{name} is made again: {reason(error)}")
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
                from lagc.cache.upkeep import shrink

                shrink(place)
    except FileNotFoundError:
        return  # the folder has just been taken away
    except (OSError, Unfit) as error:
        note(f"{name} is not kept: {reason(error)}")


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


def note(text: str) -> None:
    if text not in notes:
        notes.append(text)


def sealed(name: str, body: bytes) -> bytes:
    """The bytes of the file of an entry."""
    hashed = sha256(name.encode() + b"\n")
    hashed.update(body)
    return b"".join((MAGIC, hashed.hexdigest().encode(), b"\n", body))


class Folder:
    """A cache folder, open.  What is done in it is done in the folder that was found to be this
    user's, whatever becomes of its name.  Raises Unfit where others may write to it, OSError."""

    def __init__(self, path: str):
        self.path = path
        self.descriptor: int | None = None
        if BY_DESCRIPTOR:
            self.descriptor = os.open(path, os.O_RDONLY | _FOLDER)
            try:
                _trust(os.fstat(self.descriptor))
            except Unfit:
                os.close(self.descriptor)
                raise

    def __enter__(self) -> Folder:
        return self

    def __exit__(self, *_: object) -> None:
        if self.descriptor is not None:
            os.close(self.descriptor)

    def read(self, name: str) -> bytes:
        """The body of an entry.  Raises FileNotFoundError, Unfit, OSError."""
        found = os.open(self._at(name), _READ, dir_fd=self.descriptor)
        with open(found, "rb", buffering=0) as file:
            status = os.fstat(found)
            if not S_ISREG(status.st_mode):
                raise Unfit("it is no regular file")
            _trust(status)
            if status.st_size > LARGEST:
                raise Unfit("it is too large")
            data = file.read()
            body = data[HEAD:]
            if data != sealed(name, body):
                raise Unfit("it is damaged")
            self._touch(found, status)
        return body

    def write(self, name: str, body: bytes) -> None:
        """Under a name of its own, then renamed: nobody sees half of it.  Raises Unfit, OSError."""
        if len(body) > LARGEST - HEAD:
            raise Unfit("it is too large")
        temporary = f"tmp-{os.getpid()}-{os.urandom(8).hex()}"
        try:
            made = os.open(self._at(temporary), _WRITE, 0o600, dir_fd=self.descriptor)
            with open(made, "wb", buffering=0) as file:
                left = memoryview(sealed(name, body))
                while left:
                    left = left[file.write(left) :]
            os.replace(self._at(temporary), self._at(name),
                       src_dir_fd=self.descriptor, dst_dir_fd=self.descriptor)  # fmt: skip
        except BaseException:
            self.remove(temporary)
            raise

    def remove(self, name: str) -> None:
        """Where it can be."""
        try:
            os.unlink(self._at(name), dir_fd=self.descriptor)
        except OSError:
            return

    def names(self) -> list[str]:
        return os.listdir(self.path if self.descriptor is None else self.descriptor)

    def status(self, name: str) -> os.stat_result:
        """Of the file itself, where it is a link.  Raises OSError."""
        return os.stat(self._at(name), dir_fd=self.descriptor, follow_symlinks=False)

    def _at(self, name: str) -> str:
        return name if self.descriptor is not None else os.path.join(self.path, name)

    def _touch(self, found: int, status: os.stat_result) -> None:
        """Its time says, to a day, when it was used last."""
        if time() - status.st_mtime > DAY and os.utime in os.supports_fd:
            try:
                os.utime(found)
            except OSError:
                return


def _trust(status: os.stat_result) -> None:
    if hasattr(os, "geteuid"):
        if status.st_uid != os.geteuid():
            raise Unfit("it belongs to another user")
        if status.st_mode & 0o022:
            raise Unfit("others may write to it (`chmod go-w` ends that)")


def reason(error: Exception) -> str:
    return error.strerror or str(error) if isinstance(error, OSError) else str(error) or type(error).__name__
