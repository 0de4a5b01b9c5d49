"""The branches of piecewise expressions: every comparison is taken as true and as false.

A property holds on each branch, whether or not tested states lie on it: a force may act beyond three turns
only. Comparisons of parameters alone are decided by their values.

If there are many conditions, branches are blended: each condition is a random number c of the finite field,
and `if` is c x + (1 - c) y. An expression that is zero then is zero for all c, so on every branch.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations, product

from lagc.base.records import dataclass
from lagc.symbolic.evaluate import evaluate
from lagc.symbolic.finite_field import P, Point
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.operators import COMPARISONS, OPERATORS
from lagc.symbolic.walk import reachable, substitute, symbols

Signs = dict[Node, int]  # difference of two sides -> 1 or -1, or 0: both are blended
_SIDES = {op: row.sides for op, row in OPERATORS.items() if row.sides is not None}
_SEED = 91
_MOST = 8  # differences whose combinations of signs are all tried
_MOST_PAIRED = 12  # differences whose pairs are


def spelt_out(graph: Graph, nodes: Sequence[Node]) -> list[Node]:
    """`nodes` with comparisons in the place of abs, sign, min, max and roots of squares."""
    kinks = [node for node in reachable(nodes) if node.op in _SIDES or _is_root_of_square(node)]
    if not kinks:
        return list(nodes)
    spelt: dict[Node, Node] = {}
    for node in kinks:  # arguments before users
        args = substitute(graph, node.args, spelt)
        if node.op == "sqrt":
            (x,) = args
            factor, square = (x.value, x.args[0]) if x.op == "scale" else (1.0, x)
            root = graph.scale(
                math.sqrt(factor), graph.product((b, e // 2) for b, e in zip(square.args, square.value))
            )
            spelt[node] = graph.select(graph.binary("lt", graph.zero, root), root, -root)
        else:
            spelt[node] = _SIDES[node.op](graph, *args)
    return substitute(graph, nodes, spelt)


def _is_root_of_square(node: Node) -> bool:
    if node.op != "sqrt":
        return False
    (x,) = node.args
    if x.op == "scale" and x.value > 0.0:
        x = x.args[0]
    return x.op == "mul" and all(e % 2 == 0 for e in x.value)


@dataclass(frozen=True, slots=True)
class Comparison:
    """lt, le or eq of two sides whose difference is `factor` times `difference`."""

    node: Node
    difference: Node
    factor: float

    def holds(self, sign: int) -> bool:
        return self.node.op != "eq" and sign * self.factor < 0

    def share(self, below: int) -> int:
        """The number for it, where that of `difference < 0` is `below`."""
        return 0 if self.node.op == "eq" else below if self.factor > 0 else (1 - below) % P


class Branches:
    """Those of `nodes`, which hold no abs, sign, min, max; `values` are those of the parameters."""

    def __init__(self, graph: Graph, nodes: Sequence[Node], values: Mapping[Node, float]):
        self._graph, self._values = graph, values
        self.comparisons = [self._comparison(x) for x in reachable(nodes) if x.op in COMPARISONS]
        free = [c for c in self.comparisons if not symbols([c.node]) <= values.keys()]
        self.differences = list(dict.fromkeys(c.difference for c in free))

    def _comparison(self, node: Node) -> Comparison:
        difference = self._graph.sub(*node.args)
        if difference.op == "scale":
            return Comparison(node, difference.args[0], difference.value)
        turned = self._graph.sub(node.args[1], node.args[0])
        if turned.index < difference.index:
            return Comparison(node, turned, -1.0)
        return Comparison(node, difference, 1.0)

    @property
    def complete(self) -> bool:
        """`all` gives all of them."""
        return len(self.differences) <= _MOST

    def all(self) -> Iterator[Signs]:
        """Return the combinations of signs: all of them, or if they are many, those that differ from equal
        signs in one or two."""
        count = len(self.differences)
        if self.complete:
            for signs in product((1, -1), repeat=count):
                yield dict(zip(self.differences, signs))
            return
        other = [(k,) for k in range(count)]
        pairs = list(combinations(range(count), 2)) if count <= _MOST_PAIRED else []
        for rest in (1, -1):
            for turned in [(), *other, *pairs]:
                yield {d: -rest if k in turned else rest for k, d in enumerate(self.differences)}

    def blended(self) -> Signs:
        return dict.fromkeys(self.differences, 0)

    def truths(self, signs: Signs) -> dict[Node, int]:
        """Of every comparison, where the differences have these signs."""
        found: dict[Node, int] = {}
        chance = Point(_SEED)
        blended = sorted([d for d, sign in signs.items() if not sign], key=lambda d: d.index)
        shares = {d: chance.draw() for d in blended}
        for c in self.comparisons:
            if c.difference in shares:
                found[c.node] = c.share(shares[c.difference])
            elif c.difference in signs:
                found[c.node] = c.holds(signs[c.difference])
            else:
                found[c.node] = bool(evaluate([c.node], self._values)[0])
        return found
