"""A run in a notebook: its picture, and how good it is."""

from __future__ import annotations

import html
from typing import TYPE_CHECKING

from lagc.base.text import one_line

if TYPE_CHECKING:
    from lagc.simulation.solution import Solution


def solution_html(solution: Solution) -> str:
    """The plot as SVG where matplotlib is installed, else the final values as a table."""
    try:
        return picture(solution)
    except ImportError:
        return table(solution)


def picture(solution: Solution) -> str:
    import io

    from lagc.reports.plots.plot import plot, styled

    figure = plot(solution)
    text = io.StringIO()
    with styled():
        figure.savefig(text, format="svg", metadata={"Date": None})
    svg = text.getvalue()
    return f'<div style="max-width: 60em">{svg[svg.index("<svg") :]}</div>'


def table(solution: Solution) -> str:
    interface, units = solution.system.interface, solution.units
    caption = html.escape(one_line(f"{interface.model}, scene {interface.scene}: {solution.message}"))
    rows = [(name, f"{value:.9g}", units.get(name, "")) for name, value in solution.final.items()]
    cells = ["".join(f"<td>{html.escape(cell)}</td>" for cell in row) for row in rows]
    body = "".join(f"<tr>{row}</tr>" for row in cells)
    head = "<tr><th>name</th><th>value</th><th>unit</th></tr>"
    return f"<table><caption>{caption}</caption>{head}{body}</table>"
