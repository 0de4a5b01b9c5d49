"""Scenes side by side: a panel for each quantity, a line for each scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lagc.reports.compare import COLUMNS, Compared
from lagc.reports.plots.plot import COLORS, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def draw(found: Compared) -> Figure:
    """Return the figure.  Raises ImportError without matplotlib."""
    with styled():
        from matplotlib.figure import Figure

        names = found.names[:COLUMNS]
        figure = Figure(figsize=(8.0, 1.2 + 1.9 * max(len(names), 1)), layout="constrained")
        panels = figure.subplots(max(len(names), 1), 1, sharex=True, squeeze=False)[:, 0]
        units = found.runs[0].units
        for axes, name in zip(panels, names):
            for k, (scene, run) in enumerate(zip(found.scenes, found.runs)):
                style = ("-", "--", ":", "-.")[k // len(COLORS) % 4]
                axes.plot(run.times, run.column(name), color=COLORS[k % len(COLORS)], linestyle=style,
                          label=scene)  # fmt: skip
            axes.set_ylabel(f"{name}, {units[name]}" if units.get(name) else name)
        panels[-1].set_xlabel("time, s")
        figure.suptitle(found.runs[0].system.interface.model, fontsize=11)
        figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
        return figure
