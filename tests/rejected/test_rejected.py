"""Every refused model: the code of its fault, and its exact place. Texts with the habits of Modelica and
Python: each mistake is one fault, with the line to write. `habits.txt` has a block for each text: `===
name`, the text, a line `--- CODE line:column words` for each fault, where the remedy has the words, and
lines `+++ first-last new line` that follow the remedies."""

import importlib
from pathlib import Path
from typing import NamedTuple

import pytest

from lagc.compiler.checking import check
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Fault, Source

HEAD = "model M parameter Mass m = 1; coordinate Length x; body b = Particle(mass = m, at = {x, 0, 0});\n"
CASES = [
    case
    for name in ("names", "quantities", "motion", "language")
    for case in importlib.import_module(f"tests.rejected.{name}").CASES
]


def whole(text: str) -> str:
    return text if "model " in text or text.startswith("«t»ype") else f"{HEAD}{text}\nend M;"


def unmarked(text: str) -> tuple[str, int, int]:
    """The text without its marks, and what they marked."""
    start = text.index("«")
    end = text.index("»") - 1
    return text.replace("«", "").replace("»", ""), start, end


@pytest.mark.sample(6, 12)
@pytest.mark.parametrize("about, code, text", CASES, ids=[case[0] for case in CASES])
def test_a_faulty_model_is_refused_at_the_place(about: str, code: str, text: str) -> None:
    plain, start, end = unmarked(whole(text))
    faults = [f for f in check(Source("model.lag", plain), Choice()) if f.severity == "error"]
    found = [(f.code, f.span.start, f.span.end) for f in faults if f.span]
    assert found == [(code, start, end)], [
        (f.code, f.message, plain[f.span.start : f.span.end]) for f in faults if f.span
    ]


def test_there_are_many() -> None:
    assert len(CASES) >= 150
    assert len({about for about, _, _ in CASES}) == len(CASES)


class Habit(NamedTuple):
    text: str
    faults: list[tuple[str, str, str]]  # code, place, words of the remedy
    remedied: str | None


def read_habits() -> dict[str, Habit]:
    blocks = (Path(__file__).parent / "habits.txt").read_text().split("=== ")[1:]
    return {block.partition("\n")[0]: _habit(block.partition("\n")[2]) for block in blocks}


def _habit(block: str) -> Habit:
    lines = block.splitlines()
    text = [line for line in lines if not line.startswith(("--- ", "+++ "))]
    faults = [line[4:].split(" ", 2) for line in lines if line.startswith("--- ")]
    edits = [line[4:].partition(" ") for line in lines if line.startswith("+++ ")]
    remedied = list(text)
    for place, _, new in reversed(edits):  # written in the order of the lines
        first, _, last = place.partition("-")
        remedied[int(first) - 1 : int(last or first)] = [new] if new else []
    followed = "\n".join(remedied) if edits else None
    return Habit("\n".join(text), [(f[0], f[1], f[2]) for f in faults], followed)


def found(text: str) -> list[Fault]:
    """The faults of a text.  Most texts are too small for a force, so nothing moves their coordinates."""
    return [f for f in check(Source("habit.lag", text), Choice()) if f.code != "LAG0429"]


HABITS = read_habits()


@pytest.mark.sample(6)
@pytest.mark.parametrize("name", HABITS)
def test_each_mistake_is_one_fault_with_its_remedy(name: str) -> None:
    faults = found(HABITS[name].text)
    places = [f"{f.span.line}:{f.span.column}" if f.span else "-" for f in faults]
    assert [(f.code, place) for f, place in zip(faults, places)] == [f[:2] for f in HABITS[name].faults]
    for fault, (_, _, words) in zip(faults, HABITS[name].faults):
        assert words in (fault.remedy or ""), (fault.message, fault.remedy)


@pytest.mark.sample(6)
@pytest.mark.parametrize("name", [name for name, habit in HABITS.items() if habit.remedied])
def test_the_text_that_follows_the_remedies_is_accepted(name: str) -> None:
    assert [(f.code, f.message) for f in found(HABITS[name].remedied or "")] == []
