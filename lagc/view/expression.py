"""Single expressions of a model, as a person would write them."""

from __future__ import annotations

from lagc.expr.graph import Node
from lagc.expr.walk import reachable
from lagc.mechanics.equations import EquationsOfMotion
from lagc.view.algebra import TooLarge
from lagc.view.formulas import collector_of, nonnegative, tidy
from lagc.view.names import Name, names
from lagc.view.polynomials import NotFinite
from lagc.view.text import TextWriter
from lagc.view.trigonometry import ShortAlgebra

LIMIT, WHOLE = 20_000, 400_000  # products
LONGEST = 600  # characters


class Expressions:
    """Writes expressions in t, q, v and the parameters of `equations`: of any length where they are asked for
    as a `whole`; or else long sums by their rule, and where that is too long as well, how long they are."""

    def __init__(self, equations: EquationsOfMotion, whole: bool) -> None:
        self.equations, self.whole = equations, whole
        self.names = names(equations)
        self.seen: set[Name] = set()

    def text(self, node: Node) -> str:
        """`node` multiplied out and collected."""
        return self.short(node) or f"(an expression of {len(reachable([node]))} parts)"

    def short(self, node: Node) -> str:
        """The same, and "" for what is too long."""
        algebra = ShortAlgebra(nonnegative(self.equations), limit=WHOLE if self.whole else LIMIT)
        try:
            collector = collector_of(self.equations, algebra)
            p = tidy(self.equations, algebra, algebra.polynomials([node])[0])
            terms = collector.collect(p)
            for abridged in (False, True):
                writer = TextWriter(collector, self.names, abridged)
                written = writer.sum(terms)
                if self.whole or len(written) <= LONGEST:
                    self.seen |= writer.seen
                    return written
        except (TooLarge, NotFinite):
            pass
        return ""
