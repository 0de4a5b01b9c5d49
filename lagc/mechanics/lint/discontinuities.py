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
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from functools import partial
from itertools import pairwise
from typing import TypeAlias

from lagc.base.records import dataclass, field
from lagc.mechanics.formulation.states import States
from lagc.mechanics.lint.break_candidates import (
    ENDS,
    STEPS,
    State,
    Switch,
    switches,
    unlike_quotients,
    ways_of,
    where,
)
from lagc.mechanics.numeric.cancellation import magnitudes
from lagc.mechanics.numeric.scalar_roots import zeros
from lagc.symbolic.derivative import gradient, tangent
from lagc.symbolic.directional import Lines, Shape, terms
from lagc.symbolic.evaluate import evaluate
from lagc.symbolic.finite_field import Point, Undefined
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.operators import ENTIRE, LOGIC, smooth_as
from lagc.symbolic.walk import reachable, symbols

Ranks: TypeAlias = Mapping[Node, int]  # leaves, with their order
Way: TypeAlias = tuple[Node, Node, Node]  # a switch, its side, and a leaf that moves

_LOGIC = smooth_as(LOGIC)
_ALIKE = 1e-11  # of their terms: two sides agree
_BESIDE = 1e-6  # of the way to a change: one side of it
_NEARER = tuple([10.0 ** (-0.5 * k) for k in range(4, 9)])  # of the way: both sides of an end
_LITTLE = 1e-4
_STAYS, _GROWS = 0.8, 3.0  # from one distance to the next: a jump stays, a slope may grow as a cusp's
_SEEN = 1e-7  # of the size of both sides
_POINTS = 8  # of the field, half of which have no root of a number
_ANALYTIC = smooth_as(ENTIRE) | frozenset(("const", "symbol", "add", "scale", "mul", "sqrt"))


@dataclass(frozen=True, slots=True)
class Break:
    """How an expression is not smooth, "jump" or "kink", and where; `cut`: it is that of an angle."""

    kind: str
    where: str
    cut: bool


@dataclass(frozen=True, slots=True)
class Edge:
    """A state where a switch changes: `state` with `leaf` at `x`; one side of it and the other are `step`
    away, and neighbours that were looked at `reach`.  `knot`: that of a table at which it is."""

    state: State
    leaf: Node
    x: float
    step: float
    reach: float
    crosses: bool
    knot: float | None

    def beside(self, way: float) -> State:
        return {**self.state, self.leaf: self.x + way}


def ranked(leaves: Sequence[Node]) -> Ranks:
    return {leaf: k for k, leaf in enumerate(leaves)}


def find_break(
    states: States,
    nodes: Sequence[Node],
    leaves: Ranks,
    slopes: bool,
    rows: bool = False,
    quiet: set[Way] | None = None,
) -> Break | None:
    """The first break of `nodes` that is found along `leaves`: a jump, or where `slopes` count a kink.

    `rows`: `nodes` are zero along the motion, which does not come to changes where one of them is not.
    `quiet`: where no change was found and none is sought again, which this adds to.
    """
    quiet = set() if quiet is None else quiet
    everything = states.in_rates(nodes)
    present = symbols(everything)
    rank = {leaf: leaves[leaf] for leaf in sorted(present & leaves.keys(), key=leaves.__getitem__)}
    nodes = unlike_quotients(everything, rank)
    pairs: list[tuple[Switch, Sequence[Node]]]
    pairs = [(x, ways_of(x, rank)) for x in switches(states, nodes, rank, slopes)]
    pairs = [(x, ways) for x, ways in pairs if ways]
    starts = [{x: state[x] for x in present} for state in states.scattered] if pairs else []
    if not any(x.pieces for x, _ in pairs):
        pairs = _loud(pairs, quiet)
    if not pairs:
        return None
    edges = [_all_edges(x, starts, ways) for x, ways in pairs]
    for (x, ways), found in zip(pairs, edges):
        if not found:
            quiet.update((x.node, x.side, y) for y in ways)
    if any(x.pieces for x, _ in pairs):  # no branch is left out
        first = [{e.leaf: e for e in reversed(found) if e.state is starts[0]} for found in edges]
        more = [[_moved(e, end) for e in table.values() for end in (0.5, -0.5)] for table in first]
        for found, near, (x, ways) in zip(edges, _neighbours(nodes, [x for x, _ in pairs]), pairs):
            found.extend(e for k in near for state in more[k] for e in _edges(x, state, ways))
    parts = _moved_parts(states.graph, nodes, dict.fromkeys(e.leaf for found in edges for e in found))
    sight = _Sight()
    cut: Break | None = None
    for (switch, _), found in zip(pairs, edges):
        if rows:
            found = [
                e
                for own in _by_knot(found)
                if not _never_zero(sight, everything, switch, rank, own)
                for e in own
            ]
        if switch.pieces:
            wrt = rank if slopes else ()
            kinds = {_kind(states.graph, parts[e.leaf], wrt, e) for e in found if e.crosses}
        else:
            ends = switch.node.op in ENDS or switch.node.op == "pow"  # beyond what they cross is nothing
            kinds = {_kind_beside(parts[e.leaf], slopes, e) for e in found if not (ends and e.crosses)}
        for kind in ("jump", "kink"):
            if kind in kinds:
                broken = Break(kind, where(switch), switch.node.op == "atan2")
                if not broken.cut:
                    return broken
                cut = cut or broken
                break
    return cut


def _neighbours(nodes: Sequence[Node], found: Sequence[Switch]) -> list[list[int]]:
    """Of each switch, those by number that stand in one term of a sum with it: of others it shows whatever
    their branch."""
    numbers: dict[Node, list[int]] = {}
    for k, x in enumerate(found):
        numbers.setdefault(x.node, []).append(k)
    near: list[set[int]] = [set() for _ in found]
    for term in dict.fromkeys(t for node in nodes for t in terms(node)):
        together = [k for x in reachable([term]) for k in numbers.get(x, ())]
        for k in together:
            near[k].update(together)
    return [sorted(x) for x in near]


@dataclass
class _Part:
    """What of the nodes one leaf moves, with the rates along it."""

    nodes: list[Node]
    rates: list[Node]
    symbols: set[Node]

    def at(self, edge: Edge, way: float) -> State:
        """The state beside `edge`, as far as the nodes depend on it."""
        found = {x: edge.state[x] for x in self.symbols}
        found[edge.leaf] = edge.x + way
        return found


def _moved_parts(graph: Graph, nodes: Sequence[Node], leaves: Mapping[Node, None]) -> dict[Node, _Part]:
    """By leaf; of sums, the terms that it moves."""
    moved: dict[Node, list[dict[Node, float]]] = {leaf: [] for leaf in leaves}
    for node in nodes:
        by_leaf: dict[Node, dict[Node, float]] = {}
        for term, c in terms(node).items():
            for leaf in symbols([term]) & moved.keys():
                by_leaf.setdefault(leaf, {})[term] = c
        for leaf, own in by_leaf.items():
            moved[leaf].append(own)
    found: dict[Node, _Part] = {}
    for leaf, tables in moved.items():
        sums = [graph.sum(graph.scale(c, t) for t, c in own.items()) for own in tables]
        rates = tangent(graph, sums, {leaf: graph.one})
        found[leaf] = _Part(sums, rates, symbols([*sums, *rates]))
    return found


@dataclass
class _Sight:
    """Nodes as functions of single leaves, seen from states."""

    shapes: dict[Node, Shape] = field(default_factory=dict)
    lines: dict[tuple[Node, int], Lines] = field(default_factory=dict)

    def shape(self, node: Node) -> Shape:
        if node not in self.shapes:
            self.shapes[node] = Shape(node)
        return self.shapes[node]

    def along(self, node: Node, state: State, leaf: Node) -> Callable[[float], float]:
        key = (node, id(state))
        if key not in self.lines:
            self.lines[key] = Lines(self.shape(node), state)
        return self.lines[key].along(leaf)


# -- where it changes -------------------------------------------------------------------------


def _edges(switch: Switch, state: State, ways: Sequence[Node]) -> Iterator[Edge]:
    """The changes of `switch` that are nearest to `state`, as one of `ways` alone moves."""
    lines = Lines(switch.shape, state)
    for leaf in ways:
        value, start = lines.along(leaf), state[leaf]
        first, size = value(start), abs(start) or 1.0
        for level in switch.levels(first):
            knot = level if switch.node.op == "piece" else None
            change = partial(_changes, switch, level, value)
            for zero in zeros(change, start, size, switch.shape.period(leaf)):
                reach = max(zero.reach, size / 16.0)
                step = _BESIDE * max(abs(zero.at), reach)
                edge = Edge(state, leaf, zero.at, step, reach, zero.crosses, knot)
                if switch.active(edge.beside(-step)) or switch.active(edge.beside(step)):
                    yield edge


def _loud(
    pairs: Sequence[tuple[Switch, Sequence[Node]]], quiet: set[Way]
) -> list[tuple[Switch, Sequence[Node]]]:
    """Those that are not `quiet`, nor the same everywhere, which they then are."""
    found: list[tuple[Switch, Sequence[Node]]] = []
    for x, ways in pairs:
        keys = [(x.node, x.side, y) for y in ways]
        if not quiet.issuperset(keys):
            if _constant(x, ways):
                quiet.update(keys)
            else:
                found.append((x, ways))
    return found


def _constant(switch: Switch, ways: Sequence[Node]) -> bool:
    """It is proved that `side` is the same along `ways` (`expr.modular`), and not zero."""
    if not all([x.op in _ANALYTIC for x in reachable([switch.side])]):
        return False
    for seed in range(_POINTS):
        point = Point(seed, roots=False)  # of a root a sign would be drawn
        try:
            here = point.values([switch.side])
            point.place({y: point.draw() for y in ways})
            return here == point.values([switch.side]) != [0]
        except Undefined:
            continue
    return False


def _all_edges(switch: Switch, starts: Sequence[State], ways: Sequence[Node]) -> list[Edge]:
    """From all `starts`, where there is a change near one of every four; an angle's may be at any."""
    few = [e for state in starts[::4] for e in _edges(switch, state, ways)]
    if not few and not switch.pieces and switch.node.op != "atan2":
        return []
    return few + [e for k, state in enumerate(starts) if k % 4 for e in _edges(switch, state, ways)]


def _by_knot(edges: Sequence[Edge]) -> Collection[list[Edge]]:
    found: dict[float | None, list[Edge]] = {}
    for edge in edges:
        found.setdefault(edge.knot, []).append(edge)
    return found.values()


def _changes(switch: Switch, level: float, value: Callable[[float], float], x: float) -> float:
    return switch.of(value(x)) - level


def _moved(edge: Edge, end: float) -> State:
    return edge.beside(end * max(abs(edge.x), edge.reach))


def _never_zero(
    sight: _Sight, nodes: Sequence[Node], switch: Switch, leaves: Ranks, edges: Sequence[Edge]
) -> bool:
    """Whether one of `nodes` has the same sign at all `edges`, whatever the `leaves` that do not move the
    change."""
    for node in nodes if edges else ():
        signs = [_signs(sight.along(node, e.state, e.leaf), e) for e in edges]
        if any(len({pair[k] for pair in signs} | {0}) != 2 for k in (0, 1)):
            continue
        within = symbols([node]) - symbols([switch.side])
        free = [leaf for leaf in leaves if leaf in within]
        first = edges[0]
        ends = [Lines(sight.shape(node), first.beside(way)) for way in (-first.step, first.step)]
        if not any(_meets(end, switch, leaf) for end in ends for leaf in free):
            return True
    return False


def _meets(end: Lines, switch: Switch, leaf: Node) -> bool:
    """Whether a node is zero somewhere along `leaf` at the change."""
    start = end.known[leaf]
    found = zeros(end.along(leaf), start, abs(start) or 1.0)
    return any(zero.crosses and switch.active({**end.state, leaf: zero.at}) for zero in found)


def _signs(value: Callable[[float], float], edge: Edge) -> list[int]:
    """On both sides of a change, the lesser first; 0 where it is small beside what it is farther away."""
    x = edge.x
    before, after, *far = (value(x + d) for d in (-edge.step, edge.step, -edge.reach, edge.reach))
    least = _LITTLE * (abs(far[0]) + abs(far[1]))
    return sorted([(v > least) - (v < -least) for v in (before, after)])


# -- what changes -----------------------------------------------------------------------------


def _kind_beside(part: _Part, slopes: bool, edge: Edge) -> str:
    """How the nodes, with their rates along the edge's leaf, differ on both sides of an end of a domain,
    however near."""
    found: list[list[tuple[float, float]]] = []
    nodes, n = [*part.nodes, *part.rates], len(part.nodes)
    for way in _NEARER:
        h = way * edge.reach
        before, after = (evaluate(nodes, part.at(edge, d)) for d in (-h, h))
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
        if k < n:
            if all(_STAYS < r < 1.0 / _STAYS for r in ratios):
                return "jump"
        elif all(_STAYS < r < _GROWS for r in ratios):
            kind = "kink"
    return kind


def _kind(graph: Graph, part: _Part, rank: Collection[Node], edge: Edge) -> str:
    """How the nodes differ in value, and in slope along the leaves in `rank`, on both sides of a change of
    pieces."""
    before, at, after = (part.at(edge, d) for d in (-edge.step, 0.0, edge.step))
    left, right = _branch(graph, part.nodes, before), _branch(graph, part.nodes, after)
    leaves = [leaf for leaf in rank if leaf in part.symbols]
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
