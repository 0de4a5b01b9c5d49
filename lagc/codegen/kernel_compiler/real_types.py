"""The types of reals in printed C: double, float and __float128."""

from __future__ import annotations

from math import copysign, inf, isqrt, ulp
from typing import TYPE_CHECKING

from lagc.base.records import dataclass
from lagc.diagnostics.faults import Fault, Refused
from lagc.lowering.program import FARTHEST

if TYPE_CHECKING:
    from fractions import Fraction

STANDS_FOR_ZERO = 1e-300  # in Programs
PI = "3.14159265358979323846264338327950288419716939937510"
# Largest numerator times denominator of `meant`: one double in 1e8 is next to such a quotient by chance.
MOST = 10**7


@dataclass(frozen=True)
class Arithmetic:
    """A type of reals."""

    name: str
    suffix: str  # of literals
    call: str  # of functions of math
    column: int  # of by_type
    infinity: str
    nan: str
    least: float  # of normal numbers, and
    largest: float  # of doubles that it holds
    headers: tuple[str, ...]
    wider: str  # of FLT_EVAL_METHOD: arithmetic keeps more digits than the type; empty: there is none

    @property
    def language(self) -> str:
        """Return the name of C with this type, for users and for `kernel_compiler.library`."""
        return ("float", "double", "quad")[self.column]

    @property
    def includes(self) -> str:
        """Return the include lines of the source."""
        return "".join(f"#include <{name}>\n" for name in self.headers)

    def literal(self, value: float | Fraction | str) -> str:
        """Return a literal that gives the same bits as rounding the value once. The numbers that replace
        zero in a divisor, and that are larger than all others, are adapted to the type. In a wider type a
        double stands for the number that it approximates (`meant`). Raises Refused (LAG0590) for a number
        that a narrower type cannot hold."""
        if value == STANDS_FOR_ZERO:
            return f"{('1e-30', '1e-300', '1e-4000')[self.column]}{self.suffix}"
        if self.column == 2:  # wider than a double
            exact = meant(value) if isinstance(value, float | int) else value
            return (exact if isinstance(exact, str) else _decimal(exact)) + self.suffix
        value = float(value)
        if self.column == 0 and abs(value) == FARTHEST:
            value = copysign(3.2e38, value)  # as far below the largest number
        if value and not self.least <= abs(value) <= self.largest:
            message = f"a number of the equations is too large or too small for a {self.name}: {value!r}"
            raise Refused((Fault("LAG0590", message, None),))
        return repr(value) + self.suffix

    def bound(self, value: float) -> str:
        """Return the literal of a bound; a bound outside of the type becomes infinity or zero."""
        if abs(value) > self.largest or abs(value) == inf:
            return f"{'-' if value < 0 else ''}{self.infinity}"
        return self.literal(value if abs(value) >= self.least else 0.0)


def meant(value: float) -> str | Fraction:
    """Return the number that a double approximates: its decimal digits if 12 are enough; else the nearest
    quotient of small integers, or such a multiple of pi, 1/pi or pi^2; else its decimal digits, although
    the last ones are round-off."""
    from fractions import Fraction  # where reals are wider than doubles

    digits, pi = repr(float(value)), Fraction(PI)
    if value == 0.0 or float(f"{value:.12g}") == value or abs(value) > MOST:
        return digits
    quotient = _near(Fraction(value))
    if quotient.numerator / quotient.denominator == value:
        return quotient
    for factor in (pi, 1 / pi, pi * pi):
        turned = _near(Fraction(value) / factor) * factor
        if abs(turned - Fraction(value)) <= ulp(value):
            return turned
    return digits


def _near(value: Fraction) -> Fraction:
    """Return the nearest quotient p/q with p q up to about MOST."""
    return value.limit_denominator(max(1, isqrt(int(MOST / abs(value)))))


def _decimal(value: Fraction) -> str:
    """Return a number with 40 digits."""
    from decimal import Context, Decimal

    digits = str(Context(40).divide(Decimal(value.numerator), Decimal(value.denominator)))
    return digits if "." in digits or "E" in digits else f"{digits}.0"


_DOUBLE = "FLT_EVAL_METHOD < 0 || FLT_EVAL_METHOD == 2 || FLT_EVAL_METHOD > 64"
_SINGLE = "FLT_EVAL_METHOD != 0 && FLT_EVAL_METHOD != 16 && FLT_EVAL_METHOD != 32"
_HEADERS = ("float.h", "math.h", "stdbool.h", "string.h")

DOUBLE = Arithmetic("double", "", "{}", 1, "HUGE_VAL", "NAN", 0.0, inf, _HEADERS, _DOUBLE)
SINGLE = Arithmetic(
    "float", "f", "{}f", 0, "HUGE_VALF", "NAN", 2.0**-126, 2.0**128 - 2.0**104, _HEADERS, _SINGLE
)
QUAD = Arithmetic(
    "__float128",
    "Q",
    "{}q",
    2,
    "HUGE_VALQ",
    'nanq("")',
    0.0,
    inf,
    ("quadmath.h", "stdbool.h", "string.h"),
    "",
)

TYPES = {real.language: real for real in (DOUBLE, SINGLE, QUAD)}
