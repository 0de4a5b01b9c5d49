"""The cache may be deleted, damaged or refuse to be written at any time."""

from __future__ import annotations

import errno
import hashlib
import json
import os
import random
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

from lagc import load
from lagc.base import records
from lagc.cli.main import main
from lagc.compiler.pipeline import Compilation
from lagc.compiler.stages import Choice
from lagc.host import cache, model_library
from lagc.host.cache import folders, upkeep
from lagc.lowering.program import Block, Clause, Contact, Field

POSIX = os.name == "posix"
KEY = cache.key("a")
BODY = bytes(range(256)) * 5 + b"\n\0end"


@pytest.fixture()
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "cache"
    monkeypatch.setenv("LAGC_CACHE", str(folder))
    cache.notes.clear()
    return folder


def kept(kind: str = "head", key: str = KEY) -> bytes | None:
    return cache.load(kind, key, bytes)


def put(path: Path, data: bytes) -> None:
    """As a stranger to the rules would write it: in place."""
    path.write_bytes(data)


def replaced_by_folder(path: Path) -> None:
    path.unlink()
    path.mkdir()
    (path / "in").write_text("the way")


def replaced_by_pipe(path: Path) -> None:
    path.unlink()
    os.mkfifo(path)


def replaced_by_link(path: Path) -> None:
    path.rename(path.with_name("elsewhere"))
    path.symlink_to("elsewhere")


def replaced_by_other(path: Path) -> None:
    other = cache.key("other")
    cache.store("head", other, b"another body")
    os.replace(path.with_name(f"head-{other}"), path)


def replaced_by_other_kind(path: Path) -> None:
    cache.store("artifact", KEY, BODY)
    os.replace(path.with_name(f"artifact-{KEY}"), path)


def hole(path: Path) -> None:
    """As large as no disk is."""
    with path.open("r+b") as file:
        file.truncate(1 << 40)


def flipped(place: float) -> Callable[[Path], None]:
    def damage(path: Path) -> None:
        data = bytearray(path.read_bytes())
        data[min(int(place * len(data)), len(data) - 1)] ^= 0x10
        put(path, bytes(data))

    return damage


def cut(place: float) -> Callable[[Path], None]:
    def damage(path: Path) -> None:
        data = path.read_bytes()
        put(path, data[: int(place * len(data))])

    return damage


DAMAGES: dict[str, Callable[[Path], None]] = {
    **{f"byte at {k}/16": flipped(k / 16) for k in range(17)},
    **{f"cut at {k}/16": cut(k / 16) for k in range(16)},
    "last byte missing": lambda path: put(path, path.read_bytes()[:-1]),
    "grown": lambda path: put(path, path.read_bytes() + b"\0"),
    "zeros": lambda path: put(path, bytes(len(path.read_bytes()))),
    "twice": lambda path: put(path, path.read_bytes() * 2),
    "of an older layout": lambda path: put(path, b"lagc-cache-1 " + path.read_bytes()[len(folders.MAGIC) :]),
    "another's": replaced_by_other,
    "another kind's": replaced_by_other_kind,
    "a folder": replaced_by_folder,
}
if POSIX:
    DAMAGES |= {
        "a pipe": replaced_by_pipe,
        "a link": replaced_by_link,
        "a hole": hole,
        "writable by all": lambda path: path.chmod(0o602),
        "writable by the group": lambda path: path.chmod(0o620),
    }
    if os.geteuid() == 0:
        DAMAGES["a stranger's"] = lambda path: os.chown(path, 12345, -1)


def test_what_is_stored_is_loaded(root: Path) -> None:
    assert kept() is None and cache.notes == []
    for body in (b"", b"x", BODY):
        cache.store("head", KEY, body)
        assert kept() == body
    assert cache.notes == [] and [p.name for p in root.iterdir()] == [f"head-{KEY}"]
    assert not POSIX or (root.stat().st_mode & 0o777, next(root.iterdir()).stat().st_mode & 0o777) == (
        0o700,
        0o600,
    )


def test_parts_of_a_key_do_not_run_together() -> None:
    assert cache.key("ab", "c") != cache.key("a", "bc") != cache.key("abc")


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_entry_is_as_good_as_absent(
    root: Path, damage: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """It is told, found and removed by `lagc cache --verify`, and made again."""
    cache.store("head", KEY, BODY)
    DAMAGES[damage](root / f"head-{KEY}")
    assert kept() is None
    assert len(cache.notes) == 1 and KEY in cache.notes[0] and "created again" in cache.notes[0]
    if damage != "a folder":
        cache.store("head", KEY, BODY)
        assert kept() == BODY
        DAMAGES[damage](root / f"head-{KEY}")
    assert main(["cache", "--verify"]) == 1
    assert f"head-{KEY} removed" in capsys.readouterr().out
    assert not os.path.lexists(root / f"head-{KEY}")
    assert main(["cache", "--verify"]) == 0
    cache.store("head", KEY, BODY)
    assert kept() == BODY


def test_every_byte_of_an_entry_counts(root: Path) -> None:
    cache.store("head", KEY, b"short")
    path = root / f"head-{KEY}"
    whole = path.read_bytes()
    for k in range(len(whole)):
        changed = bytearray(whole)
        changed[k] ^= 1 << k % 8
        path.write_bytes(changed)
        assert kept() is None, k
    path.write_bytes(whole)
    assert kept() == b"short"


def test_a_body_that_cannot_be_read_is_as_good_as_absent(root: Path) -> None:
    cache.store("head", KEY, b"{no json")
    assert cache.load("head", KEY, json.loads) is None and len(cache.notes) == 1


def test_a_cache_folder_that_is_a_file_is_no_error(root: Path) -> None:
    root.write_text("in the way")
    cache.store("head", KEY, BODY)
    assert kept() is None and "is not used" in cache.notes[0]
    assert main(["cache", "--clear"]) == 1 and root.read_text() == "in the way"


def test_a_folder_that_vanishes_is_no_error(root: Path) -> None:
    cache.store("head", KEY, BODY)
    place = cache.opened()
    assert place is not None
    with place:
        (root / f"head-{KEY}").unlink()
        root.rmdir()
        with pytest.raises(FileNotFoundError):
            place.write(f"head-{KEY}", BODY)
        with pytest.raises(FileNotFoundError):
            place.read(f"head-{KEY}")
    assert kept() is None and cache.notes == []


@pytest.mark.skipif(not POSIX or os.geteuid() == 0, reason="root writes anywhere")
def test_a_read_only_folder_is_no_error(root: Path) -> None:
    root.mkdir()
    root.chmod(0o500)
    cache.store("head", KEY, BODY)
    assert kept() is None and "not kept" in cache.notes[0]
    root.chmod(0o700)


@pytest.mark.skipif(not POSIX, reason="other systems have other rights")
@pytest.mark.parametrize("rights", [0o777, 0o770, 0o722, 0o1777, "a stranger's", "a link to a stranger's"])
def test_a_folder_that_others_may_write_is_not_used(root: Path, rights: int | str) -> None:
    cache.store("head", KEY, BODY)
    if isinstance(rights, int):
        root.chmod(rights)
    elif os.geteuid() != 0:
        pytest.skip("only root gives folders away")
    else:
        os.chown(root, 12345, -1)
        if "link" in rights:
            root.rename(root.with_name("theirs"))
            root.symlink_to("theirs")
    assert kept() is None and not cache.holds("head", KEY)
    before = sorted(root.iterdir())
    cache.store("head", cache.key("b"), BODY)
    assert sorted(root.iterdir()) == before
    assert len(cache.notes) == 1 and "is not used" in cache.notes[0]
    assert main(["cache"]) == 1


def test_an_empty_variable_turns_it_off(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LAGC_CACHE", "")
    assert cache.folder() is None
    cache.store("head", KEY, BODY)
    assert kept() is None
    assert main(["cache", "--verify"]) == 0


def test_the_platform_default_is_used(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv("LAGC_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache.folder() == str(tmp_path / "lagc")


@pytest.mark.sample(4)
@pytest.mark.skipif(os.name == "nt", reason="HOME is of other systems")
@pytest.mark.parametrize("home", ["", "here", "./here", "../here", "~"])
def test_a_relative_home_makes_no_folders(home: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A relative XDG_CACHE_HOME is to be ignored, by the specification of these folders."""
    monkeypatch.delenv("LAGC_CACHE", raising=False)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", home)
    monkeypatch.setenv("XDG_CACHE_HOME", "here")
    assert cache.folder() is None
    assert main(["sim", "simple_pendulum", "-q", "--backend", "numpy", "--stop", "0.1"]) == 0
    assert list(tmp_path.iterdir()) == []


def test_a_relative_variable_is_taken_at_its_word(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("LAGC_CACHE", "here")
    cache.store("head", KEY, BODY)
    assert kept() == BODY and (tmp_path / "here" / f"head-{KEY}").exists()


def test_the_home_folder_has_a_sign(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("USERPROFILE", str(tmp_path))
    monkeypatch.setenv("LAGC_CACHE", "~/kept")
    assert cache.folder() == f"{tmp_path}/kept"


def test_the_command_shows_and_clears(root: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for k in range(5):
        cache.store("head" if k % 2 else "artifact", cache.key(str(k)), b"x" * k * 1200)
    (root / "mine").write_text("not an entry")
    (root / "tmp-0123456789abcdef").write_text("being written")
    assert main(["cache", "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert facts["kinds"] == {
        "artifact": {"entries": 3, "bytes": 4 * upkeep.BLOCK},
        "head": {"entries": 2, "bytes": 2 * upkeep.BLOCK},
    }
    assert (facts["folder"], facts["unfinished"], facts["status"]) == (str(root), 1, "ok")
    assert main(["cache"]) == 0
    assert "5 entries" in capsys.readouterr().out
    assert main(["cache", "--clear"]) == 0
    assert "5 removed" in capsys.readouterr().out
    assert [p.name for p in root.iterdir()] == ["mine"]


def test_what_was_used_least_recently_goes(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Random sizes and ages: what stays is the most recent, within the limit."""
    random_of = random.Random(3)
    for _ in range(10):
        main(["cache", "--clear", "-q"])
        now, ages = 2_000_000_000, random_of.sample(range(1000), 30)
        for age in ages:
            cache.store("head", "f" + cache.key(str(age))[1:], bytes(random_of.randrange(20_000)))
            os.utime(root / f"head-f{cache.key(str(age))[1:]}", (now - age, now - age))
        limit = random_of.randrange(1, 500_000)
        monkeypatch.setenv("LAGC_CACHE_SIZE", str(limit))
        place = cache.opened()
        assert place is not None
        with place:
            before = sorted(upkeep.entries(place), key=lambda e: -e.used)
            upkeep.shrink(place)
            left = sorted(upkeep.entries(place), key=lambda e: -e.used)
        assert left == before[: len(left)]
        total = sum(e.size for e in left)
        if left == before:
            assert total <= limit
        else:
            assert total <= upkeep.LEFT * limit < total + before[len(left)].size


def test_storing_keeps_the_cache_below_its_limit(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is looked after at one entry in 256: seldom more than a thousand come between."""
    monkeypatch.setenv("LAGC_CACHE_SIZE", "1M")
    most = []
    for k in range(2000):
        cache.store("head", cache.key(str(k)), b"")
        if k % 100 == 0:
            most.append(len(os.listdir(root)))
    assert 200 < max(most) < 1300


def test_an_entry_that_is_used_stays_young(root: Path) -> None:
    cache.store("head", KEY, BODY)
    path = root / f"head-{KEY}"
    os.utime(path, (1e9, 1e9))
    assert kept() == BODY
    assert not POSIX or path.stat().st_mtime > 1.1e9


@pytest.mark.parametrize(
    ("word", "bytes_"),
    [("500M", 500_000_000), ("2g", 2_000_000_000), ("1.5 kB", 1500), ("0", 0), ("7", 7), (" 3K ", 3000),
     *((w, upkeep.LIMIT) for w in ("", "much", "-1", "1e9", "nan", "٣", "1T", "inf"))],
)  # fmt: skip
def test_sizes(word: str, bytes_: int, monkeypatch: pytest.MonkeyPatch) -> None:
    cache.notes.clear()
    monkeypatch.setenv("LAGC_CACHE_SIZE", word)
    assert upkeep.limit() == bytes_
    assert bool(cache.notes) == (bytes_ == upkeep.LIMIT and word != "")


def test_old_temporary_files_are_removed(root: Path) -> None:
    cache.store("head", KEY, BODY)
    (root / "tmp-0123456789abcdef").write_bytes(b"half")
    assert main(["cache", "--verify", "-q"]) == 0
    assert list(root.glob("tmp-*"))
    for path in root.glob("tmp-*"):
        os.utime(path, (1e9, 1e9))
    assert main(["cache", "--verify", "-q"]) == 0
    assert not list(root.glob("tmp-*"))


def test_each_folder_has_its_own_imports(root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One and the same text, called by the same name, means another model beside another file."""
    text = (
        'import "lib.lag"; model A coordinate Length x(start = x0); '
        "body b = Particle(mass = 1, at = {x, 0, 0}); end A;"
    )
    found = []
    for number in (1, 2, 1):
        folder = tmp_path / str(number)
        folder.mkdir(exist_ok=True)
        (folder / "main.lag").write_text(text)
        (folder / "lib.lag").write_text(f"constant Length x0 = {number};")
        monkeypatch.chdir(folder)
        found.append(float(load("main.lag").compile(backend="numpy").start()[0]))
    assert found == [1.0, 2.0, 1.0]


class Failing:
    """A module or file of which the call number `at` fails."""

    def __init__(self, real: Any, error: int, at: int, counted: list[int]):
        self.real, self.error, self.at, self.counted = real, error, at, counted

    def __getattr__(self, name: str) -> Any:
        found = getattr(self.real, name)
        if not callable(found) or name in ("fspath", "geteuid", "getpid", "urandom", "strerror"):
            return found

        def call(*given: Any, **named: Any) -> Any:
            self.counted[0] += 1
            if self.counted[0] == self.at and name != "close":
                raise OSError(self.error, os.strerror(self.error))
            return found(*given, **named)

        return call


def open_failing(error: int, at: int, counted: list[int]) -> Callable[..., Any]:
    class File(Failing):
        def __enter__(self) -> File:
            return self

        def __exit__(self, *_: object) -> None:
            self.real.close()

    return lambda *given, **named: File(open(*given, **named), error, at, counted)


@pytest.mark.sample(2)
@pytest.mark.parametrize("error", ["EIO", "ENOSPC", "EMFILE", "EACCES", "ESTALE", "ENOENT"])
def test_whatever_the_system_refuses_is_no_error(
    root: Path, error: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every call of the system fails once, one after the other: nothing is raised, nothing wrong is read
    and, when it works again, nothing is left over and all is as it should be."""
    number = getattr(errno, error)
    monkeypatch.setenv("LAGC_CACHE_SIZE", "300")

    def use() -> None:
        key = "00" + KEY[2:]  # the size is looked at
        cache.store("head", key, BODY[:100])
        assert kept("head", key) in (None, BODY[:100])
        cache.store("head", KEY, BODY)
        assert kept() in (None, BODY)
        cache.holds("head", KEY)
        place = cache.opened()
        if place is not None:
            with place, suppress(OSError):  # which `lagc cache` tells
                upkeep.damaged(place)
                upkeep.clear(place)

    at, counted = 0, [1]
    while at < counted[0]:
        at, counted = at + 1, [0]
        with monkeypatch.context() as patch:
            for module in (cache, folders, upkeep):
                patch.setattr(module, "os", Failing(os, number, at, counted))
            patch.setattr(folders, "open", open_failing(number, at, counted), raising=False)
            use()
        cache.store("head", KEY, BODY)
        assert kept() == BODY
        assert main(["cache", "--verify", "-q"]) == 0
        assert main(["cache", "--clear", "-q"]) == 0
        assert main(["cache"]) == 0 and not list(root.iterdir())
    assert at > 30


def test_hashes_are_blake2b() -> None:
    """Of whichever module they come."""
    for size in (0, 1, 55, 56, 63, 64, 65, 1000, 100_001):
        data = random.Random(size).randbytes(size)
        assert cache.digest(data) == hashlib.blake2b(data, digest_size=32).hexdigest()
    hashed = folders.sealed("n", BODY)[: folders.HEAD].split()[1].decode()
    assert hashed == hashlib.blake2b(b"n\n" + BODY, digest_size=32).hexdigest()


@pytest.mark.full
@pytest.mark.parametrize("target", ["c", "numpy"])
def test_an_artifact_comes_back_as_it_was(root: Path, target: str) -> None:
    """Every number and text of it, of its own type: what is kept knows no others."""
    names = sorted(model_library.library_models())
    for name in random.Random(7).sample(names, 3):
        compilation = Compilation(model_library.read(name), Choice())
        made = compilation.artifact(target)
        kept_ = compilation.cached_artifact(target)
        assert kept_ is not None and repr(kept_.interface) == repr(made.interface)
        assert kept_.interface == made.interface and kept_.unused == made.unused
        assert kept_.sources == made.sources and kept_.code == made.code
        for field in (getattr(kept_.interface, each) for each in records.names(type(kept_.interface))):
            assert plain(field), field


def plain(value: Any) -> bool:
    if isinstance(value, tuple | dict):
        return all(map(plain, value.values() if isinstance(value, dict) else value))
    if isinstance(value, Field | Clause | Contact | Block):
        return all(plain(getattr(value, name)) for name in records.names(type(value)))
    return type(value) in (str, int, float, bool, type(None))
