"""Texts, places in them, and the lines of a text with a place marked:

 --> pendulum.lag:7:38
  |
7 |   body bob = Particle(mass = m, at = l*{sin(thet), 0, 0});
  |                                             ^^^^
"""

from __future__ import annotations

from bisect import bisect_right
from functools import cached_property

from lagc.base.records import dataclass, field
from lagc.base.text import one_line

TAB = 4
WIDEST = 100  # columns of a source line that are shown; longer lines are windowed

_COLORS = {
    "error": "\033[1;31m",
    "warning": "\033[1;33m",
    "help": "\033[1;36m",
    "frame": "\033[1;34m",
    "bold": "\033[1m",
}
_PLAIN_END = "\033[0m"


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


def snippet(span: Span, arrow: str, mark: str, label: str, width: int, tint: str, color: bool) -> list[str]:
    """Return the place, and the line of text with the place marked and labelled."""
    line, column = span.source.place(span.start)
    text = span.source.line(line)
    start = min(column - 1, len(text))
    end = max(start + 1, min(len(text), start + span.end - span.start))
    text, start, end = _window(text, start, end)
    shown, positions = _layout(text)
    run = mark * max(1, positions[min(end, len(text))] - positions[start])
    bar = paint("|", "frame", color)
    margin = " " * (width + 1)
    under = f"{' ' * positions[start]}{paint(run + (' ' + one_line(label) if label else ''), tint, color)}"
    return [
        f"{' ' * width}{paint(arrow, 'frame', color)} {one_line(span.source.name)}:{line}:{column}",
        f"{margin}{bar}",
        f"{paint(f'{line:>{width}}', 'frame', color)} {bar} {shown}",
        f"{margin}{bar} {under}",
    ]


def _window(text: str, start: int, end: int) -> tuple[str, int, int]:
    """Return the part of a long line around start..end, and the positions of these in it."""
    if len(text) <= WIDEST:
        return text, start, end
    end = min(end, start + WIDEST - 20)
    first = max(0, min(start - 20, len(text) - WIDEST))
    last = min(len(text), first + WIDEST)
    before, after = "..." if first > 0 else "", "..." if last < len(text) else ""
    return before + text[first:last] + after, start - first + len(before), end - first + len(before)


def _layout(text: str) -> tuple[str, list[int]]:
    """Return the text with tabs expanded and control characters replaced, and the terminal column of each
    character."""
    shown: list[str] = []
    positions: list[int] = []
    column = 0
    for char in text:
        positions.append(column)
        if char == "\t":
            step = TAB - column % TAB
            shown.append(" " * step)
            column += step
        elif char.isascii():
            shown.append(char if char.isprintable() else "?")
            column += 1
        else:
            shown.append(char if char.isprintable() or _cells(char) == 0 else "\N{REPLACEMENT CHARACTER}")
            column += _cells(char)
    positions.append(column)
    return "".join(shown), positions


def _cells(char: str) -> int:
    """Return the number of terminal columns of a character."""
    import unicodedata

    if unicodedata.category(char) in ("Mn", "Me"):
        return 0
    return 2 if unicodedata.east_asian_width(char) in ("W", "F") else 1


def paint(text: str, tint: str, color: bool) -> str:
    """Return `text` in a colour of the terminal, if `color`."""
    return f"{_COLORS[tint]}{text}{_PLAIN_END}" if color else text
