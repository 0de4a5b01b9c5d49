"""The models that the documents show are models."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from lagc.checking import check
from lagc.compiler import Choice
from lagc.diagnostics.faults import Source

ROOT = Path(__file__).parents[2]
DOCUMENTS = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


def blocks() -> list[tuple[str, str]]:
    """(where, text) of every block of `modelica` that is not marked as a fragment."""
    found = []
    for path in DOCUMENTS:
        text = path.read_text(encoding="utf-8")
        for match in re.finditer(r"^```modelica\n(.*?)^```", text, re.MULTILINE | re.DOTALL):
            found.append((f"{path.name}:{text.count(chr(10), 0, match.start()) + 2}", match[1]))
    return found


@pytest.mark.parametrize(("where", "text"), blocks(), ids=lambda x: x if len(x) < 40 else "")
def test_models_of_the_documents_are_accepted(where: str, text: str) -> None:
    assert check(Source(where, text), Choice()) == []


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda p: p.name)
def test_links_lead_somewhere(path: Path) -> None:
    prose = re.sub(r"^```.*?^```", "", path.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    for target in re.findall(r"\]\(([^)#]+)\)", prose):
        if "://" not in target:
            assert (path.parent / target).exists(), target
