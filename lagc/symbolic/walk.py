"""Walks over the expression graph: what is reachable, what depends on what, substitution.

All are loops: `index` order is a topological order, so depth never matters.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping, Sequence
from operator import attrgetter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from lagc.symbolic.graph import Graph, Node

_index = attrgetter("index")


def reachable(nodes: Iterable[Node]) -> list[Node]:
    """Every node below `nodes`, they included, arguments before users."""
    seen = set(nodes)
    stack = list(seen)
    while stack:
        for node in stack.pop().args:
            if node not in seen:
                seen.add(node)
                stack.append(node)
    return sorted(seen, key=_index)


def missing(nodes: Iterable[Node], known: Container[Node]) -> list[Node]:
    """Those nodes below `nodes`, they included, that are not `known`, arguments before users; what is
    below a known one is not looked at."""
    seen = {node for node in nodes if node not in known}
    stack = list(seen)
    while stack:
        for node in stack.pop().args:
            if node not in seen and node not in known:
                seen.add(node)
                stack.append(node)
    return sorted(seen, key=_index)


def within(nodes: Iterable[Node], known: Container[Node]) -> list[Node]:
    """Those below `nodes`, they included, that are `known`, as all are above them, arguments before users."""
    seen = {node for node in nodes if node in known}
    stack = list(seen)
    while stack:
        for node in stack.pop().args:
            if node not in seen and node in known:
                seen.add(node)
                stack.append(node)
    return sorted(seen, key=_index)


def linked(nodes: Iterable[Node], links: Mapping[Node, Sequence[Node]]) -> list[Node]:
    """Every node that `links` lead to from `nodes`, they included, arguments before users."""
    seen = set(nodes)
    stack = list(seen)
    while stack:
        for node in links[stack.pop()]:
            if node not in seen:
                seen.add(node)
                stack.append(node)
    return sorted(seen, key=_index)


def symbols(nodes: Iterable[Node]) -> set[Node]:
    """The symbols that `nodes` are made of."""
    return {node for node in reachable(nodes) if node.op == "symbol"}


def depends(nodes: Iterable[Node], leaves: Iterable[Node]) -> set[Node]:
    """Those nodes below `nodes`, they included, that any of `leaves` can change."""
    touched = set(leaves)
    found: set[Node] = set()
    for node in reachable(nodes):
        if node in touched or not touched.isdisjoint(node.args):
            touched.add(node)
            found.add(node)
    return found


def leaves_below(nodes: Iterable[Node], leaves: Iterable[Node]) -> dict[Node, int]:
    """Which of `leaves` each of `nodes` is made of, arguments before users, as bits of a number; none: left
    out."""
    found = {leaf: 1 << k for k, leaf in enumerate(leaves)}
    for node in nodes:
        if node not in found:
            bits = union(found.get(a, 0) for a in node.args)
            if bits:
                found[node] = bits
    return found


def union(sets: Iterable[int]) -> int:
    """Of sets given as bits."""
    found = 0
    for bits in sets:
        found |= bits
    return found


def substitute(graph: Graph, nodes: Sequence[Node], mapping: Mapping[Node, Node]) -> list[Node]:
    """`nodes` with every key of `mapping` replaced by its value, all at once."""
    replaced: dict[Node, Node] = dict(mapping)
    touched = depends(nodes, mapping)
    for node in sorted(touched, key=_index):
        if node not in replaced:
            replaced[node] = graph.rebuild(node, tuple([replaced.get(a, a) for a in node.args]))
    return [replaced.get(node, node) for node in nodes]
