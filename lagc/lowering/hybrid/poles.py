"""Divisors that may come near zero: a step that takes them past it, or close by, may hide how large the rates
are there, as where a particle meets a centre of force, or a wall of (s/x)^12.
"""

from __future__ import annotations

from collections.abc import Sequence

from lagc.lowering.hybrid.step_guards import MOST, divisors
from lagc.lowering.modes import deciding
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.symbolic.enclosures import intervals
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.walk import depends, reachable


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
