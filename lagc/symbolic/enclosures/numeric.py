"""Intervals that expressions keep to whatever the motion, from those of their symbols.

R. E. Moore, *Interval Analysis*, Prentice-Hall 1966; rounding is left out of account.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

from lagc.symbolic.graph import Node
from lagc.symbolic.operators import EVERYWHERE, OPERATORS, Interval
from lagc.symbolic.walk import missing, reachable


def intervals(nodes: Sequence[Node], given: Mapping[Node, Interval]) -> dict[Node, Interval]:
    """Of all below `nodes`, they included; a symbol that is not `given` may be any number."""
    found: dict[Node, Interval] = {}
    for node in reachable(nodes):
        found[node] = given.get(node) or _interval(node, [found[a] for a in node.args])
    return found


def extended(known: dict[Node, Interval], node: Node) -> Interval:
    """That of a node; `known`, of symbols that may be any number, comes to hold those of all below it."""
    for below in missing([node], known):
        known[below] = _interval(below, [known[a] for a in below.args])
    return known[node]


def _interval(node: Node, x: Sequence[Interval]) -> Interval:
    op = node.op
    if op == "const":
        return (node.value, node.value)
    if op == "add":
        return (x[0][0] + x[1][0], x[0][1] + x[1][1])
    if op == "scale":
        return _hull([_times(node.value, end) for end in x[0]])
    if op == "mul":
        found = (1.0, 1.0)
        for base, exponent in zip(x, node.value):
            power = _power(base, exponent)
            found = _hull([_times(a, b) for a in found for b in power])
        return found
    if op == "abs":
        low, high = x[0]
        return (max(low, -high, 0.0), max(-low, high))
    if op == "select":
        return _hull([*x[1], *x[2]])
    if op == "pow" and x[0][0] >= 0.0:
        return (0.0, math.inf)
    if op == "symbol":
        return EVERYWHERE
    if op == "piece":
        return (node.value.piece(x[0][0]), node.value.piece(x[0][1]))
    if op == "entry":
        numbers = node.value.numbers
        begin, end = (int(min(max(a, 0.0), len(numbers) - 1.0)) for a in x[0])
        reached = numbers[begin : end + 1]
        return (min(reached), max(reached))
    row = OPERATORS[op]
    low, high = row.within
    if row.rising:
        first, last = (_at(row.value, [interval[k] for interval in x]) for k in (0, 1))
        return (low if math.isnan(first) else first, high if math.isnan(last) else last)
    return (low, high)


def _at(function: Callable[..., float], x: Sequence[float]) -> float:
    try:
        return float(function(*x))
    except (ValueError, OverflowError):
        return math.nan


def _times(a: float, b: float) -> float:
    return 0.0 if a == 0.0 or b == 0.0 else a * b


def _power(base: Interval, n: int) -> Interval:
    low, high = base
    if n % 2 == 0:
        low, high = max(low, -high, 0.0), max(-low, high)
    if n > 0:
        return (_raised(low, n), _raised(high, n))
    if low < 0.0 < high or low == high == 0.0:
        return EVERYWHERE
    return (
        -math.inf if high == 0.0 else 1.0 / _raised(high, -n),
        math.inf if low == 0.0 else 1.0 / _raised(low, -n),
    )


def _raised(x: float, n: int) -> float:
    try:
        return float(x**n)
    except OverflowError:
        return math.inf if x > 0.0 or n % 2 == 0 else -math.inf


def _hull(ends: Sequence[float]) -> Interval:
    return (min(ends), max(ends))
