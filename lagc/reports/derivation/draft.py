"""A solution while it is written: its blocks, and what the sections share."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

from lagc.mechanics.analysis.analysis import Analysis, analyse
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.reports.algebra.expansion import TooLarge
from lagc.reports.algebra.polynomials import NotFinite
from lagc.reports.derivation.document import Block, FormulaBlock, FormulaRow, Heading, Paragraph, Text
from lagc.reports.derivation.phrases import Phrases
from lagc.reports.derivation.rates import Rates, rates_of
from lagc.reports.derivation.unit_vectors import Components, UnitVectors
from lagc.reports.derivation.writer import FormulaWriter, Written, broken, subscript
from lagc.semantics.model import Body, Frame
from lagc.symbolic.derivative import gradient, tangent
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import substitute

VELOCITY, ROTATION = r"\vec{V}", r"\vec{\Omega}"


class Draft:
    """`kinetic` is K as it is written, set by the section on the kinetic energy; in it, the symbols of
    `writer.meanings` stand for sums that stay together."""

    def __init__(self, equations: EquationsOfMotion, language: str, full: bool):
        self.equations, self.graph, self.full = equations, equations.graph, full
        self.rates: Rates = rates_of(equations)
        self.model = self.rates.model
        self.say = Phrases(language)
        self.writer = FormulaWriter(self.rates, self.say, full)
        bodies, points = self.model.bodies, self.model.points
        frames = [*self.model.frames, *(b.frame for b in bodies if b.frame is not None)]
        self.frames: list[Frame] = [f for f in dict.fromkeys(frames) if f.name != "world"]
        positions = [*(b.position for b in bodies), *(p.position for p in points)]
        self.vectors = UnitVectors(self.writer, self.frames, positions)
        self.blocks: list[Block] = []
        self.kinetic: Node = self.rates.kinetic

    @cached_property
    def analysis(self) -> Analysis:
        return analyse(self.equations)

    @cached_property
    def centres(self) -> dict[str, str]:
        """The letters of each body's centre: those of a declared point there, or of the body."""
        found = {}
        for body in self.model.bodies:
            names = [p.name for p in self.model.points if p.position == body.position]
            found[body.name] = self.writer.name(names[0] if names else body.name)
        return found

    # -- derivatives of K -----------------------------------------------------------------------------

    @cached_property
    def momenta(self) -> list[Node]:
        """dK/dq' of K as it is written, for each rate: through the parts that stay together."""
        meanings, graph = self.writer.meanings, self.graph
        direct = gradient(graph, {self.kinetic: graph.one}, [*self.rates.symbols, *meanings])
        found = [direct.get(v, graph.zero) for v in self.rates.symbols]
        for part, meaning in meanings.items():
            if part in direct:
                inner = gradient(graph, {meaning: graph.one}, list(self.rates.symbols))
                found = [
                    x + direct[part] * inner[v] if v in inner else x
                    for x, v in zip(found, self.rates.symbols)
                ]
        return found

    @cached_property
    def slopes(self) -> list[Node]:
        """dK/dq of K as it is written, for each rate."""
        graph, displacement = self.graph, dict(self.rates.displacement)
        meanings = self.writer.meanings
        displacement.update(zip(meanings, tangent(graph, list(meanings.values()), displacement)))
        (change,) = tangent(graph, [self.kinetic], displacement)
        found = gradient(graph, {change: graph.one}, list(self.rates.stars.values()))
        return [found.get(star, graph.zero) for star in self.rates.stars.values()]

    def opened(self, nodes: Sequence[Node]) -> list[Node]:
        """Return expressions with the parts that stay together written out."""
        return substitute(self.graph, nodes, self.writer.meanings)

    # -- blocks -------------------------------------------------------------------------------------

    def heading(self, level: int, text: Text) -> None:
        self.blocks.append(Heading(level, text))

    def paragraph(self, text: Text) -> None:
        self.blocks.append(Paragraph(text))

    def formula(self, *rows: FormulaRow) -> None:
        self.blocks.append(FormulaBlock(rows))

    # -- vectors ------------------------------------------------------------------------------------

    def vector(
        self, vector: Sequence[Node], about: str, leading: Sequence[int] | None = None
    ) -> tuple[str, ...]:
        """Return the lines of a vector in the unit vectors that make it shortest."""
        try:
            return self.components(self.vectors.express(vector), vector, about, leading)
        except (TooLarge, NotFinite):
            parts = [self.writer.lines(x, about, leading)[0] for x in vector]
            units = [unit.latex for unit in self.vectors.world]
            return tuple(
                [rf"{'' if k == 0 else '+ '}{x} \, {u}" for k, (x, u) in enumerate(zip(parts, units))]
            )

    def components(
        self, components: Components, vector: Sequence[Node], about: str, leading: Sequence[int] | None = None
    ) -> tuple[str, ...]:
        """Return the lines of a vector that is the sum of `components`; each of the world is recorded."""
        writer = self.writer
        forms = [(writer.factored(p, leading), unit) for p, unit in components]
        for k in range(3):
            shown = tuple([(form, unit.axis[k]) for form, unit in forms])
            writer.written.append(Written(about, shown, vector[k]))
        terms = []
        for form, unit in forms:
            text = writer.latex.total(form)
            if len(form.terms) > 1:
                terms.append(rf"\left({text}\right) {unit.latex}")
            else:
                terms.append({"1": "", "-1": "-"}.get(text, text + r" \, ") + unit.latex)
        return broken(terms) if terms else (r"\vec{0}",)

    def rotation_letters(self, frame: Frame, star: str = "") -> str:
        return rf"{ROTATION}{star}_{{{subscript(frame.name)}}}"

    def velocity_letters(self, point: str, star: str = "") -> str:
        return rf"{VELOCITY}{star}({point})"

    def chain(self, frame: Frame) -> list[Frame]:
        """Return the frames that lead from the world to a frame, which is the last."""
        by_name, found = {x.name: x for x in self.frames}, list[Frame]()
        current: Frame | None = frame
        while current is not None and current not in found:
            found.append(current)
            current = by_name.get(current.parent)
        return found[::-1]

    @property
    def solids(self) -> list[tuple[Body, Frame]]:
        return [(body, body.frame) for body in self.model.bodies if body.frame is not None]
