"""The cache may be deleted, damaged or refuse to be written at any time."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from lagc import cache, load


@pytest.fixture()
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "cache"
    monkeypatch.setenv("LAGC_CACHE", str(folder))
    return folder


def only_entry(root: Path) -> Path:
    (path,) = [p for p in root.rglob("*") if p.is_file()]
    return path


def test_what_is_stored_is_loaded(root: Path) -> None:
    name = cache.key("a", "b")
    assert cache.load(name) is None
    cache.store(name, b"line\n\0bytes")
    assert cache.load(name) == b"line\n\0bytes"


def test_parts_of_a_key_do_not_run_together() -> None:
    assert cache.key("ab", "c") != cache.key("a", "bc") != cache.key("abc")


@pytest.mark.parametrize("damage", [b"", b"x", b"lagc-cache-1 00\nbody"])
def test_a_damaged_entry_is_as_good_as_absent(root: Path, damage: bytes) -> None:
    name = cache.key("a")
    cache.store(name, b"body")
    only_entry(root).write_bytes(damage)
    assert cache.load(name) is None
    cache.store(name, b"new")
    assert cache.load(name) == b"new"


def test_a_changed_byte_is_noticed(root: Path) -> None:
    name = cache.key("a")
    cache.store(name, b"body")
    path = only_entry(root)
    path.write_bytes(path.read_bytes()[:-1] + b"Y")
    assert cache.load(name) is None


def test_a_cache_folder_that_is_a_file_is_no_error(root: Path) -> None:
    root.write_text("in the way")
    cache.store(cache.key("a"), b"body")
    assert cache.load(cache.key("a")) is None


def test_a_folder_that_vanishes_is_no_error(root: Path) -> None:
    name = cache.key("a")
    cache.store(name, b"body")
    only_entry(root).unlink()
    assert cache.load(name) is None


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root writes anywhere")
def test_a_read_only_folder_is_no_error(root: Path) -> None:
    root.mkdir()
    root.chmod(0o500)
    cache.store(cache.key("a"), b"body")
    assert cache.load(cache.key("a")) is None
    root.chmod(0o700)


def test_an_empty_variable_turns_it_off(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LAGC_CACHE", "")
    assert cache.folder() is None
    cache.store(cache.key("a"), b"body")
    assert cache.load(cache.key("a")) is None


def test_the_platform_default_is_used(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv("LAGC_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache.folder() == str(tmp_path / "lagc")


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
