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

from lagc.diagnostics.faults import Fault
from lagc.diagnostics.sources import Span

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
