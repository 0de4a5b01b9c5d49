"""Warnings where a constraint, a place, an energy or a declared speed jumps or has a kink.

The speeds would jump there, which is an impact. A motion may never get there, so the model is accepted, and a
clause `when` stops a run that does. Roots, quotients and angles are not examined: a run stops where a row has
no gradient or the energy is out of balance.

Newton's method finds states at which an event indicator is zero. There the expressions on both sides and
their slopes are compared: two different analytic functions differ at a random point (Schwartz-Zippel).
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import islice, pairwise
from typing import NamedTuple, TypeAlias

from lagc.base.records import dataclass
from lagc.diagnostics.faults import Fault, Span
from lagc.mechanics.formulation.equations import WhenEquations
from lagc.mechanics.formulation.states import States
from lagc.mechanics.identities.samples import magnitudes
from lagc.semantics.model import Lagrangian, Potential, When
from lagc.symbolic.derivative import gradient
from lagc.symbolic.enclosures import extended, intervals
from lagc.symbolic.expression_text import brief
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.operators import CORNER, LOGIC, STEP, Interval, smooth_as
from lagc.symbolic.walk import depends, evaluate, reachable, symbols

State: TypeAlias = Mapping[Node, float]

_STEPS, _LOGIC = smooth_as(STEP), smooth_as(LOGIC)
_RELATIONS = _STEPS | smooth_as(CORNER)
_COUNTING = ("floor", "piece")
_NEWTON = 60  # iterations; most need some five
_POINTS = 12  # zeros of an indicator at which both sides are compared
_ALIKE = 1e-11  # of their terms: two sides agree
_BESIDE = 1e-6  # of the distance to a zero: one side of it
_ROUND = "write it with a function whose slope does not jump"


class Cuts(NamedTuple):
    """Warnings, and the clauses that stop a run at a jump."""

    warnings: tuple[Fault, ...]
    whens: tuple[WhenEquations, ...]


class _Place(NamedTuple):
    """Expressions that may not jump in the leaves, nor have a kink if `slopes`; the warning if they do."""

    nodes: Sequence[Node]
    leaves: Sequence[Node]
    slopes: bool
    code: str
    what: str
    remedy: str
    span: Span


def find_cuts(states: States, relations: Collection[Node]) -> Cuts:
    """Return warnings LAG0421 of constraints and LAG0422 of places with a jump or kink, LAG0423 of energies
    and LAG0424 of declared speeds with a jump; `relations` are the candidates."""
    # Expressions above no relation are smooth, and are not looked at.
    above = set(relations)
    for node in states.graph.nodes:
        if not above.isdisjoint(node.args):
            above.add(node)
    all_smooth = above.isdisjoint([] if states.plain else states.spelt.values())
    warnings: list[Fault] = []
    whens: list[WhenEquations] = []
    for nodes, leaves, slopes, code, what, remedy, span in _places(states):
        if all_smooth and above.isdisjoint(nodes):
            continue
        found = find_break(states, nodes, leaves, slopes, rows=code == "LAG0421")
        if found is None:
            continue
        message = f"{what} has a {found.kind} where {found.where}; a run that gets there stops"
        fault = Fault(code, message, span, remedy=remedy, severity="warning")
        if fault not in warnings:
            warnings.append(fault)
        whens += _stops(fault, found)
    return Cuts(tuple(warnings), tuple(whens))


def _places(states: States) -> Iterator[_Place]:
    """Yield constraints, places of bodies, energies and declared speeds."""
    model = states.model
    positions = list(states.q)
    place = [*positions, model.time]
    rates = [*states.rates, *(speed.symbol for speed in model.speeds)]
    # Rows of positions may have neither jump nor kink, as their gradients are forces. Rows of speeds
    # may have kinks.
    remedy = f"{_ROUND}, or let a force act in its place"
    in_rates = depends([x for c in model.constraints for x in c.residuals], rates)
    for c in model.constraints:
        for nonholonomic in (False, True):  # a kink is a jump of the forces
            rows = [x for x in c.residuals if (x in in_rates) == nonholonomic]
            leaves = [*place, *rates] if nonholonomic else place
            what = f"the constraint `{c.name}`"
            yield _Place(rows, leaves, not nonholonomic, "LAG0421", what, remedy, c.span)
    for body in model.bodies:
        axes = [x for row in body.frame.axes for x in row] if body.frame is not None else []
        what = f"the place of `{body.name}`"
        yield _Place([*body.position, *axes], place, True, "LAG0422", what, _ROUND, body.span)
    # Energies may have kinks in the coordinates, where forces jump, but none in the rates, where momenta
    # would.
    remedy = "let it change over a distance, or write the forces that are meant with `force`"
    for action in model.actions:
        what = f"the energy `{action.name}`"
        if isinstance(action, Potential):
            yield _Place([action.energy], positions, False, "LAG0423", what, remedy, action.span)
        elif isinstance(action, Lagrangian):
            yield _Place([action.function], place, False, "LAG0423", what, remedy, action.span)
            yield _Place([action.function], rates, True, "LAG0423", what, remedy, action.span)
    remedy = "declare a speed that changes with the motion alone"
    for speed in model.speeds:
        what = f"the speed `{speed.name}`"
        yield _Place([speed.expression], place, False, "LAG0424", what, remedy, speed.span)


def _stops(fault: Fault, found: Break) -> list[WhenEquations]:
    """Return clauses that end a run as failed where the relation changes."""
    assert fault.span is not None
    words, reason = found.where.replace("`", ""), fault.message.partition(";")[0]
    clauses = [When(words, c, (), reason, (), fault.span, fails=True) for c in found.conditions]
    return [WhenEquations(clause, clause.condition, ()) for clause in clauses]


def jumps_in_time(states: States, energy: Node) -> bool:
    """Return whether `energy` jumps at certain times: the change is no change of a stored energy."""
    return find_break(states, [energy], [states.model.time], slopes=False) is not None


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
        """Return two conditions: whenever the relation changes, one of them becomes true."""
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
    # Relations below the expressions that the leaves move, whose indicators can be zero for some values of
    # the parameters.
    moving = depends(everything, leaves)
    ops = _RELATIONS if slopes else _STEPS
    found = [node for node in reachable(everything) if node.op in ops and node in moving]
    kept = intervals([_indicator(node) for node in found], states.bounds) if found else {}
    found = [node for node in found if not _is_constant(node, kept[_indicator(node)])]
    # A row vanishes along the motion: its value where the indicator is zero must contain zero.
    if rows:
        found = [node for node in found if not _is_never_met(states, everything, node)]
    kink: Break | None = None
    # Up to twelve zeros of each indicator: the first jump settles it, a kink is remembered.
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


# -- zeros of an indicator -----------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Point:
    """A state where an indicator is zero as `leaf` moves; one side and the other are `step` away."""

    state: State
    leaf: Node
    step: float

    def displaced(self, distance: float) -> State:
        return {**self.state, self.leaf: self.state[self.leaf] + distance}


def _zeros(states: States, relation: Node, nodes: Sequence[Node], leaves: Sequence[Node]) -> Iterator[_Point]:
    """Yield zeros of the indicator near random states, by Newton's method with the least relative change of
    the leaves."""
    indicator, graph = _indicator(relation), states.graph
    slopes = gradient(graph, {indicator: graph.one}, leaves)
    needed = symbols([*nodes, indicator])
    # From random states, near and far.
    for sample in states.scattered if slopes else ():
        given = {x: sample[x] for x in needed}
        # Each level at which the relation changes: 0, or the two whole numbers or the knots beside.
        for level in _levels(relation, evaluate([indicator], given)[0]):
            state = dict(given)
            # Newton's method for one equation: the shortest step in the sizes of the leaves, along the
            # gradient.
            for _ in range(_NEWTON):
                value, *slope = evaluate([indicator, *slopes.values()], state)
                sizes = [abs(given[x]) or 1.0 for x in slopes]
                square = sum((g * s) ** 2 for g, s in zip(slope, sizes))
                if not (math.isfinite(value) and 0.0 < square < math.inf):
                    break
                before = dict(state)
                for x, g, s in zip(slopes, slope, sizes):
                    state[x] -= (value - level) * g * s * s / square
                # The leaf that moved most counts as the direction across the zero.
                leaf = max(zip(slopes, slope, sizes), key=lambda each: abs(each[1] * each[2]))[0]
                if abs(state[leaf] - before[leaf]) <= 1e-15 * max(abs(state[leaf]), 1e-3 * abs(given[leaf])):
                    reach = max(abs(state[leaf]), abs(given[leaf])) or 1.0
                    yield _Point(state, leaf, _BESIDE * reach)
                    break


def _levels(relation: Node, value: float) -> Sequence[float]:
    """Return the values of the indicator, near `value`, at which the relation changes."""
    if relation.op == "floor":
        return [math.floor(value) + k for k in (0.0, 1.0)] if math.isfinite(value) else []
    if relation.op == "piece":
        return _knots(relation, value)
    return [0.0]


def _knots(piece: Node, value: float) -> list[float]:
    """Return the knots beside `value`, the first, the last, and those where the entries of tables change
    most."""
    table = piece.value
    place = int(table.piece(value))
    found = {1, len(table) - 1, place, place + 1}
    for node in piece.graph.nodes:
        if node.op == "entry" and node.args[0] is piece:
            changes = [abs(b - a) for a, b in pairwise(node.value)]
            found.add(1 + changes.index(max(changes)))
    return [table[k] for k in sorted(found) if 0 < k < len(table)]


# -- both sides of a zero ------------------------------------------------------------------------


def _kind(graph: Graph, nodes: Sequence[Node], leaves: Sequence[Node], point: _Point) -> str:
    """Return "jump" where values on both sides differ, "kink" where slopes along `leaves` do, or ""."""
    # Both sides with all relations held: two analytic expressions, compared at the zero itself.
    before, at, after = (point.displaced(d) for d in (-point.step, 0.0, point.step))
    kind = ""
    for a, b in zip(_branch(graph, nodes, before), _branch(graph, nodes, after)):
        if a is b:
            continue
        if _differ([a], [b], at, after):
            return "jump"
        # Equal values: their slopes along the leaves.
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
    # A difference counts against the size of the terms, and against what moving a little would change.
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
