"""The picture of a study of effects: what each changes over what it costs, and the cheapest scenes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lagc.reports.effects import headline
from lagc.reports.plots.plot import styled
from lagc.study.effects import AS_LONG, Change, Effects

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SAVES, COSTS, SAME = "#1b7f4b", "#b3261e", "#34495e"
LIGHT = "#b8cfe5"
LONG = 44  # characters of a list of names


def draw(found: Effects, heading: str) -> Figure:
    """Return the figure.  Raises ImportError without matplotlib."""
    with styled():
        from matplotlib.figure import Figure

        figure = Figure(figsize=(13.0, 5.8), layout="constrained")
        left, right = figure.subplots(1, 2, width_ratios=(1.0, 1.0))
        figure.suptitle(f"{heading}, {found.stop:g} s: {headline(found)}", fontsize=11)
        _singles(left, found)
        _sets(right, found)
        return figure


def _singles(axes: Axes, found: Effects) -> None:
    shown = [one for one in found.left_out if one.change]
    axes.set_title("Each effect left out alone", loc="left", fontsize=10)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_ylim(*_limits([one.change or 1.0 for one in shown] + [choice.accuracy for choice in found.sets]))
    axes.set_ylabel("change, relative to the range (largest over time)")
    axes.set_xlabel(
        "time of a run without the effect (full scene: 1)\n\u2190 saves time        costs time \u2192"
    )
    axes.axvline(1.0, color="#999999", linewidth=0.8, linestyle=":")
    for choice in found.sets:
        axes.axhline(choice.accuracy, color="#cccccc", linewidth=0.8, zorder=0)
    # Labels of changes within half a decade move apart.
    taken: list[float] = []
    for one in sorted(shown, key=lambda one: -(one.change or 0.0)):
        assert one.change is not None
        axes.plot([one.time], [one.change], marker="o", markersize=7, color=_color(one), linestyle="")
        near = sum(1 for other in taken if 0.3 < other / one.change < 3.3)
        taken.append(one.change)
        axes.annotate(one.effect, (one.time, one.change), xytext=(8, -4 - 10 * near),
                      textcoords="offset points", fontsize=8.5, color=_color(one))  # fmt: skip
    axes.margins(x=0.25)
    low, high = axes.get_xlim()
    axes.set_xlim(min(low, 0.5), max(high, 2.0))


def _limits(values: list[float]) -> tuple[float, float]:
    return (min(values, default=1e-6) / 4.0, max(values, default=1.0) * 4.0)


def _color(one: Change) -> str:
    if one.time < 1.0 - AS_LONG:
        return SAVES
    return COSTS if one.time > 1.0 + AS_LONG else SAME


def _sets(axes: Axes, found: Effects) -> None:
    axes.set_title("The cheapest scene that keeps an accuracy (each was run)", loc="left", fontsize=10)
    axes.set_xlabel("part of the full scene")
    axes.grid(visible=False)
    axes.set_ylabel("accuracy asked")
    ticks = range(len(found.sets))
    for k, one in enumerate(found.sets):
        part = one.operations / max(found.operations, 1)
        axes.barh(k - 0.2, part, height=0.36, color=LIGHT)
        axes.barh(k + 0.2, one.time, height=0.36, color=SAME)
        out = ", ".join(one.left_out)
        out = out if len(out) <= LONG else f"{len(one.left_out)} of {len(found.effects)} effects"
        words = f"without {out}\nchange {one.change:.1e}" if out else "the full scene"
        axes.text(1.04, k, words, fontsize=7.5, va="center")
    axes.set_yticks(list(ticks), [f"{one.accuracy:.0e}" for one in found.sets])
    axes.invert_yaxis()
    axes.set_xlim(0.0, 1.75)
    axes.set_xticks([0.0, 0.25, 0.5, 0.75, 1.0])
    axes.barh([0], [0], color=LIGHT, label="operations of one evaluation")
    axes.barh([0], [0], color=SAME, label="CPU time of a run (measured)")
    axes.legend(fontsize=7.5, frameon=False, loc="upper center", bbox_to_anchor=(0.4, -0.16), ncols=2)
