"""Expansion of products of sums, if the sums are components of rotated vectors.

The velocities and accelerations of rotating links are sums whose terms all have a sine or a cosine. After
expansion, terms of products cancel and sin^2 + cos^2 meet. Other sums, such as differences of lengths, stay:
their expansion would lose digits.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from math import inf

from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.operators import TRUTHS, TWINS, exchanged
from lagc.symbolic.walk import reachable


class Coefficients:
    """`nodes` with symbols as coefficients, and the `meaning` of each symbol. `constants` are the symbols of
    parameters."""

    def __init__(self, graph: Graph, nodes: Sequence[Node], constants: Collection[Node]) -> None:
        self.graph = graph
        self.meaning: dict[Node, Node] = {}
        self._fixed: set[Node] = set()
        self._new: dict[Node, Node] = {}
        changed: set[Node] = set()  # of those that move
        for node in reachable(nodes):
            if node.op == "const" or node in constants or (node.args and self._fixed.issuperset(node.args)):
                self._fixed.add(node)
            elif self._fixed.isdisjoint(node.args) and changed.isdisjoint(node.args):
                self._new[node] = node
            else:
                found = self._new[node] = self._moving(node)
                if found is not node:
                    changed.add(node)
        self.nodes = [self._used(node) for node in nodes]

    def _used(self, node: Node) -> Node:
        return self._coefficient(node) if node in self._fixed else self._new[node]

    def _moving(self, node: Node) -> Node:
        if node.op == "mul":
            return self._monomial(node)
        if node.op == "scale":
            return self._scaled(node.value, self._new[node.args[0]])
        return self.graph.rebuild(node, tuple([self._used(a) for a in node.args]))

    def _monomial(self, node: Node) -> Node:
        graph, factors = self.graph, list(zip(node.args, node.value))
        coefficient = graph.product([(b, e) for b, e in factors if b in self._fixed])
        rest = graph.product([(self._new[b], e) for b, e in factors if b not in self._fixed])
        return graph.mul(self._coefficient(coefficient), rest)

    def _scaled(self, c: float, node: Node) -> Node:
        """A number times a product: it goes into the coefficient."""
        graph = self.graph
        for base, exponent in zip(node.args, node.value) if node.op == "mul" else ():
            if exponent == 1 and (base in self.meaning or base in self._fixed):
                coefficient = graph.scale(c, self.meaning.get(base, base))
                return graph.mul(self._coefficient(coefficient), graph.div(node, base))
        return graph.scale(c, node)

    def _coefficient(self, node: Node) -> Node:
        """The symbol of a constant; of what needs no operation, that itself."""
        if node.op in ("const", "symbol") or node.op in TRUTHS:
            return node
        if node.op == "scale" and node.value < 0.0:
            return -self._coefficient(-node)
        symbol = self.graph.symbol("coefficient", str(node.index))
        self.meaning[symbol] = node
        return symbol


Monomial = tuple[tuple[Node, int], ...]  # bases by index, exponents not zero
Polynomial = dict[Monomial, float]

_MOST_TERMS = 48  # of one sum; beyond, products stay as they are


def expanded(graph: Graph, nodes: Sequence[Node]) -> list[Node]:
    """`nodes`, each multiplied out where that is sound and leaves fewer nodes."""
    forms: dict[Node, Polynomial] = {}
    for node in reachable(nodes):
        form = _form(node, forms)
        forms[node] = form if len(form) <= _MOST_TERMS and _in_range(form) else {((node, 1),): 1.0}
    others = [_rebuilt(graph, _squares_met(forms[node])) for node in nodes]
    return [_smaller(node, other) for node, other in zip(nodes, others)]


def _smaller(node: Node, other: Node) -> Node:
    if node is other:
        return node
    return other if len(reachable([other])) < len(reachable([node])) else node


def _form(node: Node, forms: Mapping[Node, Polynomial]) -> Polynomial:
    if node.op == "const":
        return {(): node.value} if node.value else {}
    if node.op == "add":
        total = dict(forms[node.args[0]])
        for monomial, c in forms[node.args[1]].items():
            _count(total, monomial, c)
        return total
    if node.op == "scale":
        return {monomial: node.value * c for monomial, c in forms[node.args[0]].items()}
    if node.op == "mul":
        return _product(node, forms)
    return {((node, 1),): 1.0}


def _in_range(form: Polynomial) -> bool:
    """Whether no product of numbers became infinite or 0."""
    return all(0.0 < abs(c) < inf for c in form.values())


def _product(node: Node, forms: Mapping[Node, Polynomial]) -> Polynomial:
    plain: list[tuple[Node, int]] = []
    total: Polynomial = {(): 1.0}
    for base, exponent in zip(node.args, node.value):
        form = forms[base]
        if not (1 <= exponent <= 2 and len(form) > 1 and all(_turned(m) for m in form)):
            plain.append((base, exponent))
            continue
        for _ in range(exponent):
            if len(total) * len(form) > 2 * _MOST_TERMS:
                return {((node, 1),): 1.0}
            total = _times(total, form)
    return _times(total, {tuple(plain): 1.0})


def _turned(monomial: Monomial) -> bool:
    return any(base.op in TWINS and exponent > 0 for base, exponent in monomial)


def _times(a: Polynomial, b: Polynomial) -> Polynomial:
    total: Polynomial = {}
    for left, c in a.items():
        for right, d in b.items():
            powers = dict(left)
            for base, exponent in right:
                powers[base] = powers.get(base, 0) + exponent
            _count(total, _monomial(powers), c * d)
    return total


def _monomial(powers: Mapping[Node, int]) -> Monomial:
    return tuple(sorted([x for x in powers.items() if x[1]], key=_by_index))


def _count(total: Polynomial, monomial: Monomial, c: float) -> None:
    before = total.get(monomial, 0.0)
    if before and before == -c:
        del total[monomial]
    else:
        total[monomial] = before + c


def _squares_met(form: Polynomial) -> Polynomial:
    """c*x*sin(u)^2 + c*x*cos(u)^2 = c*x, as often as it occurs."""
    left = dict(form)
    pending = list(form)
    while pending:
        monomial = pending.pop()
        c = left.get(monomial)
        if c is None:
            continue
        for rest, other in exchanged(monomial, _twin):
            short, twin = _monomial(rest), _monomial({**rest, other: rest.get(other, 0) + 2})
            if left.get(twin) == c:
                del left[monomial], left[twin]
                _count(left, short, c)
                pending.append(short)
                break
    return left


def _twin(base: Node, exponent: int) -> Node | None:
    return base.graph.twin(base) if exponent >= 2 else None


def _rebuilt(graph: Graph, form: Polynomial) -> Node:
    total = graph.zero
    for monomial, c in form.items():
        product = graph.one
        for base, exponent in monomial:
            product = graph.mul(product, graph.power(base, exponent))
        total = graph.add(total, graph.scale(c, product))
    return total


def _by_index(item: tuple[Node, int]) -> int:
    return item[0].index
