"""The site: all documents are in it, and its builder has nothing to say."""

import re
import sys
from pathlib import Path

import pytest

from lagc.host.model_library import library_models
from tools.site import __main__ as site

DOCS = site.ROOT / "docs"
MODELS = ("course/simple_pendulum", "classic/four_bar", "contact/bouncing_ball")


def test_each_document_has_a_place_in_the_navigation() -> None:
    listed = re.findall(r"[\w./-]+\.md", (site.HERE / "mkdocs.yml").read_text(encoding="utf-8"))
    written = {path.relative_to(DOCS).as_posix() for path in DOCS.rglob("*.md")}
    beside = {"index.md", "reference/api.md", *(f"{name}.md" for name in site.tree.PROJECT)}
    assert sorted(listed) == sorted(written | beside)


def build(folder: Path, monkeypatch: pytest.MonkeyPatch, *models: str) -> int:
    pytest.importorskip("zensical")
    pytest.importorskip("mkdocstrings")
    monkeypatch.setattr(
        sys, "argv", ["site", str(folder), "--no-playground", *(["--models", *models] if models else [])]
    )
    return site.main()


@pytest.mark.full
def test_the_site_is_built_without_a_warning(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    assert build(tmp_path, monkeypatch, *MODELS) == 0, capfd.readouterr().out
    gallery = (tmp_path / "gallery.html").read_text(encoding="utf-8")
    for name in MODELS:
        page = (tmp_path / "gallery" / f"{name}.html").read_text(encoding="utf-8")
        assert f"playground/index.html#model={name}" in page and "<math" in page and "coordinate" in page
        assert (tmp_path / "gallery" / f"{name}.png").stat().st_size > 500
        assert f"gallery/{name}.html" in gallery
    interface = (tmp_path / "reference" / "api.html").read_text(encoding="utf-8")
    said = ("Simulate from t = 0", "Return the positions of a body", "Limits of a block")
    assert all(text in interface for text in said)
    assert "SimplePendulum" in (tmp_path / "search.json").read_text(encoding="utf-8")


@pytest.mark.long
def test_the_gallery_has_all_models(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert build(tmp_path, monkeypatch) == 0
    assert all((tmp_path / "gallery" / f"{name}.html").exists() for name in library_models())
