"""What of the equations may be narrow: terms that are nothing for most of a motion, and much for a moment.

exp, tanh and atan of what moves, powers whose exponent does, and quotients by what is never zero, as
of a bell or a smooth step.  Each is put into a measure in which 1 is much.
"""

from __future__ import annotations

from collections.abc import Set

from lagc.lowering.modes import deciding
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.symbolic.enclosures import intervals
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.walk import depends

_STEEP = ("exp", "tanh", "atan")
MOST = 10_000  # beyond, none is looked at


def features(equations: EquationsOfMotion) -> tuple[Node, ...]:
    """Those of the equations, each once."""
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
    """The bases of its powers below zero that move, each with the condition that it is one: the exponent may
    be a parameter."""
    if node.op == "mul":
        return [(base, graph.one) for base, e in zip(node.args, node.value) if e < 0 and base in moving]
    if node.op == "pow" and node.args[0] in moving:
        base, exponent = node.args
        below = graph.one if exponent in moving else graph.binary("lt", exponent, graph.zero)
        return [] if below.is_zero else [(base, below)]
    return []
