"""The picture of hard cases: measured over required for each figure, and the motion of a single case."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lagc.reports.hard import NAMES, headline
from lagc.reports.plots.plot import COLORS, by_unit, shown_names, styled
from lagc.study.hard.case import Hard

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

KEPT, UNMET = "#1b7f4b", "#b3261e"
LEAST = 1e-6  # of the required value: smaller shares are drawn there
MOST_PANELS = 3  # of the motion


def draw(found: Hard, heading: str) -> Figure:
    """Return the figure.  Raises ImportError without matplotlib."""
    with styled():
        from matplotlib.figure import Figure

        cases = list(dict.fromkeys(row.case.name for row in found.rows))
        runs = [row.found.run for row in found.rows if row.found and row.found.run] if len(cases) == 1 else []
        groups = by_unit(runs[0], shown_names(runs[0])) if runs and len(runs[0].times) > 2 else {}
        shown = list(groups.items())[:MOST_PANELS]
        labels = list(dict.fromkeys(f"{r.case.name}: {f.words}" for r in found.rows for f in r.case.figures))
        # A line for each figure; the motion is drawn below where a single case is shown.
        height = 0.8 + 0.24 * max(len(labels), 2)
        figure = Figure(figsize=(10.0, height + 2.0 * len(shown) + 0.6), layout="constrained")
        panels = figure.subplots(
            1 + len(shown), 1, squeeze=False, height_ratios=[height, *[2.0 for _ in shown]]
        )
        figure.suptitle(f"{heading}: {headline(found)}", fontsize=10, wrap=True)
        _figures(panels[0][0], found, labels)
        for (axes,), (unit, names) in zip(panels[1:], shown):
            for color, name in zip(COLORS, names):
                axes.plot(runs[0].t, runs[0][name], color=color, label=name)
            axes.set_ylabel(f"[{unit}]" if unit else "")
            axes.legend(fontsize=7.5, loc="center left", bbox_to_anchor=(1.0, 0.5))
            axes.set_xlabel("time [s]")
        return figure


def _figures(axes: Axes, found: Hard, labels: list[str]) -> None:
    axes.set_xscale("log")
    axes.axvline(1.0, color="#666666", linewidth=1.0)
    for marker, backend, offset in zip("os", found.backends, (-0.15, 0.15)):
        axes.plot([], [], marker, color="#666666", markersize=4, label=NAMES[backend])
        for row in found.rows:
            if row.backend != backend or row.found is None:
                continue
            for figure, value in zip(row.case.figures, row.found.values):
                if value is None:
                    continue
                share = value / figure.most if figure.most else (10.0 if value else LEAST)
                at = labels.index(f"{row.case.name}: {figure.words}") + offset
                color = KEPT if value <= figure.most else UNMET
                axes.plot([max(share, LEAST)], [at], marker, color=color, markersize=4)
    axes.set_yticks(range(len(labels)), labels, fontsize=7.5)
    axes.set_ylim(len(labels) - 0.4, -0.6)
    axes.set_xlim(left=LEAST / 3.0)
    axes.set_xlabel(f"measured over required (1: the figure itself; below {LEAST:g} drawn there)")
    axes.legend(fontsize=7.5, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2)
