"""The report as text, and the files of the documentation that `--write` makes."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from math import exp, log
from pathlib import Path
from textwrap import fill

from tools.benchmarks.measured import TARGETS, Line, Part, Report, power
from tools.benchmarks.pictures import asked_and_got, made, shown, svg, work_precision
from tools.benchmarks.tables import Cell, table
from tools.benchmarks.tools import TOOLS

ROOT = Path(__file__).parents[2]
BEGIN, END = "<!-- benchmarks -->", "<!-- end of benchmarks -->"
OWN = [tool.name for tool in TOOLS if tool.package is None and not tool.asks]
ASKS = next(tool.name for tool in TOOLS if tool.asks)
NOTE = 60  # letters of the reason why a tool has no more points
WORDS = ("none", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")


def text(report: Report) -> None:
    """Print the report."""
    print(f"{report.machine}\n{report.day}, " + ", ".join(f"{k} {v}" for k, v in report.versions.items()))
    for package, reason in report.missing.items():
        print(f"{package}: {reason}")
    for part in report.parts:
        head = ["", "s to ready", *(f"ms to {power(t)}" for t in TARGETS)]
        head += [*(f"{power(t)} gives" for t in TARGETS), ""]
        title = f"{part.title} (reference known to {power(part.agreement)})"
        table(title, head, [_row(line) for line in part.lines if line.dots])
        without = [f"{line.tool}: {line.note}" for line in part.lines if not line.dots]
        if without:
            print(f"  without {'; '.join(without)}")
    rows: list[list[Cell]] = []
    for name in shown(report):
        pairs = made(report, name)
        for target in TARGETS:
            ratios = [error / t for t, error in pairs if t == target]
            if ratios:
                kept = sum(r <= 1.0 for r in ratios)
                spread = min(ratios), mean(ratios), max(ratios)
                rows.append([name, power(target), f"{kept} of {len(ratios)}", *spread])
    table("Error made over tolerance given", ["", "asked", "kept", "least", "mean", "most"], rows)
    print(fill(ahead(report), 110) + "\n\n" + fill(kept_words(report), 110))


def _row(line: Line) -> list[Cell]:
    times = [line.fastest(target) for target in TARGETS]
    gives = [line.made(target) for target in TARGETS]
    return [line.tool, line.ready, *(t and 1e3 * t for t in times),
            *(None if e is None else power(e) for e in gives), line.note[:NOTE]]  # fmt: skip


def mean(values: Sequence[float]) -> float:
    """The geometric mean."""
    return exp(sum(map(log, values)) / len(values)) if values else 0.0


def _fastest(part: Part, target: float, own: bool) -> tuple[float, str] | None:
    found = [
        (seconds, line.tool)
        for line in part.lines
        for seconds in [line.fastest(target)]
        if seconds is not None and line.tool != ASKS and (line.tool in OWN) == own
    ]
    return min(found, default=None)


def ahead(report: Report, target: float = 1e-9) -> str:
    """The sentence on the fastest tools."""
    won, lost = 0, dict[str, list[float]]()
    for part in report.parts:
        own, other = (_fastest(part, target, mine) for mine in (True, False))
        if own is not None and (other is None or own[0] <= other[0]):
            won += 1
        elif other is not None:
            lost.setdefault(other[1], []).append(own[0] / other[0] if own else float("inf"))
    words = [f"{name} on {WORDS[len(r)]} ({_ratios(r)})" for name, r in lost.items()]
    sentence = f"To an error of {power(target)}, lagc's C with a tolerance set by hand is the fastest on "
    sentence += f"{WORDS[won]} of {WORDS[len(report.parts)]} problems"
    return sentence + (f"; faster are {' and '.join(words)}." if words else ".")


def _ratios(values: Sequence[float]) -> str:
    low, high = f"{min(values):.1f}", f"{max(values):.1f}"
    if high == "inf":  # lagc does not reach the error
        return "alone" if low == "inf" else f"{low} times or more"
    return f"{low} times" if low == high else f"{low} to {high} times"


def kept_words(report: Report) -> str:
    """The sentence on the accuracy that was asked for."""
    counts = {name: made(report, name) for name in shown(report)}
    kept = {name: sum(error <= t for t, error in pairs) for name, pairs in counts.items() if pairs}
    if ASKS not in kept:
        return ""
    targets = ", ".join(map(power, TARGETS))
    words = f"Of the errors {targets} asked for, lagc's `accuracy=` keeps {kept[ASKS]} of {len(counts[ASKS])}"
    most = max((len(counts[name]) for name in kept), default=0)
    others = [name for name in kept if name not in (*OWN, ASKS)]
    best = max((n for n in others if 2 * len(counts[n]) >= most), key=lambda n: kept[n], default=None)
    if best is not None:
        rest = [name for name in others if name != best]
        words += f"; with such a tolerance {best} keeps {kept[best]} of {len(counts[best])}"
        words += f", the other tools {sum(kept[n] for n in rest)} of {sum(len(counts[n]) for n in rest)}"
    return words + "."


def of_readme(report: Report) -> str:
    """The text of the README between the markers."""
    first = (
        f"CPU time and true error on {WORDS[len(report.parts)]} problems, by `python -m tools.benchmarks` on "
        f"{report.day} ({report.machine}, gcc -O2). Other tools get the equations as a person writes them. "
    )
    lines = [
        BEGIN, "", "![CPU time over the error made, for each problem and tool](docs/work-precision.svg)", "",
        fill(first + ahead(report), 110), "",
        "![the error made over the tolerance given, for each tool](docs/asked-and-got.svg)", "",
        fill("A tolerance is not the error of the result. " + kept_words(report), 110), "", END,
    ]  # fmt: skip
    return "\n".join(lines)


def numbers(report: Report) -> str:
    """All numbers as JSON, a line for each tool and problem."""
    return re.sub(r'(\{"(?:tool|name)")', r"\n\1", json.dumps(report.to_dict())) + "\n"


def write(report: Report) -> list[Path]:
    """Write the pictures, the numbers and the README."""
    docs, readme = ROOT / "docs", ROOT / "README.md"
    files = {
        docs / "work-precision.svg": svg(work_precision(report)),
        docs / "asked-and-got.svg": svg(asked_and_got(report)),
        docs / "benchmarks.json": numbers(report).encode(),
    }
    before, _, rest = readme.read_text(encoding="utf-8").partition(BEGIN)
    after = rest.partition(END)[2]
    files[readme] = (before + of_readme(report) + after).encode()
    for path, data in files.items():
        path.write_bytes(data)
    return list(files)
