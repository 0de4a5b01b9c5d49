"""Texts and places in them, faults, the exceptions that carry them, and reports for people and programs.

error[LAG0201]: `thet` is not declared
  --> pendulum.lag:7:38
   |
 7 |   body bob = Particle(mass = m, at = l*{sin(thet), 0, 0});
   |                                             ^^^^
   = help: did you mean `theta`?
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Sequence
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


@dataclass(frozen=True, slots=True)
class Edit:
    """The characters start..end of a text become `text`."""

    start: int
    end: int
    text: str


@dataclass(frozen=True, slots=True)
class Fault:
    """One fault: a message for the user. `code` is stable (`LAG0123`) and listed in
    `lagc.diagnostics.catalogue`; `related` are further places, each with a short label; `edits` of the text
    with the fault probably give what was meant."""

    code: str
    message: str
    span: Span | None = None
    related: tuple[tuple[Span, str], ...] = ()
    remedy: str | None = None
    severity: str = "error"  # or "warning"
    edits: tuple[Edit, ...] = ()

    @property
    def file(self) -> str | None:
        return self.span.source.name if self.span else None

    @property
    def line(self) -> int | None:
        return self.span.line if self.span else None

    @property
    def column(self) -> int | None:
        return self.span.column if self.span else None

    def __str__(self) -> str:
        return f"{self.code}: {self.message}" + (f" ({self.remedy})" if self.remedy else "")

    def shown(self, color: bool = False, head: str = "") -> str:
        """Return the fault in lines: the message after `head`, the places with carets, the remedy."""
        head = head or paint(f"{self.severity}[{self.code}]", self.severity, color)
        lines = [f"{head}: {paint(one_line(self.message), 'bold', color)}"]
        spans = [*([self.span] if self.span else []), *(span for span, _ in self.related)]
        width = max((len(str(span.line)) for span in spans), default=0) + 1
        if self.span:
            lines += snippet(self.span, "-->", "^", "", width, self.severity, color)
        before = self.span
        for span, label in self.related:
            more = snippet(span, ":::", "-", label, width, "frame", color)
            lines += more[3:] if before is not None and _on_one_line(span, before) else more
            before = span
        if self.remedy:
            lines.append(f"{' ' * (width + 1)}{paint('= help:', 'help', color)} {one_line(self.remedy)}")
        return "\n".join(lines)


def _on_one_line(span: Span, other: Span) -> bool:
    """Return whether both spans are in the same line of text, which is then shown once."""
    if span.source is not other.source or span.line != other.line:
        return False
    return len(span.source.line(span.line)) <= WIDEST


class Refused(Exception):
    """The model or the request is refused because of `faults`.

    `code`, `file`, `line`, `column` and `remedy` are those of the first one.
    """

    def __init__(self, faults: list[Fault] | tuple[Fault, ...]):
        self.faults = tuple(faults)
        super().__init__(self.faults)

    def __str__(self) -> str:
        return "\n\n".join(fault.shown(head=fault.code) for fault in self.faults)

    @property
    def code(self) -> str | None:
        return self.faults[0].code if self.faults else None

    @property
    def file(self) -> str | None:
        return self.faults[0].file if self.faults else None

    @property
    def line(self) -> int | None:
        return self.faults[0].line if self.faults else None

    @property
    def column(self) -> int | None:
        return self.faults[0].column if self.faults else None

    @property
    def remedy(self) -> str | None:
        return self.faults[0].remedy if self.faults else None

    def __reduce__(self) -> tuple[type[Refused], tuple[tuple[Fault, ...]]]:
        return type(self), (self.faults,)


MOST = 100  # faults that are shown in full


def report(faults: Sequence[Fault], color: bool = False, more: str = "") -> str:
    """Return all faults as text, in the order of their places, with a count and the text `more` at the
    end."""
    ordered = sorted(faults, key=_order)
    blocks = [fault.shown(color) for fault in ordered[:MOST]]
    if len(ordered) > MOST:
        blocks.append(f"... and {len(ordered) - MOST} more")
    if len(ordered) > 1 or more:
        blocks.append("; ".join(filter(None, [_count(ordered), more])))
    return "\n\n".join(blocks)


def as_json(faults: Iterable[Fault]) -> list[dict[str, object]]:
    """Return faults as plain data: code, severity, message, place, related places, remedy."""
    return [
        {
            "code": fault.code,
            "severity": fault.severity,
            "message": fault.message,
            **(place(fault.span) if fault.span else {"file": None}),
            "related": [{"label": label, **place(span)} for span, label in fault.related],
            "remedy": fault.remedy,
            "edits": [{**place(span), "text": text} for span, text in _edited(fault)],
        }
        for fault in sorted(faults, key=_order)
    ]


def _edited(fault: Fault) -> list[tuple[Span, str]]:
    return [(Span(fault.span.source, e.start, e.end), e.text) for e in fault.edits if fault.span]


def place(span: Span) -> dict[str, object]:
    """Return 1-based lines and columns; the end is the first character after the span."""
    line, column = span.source.place(span.start)
    end_line, end_column = span.source.place(span.end)
    end = {"end_line": end_line, "end_column": end_column}
    return {"file": span.source.name, "line": line, "column": column, **end}


def _order(fault: Fault) -> tuple[bool, str, int]:
    span = fault.span
    return (span is None, span.source.name, span.start) if span else (True, "", 0)


def _count(faults: Sequence[Fault]) -> str:
    errors = sum(1 for fault in faults if fault.severity == "error")
    warnings = len(faults) - errors
    words = []
    if errors:
        words.append(f"{errors} error{'s' if errors > 1 else ''}")
    if warnings:
        words.append(f"{warnings} warning{'s' if warnings > 1 else ''}")
    return ", ".join(words)


class Wrong(Exception):
    """A fault ends the evaluation."""

    def __init__(
        self, code: str, message: str, span: Span | None, remedy: str | None = None,
        related: tuple[tuple[Span, str], ...] = (),
    ):  # fmt: skip
        self.fault = Fault(code, message, span, related, remedy, edits=_meant(span, remedy))
        super().__init__(message)


def _meant(span: Span | None, remedy: str | None) -> tuple[Edit, ...]:
    """Return the edit of a remedy that names the unit or the name that was meant: "did you mean `theta`?". Of
    a path `a.b`, it is the last name."""
    if span is None or remedy is None:
        return ()
    words, _, rest = remedy.partition("`")
    text, _, rest = rest.partition("`")
    if (words, rest) != ("did you mean ", "?") and (words, text[:1], rest) != ("write ", "[", ""):
        return ()
    before = 0 if "." in text or text[:1] == "[" else span.text.rfind(".") + 1
    return (Edit(span.start + before, span.end, text),)


class Poisoned(Exception):
    """The evaluation ends because of a fault that is already reported."""


# -- lines of a text with a place marked --


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
        # A caret stands below its character: tabs go to the next stop, wide characters take two cells.
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
