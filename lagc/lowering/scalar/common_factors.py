"""Fewer operations by algebra: common factors of sums, shared parts of products.

Transformations keep the value up to round-off and always save operations; nothing is distributed.
"""

from collections.abc import Iterable, Sequence
from heapq import heapify, heappop, heappush, heapreplace
from math import isfinite

from lagc.lowering.scalar.expand import Product, inverse, is_divisor, split
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.walk import reachable

Term = tuple[float, dict[Node, int]]  # coefficient, powers of the bases
Partners = dict[Node, set[Node]]
_NONE: frozenset[Node] = frozenset()


def factored(graph: Graph, nodes: Sequence[Node]) -> list[Node]:
    """Return `nodes` with a*b + a*c written a*(b + c) where that saves a product. Sums are flattened through
    additions that have one user only."""
    # Sums with one user are opened into it; each sum is then rewritten as a whole, from the leaves of the
    # graph up.
    below = reachable(nodes)
    users = _users(below, nodes)
    inner = {a for node in below if node.op == "add" for a in node.args if a.op == "add" and users[a] == 1}
    partners = _partners(below, nodes, users)
    new: dict[Node, Node] = {}
    for node in below:
        if node in inner:
            continue
        if node.op == "add":
            new[node] = _sum(graph, node, inner, users, new, partners)
        else:
            args = tuple([new[a] for a in node.args])
            new[node] = node if args == node.args else graph.rebuild(node, args)
    return [new[node] for node in nodes]


def _users(below: Sequence[Node], roots: Sequence[Node]) -> dict[Node, int]:
    users = dict.fromkeys(below, 0)
    for node in below:
        for a in node.args:
            users[a] += 1
    for node in roots:
        users[node] += 1
    return users


def _partners(below: Sequence[Node], roots: Sequence[Node], users: dict[Node, int]) -> Partners:
    """Return for each node the nodes whose product with it is computed in any case."""
    asked = set(roots)
    found: Partners = {}
    for node in below:
        if node.op == "mul" and node.value == (1, 1) and (node in asked or users[node] > 1):
            a, b = node.args
            found.setdefault(a, set()).add(b)
            found.setdefault(b, set()).add(a)
    return found


def _sum(
    graph: Graph,
    root: Node,
    inner: set[Node],
    users: dict[Node, int],
    new: dict[Node, Node],
    partners: Partners,
) -> Node:
    """Return the sum `root`, with the sums inside it, after common factors are taken out."""
    # Terms of the sum, from left to right.
    leaves: list[Node] = []
    stack = list(reversed(root.args))
    while stack:
        node = stack.pop()
        if node in inner:
            stack.extend(reversed(node.args))
        else:
            leaves.append(node)
    # A product with other users exists anyway, so taking it apart would save nothing.
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
    return graph.add(total, _collect(graph, free, partners))


def _term(node: Node) -> Term:
    c = 1.0
    if node.op == "scale":
        c, node = node.value, node.args[0]
    if node.op == "const":
        return c * node.value, {}
    if node.op == "mul":
        return c, dict(zip(node.args, node.value))
    return c, {node: 1}


def _collect(graph: Graph, terms: list[Term], partners: Partners) -> Node:
    """Return the sum of `terms` with the most common factor taken out, recursively. The recursion is as deep
    as a monomial has factors."""
    # Horner's scheme in many variables: the factor that most terms share is taken out, and the same is done
    # inside (M. Ceberio, V. Kreinovich, Greedy algorithms for optimizing multivariate Horner schemes, SIGSAM
    # Bull. 38 (2004) 8-15).
    total = graph.zero
    shared = _Shared(terms, partners)
    while (key := shared.most_common()) is not None:
        base, sign = key
        inner = _collect(graph, [_without(c, powers, key) for c, powers in shared.take(key)], partners)
        if isinstance(base, float):
            total = graph.add(total, graph.scale(base, inner))
        else:
            total = graph.add(total, graph.mul(graph.power(base, sign), inner))
    for c, powers in shared.left.values():
        product = graph.one
        for base, exponent in powers.items():
            product = graph.mul(product, graph.power(base, exponent))
        total = graph.add(total, graph.scale(c, product))
    return total


Key = tuple["Node | float", int]  # a base with the sign of its exponent; or a coefficient, 1


class _Shared:
    """How many of the terms that are `left` would save an operation if a factor were taken out of them."""

    def __init__(self, terms: list[Term], partners: Partners) -> None:
        self.left = dict(enumerate(terms))
        # Each term counts for each of its factors; `saves` is whether taking it out of that term saves a
        # product.
        self.keys = [_keys(term, partners) for term in terms]
        self.counts: dict[Key, int] = {}
        self.holders: dict[Key, list[int]] = {}
        for number, keys in enumerate(self.keys):
            for key, saves in keys:
                self.counts[key] = self.counts.get(key, 0) + saves
                self.holders.setdefault(key, []).append(number)
        # Counts only fall: those in the heap may be too large.
        self.heap = [(_rank(key, count), key) for key, count in self.counts.items() if count > 1]
        heapify(self.heap)

    def most_common(self) -> Key | None:
        """Return the factor that most terms share if taking it out saves an operation; else None."""
        while self.heap:
            rank, key = self.heap[0]
            count = self.counts[key]
            if count == -rank[0]:
                return key
            if count > 1:
                heapreplace(self.heap, (_rank(key, count), key))
            else:
                heappop(self.heap)
        return None

    def take(self, key: Key) -> list[Term]:
        """Remove the terms with the factor `key` from those that are left, and return them."""
        numbers = [number for number in self.holders[key] if number in self.left]
        for number in numbers:
            for other, saves in self.keys[number]:
                self.counts[other] -= saves
        return [self.left.pop(number) for number in numbers]


def _keys(term: Term, partners: Partners) -> list[tuple[Key, bool]]:
    """Return the factors of a term, each with whether taking it out can save an operation."""
    # c x y z -> x (c y z) saves one product if the term has at least two; a pair of factors that exists
    # anyway as a product of another term does not count.
    c, powers = term
    scaled = abs(c) != 1.0 and isfinite(c)
    several = sum(map(abs, powers.values())) + scaled > 1
    found: list[tuple[Key, bool]] = []
    for base, exponent in powers.items():
        saves = exponent < 0 or (several and partners.get(base, _NONE).isdisjoint(powers))
        found.append(((base, 1 if exponent > 0 else -1), saves))
    if scaled and powers:
        found.append(((abs(c), 1), True))
    return found


def _rank(key: Key, count: int) -> tuple[int, int, float]:
    base, sign = key
    if isinstance(base, float):
        return (-count, 1, base)
    return (-count, 0, sign * base.index)


def _without(c: float, powers: dict[Node, int], key: Key) -> Term:
    # The factor leaves the term: its exponent falls by one in magnitude.
    base, sign = key
    if isinstance(base, float):
        return c / base, powers
    less = powers[base] - sign
    return c, {b: less if b is base else e for b, e in powers.items() if b is not base or less}


def plan(nodes: Sequence[Node]) -> dict[Product, tuple[Product, Product]]:
    """Return the two parts of each product, chosen so that products share as much as possible.

    Greedy: the pair of factors that most products contain becomes a factor, as long as two products share one
    (M. Breuer, *Generation of optimal code for expressions via factorization*, CACM 12 (1969)). A divisor is
    one more factor. Products have at most `MOST_FACTORS` factors, so the work is linear in their number."""
    # All products with their factors as numbers; a divisor is one more factor, and its product exists as
    # well.
    products: dict[Product, Row] = {}
    atoms: list[Product] = []  # what each factor number stands for
    numbers: dict[Node | Product, int] = {}
    for node in reachable(nodes):
        if node.op == "mul":
            product = tuple(zip(node.args, node.value))
            over, divisor = split(product)
            products[product] = _numbered(over, divisor, atoms, numbers)
            if divisor and (under := inverse(divisor)) not in products:
                products[under] = _numbered(under, (), atoms, numbers)
    made: dict[Product, tuple[Product, Product]] = {}
    # Pairs that most products share become factors of their own, until no pair is in two.
    pairs = _Pairs(list(products.values()))
    while (pair := pairs.most_common()) is not None:
        one, other = sorted([atoms[k] for k in pair], key=is_divisor)
        whole = _join(one, other)
        made[whole] = (one, other)
        atoms.append(whole)
        pairs.replace(pair, len(atoms) - 1)
    # Factors that are left are multiplied one by one, divisors last.
    for product, row in products.items():
        factors = sorted([atoms[k] for k, power in row.items() for _ in range(power)], key=is_divisor)
        whole, *others = factors
        for factor in others:
            longer = _join(whole, factor)
            if longer not in made:
                made[longer] = (whole, factor)
            whole = longer
        assert whole == product
    return made


Row = dict[int, int]  # the numbers of the factors of a product, with their exponents


def _numbered(
    product: Product, divisor: Product, atoms: list[Product], numbers: dict[Node | Product, int]
) -> Row:
    row: Row = {}

    def count(factor: Node | Product, atom: Product, exponent: int) -> None:
        k = numbers.get(factor)
        if k is None:
            k = numbers[factor] = len(atoms)
            atoms.append(atom)
        row[k] = exponent

    for base, exponent in product:
        count(base, ((base, 1),), exponent)
    if divisor:
        count(divisor, divisor, 1)
    return row


class _Pairs:
    """How often each pair of factors occurs in `rows`, kept up to date as rows change."""

    def __init__(self, rows: list[Row]) -> None:
        self.rows = rows
        self.counts: dict[tuple[int, int], int] = {}
        self.holders: dict[tuple[int, int], set[int]] = {}  # rows that hold a pair, or did
        self.new: list[tuple[int, int]] = []  # pairs that are counted, but not in the heap yet
        self.heap: list[tuple[int, tuple[int, int]]] = []  # counts, perhaps too large: they only fall
        for number, row in enumerate(rows):
            self._count(number, 1, row)

    # Counts in the heap may be too large, as replacing pairs only lowers them: the top is corrected until it
    # is true.
    def most_common(self) -> tuple[int, int] | None:
        """Return the pair that most rows contain, counted twice if one row has it twice; None below two."""
        for pair in self.new:
            if self.counts[pair] > 1:
                heappush(self.heap, (-self.counts[pair], pair))
        self.new.clear()
        while self.heap:
            known, pair = self.heap[0]
            count = self.counts[pair]
            if -known == count:
                return pair
            if count > 1:
                heapreplace(self.heap, (-count, pair))
            else:
                heappop(self.heap)
        return None

    def replace(self, pair: tuple[int, int], by: int) -> None:
        i, j = pair
        # As often as the row contains the pair: x^3 y^2 contains (x, y) twice.
        for number in sorted(self.holders[pair]):
            row = self.rows[number]
            times = row.get(i, 0) // 2 if i == j else min(row.get(i, 0), row.get(j, 0))
            if times:
                self._count(number, -1, pair)
                for k in pair:
                    row[k] -= times
                    if not row[k]:
                        del row[k]
                row[by] = times
                self._count(number, 1, (i, j, by))

    def _count(self, number: int, sign: int, changing: Iterable[int]) -> None:
        """Count the pairs of a row that hold any of `changing`, each once."""
        # Pairs that contain a factor: powers of it with itself by twos, and with each other factor by the
        # smaller power.
        left = dict(self.rows[number])
        for i in changing:
            power = left.pop(i, 0)
            if power > 1:
                self._change(number, (i, i), sign * (power // 2))
            if power:
                for j, other in left.items():
                    self._change(number, (i, j) if i < j else (j, i), sign * min(power, other))

    def _change(self, number: int, pair: tuple[int, int], change: int) -> None:
        count = self.counts.get(pair)
        if count is None:
            self.counts[pair] = change
            self.holders[pair] = {number}
            self.new.append(pair)
        else:
            self.counts[pair] = count + change
            if change > 0:
                self.holders[pair].add(number)


def _join(a: Product, b: Product) -> Product:
    powers: dict[Node, int] = dict(a)
    for base, exponent in b:
        powers[base] = powers.get(base, 0) + exponent
    return tuple(sorted(powers.items(), key=_by_index))


def _by_index(item: tuple[Node, int]) -> int:
    return item[0].index
