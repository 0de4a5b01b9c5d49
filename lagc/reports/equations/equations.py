"""The equations of motion as a person would write them: text, LaTeX, or a SymPy script.

    M a + h - tau - G^T lam = 0,  phi = 0,  psi = 0,  q' = N v + n where speeds are declared

each up to a factor that is a number or a product of parameters.
"""

from __future__ import annotations

from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.reports.equations.page import Page, page
from lagc.reports.equations.text import TextWriter
from lagc.reports.names import where

TITLES = {
    "shared": "shared parts",
    "kinematic": "kinematics",
    "motion": "equations of motion",
    "position": "constraints on positions",
    "velocity": "constraints on velocities",
    "event": "at events",
}


def write(equations: EquationsOfMotion, format: str = "text", full: bool = True) -> str:
    """The equations in `format`: text, latex or sympy.  Not in `full`, many are written by their rules."""
    found = page(equations, full)
    if format == "latex":
        from lagc.reports.equations.latex import write_latex

        return write_latex(found)
    if format == "sympy":
        from lagc.reports.equations.script import write_script

        return write_script(equations, found)
    return write_text(found)


def write_text(found: Page) -> str:
    writer = TextWriter(found.names, found.ruled)
    lines: list[str] = []
    for kind, group in found.by_kind():
        if len(found.lines) > 1:
            lines += ["", f"// {TITLES[kind]}"] if lines else [f"// {TITLES[kind]}"]
        lines += [writer.line(line) for line in group]
    legend = where(writer.seen)
    if legend:
        lines += ["", "where " + ", ".join(f"{short} = {full}" for short, full in legend)]
    return "\n".join(lines)
