"""Tables of benchmark scripts."""

from __future__ import annotations

import os
import platform
from collections.abc import Sequence
from pathlib import Path

Cell = str | float | int | None


def machine() -> str:
    cpu = platform.processor() or platform.machine()
    info = Path("/proc/cpuinfo")
    if info.exists():
        names = [line for line in info.read_text().splitlines() if line.startswith("model name")]
        if names:
            cpu = names[0].split(":", 1)[1].strip()
    return f"{cpu}, {os.cpu_count()} cores, Python {platform.python_version()}"


def show(value: Cell) -> str:
    if value is None:
        return "-"
    if isinstance(value, float):
        return f"{value:.3g}"
    return str(value)


def table(title: str, head: Sequence[str], rows: Sequence[Sequence[Cell]]) -> None:
    """Print an aligned table."""
    cells = [list(head), *[[show(c) for c in row] for row in rows]]
    widths = [max(len(row[k]) for row in cells) for k in range(len(head))]
    print(f"\n{title}\n")
    for number, row in enumerate(cells):
        print(
            "  "
            + "  ".join(c.ljust(w) if k == 0 else c.rjust(w) for k, (c, w) in enumerate(zip(row, widths)))
        )
        if number == 0:
            print("  " + "  ".join("-" * w for w in widths))
    print(flush=True)
