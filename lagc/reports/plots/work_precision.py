"""The work-precision diagram of a study: CPU time over error, a line for each method."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lagc.kernels import METHODS
from lagc.reports.cost import headline
from lagc.reports.plots.plot import COLORS, styled
from lagc.study.cost import Study

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.transforms import Bbox

MARKS = "osD^vPX"
# Of a label from its place, the best first: offset in points, horizontal and vertical alignment.
OFFSETS = [
    (dx * far, dy * far, ha, va)
    for far in (1.0, 2.0, 4.0)
    for dx, dy, ha, va in ((7, 3, "left", "bottom"), (-7, 3, "right", "bottom"), (0, -9, "center", "top"),
                           (7, -3, "left", "top"), (0, 9, "center", "bottom"))
]  # fmt: skip


class Label(NamedTuple):
    """Words for a curve, with the points at which they may stand, the best first."""

    words: str
    places: list[tuple[float, float]]
    color: str
    size: float


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
        labels = list[Label]()
        # From the back to the front: the front of all settings, lines by method, verified runs, advice.
        _front(axes, study)
        for method, color, mark in zip(METHODS, COLORS, MARKS):
            _method(axes, study, method, color, mark, labels)
        _verified(axes, study, labels)
        _advice(axes, study, labels)
        axes.margins(y=0.12)
        if study.reference is not None:
            axes.text(0.0, -0.16, f"reference: {study.reference.words}", transform=axes.transAxes,
                      fontsize=7.5, color="#555555")  # fmt: skip
        _write(figure, axes, labels)
        return figure


def _front(axes: Axes, study: Study) -> None:
    front = [p for p in study.front if p.error > 0.0]
    axes.step([p.error for p in front], [1e3 * p.seconds for p in front], where="post", color="#e0e0e0",
              linewidth=7.0, zorder=0)  # fmt: skip


def _method(axes: Axes, study: Study, method: str, color: str, mark: str, labels: list[Label]) -> None:
    own = [p for p in study.points if p.setting.method == method and p.error > 0.0]
    if not own:
        return
    x, y = [p.error for p in own], [1e3 * p.seconds for p in own]
    above = [[0.0] * len(own), [p.spread * t for p, t in zip(own, y)]]
    axes.errorbar(x, y, yerr=above, color=color, marker=mark, markersize=4.5, linewidth=1.2)
    name = f"{method} (fixed steps)" if own[0].setting.step else method
    labels.append(Label(name, [*zip(x, y)][::-1], color, 9.5))


def _verified(axes: Axes, study: Study, labels: list[Label]) -> None:
    own = [v for v in study.verified if v.error > 0.0]
    if own:
        axes.plot([v.error for v in own], [1e3 * v.seconds for v in own], linestyle="", marker="*",
                  markersize=11, color="#2e7d32")  # fmt: skip
        places = [(v.error, 1e3 * v.seconds) for v in sorted(own, key=lambda v: -v.seconds)]
        labels.append(Label("`lagc sim --accuracy`: all runs that verify", places, "#2e7d32", 9.5))


def _advice(axes: Axes, study: Study, labels: list[Label]) -> None:
    for a in study.advice:
        axes.axvline(a.target, color="#bbbbbb", linewidth=0.8, linestyle=":", zorder=0)
        if a.setting is None:
            continue
        x, y = a.target, 1e3 * a.seconds
        axes.plot([x], [y], marker="o", markersize=12, markerfacecolor="none", markeredgecolor="#b3261e",
                  linestyle="")  # fmt: skip
        words = f"for {a.target:.0e}: {a.setting.method}\n{a.setting}, {y:.2g} ms"
        labels.append(Label(words, [(x, y)], "#b3261e", 7.5))


def _write(figure: Figure, axes: Axes, labels: Sequence[Label]) -> None:
    """Write each label at one of its places, where it covers least of curves, bars and other labels."""
    figure.draw_without_rendering()  # places in pixels are known from here on
    curves = [line for line in axes.lines if line.get_linestyle() != ":"]  # not the lines of the targets
    paths: list[tuple[Any, Any]] = [(line, line.get_path()) for line in curves]
    paths += [(bars, bar) for bars in axes.collections for bar in bars.get_paths()]
    drawn = np.concatenate([_points(of.get_transform().transform(path.vertices)) for of, path in paths])
    boxes: list[Bbox] = []
    for label in labels:
        tried = list[tuple[float, int, Any, Any]]()
        for place, (dx, dy, ha, va) in product(label.places, OFFSETS):
            text = axes.annotate(label.words, place, (dx, dy), textcoords="offset points", ha=ha, va=va,
                                 color=label.color, fontsize=label.size)  # fmt: skip
            box = text.get_window_extent()
            inside = axes.bbox.containsx(box.x0) and axes.bbox.containsx(box.x1)
            covers = box.count_contains(drawn) + len(drawn) * (box.count_overlaps(boxes) + (not inside))
            tried.append((covers, len(tried), text, box))
        # Of equal ones the first, which is nearest to the end of a curve.
        _, best, _, box = min(tried)
        boxes.append(box)
        for _, k, text, _ in tried:
            if k != best:
                text.remove()


def _points(path: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points of a path in pixels, a few pixels apart."""
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    along = np.linspace(0.0, length[-1], 2 + int(length[-1] / 3.0))
    return np.column_stack([np.interp(along, length, column) for column in path.T])
