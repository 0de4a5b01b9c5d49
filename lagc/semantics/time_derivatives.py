"""Time derivatives in terms of the rates, and the kinds of symbols in a node.

Both are cached per node, so that a chain of n points costs O(n) and not O(n^2).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from lagc.semantics.model import Frame
from lagc.symbolic.derivative import partials
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.leaves import QUANTITIES
from lagc.symbolic.vectors import Matrix, axis_rates

T = TypeVar("T")

KINDS = (
    "parameter",
    "input",
    "time",
    "coordinate",
    "rate",
    "speed",
    "discrete",
    "acceleration",
    "multiplier",
    *QUANTITIES,
)
BIT = {kind: 1 << k for k, kind in enumerate(KINDS)}
MOVING = BIT["input"] | BIT["time"] | BIT["coordinate"] | BIT["rate"] | BIT["speed"] | BIT["discrete"]
# Known once the equations are solved.
LATE = BIT["acceleration"] | BIT["multiplier"] | sum(BIT[kind] for kind in QUANTITIES)
VELOCITY = BIT["rate"] | BIT["speed"]


class Clock:
    """Time derivatives of nodes; `set_rate` gives those of the symbols."""

    def __init__(self, graph: Graph):
        self.graph = graph
        self._rate: dict[Node, Node] = {}
        self._mask: dict[Node, int] = {}
        self.axes: dict[Node, Matrix] = {}  # component -> axes of the first frame that has it

    def set_rate(self, symbol: Node, rate: Node) -> None:
        """Set d(symbol)/dt = rate."""
        self._rate[symbol] = rate

    def add_frame(self, frame: Frame) -> None:
        """Set the time derivatives of the axes of a frame, e_k' = w x e_k."""
        for component in (x for row in frame.axes for x in row):
            node = component.args[0] if component.op == "scale" else component
            if not node.is_const:
                self.axes.setdefault(node, frame.axes)
        for node, rate in axis_rates(frame.axes, frame.angular_velocity).items():
            self._rate.setdefault(node, rate)

    def derivative(self, node: Node) -> Node:
        """Return d(node)/dt.  Inputs, multipliers and similar symbols have none (check `mask` first)."""
        graph = self.graph

        def rate(top: Node, known: dict[Node, Node]) -> Node:
            total = graph.zero
            if any(not known[a].is_zero for a in top.args):
                for local, argument in zip(partials(graph, top), top.args):
                    total = total + local * known[argument]
            return total

        return _found(node, self._rate, rate)

    def mask(self, node: Node) -> int:
        """Return the kinds of symbols below `node`, one bit each."""

        def kinds(top: Node, known: dict[Node, int]) -> int:
            found = BIT[top.record.kind] if top.op == "symbol" else 0
            for argument in top.args:
                found |= known[argument]
            return found

        return _found(node, self._mask, kinds)


def set_quaternion_rate(clock: Clock, q: tuple[Node, Node, Node, Node], w: tuple[Node, Node, Node]) -> None:
    """Set q' = 1/2 q (0, w) for a unit quaternion with the body rates w, and the derivatives of w."""
    a, b, c = w
    e, x, y, z = q
    runs = (-x * a - y * b - z * c, e * a + y * c - z * b, e * b + z * a - x * c, e * c + x * b - y * a)
    for symbol, rate in zip(q, runs):
        clock.set_rate(symbol, 0.5 * rate)
    for rate in w:
        clock.set_rate(rate, clock.graph.leaf(rate.record.derivative))


def _found(node: Node, known: dict[Node, T], find: Callable[[Node, dict[Node, T]], T]) -> T:
    """Return `known[node]`, computed from its arguments in a loop, because graphs are deep."""
    stack = [node]
    while stack:
        top = stack[-1]
        if top in known:
            stack.pop()
            continue
        missing = [a for a in top.args if a not in known]
        if missing:
            stack.extend(missing)
            continue
        stack.pop()
        known[top] = find(top, known)
    return known[node]
