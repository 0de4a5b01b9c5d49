"""Files that are written completely or not at all, and temporary files of processes that were killed.

Data goes into a file beside the target, is flushed to the disk, and then the file is renamed to the target.
A reader of the target finds the old content or all of the new one.  Links are followed.  A target that is not
a regular file (a pipe, a device, the standard output) is written directly; a pipe only if a reader opens it
within `READER` seconds.

Temporary names contain the process: `...PROCESS-XXXXXXXXXXXX...`.
"""

from __future__ import annotations

import errno
import os
import stat
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from io import BufferedWriter
from time import monotonic, sleep, time
from types import TracebackType

LONGEST = 60  # bytes of a file name inside of a temporary name
READER = 5.0  # s to wait for the reader of a pipe
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
        target = os.path.realpath(path) if os.path.islink(path) and not fresh else path
        old = _status(target)
        if old is not None and fresh:
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), path)
        if old is not None and stat.S_ISDIR(old.st_mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), path)
        if old is not None and not os.access(target, os.W_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), path)
        folder, base = os.path.split(target)
        beside = os.path.join(folder, f".{shortened(base)}.{mark()}.lagc-tmp")
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
                    sweep(folder or ".", FILES)
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
    """Whether `path` is written directly: it is not a regular file, or it is our own output."""
    with suppress(OSError, ValueError):
        mode = os.stat(path).st_mode
        return not (stat.S_ISDIR(mode) or stat.S_ISREG(mode)) or output(path) > 0
    return False


def may_wait(path: str) -> bool:
    """Whether writing `path` may wait for another process."""
    try:
        old = _status(path)
    except OSError:
        return False
    return old is not None and not stat.S_ISREG(old.st_mode)


@contextmanager
def scratch() -> Iterator[str]:
    """Yield a folder for temporary files, which is removed at the end.  Raises OSError."""
    import shutil

    place = _temporary_folder()
    sweep(place, FOLDERS)
    folder = os.path.join(place, f"lagc-{mark()}")
    try:
        os.mkdir(folder, 0o700)
        yield folder
    finally:
        try:
            shutil.rmtree(folder, ignore_errors=True)
        except KeyboardInterrupt:
            shutil.rmtree(folder, ignore_errors=True)
            raise


def _temporary_folder() -> str:
    """Return the folder of `tempfile.gettempdir`, which writes a file to find it."""
    for name in ("TMPDIR", "TEMP", "TMP"):
        folder = os.environ.get(name)
        if folder and os.path.isdir(folder) and os.access(folder, os.W_OK):
            return folder
    if os.name == "posix" and os.access("/tmp", os.W_OK):
        return "/tmp"
    import tempfile

    return tempfile.gettempdir()


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
        if self.target and self.fresh:
            _link(self.beside, self.target)
        elif self.target:
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
    return os.fdopen(_unwaiting(path) if hasattr(os, "O_NONBLOCK") else os.open(path, os.O_WRONLY), "wb")


def _unwaiting(path: str) -> int:
    """Open a pipe or a device without waiting forever, and return its descriptor."""
    end = monotonic() + READER
    while True:
        try:
            number = os.open(path, os.O_WRONLY | os.O_NONBLOCK)
        except OSError as error:
            if error.errno != errno.ENXIO or not stat.S_ISFIFO(os.stat(path).st_mode):
                raise
            if monotonic() > end:
                raise OSError(errno.ENXIO, "nobody reads it", path) from None
            sleep(0.02)
        else:
            os.set_blocking(number, True)
            return number


def _status(path: str) -> os.stat_result | None:
    """Return the status of a file, or None if there is none.  Raises OSError."""
    try:
        return os.stat(path)
    except FileNotFoundError:
        return None


def _like(path: str, old: os.stat_result) -> None:
    """Give `path` the mode and, if allowed, the owner and group of `old`. Rights of a group are dropped if
    the group cannot be set."""
    mode = stat.S_IMODE(old.st_mode)
    if hasattr(os, "chown"):
        for field, wanted in (("st_gid", (-1, old.st_gid)), ("st_uid", (old.st_uid, -1))):
            if getattr(os.stat(path), field) != getattr(old, field):
                with suppress(OSError):
                    os.chown(path, *wanted)
        own = os.stat(path)
        if own.st_gid != old.st_gid:
            mode &= ~(stat.S_IRWXG | stat.S_ISGID)
        if own.st_uid != old.st_uid:
            mode &= ~stat.S_ISUID
    os.chmod(path, mode)


def _link(beside: str, target: str) -> None:
    """Rename the file `beside` to `target` if there is no such file.  Raises FileExistsError."""
    try:
        os.link(beside, target)
    except FileExistsError:
        raise
    except OSError:  # a file system without hard links
        if os.path.lexists(target):
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), target) from None
        os.replace(beside, target)


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


ABANDONED = 3600.0  # s after which no process, on any machine that shares the folder, still writes a file
FILES = (".", ".lagc-tmp")  # beginning and end of the names
FOLDERS = ("lagc-", "")


def mark() -> str:
    """Return a name that is unique for this process and file."""
    return f"{os.getpid()}-{os.urandom(6).hex()}"


def sweep(folder: str, kind: tuple[str, str]) -> None:
    """Remove orphans from `folder`: files of this user that are old and whose process has ended."""
    with suppress(OSError), os.scandir(folder) as found:
        for entry in found:
            with suppress(OSError):
                if _is_left(entry, kind):
                    _remove(entry)


def gone(process: int) -> bool:
    """Whether there is no such process; False if that is unknown."""
    if os.name != "posix":  # elsewhere os.kill ends the process
        return False
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return True
    except (OSError, OverflowError):
        return False
    return False


def _is_left(entry: os.DirEntry[str], kind: tuple[str, str]) -> bool:
    begin, end = kind
    if not (entry.name.startswith(begin) and entry.name.endswith(end)):
        return False
    name, _, mark = entry.name[len(begin) : len(entry.name) - len(end)].rpartition(".")
    process, _, number = mark.partition("-")
    if not (process.isascii() and process.isdigit() and len(number) == 12) or (name != "") != (kind == FILES):
        return False
    status = entry.stat(follow_symlinks=False)
    right = stat.S_ISDIR if kind == FOLDERS else stat.S_ISREG
    own = hasattr(os, "geteuid") and status.st_uid == os.geteuid()
    return right(status.st_mode) and own and time() - status.st_mtime > ABANDONED and gone(int(process))


def _remove(entry: os.DirEntry[str]) -> None:
    if entry.is_dir(follow_symlinks=False):
        import shutil

        shutil.rmtree(entry.path, ignore_errors=True)
    else:
        os.unlink(entry.path)
