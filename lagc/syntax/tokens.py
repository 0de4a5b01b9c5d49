"""The tokens of a text."""

from __future__ import annotations

from lagc.base.records import dataclass
from lagc.diagnostics.faults import Fault

WORD, NUMBER, STRING, UNIT, SYMBOL, END = "word", "number", "string", "unit", "symbol", "end"


class Token:
    """One token: its kind, its text, and the characters start..end of the source. `terminal` is set by the
    parser (`NAME`, `PARAMETER`, ...)."""

    __slots__ = ("end", "kind", "start", "terminal", "text")

    def __init__(self, kind: str, text: str, start: int, end: int):
        self.kind = kind
        self.text = text
        self.start = start
        self.end = end
        self.terminal = ""

    def __repr__(self) -> str:
        return f"{self.kind} {self.text!r} at {self.start}"


@dataclass(frozen=True, slots=True)
class Lexed:
    """The tokens of a text (the last is of kind END), its comments, and the faults."""

    tokens: list[Token]
    comments: list[Token]
    faults: list[Fault]
