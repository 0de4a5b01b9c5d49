"""Sums of monomials with exact coefficients, and the numbers of a model as such coefficients."""

from collections.abc import Iterable
from fractions import Fraction
from math import floor, gcd, log10
from typing import TypeAlias

Exponent: TypeAlias = "int | Fraction"
Monomial: TypeAlias = tuple[tuple[int, Exponent], ...]
Polynomial: TypeAlias = dict[Monomial, Fraction]
Frozen: TypeAlias = tuple[tuple[Monomial, Fraction], ...]

READABLE = 1_000_000  # a denominator beyond it comes from a decimal number, not from a formula
WRITTEN = 12  # digits: numbers of more may have been rounded
PRODUCTS, SUMS = Fraction(1, 2**50), Fraction(1, 2**47)  # what rounding makes of them, relatively; long sums


class NotFinite(Exception):
    """A number is infinite or NaN, which has no place in an equation."""


def fraction(value: float) -> Fraction:
    """Return the simple fraction that `value` equals up to round-off, or `value`. Raises NotFinite."""
    if value - value != 0.0:
        raise NotFinite
    # Exactly a simple fraction, or a decimal number that someone wrote: these stay as they are.
    near = Fraction(value).limit_denominator(1000)
    if float(near) == value:
        return near
    exact = Fraction(repr(value))
    if len(repr(abs(value)).partition("e")[0].replace(".", "").strip("0")) <= WRITTEN:
        return exact
    # to one of these fractions a number of random digits is as near with a chance of some 1e-5
    unit = Fraction(10) ** floor(log10(abs(value)))
    for scale, finest, slack in (
        (unit, 100_000, PRODUCTS),
        (unit, 3_000, SUMS),
        (max(unit, Fraction(1)), 30_000, SUMS),
    ):
        near = (exact / scale).limit_denominator(finest) * scale
        if abs(near - exact) <= slack * abs(exact):
            return near
    return exact


def constant(c: Fraction) -> Polynomial:
    return {(): c} if c else {}


def settled(p: Polynomial) -> Polynomial:
    """`p` with simple fractions for what decimal numbers came to but for rounding."""
    found = dict(p)
    for m, c in p.items():
        if c.denominator > READABLE and 1e-300 < abs(c) < 1e300:
            near = fraction(float(c))
            if near.denominator <= READABLE:
                found[m] = near
    return found


def scaled(p: Polynomial, c: Fraction) -> Polynomial:
    return {m: c * value for m, value in p.items()} if c else {}


def accumulate(total: Polynomial, monomial: Monomial, c: Fraction) -> None:
    """total += c*monomial; the rest of decimal numbers that cancel is round-off."""
    before = total.get(monomial)
    value = c if before is None else before + c
    if value and (before is None or value.denominator <= READABLE or abs(value) > SUMS * abs(c)):
        total[monomial] = value
    else:
        total.pop(monomial, None)


def frozen(p: Polynomial) -> Frozen:
    return tuple(sorted(p.items()))


def divided(monomial: Monomial, common: dict[int, Exponent]) -> Monomial:
    return tuple([(a, e - common.get(a, 0)) for a, e in monomial if e != common.get(a, 0)])


def number_content(values: Iterable[Fraction]) -> Fraction:
    """Return the greatest number > 0 that divides all `values` to integers; 1 for different decimal
    numbers."""
    sizes = {abs(value) for value in values}
    if len(sizes) == 1:
        return sizes.pop()
    over, under = 0, 1
    for value in sizes:
        if value.denominator > READABLE:
            return Fraction(1)
        over = gcd(over, value.numerator)
        under = under * value.denominator // gcd(under, value.denominator)
    return Fraction(over, under) if under <= READABLE and over else Fraction(1)
