"""Walks over the expression graph: reachable nodes, dependence, substitution, evaluation on floats.

All walks are loops, because `index` order is a topological order.
"""

import math
from collections.abc import Container, Iterable, Mapping, Sequence
from operator import attrgetter

from lagc.diagnostics.faults import Fault, Refused
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.operators import VALUES

_index = attrgetter("index")


def reachable(nodes: Iterable[Node]) -> list[Node]:
    """Return `nodes` and every node below them, arguments before users."""
    # Depth first without recursion; the indices give the topological order at the end.
    seen = set(nodes)
    stack = list(seen)
    while stack:
        for node in stack.pop().args:
            if node not in seen:
                seen.add(node)
                stack.append(node)
    return sorted(seen, key=_index)


def missing(nodes: Iterable[Node], known: Container[Node]) -> list[Node]:
    """Return the nodes at or below `nodes` that are not `known`, arguments before users; known ones are not
    descended."""
    seen = {node for node in nodes if node not in known}
    stack = list(seen)
    while stack:
        for node in stack.pop().args:
            if node not in seen and node not in known:
                seen.add(node)
                stack.append(node)
    return sorted(seen, key=_index)


def within(nodes: Iterable[Node], known: Container[Node]) -> list[Node]:
    """Return the nodes at or below `nodes` that are reached through `known` nodes only, arguments before
    users."""
    seen = {node for node in nodes if node in known}
    stack = list(seen)
    while stack:
        for node in stack.pop().args:
            if node not in seen and node in known:
                seen.add(node)
                stack.append(node)
    return sorted(seen, key=_index)


def linked(nodes: Iterable[Node], links: Mapping[Node, Sequence[Node]]) -> list[Node]:
    """Return every node that `links` reach from `nodes`, arguments before users."""
    seen = set(nodes)
    stack = list(seen)
    while stack:
        for node in links[stack.pop()]:
            if node not in seen:
                seen.add(node)
                stack.append(node)
    return sorted(seen, key=_index)


def symbols(nodes: Iterable[Node]) -> set[Node]:
    return {node for node in reachable(nodes) if node.op == "symbol"}


def depends(nodes: Iterable[Node], leaves: Iterable[Node]) -> set[Node]:
    """Return the nodes at or below `nodes` that depend on any of `leaves`."""
    touched = set(leaves)
    found: set[Node] = set()
    for node in reachable(nodes):
        if node in touched or not touched.isdisjoint(node.args):
            touched.add(node)
            found.add(node)
    return found


def leaves_below(nodes: Iterable[Node], leaves: Iterable[Node]) -> dict[Node, int]:
    """Return the leaves below each of `nodes` (arguments before users) as bits; nodes without leaves are left
    out."""
    found = {leaf: 1 << k for k, leaf in enumerate(leaves)}
    for node in nodes:
        if node not in found:
            bits = union(found.get(a, 0) for a in node.args)
            if bits:
                found[node] = bits
    return found


def union(sets: Iterable[int]) -> int:
    """Return the union of sets given as bits."""
    found = 0
    for bits in sets:
        found |= bits
    return found


def substitute(graph: Graph, nodes: Sequence[Node], mapping: Mapping[Node, Node]) -> list[Node]:
    """Return `nodes` with every key of `mapping` replaced by its value, all at once."""
    replaced: dict[Node, Node] = dict(mapping)
    # Only nodes above a key change; each is rebuilt once, from its changed arguments.
    touched = depends(nodes, mapping)
    for node in sorted(touched, key=_index):
        if node not in replaced:
            replaced[node] = graph.rebuild(node, tuple([replaced.get(a, a) for a in node.args]))
    return [replaced.get(node, node) for node in nodes]


def evaluate(
    nodes: Sequence[Node], values: Mapping[Node, float], within: Sequence[Node] | None = None
) -> list[float]:
    """Return the values of `nodes`, given those of their symbols. `within`: all nodes below `nodes`,
    arguments before users, if they are known already.  Outside the domain of a function the value is NaN, as
    in C.  Raises KeyError for a symbol without a value."""
    known: dict[Node, float] = dict(values)
    for node in reachable(nodes) if within is None else within:
        if node not in known:
            known[node] = value_of(node, known)
    return [known[node] for node in nodes]


def value_of(node: Node, known: Mapping[Node, float]) -> float:
    """Return the value of a node whose arguments are `known`."""
    op = node.op
    if op == "const":
        return float(node.value)
    if op == "symbol":
        raise KeyError(node.value)
    x = [known[a] for a in node.args]
    try:
        if op == "add":
            return x[0] + x[1]
        if op == "scale":
            return float(node.value * x[0])
        if op == "mul":
            product = 1.0
            for base, exponent in zip(x, node.value):
                product *= base**exponent
            return product
        if node.value is not None:
            return float(VALUES[op](node.value, *x))
        return float(VALUES[op](*x))
    except (ValueError, ZeroDivisionError, OverflowError):
        return math.nan


def double(value: float) -> float:
    """Return `value`.  Raises Refused (LAG0590) if it is not finite."""
    if value - value != 0.0:
        raise Refused((Fault("LAG0590", "a number in the equations is too large for a double", None),))
    return value
