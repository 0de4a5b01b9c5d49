"""Every refused model: the code of its fault, and its exact place."""

import importlib

import pytest

from lagc.compiler.checking import check
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Source

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
