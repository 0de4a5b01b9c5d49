"""Trigonometric identities that shorten a sum, applied as long as one does.

    x sin^2 u + x cos^2 u = x             x cos u cos w + x sin u sin w = x cos(u - w)
    x - x cos^2 u = x sin^2 u             x sin u cos w - x cos u sin w = x sin(u - w)

and the same with u + w. Every step leaves fewer terms or fewer factors, so the search ends.
"""

from fractions import Fraction

from lagc.reports.algebra.expansion import Algebra
from lagc.reports.algebra.polynomials import (
    READABLE,
    Exponent,
    Monomial,
    Polynomial,
    accumulate,
    frozen,
    scaled,
)
from lagc.symbolic.graph import Node
from lagc.symbolic.operators import TWINS, exchanged

NOISE = Fraction(1, 2**50)
Powers = dict[int, Exponent]


class ShortAlgebra(Algebra):
    """Shortens what stands under roots and below lines, where nothing does later."""

    def root(self, p: Polynomial) -> Polynomial:
        return super().root(shorten(self, p))

    def _inverse_power(self, p: Polynomial, n: int) -> Polynomial:
        return super()._inverse_power(shorten(self, p) or p, n)  # what vanishes stays as it was written


class TurningAlgebra(ShortAlgebra):
    """Shortens each sum at once: along frames that rotate relative to each other, sine and cosine of the
    total angle are one term each."""

    def _convert(self, node: Node) -> Polynomial:
        p = super()._convert(node)
        return shorten(self, p) if node.op == "add" else p


def shorten(algebra: Algebra, p: Polynomial) -> Polynomial:
    """`p` after the identities; exactly equal to it."""
    p = dict(p)
    # A change can make another one possible in the terms that it touched, and nowhere else.
    queue = sorted(p)
    while queue:
        again: list[Monomial] = []
        for monomial in queue:
            if monomial in p:
                again += _step(algebra, p, monomial)
        queue = sorted({m for m in again if m in p})
    return p


def _step(algebra: Algebra, p: Polynomial, monomial: Monomial) -> list[Monomial]:
    """Try the identities on one monomial of p; the monomials that changed."""

    def twin(atom: int, exponent: Exponent) -> int | None:
        return _twin(algebra, atom) if _whole(algebra, atom, exponent, 2) else None

    # First one angle: sin^2 + cos^2. Then the products of two angles.
    for powers, other in exchanged(monomial, twin):
        rest = _sorted(powers)
        changed = _pythagoras(p, monomial, rest, _exchange(rest, [(other, 2)]))
        if changed:
            return changed
    trig = [a for a, e in monomial if _whole(algebra, a, e, 1)]
    for i, first in enumerate(trig):
        for second in trig[i + 1 :]:
            if algebra.atoms[first].args != algebra.atoms[second].args:
                changed = _difference(algebra, p, monomial, first, second)
                if changed:
                    return changed
    return []


def _whole(algebra: Algebra, atom: int, exponent: Exponent, least: int) -> bool:
    """Whether the power of an atom is one of a sine or cosine, whole and no smaller than `least`."""
    return algebra.atoms[atom].op in TWINS and exponent >= least and exponent.denominator == 1


def _twin(algebra: Algebra, atom: int) -> int:
    """The number of sin u for cos u, of cos u for sin u."""
    found = algebra.twins.get(atom)
    if found is None:
        known = algebra.atoms[atom]
        ((monomial, _),) = algebra.function(TWINS[known.op], dict(known.args[0])).items()
        found = algebra.twins[atom] = monomial[0][0]
    return found


def _exchange(monomial: Monomial, changes: list[tuple[int, int]]) -> Monomial:
    powers: Powers = dict(monomial)
    for atom, by in changes:
        powers[atom] = powers.get(atom, 0) + by
    return _sorted(powers)


def _sorted(powers: Powers) -> Monomial:
    return tuple(sorted([(a, e) for a, e in powers.items() if e]))


def _pythagoras(p: Polynomial, monomial: Monomial, rest: Monomial, other: Monomial) -> list[Monomial]:
    c, d = p[monomial], p.get(other)
    if d is not None and (c > 0) == (d > 0):
        least = min(c, d, key=abs)
        for m, value in ((monomial, -least), (other, -least), (rest, least)):
            accumulate(p, m, value)
        return [monomial, other, rest]
    if p.get(rest) == -c:  # x - x*cos^2 u, where the two terms become one
        del p[rest], p[monomial]
        accumulate(p, other, -c)
        return [other]
    return []


def _difference(
    algebra: Algebra, p: Polynomial, monomial: Monomial, first: int, second: int
) -> list[Monomial]:
    others = [(_twin(algebra, first), 1), (_twin(algebra, second), 1)]
    twins = _exchange(monomial, [(first, -1), (second, -1), *others])
    c, d = p[monomial], p.get(twins)
    if d is None or abs(c) != abs(d):
        return []
    same = c == d
    a, b = algebra.atoms[first], algebra.atoms[second]
    u, w = dict(a.args[0]), dict(b.args[0])
    # The two products, without sines and cosines, have the same factor up to its sign.
    rest = {_exchange(monomial, [(first, -1), (second, -1)]): c}
    minus = algebra.add(u, scaled(w, Fraction(-1)))
    plus = algebra.add(u, w)
    if a.op == b.op:  # cos cos + sin sin = cos(u - w); cos cos - sin sin = cos(u + w)
        result = algebra.multiply(rest, _trig(algebra, "cos", minus if same else plus))
        if not same and a.op == "sin":
            result = scaled(result, Fraction(-1))
    elif same:  # sin u cos w + cos u sin w
        result = algebra.multiply(rest, _trig(algebra, "sin", plus))
    else:  # sin u cos w - cos u sin w = sin(u - w), with c the coefficient of the first product
        sign = Fraction(1 if a.op == "sin" else -1)
        result = scaled(algebra.multiply(rest, _trig(algebra, "sin", minus)), sign)
    del p[monomial], p[twins]
    for m, value in result.items():
        accumulate(p, m, value)
    return sorted(result)


def _trig(algebra: Algebra, op: str, u: Polynomial) -> Polynomial:
    if not frozen(u):
        return {(): Fraction(1)} if op == "cos" else {}
    return algebra.function(op, u)


def unit_quaternion(algebra: Algebra, p: Polynomial, parts: tuple[int, int, int, int]) -> Polynomial:
    """`p` by w^2 + x^2 + y^2 + z^2 = 1 of the four atoms `parts`, where that leaves fewer terms."""
    best = p
    for eliminated in parts:
        square: Polynomial = {(): Fraction(1)} | {((a, 2),): Fraction(-1) for a in parts if a != eliminated}
        by_power: dict[int, Polynomial] = {}  # of the square of the one that goes
        for monomial, c in p.items():
            times = max(int(dict(monomial).get(eliminated, 0)) // 2, 0)
            by_power.setdefault(times, {})[_exchange(monomial, [(eliminated, -2 * times)])] = c
        candidate: Polynomial = {}
        for times in range(max(by_power, default=0), -1, -1):  # Horner
            candidate = algebra.add(algebra.multiply(candidate, square), by_power.get(times, {}))
        if len(candidate) < len(best):
            best = candidate
    return best


def without_noise(algebra: Algebra, p: Polynomial) -> Polynomial:
    """Return `p` without terms of about 1e-16 of another term that differs in sines and cosines only: they
    are round-off."""
    if all(c.denominator <= READABLE for c in p.values()):
        return p
    bounded = {a for a, atom in enumerate(algebra.atoms) if atom.op in TWINS}
    keys = {m: tuple([(a, e) for a, e in m if a not in bounded or e < 0]) for m in p}
    largest: dict[Monomial, Fraction] = {}
    for m, c in p.items():
        largest[keys[m]] = max(largest.get(keys[m], Fraction(0)), abs(c))
    return {m: c for m, c in p.items() if abs(c) > NOISE * largest[keys[m]]}
