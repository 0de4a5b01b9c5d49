"""Narrow terms of the equations: negligible for most of a motion, and large for a moment.

These are exp, tanh and atan of varying arguments, powers with varying exponents, and quotients by divisors
that never vanish, as in a bell or a smooth step. Each is scaled so that 1 is large.
"""

from __future__ import annotations

from collections.abc import Sequence, Set

from lagc.lowering.event_relations import deciding
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.symbolic.enclosures import intervals
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.walk import depends, reachable

_STEEP = ("exp", "tanh", "atan")
MOST = 10_000  # beyond, none is looked at


def features(equations: EquationsOfMotion) -> tuple[Node, ...]:
    changing = [equations.time, *equations.q, *equations.v]
    moving = depends(deciding(equations), changing)
    moved = sorted(moving, key=lambda node: node.index)
    found = [node for node in moved if node.op in _STEEP or (node.op == "pow" and node.args[1] in moving)]
    graph = equations.graph
    below = [pair for node in moved for pair in divisors(graph, node, moving)]
    ranges = intervals([base for base, _ in below], {})
    for base, divides in below:
        least = ranges[base][0]
        if least > 0.0:
            found.append(graph.select(divides, graph.div(graph.const(least), base), graph.one))
    found = [node for node in dict.fromkeys(found) if not node.is_const]
    return tuple(found) if len(found) <= MOST else ()


def divisors(graph: Graph, node: Node, moving: Set[Node]) -> list[tuple[Node, Node]]:
    """Return the varying bases of negative powers, each with the condition that the exponent, which may be a
    parameter, is negative."""
    if node.op == "mul":
        return [(base, graph.one) for base, e in zip(node.args, node.value) if e < 0 and base in moving]
    if node.op == "pow" and node.args[0] in moving:
        base, exponent = node.args
        below = graph.one if exponent in moving else graph.binary("lt", exponent, graph.zero)
        return [] if below.is_zero else [(base, below)]
    return []


def poles(equations: EquationsOfMotion) -> tuple[Node, ...]:
    """The divisors, each once, without the root that one may be; 1 on branches that ask for none."""
    roots, graph = deciding(equations), equations.graph
    moving = depends(roots, [equations.time, *equations.q, *equations.v])
    found: dict[Node, list[tuple[Node, Node]]] = {}  # with the nodes that divide by them, and when these do
    for node in reachable(roots):
        for base, divides in divisors(graph, node, moving):
            found.setdefault(base.args[0] if base.op == "sqrt" else base, []).append((node, divides))
    ranges = intervals(list(found), {})
    near = [base for base in found if ranges[base][0] <= 0.0 <= ranges[base][1]]
    if not near or len(near) > MOST:
        return ()
    asked = _asked(graph, roots)
    return tuple([
        _where(graph, base, [_both(graph, asked[node], divides) for node, divides in found[base]])
        for base in near
    ])  # fmt: skip


def _asked(graph: Graph, roots: Sequence[Node]) -> dict[Node, Node]:
    """Of each node the condition under which the values of `roots` depend on it."""
    asked = dict.fromkeys(roots, graph.one)
    for node in reversed(reachable(roots)):
        for k, below in enumerate(node.args):
            own = asked[node]
            if node.op == "select" and k > 0:
                branch = node.args[0] if k == 1 else graph.logical_not(node.args[0])
                own = _both(graph, own, branch)
            known = asked.get(below)
            if known is not None and own is not known:
                own = graph.one if graph.one in (own, known) else graph.binary("or", own, known)
            asked[below] = own
    return asked


def _both(graph: Graph, x: Node, y: Node) -> Node:
    if graph.one in (x, y):
        return y if x is graph.one else x
    return graph.binary("and", x, y)


def _where(graph: Graph, base: Node, conditions: Sequence[Node]) -> Node:
    if graph.one in conditions:
        return base
    found = conditions[0]
    for condition in conditions[1:]:
        found = graph.binary("or", found, condition)
    return graph.select(found, base, graph.one)
