"""Reference evaluation of nodes on floats."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from lagc.diagnostics.faults import Fault, Refused
from lagc.symbolic.graph import Node
from lagc.symbolic.operators import VALUES
from lagc.symbolic.walk import reachable


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
