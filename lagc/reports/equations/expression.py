"""Single expressions of a model, as a person would write them."""

from __future__ import annotations

from collections.abc import Sequence

from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.reports.algebra.expansion import TooLarge
from lagc.reports.algebra.polynomials import NotFinite
from lagc.reports.algebra.trigonometry import ShortAlgebra
from lagc.reports.equations.formulas import collector_of, nonnegative, tidy
from lagc.reports.equations.page import in_parts
from lagc.reports.equations.text import TextWriter
from lagc.reports.names import Name, names, taken
from lagc.reports.patterns.formula_trees import Former
from lagc.reports.patterns.index_rules import summed
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import reachable

LIMIT, WHOLE = 20_000, 800_000  # products: of one expression; of wholes, each half of what is left
LONGEST = 600  # characters
PARTS = 24  # lines that say the parts of expressions


class Expressions:
    """Writes expressions in t, q, v and the parameters of `equations`: of any length where they are asked for
    as a `whole`; or else long sums by their rule, and where that is too long as well, how long they are."""

    def __init__(self, equations: EquationsOfMotion, whole: bool) -> None:
        self.equations, self.whole = equations, whole
        self.names = names(equations)
        self.seen: set[Name] = set()
        self.left = WHOLE

    def text(self, node: Node) -> str:
        """`node` multiplied out and collected."""
        return self.short(node) or f"(an expression of {len(reachable([node]))} parts)"

    def short(self, node: Node) -> str:
        """The same, and "" for what is too long."""
        limit = max(LIMIT, self.left // 2) if self.whole else LIMIT
        algebra = ShortAlgebra(nonnegative(self.equations), limit=limit)
        try:
            collector = collector_of(self.equations, algebra)
            p = tidy(self.equations, algebra, algebra.polynomials([node])[0])
            found = Former(collector, self.names).total(collector.collect(p))
            for form in (found,) if self.whole else (found, summed(found, taken(self.names))):
                writer = TextWriter(self.names)
                written = writer.total(form)
                if self.whole or len(written) <= LONGEST:
                    self.seen |= writer.seen
                    return written
        except (TooLarge, NotFinite):
            pass
        finally:
            self.left -= algebra.spent
        return ""

    def texts(self, nodes: Sequence[Node]) -> tuple[list[str], list[str]]:
        """As `text`; what is too long by rules where it follows such, and lines that say its parts."""
        short = [self.short(node) for node in nodes]
        long = [k for k, text in enumerate(short) if not text]
        if self.whole or not long:
            return [text or self.text(node) for text, node in zip(short, nodes)], []
        try:
            found = in_parts(self.equations, [nodes[k] for k in long])
        except NotFinite:
            return [text or self.text(node) for text, node in zip(short, nodes)], []
        writer = TextWriter(found.names)
        sums = [writer.total(line.left) for line in found.lines if line.kind == "motion"]
        parts = [writer.line(line) for line in found.lines if line.kind == "shared"]
        if len(parts) > PARTS or max(map(len, [*sums, *parts])) > LONGEST:
            return [text or self.text(node) for text, node in zip(short, nodes)], []
        self.seen |= writer.seen
        for k, text in zip(long, sums):
            short[k] = text
        return short, parts
