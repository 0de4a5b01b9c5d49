"""A folder of entries, each bound to its name by a hash.

An entry begins with the hash of its name and content, so a changed, truncated or renamed entry is treated as
absent. Entries contain code, so only files that no other user can write are accepted.  Folder and file are
opened first and checked by descriptor, so that a renamed file cannot take their place.
"""

from __future__ import annotations

import os
from stat import S_ISREG
from time import time

try:  # hashlib loads OpenSSL, 5 % of a short run; Python's own SHA-256 takes 4 times as long
    from _blake2 import blake2b
except ImportError:
    from hashlib import blake2b

MAGIC = b"lagc-cache-3 "
HEAD = len(MAGIC) + 64 + 1  # with the hash and the end of the line
LARGEST = 1 << 28  # bytes, the maximum size of an entry
DAY = 86_400.0  # s
BY_DESCRIPTOR = os.open in os.supports_dir_fd
_FOLDER = getattr(os, "O_DIRECTORY", 0)
_BINARY = getattr(os, "O_BINARY", 0) | getattr(os, "O_NOFOLLOW", 0)
_READ = os.O_RDONLY | _BINARY | getattr(os, "O_NONBLOCK", 0)
_WRITE = os.O_WRONLY | os.O_CREAT | os.O_EXCL | _BINARY

notes: list[str] = []  # problems with folder and entries


class Unfit(Exception):
    """A folder or an entry that is refused; the message says why."""


def hashed(data: bytes) -> blake2b:
    """Return the hash object of `data`, to which more data can be added."""
    return blake2b(data, digest_size=32)


def note(text: str) -> None:
    if text not in notes:
        notes.append(text)


def sealed(name: str, body: bytes) -> bytes:
    """Return the bytes of the file of an entry."""
    found = hashed(name.encode() + b"\n")
    found.update(body)
    return b"".join((MAGIC, found.hexdigest().encode(), b"\n", body))


class Folder:
    """An open cache folder of this user.  Raises Unfit if others can write to it, OSError."""

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
        """Return the body of an entry.  Raises FileNotFoundError, Unfit, OSError."""
        found = os.open(self._at(name), _READ, dir_fd=self.descriptor)
        with open(found, "rb", buffering=0) as file:
            status = os.fstat(found)
            if not S_ISREG(status.st_mode):
                raise Unfit("it is not a regular file")
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
        """Write a temporary file and rename it, so that no reader sees half of it.  Raises Unfit, OSError."""
        if len(body) > LARGEST - HEAD:
            raise Unfit("it is too large")
        temporary = f"tmp-{os.urandom(8).hex()}"
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
        """Remove an entry if possible."""
        try:
            os.unlink(self._at(name), dir_fd=self.descriptor)
        except OSError:
            return

    def names(self) -> list[str]:
        return os.listdir(self.path if self.descriptor is None else self.descriptor)

    def status(self, name: str) -> os.stat_result:
        """Return the status of the file itself, also for a link.  Raises OSError."""
        return os.stat(self._at(name), dir_fd=self.descriptor, follow_symlinks=False)

    def _at(self, name: str) -> str:
        return name if self.descriptor is not None else os.path.join(self.path, name)

    def _touch(self, found: int, status: os.stat_result) -> None:
        """Set the time of last use, to the day."""
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
            raise Unfit("other users can write to it (forbid it with `chmod go-w`)")


def reason(error: Exception) -> str:
    return error.strerror or str(error) if isinstance(error, OSError) else str(error) or type(error).__name__
