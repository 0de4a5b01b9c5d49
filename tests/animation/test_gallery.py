"""The gallery of the documents against the library."""

import re
from pathlib import Path

from lagc.host.model_library import library_models

DOCS = Path(__file__).resolve().parents[2] / "docs"
MOST_BYTES = 100_000  # of a picture: the repository stays light


def test_the_gallery_has_every_model_of_the_library_once() -> None:
    text = (DOCS / "gallery.md").read_text(encoding="utf-8")
    named = re.findall(r"^\*\*\[(\S+)\]\(\.\./models/(\S+)\.lag\)\*\*", text, re.MULTILINE)
    assert [name for name, _ in named] == [path for _, path in named] == library_models()


def test_its_pictures_are_there_and_small() -> None:
    text = (DOCS / "gallery.md").read_text(encoding="utf-8")
    pictures = re.findall(r"!\[.*?\]\((\S+)\)", text)
    assert {Path(picture).stem for picture in pictures} == {
        name.partition("/")[0] for name in library_models()
    }
    assert all(0 < (DOCS / picture).stat().st_size < MOST_BYTES for picture in pictures)
