"""Values together with the size of the terms that they are made of.

Whether a number is zero can be told only beside what it is the sum of: what cancels leaves about
1e-16 of its terms.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from lagc.expr.evaluate import evaluate
from lagc.expr.graph import Node
from lagc.expr.walk import reachable

VANISHES = 1e-9  # of its terms


def magnitudes(
    nodes: Sequence[Node], state: Mapping[Node, float], within: Sequence[Node] | None = None
) -> list[tuple[float, float]]:
    """Value and size of each node: sizes add in sums and multiply in products.  `within` as in `evaluate`."""
    order = reachable(nodes) if within is None else within
    value = dict(zip(order, evaluate(order, state, order)))
    size: dict[Node, float] = {}
    for node in order:
        if node.op == "add":
            size[node] = size[node.args[0]] + size[node.args[1]]
        elif node.op == "scale":
            size[node] = abs(node.value) * size[node.args[0]]
        elif node.op == "mul":
            factors = zip(node.args, node.value)
            size[node] = math.prod([_factor(value[b], size[b], e) for b, e in factors])
        else:
            size[node] = abs(value[node])
    return [(value[node], size[node]) for node in nodes]


def _factor(value: float, size: float, exponent: int) -> float:
    try:
        return float((size if exponent > 0 else abs(value)) ** exponent)
    except (ZeroDivisionError, OverflowError):
        return math.inf
