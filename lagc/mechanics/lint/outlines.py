"""Expressions of many leaves as functions of a few sums that they are made of.

The distance of two points far along a chain is a function of where they are, and points of a chain can move
as they like.  What is smooth as a function of their coordinates is smooth in all angles of the chain, and to
ask so takes as much work as the expression itself is long.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Container, Sequence
from functools import cached_property

from lagc.base.records import dataclass
from lagc.mechanics.formulation.states import States
from lagc.mechanics.numeric.dense_linear import dimension
from lagc.mechanics.numeric.samples import Chance
from lagc.symbolic.evaluate import extend
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import leaves_below, missing

_MANY = 24  # leaves
_MOST = 8  # sums, with the leaves beside them
_WAYS = 12
_STEP = 1e-6  # of the sizes of leaves: by it slopes are told
_FREE = frozenset(("symbol", "add", "scale", "sin", "cos"))
_APART = 1e-4  # of the length of gradients: less may be rounding


@dataclass(frozen=True, slots=True)
class Outline:
    """`nodes`, with symbols for sums, as functions of `leaves`."""

    nodes: list[Node]
    leaves: list[Node]


class Outlines:
    """Of expressions in `leaves`; the samples of the states come to know the symbols that stand for sums."""

    def __init__(self, states: States, leaves: Sequence[Node]):
        self._states, self._leaves = states, frozenset(leaves)
        nodes = states.graph.nodes
        self._bits = leaves_below(nodes, leaves)
        self._free = _free(nodes, self._bits)
        self._users = Counter([a for node in nodes for a in set(node.args)])

    @cached_property
    def _samples(self) -> list[dict[Node, float]]:
        return [*self._states.scattered, *self._states.near]

    @cached_property
    def _known(self) -> list[dict[Node, float]]:
        """What expressions are at the samples, and beside the first of them."""
        first, chance = self._samples[0], Chance(577)
        moving = [x for x in first if x in self._leaves]
        beside = [
            {**first, **{x: first[x] + _STEP * (abs(first[x]) or 1.0) * chance.draw() for x in moving}}
            for _ in range(_WAYS)
        ]
        return [dict(state) for state in (*self._samples, *beside)]

    def of(self, nodes: Sequence[Node]) -> Outline | None:
        """None of what has few leaves, or where sums depend on each other."""
        if all([self._bits.get(node, 0).bit_count() <= _MANY for node in nodes]):
            return None
        sums, own = self._parts(nodes)
        leaves = [x for x in own if x in self._leaves]
        if not sums or len(sums) + len(leaves) > _MOST or not self._samples:
            return None
        for known in self._known:
            extend(known, sums)
        if not self._independent([*leaves, *sums]):
            return None
        graph = self._states.graph
        found = {x: graph.symbol("sum", str(x.index)) for x in sums}
        for state, known in zip(self._samples, self._known):
            state.update((symbol, known[x]) for x, symbol in found.items())
        leaves += found.values()
        for x in own:
            found[x] = graph.rebuild(x, tuple([found[a] for a in x.args])) if x.args else x
        return Outline([found[node] for node in nodes], leaves)

    def _parts(self, nodes: Sequence[Node]) -> tuple[list[Node], list[Node]]:
        """The sums of several leaves that other expressions are made of, too, and what is made of them."""
        sums: dict[Node, None] = {}
        seen, stack = set(nodes), list(nodes)
        while stack:
            for node in stack.pop().args:
                shared = self._users[node] > 1 and self._bits.get(node, 0).bit_count() > 1
                if node.op == "add" and shared and node in self._free:
                    sums[node] = None
                elif node not in seen:
                    seen.add(node)
                    stack.append(node)
        return list(sums), missing(nodes, sums)

    def _independent(self, nodes: Sequence[Node]) -> bool:
        """Whether their gradients are."""
        first, beside = self._known[0], self._known[len(self._samples) :]
        vectors = []
        for node in nodes:
            moved = [known[node] - first[node] for known in beside]
            size = sum([x * x for x in moved]) ** 0.5
            if not 0.0 < size < float("inf"):
                return False
            vectors.append([x / size for x in moved])
        return dimension(vectors, _APART) == len(nodes)


def _free(nodes: Sequence[Node], moving: Container[Node]) -> set[Node]:
    """Those that have no end that they touch and do not pass, as far as squares, roots and the like tell."""
    found: set[Node] = set()
    for node in nodes:
        if node.op == "mul":
            whole = all([exponent == 1 for base, exponent in zip(node.args, node.value) if base in moving])
        else:
            whole = node.op in _FREE
        if node not in moving or (whole and all([a in found for a in node.args])):
            found.add(node)
    return found
