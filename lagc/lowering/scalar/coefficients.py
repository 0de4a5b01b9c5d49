"""What depends on parameters alone, put together in each product: it is computed once, when they are bound.

In m*l*sin(a)*w^2 the factors m*l become one symbol, a *coefficient*, before common factors are looked for.
Sums are left as they are: moving a constant out of (x - x0) + (y - y0) would lose digits.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.operators import TRUTHS
from lagc.symbolic.walk import reachable


class Coefficients:
    """`nodes`, with their coefficients as symbols, and the `meaning` of each.  `constants` are the symbols of
    parameters."""

    def __init__(self, graph: Graph, nodes: Sequence[Node], constants: Collection[Node]) -> None:
        self.graph = graph
        self.meaning: dict[Node, Node] = {}
        self._fixed: set[Node] = set()
        self._new: dict[Node, Node] = {}
        changed: set[Node] = set()  # of those that move
        for node in reachable(nodes):
            if node.op == "const" or node in constants or (node.args and self._fixed.issuperset(node.args)):
                self._fixed.add(node)
            elif self._fixed.isdisjoint(node.args) and changed.isdisjoint(node.args):
                self._new[node] = node
            else:
                found = self._new[node] = self._moving(node)
                if found is not node:
                    changed.add(node)
        self.nodes = [self._used(node) for node in nodes]

    def _used(self, node: Node) -> Node:
        return self._coefficient(node) if node in self._fixed else self._new[node]

    def _moving(self, node: Node) -> Node:
        if node.op == "mul":
            return self._monomial(node)
        if node.op == "scale":
            return self._scaled(node.value, self._new[node.args[0]])
        return self.graph.rebuild(node, tuple([self._used(a) for a in node.args]))

    def _monomial(self, node: Node) -> Node:
        graph, factors = self.graph, list(zip(node.args, node.value))
        coefficient = graph.product([(b, e) for b, e in factors if b in self._fixed])
        rest = graph.product([(self._new[b], e) for b, e in factors if b not in self._fixed])
        return graph.mul(self._coefficient(coefficient), rest)

    def _scaled(self, c: float, node: Node) -> Node:
        """A number times a product: it goes into the coefficient."""
        graph = self.graph
        for base, exponent in zip(node.args, node.value) if node.op == "mul" else ():
            if exponent == 1 and (base in self.meaning or base in self._fixed):
                coefficient = graph.scale(c, self.meaning.get(base, base))
                return graph.mul(self._coefficient(coefficient), graph.div(node, base))
        return graph.scale(c, node)

    def _coefficient(self, node: Node) -> Node:
        """The symbol of a constant; of what needs no operation, that itself."""
        if node.op in ("const", "symbol") or node.op in TRUTHS:
            return node
        if node.op == "scale" and node.value < 0.0:
            return -self._coefficient(-node)
        symbol = self.graph.symbol("coefficient", str(node.index))
        self.meaning[symbol] = node
        return symbol
