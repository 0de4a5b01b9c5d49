"""Nodes of the expression graph in many digits, and derivatives by differences of them."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import mpmath as mp

from lagc.symbolic.graph import Node
from lagc.symbolic.walk import reachable

DIGITS = 50
STEP = mp.mpf(10) ** -20  # errors of central differences are 1e-40, those of rounding 1e-30

FUNCTIONS: dict[str, Callable[..., Any]] = {
    "abs": abs, "sign": mp.sign, "floor": mp.floor,
    "min": lambda a, b: b if b < a else a, "max": lambda a, b: b if b > a else a,
    "lt": lambda a, b: a < b, "le": lambda a, b: a <= b, "eq": lambda a, b: a == b,
    "and": lambda a, b: a and b, "or": lambda a, b: a or b, "not": lambda a: not a,
    "select": lambda c, a, b: a if c else b,
    "pow": lambda a, b: a**b,
    **{name: getattr(mp, name) for name in (
        "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "exp", "log", "sqrt",
    )},
}  # fmt: skip


def values(nodes: Sequence[Node], given: Mapping[Node, Any]) -> list[Any]:
    """The values of `nodes` in DIGITS digits."""
    known: dict[Node, Any] = dict(given)
    for node in reachable(nodes):
        if node in known:
            continue
        arguments = [known[a] for a in node.args]
        if node.op == "const":
            known[node] = mp.mpf(node.value)
        elif node.op == "add":
            known[node] = arguments[0] + arguments[1]
        elif node.op == "scale":
            known[node] = mp.mpf(node.value) * arguments[0]
        elif node.op == "mul":
            known[node] = mp.fprod(base**exponent for base, exponent in zip(arguments, node.value))
        else:
            known[node] = FUNCTIONS[node.op](*arguments)
    return [known[node] for node in nodes]


def along(
    function: Callable[[Mapping[Node, Any]], Sequence[Any]], at: Mapping[Node, Any], way: Mapping[Node, float]
) -> list[Any]:
    """The derivative of `function` at a point along a way, by central differences."""
    sides = []
    for sign in (1, -1):
        beside = {symbol: mp.mpf(value) + sign * STEP * way.get(symbol, 0) for symbol, value in at.items()}
        sides.append(function(beside))
    return [(a - b) / (2 * STEP) for a, b in zip(*sides)]
