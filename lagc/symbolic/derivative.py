"""Derivatives on the graph: forward sweeps (`tangent`), reverse sweeps (`gradient`) and sparse Jacobians
(`slopes`).

A. Griewank, A. Walther, *Evaluating Derivatives*, SIAM 2008, chapter 3.  Only nodes that depend on the seeds
are visited.  Piecewise functions are differentiated branch by branch, and the derivative of a step is 0.  A
branch that is not taken may have no derivative.

Many expressions that share sums, such as the positions of points along a chain, have one derivative for each
pair of an expression and a leaf.  If that is far more than the number of nodes, `slopes` returns derivatives
with respect to leaves *and* shared sums, and the derivatives of each sum.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from functools import cached_property
from typing import TypeVar

from lagc.base.records import dataclass, replace
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.operators import END, OPERATORS, POLE
from lagc.symbolic.walk import depends, reachable, substitute, symbols, union, within

T = TypeVar("T")


def partials(graph: Graph, node: Node) -> tuple[Node, ...]:
    """Return d(node)/d(argument) for each argument."""
    op, args = node.op, node.args
    if op == "add":
        return (graph.one, graph.one)
    if op == "scale":
        return (graph.const(node.value),)
    if op == "mul":
        return tuple([partial(graph, node, k) for k in range(len(args))])
    return OPERATORS[op].slopes(graph, node, *args)


def partial(graph: Graph, node: Node, k: int) -> Node:
    """Return d(node)/d(argument k)."""
    if node.op == "mul":
        exponent = node.value[k]
        return graph.scale(float(exponent), graph.reduced(node, k))
    return partials(graph, node)[k]


def tangent(
    graph: Graph,
    outputs: Sequence[Node],
    seeds: Mapping[Node, Node],
    within: Sequence[Node] | None = None,
    norms: bool = False,
) -> list[Node]:
    """Return d(outputs) along the direction d(leaf) = seeds[leaf]; leaves without a seed are constant.
    `within`: the nodes below `outputs` that the leaves can change, arguments before users, if they are known
    already. `norms`: the derivative of a norm that is 0 is 0, as that of abs(0): norm(v)*v has this one."""
    # Forward accumulation: rates of the leaves, then of each node from those of its arguments. A node that is
    # not in `rates` does not move.
    order = reachable(outputs) if within is None else within
    leaves = order if within is None else seeds  # only those in `order`, if there are many seeds
    rates = {leaf: seeds[leaf] for leaf in leaves if leaf in seeds and not seeds[leaf].is_zero}
    zero = graph.zero
    for node in order:
        if node in rates or not node.args:
            continue
        moving = [k for k, a in enumerate(node.args) if a in rates]
        if not moving:
            continue
        total = zero
        # The derivative of a choice is the choice of the derivatives: a branch that is not taken may have
        # none.
        if node.op == "select":
            total, moving = graph.select(node.args[0], *[rates.get(a, zero) for a in node.args[1:]]), []
        for k in moving:
            rate = rates[node.args[k]]
            share = rate if node.op == "add" else graph.mul(partial(graph, node, k), rate)
            total = graph.add(total, share)
        # d sqrt(u) = du / (2 sqrt(u)) is 0/0 where a norm vanishes.
        if norms and node.op == "sqrt" and _is_square(node.args[0]):
            total = graph.select(graph.binary("eq", node, zero), zero, total)
        if total is not zero:
            rates[node] = total
    return [rates.get(node, zero) for node in outputs]


def _is_square(node: Node) -> bool:
    """Return whether a node is a sum of squares."""
    if node.op == "add":
        return all(map(_is_square, node.args))
    if node.op == "scale":
        return node.value > 0.0 and _is_square(node.args[0])
    return node.op == "mul" and all(exponent % 2 == 0 for exponent in node.value)


def gradient(
    graph: Graph,
    seeds: Mapping[Node, Node],
    wrt: Sequence[Node] | Mapping[Node, int],
    within: Sequence[Node] | None = None,
) -> dict[Node, Node]:
    """Return the non-zero sums over outputs of seeds[output] * d(output)/d(w), in the order of `wrt`. `wrt`
    may be a mapping from w to its position, if it is long and used often.  `within` is as in `tangent`."""
    places = wrt if isinstance(wrt, Mapping) else {w: k for k, w in enumerate(wrt)}
    # Only nodes above a leaf of `wrt` need an adjoint.
    live = set[Node]() if within is None else set(places)
    order: list[Node] = []
    for node in reachable(seeds) if within is None else within:
        if node in places or not live.isdisjoint(node.args):
            live.add(node)
            order.append(node)
    # Reverse accumulation: users before arguments, so that a node's adjoint is complete when it is passed on.
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
    """The branches that are taken, as (condition, which) from the inner to the outer. `partly` are the nodes
    above functions that may have no value or derivative if the branches are not taken."""

    taken: tuple[tuple[Node, bool], ...]
    partly: frozenset[Node]


ALWAYS = _Choice((), frozenset())


class _Sweep:
    """Adjoints of a reverse sweep. A node may have an unconditional adjoint and adjoints of choices.  An
    adjoint that passes a function with a limited domain is selected after that function, because 0 times a
    non-finite number is not 0."""

    def __init__(self, graph: Graph, places: Mapping[Node, int], order: Sequence[Node]):
        self.graph, self.places = graph, places
        self.adjoint: dict[Node, Node] = {}
        self.chosen: dict[Node, dict[_Choice, Node]] = {}
        # Functions with a limited domain matter only below choices: without `select` the sets stay empty.
        self.narrow: set[Node] = set()  # nodes at or above functions with a limited domain
        conditions = [node.args[0] for node in order if node.op == "select"]
        self.deciding = symbols(conditions)
        if conditions:
            for node in reachable(order):
                if self._is_narrow(node) or not self.narrow.isdisjoint(node.args):
                    self.narrow.add(node)

    def add(self, node: Node, weight: Node, choice: _Choice) -> None:
        if weight.is_zero:
            return
        # An adjoint that must not meet a function without value stays with its choice until it has passed it.
        if node in choice.partly and node not in self.places:
            _gather(self.chosen.setdefault(node, {}), choice, weight)
            return
        c, weight = (weight.value, weight.args[0]) if weight.op == "scale" else (1.0, weight)
        # The branches are applied from the inner to the outer one; a number goes outside of them.
        for condition, which in choice.taken:
            sides = (weight, self.graph.zero) if which else (self.graph.zero, weight)
            weight = self.graph.select(condition, *sides)
        _gather(self.adjoint, node, self.graph.scale(c, weight))  # so that opposite weights cancel

    def pass_on(self, node: Node, live: Container[Node]) -> None:
        """Add the contributions of a node to the adjoints of its arguments."""
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
        # Entering a branch: what in it may be undefined while the branch is not taken?
        if node.op == "select" and k and (partly := self._partly(argument, node.args[0])):
            taken = ((node.args[0], k == 1), *choice.taken)
            self.add(argument, weight, _Choice(taken, choice.partly | partly))
            return
        self.add(argument, self.graph.mul(weight, partial(self.graph, node, k)), choice)

    def _partly(self, branch: Node, condition: Node) -> frozenset[Node]:
        """Return the nodes of a branch at or above functions with a limited domain that its condition does
        not use."""
        # A function that the condition itself evaluates is defined on both sides.
        asked = set(self._narrow_below(condition))
        found: set[Node] = set()
        for node in self._narrow_below(branch):
            # From such functions upwards, up to the top of the branch.
            if (self._is_narrow(node) and node not in asked) or not found.isdisjoint(node.args):
                found.add(node)
        return frozenset(found)

    def _narrow_below(self, top: Node) -> list[Node]:
        """Return `top` and the nodes of `narrow` below it, arguments before users."""
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
        """Return whether the node may lack a value or a derivative for some arguments. A parameter is the
        same in all branches, and may only be 0 if that is why a branch is not taken."""
        if node.op == "mul":
            return any(e < 0 and not self._is_given(base) for base, e in zip(node.args, node.value))
        return node.op in OPERATORS and OPERATORS[node.op].smoothness in (END, POLE)

    def _is_given(self, node: Node) -> bool:
        return node.op == "symbol" and node.value.kind == "parameter" and node not in self.deciding


def _gather(weights: dict[T, Node], key: T, weight: Node) -> None:
    held = weights.get(key)
    weights[key] = weight if held is None else weight.graph.add(held, weight)


def seeds(graph: Graph, pairs: Iterable[tuple[Node, Node]]) -> dict[Node, Node]:
    """Return the seeds of a reverse sweep; the weights of a node that occurs twice are added."""
    found: dict[Node, Node] = {}
    for node, weight in pairs:
        if not weight.is_zero:
            held = found.get(node)
            found[node] = weight if held is None else graph.add(held, weight)
    return found


_WORTH = 2  # least ratio of derivatives without and with sums


@dataclass(frozen=True)
class Slopes:
    """The derivatives of expressions (`rows`) and of shared sums: column -> derivative, without zeros. The
    columns are the `leaves`, then the sums."""

    graph: Graph
    rows: list[dict[int, Node]]
    sums: list[dict[int, Node]]
    leaves: int

    @property
    def nodes(self) -> list[Node]:
        return [node for own in (*self.rows, *self.sums) for node in own.values()]

    @cached_property
    def columns(self) -> list[list[int]]:
        """Return the leaves that each expression depends on by structure."""
        if not self.sums:
            return [list(row) for row in self.rows]
        # Bits of leaves below each sum, from the first sum on: each contains sums before it only.
        known = [1 << k for k in range(self.leaves)]
        for own in self.sums:
            known.append(union(known[k] for k in own))
        return [_places(union(known[k] for k in row)) for row in self.rows]

    def entries(self, k: int) -> dict[int, Node]:
        """Return the derivatives of expression k with respect to leaves."""
        found = self.total([k])
        return {j: found.get(j, self.graph.zero) for j in self.columns[k]}

    def total(self, numbers: Sequence[int]) -> dict[int, Node]:
        """Return the derivatives of the sum of these expressions with respect to leaves."""
        found: dict[int, Node] = {}
        for k in numbers:
            for j, slope in self.rows[k].items():
                found[j] = found[j] + slope if j in found else slope
        # From the last sum to the first: each passes its weight on to leaves and earlier sums.
        for column in range(self.leaves + len(self.sums) - 1, self.leaves - 1, -1):
            if column in found:
                weight = found.pop(column)
                for j, slope in self.sums[column - self.leaves].items():
                    share = weight * slope
                    found[j] = found[j] + share if j in found else share
        return found

    def weighted(self, weights: Sequence[Mapping[int, Node]]) -> Slopes:
        """Return the derivatives of weighted sums of the expressions."""
        found: list[dict[int, Node]] = []
        for own in weights:
            row: dict[int, Node] = {}
            for k, weight in own.items():
                for j, slope in self.rows[k].items():
                    share = weight * slope
                    row[j] = row[j] + share if j in row else share
            found.append(row)
        return replace(self, rows=found)

    def mapped(self, values: Callable[[Sequence[Node]], Sequence[Node]]) -> Slopes:
        """Return a copy with all derivatives replaced by `values` of them."""
        new = iter(values(self.nodes))
        found = [{k: next(new) for k in own} for own in (*self.rows, *self.sums)]
        return replace(self, rows=found[: len(self.rows)], sums=found[len(self.rows) :])

    def placed(self, places: Mapping[int, int], size: int) -> Slopes:
        """Return a copy with the leaves in other columns of `size`; leaves that are not in `places` are left
        out."""
        new = {**places, **{self.leaves + k: size + k for k in range(len(self.sums))}}
        rows, sums = ([{new[k]: x for k, x in own.items() if k in new} for own in part]
                      for part in (self.rows, self.sums))  # fmt: skip
        return replace(self, rows=rows, sums=sums, leaves=size)


def slopes(
    graph: Graph, nodes: Sequence[Node], places: Mapping[Node, int], size: int, few: int = 0
) -> Slopes:
    """Return the derivatives of `nodes` with respect to the leaves in `places` (`size` columns). At most
    `few` derivatives are never expressed by shared sums."""
    # Derivatives through shared sums only if they are fewer by the factor _WORTH; else plain gradients.
    found = by_sums(graph, nodes, places, size, few)
    return found or Slopes(graph, _gradients(graph, nodes, places), [], size)


def by_sums(
    graph: Graph, nodes: Sequence[Node], places: Mapping[Node, int], size: int, few: int = 0
) -> Slopes | None:
    """Return the derivatives by shared sums, or None if that does not save many."""
    shared = _shared_sums(nodes, places, few)
    found = _through_sums(graph, nodes, places, size, shared) if shared else None
    if found is None or sum(map(len, found.columns)) <= _WORTH * len(found.nodes):
        return None  # some derivatives are 0
    return found


def _shared_sums(nodes: Sequence[Node], leaves: Mapping[Node, int], few: int) -> list[Node]:
    """Return the sums that are used more than once, if they save many derivatives."""
    order = reachable(nodes)
    users = Counter([*nodes, *(a for node in order for a in set(node.args))])
    # Derivatives are counted by bit sets. whole[x] has a bit for each leaf that x depends on, own[x] one
    # for each leaf or shared sum that it depends on directly.
    whole = {x: 1 << k for k, x in enumerate(leaves)}
    own, sums, next_bit = dict(whole), dict[Node, int](), len(whole)
    for node in order:
        if node in whole:
            continue
        bits = union(whole.get(a, 0) for a in node.args)
        if bits:
            whole[node], own[node] = bits, union(own.get(a, 0) for a in node.args)
            # A sum with several users becomes an unknown of its own: what it depends on is counted once,
            # in sums, and one bit stands for it in what uses it.
            if node.op == "add" and users[node] > 1 and own[node].bit_count() > 1:
                sums[node], own[node] = own[node], 1 << next_bit
                next_bit += 1
    # The derivatives without and with shared sums.
    plain = sum([whole.get(node, 0).bit_count() for node in nodes])
    fewer = sum([own.get(node, 0).bit_count() for node in nodes]) + sum(
        [b.bit_count() for b in sums.values()]
    )
    return list(sums) if plain > max(_WORTH * fewer, few) else []


def _through_sums(
    graph: Graph, nodes: Sequence[Node], places: Mapping[Node, int], size: int, shared: Sequence[Node]
) -> Slopes:
    """Return the derivatives with respect to leaves and the sums in `shared`; a symbol stands for each
    sum."""
    # Each shared sum becomes a symbol: the expressions above are short, and the sums themselves are
    # expressions of the sums before.
    symbols = {x: graph.symbol("sum", str(size + k)) for k, x in enumerate(shared)}
    found: dict[Node, Node] = dict(symbols)
    made: dict[Node, Node] = {}
    for node in reachable(nodes):
        args = tuple([found[a] for a in node.args])
        made[node] = graph.rebuild(node, args) if args else node
        found.setdefault(node, made[node])
    by = {**places, **{symbols[x]: size + k for k, x in enumerate(shared)}}
    own = _gradients(graph, [*(found[node] for node in nodes), *(made[x] for x in shared)], by)
    outlined = Slopes(graph, own[: len(nodes)], own[len(nodes) :], size)
    # In the derivatives the symbols are the sums again.
    back = {symbol: x for x, symbol in symbols.items()}
    return outlined.mapped(lambda slopes: substitute(graph, slopes, back))


def _gradients(graph: Graph, nodes: Sequence[Node], by: Mapping[Node, int]) -> list[dict[int, Node]]:
    # All gradients walk on the nodes that depend on leaves; `within` restricts each to those below its node.
    moving = depends(nodes, by)
    found = (gradient(graph, {node: graph.one}, by, within([node], moving)) for node in nodes)
    return [{by[x]: slope for x, slope in own.items()} for own in found]


def _places(bits: int) -> list[int]:
    return [k for k, digit in enumerate(reversed(f"{bits:b}")) if digit == "1"]
