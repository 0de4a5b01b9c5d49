"""Time derivatives in terms of the rates, and what kinds of symbols a node is made of.

Both are remembered node by node, so that a chain of n points costs n and not n^2.
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
    "acceleration",
    "multiplier",
    *QUANTITIES,
)
BIT = {kind: 1 << k for k, kind in enumerate(KINDS)}
MOVING = BIT["input"] | BIT["time"] | BIT["coordinate"] | BIT["rate"] | BIT["speed"]
# Known once the equations are solved.
LATE = BIT["acceleration"] | BIT["multiplier"] | sum(BIT[kind] for kind in QUANTITIES)
VELOCITY = BIT["rate"] | BIT["speed"]


class Clock:
    """d/dt of nodes.  Each moving symbol is told with `set_rate`."""

    def __init__(self, graph: Graph):
        self.graph = graph
        self._rate: dict[Node, Node] = {}
        self._mask: dict[Node, int] = {}
        self.axes: dict[Node, Matrix] = {}  # by their components, of the first frame that has them

    def set_rate(self, symbol: Node, rate: Node) -> None:
        """d(symbol)/dt = rate."""
        self._rate[symbol] = rate

    def add_frame(self, frame: Frame) -> None:
        """The axes of a frame turn with it."""
        for component in (x for row in frame.axes for x in row):
            node = component.args[0] if component.op == "scale" else component
            if not node.is_const:
                self.axes.setdefault(node, frame.axes)
        for node, rate in axis_rates(frame.axes, frame.angular_velocity).items():
            self._rate.setdefault(node, rate)

    def derivative(self, node: Node) -> Node:
        """d(node)/dt; inputs, multipliers and the like have none (check `mask` first)."""
        graph = self.graph

        def rate(top: Node, known: dict[Node, Node]) -> Node:
            total = graph.zero
            if any(not known[a].is_zero for a in top.args):
                for local, argument in zip(partials(graph, top), top.args):
                    total = total + local * known[argument]
            return total

        return _found(node, self._rate, rate)

    def mask(self, node: Node) -> int:
        """The kinds of symbols below `node`, a bit each."""

        def kinds(top: Node, known: dict[Node, int]) -> int:
            found = BIT[top.record.kind] if top.op == "symbol" else 0
            for argument in top.args:
                found |= known[argument]
            return found

        return _found(node, self._mask, kinds)


def _found(node: Node, known: dict[Node, T], find: Callable[[Node, dict[Node, T]], T]) -> T:
    """`known[node]`, found from those of its arguments; a loop, since graphs are deep."""
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
