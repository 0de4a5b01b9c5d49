"""Every code that lagc can say is explained, and its examples do what they say."""

import re
from pathlib import Path

import pytest

from lagc.compiler.checking import check
from lagc.compiler.stages import Choice
from lagc.diagnostics.catalogue import entries
from lagc.diagnostics.faults import Source
from lagc.host.model_library import messages_folder

PACKAGE = Path(__file__).resolve().parents[2] / "lagc"
ENTRIES = entries(messages_folder())


def codes_in_use() -> set[str]:
    texts = [p.read_text() for p in PACKAGE.rglob("*.py")]
    return {code for text in texts for code in re.findall(r"LAG0\d{3}", text)}


def test_every_code_has_an_entry_and_every_entry_a_use() -> None:
    assert codes_in_use() == set(ENTRIES)


def faults_of(text: str, code: str) -> list[str]:
    """The codes of a text.  Most examples are too small for a force, so nothing moves their coordinates."""
    found = [f.code for f in check(Source("example.lag", text), Choice())]
    return [c for c in found if c != "LAG0429" or code == c]


@pytest.mark.sample(6, 12)
@pytest.mark.parametrize("code", [code for code, entry in ENTRIES.items() if entry.wrong])
def test_the_wrong_example_brings_its_code_alone(code: str) -> None:
    assert set(faults_of(ENTRIES[code].wrong, code)) == {code}


@pytest.mark.sample(6, 12)
@pytest.mark.parametrize("code", [code for code, entry in ENTRIES.items() if entry.right])
def test_the_right_example_is_accepted(code: str) -> None:
    assert faults_of(ENTRIES[code].right, code) == []


def test_an_entry_explains_itself() -> None:
    for code, entry in ENTRIES.items():
        assert entry.explanation.endswith("."), code
        assert entry.title[0].islower(), code


def test_every_section_of_a_page_is_an_entry() -> None:
    pages = [page.read_text(encoding="utf-8") for page in Path(messages_folder()).iterdir()]
    assert sum(page.count("\n## ") for page in pages) == len(ENTRIES)
    examples = [text for entry in ENTRIES.values() for text in (entry.wrong, entry.right) if text]
    assert sum(page.count("\n\n    ") for page in pages) == len(examples)
