"""Divisors that may come near zero: a step that takes them past it, or close by, may hide how large the rates
are there, as where a particle meets a centre of force, or a wall of (s/x)^12.
"""

from __future__ import annotations

from collections.abc import Sequence

from lagc.expr.graph import Graph, Node
from lagc.expr.walk import depends, reachable
from lagc.mechanics.equations import EquationsOfMotion
from lagc.mechanics.intervals import intervals
from lagc.optimize.features import MOST
from lagc.optimize.freezing import deciding


def poles(equations: EquationsOfMotion) -> tuple[Node, ...]:
    """The divisors, each once, without the root that one may be; 1 on branches that ask for none."""
    roots, graph = deciding(equations), equations.graph
    moving = depends(roots, [equations.time, *equations.q, *equations.v])
    found: dict[Node, list[Node]] = {}
    for node in reachable(roots):
        for base in _divisors(node):
            if base in moving:
                found.setdefault(base.args[0] if base.op == "sqrt" else base, []).append(node)
    ranges = intervals(list(found), {})
    near = [base for base in found if ranges[base][0] <= 0.0 <= ranges[base][1]]
    if not near or len(near) > MOST:
        return ()
    asked = _asked(graph, roots)
    return tuple([_where(graph, base, [asked[node] for node in found[base]]) for base in near])


def _divisors(node: Node) -> list[Node]:
    if node.op == "mul":
        return [base for base, exponent in zip(node.args, node.value) if exponent < 0]
    if node.op == "pow" and node.args[1].is_const and node.args[1].value < 0.0:
        return [node.args[0]]
    return []


def _asked(graph: Graph, roots: Sequence[Node]) -> dict[Node, Node]:
    """Of each node the condition under which the values of `roots` depend on it."""
    asked = dict.fromkeys(roots, graph.one)
    for node in reversed(reachable(roots)):
        for k, below in enumerate(node.args):
            own = asked[node]
            if node.op == "select" and k > 0:
                branch = node.args[0] if k == 1 else graph.logical_not(node.args[0])
                own = branch if own is graph.one else graph.binary("and", own, branch)
            known = asked.get(below)
            if known is not None and own is not known:
                own = graph.one if graph.one in (own, known) else graph.binary("or", own, known)
            asked[below] = own
    return asked


def _where(graph: Graph, base: Node, conditions: Sequence[Node]) -> Node:
    if graph.one in conditions:
        return base
    found = conditions[0]
    for condition in conditions[1:]:
        found = graph.binary("or", found, condition)
    return graph.select(found, base, graph.one)
