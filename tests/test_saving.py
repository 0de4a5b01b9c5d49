"""Files are written whole or not at all: every operation on files fails once, or is the last one."""

import errno
import os
import random
import signal
import stat
import sys
import threading
from collections.abc import Callable
from itertools import product
from pathlib import Path
from typing import IO, Any

import pytest

from lagc.host import atomic_write

OPERATIONS = ("open", "stat", "fsync", "replace", "link", "chmod")
OLD, NEW = b"old " * 1000, b"new " * 50_000


class Faulty:
    """Each call of an operation on files, and each write, is counted; `at` does `end` instead."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, at: int, end: Callable[[], object]):
        self.calls, self.at, self.end = 0, at, end
        for name in OPERATIONS:
            monkeypatch.setattr(os, name, self._counted(getattr(os, name)))

        fdopen = os.fdopen
        monkeypatch.setattr(os, "fdopen", lambda number, mode: _Counted(fdopen(number, mode), self))

    def _counted(self, function: Callable[..., Any]) -> Callable[..., Any]:
        def call(*arguments: Any, **named: Any) -> Any:
            self.count()
            return function(*arguments, **named)

        return call

    def count(self) -> None:
        self.calls += 1
        if self.calls == self.at:
            self.end()


class _Counted:
    def __init__(self, file: IO[bytes], faulty: Faulty):
        self.file, self.faulty = file, faulty

    def write(self, data: bytes) -> int:
        self.faulty.count()
        return self.file.write(data)

    def flush(self) -> None:
        self.faulty.count()
        self.file.flush()

    def __getattr__(self, name: str) -> Any:
        return getattr(self.file, name)


def disk_full() -> None:
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def interrupt() -> None:
    raise KeyboardInterrupt


def save(folder: Path) -> None:
    with atomic_write.Files() as files:
        for name in ("a", "b"):
            file = files.open(str(folder / name))
            for k in range(0, len(NEW), 20_000):
                file.write(NEW[k : k + 20_000])
    atomic_write.write(str(folder / "c"), NEW, fresh=True)


def prepared(folder: Path) -> None:
    folder.mkdir()
    for name in ("a", "b"):
        (folder / name).write_bytes(OLD)


@pytest.mark.parametrize("end", [disk_full, interrupt])
def test_whatever_fails_targets_are_whole_and_nothing_is_left(
    end: Callable[[], object], tmp_path: Path
) -> None:
    at, failed = 0, 0
    while True:
        at += 1
        folder = tmp_path / str(at)
        prepared(folder)
        with pytest.MonkeyPatch.context() as patch:
            faulty = Faulty(patch, at, end)
            try:
                save(folder)
                done = True
            except (OSError, KeyboardInterrupt):
                done = False
                failed += 1
        found = {path.name: path.read_bytes() for path in folder.iterdir()}
        assert set(found) <= {"a", "b", "c"}, at
        assert all(content in (OLD, NEW) for content in found.values()), at
        assert found["a"] == NEW or found["b"] == OLD, at  # one after the other
        if done:
            assert found == dict.fromkeys("abc", NEW), at
        if faulty.calls < at:
            break
    assert failed > 40


@pytest.mark.full
@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes")
def test_whenever_it_ends_every_target_is_whole(tmp_path: Path) -> None:
    at, ended = 0, False
    while not ended:
        at += 1
        folder = tmp_path / str(at)
        prepared(folder)
        child = os.fork()
        if child == 0:
            with pytest.MonkeyPatch.context() as patch:
                Faulty(patch, at, lambda: os._exit(1))
                save(folder)
                os._exit(0)
        ended = os.waitpid(child, 0)[1] == 0
        for path in folder.iterdir():
            content = path.read_bytes()
            assert content in (OLD, NEW) or path.name.endswith(".lagc-tmp"), at
    assert at > 40 and {path.name for path in folder.iterdir()} == {"a", "b", "c"}


@pytest.mark.skipif(sys.platform == "win32", reason="modes")
def test_an_old_file_keeps_its_mode_and_a_new_one_has_the_usual(tmp_path: Path) -> None:
    chance = random.Random(1)
    old = os.umask(0o027)
    try:
        atomic_write.write(str(tmp_path / "new"), NEW)
        assert stat.S_IMODE((tmp_path / "new").stat().st_mode) == 0o640
        for _ in range(20):
            mode = chance.randrange(0o1000) | 0o200
            (tmp_path / "old").write_bytes(OLD)
            (tmp_path / "old").chmod(mode)
            atomic_write.write(str(tmp_path / "old"), NEW)
            assert stat.S_IMODE((tmp_path / "old").stat().st_mode) == mode
            (tmp_path / "old").unlink()
    finally:
        os.umask(old)


@pytest.mark.full
@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="other users")
def test_no_group_gets_what_was_granted_to_another(tmp_path: Path) -> None:
    """Written by each user, in the group of the file or not, what is granted stays granted to the same
    group, or to none."""
    ours, secret, user, other = 40_001, 40_002, 40_003, 40_004
    folder = tmp_path / "all"
    folder.mkdir()
    folder.chmod(0o777)
    path = str(folder / "file")
    for owner, mode, groups in product((user, other), (0o640, 0o666, 0o2770, 0o4762), ([secret], [])):
        (folder / "file").write_bytes(OLD)
        os.chown(path, owner, secret)
        os.chmod(path, mode)
        child = os.fork()
        if child == 0:
            os.chdir(folder)  # which those above need not let them see
            os.setgroups(groups)
            os.setgid(ours)
            os.setuid(user)
            try:
                atomic_write.write("file", NEW)
            except PermissionError:
                os._exit(1)
            os._exit(0)
        done = os.waitpid(child, 0)[1] == 0
        allowed = owner == user or mode & 0o002 or (groups and mode & 0o020)
        found = os.stat(path)
        kept = stat.S_IMODE(found.st_mode)
        case = owner, oct(mode), groups
        assert done == bool(allowed), case
        if done:
            assert found.st_uid == user and (found.st_gid == secret) == bool(groups), case
            lost = (0 if groups else 0o2070) | (0 if owner == user else 0o4000)
            assert kept & 0o777 == mode & ~lost & 0o777 and not kept & lost, (case, oct(kept))
        os.unlink(path)


@pytest.mark.skipif(sys.platform == "win32", reason="links")
def test_links_are_followed(tmp_path: Path) -> None:
    (tmp_path / "far").mkdir()
    (tmp_path / "first").symlink_to("second")
    (tmp_path / "second").symlink_to(Path("far") / "file")
    for data in (OLD, NEW):
        atomic_write.write(str(tmp_path / "first"), data)
        assert (tmp_path / "far" / "file").read_bytes() == data
        assert (tmp_path / "first").is_symlink() and (tmp_path / "second").is_symlink()
    (tmp_path / "round").symlink_to("round")
    with pytest.raises(OSError):
        atomic_write.write(str(tmp_path / "round"), NEW)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes")
def test_what_is_no_regular_file_is_written_straight(tmp_path: Path) -> None:
    pipe, found = tmp_path / "pipe", []
    os.mkfifo(pipe)
    reader = threading.Thread(target=lambda: found.append(pipe.read_bytes()))
    reader.start()
    atomic_write.write(str(pipe), NEW)
    reader.join()
    assert found == [NEW] and stat.S_ISFIFO(pipe.stat().st_mode)
    atomic_write.write(os.devnull, NEW)
    assert stat.S_ISCHR(os.stat(os.devnull).st_mode)


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="a device that is full")
def test_a_full_device_is_told() -> None:
    with pytest.raises(OSError) as caught:
        atomic_write.write("/dev/full", NEW)
    assert caught.value.errno == errno.ENOSPC


def test_a_fresh_file_replaces_none(tmp_path: Path) -> None:
    path = tmp_path / "x"
    atomic_write.write(str(path), OLD, fresh=True)
    with pytest.raises(FileExistsError):
        atomic_write.write(str(path), NEW, fresh=True)
    assert path.read_bytes() == OLD and [p.name for p in tmp_path.iterdir()] == ["x"]


@pytest.mark.parametrize("letter", ["x", "\N{LATIN SMALL LETTER E WITH ACUTE}", "\N{SNOWMAN}", "\U0001f600"])
def test_whatever_name_a_folder_takes_is_written(letter: str, tmp_path: Path) -> None:
    most, size = os.pathconf(tmp_path, "PC_NAME_MAX"), len(letter.encode())
    for before in range(size):  # so that names are cut within every byte of a letter
        for length in (atomic_write.LONGEST, atomic_write.LONGEST + 8, most):
            name = "a" * before + letter * ((length - before) // size)
            assert atomic_write.obstacle(str(tmp_path / name)) == ""
            atomic_write.write(str(tmp_path / name), NEW)
            assert (tmp_path / name).read_bytes() == NEW
        assert atomic_write.obstacle(str(tmp_path / (name + letter))) == os.strerror(errno.ENAMETOOLONG)


@pytest.mark.skipif(sys.platform != "linux", reason="names that are no text")
def test_names_that_are_no_text_are_written(tmp_path: Path) -> None:
    chance = random.Random(2)
    for length in (1, 59, 60, 61, 255):
        name = os.fsdecode(bytes(chance.choice(range(128, 256)) for _ in range(length)))
        atomic_write.write(str(tmp_path / name), NEW)
        assert (tmp_path / name).read_bytes() == NEW


@pytest.mark.skipif(sys.platform != "linux", reason="the longest path")
def test_the_longest_path_is_written_relative_to_where_one_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for _ in range(20):  # a current folder whose name alone is longer than a path may be
        os.mkdir("x" * 255)
        os.chdir("x" * 255)
    atomic_write.write("here", NEW)
    with open("here", "rb") as file:
        assert file.read() == NEW


def test_what_is_in_the_way_shows_before(tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").write_bytes(OLD)
    for name in ("folder", "file/x", "nowhere/x", "x" * 300):
        assert atomic_write.obstacle(str(tmp_path / name)), name
        with pytest.raises(OSError):
            atomic_write.write(str(tmp_path / name), NEW)
    for name in ("a\0b", "\ud800"):
        assert atomic_write.obstacle(name) and atomic_write.obstacle(str(tmp_path / name))
    for name in ("file", "new"):
        assert atomic_write.obstacle(str(tmp_path / name)) == "", name


pipes = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes")


@pipes
def test_a_pipe_waits_for_its_reader(tmp_path: Path) -> None:
    pipe, found = tmp_path / "pipe", []
    os.mkfifo(pipe)
    late = threading.Timer(0.3, lambda: found.append(pipe.read_bytes()))
    late.start()
    atomic_write.write(str(pipe), NEW)
    late.join()
    assert found == [NEW]


@pipes
def test_a_pipe_whose_reader_reads_nothing_is_given_up_by_an_interrupt(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    before = signal.signal(signal.SIGALRM, lambda *_: interrupt())
    try:
        for size in (70_000, 1 << 20):  # more than a pipe holds
            signal.setitimer(signal.ITIMER_REAL, 0.2)
            with pytest.raises(KeyboardInterrupt), atomic_write.Files() as files:
                files.open(str(tmp_path / "beside")).write(NEW)
                file = files.open(str(pipe))
                for _ in range(0, size, 1000):
                    file.write(bytes(1000))
                file.flush()
            assert [path.name for path in tmp_path.iterdir()] == ["pipe"]
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
        os.close(reader)


def test_the_file_that_was_asked_for_is_blamed(tmp_path: Path) -> None:
    path = str(tmp_path / "none" / "a.svg")
    with pytest.raises(FileNotFoundError) as found:
        atomic_write.write(path, b"")
    assert found.value.filename == path
