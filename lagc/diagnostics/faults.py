"""Faults and places in texts."""

from __future__ import annotations

from bisect import bisect_right
from functools import cached_property

from lagc.base.records import dataclass, field


@dataclass(frozen=True)
class Source:
    """A text and its name for messages.  `asked`: it comes from a command or a caller, not from a file."""

    name: str
    text: str = field(repr=False)
    asked: bool = field(default=False, repr=False)

    @cached_property
    def line_starts(self) -> tuple[int, ...]:
        starts = [0]
        for offset, char in enumerate(self.text):
            if char == "\n":
                starts.append(offset + 1)
        return tuple(starts)

    def place(self, offset: int) -> tuple[int, int]:
        """Return the 1-based line and column (in characters) of `offset`."""
        line = bisect_right(self.line_starts, offset)
        return line, offset - self.line_starts[line - 1] + 1

    def line(self, number: int) -> str:
        start = self.line_starts[number - 1]
        end = self.text.find("\n", start)
        return self.text[start : len(self.text) if end < 0 else end].rstrip("\r")


@dataclass(frozen=True, slots=True)
class Span:
    """Characters start..end (end excluded) of a source."""

    source: Source = field(repr=False)
    start: int
    end: int

    @property
    def line(self) -> int:
        return self.source.place(self.start)[0]

    @property
    def column(self) -> int:
        return self.source.place(self.start)[1]

    @property
    def text(self) -> str:
        return self.source.text[self.start : self.end]

    def to(self, other: Span) -> Span:
        return Span(self.source, self.start, max(self.end, other.end))

    def __str__(self) -> str:
        return f"{self.source.name}:{self.line}:{self.column}"


@dataclass(frozen=True, slots=True)
class Fault:
    """One fault: a message for the user. `code` is stable (`LAG0123`) and listed in
    `lagc.diagnostics.catalogue`; `related` are further places, each with a short label."""

    code: str
    message: str
    span: Span | None = None
    related: tuple[tuple[Span, str], ...] = ()
    remedy: str | None = None
    severity: str = "error"  # or "warning"

    def __str__(self) -> str:
        return f"{self.code}: {self.message}" + (f" ({self.remedy})" if self.remedy else "")


class Refused(Exception):
    """The model is refused because of `faults`."""

    def __init__(self, faults: list[Fault] | tuple[Fault, ...]):
        self.faults = tuple(faults)
        super().__init__("; ".join(map(str, self.faults)))

    def __reduce__(self) -> tuple[type[Refused], tuple[tuple[Fault, ...]]]:
        return type(self), (self.faults,)
