"""Reference evaluation of nodes on floats."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from operator import attrgetter

from lagc.expr.graph import Node
from lagc.expr.operators import VALUES
from lagc.expr.walk import depends, missing, reachable


def evaluate(nodes: Sequence[Node], values: Mapping[Node, float]) -> list[float]:
    """The values of `nodes`, given those of their symbols.

    Outside a function's domain the value is NaN, as in C; KeyError for a symbol without value.
    """
    known: dict[Node, float] = dict(values)
    for node in reachable(nodes):
        if node not in known:
            known[node] = _value(node, known)
    return [known[node] for node in nodes]


def extend(known: dict[Node, float], nodes: Sequence[Node]) -> None:
    """Add to `known` the values of `nodes` and of all below them that it lacks; as `evaluate`."""
    for node in missing(nodes, known):
        known[node] = _value(node, known)


def along(node: Node, state: Mapping[Node, float], leaf: Node) -> Callable[[float], float]:
    """`node` as a function of `leaf` alone, where the others are as in `state`."""
    moving = depends([node], [leaf])
    still = dict(state)
    extend(still, [a for x in (moving or (node,)) for a in x.args if a not in moving and a is not leaf])
    order = [x for x in sorted(moving, key=attrgetter("index")) if x is not leaf]
    if not moving:
        extend(still, [node])

    def value(x: float) -> float:
        still[leaf] = x
        for below in order:
            still[below] = _value(below, still)
        return still[node]

    return value


def _value(node: Node, known: Mapping[Node, float]) -> float:
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
        return float(VALUES[op](*x))
    except (ValueError, ZeroDivisionError, OverflowError):
        return math.nan
