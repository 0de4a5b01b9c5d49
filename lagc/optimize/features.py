"""What of the equations may be narrow: terms that are nothing for most of a motion, and much for a moment.

exp, tanh and atan of what moves, powers whose exponent does, and quotients by what is never zero, as
of a bell or a smooth step.  Each is put into a measure in which 1 is much.
"""

from __future__ import annotations

from collections.abc import Sequence

from lagc.expr.enclosure import enclosures
from lagc.expr.graph import Node
from lagc.expr.walk import depends
from lagc.mechanics.equations import EquationsOfMotion
from lagc.mechanics.intervals import intervals
from lagc.optimize.freezing import deciding
from lagc.optimize.functions import made
from lagc.optimize.program import Function
from lagc.optimize.switching import boxed
from lagc.optimize.symbols import Places

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


def narrow(along: Places, found: Sequence[Node]) -> list[Function]:
    """`features`, and `feature_bounds` in a box of time and states; none where there are none."""
    if not found:
        return []
    places, boxes = boxed(along)
    ends = [end for pair in enclosures(along.graph, found, boxes) for end in pair]
    inputs = ("p", *along.state[3:])
    about = "what these keep to in a box"
    return [
        made(along, "features", along.state, (("e", found),), "terms that may be narrow", seldom=True),
        made(places, "feature_bounds", (*inputs, "box"), (("e", ends),), about, seldom=True),
    ]
