"""Derivatives on the graph: one forward sweep (`tangent`) or one reverse sweep (`gradient`).

A. Griewank, A. Walther, *Evaluating Derivatives*, SIAM 2008, chapter 3.  Only nodes that
depend on the seeds are visited; piecewise functions are differentiated branch by branch,
with the value 0 for the derivative of a step.  A branch that is not taken need have no slope.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping, Sequence
from typing import TypeVar

from lagc.base.records import dataclass
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.operators import END, OPERATORS, POLE
from lagc.symbolic.walk import reachable, symbols

T = TypeVar("T")


def partials(graph: Graph, node: Node) -> tuple[Node, ...]:
    """d(node)/d(argument), one an argument."""
    op, args = node.op, node.args
    if op == "add":
        return (graph.one, graph.one)
    if op == "scale":
        return (graph.const(node.value),)
    if op == "mul":
        return tuple([partial(graph, node, k) for k in range(len(args))])
    return OPERATORS[op].slopes(graph, node, *args)


def partial(graph: Graph, node: Node, k: int) -> Node:
    """d(node)/d(argument k) alone."""
    if node.op == "mul":
        exponent = node.value[k]
        return graph.scale(float(exponent), graph.reduced(node, k))
    return partials(graph, node)[k]


def tangent(
    graph: Graph,
    outputs: Sequence[Node],
    seeds: Mapping[Node, Node],
    within: Sequence[Node] | None = None,
) -> list[Node]:
    """d(outputs) along the direction d(leaf) = seeds[leaf]; leaves without a seed stand still.

    `within`: the nodes below `outputs` that leaves can change, arguments before users, where these
    are known already.
    """
    order = reachable(outputs) if within is None else within
    leaves = order if within is None else seeds  # of many seeds, those that are asked for
    rates = {leaf: seeds[leaf] for leaf in leaves if leaf in seeds and not seeds[leaf].is_zero}
    zero = graph.zero
    for node in order:
        if node in rates or not node.args:
            continue
        moving = [k for k, a in enumerate(node.args) if a in rates]
        if not moving:
            continue
        total = zero
        if node.op == "select":
            total, moving = graph.select(node.args[0], *[rates.get(a, zero) for a in node.args[1:]]), []
        for k in moving:
            rate = rates[node.args[k]]
            share = rate if node.op == "add" else graph.mul(partial(graph, node, k), rate)
            total = graph.add(total, share)
        if total is not zero:
            rates[node] = total
    return [rates.get(node, zero) for node in outputs]


def gradient(
    graph: Graph,
    seeds: Mapping[Node, Node],
    wrt: Sequence[Node] | Mapping[Node, int],
    within: Sequence[Node] | None = None,
) -> dict[Node, Node]:
    """sum over outputs of seeds[output] * d(output)/d(w), for the w where it is not zero, in their order: of
    many that are asked for often, each with its place.

    `within` as in `tangent`.
    """
    places = wrt if isinstance(wrt, Mapping) else {w: k for k, w in enumerate(wrt)}
    live = set[Node]() if within is None else set(places)
    order: list[Node] = []
    for node in reachable(seeds) if within is None else within:
        if node in places or not live.isdisjoint(node.args):
            live.add(node)
            order.append(node)
    sweep = _Sweep(graph, places, order)
    for node, seed in seeds.items():
        if node in live:
            sweep.add(node, seed, ALWAYS)
    for node in reversed(order):
        sweep.pass_on(node, live)
    adjoint = sweep.adjoint
    found = sorted([w for w in adjoint if w in places], key=places.__getitem__)
    return {w: adjoint[w] for w in found if not adjoint[w].is_zero}


@dataclass(frozen=True, slots=True)
class _Choice:
    """That branches of choices are taken, (condition, which) from the inner to the outer; `partly` are the
    nodes above functions that need have no value or slope where they are not."""

    taken: tuple[tuple[Node, bool], ...]
    partly: frozenset[Node]


ALWAYS = _Choice((), frozenset())


class _Sweep:
    """Weights on their way down.  Beside those of all times, each node may have some of a choice: what passes
    functions that are not everywhere is chosen behind them, as 0 times what is not finite is not 0."""

    def __init__(self, graph: Graph, places: Mapping[Node, int], order: Sequence[Node]):
        self.graph, self.places = graph, places
        self.adjoint: dict[Node, Node] = {}
        self.chosen: dict[Node, dict[_Choice, Node]] = {}
        self.narrow: set[Node] = set()  # nodes at or above functions that are not everywhere
        conditions = [node.args[0] for node in order if node.op == "select"]
        self.deciding = symbols(conditions)
        if conditions:
            for node in reachable(order):
                if self._is_narrow(node) or not self.narrow.isdisjoint(node.args):
                    self.narrow.add(node)

    def add(self, node: Node, weight: Node, choice: _Choice) -> None:
        if weight.is_zero:
            return
        if node in choice.partly and node not in self.places:
            _gather(self.chosen.setdefault(node, {}), choice, weight)
            return
        c, weight = (weight.value, weight.args[0]) if weight.op == "scale" else (1.0, weight)
        for condition, which in choice.taken:
            sides = (weight, self.graph.zero) if which else (self.graph.zero, weight)
            weight = self.graph.select(condition, *sides)
        _gather(self.adjoint, node, self.graph.scale(c, weight))  # so that what is opposite cancels

    def pass_on(self, node: Node, live: Container[Node]) -> None:
        """To the arguments of a node what its weights give them."""
        weights = [*self.chosen.pop(node, {}).items()]
        if node in self.adjoint:
            weights.append((ALWAYS, self.adjoint[node]))
        for choice, weight in weights:
            if weight.is_zero:
                continue
            for k, argument in enumerate(node.args):
                if argument in live:
                    self._share(choice, weight, node, k)

    def _share(self, choice: _Choice, weight: Node, node: Node, k: int) -> None:
        argument = node.args[k]
        if node.op == "add":
            self.add(argument, weight, choice)
            return
        if node.op == "select" and k and (partly := self._partly(argument, node.args[0])):
            taken = ((node.args[0], k == 1), *choice.taken)
            self.add(argument, weight, _Choice(taken, choice.partly | partly))
            return
        self.add(argument, self.graph.mul(weight, partial(self.graph, node, k)), choice)

    def _partly(self, branch: Node, condition: Node) -> frozenset[Node]:
        """The nodes of a branch at or above functions that are not everywhere and that its condition does
        not ask for as well."""
        asked = set(self._narrow_below(condition))
        found: set[Node] = set()
        for node in self._narrow_below(branch):
            if (self._is_narrow(node) and node not in asked) or not found.isdisjoint(node.args):
                found.add(node)
        return frozenset(found)

    def _narrow_below(self, top: Node) -> list[Node]:
        """`top` and what is below it of `narrow`, arguments before users."""
        found: dict[Node, None] = {}
        stack = [top] if top in self.narrow else []
        while stack:
            node = stack[-1]
            missing = [a for a in node.args if a in self.narrow and a not in found]
            if missing:
                stack += missing
                continue
            stack.pop()
            found[node] = None
        return list(found)

    def _is_narrow(self, node: Node) -> bool:
        """Whether it need have no value, or no slope, for all values of its arguments.  A parameter has one
        value in all branches; 0 it may be where a branch is not taken for that."""
        if node.op == "mul":
            return any(e < 0 and not self._is_given(base) for base, e in zip(node.args, node.value))
        return node.op in OPERATORS and OPERATORS[node.op].smoothness in (END, POLE)

    def _is_given(self, node: Node) -> bool:
        return node.op == "symbol" and node.value.kind == "parameter" and node not in self.deciding


def _gather(weights: dict[T, Node], key: T, weight: Node) -> None:
    held = weights.get(key)
    weights[key] = weight if held is None else weight.graph.add(held, weight)


def seeds(graph: Graph, pairs: Iterable[tuple[Node, Node]]) -> dict[Node, Node]:
    """Weights of a reverse sweep: a node that is met twice has the sum of its weights."""
    found: dict[Node, Node] = {}
    for node, weight in pairs:
        if not weight.is_zero:
            held = found.get(node)
            found[node] = weight if held is None else graph.add(held, weight)
    return found
