"""Terms collected as a person would: a polynomial becomes a sum of products of sums."""

from collections.abc import Sequence
from fractions import Fraction
from functools import cached_property
from typing import TypeAlias

from lagc.base.records import dataclass
from lagc.reports.algebra.expansion import Algebra
from lagc.reports.algebra.polynomials import Exponent, Monomial, Polynomial, divided, scaled

Factors: TypeAlias = "tuple[tuple[int | Sum, Exponent], ...]"


@dataclass(frozen=True, slots=True)
class Product:
    """coefficient * atom^exponent * ... * (sum)^exponent ..."""

    coefficient: Fraction
    factors: Factors


@dataclass(frozen=True, slots=True)
class Sum:
    terms: tuple[Product, ...]


LONGEST = 60  # terms of a sum in which squares are looked for


@dataclass(frozen=True)
class Collector:
    """Collects terms: accelerations first, multipliers last, what terms share before parentheses."""

    algebra: Algebra
    parameters: set[int]
    leading: list[int]
    rates: set[int]
    trailing: list[int]
    cancelled: set[int]

    @cached_property
    def _first(self) -> dict[int, int]:
        """The places of those that stand first."""
        return {a: k for k, a in enumerate(self.leading)}

    @cached_property
    def _arguments(self) -> dict[int, tuple[Sum, ...]]:
        return {}

    @cached_property
    def _last(self) -> dict[int, int]:
        """The places of those that stand last."""
        return {a: k for k, a in enumerate(self.trailing)}

    def cancel(self, p: Polynomial) -> Polynomial:
        """Return `p` without its `common_factor`."""
        inverse = {tuple([(a, -e) for a, e in m]): 1 / c for m, c in self.common_factor(p).items()}
        return self.algebra.multiply(inverse, p)

    def common_factor(self, p: Polynomial) -> Polynomial:
        """Return the number and the parameters that all terms share, as one term; without it, most terms of
        the first acceleration are positive. It is 1 for zero."""
        if not p:
            return {(): Fraction(1)}
        c, common, _ = self.algebra.content(p)
        shared = tuple(sorted([(a, e) for a, e in common if a in self.cancelled]))
        return {shared: abs(c) * self._sign(p)}

    def _sign(self, p: Polynomial) -> int:
        heads = {a for m in p for a, e in m if e == 1 and a in self._first}
        head = min(heads, key=self._first.__getitem__, default=None)
        first = [m for m in p if head is None or (head, 1) in m]
        balance = sum(1 if p[m] > 0 else -1 for m in first)
        return 1 if (balance or p[min(first, key=self._term_key)]) > 0 else -1

    def collect(self, p: Polynomial, leading: Sequence[int] | None = None) -> Sum:
        """`p` with the terms of each atom of `leading` (the accelerations) gathered and put first."""
        first = self._first if leading is None else {a: k for k, a in enumerate(leading)}
        # Each term goes to the acceleration or multiplier that it is linear in, the others stay together.
        parts: dict[int, Polynomial] = {}
        rest: Polynomial = {}
        for monomial, c in p.items():
            head = next((a for a, e in monomial if e == 1 and (a in first or a in self._last)), None)
            into = rest if head is None else parts.setdefault(head, {})
            into[_less(monomial, head)] = c
        before = sorted([a for a in parts if a in first], key=first.__getitem__)
        after = sorted([a for a in parts if a not in first], key=self._last.__getitem__)
        terms = [self._multiplied(parts[a], ((a, 1),)) for a in before]
        if rest:
            terms += sorted(self._gathered(rest), key=self._is_constant)
        terms += [self._multiplied(parts[a], ((a, 1),)) for a in after]
        return Sum(tuple(terms))

    def factored(self, p: Polynomial) -> Sum:
        """Return `collect(p)`, with a number that all terms share before one pair of parentheses."""
        c = self.algebra.content(p)[0]
        if len(p) < 2 or abs(c) == 1:
            return self.collect(p)
        return Sum((Product(c, ((self.collect(scaled(p, 1 / c)), 1),)),))

    def inside(self, p: Polynomial) -> Sum:
        """`p` as it stands inside a function: its first term positive where one is."""
        return Sum(positive_first(self._gathered(p)))

    def arguments(self, atom: int) -> tuple[Sum, ...]:
        """Return the arguments of a function as they stand inside it, which are made once."""
        if atom not in self._arguments:
            self._arguments[atom] = tuple([self.inside(dict(p)) for p in self.algebra.atoms[atom].args])
        return self._arguments[atom]

    def _gathered(self, p: Polynomial) -> list[Product]:
        """Terms with the same functions and speeds become one, with a sum of the rest before."""
        groups: dict[Monomial, Polynomial] = {}
        for monomial in sorted(p, key=self._term_key):
            mine = tuple([(a, e) for a, e in monomial if not self._is_plain(a)])
            rest = tuple([(a, e) for a, e in monomial if self._is_plain(a)])
            groups.setdefault(mine, {})[rest] = p[monomial]
        products: list[Product] = []
        for mine, coefficient in groups.items():
            products += [self._multiplied(coefficient, mine)] if mine else self._plain(coefficient)
        return products

    def _multiplied(self, p: Polynomial, factors: Monomial) -> Product:
        """p*factors as one product: what the terms of p share, their sum, `factors`."""
        if len(p) == 1:
            ((monomial, c),) = p.items()
            whole: Monomial = (*monomial, *factors)
            ordered: Monomial = tuple(sorted(whole, key=self._factor_key))
            return Product(c, ordered)
        c, common, _ = self.algebra.content(p)
        shared = {a: e for a, e in common if self._is_plain(a)}
        terms = self._gathered({divided(m, shared): value / c for m, value in p.items()})
        if terms[0].coefficient < 0:
            c, terms = -c, [Product(-t.coefficient, t.factors) for t in terms]
        # The first term is positive now, so equal sums are equal objects: those that all terms share go
        # out.
        sums, terms = _common_sums(terms)
        before, after = self._before_and_after([*shared.items(), *factors])
        if len(terms) == 1:
            return Product(c * terms[0].coefficient, (*before, *sums, *terms[0].factors, *after))
        return Product(c, (*before, *sums, (Sum(tuple(terms)), 1), *after))

    def _before_and_after(self, factors: Sequence[tuple[int, Exponent]]) -> tuple[Monomial, Monomial]:
        """Return the factors that stand before a sum, and those that stand after it."""
        ordered = sorted(factors, key=self._factor_key)
        plain = [self._is_plain(a) for a, _ in ordered]
        return (
            tuple([f for f, is_plain in zip(ordered, plain) if is_plain]),
            tuple([f for f, is_plain in zip(ordered, plain) if not is_plain]),
        )

    def _plain(self, p: Polynomial) -> list[Product]:
        """Parameters and coordinates: squares of sums, then a product a monomial of coordinates."""
        # Squares of sums first: what they use must not be gathered by coordinates.
        squares, p = self._squares(p)
        groups: dict[Monomial, Polynomial] = {}
        for monomial in sorted(p, key=self._term_key):
            mine = tuple([(a, e) for a, e in monomial if a not in self.parameters])
            rest = tuple([(a, e) for a, e in monomial if a in self.parameters])
            groups.setdefault(mine, {})[rest] = p[monomial]
        products: list[Product] = []
        for mine, coefficient in groups.items():
            if len(coefficient) == 1 or mine:
                products.append(self._of_parameters(coefficient, mine))
            elif self.algebra.content(coefficient)[1]:
                products.append(self._of_parameters(coefficient, ()))
            else:
                products += [Product(c, m) for m, c in coefficient.items()]
        return [*squares, *products]

    def _of_parameters(self, coefficient: Polynomial, mine: Monomial) -> Product:
        c, common, rest = self.algebra.content(coefficient)
        factors: list[tuple[int | Sum, Exponent]] = list(common)
        if rest != {(): 1}:
            ordered = sorted(rest, key=self._term_key)
            factors.append((Sum(positive_first([Product(rest[m], m) for m in ordered])), 1))
        return Product(c, (*factors, *sorted(mine, key=self._factor_key)))

    def _squares(self, p: Polynomial) -> tuple[list[Product], Polynomial]:
        """Terms of `p` that make c*(x + b)^2, the longest b first, as products, and those left."""
        found: list[Product] = []
        while 2 < len(p) <= LONGEST:
            candidates = [
                (monomial, atom, *square)
                for monomial in sorted(p, key=self._term_key)
                for atom, e in monomial
                if e == 2 and (square := self._square(p, monomial, atom)) is not None
            ]
            if not candidates:
                break
            # Of several squares the one that uses most terms: (x + y + z)^2 before (x + y)^2.
            monomial, atom, base, used = max(candidates, key=_uses)
            outside = sorted(_less(monomial, atom), key=self._factor_key)
            found.append(Product(p[monomial], (*outside, (self.inside(base), 2))))
            p = {m: c for m, c in p.items() if m not in used}
        return found, p

    def _square(
        self, p: Polynomial, monomial: Monomial, atom: int
    ) -> tuple[Polynomial, set[Monomial]] | None:
        """x + b where p holds c*x^2 + 2*c*x*b + c*b^2 with c*x^2 = `monomial`, and those terms."""
        # c x^2 is there; the terms linear in x give b, and the square counts if all its other terms are
        # there.
        outside = dict(_less(monomial, atom))
        c = p[monomial]
        b: Polynomial = {}
        for m, value in p.items():
            powers = dict(m)
            if powers.get(atom) == 1 and all(powers.get(a, 0) >= e for a, e in outside.items()):
                b[divided(m, {**outside, atom: 1})] = value / (2 * c)
        if not b:
            return None
        base = self.algebra.add(self.algebra.single(atom), b)
        whole = self.algebra.multiply({tuple(outside.items()): c}, self.algebra.power(base, 2))
        if any(p.get(m) != value for m, value in whole.items()):
            return None
        return base, set(whole)

    def _is_plain(self, atom: int) -> bool:
        """A parameter, a coordinate or the time."""
        moving = atom in self.rates or atom in self._first or atom in self._last
        return self.algebra.atoms[atom].op == "symbol" and not moving

    def _is_constant(self, product: Product) -> bool:
        return all(isinstance(f, Sum) or f in self.parameters for f, _ in product.factors)

    def _factor_key(self, factor: tuple[int, Exponent]) -> tuple[int, int]:
        """Return the place of a factor in a product: parameters, coordinates, functions, rates, then
        accelerations and multipliers."""
        atom, _ = factor
        if atom in self._first or atom in self._last:
            return (4, atom)
        if self.algebra.atoms[atom].op != "symbol":
            return (2, atom)
        return (0 if atom in self.parameters else 3 if atom in self.rates else 1, atom)

    def _term_key(self, monomial: Monomial) -> tuple[object, ...]:
        """Return the place of a term in a sum: accelerations, then high degree in the rates, then the order
        of the symbols."""
        head = min([a for a, _ in monomial if a in self._first], default=len(self.algebra.atoms) + 1)
        last = min([a for a, _ in monomial if a in self._last], default=-1)
        degree = sum([e for a, e in monomial if a in self.rates])
        functions = len([a for a, _ in monomial if self.algebra.atoms[a].op != "symbol"])
        return (last, head, -degree, functions, monomial)


def _common_sums(terms: list[Product]) -> tuple[Factors, list[Product]]:
    """The sums that are a factor of every term, and the terms without them."""
    shared = tuple(
        [f for f in terms[0].factors if isinstance(f[0], Sum) and all(f in t.factors for t in terms)]
    )
    rest = [Product(t.coefficient, tuple([f for f in t.factors if f not in shared])) for t in terms]
    return shared, rest


def _less(monomial: Monomial, atom: int | None) -> Monomial:
    return tuple([(a, e) for a, e in monomial if a != atom])


def _uses(candidate: tuple[Monomial, int, Polynomial, set[Monomial]]) -> int:
    return len(candidate[3])


def positive_first(terms: Sequence[Product]) -> tuple[Product, ...]:
    """`terms`, where the first is negative with the first positive one before it."""
    k = next((k for k, term in enumerate(terms) if term.coefficient > 0), 0)
    return (*terms[k : k + 1], *terms[:k], *terms[k + 1 :])
