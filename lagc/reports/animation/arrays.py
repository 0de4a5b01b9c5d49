"""Values of expression nodes over arrays of states."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from lagc.symbolic.graph import Node
from lagc.symbolic.operators import VALUES
from lagc.symbolic.walk import reachable

Array: TypeAlias = NDArray[np.float64]
Given: TypeAlias = Mapping[Node, Any]

_NAMES = {
    "asin": "arcsin", "acos": "arccos", "atan": "arctan", "atan2": "arctan2", "pow": "power",
    "min": "minimum", "max": "maximum", "lt": "less", "le": "less_equal", "eq": "equal", "and": "logical_and",
    "or": "logical_or", "not": "logical_not", "select": "where",
    **{name: name for name in ("sin", "cos", "tan", "sinh", "cosh", "tanh", "exp", "log", "sqrt", "abs",
                               "floor", "sign")},
}  # fmt: skip
_FUNCTIONS = {ours: getattr(np, theirs) for ours, theirs in _NAMES.items()}


def values(nodes: Sequence[Node], given: Given, size: int) -> Array:
    """Return the values of `nodes`, (len(nodes), size), at `size` states.

    `given` has arrays or numbers for symbols, and for any other node that is not to be computed: so a
    derivative by a subexpression is taken.  A symbol without a value is NaN."""
    known: dict[Node, Any] = {}
    with np.errstate(all="ignore"):
        for node in reachable(nodes):
            known[node] = given[node] if node in given else _value(node, known)
    rows = [np.broadcast_to(np.asarray(known[node], float), size) for node in nodes]
    return np.array(rows, float).reshape(len(nodes), size)


def _value(node: Node, known: Mapping[Node, Any]) -> Any:
    op = node.op
    if op == "const":
        return float(node.value)
    if op == "symbol":
        return np.nan  # an acceleration, a multiplier
    x = [known[a] for a in node.args]
    if op == "add":
        return x[0] + x[1]
    if op == "scale":
        return node.value * x[0]
    if op == "mul":
        product: Any = 1.0
        for base, exponent in zip(x, node.value):
            product = product * np.asarray(base, float) ** float(exponent)
        return product
    if op in _FUNCTIONS:
        return _FUNCTIONS[op](*x)
    extra = () if node.value is None else (node.value,)  # tables
    rows = np.broadcast_arrays(*x)
    return np.array([VALUES[op](*extra, *row) for row in zip(*(np.atleast_1d(r) for r in rows))], float)
