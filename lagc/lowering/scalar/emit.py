"""Nodes of the expression graph become operations of a block.

A monomial becomes a product over a divisor. A `Plan` (see `common_factors`) decides which factors are
combined first, so that monomials share parts.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from lagc.lowering.scalar.value_numbering import Block
from lagc.symbolic.graph import Node
from lagc.symbolic.operators import PARITY
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
        """References to the values of `nodes`.  KeyError for a symbol that is not known."""
        known = self.known
        for node in reachable(nodes):
            if node not in known:
                known[node] = self._lower(node)
        return [known[node] for node in nodes]

    def _lower(self, node: Node) -> int:
        op, known, block = node.op, self.known, self.block
        if op == "mul":
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
        if not parity or operands[0] >= 0:
            return self.block.apply(op, *operands)
        found = self.block.apply(op, ~operands[0])
        return found if parity > 0 else ~found

    def _product(self, product: Product) -> int:
        found = self._products.get(product)
        if found is not None:
            return found
        stack = [product]
        while stack:
            top = stack[-1]
            if top in self._products:
                stack.pop()
                continue
            if len(top) == 1 and top[0][1] == 1:
                self._products[top] = self.known[top[0][0]]
                continue
            left, right = self.plan.get(top) or halves(top)
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
    """Whether it is one over a product."""
    return bool(product) and product[0][1] < 0 and max([exponent for _, exponent in product]) < 0


def inverse(product: Product) -> Product:
    return tuple([(base, -exponent) for base, exponent in product])


def split(product: Product) -> tuple[Product, Product]:
    """The factors above the line, and one over those below it."""
    over = tuple([(b, e) for b, e in product if e > 0])
    return (product, ()) if len(over) == len(product) else (over, tuple([x for x in product if x[1] < 0]))


def halves(product: Product) -> tuple[Product, Product]:
    """The two parts of a product that no plan speaks of: divided last; squares first, then left to right."""
    over, divisor = split(product)
    if divisor:
        return over, divisor
    if len(product) == 1:
        base, exponent = product[0]
        return ((base, exponent // 2),), ((base, exponent - exponent // 2),)
    return product[:-1], product[-1:]
