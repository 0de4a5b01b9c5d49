"""The worked solution of a model, as data and in several formats."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from lagc.base.records import dataclass, replace
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.reports.derivation.actions import write_actions, write_forces
from lagc.reports.derivation.document import Block, Heading, Picture, Table, math
from lagc.reports.derivation.draft import Draft
from lagc.reports.derivation.kinematics import write_kinematics, write_virtual_velocities
from lagc.reports.derivation.kinetic_energy import write_kinetic_energy
from lagc.reports.derivation.lagrange import write_equations, write_lagrangian, write_result
from lagc.reports.derivation.parameters import write_constraints, write_count, write_parameters
from lagc.reports.derivation.phrases import Phrases
from lagc.reports.derivation.rates import Term
from lagc.reports.derivation.reactions import write_conserved, write_reactions
from lagc.reports.derivation.writer import Written
from lagc.reports.equations.latex import letter
from lagc.symbolic.graph import Node

if TYPE_CHECKING:
    from lagc.simulation.solution import Solution

SECTIONS: tuple[Callable[[Draft], None], ...] = (
    write_parameters,
    write_constraints,
    write_kinematics,
    write_kinetic_energy,
    write_virtual_velocities,
    write_actions,
    write_forces,
    write_count,
    write_equations,
    write_result,
    write_lagrangian,
    write_conserved,
    write_reactions,
)


@dataclass(frozen=True)
class Derivation:
    """A worked solution.

    blocks: the headings, sentences, formulas and tables, in their order.
    terms: the generalized forces of each action, constraint and contact, by rate.
    inertial: d/dt(dK/dq') - dK/dq for each rate; it is the sum of the terms.
    written: every formula with the expression that it stands for; `meanings` of symbols in them.
    """

    language: str
    blocks: tuple[Block, ...]
    terms: tuple[Term, ...]
    inertial: tuple[Node, ...]
    written: tuple[Written, ...]
    meanings: dict[Node, Node]

    @property
    def markdown(self) -> str:
        """The solution in Markdown, with formulas between dollar signs."""
        from lagc.reports.derivation.formats import to_markdown

        return to_markdown(self.blocks)

    @property
    def latex(self) -> str:
        """The solution as a LaTeX document that needs the package amsmath."""
        from lagc.reports.derivation.formats import to_latex

        return to_latex(self.blocks)

    @property
    def html(self) -> str:
        """The solution as an HTML page; formulas are MathML, so that it needs no network."""
        from lagc.reports.derivation.html import to_page

        return to_page(self.blocks, self.language)

    @property
    def pdf(self) -> bytes:
        """The solution in PDF. Raises NoLatex (of `formats`) if this machine has no LaTeX."""
        from lagc.reports.derivation.formats import to_pdf

        return to_pdf(self.latex, self.pictures(".tex"))

    def pictures(self, ending: str) -> dict[str, bytes]:
        """Return the files that a text with this ending refers to: SVG for .md, PDF for .tex."""
        found = [block for block in self.blocks if isinstance(block, Picture)]
        files = {
            ".md": {f"{x.name}.svg": x.svg for x in found},
            ".tex": {f"{x.name}.pdf": x.pdf for x in found},
        }
        return files.get(ending, {})

    def _repr_html_(self) -> str:
        from lagc.reports.derivation.html import to_fragment

        return to_fragment(self.blocks)

    def _repr_markdown_(self) -> str:
        return self.markdown


def derivation_of(equations: EquationsOfMotion, language: str = "en", full: bool = False) -> Derivation:
    """Return the worked solution. Raises ValueError for an unknown language."""
    draft = Draft(equations, language, full)
    model, rates, writer = draft.model, draft.rates, draft.writer
    draft.blocks.append(Heading(1, model.description or model.name))
    used = ", ".join([e.description or e.name for e in model.effects if e.used])
    draft.paragraph("scene_effects" if used else "scene", model.scene, used)
    draft.paragraph("notation", math(r"\hat Q_j"), math(r"\tilde Q_j"))
    for section in SECTIONS:
        section(draft)
    if writer.abbreviated:
        draft.paragraph("abbreviated", writer.abbreviated)
    return Derivation(
        language, tuple(draft.blocks), (*rates.given_terms, *rates.reactions),
        tuple(rates.inertial_terms(rates.kinetic)), tuple(writer.written), dict(writer.meanings),
    )  # fmt: skip


def with_motion(found: Derivation, run: Solution) -> Derivation:
    """Return the solution with the values of a run, its start, its plot and its error. Raises ImportError
    without matplotlib."""
    from io import BytesIO

    from lagc.reports.plots.plot import plot, styled, svg

    say, interface = Phrases(found.language), run.system.interface
    fields = [(f.name, f.unit) for f in (*interface.parameters, *interface.inputs)]
    states = list(zip(run.state_names, interface.state_units))
    blocks: list[Block] = [Heading(2, say("h_motion"))]
    for title, named, values in (("values", fields, run.parameters), ("start", states, run.states[0])):
        rows = [
            (math(letter(name)), f"{value:.6g}", unit or "1") for (name, unit), value in zip(named, values)
        ]
        blocks += [say(title), Table((("", say("value"), say("unit")), *rows))]
    end = f"{run.times[-1]:.6g} s"
    blocks.append(say("stopped", end, run.message) if run.status == "failed" else say("simulated", end))
    # Without a date the same run gives the same bytes.
    figure, pdf = plot(run), BytesIO()
    with styled():
        figure.savefig(pdf, format="pdf", metadata={"CreationDate": None})
    blocks.append(Picture("solution-motion", svg(figure).encode(), pdf.getvalue()))
    blocks += [] if run.estimated is None else [say("error", f"{run.estimated:.1e}")]
    return replace(found, blocks=(*found.blocks, *blocks))
