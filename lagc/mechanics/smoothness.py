"""Expressions that have a jump or a kink, and where the mechanics of rigid constraints allows none.

A row of a constraint, the place of a body and a declared speed that bend or jump ask for a jump of
the speeds, which is an impact: no equation of motion holds it.  An energy that jumps is a force
without bound that its gradient, zero nearly everywhere, does not show.  Forces may jump.

Where the condition of `if`, or the argument of `abs`, `sign`, `floor`, `min`, `max` changes, the
expressions on both sides of the change are compared, with their slopes: at random states, beside which
two different analytic functions do not agree (Schwartz-Zippel).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import TypeAlias

from lagc.diagnostics.faults import Fault, Refused, Span
from lagc.expr.derivative import gradient
from lagc.expr.evaluate import evaluate
from lagc.expr.graph import Graph, Node
from lagc.expr.text import text
from lagc.expr.walk import depends, reachable
from lagc.meaning.model import Body, Constraint, Lagrangian, Potential
from lagc.mechanics.magnitude import magnitudes
from lagc.mechanics.samples import samples
from lagc.mechanics.states import States
from lagc.records import dataclass

State: TypeAlias = dict[Node, float]

_JUMPS = frozenset(("sign", "floor", "lt", "le", "eq"))
_BENDS = frozenset(("abs", "min", "max", "sqrt"))  # a root of a square is an `abs`
_ROOT = frozenset(("sqrt",))
_LOGIC = frozenset(("and", "or", "not"))
_ALIKE = 1e-11  # of their terms: two sides agree
_WAYS = tuple([4.0**k for k in range(-16, 33)])  # along which a change is looked for
_BESIDE = 1e-6  # of the way to a change: one side of it
_ANY, _ABOVE, _BELOW = frozenset((-1, 0, 1)), frozenset((0, 1)), frozenset((-1, 0))  # signs


@dataclass(frozen=True, slots=True)
class Break:
    """Where and how an expression is not smooth: `kind` is "jump", or "kink" where slopes alone differ."""

    kind: str
    where: str


def refuse_breaks(states: States) -> None:
    """Raises Refused: LAG0421 a constraint with a kink or jump, LAG0422 a body whose place or frame has
    one, LAG0423 an energy that jumps, LAG0424 a declared speed that does."""
    if not any(_switches(node, _JUMPS | _BENDS) for node in states.graph.nodes):
        return
    place = [*states.q, states.model.time]
    rates = [*states.rates, *(speed.symbol for speed in states.model.speeds)]
    faults: list[Fault | None] = []
    for constraint in states.model.constraints:
        found = _smooth(states, constraint.residuals, [*place, *rates], rows=True)
        faults.append(_bent_row(constraint, found))
    for body in states.model.bodies:
        axes = [x for row in body.frame.axes for x in row] if body.frame is not None else []
        faults.append(_bent_body(body, _smooth(states, [*body.position, *axes], place)))
    for action in states.model.actions:
        if isinstance(action, Potential):
            faults.append(_torn_energy(action.name, action.span, _whole(states, action.energy, states.q)))
        elif isinstance(action, Lagrangian):
            found = _whole(states, action.function, place) or _smooth(states, [action.function], rates)
            faults.append(_torn_energy(action.name, action.span, found))
    for speed in states.model.speeds:
        found = _whole(states, speed.expression, place)
        faults.append(_torn_speed(speed.name, speed.span, found))
    refused = [fault for fault in faults if fault is not None]
    if refused:
        raise Refused(refused)


def jumps_in_time(states: States, energy: Node) -> bool:
    """Whether `energy` jumps at certain times: what it does then is no change of a stored energy."""
    return _whole(states, energy, [states.model.time]) is not None


def _smooth(
    states: States, nodes: Sequence[Node], leaves: Sequence[Node], rows: bool = False
) -> Break | None:
    """The first break of `nodes` along `leaves`; a change that is not found may be one.

    `rows`: where `nodes` are zero, so that the root of a square is no break if they are not at its zero.
    """
    return _break(states, nodes, leaves, _JUMPS | _BENDS, slopes=True, rows=rows)


def _whole(states: States, node: Node, leaves: Sequence[Node]) -> Break | None:
    """The first jump of `node` along `leaves`."""
    return _break(states, [node], leaves, _JUMPS, slopes=False)


def _break(
    states: States,
    nodes: Sequence[Node],
    leaves: Sequence[Node],
    ops: frozenset[str],
    slopes: bool,
    rows: bool = False,
) -> Break | None:
    graph = states.graph
    nodes = states.in_rates(nodes)
    switches = [x for x in reachable(nodes) if _switches(x, ops)]
    if not switches:
        return None
    moving = depends(nodes, leaves)
    switches = [x for x in switches if x in moving and not _fixed(states, x)]
    sides = [_difference(graph, x) for x in switches]
    along = [[leaf for leaf in leaves if leaf in set(reachable([x]))] for x in switches]
    starts = _starts(states, switches, sides, along)
    for switch, side, ways in zip(switches, sides, along):
        found = [_edge(switch, side, state, leaf) for state in starts for leaf in ways]
        edges = [edge for edge in found if edge is not None]
        if rows and switch.op == "sqrt" and _never_zero(nodes, [at for at, _, _ in edges]):
            continue
        kinds = {_kind(graph, nodes, leaves if slopes else (), *edge) for edge in edges}
        if not edges and slopes:
            return Break("possible kink", _where(switch))
        for kind in ("jump", "kink"):
            if kind in kinds:
                return Break(kind, _where(switch))
    return None


def _switches(node: Node, ops: frozenset[str]) -> bool:
    if node.op != "sqrt" or node.op not in ops:
        return node.op in ops
    square = node.args[0]
    if square.op == "scale" and square.value > 0.0:
        square = square.args[0]
    return square.op == "mul" and all(e % 2 == 0 for e in square.value)


def _square_root(root: Node, held: Mapping[Node, Node]) -> Node:
    """u where `root` is that of u^2, a product of even powers; its factors replaced by those of `held`."""
    graph, square, c = root.graph, root.args[0], 1.0
    if square.op == "scale":
        c, square = math.sqrt(square.value), square.args[0]
    return graph.scale(c, graph.product((held.get(b, b), e // 2) for b, e in zip(square.args, square.value)))


def _never_zero(nodes: Sequence[Node], states: Sequence[State]) -> bool:
    """Whether one of `nodes` has the same sign on all of `states`."""
    signs = [{_sign(x) for x in (evaluate([node], state)[0] for state in states)} for node in nodes]
    return {1} in signs or {-1} in signs


def _difference(graph: Graph, switch: Node) -> Node:
    """What is zero where `switch` changes; for `floor` what is a whole number there."""
    if switch.op == "sqrt":
        return _square_root(switch, {})
    return switch.args[0] if len(switch.args) == 1 else graph.sub(*switch.args)


def _starts(
    states: States, switches: Sequence[Node], sides: Sequence[Node], along: Sequence[Sequence[Node]]
) -> list[State]:
    """States at random, and on both sides of every change, so that no branch is left out."""
    found = [state for spread in (0.3, 3.0, 30.0) for state in samples(states.model, 3, spread=spread)]
    beside: list[State] = []
    for switch, side, ways in zip(switches, sides, along):
        for state in found[:1] if found else ():
            for leaf in ways:
                edge = _edge(switch, side, state, leaf)
                for end in (0.5, -0.5) if edge is not None else ():
                    shifted = dict(edge[0]) if edge is not None else {}
                    shifted[leaf] += end * (abs(shifted[leaf]) or 1.0)
                    beside.append(shifted)
    return [*found, *beside]


def _edge(switch: Node, side: Node, state: State, leaf: Node) -> tuple[State, State, State] | None:
    """A state where `switch` changes, reached from `state` along `leaf`, and those before and after."""
    start, level = state[leaf], 0.0
    if switch.op == "floor":
        (first,) = evaluate([side], state)
        level = math.floor(first) + 1.0 if math.isfinite(first) else 0.0

    def value(x: float) -> float:
        return evaluate([side], {**state, leaf: x})[0] - level

    bounds = _bracket(value, start)
    if bounds is None:
        return None
    root = _bisected(value, *bounds)
    step = _BESIDE * max(abs(root), abs(bounds[1] - bounds[0]))
    if not value(root - step) * value(root + step) < 0.0:
        return None
    return {**state, leaf: root}, {**state, leaf: root - step}, {**state, leaf: root + step}


def _bracket(value: Callable[[float], float], start: float) -> tuple[float, float] | None:
    """Two arguments with values of unlike sign, the nearest to `start` that are met."""
    first = value(start)
    size = abs(start) or 1.0
    for way in _WAYS:
        for x in (start + way * size, start - way * size):
            other = value(x)
            if first * other < 0.0:
                return start, x
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


def _kind(
    graph: Graph, nodes: Sequence[Node], leaves: Sequence[Node], at: State, before: State, after: State
) -> str:
    """How `nodes` differ on both sides of the state `at`: "jump", "kink" or not at all."""
    left, right = _branch(graph, nodes, before), _branch(graph, nodes, after)
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
        elif _switches(node, _ROOT):
            root = _square_root(node, held)
            held[node] = root if evaluate([root], state)[0] >= 0.0 else -root
        elif node.op in ("min", "max"):
            held[node] = args[0] if value[node] == value[node.args[0]] else args[1]
        elif (node.op in _JUMPS or node.op in _LOGIC) and math.isfinite(value[node]):
            held[node] = graph.const(value[node])
        else:
            held[node] = graph.rebuild(node, args) if node.args else node
    return [held[node] for node in nodes]


# -- arguments of one sign --------------------------------------------------------------------


def _fixed(states: States, switch: Node) -> bool:
    """Whether `switch` never changes, because its argument has one sign whatever the motion."""
    if switch.op == "floor":
        return False
    bounded = {p.symbol: _BELOW if p.maximum <= 0.0 else _ABOVE
               for p in states.model.parameters if p.minimum >= 0.0 or p.maximum <= 0.0}  # fmt: skip
    signs: dict[Node, frozenset[int]] = {}
    side = _difference(states.graph, switch)
    for node in reachable([side]):
        signs[node] = bounded.get(node) or _signs(node, [signs[a] for a in node.args])
    return signs[side] != _ANY


def _signs(node: Node, given: Sequence[frozenset[int]]) -> frozenset[int]:
    """The signs, of -1 0 1, that `node` may have where its arguments have the given ones."""
    if node.op == "const":
        return frozenset((_sign(node.value),))
    if node.op == "scale":
        return frozenset(_sign(node.value) * s for s in given[0])
    if node.op == "add":
        return frozenset(
            s for a in given[0] for b in given[1] for s in ((-1, 0, 1) if a * b < 0 else (a or b,))
        )
    if node.op == "mul":
        found = frozenset((1,))
        for signs, exponent in zip(given, node.value):
            found = frozenset(a * (b if exponent % 2 else b * b) for a in found for b in signs)
        return found
    if node.op in ("exp", "cosh"):
        return frozenset((1,))
    if node.op in ("abs", "sqrt"):
        return frozenset(s * s for s in given[0])
    return _ANY


def _sign(value: float) -> int:
    return (value > 0.0) - (value < 0.0)


# -- what is said -----------------------------------------------------------------------------


def _where(switch: Node) -> str:
    if switch.op == "floor":
        return f"`{text(switch.args[0])}` passes a whole number"
    left, right = (*switch.args, switch.graph.zero)[:2]
    if switch.op == "sqrt":
        left = _square_root(switch, {})
    if left.is_const:
        left, right = right, left
    return f"`{text(left)}` passes {text(right) if right.is_const else f'`{text(right)}`'}"


def _bent_row(c: Constraint, found: Break | None) -> Fault | None:
    if found is None:
        return None
    return Fault(
        "LAG0421",
        f"the constraint `{c.name}` has a {found.kind} where {found.where}: the speeds would jump there",
        c.span,
        remedy="write it with a function whose slope does not jump, or let a force act in its place",
    )


def _bent_body(body: Body, found: Break | None) -> Fault | None:
    if found is None:
        return None
    return Fault(
        "LAG0422",
        f"the place of `{body.name}` has a {found.kind} where {found.where}: its velocity would jump there",
        body.span,
        remedy="write it with a function whose slope does not jump",
    )


def _torn_energy(name: str, span: Span, found: Break | None) -> Fault | None:
    if found is None:
        return None
    return Fault(
        "LAG0423",
        f"the energy `{name}` has a {found.kind} where {found.where}: no finite force goes with it",
        span,
        remedy="let it change over a distance, or write the forces that are meant with `force`",
    )


def _torn_speed(name: str, span: Span, found: Break | None) -> Fault | None:
    if found is None:
        return None
    return Fault(
        "LAG0424",
        f"the speed `{name}` has a jump where {found.where}, though nothing moves faster there",
        span,
        remedy="declare a speed that changes with the motion alone",
    )
