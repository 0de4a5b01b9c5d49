"""The report of `lagc fit`: values with their intervals, as text and as plain data."""

from math import floor, inf, isfinite, log10
from typing import Any

from lagc.base.text import entry, printable, table
from lagc.study.fit import Fit


def text(found: Fit, heading: str) -> str:
    """Return the report for a terminal."""
    points = sum(len(m.values) for m in found.measured)
    percent = f"{100.0 * found.confidence:g} %"
    lines = [f"{heading}: {points} measured values, {found.evaluations} runs", ""]
    rows = []
    for p in found.parameters:
        value, half = rounded(found.values[p.name], found.intervals[p.name])
        rows.append([p.name, value, half, p.unit, f"{p.begin:.6g}"])
    lines += table(["", "value", f"+- ({percent})", "unit", "begun at"], rows)
    lines.append("")
    rows = []
    for m in found.measured:
        values = found.residuals[m.quantity]
        rows.append(
            [m.quantity, m.column, f"{found.sigmas[m.quantity]:.3g}", f"{abs(values).max():.3g}", m.unit]
        )
    lines += table(["residuals of", "column", "deviation", "largest", "unit"], rows)
    lines.append("")
    for sentence in found.unseen:
        lines += entry("warning", sentence)
    for note in found.notes:
        lines += entry("note", note)
    while not lines[-1]:
        lines.pop()
    return "\n".join(map(printable, lines)) + "\n"


def rounded(value: float, half: float) -> tuple[str, str]:
    """Return a value with the digits that its interval leaves, and the interval with two."""
    if not isfinite(half):
        return f"{value:.6g}", "not determined" if half == inf else "unknown"
    if half <= 0.0:
        return f"{value:.15g}", "0"
    digits = 1 - floor(log10(half))
    if not 0 <= digits <= 12 or abs(value) >= 1e6:
        return f"{value:.{max(floor(log10(abs(value) or 1.0)) + digits, 1)}e}", f"{half:.1e}"
    return f"{value:.{digits}f}", f"{half:.{digits}f}"


def to_dict(found: Fit) -> dict[str, Any]:
    """Return the object that `lagc fit --json` prints."""
    return {
        "converged": found.converged, "confidence": found.confidence, "freedom": found.freedom,
        "evaluations": found.evaluations,
        "parameters": [
            {"name": p.name, "value": found.values[p.name], "deviation": found.deviations[p.name],
             "interval": found.intervals[p.name], "unit": p.unit, "begin": p.begin}
            for p in found.parameters
        ],
        "correlation": [] if found.correlation is None else found.correlation.tolist(),
        "residuals": [
            {"quantity": m.quantity, "column": m.column, "unit": m.unit, "points": len(m.values),
             "deviation": found.sigmas[m.quantity], "largest": float(abs(found.residuals[m.quantity]).max())}
            for m in found.measured
        ],
        "unseen": list(found.unseen), "notes": list(found.notes),
    }  # fmt: skip
