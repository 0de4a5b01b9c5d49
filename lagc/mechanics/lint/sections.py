"""Rows of many unknowns as functions of the few that are nearest to them, with all else as on one state.

The zeros of a section are zeros of the row, and where a slope of it does not vanish the gradient of the row
does not.  To ask so takes as much work as the row has near itself.
"""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Mapping, Sequence
from functools import cached_property

from lagc.base.records import dataclass
from lagc.mechanics.formulation.equations import Row
from lagc.mechanics.formulation.states import States
from lagc.symbolic.derivative import gradient
from lagc.symbolic.evaluate import extend
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import leaves_below, reachable, union

_MANY = 24  # unknowns
_NEAR = 8  # speeds


@dataclass(frozen=True, slots=True)
class Section:
    """`node` and its `slopes` by speeds; `states` differ in the unknowns alone, and hold all else."""

    node: Node
    slopes: dict[Node, Node]
    states: list[Mapping[Node, float]]


class Sections:
    """Of `rows`, through the state `given`; `carried` are the coordinates that each speed moves."""

    def __init__(
        self,
        states: States,
        rows: Sequence[Row],
        given: Mapping[Node, float],
        carried: Mapping[Node, Mapping[Node, Node]],
    ):
        self._states, self._carried, self._given = states, carried, given
        self._leaves = (*states.q, *states.v)
        self._ends = [x for row in rows for x in (row.residual, row.rate)]

    @cached_property
    def _bits(self) -> dict[Node, int]:
        return leaves_below(reachable(self._ends), self._leaves)

    @cached_property
    def _known(self) -> dict[Node, float]:
        known = dict(self._given)
        extend(known, self._ends)
        return known

    def of(self, row: Row, tries: Sequence[Mapping[Node, float]]) -> Section | None:
        """Through the state with the nearest unknowns as in `tries`; None where it has not many unknowns."""
        if len(self._leaves) <= _MANY or self._bits[row.rate].bit_count() <= _MANY:
            return None
        graph, speeds = self._states.graph, self._nearest(row.rate)
        moving = [*speeds, *(q for v in speeds for q in self._carried[v])]
        moved = union(self._bits[x] for x in moving)
        node, rate = self._held([row.residual, row.rate], moved)
        slopes = gradient(graph, {rate: graph.one}, speeds)
        return Section(node, slopes, [ChainMap({x: s[x] for x in moving}, self._known) for s in tries])

    def _nearest(self, node: Node) -> list[Node]:
        """The speeds that are the fewest operations below."""
        speeds = self._states.place_of_v
        found: dict[Node, None] = {}
        layer, seen = [node], {node}
        while layer and len(found) < _NEAR:
            found.update((x, None) for x in layer if x in speeds)
            layer = [a for x in layer for a in x.args if a in self._bits and a not in seen]
            layer = list(dict.fromkeys(layer))
            seen.update(layer)
        return list(found)[:_NEAR]

    def _held(self, nodes: Sequence[Node], moved: int) -> list[Node]:
        """`nodes` with a symbol for everything else below them."""
        graph, bits = self._states.graph, self._bits
        local, stack = set(nodes), list(nodes)
        while stack:
            for a in stack.pop().args:
                if bits.get(a, 0) & moved and a not in local:
                    local.add(a)
                    stack.append(a)
        found: dict[Node, Node] = {}
        for node in sorted(local, key=lambda node: node.index):
            for a in node.args:
                if a not in found:
                    found[a] = self._symbol(a)
            found[node] = graph.rebuild(node, tuple([found[a] for a in node.args])) if node.args else node
        return [found[node] for node in nodes]

    def _symbol(self, node: Node) -> Node:
        if not node.args:
            return node
        symbol = self._states.graph.symbol("held", str(node.index))
        self._known[symbol] = self._known[node]
        return symbol
