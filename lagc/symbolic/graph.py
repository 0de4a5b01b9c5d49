"""The expression graph: interned nodes and the smart constructors that make them.

Every node belongs to one `Graph`.  Equal expressions are the same object, so equality is identity and a
shared sub-expression is stored once.  A node is created after its arguments, so `index` order is topological
and every walk is a loop.

Normal form (kept by the constructors):

* `scale` c*x holds a numeric coefficient, never nested, never around a constant;
* `mul` is a monomial: distinct bases sorted by index with non-zero integer exponents;
  x^2 is `mul` with one base, a quotient is a negative exponent;
* a sum of numbers that is round-off is zero: 0.1 x + 0.2 x - 0.3 x;
* `add` is binary; like terms, and c*x*sin(u)^2 + c*x*cos(u)^2, are collected when they
  meet.  Long sums are not flattened, so that the prefix sums of a chain stay shared.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterable
from typing import Any, TypeAlias

from lagc.symbolic.leaves import Symbol, Table
from lagc.symbolic.operators import PARITY, TWINS, VALUES, exchanged

Number: TypeAlias = "float | int"

MOST_FACTORS = 16  # in one product; a longer one is a product of products
MOST_TURNED = 1e4  # rad, of constant angles
ULP = 2.0**-52
_ROUNDING = 2.0**-51  # relative to the terms: the round-off of decimal numbers that cancel


def _total(a: float, b: float) -> float:
    """Return a + b, or zero if the sum is round-off."""
    found = a + b
    return 0.0 if abs(found) <= _ROUNDING * abs(a) and math.isfinite(a) else found


class Node:
    """An interned expression: an operator `op`, its arguments `args` and a `value`.

    op        args            value
    const     ()              float
    symbol    ()              Symbol
    add       (a, b)          None
    scale     (x,)            float coefficient
    mul       (b1, ..., bk)   (e1, ..., ek) integer exponents
    piece ..  (x,)            Table         every operator with `looked_up`
    sin ...   (x, ...)        None          every other operator
    """

    __slots__ = ("args", "graph", "index", "op", "value")

    graph: Graph
    op: str
    args: tuple[Node, ...]
    value: Any  # by `op`, see above
    index: int

    def __add__(self, other: Node | Number) -> Node:
        return self.graph.add(self, self.graph.as_node(other))

    def __radd__(self, other: Number) -> Node:
        return self.graph.add(self.graph.as_node(other), self)

    def __sub__(self, other: Node | Number) -> Node:
        return self.graph.sub(self, self.graph.as_node(other))

    def __rsub__(self, other: Number) -> Node:
        return self.graph.sub(self.graph.as_node(other), self)

    def __mul__(self, other: Node | Number) -> Node:
        return self.graph.mul(self, self.graph.as_node(other))

    def __rmul__(self, other: Number) -> Node:
        return self.graph.mul(self.graph.as_node(other), self)

    def __truediv__(self, other: Node | Number) -> Node:
        return self.graph.div(self, self.graph.as_node(other))

    def __rtruediv__(self, other: Number) -> Node:
        return self.graph.div(self.graph.as_node(other), self)

    def __neg__(self) -> Node:
        return self.graph.scale(-1.0, self)

    def __pow__(self, other: Node | Number) -> Node:
        return self.graph.pow(self, self.graph.as_node(other))

    def __repr__(self) -> str:
        arguments = ", ".join(f"#{a.index}" for a in self.args)
        return f"#{self.index} {self.op}({arguments})" + ("" if self.value is None else f" {self.value}")

    @property
    def record(self) -> Symbol:
        found: Symbol = self.value
        return found

    @property
    def is_zero(self) -> bool:
        return self.op == "const" and self.value == 0.0

    @property
    def is_const(self) -> bool:
        return self.op == "const"


class Graph:
    """Creates and owns nodes.  It is not shared between threads."""

    def __init__(self) -> None:
        self._table: dict[tuple[object, ...], Node] = {}
        self.nodes: list[Node] = []
        self.zero = self.const(0.0)
        self.one = self.const(1.0)

    def _intern(self, op: str, args: tuple[Node, ...], value: object) -> Node:
        # Interning: equal (op, args, value) is one object, so that equality of expressions is identity.
        key = (op, args, value)
        node = self._table.get(key)
        if node is None:
            node = Node()
            node.graph = self
            node.op = op
            node.args = args
            node.value = value
            node.index = len(self.nodes)
            self.nodes.append(node)
            self._table[key] = node
        return node

    def const(self, value: Number) -> Node:
        """Return the constant `value`; -0.0 becomes 0.0."""
        return self._intern("const", (), float(value) + 0.0)

    def symbol(self, kind: str, owner: str = "", component: str = "", order: int = 0) -> Node:
        return self.leaf(Symbol(kind, owner, component, order))

    def leaf(self, symbol: Symbol) -> Node:
        return self._intern("symbol", (), symbol)

    def as_node(self, value: Node | Number) -> Node:
        return value if isinstance(value, Node) else self.const(value)

    def scale(self, c: float, x: Node) -> Node:
        op = x.op
        if op == "const":
            return self.const(c * x.value)
        # Nested factors are multiplied; a factor of 1 or 0 disappears.
        if op == "scale":
            c = c * x.value
            x = x.args[0]
        if c == 1.0:
            return x
        if c == 0.0:
            return self.zero
        return self._intern("scale", (x,), c)

    def add(self, a: Node, b: Node) -> Node:
        # Numbers are summed; zero disappears.
        if a.op == "const":
            if a.value == 0.0:
                return b
            if b.op == "const":
                return self.const(_total(a.value, b.value))
        elif b.op == "const" and b.value == 0.0:
            return a
        # Like terms meet, also those one level deep in either sum; longer sums keep the order in which they
        # were written.
        met = self._meet(a, b)
        if met is not None:
            return met
        if a.op == "add":  # one level deep, which simplifies the square of a rotating arm
            x, y = a.args
            met = self._meet(y, b)
            if met is not None:
                return self.add(x, met)
            met = self._meet(x, b)
            if met is not None:
                return self.add(met, y)
        if b.op == "add":
            x, y = b.args
            met = self._meet(a, x)
            if met is not None:
                return self.add(met, y)
            met = self._meet(a, y)
            if met is not None:
                return self.add(x, met)
        if a.index > b.index:
            a, b = b, a
        return self._intern("add", (a, b), None)

    def _meet(self, a: Node, b: Node) -> Node | None:
        """Return a + b if the terms are alike (or sin^2 and cos^2), else None."""
        # Equal terms up to their factors: the factors add.
        ca, xa = (a.value, a.args[0]) if a.op == "scale" else (1.0, a)
        cb, xb = (b.value, b.args[0]) if b.op == "scale" else (1.0, b)
        if xa is xb:
            return self.scale(_total(ca, cb), xa)
        if xa.op == "const" and xb.op == "const":
            return self.const(_total(ca * xa.value, cb * xb.value))
        # c x sin(u)^2 + c x cos(u)^2 = c x. Both must be products with one factor; `exchanged` proposes x
        # sin^2 -> x cos^2.
        if ca != cb or xa.op != "mul" or xb.op != "mul" or 2 not in xa.value:
            return None
        squares = exchanged(zip(xa.args, xa.value), lambda base, e: self.twin(base) if e == 2 else None)
        for powers, other in squares:
            rest = self.product(powers.items())
            if self.mul(rest, self.power(other, 2)) is xb:
                return self.scale(ca, rest)
        return None

    def sub(self, a: Node, b: Node) -> Node:
        return self.add(a, self.scale(-1.0, b))

    def sum(self, terms: Iterable[Node]) -> Node:
        total = self.zero
        for term in terms:
            total = self.add(total, term)
        return total

    def mul(self, a: Node, b: Node) -> Node:
        if a.op == "const":
            return self.scale(a.value, b)
        if b.op == "const":
            return self.scale(b.value, a)
        c = 1.0
        if a.op == "scale":
            c, a = a.value, a.args[0]
        if b.op == "scale":
            c, b = c * b.value, b.args[0]
        return self.scale(c, self._merge(a, b, 1))

    def div(self, a: Node, b: Node) -> Node:
        """Return a/b.  Raises ZeroDivisionError for the constant zero."""
        c = 1.0
        if b.op == "const":
            return self.scale(1.0 / b.value, a)
        if b.op == "scale":
            c, b = 1.0 / b.value, b.args[0]
        if a.op == "const":
            return self.scale(c * a.value, self._merge(self.one, b, -1))
        if a.op == "scale":
            c, a = c * a.value, a.args[0]
        return self.scale(c, self._merge(a, b, -1))

    def product(self, factors: Iterable[tuple[Node, int]]) -> Node:
        """Return the product of integer powers; 0^-1 is kept as it is."""
        c = 1.0
        powers: dict[Node, int] = {}
        for base, exponent in factors:
            if base.op in ("scale", "const"):
                # A power of a number is folded if it has a value; 0^-1 stays as written.
                folded = _fold(operator.pow, base.value, exponent)
                if folded is None:
                    powers[base] = powers.get(base, 0) + exponent
                    continue
                c *= folded
                if base.op == "const":
                    continue
                base = base.args[0]
            if base.op == "mul":
                for b, e in zip(base.args, base.value):
                    powers[b] = powers.get(b, 0) + e * exponent
            else:
                powers[base] = powers.get(base, 0) + exponent
        return self.scale(c, self._monomial(powers))

    def reduced(self, monomial: Node, k: int) -> Node:
        """Return the product `monomial` divided by its base k."""
        bases, exponents = monomial.args, monomial.value
        if exponents[k] != 1:
            return self.div(monomial, bases[k])
        if len(bases) == 2 and exponents[1 - k] == 1:
            return bases[1 - k]
        return self._intern("mul", bases[:k] + bases[k + 1 :], exponents[:k] + exponents[k + 1 :])

    def _merge(self, a: Node, b: Node, sign: int) -> Node:
        """Return a * b^sign; neither is a scale, and b is not a constant."""
        powers: dict[Node, int] = {}
        if a.op == "mul":
            powers.update(zip(a.args, a.value))
        elif a.op != "const":
            powers[a] = 1
        pairs = zip(b.args, b.value) if b.op == "mul" else ((b, 1),)
        for base, exponent in pairs:
            powers[base] = powers.get(base, 0) + sign * exponent
        return self._monomial(powers)

    def _monomial(self, powers: dict[Node, int]) -> Node:
        # Sorted by index: one monomial for each set of powers. Roots with other powers than 1 and -1 become
        # powers of their argument.
        items = []
        for b, e in powers.items():
            if e:
                if e != 1 and e != -1 and b.op == "sqrt":
                    return self._without_roots(powers)
                items.append((b.index, b, e))
        if len(items) > 1:
            items.sort()
            if len(items) > MOST_FACTORS:
                return self._nested(items)
        elif not items:
            return self.one
        elif items[0][2] == 1:
            return items[0][1]
        return self._intern("mul", tuple([b for _, b, _ in items]), tuple([e for _, _, e in items]))

    def _nested(self, items: list[tuple[int, Node, int]]) -> Node:
        """Return a product of products, so that its derivatives have fewer factors."""
        first, rest = items[:MOST_FACTORS], items[MOST_FACTORS:]
        inner = self._intern("mul", tuple([b for _, b, _ in first]), tuple([e for _, _, e in first]))
        return self._monomial({inner: 1, **{b: e for _, b, e in rest}})

    def _without_roots(self, powers: dict[Node, int]) -> Node:
        """Replace sqrt(u)^2 by u."""
        rest = self.one
        # sqrt(u)^e = u^(e // 2) sqrt(u)^(e % 2), rounded towards zero.
        for root in [b for b, e in powers.items() if b.op == "sqrt" and e not in (1, -1, 0)]:
            e = powers.pop(root)
            half = e // 2 if e > 0 else -(-e // 2)
            rest = self.mul(rest, self.power(root.args[0], half))
            if e - 2 * half:
                powers[root] = e - 2 * half
        return self.mul(self._monomial(powers), rest)

    def power(self, x: Node, n: int) -> Node:
        """Return x^n for an integer n.  Raises ZeroDivisionError for 0^n with n < 0."""
        if n == 1:
            return x
        if n == 0:
            return self.one
        if x.op == "const":
            return self.const(x.value**n)
        c = 1.0
        if x.op == "scale":
            c, x = x.value**n, x.args[0]
        pairs = zip(x.args, x.value) if x.op == "mul" else ((x, 1),)
        return self.scale(c, self._monomial({b: e * n for b, e in pairs}))

    def pow(self, x: Node, y: Node) -> Node:
        # Integer powers are products, 1/2 is a root; others stay `pow`.
        if y.op == "const":
            n = y.value
            if n == int(n) and abs(n) <= 64:
                return self.power(x, int(n))
            if n == 0.5:
                return self.unary("sqrt", x)
            if x.op == "const":
                folded = _fold(VALUES["pow"], x.value, n)
                if folded is not None:
                    return self.const(folded)
        return self._intern("pow", (x, y), None)

    def unary(self, op: str, x: Node) -> Node:
        # Constants are folded, unless they have no value; a sine at a quarter turn is exactly 0. f(-x) =
        # +-f(x) takes a sign outside.
        if x.op == "const":
            folded = _fold(VALUES[op], x.value)
            if folded is not None:
                return self.const(0.0 if op in TWINS and _at_quarter_turn(x.value, folded) else folded)
        elif x.op == "scale" and x.value < 0:
            parity = PARITY[op]
            if parity:
                return self.scale(float(parity), self.unary(op, -x))
        return self._intern(op, (x,), None)

    def sin(self, x: Node) -> Node:
        return self.unary("sin", x)

    def cos(self, x: Node) -> Node:
        return self.unary("cos", x)

    def sqrt(self, x: Node) -> Node:
        return self.unary("sqrt", x)

    def is_of_parameters(self, x: Node) -> bool:
        """Return whether all symbols below `x` are parameters."""
        seen, stack = {x}, [x]
        while stack:
            node = stack.pop()
            if node.op == "symbol" and node.value.kind != "parameter":
                return False
            new = [a for a in node.args if a not in seen]
            seen.update(new)
            stack += new
        return True

    def twin(self, x: Node) -> Node | None:
        """Return cos(u) for sin(u), sin(u) for cos(u), else None."""
        return self.unary(TWINS[x.op], x.args[0]) if x.op in TWINS else None

    def binary(self, op: str, x: Node, y: Node) -> Node:
        """Return atan2, min, max, pow, a comparison (lt, le, eq), `and` or `or`."""
        if op == "pow":
            return self.pow(x, y)
        if x.op == "const" and y.op == "const":
            folded = _fold(VALUES[op], x.value, y.value)
            if folded is not None:
                return self.const(folded)
        return self._intern(op, (x, y), None)

    def logical_not(self, x: Node) -> Node:
        if x.op == "const":
            return self.const(0.0 if x.value else 1.0)
        return self._intern("not", (x,), None)

    def select(self, condition: Node, x: Node, y: Node) -> Node:
        if condition.op == "const":
            return x if condition.value else y
        return x if x is y else self._intern("select", (condition, x, y), None)

    def looked_up(self, op: str, table: Table, x: Node) -> Node:
        """Return `piece` or `entry` of x in a table."""
        if op == "entry" and table.is_constant:
            return self.const(table[0])
        if x.op == "const":
            return self.const(VALUES[op](table, x.value))
        return self._intern(op, (x,), table)

    def rebuild(self, node: Node, args: tuple[Node, ...]) -> Node:
        """Return `node` with other arguments, simplified; a constant without a finite value is kept as
        written."""
        op = node.op
        if op in ("const", "symbol"):
            return node
        if op == "add":
            return self.add(*args)
        if op == "scale":
            return self.scale(node.value, args[0])
        if op == "mul":
            return self.product(zip(args, node.value))
        if op == "select":
            return self.select(*args)
        if op == "not":
            return self.logical_not(args[0])
        if node.value is not None:
            return self.looked_up(op, node.value, args[0])
        if len(args) == 1:
            return self.unary(op, args[0])
        try:
            return self.binary(op, *args)
        except (ZeroDivisionError, OverflowError):  # a power of two numbers
            return self._intern(op, args, None)


def _at_quarter_turn(angle: float, value: float) -> bool:
    """Return whether a sine or cosine of a constant is round-off, as cos(90 [deg])."""
    return abs(angle) < MOST_TURNED and abs(value) <= ULP * abs(angle)


def _fold(function: Callable[..., float], *values: float) -> float | None:
    try:
        result = float(function(*values))
    except (ValueError, OverflowError, ZeroDivisionError):
        return None
    return result if math.isfinite(result) else None
