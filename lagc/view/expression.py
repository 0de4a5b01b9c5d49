"""Single expressions of a model, as a person would write them."""

from __future__ import annotations

from lagc.expr.graph import Node
from lagc.expr.walk import reachable
from lagc.mechanics.equations import EquationsOfMotion
from lagc.view.algebra import Algebra, TooLarge
from lagc.view.formulas import collector_of, nonnegative, tidy
from lagc.view.names import Name, names
from lagc.view.polynomials import NotFinite
from lagc.view.text import TextWriter

LIMIT = 20_000  # products
LONGEST = 600  # characters


class Expressions:
    """Writes expressions in t, q, v and the parameters of `equations`."""

    def __init__(self, equations: EquationsOfMotion) -> None:
        self.equations = equations
        self.names = names(equations)
        self.seen: set[Name] = set()

    def text(self, node: Node) -> str:
        """`node` multiplied out and collected; of one that is too long to be read, its size."""
        algebra = Algebra(nonnegative(self.equations), limit=LIMIT)
        try:
            collector = collector_of(self.equations, algebra)
            p = tidy(self.equations, algebra, algebra.polynomials([node])[0])
            writer = TextWriter(collector, self.names)
            written = writer.sum(collector.collect(p))
        except (TooLarge, NotFinite):
            written = ""
        if 0 < len(written) <= LONGEST:
            self.seen |= writer.seen
            return written
        return f"(an expression of {len(reachable([node]))} parts)"
