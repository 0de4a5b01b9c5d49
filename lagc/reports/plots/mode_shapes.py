"""Pictures of modes: what moves, by how much and in which phase."""

from __future__ import annotations

from math import ceil
from typing import TYPE_CHECKING, Any

from lagc.base.text import printable
from lagc.reports.plots.plot import COLORS, entitle, panels, save, styled
from lagc.simulation.linearization.linearize import damping, frequency

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from lagc.simulation.linearization.linearize import Linear

MOST = 12  # modes of a picture
LEVEL = 6  # names that stand level below an axis
NAMED = 30  # coordinates that are named: of more every second, or third, and so on
AT_REST_RATE = 1e-9  # of the largest: what a mode leaves where it is


def plot_modes(linear: Linear, title: str, path: str | None = None) -> Figure:
    """A panel a mode, of a pair one: for each coordinate a bar as high as it moves (SI) beside the largest,
    in phase with it upwards, against it downwards; what is a quarter ahead is hollow.  Modes of the
    eigenvalue 0 are left out.  Into the file `path` where one is given; raises as `lagc.reports.plots.plot.plot`."""
    interface = linear.system.interface
    names, nq = interface.q_names, interface.nq
    shown = [k for k, value in enumerate(linear.eigenvalues) if value and value.imag >= 0.0][:MOST]
    with styled():
        from matplotlib.figure import Figure

        figure = Figure(layout="constrained")
        axes, lowest = panels(figure, max(1, len(shown)), 1.6)
        entitle(figure, title)
        told = False
        for axis, k in zip(axes, shown):
            value, mode = complex(linear.eigenvalues[k]), linear.modes[:nq, k]
            turned = abs(mode.imag).max(initial=0.0) > AT_REST_RATE
            aside = 0.2 if turned else 0.0
            axis.axhline(0.0, color="#7f7f7f", linewidth=0.8)
            axis.bar([i - aside for i in range(nq)], mode.real, width=0.4, color=COLORS[0], label="real part")
            if turned:
                axis.bar([i + aside for i in range(nq)], mode.imag, width=0.4, fill=False,
                         edgecolor=COLORS[1], label="imaginary part")  # fmt: skip
                if not told:
                    axis.legend(
                        loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.0, fontsize=8
                    )
                told = True
            axis.set_axisbelow(True)
            axis.set(xlim=(-0.6, nq - 0.4), ylim=(-1.15, 1.15))
            axis.set_title(_caption(value), fontsize=8, loc="left")
        if not shown:
            axes[0].set(xlim=(-0.6, nq - 0.4), yticks=[])
            axes[0].set_title("no eigenvalues but 0", fontsize=8, loc="left")
        every = ceil(nq / NAMED)
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
