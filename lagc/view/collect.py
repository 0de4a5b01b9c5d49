"""Terms collected as a person would: a polynomial becomes a sum of products of sums."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from lagc.view.algebra import Algebra, Exponent, Monomial, Polynomial, divided, scaled


@dataclass(frozen=True, slots=True)
class Product:
    """coefficient * atom^exponent * ... * (sum)^exponent ..."""

    coefficient: Fraction
    factors: tuple[tuple[int | Sum, Exponent], ...]


@dataclass(frozen=True, slots=True)
class Sum:
    terms: tuple[Product, ...]


@dataclass(frozen=True)
class Collector:
    """Collects terms: accelerations first, multipliers last, parameters gathered before the rest."""

    algebra: Algebra
    parameters: set[int]
    leading: list[int]
    rates: set[int]
    trailing: list[int]
    cancelled: set[int]

    def cancel(self, p: Polynomial) -> Polynomial:
        """`p` without the number and the parameters that all terms share; its first term positive."""
        if not p:
            return p
        c, common, _ = self.algebra.content(p)
        factor = {a: e for a, e in common if a in self.cancelled}
        ordered = sorted(p, key=self._term_key)
        c = abs(c) if p[ordered[0]] > 0 else -abs(c)
        powers = self.algebra.multiply({tuple(sorted((a, -e) for a, e in factor.items())): 1 / c}, p)
        return powers

    def collect(self, p: Polynomial, leading: Sequence[int] | None = None) -> Sum:
        """`p` with the terms of each atom of `leading` (the accelerations) gathered and put first."""
        leading = self.leading if leading is None else leading
        heads = [*leading, *self.trailing]
        parts: dict[int | None, Polynomial] = {}
        for monomial, c in p.items():
            head = next((a for a, e in monomial if e == 1 and a in heads), None)
            rest = tuple([(a, e) for a, e in monomial if a != head])
            parts.setdefault(head, {})[rest] = c
        terms: list[Product] = []
        for head in (*leading, None, *self.trailing):
            if head is None and None in parts:
                terms += sorted(self._gathered(parts[None]), key=self._is_constant)
            elif head in parts:
                terms.append(self._headed(head, parts[head]))
        return Sum(tuple(terms))

    def _headed(self, head: int | None, p: Polynomial) -> Product:
        """p*head, with what the terms of p share before a sum in parentheses."""
        assert head is not None
        if len(p) > 1:
            c, shared, p = self._shared(p)
        else:
            c, shared = Fraction(1), ()
        terms = self._gathered(p)
        if len(terms) == 1:
            factors = sorted((*shared, *terms[0].factors), key=_sums_last)
            return Product(c * terms[0].coefficient, (*factors, (head, 1)))
        if terms[0].coefficient < 0:
            c, terms = -c, [Product(-t.coefficient, t.factors) for t in terms]
        return Product(c, (*shared, (Sum(tuple(terms)), 1), (head, 1)))

    def _shared(self, p: Polynomial) -> tuple[Fraction, Monomial, Polynomial]:
        """The number and the parameters that all terms of p share, and the rest."""
        c, common, _ = self.algebra.content(p)
        powers = {a: e for a, e in common if a in self.parameters}
        return c, tuple(powers.items()), {divided(m, powers): value / c for m, value in p.items()}

    def factored(self, p: Polynomial) -> Sum:
        """As `collect`, with a number that all terms share before one pair of parentheses."""
        c = self.algebra.content(p)[0]
        if len(p) < 2 or abs(c) == 1:
            return self.collect(p)
        return Sum((Product(c, ((self.collect(scaled(p, 1 / c)), 1),)),))

    def _gathered(self, p: Polynomial) -> list[Product]:
        """Terms with the same coordinates and speeds become one, with a sum of parameters before."""
        groups: dict[Monomial, Polynomial] = {}
        for monomial in sorted(p, key=self._term_key):
            mine = tuple([(a, e) for a, e in monomial if a not in self.parameters])
            coefficient = tuple([(a, e) for a, e in monomial if a in self.parameters])
            groups.setdefault(mine, {})[coefficient] = p[monomial]
        return [self._product(coefficient, mine) for mine, coefficient in groups.items()]

    def _product(self, coefficient: Polynomial, mine: Monomial) -> Product:
        no_factors: Monomial = ()
        if not mine and len(coefficient) > 1:
            c, common, rest = Fraction(1), no_factors, coefficient
        else:
            c, common, rest = self.algebra.content(coefficient)
        factors: list[tuple[int | Sum, Exponent]] = list(common)
        if rest != {(): 1}:
            inner = tuple([Product(rest[m], tuple(m)) for m in sorted(rest, key=self._term_key)])
            if inner[0].coefficient < 0:
                c, inner = -c, tuple([Product(-t.coefficient, t.factors) for t in inner])
            factors.append((Sum(inner), 1))
        return Product(c, (*factors, *sorted(mine, key=self._factor_key)))

    def _is_constant(self, product: Product) -> bool:
        return all(isinstance(f, Sum) or f in self.parameters for f, _ in product.factors)

    def _factor_key(self, factor: tuple[int, Exponent]) -> tuple[int, int]:
        """In a product: parameters, coordinates, functions, rates."""
        atom, _ = factor
        if self.algebra.atoms[atom].op != "symbol":
            return (2, atom)
        return (0 if atom in self.parameters else 3 if atom in self.rates else 1, atom)

    def _term_key(self, monomial: Monomial) -> tuple[object, ...]:
        """In a sum: accelerations, then high degree in the rates, then the order of the symbols."""
        head = min([a for a, _ in monomial if a in self.leading], default=len(self.algebra.atoms) + 1)
        last = min([a for a, _ in monomial if a in self.trailing], default=-1)
        degree = sum([e for a, e in monomial if a in self.rates])
        functions = len([a for a, _ in monomial if self.algebra.atoms[a].op != "symbol"])
        return (last, head, -degree, functions, monomial)


def _sums_last(factor: tuple[int | Sum, Exponent]) -> bool:
    return isinstance(factor[0], Sum)
