"""Faults as people and programs read them.

error[LAG0201]: `thet` is not declared
  --> pendulum.lag:7:38
   |
 7 |   body bob = Particle(mass = m, at = l*{sin(thet), 0, 0});
   |                                             ^^^^
   = help: did you mean `theta`?
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from lagc.base.text import one_line
from lagc.diagnostics.faults import Fault, Span

TAB = 4
WIDEST = 100  # columns of a source line that are shown; longer lines are windowed
MOST = 100  # faults that are shown in full

_COLORS = {
    "error": "\033[1;31m",
    "warning": "\033[1;33m",
    "help": "\033[1;36m",
    "frame": "\033[1;34m",
    "bold": "\033[1m",
}
_PLAIN_END = "\033[0m"


def report(faults: Sequence[Fault], color: bool = False, more: str = "") -> str:
    """Return all faults as text, in the order of their places, with a count and the text `more` at the
    end."""
    ordered = sorted(faults, key=_order)
    blocks = [_block(fault, color) for fault in ordered[:MOST]]
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
        }
        for fault in sorted(faults, key=_order)
    ]


def place(span: Span) -> dict[str, object]:
    """Return 1-based lines and columns; the end is the first character after the span."""
    line, column = span.source.place(span.start)
    end_line, end_column = span.source.place(span.end)
    return {
        "file": span.source.name,
        "line": line,
        "column": column,
        "end_line": end_line,
        "end_column": end_column,
    }


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


def _block(fault: Fault, color: bool) -> str:
    kind = _paint(f"{fault.severity}[{fault.code}]", fault.severity, color)
    head = f"{kind}: {_paint(one_line(fault.message), 'bold', color)}"
    lines = [head]
    spans = [*([fault.span] if fault.span else []), *(span for span, _ in fault.related)]
    width = max((len(str(span.line)) for span in spans), default=0) + 1
    if fault.span:
        lines += _snippet(fault.span, "-->", "^", "", width, fault.severity, color)
    before = fault.span
    for span, label in fault.related:
        snippet = _snippet(span, ":::", "-", label, width, "frame", color)
        lines += snippet[3:] if before is not None and _on_one_line(span, before) else snippet
        before = span
    if fault.remedy:
        lines.append(f"{' ' * (width + 1)}{_paint('= help:', 'help', color)} {one_line(fault.remedy)}")
    return "\n".join(lines)


def _on_one_line(span: Span, other: Span) -> bool:
    """Whether both spans are in the same line of text, which is then shown once."""
    if span.source is not other.source or span.line != other.line:
        return False
    return len(span.source.line(span.line)) <= WIDEST


def _snippet(span: Span, arrow: str, mark: str, label: str, width: int, tint: str, color: bool) -> list[str]:
    line, column = span.source.place(span.start)
    text = span.source.line(line)
    start = min(column - 1, len(text))
    end = max(start + 1, min(len(text), start + span.end - span.start))
    text, start, end = _window(text, start, end)
    shown, positions = _layout(text)
    run = mark * max(1, positions[min(end, len(text))] - positions[start])
    bar = _paint("|", "frame", color)
    margin = " " * (width + 1)
    under = f"{' ' * positions[start]}{_paint(run + (' ' + one_line(label) if label else ''), tint, color)}"
    return [
        f"{' ' * width}{_paint(arrow, 'frame', color)} {one_line(span.source.name)}:{line}:{column}",
        f"{margin}{bar}",
        f"{_paint(f'{line:>{width}}', 'frame', color)} {bar} {shown}",
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


def _paint(text: str, tint: str, color: bool) -> str:
    return f"{_COLORS[tint]}{text}{_PLAIN_END}" if color else text
