"""Values together with the sizes of their terms.

A number is zero only relative to its terms: cancellation leaves about 1e-16 of them. Sizes that add in sums
and multiply in products are far too large for long expressions, as components of a vector that was rotated
ten times. So the size is measured: the change of the value if each operation is perturbed by a small relative
error, over that error (stochastic arithmetic: J. Vignes, *Math. Comput. Simul.* 35, 1993).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from random import Random

from lagc.symbolic.evaluate import evaluate, value_of
from lagc.symbolic.graph import Node
from lagc.symbolic.operators import FLAT, LOGIC, STEP, smooth_as
from lagc.symbolic.walk import reachable

VANISHES = 1e-9  # of its terms
_OFF = 2.0**-26  # of a result: far more than rounding, and what goes with its square is far less
_DRAWS = 2
_EXACT = smooth_as(STEP, FLAT, LOGIC) | {"const"}


def magnitudes(
    nodes: Sequence[Node], state: Mapping[Node, float], within: Sequence[Node] | None = None
) -> list[tuple[float, float]]:
    """Return the value and the size of each node, which is at least the value. `within` as in `evaluate`."""
    order = reachable(nodes) if within is None else within
    value = {**state, **dict(zip(order, evaluate(order, state, order)))}
    size = [abs(value[node]) for node in nodes]
    chance = Random(0)
    for _ in range(_DRAWS):
        moved = _moved(order, state, value, chance)
        for k, node in enumerate(nodes):
            size[k] = max(size[k], abs(moved[node] - value[node]) / _OFF)
    return [(value[node], own) for node, own in zip(nodes, size)]


def _moved(
    order: Sequence[Node], state: Mapping[Node, float], value: Mapping[Node, float], chance: Random
) -> dict[Node, float]:
    """The values, where each is off; what has none there is as it is."""
    moved: dict[Node, float] = {}
    for node in order:
        own = value[node]
        if node.op not in _EXACT and not (node in state and node.op != "symbol"):
            there = own if node in state else value_of(node, moved)
            there *= 1.0 + _OFF * chance.uniform(-1.0, 1.0)
            own = there if math.isfinite(there) else own
        moved[node] = own
    return moved
