"""A solution while it is written: its blocks, and what the sections share."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

from lagc.mechanics.analysis.analysis import Analysis, analyse
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.reports.algebra.expansion import TooLarge
from lagc.reports.algebra.polynomials import NotFinite
from lagc.reports.derivation.document import Block, Formulas, Heading, Row
from lagc.reports.derivation.phrases import Phrases
from lagc.reports.derivation.rates import rates_of
from lagc.reports.derivation.unit_vectors import Components, UnitVectors
from lagc.reports.derivation.writer import FormulaWriter, Written, broken, subscript
from lagc.semantics.model import Body, Frame
from lagc.symbolic.derivative import gradient, tangent
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import substitute


class Draft:
    """`kinetic` is K as it is written, set by the section on the kinetic energy; in it, the symbols of
    `writer.meanings` stand for sums that stay together."""

    def __init__(self, equations: EquationsOfMotion, language: str, full: bool):
        self.equations, self.graph, self.full = equations, equations.graph, full
        self.rates, self.say = rates_of(equations), Phrases(language)
        self.model = self.rates.model
        self.writer = FormulaWriter(self.rates, self.say, full)
        frames = [*self.model.frames, *(frame for _, frame in self.solids)]
        self.frames = [f for f in dict.fromkeys(frames) if f.name != "world"]
        bodies, points = self.model.bodies, self.model.points
        positions = [*(b.position for b in bodies), *(p.position for p in points)]
        self.vectors = UnitVectors(self.writer, self.frames, positions)
        self.blocks: list[Block] = []
        self.kinetic = self.rates.kinetic

    @cached_property
    def analysis(self) -> Analysis:
        return analyse(self.equations)

    @property
    def solids(self) -> list[tuple[Body, Frame]]:
        return [(body, body.frame) for body in self.model.bodies if body.frame is not None]

    @cached_property
    def centres(self) -> dict[str, str]:
        """The letters of each body's centre: those of a declared point there, or of the body."""
        found = {}
        for body in self.model.bodies:
            names = [p.name for p in self.model.points if p.position == body.position]
            found[body.name] = self.writer.name(names[0] if names else body.name)
        return found

    def chain(self, frame: Frame) -> list[Frame]:
        """Return the frames that lead from the world to a frame, which is the last."""
        by_name, found = {x.name: x for x in self.frames}, [frame]
        while (parent := by_name.get(found[-1].parent)) is not None and parent not in found:
            found.append(parent)
        return found[::-1]

    # -- derivatives of K -----------------------------------------------------------------------------

    @cached_property
    def momenta(self) -> list[Node]:
        """dK/dq' of K as it is written, for each rate: through the parts that stay together."""
        graph, rates, meanings = self.graph, list(self.rates.symbols), self.writer.meanings
        direct = gradient(graph, {self.kinetic: graph.one}, [*rates, *meanings])
        found = [direct.get(v, graph.zero) for v in rates]
        for part, meaning in meanings.items():
            if part in direct:
                inner = gradient(graph, {meaning: graph.one}, rates)
                found = [x + direct[part] * inner[v] if v in inner else x for x, v in zip(found, rates)]
        return found

    @cached_property
    def slopes(self) -> list[Node]:
        """dK/dq of K as it is written, for each rate."""
        meanings, displacement = self.writer.meanings, self.rates.displacement
        moved = tangent(self.graph, list(meanings.values()), displacement)
        return self.rates.slopes(self.kinetic, {**displacement, **dict(zip(meanings, moved))})

    def opened(self, nodes: Sequence[Node]) -> list[Node]:
        """Return expressions with the parts that stay together written out."""
        return substitute(self.graph, nodes, self.writer.meanings)

    # -- blocks ---------------------------------------------------------------------------------------

    def heading(self, key: str, *given: str, level: int = 2) -> None:
        self.blocks.append(Heading(level, self.say(key, *given)))

    def paragraph(self, key: str, *given: object) -> None:
        self.blocks.append(self.say(key, *given))

    def formula(self, *rows: Row) -> None:
        self.blocks.append(Formulas(rows))

    def row(self, left: str, node: Node, about: str, note: str = "", stars: bool = False) -> Row:
        """Return the row `left` = `node`; with `stars` it is gathered by virtual velocities."""
        return Row(left, self.writer.lines(node, about, self.writer.stars if stars else None), note)

    # -- vectors --------------------------------------------------------------------------------------

    def vector(self, vector: Sequence[Node], about: str, stars: bool = False) -> tuple[str, ...]:
        """Return the lines of a vector in the unit vectors that make it shortest."""
        try:
            return self.components(self.vectors.express(vector), vector, about, stars)
        except (TooLarge, NotFinite):
            forms = [self.writer.text(x, about) for x in vector]
            return broken([rf"{x} \, {unit.latex}" for x, unit in zip(forms, self.vectors.world)])

    def components(
        self, components: Components, vector: Sequence[Node], about: str, stars: bool = False
    ) -> tuple[str, ...]:
        """Return the lines of a vector that is the sum of `components`; each of the world is recorded."""
        writer = self.writer
        forms = [(writer.factored(p, writer.stars if stars else None), unit) for p, unit in components]
        for k in range(3):
            shown = tuple([(form, unit.axis[k]) for form, unit in forms])
            writer.written.append(Written(about, shown, vector[k]))
        terms = []
        for form, unit in forms:
            text = writer.latex.total(form)
            text = (
                {"1": "", "-1": "-"}.get(text, text + r" \, ")
                if len(form.terms) == 1
                else rf"\left({text}\right) "
            )
            terms.append(text + unit.latex)
        return broken(terms) if terms else (r"\vec{0}",)

    def omega(self, frame: Frame, star: str = "") -> str:
        """Return the letters of a rotation vector."""
        return rf"\vec{{\Omega}}{star}_{{{subscript(frame.name)}}}"
