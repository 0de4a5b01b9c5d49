"""Expressions that are too long to be multiplied out: their parts get names."""

from __future__ import annotations

from collections.abc import Iterable
from math import inf

from lagc.reports.algebra.expansion import HIGHEST, LONG, Parts
from lagc.reports.algebra.polynomials import Frozen, Polynomial, frozen
from lagc.reports.algebra.trigonometry import ShortAlgebra
from lagc.symbolic.graph import Graph, Node


class NamingAlgebra(ShortAlgebra):
    """Takes `shared` nodes, and whatever gets long, as symbols, those of `graph`; `definitions` says what
    they are.  It has no limit: nothing is multiplied out that would be long."""

    def __init__(self, graph: Graph, shared: Iterable[Node], nonnegative: Iterable[Node] = ()) -> None:
        super().__init__(nonnegative, limit=1 << 62)
        self._graph = graph
        self._shared = set(shared)
        self._named: dict[Frozen, Polynomial] = {}
        self.definitions: list[tuple[Node, Polynomial]] = []

    def multiply(self, p: Polynomial, q: Polynomial) -> Polynomial:
        if len(p) * len(q) > LONG**2 and min(len(p), len(q)) > 1:
            p, q = self._name(p), self._name(q)
        return super().multiply(p, q)

    def power(self, p: Polynomial, n: int) -> Polynomial:
        return super().power(self._name(p) if n > HIGHEST else p, n)

    def _name(self, p: Polynomial) -> Polynomial:
        """A symbol for `p`, where it has several terms, but for the factor that all of them share."""
        if len(p) < 2:
            return p
        c, common, rest = self.content(p)
        return super().multiply({common: c}, self._symbol_for(rest))

    def _symbol_for(self, p: Polynomial) -> Polynomial:
        key = frozen(p)
        if key not in self._named:
            node = self._graph.symbol("shown part", str(len(self._named)))
            self.definitions.append((node, p))
            self._named[key] = self.symbol_only(node)
        return self._named[key]

    def _longest(self, node: Node) -> float:
        """The terms of what has no name."""
        return LONG

    def _parts(self, node: Node) -> Parts:
        return []  # what would be long has a name

    def _convert(self, node: Node) -> Polynomial:
        p = super()._convert(node)
        if len(p) < 2 or (node not in self._shared and len(p) <= self._longest(node)):
            return p
        return self._name(p)


class SharedAlgebra(NamingAlgebra):
    """Sums that are not shared stay as they are, whatever their length: they may follow a rule."""

    def _longest(self, node: Node) -> float:
        return inf if node.op == "add" else LONG
