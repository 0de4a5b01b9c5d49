"""Random expressions: grown at once as nodes of a graph and as functions of complex numbers."""

import cmath
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from hypothesis import strategies as st

from lagc.symbolic.graph import Graph, Node

NAMES = ("x", "y", "z")
Function = Callable[[Sequence[complex]], complex]


@dataclass(frozen=True)
class Pair:
    """The same expression twice: `node` through the smart constructors, `value` without them."""

    node: Node
    value: Function


# smooth on the whole complex neighbourhood of the values tried
SMOOTH: dict[str, Callable[[complex], complex]] = {
    "sin": cmath.sin, "cos": cmath.cos, "atan": cmath.atan, "tanh": cmath.tanh, "sinh": cmath.sinh,
    "cosh": cmath.cosh,
}  # fmt: skip


def leaf(graph: Graph, k: int) -> Pair:
    return Pair(graph.symbol("coordinate", NAMES[k]), lambda at: at[k])


def number(graph: Graph, c: float) -> Pair:
    return Pair(graph.const(c), lambda at: c)


def bounded(graph: Graph, p: Pair) -> Pair:
    """sin(p), so that towers of functions stay in range."""
    return Pair(graph.sin(p.node), lambda at: cmath.sin(p.value(at)))


def combine(graph: Graph, op: str, a: Pair, b: Pair) -> Pair:
    if op == "add":
        return Pair(a.node + b.node, lambda at: a.value(at) + b.value(at))
    if op == "sub":
        return Pair(a.node - b.node, lambda at: a.value(at) - b.value(at))
    if op == "mul":
        return Pair(a.node * b.node, lambda at: a.value(at) * b.value(at))
    low = bounded(graph, b)  # denominators and roots stay away from zero
    if op == "div":
        return Pair(a.node / (low.node + 2.0), lambda at: a.value(at) / (low.value(at) + 2.0))
    if op == "sqrt":
        return Pair(
            a.node * graph.sqrt(low.node + 2.0), lambda at: a.value(at) * cmath.sqrt(low.value(at) + 2.0)
        )
    if op == "log":
        return Pair(
            a.node + graph.unary("log", low.node + 2.0),
            lambda at: a.value(at) + cmath.log(low.value(at) + 2.0),
        )
    if op == "exp":
        return Pair(a.node * graph.unary("exp", low.node), lambda at: a.value(at) * cmath.exp(low.value(at)))
    if op == "pow":
        base = low.node + 2.0
        return Pair(
            a.node + graph.pow(base, graph.const(1.5)), lambda at: a.value(at) + (low.value(at) + 2.0) ** 1.5
        )
    if op == "cube":
        return Pair(a.node + b.node**3, lambda at: a.value(at) + b.value(at) ** 3)
    inside = bounded(graph, a)
    return Pair(graph.unary(op, inside.node), lambda at: SMOOTH[op](inside.value(at)))


OPS = ("add", "sub", "mul", "div", "sqrt", "log", "exp", "pow", "cube", *SMOOTH)
step = st.tuples(st.sampled_from(OPS), st.integers(0, 30), st.integers(0, 30))
programs = st.lists(step, min_size=1, max_size=12)
points = st.tuples(*[st.floats(-1.5, 1.5, allow_subnormal=False) for _ in NAMES])


def grow(graph: Graph, program: Sequence[tuple[str, int, int]]) -> Pair:
    """Each step combines two of what there is, most often what was made last."""
    made = [leaf(graph, k) for k in range(len(NAMES))] + [number(graph, 0.5), number(graph, -2.0)]
    for op, i, j in program:
        made.append(combine(graph, op, made[-1 - i % len(made)], made[-1 - j % len(made)]))
    return made[-1]
