"""What of expressions may jump or bend: where a condition, or an argument of `abs`, `sign`, `floor`, `min`,
`max` changes, and where one of a root, a logarithm, an inverse function, a quotient or an angle reaches the
end of its domain.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import pairwise
from typing import TypeAlias

from lagc.base.records import dataclass
from lagc.mechanics.formulation.states import States
from lagc.symbolic.directional import Shape
from lagc.symbolic.enclosures import intervals
from lagc.symbolic.evaluate import evaluate
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.operators import CORNER, END, ENTIRE, OPERATORS, POLE, STEP, Interval, smooth_as
from lagc.symbolic.text import brief
from lagc.symbolic.walk import depends, reachable, symbols

State: TypeAlias = dict[Node, float]

STEPS, _CORNERS = smooth_as(STEP), smooth_as(CORNER)
_POLES = smooth_as(POLE) | {"mul"}
ENDS = smooth_as(END)
_PIECES = STEPS | _CORNERS
_BORDERS = {op: row.border for op, row in OPERATORS.items() if row.border is not None}
_RATIONAL = frozenset(("add", "scale", "mul"))
_ENTIRE = smooth_as(ENTIRE)


@dataclass(frozen=True)
class Switch:
    """A node that may be another function where `of(side)` is zero."""

    node: Node
    side: Node
    knots: Sequence[float] = ()  # of a table, some at which it may be another

    @cached_property
    def shape(self) -> Shape:
        return Shape(self.side)

    @property
    def pieces(self) -> bool:
        return self.node.op in _PIECES

    def of(self, value: float) -> float:
        border = _BORDERS.get(self.node.op)
        return value if border is None else border.zero(value)

    def allowed(self, interval: Interval) -> bool:
        """Whether it never changes where `side` keeps to `interval`."""
        low, high = interval
        border = _BORDERS.get(self.node.op)
        if border is not None:
            return border.inside[0] < low and high < border.inside[1]
        if self.node.op == "floor":
            return math.isfinite(low) and math.isfinite(high) and math.floor(low) == math.floor(high)
        if self.node.op == "piece":
            table = self.node.value
            return bool(table.piece(low) == table.piece(high))
        return (low >= 0.0 or high <= 0.0) if self.pieces else (low > 0.0 or high < 0.0)

    def levels(self, value: float) -> Sequence[float]:
        """Those of `side` at which it changes, near one where that has this value."""
        if self.node.op == "floor":
            return [math.floor(value) + k for k in (0.0, 1.0)] if math.isfinite(value) else []
        if self.node.op == "piece":
            table = self.node.value
            place = int(table.piece(value))
            return sorted({*self.knots, *table.numbers[place : place + 2]})
        return [0.0]

    def active(self, state: State) -> bool:
        """An angle changes on the negative axis alone."""
        return self.node.op != "atan2" or not evaluate([self.node.args[1]], state)[0] > 0.0


def switches(
    states: States, nodes: Sequence[Node], leaves: Collection[Node], slopes: bool
) -> Iterator[Switch]:
    """All in `nodes` that may change as `leaves` do, where `slopes` count those that bend too."""
    ops = STEPS | _POLES | (_CORNERS | ENDS if slopes else frozenset())
    below = reachable(nodes)
    if not any(node.op in ops for node in below):
        return
    moving = depends(nodes, leaves)
    found: dict[tuple[str, Node], Switch] = {}  # of all that is divided by the same, one
    for node in below:
        if node.op in ops and node in moving:
            for x in _of_node(states.graph, node, below):
                found.setdefault((node.op, x.side if node.op == "mul" else node), x)
    kept = intervals([x.side for x in found.values()], states.bounds) if found else {}
    for x in found.values():
        if (x.pieces or x.side in moving) and not x.allowed(kept[x.side]):
            yield x


def ways_of(switch: Switch, rank: Mapping[Node, int]) -> list[Node]:
    """The leaves, of those in `rank`, along which it may change: what stands still beside squares of others
    is not zero."""
    parts = [switch.side]
    if not switch.pieces and switch.node.op not in _BORDERS:
        parts = together(switch.side)
    common = set.intersection(*[symbols([part]) for part in parts])
    return sorted(common & rank.keys(), key=rank.__getitem__)


def unlike_quotients(nodes: Sequence[Node], leaves: Collection[Node]) -> list[Node]:
    """Those of `nodes` that are not quotients of functions analytic everywhere: where such a quotient has no
    pole, it is smooth, and beside a pole it grows beyond bounds."""
    moving = depends(nodes, leaves)
    poles: set[Node] = set()
    others: set[Node] = set()
    for node in reachable(nodes):
        if node not in moving or not node.args:
            continue
        op, args = node.op, node.args
        if not others.isdisjoint(args) or not (op in _RATIONAL or (op in _ENTIRE and poles.isdisjoint(args))):
            others.add(node)
        elif not poles.isdisjoint(args) or (op == "mul" and min(node.value) < 0):
            poles.add(node)
    return [node for node in nodes if node in others]


def _of_node(graph: Graph, node: Node, below: Sequence[Node]) -> list[Switch]:
    op, args = node.op, node.args
    if op == "piece":
        return [Switch(node, args[0], _telling(node, below))]
    if op == "mul":
        return [Switch(node, base) for base, exponent in zip(args, node.value) if exponent < 0]
    if op == "pow":
        smooth = args[1].is_const and args[1].value >= 1.0
        return [] if smooth else [Switch(node, args[0])]
    if op == "atan2" or len(args) == 1:
        return [Switch(node, args[0])]
    return [Switch(node, graph.sub(*args))]


def _telling(piece: Node, below: Sequence[Node]) -> Sequence[float]:
    """The first and the last knot, and those where the numbers that are looked up change most."""
    found = {1, len(piece.value) - 1}
    for node in below:
        if node.op == "entry" and node.args[0] is piece:
            changes = [abs(b - a) for a, b in pairwise(node.value)]
            found.add(1 + changes.index(max(changes)))
    return [piece.value[k] for k in sorted(found)]


def together(node: Node) -> list[Node]:
    """Expressions that are all zero where `node`, a sum of squares or its root, is."""
    low = intervals([node], {})
    found: list[Node] = []
    stack = [node]
    while stack:
        x = stack.pop()
        power = x.op == "mul" and len(x.args) == 1 and x.value[0] > 0
        if power or x.op in ("sqrt", "scale"):
            stack.append(x.args[0])
        elif x.op == "add" and min(low[a][0] for a in x.args) >= 0.0:
            stack.extend(x.args)
        else:
            found.append(x)
    return found


def where(switch: Switch) -> str:
    """In words."""
    node, side = switch.node, brief(switch.side)
    if node.op == "floor":
        return f"`{side}` passes a whole number"
    if node.op == "piece":
        return f"`{side}` passes a knot of a table"
    if node.op in _BORDERS:
        return f"`{side}` {_BORDERS[node.op].words}"
    if node.op == "atan2":
        return f"`{brief(node)}` passes its cut"
    if not switch.pieces:
        return f"`{side}` reaches 0"
    left, right = (*node.args, node.graph.zero)[:2]
    if left.is_const:
        left, right = right, left
    return f"`{brief(left)}` passes {brief(right) if right.is_const else f'`{brief(right)}`'}"
