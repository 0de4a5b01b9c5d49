"""Jumps and kinks of expressions at the relations `abs`, `sign`, `floor`, `min`, `max`, `if` and tables.

The zero of an event indicator is located along single leaves. There the expressions on both sides and their
slopes are compared: two different analytic functions differ at a random point (Schwartz-Zippel).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from itertools import islice, pairwise
from typing import TypeAlias

from lagc.base.records import dataclass
from lagc.mechanics.formulation.states import States
from lagc.mechanics.numeric.cancellation import magnitudes
from lagc.symbolic.derivative import gradient
from lagc.symbolic.enclosures import extended, intervals
from lagc.symbolic.evaluate import evaluate
from lagc.symbolic.expression_text import brief
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.operators import CORNER, LOGIC, STEP, Interval, smooth_as
from lagc.symbolic.walk import depends, reachable, symbols

State: TypeAlias = Mapping[Node, float]

_STEPS, _LOGIC = smooth_as(STEP), smooth_as(LOGIC)
RELATIONS = _STEPS | smooth_as(CORNER)
_COUNTING = ("floor", "piece")
_STEPWISE = tuple([2.0**k for k in (*range(-6, 13), *range(16, 65, 4))])  # distances of the scan
_POINTS = 12  # zeros of an indicator at which both sides are compared
_LEAVES = 8  # along which a zero is looked for
_ALIKE = 1e-11  # of their terms: two sides agree
_BESIDE = 1e-6  # of the distance to a zero: one side of it


@dataclass(frozen=True, slots=True)
class Break:
    """A "jump" or a "kink" of an expression, at a zero of the indicator of `relation`."""

    kind: str
    relation: Node

    @property
    def where(self) -> str:
        node = self.relation
        side = brief(node.args[0])
        if node.op in _COUNTING:
            return f"`{side}` passes {'a whole number' if node.op == 'floor' else 'a knot of a table'}"
        left, right = (*node.args, node.graph.zero)[:2]
        if left.is_const:
            left, right = right, left
        return f"`{brief(left)}` passes {brief(right) if right.is_const else f'`{brief(right)}`'}"

    @property
    def conditions(self) -> tuple[Node, Node]:
        """Two conditions.  Whenever the relation changes one of them becomes true."""
        node, graph = self.relation, self.relation.graph
        if node.op in _COUNTING:
            half = graph.const(0.5)
            odd = node - 2.0 * graph.unary("floor", half * node)
            return graph.binary("lt", half, odd), graph.binary("lt", odd, half)
        indicator = _indicator(node)
        return graph.binary("lt", graph.zero, indicator), graph.binary("lt", indicator, graph.zero)


def find_break(
    states: States, nodes: Sequence[Node], leaves: Sequence[Node], slopes: bool, rows: bool = False
) -> Break | None:
    """Return the first jump of `nodes` along `leaves`, or else the first kink (not with `slopes` off).
    `rows`: `nodes` vanish along the motion, so a relation counts only if they vanish at its zero."""
    everything = states.in_rates(nodes)
    moving = depends(everything, leaves)
    ops = RELATIONS if slopes else _STEPS
    found = [node for node in reachable(everything) if node.op in ops and node in moving]
    kept = intervals([_indicator(node) for node in found], states.bounds) if found else {}
    found = [node for node in found if not _is_constant(node, kept[_indicator(node)])]
    if rows:
        found = [node for node in found if not _is_never_met(states, everything, node)]
    kink: Break | None = None
    for relation in found:
        for point in islice(_zeros(states, relation, everything, leaves), _POINTS):
            kind = _kind(states.graph, everything, leaves if slopes and kink is None else (), point)
            if kind == "jump":
                return Break(kind, relation)
            if kind:
                kink = kink or Break(kind, relation)
    return kink


def _indicator(node: Node) -> Node:
    return node.args[0] if len(node.args) == 1 else node.graph.sub(*node.args)


def _is_constant(node: Node, interval: Interval) -> bool:
    """Return whether the relation has one value for all indicators in `interval`."""
    low, high = interval
    if node.op == "floor":
        return math.isfinite(low) and math.isfinite(high) and math.floor(low) == math.floor(high)
    if node.op == "piece":
        return bool(node.value.piece(low) == node.value.piece(high))
    return low >= 0.0 or high <= 0.0


def _is_never_met(states: States, nodes: Sequence[Node], relation: Node) -> bool:
    """Return whether one of `nodes` has no zero where the indicator is zero, with the parameters' values."""
    if relation.op in _STEPS:
        return False
    known: dict[Node, Interval] = {
        p.symbol: (p.value, p.value) for p in states.model.parameters if p.value is not None
    }
    known[relation] = (0.0, 0.0) if relation.op == "abs" else extended(known, relation.args[0])
    ends = [extended(known, node) for node in nodes]
    return any(low > 0.0 or high < 0.0 for low, high in ends)


# -- zeros of an indicator ---------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Point:
    """A state where an indicator is zero as `leaf` moves; one side and the other are `step` away."""

    state: State
    leaf: Node
    step: float

    def beside(self, distance: float) -> State:
        return {**self.state, self.leaf: self.state[self.leaf] + distance}


def _zeros(states: States, relation: Node, nodes: Sequence[Node], leaves: Sequence[Node]) -> Iterator[_Point]:
    """Yield points of every random state in turn, the first leaf that leads to one."""
    indicator = _indicator(relation)
    needed = symbols([*nodes, indicator])
    below = reachable([indicator])
    own = [leaf for leaf in leaves if leaf in symbols([indicator])]
    own = own[:: 1 + len(own) // _LEAVES]
    for sample in states.scattered:
        state = {x: sample[x] for x in needed}
        for leaf in own:
            found = list(_along(state, leaf, relation, indicator, below))
            if found:
                yield from found
                own = [leaf, *(x for x in own if x is not leaf)]  # it may lead to one again
                break


def _along(
    state: State, leaf: Node, relation: Node, indicator: Node, below: Sequence[Node]
) -> Iterator[_Point]:
    def apart(level: float, x: float) -> float:
        return evaluate([indicator], {**state, leaf: x}, below)[0] - level

    start = state[leaf]
    for level in _levels(relation, apart(0.0, start)):
        found = _crossing(partial(apart, level), start, abs(start) or 1.0)
        if found is not None:
            at, reach = found
            yield _Point({**state, leaf: at}, leaf, _BESIDE * max(abs(at), reach))


def _levels(relation: Node, value: float) -> Sequence[float]:
    """Values of the indicator at which the relation changes, near `value`."""
    if relation.op == "floor":
        return [math.floor(value) + k for k in (0.0, 1.0)] if math.isfinite(value) else []
    if relation.op == "piece":
        return _knots(relation, value)
    return [0.0]


def _knots(piece: Node, value: float) -> list[float]:
    """Those beside `value`, the first, the last, and those where the numbers looked up change most."""
    table = piece.value
    place = int(table.piece(value))
    found = {1, len(table) - 1, place, place + 1}
    for node in piece.graph.nodes:
        if node.op == "entry" and node.args[0] is piece:
            changes = [abs(b - a) for a, b in pairwise(node.value)]
            found.add(1 + changes.index(max(changes)))
    return [table[k] for k in sorted(found) if 0 < k < len(table)]


def _crossing(value: Callable[[float], float], start: float, size: float) -> tuple[float, float] | None:
    """Return the zero nearest to `start` where the sign changes, and how far apart the scan is there."""
    ends = {1.0: (start, value(start)), -1.0: (start, value(start))}
    for distance in _STEPWISE:
        for sign, (a, before) in ends.items():
            b = start + sign * distance * size
            after = value(b)
            if before * after < 0.0:
                return _bisected(value, a, b), abs(b - a)
            if after == 0.0:
                return b, abs(b - a)
            ends[sign] = b, after
    return None


def _bisected(value: Callable[[float], float], a: float, b: float) -> float:
    low = value(a)
    for _ in range(200):
        middle = 0.5 * (a + b)
        if middle in (a, b):
            break
        found = value(middle)
        if found == 0.0:
            return middle
        a, b = (middle, b) if low * found > 0.0 else (a, middle)
    return 0.5 * (a + b)


# -- both sides of a zero ----------------------------------------------------------------------


def _kind(graph: Graph, nodes: Sequence[Node], leaves: Sequence[Node], point: _Point) -> str:
    """Return "jump" where values on both sides differ, "kink" where slopes along `leaves` do, or ""."""
    before, at, after = (point.beside(d) for d in (-point.step, 0.0, point.step))
    kind = ""
    for a, b in zip(_branch(graph, nodes, before), _branch(graph, nodes, after)):
        if a is b:
            continue
        if _differ([a], [b], at, after):
            return "jump"
        ahead, behind = (gradient(graph, {x: graph.one}, leaves) for x in (a, b))
        moved = list({**ahead, **behind})
        pairs = [[slopes.get(leaf, graph.zero) for leaf in moved] for slopes in (ahead, behind)]
        if moved and _differ(pairs[0], pairs[1], at, after):
            kind = "kink"
    return kind


def _differ(left: Sequence[Node], right: Sequence[Node], at: State, after: State) -> bool:
    """Return whether any two differ at `at`, by more than the round-off of their terms and arguments."""
    nodes = [*left, *right]
    found = magnitudes(nodes, at)
    size = [p + abs(x - a) / _BESIDE for (a, p), x in zip(found, evaluate(nodes, after))]
    for (a, _), (b, _), p, q in zip(found, found[len(left) :], size, size[len(left) :]):
        if abs(a - b) > _ALIKE * (p + q):
            return True
    return False


def _branch(graph: Graph, nodes: Sequence[Node], state: State) -> list[Node]:
    """Return `nodes` with every relation held as it is at `state`."""
    order = reachable(nodes)
    value = dict(zip(order, evaluate(order, state, order)))
    held: dict[Node, Node] = {}
    for node in order:
        args = tuple([held[a] for a in node.args])
        if node.op == "abs":
            held[node] = args[0] if value[node.args[0]] >= 0.0 else -args[0]
        elif node.op in ("min", "max"):
            held[node] = args[0] if value[node] == value[node.args[0]] else args[1]
        elif (node.op in _STEPS or node.op in _LOGIC) and math.isfinite(value[node]):
            held[node] = graph.const(value[node])
        else:
            held[node] = graph.rebuild(node, args) if node.args else node
    return [held[node] for node in nodes]
