"""The catalogue's examples of the mechanics: each wrong one brings its code, each right one passes."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import lagc.mechanics
from lagc.diagnostics.catalogue import entries
from lagc.diagnostics.faults import Refused, Source
from lagc.host.model_library import messages_folder
from lagc.mechanics.derive import derive
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.mechanics.lint.loads import unmoved
from lagc.semantics.resolve import resolve
from lagc.syntax.parse import parse
from tests.invariants import verify

ENTRIES = entries(messages_folder())
CODES = [code for code in ENTRIES if code.startswith("LAG04")]


def derived(text: str) -> EquationsOfMotion:
    return derive(resolve(parse(Source("example.lag", text))))


@pytest.mark.parametrize("code", CODES)
def test_wrong_example_is_refused_or_warned_of_at_a_place(code: str) -> None:
    try:
        equations = derived(ENTRIES[code].wrong)
        (fault,) = equations.warnings or unmoved(equations)
    except Refused as refused:
        (fault,) = refused.faults
    assert fault.code == code
    assert fault.span is not None and fault.span.line > 1
    assert fault.remedy


@pytest.mark.parametrize("code", CODES)
def test_right_example_passes(code: str) -> None:
    equations = derived(ENTRIES[code].right)
    verify(equations)
    assert not equations.warnings
    assert equations.v


def test_every_code_of_the_room_is_listed() -> None:
    sources = Path(lagc.mechanics.__file__).parent.rglob("*.py")
    used = {code for p in sources for code in re.findall(r'"(LAG\d{4})"', p.read_text("utf-8"))}
    others = {"LAG0235", "LAG0623"}  # of the arguments of a contact, and of what linear models do not follow
    elsewhere = {"LAG0434"}  # gravity that points up, which declarations find
    assert used | elsewhere == {*CODES, *others}
