"""Derivatives of many expressions by many leaves, by the sums that they share where these are fewer.

Expressions that build on shared sums, as the places of points along a chain, have as many derivatives as
there are pairs of an expression and a leaf before it.  Where these are far more than the expressions are made
of, the derivatives are given by leaves *and* sums, and those of each sum likewise.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property

from lagc.base.records import dataclass, replace
from lagc.symbolic.derivative import gradient
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.walk import depends, reachable, substitute, union, within

_WORTH = 2  # times as many derivatives as by sums


@dataclass(frozen=True)
class Slopes:
    """The derivatives of each expression, and of each sum by what comes before it: column -> derivative,
    zeros left out.  The columns are the `leaves`, then the sums."""

    graph: Graph
    rows: list[dict[int, Node]]
    sums: list[dict[int, Node]]
    leaves: int

    @property
    def nodes(self) -> list[Node]:
        """All that derivatives are made of."""
        return [node for own in (*self.rows, *self.sums) for node in own.values()]

    @cached_property
    def columns(self) -> list[list[int]]:
        """The leaves that each expression depends on, as far as structure tells."""
        if not self.sums:
            return [list(row) for row in self.rows]
        known = [1 << k for k in range(self.leaves)]
        for own in self.sums:
            known.append(union(known[k] for k in own))
        return [_places(union(known[k] for k in row)) for row in self.rows]

    def entries(self, k: int) -> dict[int, Node]:
        """The derivatives of expression k by leaves alone, put together."""
        found = self.total([k])
        return {j: found.get(j, self.graph.zero) for j in self.columns[k]}

    def total(self, numbers: Sequence[int]) -> dict[int, Node]:
        """Of the sum of these expressions."""
        found: dict[int, Node] = {}
        for k in numbers:
            for j, slope in self.rows[k].items():
                found[j] = found[j] + slope if j in found else slope
        for column in range(self.leaves + len(self.sums) - 1, self.leaves - 1, -1):
            if column in found:
                weight = found.pop(column)
                for j, slope in self.sums[column - self.leaves].items():
                    share = weight * slope
                    found[j] = found[j] + share if j in found else share
        return found

    def weighted(self, weights: Sequence[Mapping[int, Node]]) -> Slopes:
        """Those of sums of expressions with these weights."""
        found: list[dict[int, Node]] = []
        for own in weights:
            row: dict[int, Node] = {}
            for k, weight in own.items():
                for j, slope in self.rows[k].items():
                    share = weight * slope
                    row[j] = row[j] + share if j in row else share
            found.append(row)
        return replace(self, rows=found)

    def mapped(self, values: Callable[[Sequence[Node]], Sequence[Node]]) -> Slopes:
        """With other derivatives, as many."""
        new = iter(values(self.nodes))
        found = [{k: next(new) for k in own} for own in (*self.rows, *self.sums)]
        return replace(self, rows=found[: len(self.rows)], sums=found[len(self.rows) :])

    def placed(self, places: Mapping[int, int], size: int) -> Slopes:
        """With the leaves at other places of `size`, and without those that have none."""
        new = {**places, **{self.leaves + k: size + k for k in range(len(self.sums))}}
        rows, sums = ([{new[k]: x for k, x in own.items() if k in new} for own in part]
                      for part in (self.rows, self.sums))  # fmt: skip
        return replace(self, rows=rows, sums=sums, leaves=size)


def slopes(
    graph: Graph, nodes: Sequence[Node], places: Mapping[Node, int], size: int, few: int = 0
) -> Slopes:
    """The derivatives of `nodes` by the leaves that have `places`, of `size` that there are; where these are
    `few` they are not given by sums."""
    found = by_sums(graph, nodes, places, size, few)
    return found or Slopes(graph, _gradients(graph, nodes, places), [], size)


def by_sums(
    graph: Graph, nodes: Sequence[Node], places: Mapping[Node, int], size: int, few: int = 0
) -> Slopes | None:
    """The same by sums; None where that leaves not far fewer."""
    shared = _shared(nodes, places, few)
    found = _through(graph, nodes, places, size, shared) if shared else None
    if found is None or sum(map(len, found.columns)) <= _WORTH * len(found.nodes):
        return None  # some derivatives turned out to be 0
    return found


def _shared(nodes: Sequence[Node], leaves: Mapping[Node, int], few: int) -> list[Node]:
    """The sums that are used more than once, where that leaves far fewer derivatives."""
    order = reachable(nodes)
    users = Counter([*nodes, *(a for node in order for a in set(node.args))])
    whole = {x: 1 << k for k, x in enumerate(leaves)}
    own, sums, next_bit = dict(whole), dict[Node, int](), len(whole)
    for node in order:
        if node in whole:
            continue
        bits = union(whole.get(a, 0) for a in node.args)
        if bits:
            whole[node], own[node] = bits, union(own.get(a, 0) for a in node.args)
            if node.op == "add" and users[node] > 1 and own[node].bit_count() > 1:
                sums[node], own[node] = own[node], 1 << next_bit
                next_bit += 1
    plain = sum([whole.get(node, 0).bit_count() for node in nodes])
    fewer = sum([own.get(node, 0).bit_count() for node in nodes]) + sum(
        [b.bit_count() for b in sums.values()]
    )
    return list(sums) if plain > max(_WORTH * fewer, few) else []


def _through(
    graph: Graph, nodes: Sequence[Node], places: Mapping[Node, int], size: int, shared: Sequence[Node]
) -> Slopes:
    """The derivatives by leaves and the sums that are `shared`, each of which a symbol stands for."""
    symbols = {x: graph.symbol("sum", str(size + k)) for k, x in enumerate(shared)}
    found: dict[Node, Node] = dict(symbols)
    made: dict[Node, Node] = {}
    for node in reachable(nodes):
        args = tuple([found[a] for a in node.args])
        made[node] = graph.rebuild(node, args) if args else node
        found.setdefault(node, made[node])
    by = {**places, **{symbols[x]: size + k for k, x in enumerate(shared)}}
    own = _gradients(graph, [*(found[node] for node in nodes), *(made[x] for x in shared)], by)
    outlined = Slopes(graph, own[: len(nodes)], own[len(nodes) :], size)
    back = {symbol: x for x, symbol in symbols.items()}
    return outlined.mapped(lambda slopes: substitute(graph, slopes, back))


def _gradients(graph: Graph, nodes: Sequence[Node], by: Mapping[Node, int]) -> list[dict[int, Node]]:
    """Of each node, by what has a column."""
    moving = depends(nodes, by)
    found = (gradient(graph, {node: graph.one}, by, within([node], moving)) for node in nodes)
    return [{by[x]: slope for x, slope in own.items()} for own in found]


def _places(bits: int) -> list[int]:
    """Of the ones."""
    return [k for k, digit in enumerate(reversed(f"{bits:b}")) if digit == "1"]
