"""A run as a picture: quantities over time, with an axis for each unit.

matplotlib is imported when a picture is drawn; without it ImportError names the package.
"""

from __future__ import annotations

import html
import io
import math
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from textwrap import fill
from typing import TYPE_CHECKING, Any, TypeAlias

from lagc.base.records import RLock
from lagc.base.text import one_line, printable
from lagc.host.atomic_write import Files, fitting
from lagc.host.packages import PICTURES
from lagc.reports.plots.curves import Scales, scales, with_corners
from lagc.simulation.linearization.linear_model import damping, frequency

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from lagc.lowering.program import Interface
    from lagc.simulation.linearization.linear_model import Linear
    from lagc.simulation.solution import Solution

# Okabe, Ito
COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7f7f7f", "#000000")
ENDINGS = (".png", ".svg", ".pdf")
LEGEND = 12  # lines an axis names one by one
WIDTH = 8.0  # inches, of a column of panels
COLUMN = 6  # panels of a picture that has one column
LETTERS = 14  # of a title, an inch
SEEN = 2e-3  # of the range of a curve: a smaller error is no wider than the line
LINES = 200  # at events: more would hide the curves
STYLE: dict[Any, Any] = {
    "font.size": 9.0, "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True,
    "grid.color": "#e6e6e6", "grid.linewidth": 0.6, "axes.linewidth": 0.8, "lines.linewidth": 1.3,
    "legend.frameon": False, "svg.hashsalt": "lagc", "svg.fonttype": "path",
}  # fmt: skip

_TURN = RLock()


Drawing: TypeAlias = Callable[["Figure"], None]


def plot(
    solution: Solution, names: Sequence[str] = (), path: str | None = None, drawing: Drawing | None = None
) -> Figure:
    """Draw the columns `names` (default: coordinates and outputs), or by `drawing`, into the file `path` if
    given, by its ending: .png .svg .pdf. Raises ImportError without matplotlib, KeyError for an unknown name,
    ValueError for an unknown ending, OSError if the file cannot be written."""
    figure: Figure = _matplotlib().figure.Figure(layout="constrained")
    if drawing is None:
        draw(solution, figure, names)
    else:
        drawing(figure)
    if path is not None:
        save(figure, path)
    return figure


def show(solution: Solution, drawing: Drawing | None = None) -> str | None:
    """Draw into a window; where there is no display, into a file beside, whose path is returned."""
    if not has_display():
        path = path_beside(solution.system.interface)
        plot(solution, path=path, drawing=drawing)
        return path
    _matplotlib()
    from matplotlib import pyplot

    (drawing or partial(draw, solution))(pyplot.figure(layout="constrained"))
    pyplot.show()
    return None


def path_beside(interface: Interface) -> str:
    """The file of a picture that is given none."""
    return f"{fitting(f'{interface.model}_{interface.scene}')}.png"


def has_display() -> bool:
    if sys.platform in ("win32", "darwin"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


@contextmanager
def styled() -> Iterator[None]:
    """Draw in the style of these pictures. matplotlib has one style for all threads, so one draws at a
    time."""
    with _TURN, _matplotlib().rc_context(STYLE):
        yield


def save(figure: Figure, path: str) -> None:
    """The same picture gives the same file: without a date."""
    dateless: dict[str, Any] = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
    check_ending(path)
    kind = os.path.splitext(path)[1].lstrip(".").lower()
    with styled(), Files() as files:
        figure.savefig(files.open(path), format=kind, dpi=160, metadata=dateless.get(kind))


def svg(figure: Figure) -> str:
    """The picture as an element `<svg>`."""
    buffer = io.StringIO()
    with styled():
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    text = buffer.getvalue()
    return text[text.index("<svg") :]


def check_ending(path: str) -> None:
    """Raises ValueError where a picture has no such ending."""
    if os.path.splitext(path)[1].lower() not in ENDINGS:
        known = " ".join(ENDINGS)
        raise ValueError(f"`{path}` cannot be drawn: the ending says the format; there are {known}")


def draw(solution: Solution, figure: Figure, names: Sequence[str] = ()) -> None:
    groups = by_unit(solution, names or shown_names(solution))
    drawn, known = with_corners(solution), scales(solution)
    with styled():
        axes, lowest = panels(figure, max(1, len(groups)), 2.0)
        entitle(figure, title(solution))
        for axis, (unit, group) in zip(axes, groups.items()):
            _draw_group(axis, solution, drawn, known, unit, group)
        times = sorted({event.t for event in solution.events})
        for axis in axes if len(times) <= LINES else ():
            for t in times:
                axis.axvline(t, color="#999999", linewidth=0.8, linestyle=":")
        for axis in lowest:
            axis.set_xlabel("time [s]")
        figure.align_ylabels()


def panels(figure: Figure, count: int, height: float) -> tuple[list[Axes], list[Axes]]:
    """Return panels one over the other, in columns if the figure would be much higher than wide; and the
    lowest ones of each column."""
    columns = 1 if count <= COLUMN else math.ceil(math.sqrt(count * height / WIDTH))
    rows = math.ceil(count / columns)
    figure.set_size_inches(WIDTH * columns, 1.2 + height * rows)
    grid = figure.subplots(rows, columns, sharex=True, squeeze=False).T.ravel()
    for spare in grid[count:]:
        spare.remove()
    lowest = [*grid[rows - 1 : count - 1 : rows], grid[count - 1]]
    for axis in lowest:
        axis.tick_params(labelbottom=True)
    return [*grid[:count]], lowest


def entitle(figure: Figure, text: str) -> None:
    """Write a title, broken into lines that the figure has room for."""
    wide = int(LETTERS * figure.get_size_inches()[0])
    lines = [fill(line, wide) for line in printable(text).splitlines()]
    figure.suptitle("\n".join(lines), fontsize=9, x=0.01, ha="left")


def title(solution: Solution) -> str:
    """Model and scene; below, how good the numbers are."""
    interface = solution.system.interface
    if solution.asked is None:
        quality = f"rtol {solution.rtol:.0e}" if not solution.step else f"step {solution.step:g} s"
    elif solution.estimated is None:
        quality = f"accuracy asked {solution.asked:.0e}, not verified"
    else:
        quality = f"accuracy asked {solution.asked:.0e}, estimated {solution.estimated:.0e}"
    status = "" if solution.status == "ok" else f"\n{solution.status}: {solution.message}"
    return f"{interface.model}, scene {interface.scene}\n{solution.method}, {quality}{status}"


def shown_names(solution: Solution) -> list[str]:
    """Coordinates and outputs, then what they change by."""
    interface, varied = solution.system.interface, solution.sensitivities
    names = [*interface.q_names, *[o.name for o in interface.outputs], *solution.expressions]
    return names if varied is None else [*names, *varied.named(names)]


def by_unit(solution: Solution, names: Sequence[str]) -> dict[str, list[str]]:
    """Unit as it is shown -> names, in order; parts of a quaternion are a group of their own, of many one."""
    interface = solution.system.interface
    several = len(interface.quaternions) > COLUMN
    parts = {
        interface.q_names[first + k]: "s" if several else f" {interface.q_names[first].rpartition('.')[0]}"
        for first in interface.quaternions
        for k in range(4)
    }
    groups: dict[str, list[str]] = {}
    units = solution.units
    for name in names:
        unit = units.get(name, "")
        unit = unit if "rad" in unit.partition("/")[2] else unit.replace("rad", "deg")
        key = f"orientation{parts[name]}" if name in parts else unit
        groups.setdefault(key, []).append(name)
    return groups


def _draw_group(
    axis: Axes, solution: Solution, drawn: Solution, known: Scales, unit: str, names: list[str]
) -> None:
    factor = 180.0 / math.pi if "deg" in unit and not unit.startswith("orientation") else 1.0
    ends, flat, size = [0.0] if known.constant.issuperset(names) else [], True, 0.0
    for number, name in enumerate(names):
        sensitive = solution.sensitivities is not None and name in solution.sensitivities
        run = solution if sensitive or name in solution.expressions else drawn
        values = run.column(name)
        finite = [x for x in values if math.isfinite(x)]
        if finite and name not in known.constant:
            ends += [factor * min(finite), factor * max(finite)]
            size = max(size, factor * known.sizes.get(name, 0.0))
            flat = flat and known.is_flat(name, finite, unit)
        shown = [factor * x for x in values]
        (line,) = axis.plot(run.times, shown, label=name, **_line(number, len(names)))
        error = factor * solution.errors.get(name, 0.0)
        if finite and error > SEEN * factor * (max(finite) - min(finite)):
            below, above = ([x + sign * error for x in shown] for sign in (-1.0, 1.0))
            axis.fill_between(run.times, below, above, color=line.get_color(), alpha=0.2, linewidth=0.0)
    _label(axis, unit, names)
    # Round-off must not fill an axis: a constant gets an axis of the size of its values or its terms.
    if flat and ends:
        low, high = min(ends), max(ends)
        half = 0.6 * max(abs(low), abs(high), size) or 1.0
        axis.set_ylim((low + high) / 2.0 - half, (low + high) / 2.0 + half)
        axis.ticklabel_format(axis="y", useOffset=False)


def _line(number: int, count: int) -> dict[str, Any]:
    if count <= LEGEND:
        style = ("-", "--")[number // len(COLORS) % 2]
        return {"color": COLORS[number % len(COLORS)], "linestyle": style}
    colormap = _matplotlib().colormaps["viridis"]
    return {"color": colormap(0.9 * number / (count - 1)), "linewidth": 0.7}


def _label(axis: Axes, unit: str, names: list[str]) -> None:
    bracket = f" [{unit}]" if unit and not unit.startswith("orientation") else ""
    if unit.startswith("orientation"):
        axis.set_ylabel(unit)
    elif len(names) == 1:
        axis.set_ylabel(f"{names[0]}{bracket}")
    else:
        axis.set_ylabel(bracket.strip() or "number")
    if 1 < len(names) <= LEGEND:
        axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), handlelength=1.4)
    elif len(names) > LEGEND:
        axis.set_title(f"{names[0]} (dark) to {names[-1]} (light)", loc="right", fontsize=8)


def _matplotlib() -> Any:
    try:
        import matplotlib
        import matplotlib.figure
    except ImportError as error:
        broken = "" if isinstance(error, ModuleNotFoundError) else f" ({error})"
        raise ImportError(PICTURES + broken) from None
    return matplotlib


def solution_html(solution: Solution) -> str:
    """The plot as SVG where matplotlib is installed, else the final values as a table."""
    try:
        return f'<div style="max-width: 60em">{svg(plot(solution))}</div>'
    except ImportError:
        return table(solution)


def table(solution: Solution) -> str:
    interface, units = solution.system.interface, solution.units
    caption = html.escape(one_line(f"{interface.model}, scene {interface.scene}: {solution.message}"))
    rows = [(name, f"{value:.9g}", units.get(name, "")) for name, value in solution.final.items()]
    cells = ["".join(f"<td>{html.escape(cell)}</td>" for cell in row) for row in rows]
    body = "".join(f"<tr>{row}</tr>" for row in cells)
    head = "<tr><th>name</th><th>value</th><th>unit</th></tr>"
    return f"<table><caption>{caption}</caption>{head}{body}</table>"


MOST = 12  # modes of a picture
LEVEL = 6  # names that stand level below an axis
NAMED = 30  # coordinates that are named: of more every second, or third, and so on
AT_REST_RATE = 1e-9  # of the largest: what a mode leaves where it is


def plot_modes(linear: Linear, title: str, path: str | None = None) -> Figure:
    """Draw a panel for each mode, one for a pair: a bar for each coordinate, its amplitude (SI) relative to
    the largest, upwards in phase with it and downwards against it; hollow at a quarter of a period. Modes of
    the eigenvalue 0 are left out. Writes the file `path` if given; raises as `plot`."""
    interface = linear.system.interface
    names, nq = interface.q_names, interface.nq
    # A conjugate pair is one mode; its real and imaginary parts are a quarter of a period apart.
    shown = [k for k, value in enumerate(linear.eigenvalues) if value and value.imag >= 0.0][:MOST]
    with styled():
        from matplotlib.figure import Figure

        figure = Figure(layout="constrained")
        axes, lowest = panels(figure, max(1, len(shown)), 1.6)
        entitle(figure, title)
        labelled = False
        for axis, k in zip(axes, shown):
            value, mode = complex(linear.eigenvalues[k]), linear.modes[:nq, k]
            turned = abs(mode.imag).max(initial=0.0) > AT_REST_RATE
            aside = 0.2 if turned else 0.0
            axis.axhline(0.0, color="#7f7f7f", linewidth=0.8)
            axis.bar([i - aside for i in range(nq)], mode.real, width=0.4, color=COLORS[0], label="real part")
            if turned:
                axis.bar([i + aside for i in range(nq)], mode.imag, width=0.4, fill=False,
                         edgecolor=COLORS[1], label="imaginary part")  # fmt: skip
                if not labelled:
                    axis.legend(
                        loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.0, fontsize=8
                    )
                labelled = True
            axis.set_axisbelow(True)
            axis.set(xlim=(-0.6, nq - 0.4), ylim=(-1.15, 1.15))
            axis.set_title(_caption(value), fontsize=8, loc="left")
        if not shown:
            axes[0].set(xlim=(-0.6, nq - 0.4), yticks=[])
            axes[0].set_title("no eigenvalues but 0", fontsize=8, loc="left")
        # Names of coordinates stand below the lowest panels alone: level, slanted, or every second, third,
        # ...
        every = math.ceil(nq / NAMED)
        labels = [f"{name} [{unit}]" if unit else name for name, unit in zip(names, interface.q_units)]
        slanted: dict[str, Any] = {"rotation": 45, "ha": "right", "rotation_mode": "anchor"}
        for axis in lowest:
            axis.set_xticks(
                range(0, nq, every), [*map(printable, labels[::every])], **slanted if nq > LEVEL else {}
            )
    if path is not None:
        save(figure, path)
    return figure


def _caption(value: complex) -> str:
    ratio = (damping(value) or 0.0) + 0.0  # no -0
    if value.imag:
        return f"{frequency(value):.5g} Hz, damping {ratio:.4g}"
    return f"{'grows' if value.real > 0.0 else 'decays'} with {abs(value.real):.5g}/s"
