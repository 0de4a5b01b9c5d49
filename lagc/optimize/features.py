"""What of the equations may be narrow: terms that are nothing for most of a motion, and much for a moment.

exp, tanh and atan of what moves, powers whose exponent does, and quotients by what is never zero, as
of a bell or a smooth step.  Each is put into a measure in which 1 is much.
"""

from __future__ import annotations

from lagc.expr.graph import Node
from lagc.expr.walk import depends
from lagc.mechanics.equations import EquationsOfMotion
from lagc.mechanics.intervals import intervals
from lagc.optimize.freezing import deciding

_STEEP = ("exp", "tanh", "atan")
MOST = 10_000  # beyond, none is looked at


def features(equations: EquationsOfMotion) -> tuple[Node, ...]:
    """Those of the equations, each once."""
    changing = [equations.time, *equations.q, *equations.v]
    moving = depends(deciding(equations), changing)
    moved = sorted(moving, key=lambda node: node.index)
    found = [node for node in moved if node.op in _STEEP or (node.op == "pow" and node.args[1] in moving)]
    bases = [
        base for node in moved if node.op == "mul" for base, e in zip(node.args, node.value)
        if e < 0 and not base.is_const
    ]  # fmt: skip
    least = intervals(bases, {})
    graph = equations.graph
    found += [graph.div(graph.const(least[base][0]), base) for base in bases if least[base][0] > 0.0]
    found = [node for node in dict.fromkeys(found) if not node.is_const]
    return tuple(found) if len(found) <= MOST else ()
