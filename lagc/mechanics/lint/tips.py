"""Where a row holds and has no gradient, at points that several coordinates reach only together.

The tip of a cone, `sqrt(x^2 + y^2)` at x = y = 0, is passed by no single coordinate.  It is sought by
Newton's method on what vanishes there; beside it, in two directions, values and slopes are compared at
distances that shrink: where they do not become alike, the row jumps or bends there.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise

from lagc.mechanics.formulation.states import States
from lagc.mechanics.lint.break_candidates import State, switches, together, where
from lagc.mechanics.lint.discontinuities import Ranks
from lagc.mechanics.numeric.cancellation import magnitudes
from lagc.mechanics.numeric.dense_linear import least_norm
from lagc.mechanics.numeric.samples import Chance
from lagc.symbolic.derivative import gradient
from lagc.symbolic.evaluate import evaluate
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import symbols

_ROOTS = frozenset(("sqrt", "mul", "pow"))  # what may have a tip; `mul`: a quotient
_ITERATIONS = 40
_EXACT, _ABOUT = 1e-15, 1e-4  # of its terms: what vanishes at a tip; a row that holds there
_BESIDE = (1e-4, 1e-5, 1e-6)  # of the sizes of coordinates: distances from a tip
_STAYS = 0.5  # from one distance to the next
_SEEN = 1e-6  # of the steepest slope


def find_tip(
    states: States, residuals: Sequence[Node], leaves: Ranks, positions: Sequence[Node]
) -> str | None:
    """What vanishes, in words, where rows `residuals` = 0 hold and have no gradient in `leaves`, where
    `positions` reach it; None where no such point is found, with the parameters' own values."""
    nodes = states.in_rates(residuals)
    for switch in switches(states, nodes, leaves, True):
        parts = together(switch.side) if switch.node.op in _ROOTS else []
        present = symbols(parts)
        moved = [leaf for leaf in positions if leaf in present] if len(parts) > 1 else []
        if moved and all(_breaks(states, nodes, parts, moved, leaves, state) for state in states.near):
            return where(switch)
    return None


def _breaks(
    states: States,
    nodes: Sequence[Node],
    parts: Sequence[Node],
    moved: Sequence[Node],
    leaves: Ranks,
    near: State,
) -> bool:
    """Whether `nodes` are zero and break where `parts` vanish as the leaves `moved` move from `near`."""
    state = {x: near[x] for x in symbols([*nodes, *parts])}
    tip = _met(states, parts, moved, state, state, _EXACT)
    if tip is None:
        return False
    chance = Chance()
    present = sorted(state.keys() & leaves.keys(), key=leaves.__getitem__)
    size = {leaf: abs(state[leaf]) or 1.0 for leaf in present}
    ways = [{leaf: size[leaf] * chance.draw() for leaf in moved} for _ in range(2)]
    free = [leaf for leaf in size if leaf not in moved]
    held = _met(states, nodes, free, _beside(tip, ways[0], _BESIDE[-1]), state, _ABOUT)
    if held is None:
        return False
    tip = {**held, **{leaf: tip[leaf] for leaf in moved}}
    return any(_differs(states, node, tip, ways, size) for node in nodes)


def _differs(
    states: States, node: Node, tip: State, ways: Sequence[Mapping[Node, float]], size: Mapping[Node, float]
) -> bool:
    """Whether the value or a slope of `node` in both directions stays apart, nearer and nearer to `tip`."""
    slopes = gradient(states.graph, {node: states.graph.one}, list(size))
    seen, sizes = [node, *slopes.values()], [1.0, *(size[leaf] for leaf in slopes)]
    apart = list[list[float]]()
    least = 0.0
    for distance in _BESIDE:
        one, two = (evaluate(seen, _beside(tip, way, distance)) for way in ways)
        if not all(map(math.isfinite, [*one, *two])):
            return False
        apart.append([abs(a - b) * c for a, b, c in zip(one, two, sizes)])
        least = _SEEN * max(
            [abs(a * c) for found in (one, two) for a, c in zip(found[1:], sizes[1:])], default=0.0
        )
    return any(
        min(series) > least and all(b > _STAYS * a for a, b in pairwise(series)) for series in zip(*apart)
    )


def _beside(tip: State, way: Mapping[Node, float], distance: float) -> State:
    return {**tip, **{leaf: tip[leaf] + distance * step for leaf, step in way.items()}}


def _met(
    states: States, nodes: Sequence[Node], leaves: Sequence[Node], start: State, state: State, met: float
) -> State | None:
    """`start` with `leaves` moved to where `nodes` are zero, up to `met` of their terms at `state`; None
    where Newton's method finds no such."""
    graph, now = states.graph, dict(start)
    slopes = [gradient(graph, {node: graph.one}, leaves) for node in nodes]
    entries = [own.get(leaf, graph.zero) for own in slopes for leaf in leaves]
    sizes = [abs(state[leaf]) or 1.0 for leaf in leaves]
    terms = [size for _, size in magnitudes(nodes, state)]
    for _ in range(_ITERATIONS):
        missed = evaluate(nodes, now)
        if all(abs(value) <= met * size for value, size in zip(missed, terms)):
            return now
        values = evaluate(entries, now)
        if not leaves or not all(map(math.isfinite, [*values, *missed])):
            return None
        n = len(leaves)
        matrix = [[a * b for a, b in zip(values[k : k + n], sizes)] for k in range(0, len(values), n)]
        for leaf, size, part in zip(leaves, sizes, least_norm(matrix, [-value for value in missed])):
            now[leaf] += size * part
    return None
