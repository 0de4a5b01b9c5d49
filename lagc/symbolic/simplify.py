"""Simplification of squares: angles by which a vector is rotated drop out of its length.

The square is expanded, within a limit, and cos(u)^2 is replaced by 1 - sin(u)^2 for one angle u after the
other.  In this normal form an angle without influence does not occur.  If an angle remains, the square is
kept as written.
"""

from collections.abc import Iterable
from math import comb

from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.operators import TWINS

MOST = 2000  # limit on nodes, terms and products
NESTED = 10  # share of this limit for a sum inside of a product
TURNS = 6  # angles in one square

Monomial = tuple[tuple[Node, int], ...]  # bases and exponents, in the order of the graph
Terms = dict[Monomial, tuple[float, float]]  # coefficient, and the sum of the absolute values of its parts
ROUNDING = 2.0**-48  # relative to that sum: numbers that cancel up to round-off


class _TooMuch(Exception):
    """The limit is exceeded."""


class _Work:
    left = MOST

    def spend(self, amount: int = 1) -> None:
        self.left -= amount
        if self.left < 0:
            raise _TooMuch


def without_turns(square: Node) -> Node:
    """Return `square` without the angles that have no influence on it."""
    work, found = _Work(), square
    # Limits on nodes, terms and products: beyond them the square stays as it was.
    try:
        angles = _angles(square, work)
        if not 0 < len(angles) <= TURNS:
            return square
        terms, left = _expand(square, work), -1
        # One angle after the other: if neither sine nor cosine of it remains, the shorter form is kept.
        # Others may drop out then, so the loop begins again.
        while left != len(angles):  # the outermost rotation drops out first
            left, others = len(angles), []
            for sine, cosine in angles:
                turned = _without_cancelled(_in_sines(terms, sine, cosine, work))
                if any(base is sine or base is cosine for term in turned for base, _ in term):
                    others.append((sine, cosine))
                else:
                    terms, found = turned, _written(square.graph, turned)
            angles = others
    except _TooMuch:
        pass
    return found


def _angles(square: Node, work: _Work) -> list[tuple[Node, Node]]:
    """Return the pairs of sines and cosines that occur as factors, or none if there are too many."""
    seen, layer = {square}, [square]
    sines, cosines = dict[Node, Node](), dict[Node, Node]()
    while layer:  # breadth first, to find the outer angles if there are many
        work.spend(len(layer))
        below: list[Node] = []
        for node in layer:
            if node.op in ("add", "scale", "mul"):
                new = [a for a in node.args if a not in seen]
                seen.update(new)
                below += new
            elif node.op in TWINS:
                (sines if node.op == "sin" else cosines)[node.args[0]] = node
        if len(sines) > TURNS:
            return []
        layer = below
    shared = sorted(sines.keys() & cosines.keys(), key=lambda u: u.index)
    return [(sines[u], cosines[u]) for u in shared]


def _expand(node: Node, work: _Work) -> Terms:
    terms: Terms = {}
    # Without recursion except for sums inside products. Terms are monomials with the coefficient and the sum
    # of magnitudes, which tells cancellation from smallness.
    stack = [(node, 1.0)]
    while stack:
        work.spend()
        part, c = stack.pop()
        if part.op == "add":
            stack += [(a, c) for a in part.args]
        elif part.op == "scale":
            stack.append((part.args[0], c * part.value))
        elif part.op == "const":
            _collect(terms, (), c * part.value, abs(c * part.value))
        elif part.op == "mul":
            product: Terms = {(): (c, abs(c))}
            for base, exponent in zip(part.args, part.value):
                factor: Terms = {((base, exponent),): (1.0, 1.0)}
                times = 1
                if base.op == "add" and exponent > 0:
                    work.spend(NESTED)
                    factor, times = _expand(base, work), exponent
                for _ in range(times):
                    product = _product(product, factor, work)
            for term, (value, size) in product.items():
                _collect(terms, term, value, size)
        else:
            _collect(terms, ((part, 1),), c, abs(c))
    return terms


def _product(a: Terms, b: Terms, work: _Work) -> Terms:
    found: Terms = {}
    for s, (c, size) in a.items():
        for t, (d, other) in b.items():
            work.spend()
            _collect(found, _monomial((*s, *t)), c * d, size * other)
    return found


def _in_sines(terms: Terms, sine: Node, cosine: Node, work: _Work) -> Terms:
    """Return `terms` with powers of the cosine below 2."""
    found: Terms = {}
    for term, (c, size) in terms.items():
        work.spend()
        # cos^2n = (1 - sin^2)^n, by the binomial theorem.
        n = max((e for base, e in term if base is cosine), default=0) // 2
        for k in range(n + 1):
            other = _monomial((*term, (cosine, -2 * n), (sine, 2 * k))) if n else term
            _collect(found, other, c * comb(n, k) * (-1.0) ** k, size * comb(n, k))
    return found


def _monomial(factors: Iterable[tuple[Node, int]]) -> Monomial:
    powers: dict[Node, int] = {}
    for base, exponent in factors:
        powers[base] = powers.get(base, 0) + exponent
    return tuple(sorted(((b, e) for b, e in powers.items() if e), key=lambda p: p[0].index))


def _collect(terms: Terms, term: Monomial, c: float, size: float) -> None:
    before, others = terms.get(term, (0.0, 0.0))
    terms[term] = before + c, others + size


def _without_cancelled(terms: Terms) -> Terms:
    """Return the terms that do not cancel up to round-off."""
    return {term: (c, size) for term, (c, size) in terms.items() if abs(c) > ROUNDING * size}


def _written(graph: Graph, terms: Terms) -> Node:
    return graph.sum(c * graph.product(term) for term, (c, _) in terms.items())
