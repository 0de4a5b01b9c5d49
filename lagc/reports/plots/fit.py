"""A fit: for each quantity the measured values with the motion, and below them the residuals."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lagc.reports.plots.plot import COLORS, styled
from lagc.study.fit import Fit

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def draw(found: Fit, heading: str = "") -> Figure:
    """Return the figure.  Raises ImportError without matplotlib."""
    with styled():
        from matplotlib.figure import Figure

        count = len(found.measured)
        figure = Figure(figsize=(8.0, 0.6 + 3.6 * count), layout="constrained")
        panels = figure.subplots(2 * count, 1, sharex=True, squeeze=False, height_ratios=[2, 1] * count)[:, 0]
        for motion, rest, m in zip(panels[::2], panels[1::2], found.measured):
            residuals, sigma = found.residuals[m.quantity], found.sigmas[m.quantity]
            if found.run is not None:
                motion.plot(
                    found.run.times, found.run.column(m.quantity), color=COLORS[0], label="fitted motion"
                )
            motion.plot(m.times, m.values, ".", color=COLORS[1], label=f"measured, {m.column}")
            motion.set_ylabel(f"{m.quantity}, {m.unit}" if m.unit else m.quantity)
            motion.legend()
            rest.axhspan(-sigma, sigma, color=COLORS[0], alpha=0.15, linewidth=0.0)
            rest.plot(m.times, residuals, ".", color=COLORS[1])
            rest.axhline(0.0, color="0.5", linewidth=0.8)
            rest.set_ylabel("measured - fitted")
        panels[-1].set_xlabel("time, s")
        if heading:
            figure.suptitle(heading, fontsize=11)
        return figure
