"""Fewer operations by algebra: common factors out of sums, shared parts of products.

Only what keeps the value up to rounding and is certain to pay: nothing is distributed.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from heapq import heappop, heappush

from lagc.expr.graph import Graph, Node
from lagc.expr.walk import reachable
from lagc.optimize.lower import Product, split

Term = tuple[float, dict[Node, int]]  # coefficient, powers of the bases


def factored(graph: Graph, nodes: Sequence[Node]) -> list[Node]:
    """`nodes` with a*b + a*c written a*(b + c) where that saves a product.

    Sums are flattened through additions that have one user only.
    """
    below = reachable(nodes)
    users = _users(below, nodes)
    inner = {a for node in below if node.op == "add" for a in node.args if a.op == "add" and users[a] == 1}
    new: dict[Node, Node] = {}
    for node in below:
        if node in inner:
            continue
        if node.op == "add":
            new[node] = _sum(graph, node, inner, users, new)
        elif node.args:
            new[node] = graph.rebuild(node, tuple([new[a] for a in node.args]))
        else:
            new[node] = node
    return [new[node] for node in nodes]


def _users(below: Sequence[Node], roots: Sequence[Node]) -> dict[Node, int]:
    users = dict.fromkeys(below, 0)
    for node in below:
        for a in node.args:
            users[a] += 1
    for node in roots:
        users[node] += 1
    return users


def _sum(graph: Graph, root: Node, inner: set[Node], users: dict[Node, int], new: dict[Node, Node]) -> Node:
    """The addition `root` and those inside it, rewritten."""
    leaves: list[Node] = []
    stack = list(reversed(root.args))
    while stack:
        node = stack.pop()
        if node in inner:
            stack.extend(reversed(node.args))
        else:
            leaves.append(node)
    free: list[Term] = []  # terms that are not used elsewhere: their product can be taken apart
    rest: list[Node] = []
    for leaf in leaves:
        product = leaf.args[0] if leaf.op == "scale" else leaf
        if product.op == "mul" and users[product] == 1 and users[leaf] == 1:
            free.append(_term(new[leaf]))
        else:
            rest.append(new[leaf])
    total = graph.zero
    for node in rest:
        total = graph.add(total, node)
    return graph.add(total, _collect(graph, free))


def _term(node: Node) -> Term:
    c = 1.0
    if node.op == "scale":
        c, node = node.value, node.args[0]
    if node.op == "const":
        return c * node.value, {}
    if node.op == "mul":
        return c, dict(zip(node.args, node.value))
    return c, {node: 1}


def _collect(graph: Graph, terms: list[Term]) -> Node:
    """The sum of `terms`, the factor that most of them share taken out, again and again.

    The recursion is as deep as a monomial has factors.
    """
    total = graph.zero
    left = terms
    while True:
        key = _common(left)
        if key is None:
            break
        base, sign = key
        inside: list[Term] = []
        others: list[Term] = []
        for c, powers in left:
            if _holds(c, powers, key):
                inside.append(_without(c, powers, key))
            else:
                others.append((c, powers))
        left = others
        inner = _collect(graph, inside)
        if isinstance(base, float):
            total = graph.add(total, graph.scale(base, inner))
        else:
            total = graph.add(total, graph.mul(graph.power(base, sign), inner))
    for c, powers in left:
        product = graph.one
        for base, exponent in powers.items():
            product = graph.mul(product, graph.power(base, exponent))
        total = graph.add(total, graph.scale(c, product))
    return total


Key = tuple["Node | float", int]  # a base with the sign of its exponent; or a coefficient, 1


def _common(terms: list[Term]) -> Key | None:
    """The factor that the most terms share, where taking it out of them saves an operation."""
    counts: dict[Key, int] = {}
    for c, powers in terms:
        degree = sum([abs(e) for e in powers.values()]) + (abs(c) != 1.0)
        for base, exponent in powers.items():
            key: Key = (base, 1 if exponent > 0 else -1)
            counts[key] = counts.get(key, 0) + (degree > 1 or exponent < 0)
        if abs(c) != 1.0 and powers:
            counts[(abs(c), 1)] = counts.get((abs(c), 1), 0) + 1
    best: Key | None = None
    for key, count in counts.items():
        if count > 1 and (best is None or _rank(key, count) < _rank(best, counts[best])):
            best = key
    return best


def _rank(key: Key, count: int) -> tuple[int, int, float]:
    base, sign = key
    if isinstance(base, float):
        return (-count, 1, base)
    return (-count, 0, sign * base.index)


def _holds(c: float, powers: dict[Node, int], key: Key) -> bool:
    base, sign = key
    if isinstance(base, float):
        return abs(c) == base and bool(powers)
    return powers.get(base, 0) * sign > 0


def _without(c: float, powers: dict[Node, int], key: Key) -> Term:
    base, sign = key
    if isinstance(base, float):
        return c / base, powers
    less = powers[base] - sign
    return c, {b: less if b is base else e for b, e in powers.items() if b is not base or less}


def plan(nodes: Sequence[Node]) -> dict[Product, tuple[Product, Product]]:
    """Which two parts each product is made of, so that products share as much as can be.

    Greedy: the pair of factors that most products hold becomes a factor of its own, while any
    two products share one (M. Breuer, *Generation of optimal code for expressions via
    factorization*, CACM 12 (1969)).
    """
    products: dict[Product, list[int]] = {}
    atoms: list[Product] = []  # what each factor number stands for
    numbers: dict[Node, int] = {}
    for node in reachable(nodes):
        if node.op == "mul":
            for part in split(node):
                if part and part not in products:
                    products[part] = _numbered(part, atoms, numbers)
    rows = list(products.values())
    made: dict[Product, tuple[Product, Product]] = {}
    pairs = _Pairs(rows)
    while (pair := pairs.most_common()) is not None:
        i, j = pair
        whole = _joined(atoms[i], atoms[j])
        made[whole] = (atoms[i], atoms[j])
        atoms.append(whole)
        pairs.replace(pair, len(atoms) - 1)
    for product, row in products.items():
        whole = atoms[row[0]]
        for k in row[1:]:
            longer = _joined(whole, atoms[k])
            if longer not in made:
                made[longer] = (whole, atoms[k])
            whole = longer
        assert whole == product
    return made


def _numbered(product: Product, atoms: list[Product], numbers: dict[Node, int]) -> list[int]:
    row: list[int] = []
    for base, exponent in product:
        k = numbers.get(base)
        if k is None:
            k = numbers[base] = len(atoms)
            atoms.append(((base, 1),))
        row.extend([k] * exponent)
    return row


class _Pairs:
    """How often each pair of factors occurs in `rows`, kept up to date as rows change."""

    def __init__(self, rows: list[list[int]]) -> None:
        self.rows = rows
        self.counts: dict[tuple[int, int], int] = {}
        self.heap: list[tuple[int, tuple[int, int]]] = []  # counts, perhaps too large
        self.holders: dict[tuple[int, int], dict[int, None]] = {}  # rows, as an ordered set
        for number in range(len(rows)):
            self._add(number, 1)

    def most_common(self) -> tuple[int, int] | None:
        """The pair that most rows hold (or one row twice), at least two."""
        while self.heap:
            known, pair = self.heap[0]
            count = self.counts[pair]
            if -known == count:
                return pair
            heappop(self.heap)
            if 1 < count < -known:
                heappush(self.heap, (-count, pair))
        return None

    def replace(self, pair: tuple[int, int], by: int) -> None:
        i, j = pair
        for number in sorted(self.holders[pair]):
            row = self.rows[number]
            if i in row and (row.count(i) > 1 if i == j else j in row):
                self._add(number, -1, pair)
                while i in row and (row.count(i) > 1 if i == j else j in row):
                    row.remove(i)
                    row.remove(j)
                    row.append(by)
                self._add(number, 1, (*pair, by))

    def _add(self, number: int, sign: int, changing: Iterable[int] | None = None) -> None:
        """Count the pairs of a row, or those with the factors `changing` alone."""
        held: dict[int, int] = {}
        for k in self.rows[number]:
            held[k] = held.get(k, 0) + 1
        left = sorted(held)
        for i in left[:] if changing is None else sorted({k for k in changing if k in held}):
            left.remove(i)
            if held[i] > 1:
                self._count(number, (i, i), sign * (held[i] // 2))
            for j in left:
                self._count(number, (i, j) if i < j else (j, i), sign * min(held[i], held[j]))

    def _count(self, number: int, pair: tuple[int, int], change: int) -> None:
        count = self.counts[pair] = self.counts.get(pair, 0) + change
        self.holders.setdefault(pair, {})[number] = None
        if change > 0 and count > 1:
            heappush(self.heap, (-count, pair))


def _joined(a: Product, b: Product) -> Product:
    powers: dict[Node, int] = dict(a)
    for base, exponent in b:
        powers[base] = powers.get(base, 0) + exponent
    return tuple(sorted(powers.items(), key=_by_index))


def _by_index(item: tuple[Node, int]) -> int:
    return item[0].index
