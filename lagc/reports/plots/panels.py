"""Plots of chosen quantities: the panels of `--show`.

A panel is one of

    a, b*            columns or expressions over time; `*` stands for any part of a name
    x : y, z         y and z over x: a phase portrait, with a mark at the start
    path(P), ...     the paths of bodies and points, in the plane of the motion
    energy           energy - start - work: the error of the integration, apart from that of the interpolation
    residuals        the scaled residuals of constraints

Several runs have lines of different styles; below a panel over time stand their differences from the first.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from math import pi
from typing import TYPE_CHECKING, Any

import numpy as np

from lagc.base.records import dataclass
from lagc.diagnostics.suggest import did_you_mean
from lagc.reports.animation.states import Array
from lagc.reports.plots.plot import COLORS, SEEN, entitle, styled, title
from lagc.simulation.solution import Solution

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from lagc.reports.animation.scene import Scene

STYLES = ("-", "--", ":", "-.")
COLUMNS = 2  # panels beside each other
MOST_MARKS = 12  # events that are named
PATH = re.compile(r"path\((.*)\)\Z")
WORDS = ("energy", "residuals")


@dataclass(frozen=True)
class Plotted:
    """A run with its label; `evaluate` and `unit` give the values and the unit of an expression, `scene` the
    scene."""

    label: str
    run: Solution
    evaluate: Callable[[str], Array]
    unit: Callable[[str], str]
    scene: Callable[[], Scene]


@dataclass(frozen=True)
class Panel:
    """A panel. `kind`: time, phase with the name `x`, path, energy or residuals."""

    kind: str
    names: tuple[str, ...] = ()
    x: str = ""


def parse(texts: Iterable[str], names: Sequence[str]) -> list[Panel]:
    """Return the panels; `names` are the columns of a run. A word in brackets that is no column is an
    expression. Raises ValueError for a name that matches nothing."""
    panels: list[Panel] = []
    for text in texts:
        path = PATH.match(text.strip())
        x, colon, rest = text.partition(":")
        if path:
            panels.append(Panel("path", tuple(split(path[1]))))
        elif text.strip() in WORDS and text.strip() not in names:
            panels.append(Panel(text.strip()))
        elif colon:
            (first,) = matching(x.strip(), names)[:1]
            panels.append(Panel("phase", tuple(n for w in split(rest) for n in matching(w, names)), first))
        else:
            panels.append(Panel("time", tuple(n for w in split(text) for n in matching(w, names))))
    return panels


def expressions(panels: Iterable[Panel], names: Sequence[str]) -> list[str]:
    """Return the expressions that panels need beside the columns."""
    found = [f"position({name})" for panel in panels if panel.kind == "path" for name in panel.names]
    return found + [n for p in panels if p.kind != "path" for n in (*p.names, p.x) if n and n not in names]


def split(text: str) -> list[str]:
    """Split at commas outside of brackets."""
    found, depth = [""], 0
    for letter in text:
        depth += (letter in "([{") - (letter in ")]}")
        if letter == "," and depth == 0:
            found.append("")
        else:
            found[-1] += letter
    return [word.strip() for word in found if word.strip()]


def matching(word: str, names: Sequence[str]) -> list[str]:
    """Return the names that a word with `*` stands for, or itself if it is an expression in brackets. Raises
    ValueError."""
    rule = re.compile(".*".join(map(re.escape, word.split("*"))))
    found = [name for name in names if rule.fullmatch(name)]
    if found or "(" in word:
        return found or [word]
    remedy = did_you_mean(word, names) or f"there are {', '.join(names[:12])}"
    raise ValueError(f"`--show {word}`: no column of the run has this name; {remedy}")


def draw(plotted: Sequence[Plotted], panels: Sequence[Panel], figure: Figure) -> None:
    """Draw the panels into a figure."""
    with styled():
        several = len(plotted) > 1
        cells = [
            (panel, below)
            for panel in panels
            for below in (False, True)[: 1 + (several and panel.kind == "time")]
        ]
        columns = COLUMNS if len(cells) > 3 and not several else 1
        rows = -(-len(cells) // columns)
        figure.set_size_inches(8.0 if columns == 1 else 11.0, 1.0 + 2.3 * rows)
        grid = figure.subplots(rows, columns, squeeze=False).ravel()
        for axes, (panel, below) in zip(grid, cells):
            _draw_panel(axes, plotted, panel, below)
        for spare in grid[len(cells) :]:
            spare.remove()
        entitle(figure, title(plotted[0].run))


def _draw_panel(axes: Axes, plotted: Sequence[Plotted], panel: Panel, below: bool) -> None:
    if panel.kind == "path":
        _paths(axes, plotted, panel.names)
    elif panel.kind == "phase":
        _phase(axes, plotted, panel)
    elif panel.kind == "time":
        (_differences if below else _over_time)(axes, plotted, panel.names)
    else:
        _errors(axes, plotted, panel.kind)
    if panel.kind not in ("path", "phase"):
        axes.set_xlabel("time [s]")
        _mark_events(axes, plotted[0].run)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(fontsize=7, loc="best")


def _column(plotted: Plotted, name: str) -> tuple[Array, str]:
    """Return the values of a column or an expression, in the unit in which they are shown."""
    if name in plotted.run:
        values, unit = np.array(plotted.run.column(name)), plotted.run.units[name]
    else:
        values, unit = plotted.evaluate(name), plotted.unit(name)
        if values.ndim > 1:
            raise ValueError(f"`--show {name}`: this is a vector; write `norm({name})`, or a component")
    if "rad" in unit and "rad" not in unit.partition("/")[2]:
        return values * 180.0 / pi, unit.replace("rad", "deg")
    return values, unit


def _style(k: int, number: int) -> dict[str, Any]:
    return {"color": COLORS[k % len(COLORS)], "linestyle": STYLES[number % len(STYLES)]}


def _named(name: str, label: str) -> str:
    return f"{name}, {label}" if label else name


def _label_units(axes: Axes, units: Iterable[str]) -> None:
    axes.set_ylabel(" ".join(f"[{unit}]" for unit in dict.fromkeys(units) if unit))


def _over_time(axes: Axes, plotted: Sequence[Plotted], names: Sequence[str]) -> None:
    units: list[str] = []
    for k, name in enumerate(names):
        for number, each in enumerate(plotted):
            y, unit = _column(each, name)
            units.append(unit)
            axes.plot(each.run.t, y, label=_named(name, each.label), **_style(k, number))
            doubt = each.run.errors.get(name, 0.0) * (180.0 / pi if unit.startswith("deg") else 1.0)
            if doubt > SEEN * float(np.ptp(y)):
                axes.fill_between(
                    each.run.t, y - doubt, y + doubt, color=COLORS[k % len(COLORS)], alpha=0.2, lw=0
                )
    _label_units(axes, units)


def _differences(axes: Axes, plotted: Sequence[Plotted], names: Sequence[str]) -> None:
    """Draw the differences of the other runs from the first, at the times that both have."""
    units: list[str] = []
    for k, name in enumerate(names):
        first, unit = _column(plotted[0], name)
        units.append(unit)
        for number, each in enumerate(plotted[1:], 1):
            t = each.run.t[each.run.t <= plotted[0].run.t[-1]]
            y = _column(each, name)[0][: len(t)] - np.interp(t, plotted[0].run.t, first)
            axes.plot(t, y, label=f"{name}, {each.label} - first", **_style(k, number))
    _label_units(axes, units)


def _phase(axes: Axes, plotted: Sequence[Plotted], panel: Panel) -> None:
    units: list[str] = []
    for k, name in enumerate(panel.names):
        for number, each in enumerate(plotted):
            (x, x_unit), (y, unit) = _column(each, panel.x), _column(each, name)
            units.append(unit)
            axes.plot(x, y, label=_named(name, each.label), **_style(k, number))
            axes.plot(x[:1], y[:1], "o", color=COLORS[k % len(COLORS)], ms=4)
            axes.set_xlabel(f"{panel.x} [{x_unit}]" if x_unit else panel.x)
    _label_units(axes, units)


def _paths(axes: Axes, plotted: Sequence[Plotted], names: Sequence[str]) -> None:
    from lagc.reports.animation.film import Camera

    camera = Camera(plotted[0].scene())
    for k, name in enumerate(names):
        for number, each in enumerate(plotted):
            x = camera(each.evaluate(f"position({name})"))
            axes.plot(*x.T, label=_named(name, each.label), **_style(k, number))
            axes.plot(*x[:1].T, "o", color=COLORS[k % len(COLORS)], ms=4)
    axes.set_aspect("equal", "datalim")
    for axis, put in ((camera.x, axes.set_xlabel), (camera.y, axes.set_ylabel)):
        named = [f"{'-' if v < 0.0 else ''}{letter}" for letter, v in zip("xyz", axis) if abs(v) > 0.99]
        put(f"{' '.join(named)} [m]".strip())


def _errors(axes: Axes, plotted: Sequence[Plotted], kind: str) -> None:
    from lagc.reports.animation.page import energy_error, residuals

    for number, each in enumerate(plotted):
        if kind == "energy":
            error = energy_error(each.run)
            if error is not None:
                axes.plot(
                    each.run.t, error, label=_named("energy - start - work", each.label), **_style(0, number)
                )
        else:
            for k, (name, y) in enumerate(residuals(each.run)):
                axes.semilogy(each.run.t, y, label=_named(name, each.label), **_style(k, number))
    axes.set_ylabel("[J]" if kind == "energy" else "scaled residual")


def _mark_events(axes: Axes, run: Solution) -> None:
    """Draw a line at each event, with its name if there are few."""
    events = dict.fromkeys((event.t, event.name) for event in run.events)
    for t, name in events:
        axes.axvline(t, color="#999999", linewidth=0.8, linestyle=":", zorder=0)
        if len(events) <= MOST_MARKS:
            axes.text(t, 1.0, f" {name}", rotation=90, fontsize=6, color="#666666", va="top",
                      transform=axes.get_xaxis_transform())  # fmt: skip
