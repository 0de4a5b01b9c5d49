"""The two pictures of the report: work and precision, and the accuracy asked for beside the error made."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

from lagc.reports.plots.plot import styled
from tools.benchmarks.measured import TARGETS, Part, Report, power

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Color, mark, dashes and width of each tool: lagc in blue, the tools around one right-hand side in one color.
LOOKS = {
    "lagc, C, dop853": ("#0072b2", "o", "-", 2.2),
    "lagc, C, radau5": ("#0072b2", "s", "--", 2.2),
    "lagc, C, taylor": ("#0072b2", "D", "-.", 2.2),
    "lagc, accuracy=": ("#0072b2", "*", ":", 0.8),
    "heyoka": ("#d55e00", "D", "-", 1.3),
    "casadi's C in DOP853": ("#009e73", "^", "-", 1.3),
    "casadi, CVODES": ("#009e73", "v", "--", 1.3),
    "scikit-sundae, CVODE": ("#cc79a7", "P", "--", 1.3),
    "SciPy, DOP853": ("#7f7f7f", "^", "-", 1.3),
    "SciPy, LSODA": ("#7f7f7f", "v", "--", 1.3),
    "SciPy, Radau": ("#7f7f7f", "s", ":", 1.3),
    "rumoca": ("#e69f00", "X", "-", 1.3),
}
USUAL = ("#000000", "x", "-", 1.3)
COARSEST, FINEST = 2.0, 1e-14
COLUMNS = 4
LEAST, MOST = 1e-4, 1e6  # error over tolerance, as far as it is drawn
SHADES = ("#56b4e9", "#0072b2", "#003f63")  # of the targets, the finest darkest


def shown(report: Report) -> list[str]:
    """The tools with results, in the order of the report."""
    names = dict.fromkeys(line.tool for part in report.parts for line in part.lines)
    return [name for name in names if any(part.line(name) for part in report.parts)]


def work_precision(report: Report) -> Figure:
    """CPU time over the error made: a panel for each problem, a line for each tool."""
    with styled():
        from matplotlib.figure import Figure

        columns = min(COLUMNS, len(report.parts))
        rows = -(-len(report.parts) // columns)
        figure = Figure(figsize=(3.3 * columns, 2.9 * rows + 1.3), layout="constrained", facecolor="white")
        panels = figure.subplots(rows, columns, squeeze=False).ravel()
        for axes, part in zip(panels, report.parts):
            _panel(axes, part)
        for k, axes in enumerate(panels):
            if k >= len(report.parts):
                axes.set_axis_off()
            if k % columns == 0:
                axes.set_ylabel("CPU time, ms")
            if k + columns >= len(report.parts):
                axes.set_xlabel("error made, of the range \u2192 more exact")
        handles = {str(line.get_label()): line for axes in panels for line in axes.get_lines()}
        names = [name for name in shown(report) if name in handles]
        figure.legend([handles[name] for name in names], names, loc="outside lower center", ncols=columns + 1,
                      frameon=False, fontsize=9)  # fmt: skip
        return figure


def _panel(axes: Axes, part: Part) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    for line in part.lines:
        dots = [d for d in line.dots if d.error < COARSEST]
        color, mark, dashes, width = LOOKS.get(line.tool, USUAL)
        if dots:
            errors, times = [max(d.error, FINEST) for d in dots], [1e3 * d.seconds for d in dots]
            axes.plot(errors, times, color=color, marker=mark, linestyle=dashes, linewidth=width,
                      markersize=7 if mark == "*" else 3.5, label=line.tool,
                      zorder=3 if width > 2.0 else 2)  # fmt: skip
    axes.set_xlim(COARSEST, 0.5 * FINEST)
    axes.set_xticks([1.0, 1e-3, 1e-6, 1e-9, 1e-12])
    axes.minorticks_off()
    axes.set_title(part.title, loc="left", fontsize=10)


def asked_and_got(report: Report) -> Figure:
    """The error made over the tolerance given: a row for each tool, a dot for each problem."""
    with styled():
        from matplotlib.figure import Figure

        names = [name for name in shown(report) if made(report, name)]
        figure = Figure(figsize=(9.5, 0.52 * len(names) + 1.4), layout="constrained", facecolor="white")
        axes = figure.subplots()
        axes.set_xscale("log")
        axes.axvspan(1.0, MOST, color="#f7e3dc", zorder=0)
        axes.axvline(1.0, color="#b3261e", linewidth=1.0)
        for row, name in enumerate(names):
            _row(axes, row, made(report, name))
        place = axes.get_yaxis_transform()
        axes.text(1.01, -0.85, "kept", transform=place, va="center", fontsize=9, weight="bold")
        axes.set_yticks(range(len(names)), names, fontsize=9)
        axes.set_ylim(len(names) - 0.5, -0.6)
        axes.set_xlim(LEAST, MOST)
        axes.grid(axis="y", visible=False)
        axes.set_xlabel("error made / tolerance given    (right of the line: worse than asked)")
        handles, labels = axes.get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper left", ncols=3, frameon=False)
        return figure


def _row(axes: Axes, row: int, found: list[tuple[float, float]]) -> None:
    for k, (target, color) in enumerate(zip(TARGETS, SHADES)):
        values = [min(max(error / t, LEAST), MOST) for t, error in found if t == target]
        axes.plot(values, [row + 0.24 * (k - 1)] * len(values), linestyle="", marker="o", markersize=5,
                  color=color, alpha=0.75, label=f"{power(target)} asked" if row == 0 else None)  # fmt: skip
    kept = sum(error <= t for t, error in found)
    words = f"{kept} of {len(found)}"
    axes.text(1.01, row, words, transform=axes.get_yaxis_transform(), va="center", fontsize=9)


def made(report: Report, tool: str) -> list[tuple[float, float]]:
    """Tolerance and error of the tool at all targets and problems."""
    lines = [line for line in (part.line(tool) for part in report.parts) if line is not None]
    pairs = [(target, line.made(target)) for line in lines for target in TARGETS]
    return [(target, error) for target, error in pairs if error is not None]


def svg(figure: Figure) -> bytes:
    """The same bytes for the same figures."""
    buffer = io.BytesIO()
    with styled():
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    return buffer.getvalue()
