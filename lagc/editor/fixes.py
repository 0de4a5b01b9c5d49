"""Quick fixes: the edits of a fault, and those that its remedy may mean.

A fix is offered only after it was tried: the fault is gone, and there are not more errors than before.
"""

import re
from collections.abc import Iterator
from itertools import islice

from lagc.base.records import dataclass
from lagc.diagnostics.faults import Edit, Fault, Source
from lagc.editor.document import Document, errors_of
from lagc.syntax.lexer import tokenise
from lagc.syntax.mistakes.signs import CLOSING

MOST = 14  # edits that are tried
_QUOTED = re.compile(r"`([^`]+)`")
_EXAMPLE = re.compile(r"\.\.\.|\blagc |\bsuch as\b|\bfor example\b|\bin place of\b")


@dataclass(frozen=True)
class Fix:
    title: str
    edits: tuple[Edit, ...]


def fix(document: Document, fault: Fault) -> Fix | None:
    """Return the first edit that removes a fault of a text."""
    if fault.span is None or fault.span.source.name != document.source.name:
        return None
    before = document.faults
    candidates = _candidates(document.source.text, fault, fault.span.start, fault.span.end)
    for edits in islice(dict.fromkeys(candidates), MOST):
        changed = document.with_edits(edits)
        after = changed.faults
        fewer = changed.settled and _count(after, fault) < _count(before, fault)
        if fewer and len(errors_of(after)) <= len(errors_of(before)) - (fault.severity == "error"):
            return Fix(_title(document, edits), edits)
    return None


def _count(faults: list[Fault], fault: Fault) -> int:
    return sum((f.code, f.message) == (fault.code, fault.message) for f in faults)


def _title(document: Document, edits: tuple[Edit, ...]) -> str:
    (edit, *_) = edits
    text = edit.text.strip()
    old = document.source.text[edit.start : edit.end]
    return f"write `{text}`" if text and old else f"insert `{text}`" if text else f"delete `{old}`"


def _candidates(text: str, fault: Fault, start: int, end: int) -> Iterator[tuple[Edit, ...]]:
    """Yield the edits of a fault, then those that the texts between backquotes of its remedy may mean: in
    place of the fault, behind it, or in place of the declaration."""
    if fault.edits:
        yield fault.edits
    remedy = fault.remedy or ""
    line = text.rfind("\n", 0, start) + 1
    first = line + len(text[line:]) - len(text[line:].lstrip())
    for written in _QUOTED.findall("" if _EXAMPLE.search(remedy) else remedy):
        last = text.find(";", start)
        if written.endswith(";") and last >= 0:
            yield (Edit(first, last + 1, written),)
        yield (Edit(start, end, written),)
        yield (Edit(end, end, written),)
    if re.search(r"\bdelete it\b|\bleave it out\b", remedy):
        yield (Edit(start, end, ""),)
    if fault.code < "LAG02":
        head = text[start:end].rpartition(" ")[0]  # of a span from one word to the next
        before = fault.edits[0].start if fault.edits else len(text[: start + len(head)].rstrip())
        yield (Edit(before, before, ","),)
        yield from _closing(text, start)


def _closing(text: str, place: int) -> Iterator[tuple[Edit, ...]]:
    """Yield the places for the closing bracket that is missing in the declaration around a place."""
    begin, last = text.rfind(";", 0, place) + 1, text.find(";", place)
    tokens = tokenise(Source("", text[begin : last if last >= 0 else None])).tokens
    opened: list[int] = []
    for k, token in enumerate(tokens):
        if token.text in CLOSING:
            opened.append(k)
        elif opened and token.text in CLOSING.values():
            if CLOSING[tokens[opened[-1]].text] != token.text:
                break
            opened.pop()
    for token in tokens[opened[-1] + 1 : -1] if opened else ():
        yield (Edit(begin + token.end, begin + token.end, CLOSING[tokens[opened[-1]].text]),)
