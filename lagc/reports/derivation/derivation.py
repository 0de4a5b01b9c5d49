"""The worked solution of a model, as data and in several formats."""

from __future__ import annotations

from collections.abc import Callable

from lagc.base.records import dataclass
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.reports.derivation.actions import write_actions, write_forces
from lagc.reports.derivation.conserved import write_conserved
from lagc.reports.derivation.document import Block, Picture, math, plain
from lagc.reports.derivation.draft import Draft
from lagc.reports.derivation.kinematics import write_kinematics, write_virtual_velocities
from lagc.reports.derivation.kinetic_energy import write_kinetic_energy
from lagc.reports.derivation.lagrange import write_equations, write_lagrangian, write_result
from lagc.reports.derivation.parameters import write_constraints, write_count, write_parameters
from lagc.reports.derivation.rates import Term
from lagc.reports.derivation.reactions import write_reactions
from lagc.reports.derivation.writer import Written
from lagc.symbolic.graph import Node

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
        from lagc.reports.derivation.markdown import to_markdown

        return to_markdown(self.blocks)

    @property
    def latex(self) -> str:
        """The solution as a LaTeX document that needs the package amsmath."""
        from lagc.reports.derivation.latex_document import to_latex

        return to_latex(self.blocks, self.language)

    @property
    def html(self) -> str:
        """The solution as an HTML page; formulas are MathML, so that it needs no network."""
        from lagc.reports.derivation.html import to_page

        return to_page(self.blocks, self.language)

    def pictures(self, ending: str) -> dict[str, bytes]:
        """Return the files that a text with this ending refers to: SVG for .md, PDF for .tex."""
        found = [block for block in self.blocks if isinstance(block, Picture)]
        if ending == ".md":
            return {f"{x.name}.svg": x.svg for x in found}
        return {f"{x.name}.pdf": x.pdf for x in found} if ending == ".tex" else {}

    def _repr_html_(self) -> str:
        from lagc.reports.derivation.html import to_fragment

        return to_fragment(self.blocks)

    def _repr_markdown_(self) -> str:
        return self.markdown


def derivation_of(equations: EquationsOfMotion, language: str = "en", full: bool = False) -> Derivation:
    """Return the worked solution. Raises ValueError for an unknown language."""
    draft = Draft(equations, language, full)
    model, say = draft.model, draft.say
    draft.heading(1, plain(model.description or model.name))
    used = ", ".join([e.description or e.name for e in model.effects if e.used])
    draft.paragraph(say("scene_effects", model.scene, used) if used else say("scene", model.scene))
    draft.paragraph(say("notation", math(r"\hat Q_j"), math(r"\tilde Q_j")))
    for section in SECTIONS:
        section(draft)
    if draft.writer.abbreviated:
        draft.paragraph(say("abbreviated", str(draft.writer.abbreviated)))
    rates, writer = draft.rates, draft.writer
    return Derivation(
        language, tuple(draft.blocks), (*rates.given, *rates.reactions),
        tuple(rates.inertial_terms(rates.kinetic)), tuple(writer.written), dict(writer.meanings),
    )  # fmt: skip
