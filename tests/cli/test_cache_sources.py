"""What is kept belongs to the sources of lagc that made it."""

import os
from pathlib import Path

import pytest

from lagc.host import cache as sources


@pytest.fixture()
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "cache"
    monkeypatch.setenv("LAGC_CACHE", str(folder))
    return folder


@pytest.fixture()
def tool(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Sources, as if they were those of the tool."""
    package = tmp_path / "tool" / "lagc"
    for name in ("a.py", "render/b.c", "render/b.h", "frontend/tables.json", "data.txt"):
        (package / name).parent.mkdir(parents=True, exist_ok=True)
        (package / name).write_text(name)
    (package.parent / "grammar").mkdir()
    (package.parent / "grammar" / "lag.lark").write_text("grammar")
    monkeypatch.setattr(sources, "PACKAGE", str(package))
    return package


def fingerprint() -> str:
    sources.tool_fingerprint.cache_clear()
    try:
        return sources.tool_fingerprint()
    finally:
        sources.tool_fingerprint.cache_clear()


@pytest.mark.parametrize(
    "name", ["a.py", "render/b.c", "render/b.h", "frontend/tables.json", "../grammar/lag.lark"]
)
@pytest.mark.parametrize("keeping_its_time", [False, True])
def test_an_edited_source_is_another_tool(
    root: Path, tool: Path, name: str, keeping_its_time: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sources, "FRESH", -1.0)  # what was read is kept at once
    before = fingerprint()
    assert fingerprint() == before and len(list(root.glob("sources-*"))) == 1
    path = tool / name
    status, text = path.stat(), path.read_text()
    path.write_text(text[::-1])  # of the same size
    if keeping_its_time:
        os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns))
    assert fingerprint() != before
    path.write_text(text)  # the content counts, not the time
    assert fingerprint() == before
    path.rename(path.with_name("renamed" + path.suffix))
    if name != "../grammar/lag.lark":
        assert fingerprint() != before


def test_sources_just_written_are_read_again(root: Path, tool: Path) -> None:
    """Two edits may have one time: what was read is not kept before the time has moved on."""
    fingerprint()
    assert not list(root.glob("sources-*"))


def test_sources_that_vanish_are_no_error(root: Path, tool: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """No entry then stands for what they were."""
    (tool / "gone.py").symlink_to("nowhere")
    assert fingerprint() != fingerprint()
    assert not root.exists()
