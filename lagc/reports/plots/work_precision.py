"""The work-precision diagram of a study: CPU time over error, a line for each method."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lagc.kernels import METHODS
from lagc.reports.cost import headline
from lagc.reports.plots.plot import COLORS, styled
from lagc.study.advice import Point
from lagc.study.cost import Study

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MARKS = "osD^vPX"


def draw(study: Study, heading: str) -> Figure:
    """Return the figure.  Raises ImportError without matplotlib."""
    with styled():
        from matplotlib.figure import Figure

        figure = Figure(figsize=(9.0, 5.6), layout="constrained")
        axes = figure.subplots()
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.invert_xaxis()
        axes.set_title(f"{heading}, {study.stop:g} s: {headline(study)}", loc="left", fontsize=11)
        axes.set_xlabel(
            "error made (the largest of all quantities, relative to their ranges)    more exact \u2192"
        )
        axes.set_ylabel("CPU time, ms (least; bars to the median)")
        # From the back to the front: the front of all settings, lines by method, verified runs, advice.
        _front(axes, study)
        for method, color, mark in zip(METHODS, COLORS, MARKS):
            _method(axes, study, method, color, mark)
        _verified(axes, study)
        _advice(axes, study)
        axes.margins(y=0.12)
        if study.reference is not None:
            axes.text(0.0, -0.16, f"reference: {study.reference.words}", transform=axes.transAxes,
                      fontsize=7.5, color="#555555")  # fmt: skip
        return figure


def _front(axes: Axes, study: Study) -> None:
    front = [p for p in study.front if p.error > 0.0]
    axes.step([p.error for p in front], [1e3 * p.seconds for p in front], where="post", color="#e0e0e0",
              linewidth=7.0, zorder=0)  # fmt: skip


def _method(axes: Axes, study: Study, method: str, color: str, mark: str) -> None:
    own = [p for p in study.points if p.setting.method == method and p.error > 0.0]
    if not own:
        return
    x, y = [p.error for p in own], [1e3 * p.seconds for p in own]
    above = [[0.0] * len(own), [p.spread * t for p, t in zip(own, y)]]
    axes.errorbar(x, y, yerr=above, color=color, marker=mark, markersize=4.5, linewidth=1.2)
    name = f"{method} (fixed steps)" if own[0].setting.step else method
    beside = "right" if _crowded(study, own[-1]) else "left"
    axes.annotate(name, (x[-1], y[-1]), xytext=(7 if beside == "left" else -7, 3),
                  textcoords="offset points", color=color, ha=beside)  # fmt: skip


def _crowded(study: Study, last: Point) -> bool:
    """Whether the line of another method ends close to the right of a point."""
    ends = {p.setting.method: p for p in study.points if p.error > 0.0}.values()
    others = [p for p in ends if p.setting.method != last.setting.method]
    return any(1.0 < last.error / p.error < 1e3 and 0.5 < last.seconds / p.seconds < 2.0 for p in others)


def _verified(axes: Axes, study: Study) -> None:
    own = [v for v in study.verified if v.error > 0.0]
    if own:
        axes.plot([v.error for v in own], [1e3 * v.seconds for v in own], linestyle="", marker="*",
                  markersize=11, color="#2e7d32")  # fmt: skip
        dearest = max(own, key=lambda v: v.seconds)
        place, words = (0.99, 1e3 * dearest.seconds), "`lagc sim --accuracy`: all runs that verify"
        axes.annotate(words, place, xycoords=("axes fraction", "data"), xytext=(0, 10),
                      textcoords="offset points", ha="right", color="#2e7d32")  # fmt: skip


def _advice(axes: Axes, study: Study) -> None:
    for a in study.advice:
        axes.axvline(a.target, color="#bbbbbb", linewidth=0.8, linestyle=":", zorder=0)
        if a.setting is None:
            continue
        x, y = a.target, 1e3 * a.seconds
        axes.plot([x], [y], marker="o", markersize=12, markerfacecolor="none", markeredgecolor="#b3261e",
                  linestyle="")  # fmt: skip
        words = f"for {a.target:.0e}: {a.setting.method}\n{a.setting}, {y:.2g} ms"
        axes.annotate(words, (x, y), xytext=(0, -26), textcoords="offset points", ha="center", va="top",
                      fontsize=7.5, color="#b3261e")  # fmt: skip
