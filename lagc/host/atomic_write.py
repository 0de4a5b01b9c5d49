"""Files that are written completely or not at all.

Data goes into a file beside the target, is flushed to the disk, and then the file is renamed to the target.
A reader of the target finds the old content or all of the new one.  Links are followed.  A target that is not
a regular file (a pipe, a device, the standard output) is written directly.
"""

from __future__ import annotations

import errno
import os
import stat
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from io import BufferedWriter
from types import TracebackType

LONGEST = 60  # bytes of a file name inside of a temporary name
_NOT_SYNCED = {errno.EINVAL, errno.ENOTSUP, errno.ENOSYS}  # file systems without fsync


class Files:
    """A group of files that are renamed to their targets in the order of opening, after all of them are
    complete.

        with Files() as files:
            files.open("a.csv").write(data)

    After an exception, or if one file cannot be written, every target is unchanged and no temporary file is
    left.  If a rename fails, earlier renames are not undone.  Without `sync` the data are not flushed to the
    disk.
    """

    def __init__(self, sync: bool = True):
        self.sync = sync
        self._drafts: list[_Draft] = []

    def open(self, path: str, fresh: bool = False) -> BufferedWriter:
        """Open a file that becomes `path`.  An existing file keeps its mode and owner; with `fresh` there
        must be none. Raises OSError, such as FileExistsError."""
        straight = None if fresh else _straight(path)
        if straight is not None:
            self._drafts.append(_Draft(straight))
            return straight
        # A link stays a link: its target is replaced. All that can be refused is refused before anything is
        # written.
        target = os.path.realpath(path) if os.path.islink(path) and not fresh else path
        old = _status(target)
        if old is not None and fresh:
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), path)
        if old is not None and stat.S_ISDIR(old.st_mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), path)
        if old is not None and not os.access(target, os.W_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), path)
        folder, base = os.path.split(target)
        beside = os.path.join(folder, f".{shortened(base)}.{os.urandom(6).hex()}.lagc-tmp")
        draft = _Draft(None, beside, target, fresh)
        self._drafts.append(draft)  # before the file exists, because a signal may come at any time
        flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)
        try:
            draft.file = os.fdopen(os.open(beside, flags, 0o666 if old is None else 0o600), "wb")
        except OSError as error:
            error.filename = path  # the temporary name means nothing to the user
            raise
        if old is not None:
            _like(beside, old)
        return draft.file

    def __enter__(self) -> Files:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            if kind is None:
                for draft in self._drafts:
                    draft.finish(self.sync)
                for draft in self._drafts:
                    draft.take_place()
                for folder in {os.path.dirname(d.target) for d in self._drafts if d.target}:
                    if self.sync:
                        _sync_folder(folder)
        finally:
            for draft in self._drafts:
                draft.discard()


def write(path: str, data: bytes, sync: bool = True, fresh: bool = False) -> None:
    """Write `data` to the file `path`.  Raises OSError; then the file is unchanged."""
    with Files(sync) as files:
        files.open(path, fresh).write(data)


def no_folder(path: str) -> str:
    """Return the file that prevents `path` from being a folder, or ""."""
    while path and not os.path.lexists(path):
        path = os.path.dirname(path)
    return "" if not path or os.path.isdir(path) else path


@contextmanager
def folder(path: str) -> Iterator[None]:
    """Create the folder `path` and its parents; new empty ones are removed if the block fails.  Raises
    OSError."""
    missing = [path]
    while missing[-1] and not os.path.isdir(missing[-1]):
        missing.append(os.path.dirname(missing[-1]))
    try:
        os.makedirs(path, exist_ok=True)
        yield
    except BaseException:
        for made in missing[:-1]:
            with suppress(OSError, ValueError):
                os.rmdir(made)
        raise


def shortened(name: str) -> str:
    """Return a prefix of a file name that is short enough for a temporary name."""
    return os.fsencode(name)[:LONGEST].decode(sys.getfilesystemencoding(), "ignore")


def fitting(name: str) -> str:
    """Return `name` if a folder accepts it with an ending, else its beginning with a checksum."""
    data = os.fsencode(name)
    if len(data) <= 2 * LONGEST:
        return name
    from binascii import crc32

    return f"{shortened(name)}_{crc32(data):08x}"


def obstacle(path: str) -> str:
    """Return the reason why `path` cannot be written, as far as it is visible in advance, or ""."""
    folder = os.path.dirname(os.path.realpath(path) if os.path.islink(path) else path) or "."
    if not os.path.isdir(folder):
        return f"there is no folder `{folder}`"
    try:
        old = _status(path)
    except OSError as error:  # a name that is too long, links in a circle
        return os.strerror(error.errno or 0)
    except ValueError:  # with a NUL, or a surrogate
        return "no file can have that name"
    if old is not None and stat.S_ISDIR(old.st_mode):
        return "it is a folder"
    needed = [path] if old is not None else []
    if old is None or stat.S_ISREG(old.st_mode):
        needed.append(folder)
    return "" if all(os.access(each, os.W_OK) for each in needed) else "permission denied"


def output(path: str) -> int:
    """Return 1 or 2 if `path` is our standard output or error, else 0."""
    for own in (1, 2):
        with suppress(OSError, ValueError):
            if os.path.samestat(os.stat(path), os.fstat(own)):
                return own
    return 0


def is_straight(path: str) -> bool:
    """Return whether `path` is written directly: it is not a regular file, or it is our own output."""
    with suppress(OSError, ValueError):
        mode = os.stat(path).st_mode
        return not (stat.S_ISDIR(mode) or stat.S_ISREG(mode)) or output(path) > 0
    return False


def may_wait(path: str) -> bool:
    """Return whether writing `path` may wait for another process."""
    try:
        old = _status(path)
    except OSError:
        return False
    return old is not None and not stat.S_ISREG(old.st_mode)


@contextmanager
def scratch() -> Iterator[str]:
    """Yield a folder for temporary files, which is removed at the end.  Raises OSError."""
    from tempfile import TemporaryDirectory  # only where there is something to compile or to plot

    with TemporaryDirectory(prefix="lagc-", ignore_cleanup_errors=True) as folder:
        yield folder


class _Draft:
    """A file in progress: `beside` its `target`, or written directly if there is no target."""

    def __init__(self, file: BufferedWriter | None, beside: str = "", target: str = "", fresh: bool = False):
        self.file, self.beside, self.target, self.fresh = file, beside, target, fresh

    def finish(self, sync: bool) -> None:
        """Flush the file to the disk."""
        assert self.file is not None
        self.file.flush()
        if self.target and sync:
            _sync(self.file.fileno())
        self.file.close()

    def take_place(self) -> None:
        if self.fresh and os.path.lexists(self.target):
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), self.target)
        if self.target:
            os.replace(self.beside, self.target)
            self.beside = ""

    def discard(self) -> None:
        """Remove the temporary file, unless it is renamed."""
        if self.file is not None:
            with suppress(OSError):
                self.file.raw.close()  # the buffer is dropped; flushing it might wait for a reader
        if self.beside:
            with suppress(OSError):
                os.unlink(self.beside)


def _straight(path: str) -> BufferedWriter | None:
    """Open `path` if it is not a regular file, or if it is our own output, else return None."""
    old = _status(path)
    if old is None or stat.S_ISDIR(old.st_mode):
        return None
    if own := output(path):
        return os.fdopen(os.dup(own), "wb")
    if stat.S_ISREG(old.st_mode):
        return None
    return os.fdopen(os.open(path, os.O_WRONLY), "wb")


def _status(path: str) -> os.stat_result | None:
    """Return the status of a file, or None if there is none.  Raises OSError."""
    try:
        return os.stat(path)
    except FileNotFoundError:
        return None


def _like(path: str, old: os.stat_result) -> None:
    """Give `path` the mode and, if allowed, the owner and group of `old`. Rights of a group, and of programs
    that run as their owner, are dropped if these cannot be set."""
    mode = stat.S_IMODE(old.st_mode)
    if hasattr(os, "chown"):
        for owner, group in ((-1, old.st_gid), (old.st_uid, -1)):
            with suppress(OSError):
                os.chown(path, owner, group)
        own = os.stat(path)
        mode &= ~0 if own.st_gid == old.st_gid else ~(stat.S_IRWXG | stat.S_ISGID)
        mode &= ~0 if own.st_uid == old.st_uid else ~stat.S_ISUID
    os.chmod(path, mode)


def _sync(number: int) -> None:
    try:
        os.fsync(number)
    except OSError as error:
        if error.errno not in _NOT_SYNCED:
            raise


def _sync_folder(folder: str) -> None:
    """Flush the directory entry to the disk, if the system supports it."""
    with suppress(OSError):
        number = os.open(folder or ".", os.O_RDONLY)
        try:
            os.fsync(number)
        finally:
            os.close(number)
