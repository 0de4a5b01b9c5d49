"""Derivatives on the graph: one forward sweep (`tangent`) or one reverse sweep (`gradient`).

A. Griewank, A. Walther, *Evaluating Derivatives*, SIAM 2008, chapter 3.  Only nodes that
depend on the seeds are visited; piecewise functions are differentiated branch by branch,
with the value 0 for the derivative of a step.  A branch that is not taken need have no slope.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from lagc.expr.graph import Graph, Node
from lagc.expr.operators import END, OPERATORS, POLE
from lagc.expr.walk import reachable


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
    adjoint: dict[Node, Node] = {}
    live = set[Node]() if within is None else set(places)
    order: list[Node] = []
    for node in reachable(seeds) if within is None else within:
        if node in places or not live.isdisjoint(node.args):
            live.add(node)
            order.append(node)
    for node, seed in seeds.items():
        if node in live and not seed.is_zero:
            adjoint[node] = seed
    for node in reversed(order):
        weight = adjoint.get(node)
        if weight is None or weight.is_zero:
            continue
        args = node.args
        for k, argument in enumerate(args):
            if argument in live:
                share = weight if node.op == "add" else _share(graph, weight, node, k)
                held = adjoint.get(argument)
                adjoint[argument] = share if held is None else graph.add(held, share)
    found = sorted([w for w in adjoint if w in places], key=places.__getitem__)
    return {w: adjoint[w] for w in found if not adjoint[w].is_zero}


def _share(graph: Graph, weight: Node, node: Node, k: int) -> Node:
    """What argument k has of the weight of `node`: 0 where a choice leaves none, whatever the slope is."""
    slope = partial(graph, node, k)
    within = node.value[k] > 0 if node.op == "mul" else node.op == "scale" or _is_everywhere(node.op)
    return graph.mul(weight, slope) if within else _chosen(graph, weight, slope)


def _is_everywhere(op: str) -> bool:
    return OPERATORS[op].smoothness not in (END, POLE)


def _chosen(graph: Graph, weight: Node, slope: Node) -> Node:
    if weight.op == "scale":
        return graph.scale(weight.value, _chosen(graph, weight.args[0], slope))
    factors = zip(weight.args, weight.value) if weight.op == "mul" else ((weight, 1),)
    for k, (factor, exponent) in enumerate(factors):
        if factor.op == "select" and exponent == 1 and graph.zero in factor.args[1:]:
            rest = graph.reduced(weight, k) if weight.op == "mul" else graph.one
            whole = graph.mul(rest, slope)
            return graph.select(factor.args[0], *[graph.mul(side, whole) for side in factor.args[1:]])
    return graph.mul(weight, slope)


def seeds(graph: Graph, pairs: Iterable[tuple[Node, Node]]) -> dict[Node, Node]:
    """Weights of a reverse sweep: a node that is met twice has the sum of its weights."""
    found: dict[Node, Node] = {}
    for node, weight in pairs:
        if not weight.is_zero:
            held = found.get(node)
            found[node] = weight if held is None else graph.add(held, weight)
    return found
