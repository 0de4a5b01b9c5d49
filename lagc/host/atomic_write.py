"""Files that are written whole or not at all.

What is written goes into a file of its own beside the target, is flushed to the disk, and takes the
target's name when all of it is there: whoever opens the target finds what it was before, or all of what
it is now, whatever happened in between.  Links are followed to the file that they name.  What is no
regular file (a pipe, a device, the standard output) is written straight; a pipe only where somebody reads
it, or comes to within `READER`.
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

LONGEST = 60  # bytes of a file's name in that of another one, which has to stay a name
READER = 5.0  # s in which the reader of a pipe has to come
_NOT_SYNCED = {errno.EINVAL, errno.ENOTSUP, errno.ENOSYS}  # by file systems that cannot


class Files:
    """Files that take their names one after the other, in the order in which they were opened, when each
    of them is whole; none does where one cannot be written.

        with Files() as files:
            files.open("a.csv").write(data)

    With an exception in the block, or where one cannot be written, every target stays as it was and
    nothing is left beside it.  Where a name is refused to what is written, those that were taken before
    are not given back.  Without `sync` a target is still never half a file while the machine runs.
    """

    def __init__(self, sync: bool = True):
        self.sync = sync
        self._drafts: list[_Draft] = []

    def open(self, path: str, fresh: bool = False) -> BufferedWriter:
        """What is written to it becomes the file `path`.  An old one keeps its mode and owner; `fresh`
        demands that there is none.  Raises OSError, FileExistsError among them."""
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
        self._drafts.append(draft)  # before there is such a file: a signal may come at any time
        flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)
        try:
            draft.file = os.fdopen(os.open(beside, flags, 0o666 if old is None else 0o600), "wb")
        except OSError as error:
            error.filename = path  # the other name says nothing to anybody
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
    """Make `data` the content of the file `path`.  Raises OSError, and then it is as it was."""
    with Files(sync) as files:
        files.open(path, fresh).write(data)


def no_folder(path: str) -> str:
    """What keeps `path` from being a folder: the file of its name, or of one above it; else empty."""
    while path and not os.path.lexists(path):
        path = os.path.dirname(path)
    return "" if not path or os.path.isdir(path) else path


@contextmanager
def folder(path: str) -> Iterator[None]:
    """The folder `path`, and those above it, made where absent; those that were made go again where the block
    fails and they are empty.  Raises OSError."""
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
    """What stands for the name of a file in that of another one: as much of it as any folder takes."""
    return os.fsencode(name)[:LONGEST].decode(sys.getfilesystemencoding(), "ignore")


def fitting(name: str) -> str:
    """`name` where any folder takes it, and an ending; else its beginning with a checksum."""
    data = os.fsencode(name)
    if len(data) <= 2 * LONGEST:
        return name
    from binascii import crc32

    return f"{shortened(name)}_{crc32(data):08x}"


def obstacle(path: str) -> str:
    """Why `path` cannot be written, as far as that shows before; empty where nothing is in the way."""
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
    """Which of our own outputs `path` is: 1 or 2, 0 for none."""
    for own in (1, 2):
        with suppress(OSError, ValueError):
            if os.path.samestat(os.stat(path), os.fstat(own)):
                return own
    return 0


def is_straight(path: str) -> bool:
    """Whether what is written there is written straight: it is no regular file, or our own output."""
    with suppress(OSError, ValueError):
        mode = os.stat(path).st_mode
        return not (stat.S_ISDIR(mode) or stat.S_ISREG(mode)) or output(path) > 0
    return False


def may_wait(path: str) -> bool:
    """Whether writing `path` may last as long as another process likes."""
    try:
        old = _status(path)
    except OSError:
        return False
    return old is not None and not stat.S_ISREG(old.st_mode)


@contextmanager
def scratch() -> Iterator[str]:
    """A folder for temporary files, which goes with all that is in it.  Raises OSError."""
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
    """As `tempfile.gettempdir` has it, which writes a file to find out."""
    for name in ("TMPDIR", "TEMP", "TMP"):
        folder = os.environ.get(name)
        if folder and os.path.isdir(folder) and os.access(folder, os.W_OK):
            return folder
    if os.name == "posix" and os.access("/tmp", os.W_OK):
        return "/tmp"
    import tempfile

    return tempfile.gettempdir()


class _Draft:
    """A file that is being written: `beside` its `target`, or straight where it has none."""

    def __init__(self, file: BufferedWriter | None, beside: str = "", target: str = "", fresh: bool = False):
        self.file, self.beside, self.target, self.fresh = file, beside, target, fresh

    def finish(self, sync: bool) -> None:
        """All of it is on the disk."""
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
        """Nothing is left of it but what took its place."""
        if self.file is not None:
            with suppress(OSError):
                self.file.raw.close()  # what it still holds is not wanted, and might wait for a reader
        if self.beside:
            with suppress(OSError):
                os.unlink(self.beside)


def _straight(path: str) -> BufferedWriter | None:
    """`path` opened, where it is no regular file, or one that is our own output already."""
    old = _status(path)
    if old is None or stat.S_ISDIR(old.st_mode):
        return None
    if own := output(path):
        return os.fdopen(os.dup(own), "wb")
    if stat.S_ISREG(old.st_mode):
        return None
    return os.fdopen(_unwaiting(path) if hasattr(os, "O_NONBLOCK") else os.open(path, os.O_WRONLY), "wb")


def _unwaiting(path: str) -> int:
    """`path`, a pipe or a device, opened without waiting for ever; its descriptor."""
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
    """None where there is no such file.  Raises OSError where that cannot be told."""
    try:
        return os.stat(path)
    except FileNotFoundError:
        return None


def _like(path: str, old: os.stat_result) -> None:
    """Give `path` the mode of `old` and, as far as that is allowed, its owner and group.  What is granted
    to a group that it does not get is granted to no other."""
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
    """Give the file `beside` the name `target`, where nothing has it.  Raises FileExistsError."""
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
    """So that the name lasts; where a system has no such thing, it is as good as it gets."""
    with suppress(OSError):
        number = os.open(folder or ".", os.O_RDONLY)
        try:
            os.fsync(number)
        finally:
            os.close(number)


SOON = 3600.0  # s in which whatever is being written is done, on any machine that shares the folder
FILES = (".", ".lagc-tmp")  # what their names begin and end with
FOLDERS = ("lagc-", "")


def mark() -> str:
    """What tells this process, and this file of it, from all others."""
    return f"{os.getpid()}-{os.urandom(6).hex()}"


def sweep(folder: str, kind: tuple[str, str]) -> None:
    """Remove what was left in `folder` where nobody uses it: it is this user's, nothing has changed in it
    for long, and the process that made it is gone."""
    with suppress(OSError), os.scandir(folder) as found:
        for entry in found:
            with suppress(OSError):
                if _is_left(entry, kind):
                    _remove(entry)


def gone(process: int) -> bool:
    """Whether there is no such process; False where that cannot be told."""
    if os.name != "posix":  # elsewhere, to ask is to end it
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
    return right(status.st_mode) and own and time() - status.st_mtime > SOON and gone(int(process))


def _remove(entry: os.DirEntry[str]) -> None:
    if entry.is_dir(follow_symlinks=False):
        import shutil

        shutil.rmtree(entry.path, ignore_errors=True)
    else:
        os.unlink(entry.path)
