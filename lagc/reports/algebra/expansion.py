"""Expansion into sums of monomials with exact coefficients, for printed equations.

A polynomial is a dict {monomial: coefficient}, a monomial a sorted tuple of (atom, exponent) pairs, an atom a
number in `Algebra.atoms`: a symbol, a function of polynomials, or a sum in a denominator or under a root.
Exponents are integers, or halves for roots. Beyond `limit` products `TooLarge` is raised, and the caller
writes the expression in another way.
"""

from collections import ChainMap
from collections.abc import Iterable, Sequence
from fractions import Fraction
from math import comb, factorial, inf, isqrt
from typing import Any, TypeAlias

from lagc.base.records import dataclass
from lagc.reports.algebra.polynomials import (
    Exponent,
    Frozen,
    Monomial,
    Polynomial,
    accumulate,
    constant,
    divided,
    fraction,
    frozen,
    number_content,
    scaled,
    settled,
)  # fmt: skip
from lagc.symbolic.finite_field import turns_of
from lagc.symbolic.graph import Node
from lagc.symbolic.operators import OPERATORS
from lagc.symbolic.walk import missing, within

Parts: TypeAlias = list[tuple[Node, Polynomial]]  # of a sum, each with its factor

HALF = Fraction(1, 2)
HIGHEST = 8  # power of a sum that is multiplied out
TABLE = "table "  # before the name of one, where an operator stands
LONG = 12  # terms of what is named


class TooLarge(Exception):
    """The expression has too many terms to be multiplied out."""


@dataclass(frozen=True, slots=True)
class Atom:
    """`op` "symbol" with its `node`, "sum" with one argument, or a function of `args`."""

    op: str
    node: Node | None
    args: tuple[Frozen, ...]
    nonnegative: bool


class Algebra:
    """Makes polynomials of nodes.  `nonnegative`: the symbols known not to be negative."""

    def __init__(self, nonnegative: Iterable[Node] = (), limit: int = 60_000) -> None:
        self.atoms: list[Atom] = []
        self.pi: Node | None = None  # what its multiples are written with
        self.named: dict[int, Node] = {}  # sums, by atom, that are written as symbols
        self.orientations: dict[int, int] = {}  # which one an atom is a part of
        self.twins: dict[int, int] = {}  # the atom of sin u for that of cos u, and the reverse
        self._numbers: dict[tuple[object, ...], int] = {}
        self._nonnegative = set(nonnegative)
        self._done: dict[Node, Polynomial] = {}
        self._sums: dict[Node, Parts] = {}  # long ones, which are not multiplied out until they are asked for
        self.limit: float = limit
        self.spent = 0  # products

    # -- from nodes -----------------------------------------------------------

    def polynomials(self, nodes: Sequence[Node]) -> list[Polynomial]:
        known: ChainMap[Node, Any] = ChainMap(self._done, self._sums)
        for node in missing(nodes, known):
            parts = self._parts(node)
            if parts:
                self._sums[node] = parts
            else:
                self._multiply_out(node.args)
                self._done[node] = self._convert(node)
        self._multiply_out(nodes)
        return [settled(self._done[node]) for node in nodes]

    def _parts(self, node: Node) -> Parts:
        """Return the parts of a sum that would be long; of anything else none."""
        if node.op == "add":
            lengths = [LONG if a in self._sums else len(self._done[a]) for a in node.args]
            return [(a, constant(Fraction(1))) for a in node.args] if sum(lengths) > LONG else []
        long = [(a, k) for k, a in enumerate(node.args) if a in self._sums]
        if len(long) != 1:
            return []
        ((part, at),) = long
        if node.op == "scale":
            return [(part, self._times(node.value, constant(Fraction(1))))]
        if node.op != "mul" or node.value[at] != 1:
            return []
        factors = [(self._done[a], e) for k, (a, e) in enumerate(zip(node.args, node.value)) if k != at]
        return [(part, self._product(factors))]

    def _multiply_out(self, nodes: Iterable[Node]) -> None:
        """Multiply out long sums from the top. A part of many sums, as along a chain, is multiplied once by
        the factors of all."""
        for top in nodes:
            if top not in self._sums:
                continue
            total: Polynomial = {}
            # As in a reverse sweep: the factor of each node is complete when it is reached, because all
            # that use it were before it. A product of depth n takes n multiplications then, not 2^n.
            factors: dict[Node, Polynomial] = {top: constant(Fraction(1))}
            for node in reversed(within([top], self._sums)):
                factor = factors.pop(node)
                for part, own in self._sums[node]:
                    product = self.multiply(factor, own)
                    if part in self._done:
                        into, product = total, self.multiply(product, self._done[part])
                    else:
                        into = factors.setdefault(part, {})
                    for m, c in product.items():
                        accumulate(into, m, c)
            self._done[top] = total
            del self._sums[top]

    def _convert(self, node: Node) -> Polynomial:
        op, args = node.op, [self._done[a] for a in node.args]
        if op == "const":
            return self._times(node.value, constant(Fraction(1)))
        if op == "symbol":
            return self.symbol_only(node)
        if op == "add":
            return self.add(args[0], args[1])
        if op == "scale":
            return self._times(node.value, args[0])
        if op == "mul":
            return self._product(zip(args, node.value))
        if op == "sqrt":
            return self.root(args[0])
        if op == "entry":
            return self._entry(node)
        if op == "pow":
            return self._pow(*args)
        return self.function(op, *args)

    def _times(self, number: float, p: Polynomial) -> Polynomial:
        turns = turns_of(number) if self.pi is not None else None
        if self.pi is None or turns is None:
            return scaled(p, fraction(number))
        return self.multiply(scaled(self.symbol_only(self.pi), turns), p)

    def _product(self, factors: Iterable[tuple[Polynomial, int]]) -> Polynomial:
        product = constant(Fraction(1))
        for base, exponent in factors:
            product = self.multiply(product, self.power(base, exponent))
        return product

    def _entry(self, node: Node) -> Polynomial:
        """Return a coefficient of a table in terms of the table and its slopes (Taylor's formula), which are
        printed."""
        table, piece = node.value, node.args[0]
        x = self._done[piece.args[0]]
        if table.curve is None:
            return self._looked_up(table.name, x)
        rows = list(table.curve.rows)
        while rows[-1].is_constant and not rows[-1][0]:
            rows.pop()
        # With the knot k of the piece the rows are f^(j)(k)/j!; f and its slopes at x give them back:
        # f^(m)(k)/m! = sum of (k - x)^(j - m) f^(j)(x) binomial(j, m)/j!.
        back = self.add(self._looked_up(piece.value.name, x), scaled(x, Fraction(-1)))
        total: Polynomial = {}
        for row in reversed(rows[table.order :]):  # Horner's scheme
            k = row.order
            known = constant(fraction(row[0])) if row is rows[-1] and row.is_constant else None
            slope = known or self._looked_up(table.curve.name + "'" * k, x)
            weight = Fraction(comb(k, table.order), 1 if known else factorial(k))
            total = self.add(self.multiply(total, back), scaled(slope, weight))
        return total

    def _looked_up(self, name: str, x: Polynomial) -> Polynomial:
        """Return the value at x of the table of that name."""
        return self.single(self._atom(Atom(TABLE + name, None, (frozen(x),), False)))

    def symbol(self, node: Node) -> int:
        return self._atom(Atom("symbol", node, (), node in self._nonnegative))

    def symbol_only(self, node: Node) -> Polynomial:
        return self.single(self.symbol(node))

    def _atom(self, atom: Atom) -> int:
        key = (atom.op, atom.node, atom.args)
        number = self._numbers.get(key)
        if number is None:
            number = self._numbers[key] = len(self.atoms)
            self.atoms.append(atom)
        return number

    @staticmethod
    def single(atom: int, exponent: Exponent = 1) -> Polynomial:
        return {((atom, exponent),): Fraction(1)}

    # -- arithmetic -----------------------------------------------------------

    def add(self, p: Polynomial, q: Polynomial) -> Polynomial:
        self._spend(len(q))
        total = dict(p)
        for monomial, c in q.items():
            accumulate(total, monomial, c)
        return total

    def multiply(self, p: Polynomial, q: Polynomial) -> Polynomial:
        self._spend(len(p) * len(q))
        total: Polynomial = {}
        for m1, c1 in p.items():
            for m2, c2 in q.items():
                monomial, sums = self._merge(m1, m2)
                if not sums:
                    accumulate(total, monomial, c1 * c2)
                    continue
                part: Polynomial = {monomial: c1 * c2}
                for base, exponent in sums:
                    part = self.multiply(part, self.power(base, exponent))
                for m, c in part.items():
                    accumulate(total, m, c)
        return total

    def _merge(self, m1: Monomial, m2: Monomial) -> tuple[Monomial, list[tuple[Polynomial, int]]]:
        """m1*m2, and the sums that it multiplies: a root squared is a sum again, |x|^2 is x^2."""
        if not m1 or not m2:
            return m1 or m2, []
        powers = dict(m1)
        for atom, e in m2:
            powers[atom] = powers.get(atom, 0) + e
        sums: list[tuple[Polynomial, int]] = []
        for atom, _ in m2:
            e = powers[atom]
            op = self.atoms[atom].op
            if op == "sum" and e >= 1:
                whole = int(e)
                powers[atom] = e - whole
                sums.append((dict(self.atoms[atom].args[0]), whole))
            elif op == "abs" and e.denominator == 1 and (e >= 2 or e <= -2):
                even = int(e) // 2 * 2 if e > 0 else -(-int(e) // 2 * 2)
                powers[atom] = e - even
                sums.append((dict(self.atoms[atom].args[0]), even))
        return tuple(sorted([(a, e) for a, e in powers.items() if e])), sums

    def power(self, p: Polynomial, n: int) -> Polynomial:
        """p^n; ZeroDivisionError for 0^-1."""
        if n < 0:
            return self._inverse_power(p, n)
        if len(p) > 1 and n > HIGHEST:
            raise TooLarge
        product = constant(Fraction(1))
        for _ in range(n):
            product = self.multiply(product, p)
        return product

    def _inverse_power(self, p: Polynomial, n: int) -> Polynomial:
        c, common, rest = self.content(p)
        outside: Polynomial = {tuple([(a, e * n) for a, e in common]): c**n}
        if rest == {(): 1}:
            return self.multiply(constant(Fraction(1)), outside)
        return self.multiply(outside, self.single(self._sum(rest), n))

    def _sum(self, p: Polynomial) -> int:
        self._spend(len(p))
        nonnegative = all(self._is_nonnegative(m, c) for m, c in p.items())
        return self._atom(Atom("sum", None, (frozen(p),), nonnegative))

    def _is_nonnegative(self, monomial: Monomial, c: Fraction) -> bool:
        return c >= 0 and all(e % 2 == 0 or self.atoms[a].nonnegative for a, e in monomial)

    def content(self, p: Polynomial) -> tuple[Fraction, Monomial, Polynomial]:
        """Return (c, common, rest) with p = c*common*rest: the greatest common factor; c has the sign of the
        first square, or else of the first term."""
        if not p:
            return Fraction(0), (), {(): Fraction(1)}
        monomials = sorted(p)
        common = dict(monomials[0])
        for monomial in monomials[1:]:
            here = dict(monomial)
            common = {a: min(e, here[a]) for a, e in common.items() if a in here and (e > 0) == (here[a] > 0)}
        factor = tuple(sorted(common.items()))
        c = number_content(p.values())
        if p[next((m for m in monomials if all(e % 2 == 0 for _, e in m)), monomials[0])] < 0:
            c = -c
        rest = {divided(m, common): value / c for m, value in p.items()}
        return c, factor, rest

    # -- functions ------------------------------------------------------------

    def root(self, p: Polynomial) -> Polynomial:
        """sqrt(p): squares come out as absolute values."""
        c, common, rest = self.content(p)
        if not p:
            return {}
        if c < 0:
            c, rest = -c, scaled(rest, Fraction(-1))
        # Even powers leave the root: x^2 as |x|, or as x where it is known not to be negative.
        outside = constant(Fraction(1))
        inside: dict[int, Exponent] = {}
        for atom, e in common:
            whole = e if self.atoms[atom].nonnegative else e // 2 * 2
            if whole:
                half = whole * HALF
                if half % 2 == 1 and not self.atoms[atom].nonnegative:
                    base = self.power(self.function("abs", self.single(atom)), int(half))
                else:
                    base = self.single(atom, half if half.denominator > 1 else int(half))
                outside = self.multiply(outside, base)
            if e - whole:
                inside[atom] = e - whole
        # So does the number, if it is the square of a fraction.
        square = Fraction(isqrt(c.numerator), isqrt(c.denominator))
        if square * square == c:
            outside, c = scaled(outside, square), Fraction(1)
        under = self.multiply({tuple(sorted(inside.items())): c}, rest)
        if under == {(): 1}:
            return outside
        return self.multiply(outside, self.single(self._sum(under), HALF))

    def _pow(self, x: Polynomial, y: Polynomial) -> Polynomial:
        exponent = y.get(()) if len(y) == 1 else None
        if exponent is not None and (2 * exponent).denominator == 1 and abs(exponent) <= 8:
            return self.power(self.root(x), int(2 * exponent))
        return self.function("pow", x, y)

    def function(self, op: str, *args: Polynomial) -> Polynomial:
        sign, row = Fraction(1), OPERATORS[op]
        if row.parity and args[0] and args[0][min(args[0])] < 0:
            args = (scaled(args[0], Fraction(-1)),)
            sign = Fraction(row.parity)
        if op == "abs" and len(args[0]) == 1:
            return self._absolute(args[0])
        self._spend(sum(len(a) for a in args))
        atom = Atom(op, None, tuple(frozen(a) for a in args), row.within[0] >= 0.0)
        return scaled(self.single(self._atom(atom)), sign)

    def _absolute(self, p: Polynomial) -> Polynomial:
        ((monomial, c),) = p.items()
        product = constant(abs(c))
        for atom, e in monomial:
            base = self.single(atom, e)
            if e % 2 and not self.atoms[atom].nonnegative:
                number = self._atom(Atom("abs", None, (frozen(self.single(atom)),), True))
                base = self.single(number, e)
            product = self.multiply(product, base)
        return product

    def end_limit(self) -> None:
        """Count no further products: all is multiplied out, and to look for squares while it is written may
        take what it takes."""
        self.limit = inf

    def _spend(self, work: int) -> None:
        self.spent += work
        if self.spent > self.limit:
            raise TooLarge
