"""Faults, the exceptions that carry them, and reports of them for people and programs.

error[LAG0201]: `thet` is not declared
  --> pendulum.lag:7:38
   |
 7 |   body bob = Particle(mass = m, at = l*{sin(thet), 0, 0});
   |                                             ^^^^
   = help: did you mean `theta`?
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from lagc.base.records import dataclass
from lagc.base.text import one_line
from lagc.diagnostics.sources import WIDEST, paint, snippet
from lagc.diagnostics.sources import Source as Source
from lagc.diagnostics.sources import Span as Span


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
