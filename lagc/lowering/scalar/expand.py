"""Nodes of the expression graph become operations of a block.

**Lowering.** A monomial becomes a product over a divisor. A `Plan` (see `common_factors`) decides which
factors are combined first, so that monomials share parts.

**Expansion** of products of sums takes place if the sums are components of rotated vectors. The velocities
and accelerations of rotating links are sums whose terms all have a sine or a cosine. After expansion, terms
of products cancel and sin^2 + cos^2 meet. Other sums, such as differences of lengths, stay: their expansion
would lose digits.
"""

from collections.abc import Collection, Mapping, Sequence
from math import inf

from lagc.lowering.scalar.value_numbering import Block
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.operators import PARITY, TRUTHS, TWINS, exchanged
from lagc.symbolic.walk import reachable

Product = tuple[tuple[Node, int], ...]  # bases by index, with exponents
Plan = Mapping[Product, tuple[Product, Product]]  # a product -> the two that it is made of


class Lowering:
    """Lowers nodes into one block; `known` maps symbols (or any node) to references."""

    def __init__(self, block: Block, known: Mapping[Node, int], plan: Plan | None = None) -> None:
        self.block = block
        self.known: dict[Node, int] = dict(known)
        self.plan: Plan = plan or {}
        self._products: dict[Product, int] = {(): block.one}

    def __call__(self, nodes: Sequence[Node]) -> list[int]:
        """Return references to the values of `nodes`. Raises KeyError for a symbol that is not known."""
        known = self.known
        for node in reachable(nodes):
            if node not in known:
                known[node] = self._lower(node)
        return [known[node] for node in nodes]

    def _lower(self, node: Node) -> int:
        op, known, block = node.op, self.known, self.block
        if op == "mul":
            # The most frequent product by far, without the detour over plans.
            if node.value == (1, 1):
                return block.mul(known[node.args[0]], known[node.args[1]])
            return self._product(tuple(zip(node.args, node.value)))
        if op == "add":
            a, b = node.args
            return block.add(known[a], known[b])
        if op == "scale":
            return block.mul(block.const(node.value), known[node.args[0]])
        if op == "const":
            return block.const(node.value)
        if op == "symbol":
            raise KeyError(node.value)
        if node.value is not None:
            return block.look_up(op, node.value, known[node.args[0]])
        return self._function(op, [known[a] for a in node.args])

    def _function(self, op: str, operands: list[int]) -> int:
        parity = PARITY[op]
        # References are numbers; the complement ~r stands for the value -r, so a sign costs nothing: f(-x) is
        # f(x) of an even function and -f(x) of an odd one.
        if not parity or operands[0] >= 0:
            return self.block.apply(op, *operands)
        found = self.block.apply(op, ~operands[0])
        return found if parity > 0 else ~found

    def _product(self, product: Product) -> int:
        found = self._products.get(product)
        if found is not None:
            return found
        # An explicit stack: a power such as x^1000000 or a product of thousands of factors is deeper than
        # Python's own.
        stack = [product]
        while stack:
            top = stack[-1]
            if top in self._products:
                stack.pop()
                continue
            if len(top) == 1 and top[0][1] == 1:
                self._products[top] = self.known[top[0][0]]
                continue
            # A plan shares subproducts among monomials (common subexpressions); without one, powers are
            # halved: x^n takes O(log n) multiplications (D. E. Knuth, *The Art of Computer Programming*, vol.
            # 2, section 4.6.3).
            left, right = self.plan.get(top) or halves(top)
            # Negative powers are collected into one denominator, as a division costs several multiplications.
            divides = is_divisor(right)
            parts = left, inverse(right) if divides else right
            missing = [part for part in parts if part not in self._products]
            if missing:
                stack.extend(missing)
                continue
            one, other = [self._products[part] for part in parts]
            self._products[top] = self.block.div(one, other) if divides else self.block.mul(one, other)
        return self._products[product]


def is_divisor(product: Product) -> bool:
    """Return whether a factor is one over a product."""
    return bool(product) and product[0][1] < 0 and max([exponent for _, exponent in product]) < 0


def inverse(product: Product) -> Product:
    return tuple([(base, -exponent) for base, exponent in product])


def split(product: Product) -> tuple[Product, Product]:
    """Return the factors of the numerator, and one over those of the denominator."""
    over = tuple([(b, e) for b, e in product if e > 0])
    return (product, ()) if len(over) == len(product) else (over, tuple([x for x in product if x[1] < 0]))


def halves(product: Product) -> tuple[Product, Product]:
    """Return the two parts of a product that no plan divides: division last; squares first, then from left to
    right."""
    over, divisor = split(product)
    if divisor:
        return over, divisor
    if len(product) == 1:
        base, exponent = product[0]
        return ((base, exponent // 2),), ((base, exponent - exponent // 2),)
    return product[:-1], product[-1:]


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
            # A node is constant if parameters and numbers are all it depends on: it can be computed once per
            # run.
            if node.op == "const" or node in constants or (node.args and self._fixed.issuperset(node.args)):
                self._fixed.add(node)
            # Neither a constant among the operands, nor a change below: the node stays the same object.
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
        # 2*m*l^2*v^2 becomes c*v^2 with the one coefficient c = 2*m*l^2.
        coefficient = graph.product([(b, e) for b, e in factors if b in self._fixed])
        rest = graph.product([(self._new[b], e) for b, e in factors if b not in self._fixed])
        return graph.mul(self._coefficient(coefficient), rest)

    def _scaled(self, c: float, node: Node) -> Node:
        """Return a number times a product: the number goes into the coefficient."""
        graph = self.graph
        # The factor that is constant takes the number in, and stays one coefficient.
        for base, exponent in zip(node.args, node.value) if node.op == "mul" else ():
            if exponent == 1 and (base in self.meaning or base in self._fixed):
                coefficient = graph.scale(c, self.meaning.get(base, base))
                return graph.mul(self._coefficient(coefficient), graph.div(node, base))
        return graph.scale(c, node)

    def _coefficient(self, node: Node) -> Node:
        """Return the symbol of a constant; a constant that needs no operation is returned itself."""
        if node.op in ("const", "symbol") or node.op in TRUTHS:
            return node
        # -c needs no coefficient besides c: references have signs.
        if node.op == "scale" and node.value < 0.0:
            return -self._coefficient(-node)
        symbol = self.graph.symbol("coefficient", str(node.index))
        self.meaning[symbol] = node
        return symbol


Monomial = tuple[tuple[Node, int], ...]  # bases by index, exponents not zero
Polynomial = dict[Monomial, float]

_MOST_TERMS = 48  # of one sum; beyond, products stay as they are


def expanded(graph: Graph, nodes: Sequence[Node]) -> list[Node]:
    """Return `nodes`, each multiplied out if that is sound and leaves fewer nodes."""
    forms: dict[Node, Polynomial] = {}
    for node in reachable(nodes):
        form = _form(node, forms)
        # Bottom-up. A sum with too many terms, or with coefficients out of range, counts as one unknown in
        # what contains it.
        forms[node] = form if len(form) <= _MOST_TERMS and _in_range(form) else {((node, 1),): 1.0}
    others = [_rebuilt(graph, _squares_met(forms[node])) for node in nodes]
    # Multiplying out may lose common factors: the smaller form wins, counted in nodes of the graph.
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
    """Return whether no product of numbers became infinite or 0."""
    return all(0.0 < abs(c) < inf for c in form.values())


def _product(node: Node, forms: Mapping[Node, Polynomial]) -> Polynomial:
    plain: list[tuple[Node, int]] = []
    total: Polynomial = {(): 1.0}
    for base, exponent in zip(node.args, node.value):
        form = forms[base]
        # Only sums with sines or cosines are multiplied out, for the sake of sin^2 + cos^2 = 1: other
        # products would grow for nothing, and cancel differently in floating point.
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
    # Exactly opposite terms vanish; a sum that only rounds to zero stays.
    if before and before == -c:
        del total[monomial]
    else:
        total[monomial] = before + c


def _squares_met(form: Polynomial) -> Polynomial:
    """Return a sum after c*x*sin(u)^2 + c*x*cos(u)^2 = c*x is applied as often as it occurs."""
    left = dict(form)
    pending = list(form)
    while pending:
        monomial = pending.pop()
        c = left.get(monomial)
        if c is None:
            continue
        # For each pair of factors sin(u)^2 the partner with cos(u)^2 is looked up; only equal coefficients
        # combine, so no rounding is involved. The shorter term may find a partner in turn.
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
