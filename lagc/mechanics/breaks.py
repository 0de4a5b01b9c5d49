"""Where expressions jump or bend, found along single coordinates from states at random.

Where the condition of `if`, or the argument of `abs`, `sign`, `floor`, `min`, `max` changes, the
expressions on both sides of the change are compared, with their slopes: at random states, beside which
two different analytic functions do not agree (Schwartz-Zippel).

Roots, logarithms, inverse functions, quotients and angles are analytic up to where an argument reaches
the end of their domain, as `u` of `sqrt(u)` that touches zero.  There values and slopes are compared at
distances that shrink: between both sides of a smooth place they differ by less and less, and by
as much however near where it jumps or bends.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import pairwise
from typing import TypeAlias

from lagc.expr.derivative import gradient, tangent
from lagc.expr.evaluate import along, evaluate
from lagc.expr.graph import Graph, Node
from lagc.expr.operators import CORNER, END, ENTIRE, LOGIC, OPERATORS, POLE, STEP, Interval, smooth_as
from lagc.expr.text import text
from lagc.expr.walk import depends, reachable
from lagc.mechanics.intervals import intervals
from lagc.mechanics.magnitude import magnitudes
from lagc.mechanics.samples import samples
from lagc.mechanics.states import States
from lagc.mechanics.zeros import zeros
from lagc.records import dataclass

State: TypeAlias = dict[Node, float]

STEPS, CORNERS = smooth_as(STEP), smooth_as(CORNER)
POLES = smooth_as(POLE) | {"mul"}
ENDS = smooth_as(END)
_PIECES = STEPS | CORNERS
_BORDERS = {op: row.border for op, row in OPERATORS.items() if row.border is not None}
_RATIONAL = frozenset(("add", "scale", "mul"))
_ENTIRE = smooth_as(ENTIRE)
_LOGIC = smooth_as(LOGIC)
_ALIKE = 1e-11  # of their terms: two sides agree
_BESIDE = 1e-6  # of the way to a change: one side of it
_NEARER = tuple([10.0 ** (-0.5 * k) for k in range(4, 9)])  # of the way: both sides of an end
_LITTLE = 1e-4
_STAYS, _GROWS = 0.8, 3.0  # from one distance to the next: a jump stays, a slope may grow as a cusp's
_SEEN = 1e-7  # of the size of both sides


@dataclass(frozen=True, slots=True)
class Break:
    """How an expression is not smooth, "jump" or "kink", and where; `cut`: it is that of an angle."""

    kind: str
    where: str
    cut: bool


@dataclass(frozen=True, slots=True)
class Switch:
    """A node that may be another function where `of(side)` is zero."""

    node: Node
    side: Node

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
        return (low >= 0.0 or high <= 0.0) if self.pieces else (low > 0.0 or high < 0.0)

    def active(self, state: State) -> bool:
        """An angle changes on the negative axis alone."""
        return self.node.op != "atan2" or not evaluate([self.node.args[1]], state)[0] > 0.0


@dataclass(frozen=True, slots=True)
class Edge:
    """A state where a switch changes, reached from `state` along `leaf`; those before and after; how far
    both reach."""

    state: State
    leaf: Node
    at: State
    before: State
    after: State
    reach: float
    crosses: bool


def find_break(
    states: States, nodes: Sequence[Node], leaves: Sequence[Node], slopes: bool, rows: bool = False
) -> Break | None:
    """The first break of `nodes` that is found along `leaves`: a jump, or where `slopes` count a kink.

    `rows`: `nodes` are zero along the motion, which does not come to changes where one of them is not.
    """
    graph = states.graph
    everything = states.in_rates(nodes)
    nodes = _unlike_quotients(everything, leaves)
    pairs = [(x, _ways(x, leaves)) for x in _switches(states, nodes, leaves, slopes)]
    pairs = [(x, ways) for x, ways in pairs if ways]
    if not pairs:
        return None
    switches = [x for x, _ in pairs]
    starts = [state for spread in (0.3, 3.0, 30.0) for state in samples(states.model, 3, spread=spread)]
    edges = [_all_edges(x, starts, ways) for x, ways in pairs]
    if any(x.pieces for x in switches):  # no branch is left out
        first = [{e.leaf: e for e in reversed(found) if e.state is starts[0]} for found in edges]
        more = [_moved(e, end) for table in first for e in table.values() for end in (0.5, -0.5)]
        for (x, ways), found in zip(pairs, edges):
            found.extend(e for state in more for e in _edges(x, state, ways))
    crossed = dict.fromkeys(e.leaf for found in edges for e in found)
    rates = {leaf: tangent(graph, nodes, {leaf: graph.one}) for leaf in crossed}
    cut: Break | None = None
    for switch, found in zip(switches, edges):
        if rows and _never_zero(everything, switch, leaves, found):
            continue
        if switch.pieces:
            wrt = leaves if slopes else ()
            kinds = {_kind(graph, nodes, wrt, e) for e in found if e.crosses}
        else:
            ends = switch.node.op in ENDS or switch.node.op == "pow"  # beyond what they cross is nothing
            kinds = {_kind_beside(nodes, rates[e.leaf], slopes, e) for e in found if not (ends and e.crosses)}
        for kind in ("jump", "kink"):
            if kind in kinds:
                broken = Break(kind, _where(switch), switch.node.op == "atan2")
                if not broken.cut:
                    return broken
                cut = cut or broken
                break
    return cut


# -- what may change --------------------------------------------------------------------------


def _unlike_quotients(nodes: Sequence[Node], leaves: Sequence[Node]) -> list[Node]:
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


def _switches(
    states: States, nodes: Sequence[Node], leaves: Sequence[Node], slopes: bool
) -> Iterator[Switch]:
    ops = STEPS | POLES | (CORNERS | ENDS if slopes else frozenset())
    below = reachable(nodes)
    if not any(node.op in ops for node in below):
        return
    moving = depends(nodes, leaves)
    switches: dict[tuple[str, Node], Switch] = {}  # of all that is divided by the same, one
    for node in below:
        if node.op in ops and node in moving:
            for x in _of_node(states.graph, node):
                switches.setdefault((node.op, x.side if node.op == "mul" else node), x)
    found = list(switches.values())
    if not found:
        return
    bounds: dict[Node, Interval] = {p.symbol: (p.minimum, p.maximum) for p in states.model.parameters}
    kept = intervals([x.side for x in found], bounds)
    for x in found:
        if (x.pieces or x.side in moving) and not x.allowed(kept[x.side]):
            yield x


def _of_node(graph: Graph, node: Node) -> list[Switch]:
    op, args = node.op, node.args
    if op == "mul":
        return [Switch(node, base) for base, exponent in zip(args, node.value) if exponent < 0]
    if op == "pow":
        smooth = args[1].is_const and args[1].value >= 1.0
        return [] if smooth else [Switch(node, args[0])]
    if op == "atan2" or len(args) == 1:
        return [Switch(node, args[0])]
    return [Switch(node, graph.sub(*args))]


def _together(node: Node) -> list[Node]:
    """Expressions that are all zero where `node`, a sum of squares or its root, is."""
    if node.op == "sqrt" or (node.op == "scale" and node.args):
        return _together(node.args[0])
    if node.op == "mul" and len(node.args) == 1 and node.value[0] > 0:
        return _together(node.args[0])
    if node.op == "add":
        low = [x[0] for x in (intervals([a], {})[a] for a in node.args)]
        if min(low) >= 0.0:
            return [x for a in node.args for x in _together(a)]
    return [node]


# -- where it changes -------------------------------------------------------------------------


def _ways(switch: Switch, leaves: Sequence[Node]) -> list[Node]:
    """The leaves along which it may change: what stands still beside squares of others is not zero."""
    parts = [switch.side]
    if not switch.pieces and switch.node.op not in _BORDERS:
        parts = _together(switch.side)
    below = [set(reachable([part])) for part in parts]
    return [leaf for leaf in leaves if all(leaf in x for x in below)]


def _edges(switch: Switch, state: State, ways: Sequence[Node]) -> Iterator[Edge]:
    """The changes of `switch` that are nearest to `state`, as one of `ways` alone moves."""
    for leaf in ways:
        value, start = along(switch.side, state, leaf), state[leaf]
        first, size = value(start), abs(start) or 1.0
        levels = [0.0]
        if switch.node.op == "floor":
            levels = [math.floor(first) + k for k in (0.0, 1.0)] if math.isfinite(first) else []
        for level in levels:
            for zero in zeros(partial(_changes, switch, level, value), start, size):
                reach = max(zero.reach, size / 16.0)
                step = _BESIDE * max(abs(zero.at), reach)
                at, before, after = ({**state, leaf: zero.at + d} for d in (0.0, -step, step))
                if switch.active(before) or switch.active(after):
                    yield Edge(state, leaf, at, before, after, reach, zero.crosses)


def _all_edges(switch: Switch, starts: Sequence[State], ways: Sequence[Node]) -> list[Edge]:
    """From all `starts`, where there is a change near one of every four; an angle's may be at any."""
    few = [e for state in starts[::4] for e in _edges(switch, state, ways)]
    if not few and not switch.pieces and switch.node.op != "atan2":
        return []
    return few + [e for k, state in enumerate(starts) if k % 4 for e in _edges(switch, state, ways)]


def _changes(switch: Switch, level: float, value: Callable[[float], float], x: float) -> float:
    return switch.of(value(x)) - level


def _moved(edge: Edge, end: float) -> State:
    x = edge.at[edge.leaf]
    return {**edge.at, edge.leaf: x + end * max(abs(x), edge.reach)}


def _never_zero(nodes: Sequence[Node], switch: Switch, leaves: Sequence[Node], edges: Sequence[Edge]) -> bool:
    """Whether one of `nodes` has the same sign at all `edges`, whatever the `leaves` that do not move the
    change."""
    below = set(reachable([switch.side]))
    for node in nodes:
        signs = [_signs(node, e) for e in edges]
        if not signs or any(len({pair[k] for pair in signs} | {0}) != 2 for k in (0, 1)):
            continue
        free = [leaf for leaf in leaves if leaf not in below and leaf in reachable([node])]
        lines = [(end, leaf) for end in (edges[0].before, edges[0].after) for leaf in free]
        if not any(_meets(node, switch, end, leaf) for end, leaf in lines):
            return True
    return False


def _meets(node: Node, switch: Switch, state: State, leaf: Node) -> bool:
    """Whether `node` is zero somewhere along `leaf` at the change."""
    found = zeros(along(node, state, leaf), state[leaf], abs(state[leaf]) or 1.0)
    return any(zero.crosses and switch.active({**state, leaf: zero.at}) for zero in found)


def _signs(node: Node, edge: Edge) -> list[int]:
    """On both sides of a change, the lesser first; 0 where it is small beside what it is farther away."""
    x = edge.at[edge.leaf]
    far = [{**edge.at, edge.leaf: x + d} for d in (-edge.reach, edge.reach)]
    values = [evaluate([node], state)[0] for state in (edge.before, edge.after, *far)]
    least = _LITTLE * (abs(values[2]) + abs(values[3]))
    return sorted([(v > least) - (v < -least) for v in values[:2]])


# -- what changes -----------------------------------------------------------------------------


def _kind_beside(nodes: Sequence[Node], rates: Sequence[Node], slopes: bool, edge: Edge) -> str:
    """How `nodes`, with their `rates` along the edge's leaf, differ on both sides of an end of a domain,
    however near."""
    found: list[list[tuple[float, float]]] = []
    x = edge.at[edge.leaf]
    for way in _NEARER:
        h = way * edge.reach
        before, after = (evaluate([*nodes, *rates], {**edge.at, edge.leaf: x + d}) for d in (-h, h))
        n = len(nodes)
        jumps = [
            (b - a - h * (q + p), abs(a) + abs(b) + 10.0 * edge.reach * (abs(p) + abs(q)))
            for a, b, p, q in zip(before, after, before[n:], after[n:])
        ]
        bends = [(q - p, abs(p) + abs(q)) for p, q in zip(before[n:], after[n:])]
        found.append(jumps + (bends if slopes else []))
    kind = ""
    for k, series in enumerate(zip(*found)):
        if not all(math.isfinite(d) and abs(d) > _SEEN * size for d, size in series):
            continue
        ratios = [b / a for (a, _), (b, _) in pairwise(series)]
        if k < len(nodes):
            if all(_STAYS < r < 1.0 / _STAYS for r in ratios):
                return "jump"
        elif all(_STAYS < r < _GROWS for r in ratios):
            kind = "kink"
    return kind


def _kind(graph: Graph, nodes: Sequence[Node], leaves: Sequence[Node], edge: Edge) -> str:
    """How `nodes` differ in value, and in slope along `leaves`, on both sides of a change of pieces."""
    at, after = edge.at, edge.after
    left, right = _branch(graph, nodes, edge.before), _branch(graph, nodes, after)
    kind = ""
    for a, b in zip(left, right):
        if a is b:
            continue
        if _differ([a], [b], at, after):
            return "jump"
        slopes = gradient(graph, {a: graph.one}, leaves), gradient(graph, {b: graph.one}, leaves)
        pairs = [[slope.get(leaf, graph.zero) for leaf in leaves] for slope in slopes]
        if leaves and _differ(pairs[0], pairs[1], at, after):
            kind = "kink"
    return kind


def _differ(left: Sequence[Node], right: Sequence[Node], at: State, after: State) -> bool:
    """Whether any two differ at `at`, by more than the rounding of their terms and arguments."""
    nodes = [*left, *right]
    found = magnitudes(nodes, at)
    size = [p + abs(x - a) / _BESIDE for (a, p), x in zip(found, evaluate(nodes, after))]
    for (a, _), (b, _), p, q in zip(found, found[len(left) :], size, size[len(left) :]):
        if abs(a - b) > _ALIKE * (p + q):
            return True
    return False


def _branch(graph: Graph, nodes: Sequence[Node], state: State) -> list[Node]:
    """`nodes` with every condition and bend held as it is at `state`."""
    order = reachable(nodes)
    value = dict(zip(order, evaluate(order, state)))
    held: dict[Node, Node] = {}
    for node in order:
        args = tuple([held[a] for a in node.args])
        if node.op == "abs":
            held[node] = args[0] if value[node.args[0]] >= 0.0 else -args[0]
        elif node.op in ("min", "max"):
            held[node] = args[0] if value[node] == value[node.args[0]] else args[1]
        elif (node.op in STEPS or node.op in _LOGIC) and math.isfinite(value[node]):
            held[node] = graph.const(value[node])
        else:
            held[node] = graph.rebuild(node, args) if node.args else node
    return [held[node] for node in nodes]


def _where(switch: Switch) -> str:
    node, side = switch.node, text(switch.side)
    if node.op == "floor":
        return f"`{side}` passes a whole number"
    if node.op in _BORDERS:
        return f"`{side}` {_BORDERS[node.op].words}"
    if node.op == "atan2":
        return f"`{text(node)}` passes its cut"
    if not switch.pieces:
        return f"`{side}` reaches 0"
    left, right = (*node.args, node.graph.zero)[:2]
    if left.is_const:
        left, right = right, left
    return f"`{text(left)}` passes {text(right) if right.is_const else f'`{text(right)}`'}"
