"""The type of a real in printed C: double, and what may take its place."""

from __future__ import annotations

from fractions import Fraction
from math import pi

from lagc.records import dataclass

STANDS_FOR_ZERO = 1e-300  # in Programs
PI = "3.1415926535897932384626433832795028841972"


@dataclass(frozen=True)
class Arithmetic:
    """The type of a Real."""

    name: str
    suffix: str  # of literals
    call: str  # of functions of math
    column: int  # of by_type
    infinity: str
    header: str
    nan: str = "NAN"

    def literal(self, value: float | Fraction | str) -> str:
        """The value, so that reading it gives the same bits as rounding it once.  What stands for zero where
        it divides zero, and what is pi to a double, are so to the type."""
        if value == STANDS_FOR_ZERO:
            return f"{('1e-30', '1e-300', '1e-4000')[self.column]}{self.suffix}"
        if self.column == 2 and not isinstance(value, str) and abs(value) == pi:
            return f"{'-' if value < 0 else ''}{PI}{self.suffix}"
        if self.column == 2:  # wider than a double
            if isinstance(value, Fraction):
                shift = 40 - len(str(abs(value.numerator) // value.denominator))
                scaled = value * Fraction(10) ** shift
                return f"{round(scaled)}e{-shift}{self.suffix}"
            return (value if isinstance(value, str) else repr(float(value))) + self.suffix
        return repr(float(value)) + self.suffix


DOUBLE = Arithmetic("double", "", "{}", 1, "HUGE_VAL", "<math.h>")
SINGLE = Arithmetic("float", "f", "{}f", 0, "HUGE_VALF", "<math.h>")
QUAD = Arithmetic("__float128", "Q", "{}q", 2, "HUGE_VALQ", "<quadmath.h>", 'nanq("")')

TYPES = {"double": DOUBLE, "float": SINGLE, "quad": QUAD}  # names of people
