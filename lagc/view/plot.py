"""A run as a picture: quantities over time, an axis a unit.

matplotlib is imported when a picture is drawn; without it ImportError says what to install.
"""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from lagc.once import RLock
from lagc.printable import printable
from lagc.saving import Files, fitting

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from lagc.optimize.program import Interface
    from lagc.run.solution import Solution

COLORS = (
    "#0072b2",
    "#d55e00",
    "#009e73",
    "#cc79a7",
    "#e69f00",
    "#56b4e9",
    "#7f7f7f",
    "#000000",
)  # Okabe, Ito
LEGEND = 12  # lines an axis names one by one
CONSTANT = 1e-6  # a relative change below it is shown as none
STYLE: dict[Any, Any] = {
    "font.size": 9.0, "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True,
    "grid.color": "#e6e6e6", "grid.linewidth": 0.6, "axes.linewidth": 0.8, "lines.linewidth": 1.3,
    "legend.frameon": False, "svg.hashsalt": "lagc", "svg.fonttype": "path",
}  # fmt: skip

_TURN = RLock()


def plot(solution: Solution, names: Sequence[str] = (), path: str | None = None) -> Figure:
    """Draw the columns `names` (coordinates and outputs without a name), into the file `path` where
    one is given, by its ending: .png .svg .pdf.

    Raises ImportError without matplotlib, KeyError for an unknown name, ValueError for an unknown
    ending, OSError where the file cannot be written.
    """
    figure: Figure = _matplotlib().figure.Figure(layout="constrained")
    draw(solution, figure, names)
    if path is not None:
        save(figure, path)
    return figure


def show(solution: Solution) -> str | None:
    """Draw into a window; where there is no display, into a file beside, whose path is returned."""
    if not has_display():
        path = path_beside(solution.system.interface)
        plot(solution, path=path)
        return path
    _matplotlib()
    from matplotlib import pyplot

    draw(solution, pyplot.figure(layout="constrained"))
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
    """In the style of these pictures, which matplotlib holds for all threads: one at a time."""
    with _TURN, _matplotlib().rc_context(STYLE):
        yield


def save(figure: Figure, path: str) -> None:
    """The same picture gives the same file: without a date."""
    dateless: dict[str, Any] = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
    ending = os.path.splitext(path)[1].lstrip(".").lower()
    if not ending:
        raise ValueError(f"`{path}` cannot be drawn: the ending says the format")
    with styled(), Files() as files:
        figure.savefig(files.open(path), format=ending, dpi=160, metadata=dateless.get(ending))


def draw(solution: Solution, figure: Figure, names: Sequence[str] = ()) -> None:
    groups = by_unit(solution, names or shown_names(solution))
    with styled():
        figure.set_size_inches(8.0, 1.2 + 2.0 * max(1, len(groups)))
        figure.suptitle(title(solution), fontsize=9, x=0.01, ha="left")
        axes = figure.subplots(max(1, len(groups)), 1, sharex=True, squeeze=False)[:, 0]
        for axis, (unit, group) in zip(axes, groups.items()):
            _draw_group(axis, solution, unit, group)
        axes[-1].set_xlabel("time [s]")
        for axis in axes:
            for event in solution.events:
                axis.axvline(event.t, color="#999999", linewidth=0.8, linestyle=":")
        figure.align_ylabels()


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
    return printable(f"{interface.model}, scene {interface.scene}\n{solution.method}, {quality}{status}")


def shown_names(solution: Solution) -> list[str]:
    """Coordinates and outputs, then what they change by."""
    interface, varied = solution.system.interface, solution.sensitivities
    names = [*interface.q_names, *[o.name for o in interface.outputs]]
    return names if varied is None else [*names, *varied.named(names)]


def by_unit(solution: Solution, names: Sequence[str]) -> dict[str, list[str]]:
    """Unit as it is shown -> names, in order; parts of a quaternion are a group of their own."""
    interface = solution.system.interface
    parts = {
        interface.q_names[first + k]: interface.q_names[first].rpartition(".")[0]
        for first in interface.quaternions
        for k in range(4)
    }
    groups: dict[str, list[str]] = {}
    units = solution.units
    for name in names:
        unit = units.get(name, "")
        unit = unit if "rad" in unit.partition("/")[2] else unit.replace("rad", "deg")
        key = f"orientation {parts[name]}" if name in parts else unit
        groups.setdefault(key, []).append(name)
    return groups


def _draw_group(axis: Axes, solution: Solution, unit: str, names: list[str]) -> None:
    factor = 180.0 / math.pi if "deg" in unit and not unit.startswith("orientation") else 1.0
    lowest, highest, constant = math.inf, -math.inf, True
    size = energy_size(solution) if unit == "J" else 0.0
    for number, name in enumerate(names):
        values = [factor * x for x in solution.column(name)]
        finite = [x for x in values if math.isfinite(x)]
        if finite:
            lowest, highest = min(lowest, *finite), max(highest, *finite)
            constant = constant and is_constant(finite, size)
        axis.plot(solution.times, values, label=name, **_line(number, len(names)))
    _label(axis, unit, names)
    if constant and lowest <= highest:
        middle, half = (lowest + highest) / 2.0, 0.6 * max(abs(lowest), abs(highest), size)
        axis.set_ylim(middle - (half or 1.0), middle + (half or 1.0))
        axis.ticklabel_format(axis="y", useOffset=False)


def is_constant(values: Sequence[float], size: float = 0.0) -> bool:
    """Whether the change is nothing beside the values, or beside `size`: rounding must not fill
    an axis."""
    low, high = min(values), max(values)
    return high - low <= CONSTANT * max(abs(low), abs(high), size)


def energy_size(solution: Solution) -> float:
    """What a change of energy is small beside: the largest kinetic energy of some twenty points."""
    step = max(1, len(solution) // 20)
    points = list(zip(solution.times, solution.states))[::step]
    kinetic = [solution.system.energies(t, x)[0] for t, x in points]
    return max([k for k in kinetic if math.isfinite(k)], default=0.0)


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
    except ModuleNotFoundError:
        raise ImportError("a picture needs matplotlib: pip install matplotlib") from None
    return matplotlib
