"""Dimensions, units and quantity types: the meaning of `[kg.m2/s]` and of `Length`.

A dimension is a tuple of exponents of kg m s A K mol cd, counted in twelfths so that roots stay integers.
Angles are numbers: rad is 1.  Factors to SI are exact ratios of integers (and pi for degrees), so that 70
[cm] is 0.7 exactly rounded.
"""

import math
import re
from functools import lru_cache
from typing import TypeAlias

from lagc.base.records import dataclass

Dimension: TypeAlias = tuple[int, ...]

PARTS = 12
BASE = ("kg", "m", "s", "A", "K", "mol", "cd")
NONE: Dimension = (0,) * len(BASE)


def dimension(**exponents: int) -> Dimension:
    return tuple(PARTS * exponents.get(base, 0) for base in BASE)


KG, M, S = (dimension(**{base: 1}) for base in BASE[:3])


def times(a: Dimension, b: Dimension) -> Dimension:
    return tuple([x + y for x, y in zip(a, b)])


def over(a: Dimension, b: Dimension) -> Dimension:
    return tuple([x - y for x, y in zip(a, b)])


def raised(a: Dimension, exponent: float) -> Dimension | None:
    """Return the dimension a^exponent, or None if its exponents are not whole twelfths."""
    scaled = [x * exponent for x in a]
    rounded = [round(x) for x in scaled]
    if any(abs(x - r) > 1e-9 for x, r in zip(scaled, rounded)):
        return None
    return tuple(rounded)


FORCE = dimension(kg=1, m=1, s=-2)
ENERGY = dimension(kg=1, m=2, s=-2)
POWER = dimension(kg=1, m=2, s=-3)


@dataclass(frozen=True, slots=True)
class Unit:
    """num/den * pi^pi times the SI unit of `dimension`."""

    num: int
    den: int
    pi: int
    dimension: Dimension

    @property
    def factor(self) -> float:
        return self.num / self.den * math.pi**self.pi

    def to_si(self, value: float) -> float:
        """Return `value` in SI; its shortest decimal form is taken as exact."""
        if not math.isfinite(value):
            return value
        mantissa, _, exponent = repr(value).partition("e")
        whole, _, decimals = mantissa.partition(".")
        power = int(exponent or 0) - len(decimals)
        num, den = int(whole + decimals) * self.num, self.den
        if power >= 0:
            num *= 10**power
        else:
            den *= 10**-power
        try:
            return num / den * math.pi**self.pi
        except OverflowError:
            return math.inf


class UnknownUnit(ValueError):
    """A text that is not a unit: `reason` is the message; `spelling_remedy` has the remedy."""

    def __init__(self, reason: str, text: str = ""):
        super().__init__(reason)
        self.reason = reason
        self.text = text


# symbol -> (num, den, power of pi, dimension); these take prefixes
_PREFIXED: dict[str, tuple[int, int, int, Dimension]] = {
    "g": (1, 1000, 0, KG), "m": (1, 1, 0, M), "s": (1, 1, 0, S),
    "A": (1, 1, 0, dimension(A=1)), "K": (1, 1, 0, dimension(K=1)), "mol": (1, 1, 0, dimension(mol=1)),
    "cd": (1, 1, 0, dimension(cd=1)), "rad": (1, 1, 0, NONE), "Hz": (1, 1, 0, dimension(s=-1)),
    "N": (1, 1, 0, FORCE), "J": (1, 1, 0, ENERGY), "W": (1, 1, 0, POWER),
    "Pa": (1, 1, 0, dimension(kg=1, m=-1, s=-2)), "bar": (100000, 1, 0, dimension(kg=1, m=-1, s=-2)),
    "C": (1, 1, 0, dimension(A=1, s=1)), "V": (1, 1, 0, dimension(kg=1, m=2, s=-3, A=-1)),
    "F": (1, 1, 0, dimension(kg=-1, m=-2, s=4, A=2)), "Ohm": (1, 1, 0, dimension(kg=1, m=2, s=-3, A=-2)),
    "T": (1, 1, 0, dimension(kg=1, s=-2, A=-1)), "Wb": (1, 1, 0, dimension(kg=1, m=2, s=-2, A=-1)),
    "H": (1, 1, 0, dimension(kg=1, m=2, s=-2, A=-2)), "L": (1, 1000, 0, dimension(m=3)),
    "l": (1, 1000, 0, dimension(m=3)), "eV": (1602176634, 10**28, 0, ENERGY),
}  # fmt: skip
# these do not
_PLAIN: dict[str, tuple[int, int, int, Dimension]] = {
    "1": (1, 1, 0, NONE), "%": (1, 100, 0, NONE), "deg": (1, 180, 1, NONE), "rev": (2, 1, 1, NONE),
    "rpm": (1, 30, 1, dimension(s=-1)), "min": (60, 1, 0, S), "h": (3600, 1, 0, S),
    "d": (86400, 1, 0, S), "day": (86400, 1, 0, S), "t": (1000, 1, 0, KG),
    "ft": (3048, 10000, 0, M), "inch": (254, 10000, 0, M),
    "lb": (45359237, 10**8, 0, KG), "au": (149597870700, 1, 0, M),
}  # fmt: skip
_PREFIXES = {
    "da": (10, 1), "Y": (10**24, 1), "T": (10**12, 1), "G": (10**9, 1), "M": (10**6, 1), "k": (1000, 1),
    "h": (100, 1), "d": (1, 10), "c": (1, 100), "m": (1, 1000), "u": (1, 10**6), "µ": (1, 10**6),
    "n": (1, 10**9), "p": (1, 10**12),
}  # fmt: skip
SYMBOLS = (*_PREFIXED, *_PLAIN)
BROKEN = re.compile(r"\^\s*(\((?![+-]?\d+\))|[+-]?\d*\.\d)")  # an exponent that is not an integer
_TOKEN = re.compile(r"\s*(?:([A-Za-zµ%]+|1)(?:\^?([+-]?\d{1,2})|\^\(([+-]?\d{1,2})\))?|([./*()]))", re.ASCII)


@lru_cache(maxsize=512)
def unit(text: str) -> Unit:
    """Return the unit of a text.  Raises UnknownUnit."""
    if BROKEN.search(text):
        raise UnknownUnit(f"`{text}` is not a unit; exponents must be integers", text)
    try:
        tokens = _tokens(text)
        position, result = _product(tokens, 0, text)
    except UnknownUnit as unknown:
        unknown.text = text
        raise
    if position != len(tokens):
        raise UnknownUnit(f"`{text}` is not a unit", text)
    return result


def _tokens(text: str) -> list[tuple[str, int]]:
    """Return (symbol, exponent) for each unit and (sign, 0) for each of . / * ( )."""
    found: list[tuple[str, int]] = []
    at, stripped = 0, text.rstrip()
    if not stripped:
        raise UnknownUnit("the unit is empty")
    while at < len(stripped):
        match = _TOKEN.match(stripped, at)
        if match is None:
            raise UnknownUnit(f"`{text}` is not a unit")
        found.append((match[4], 0) if match[4] else (match[1], int(match[2] or match[3] or 1)))
        at = match.end()
    if len(found) > 64:
        raise UnknownUnit("the unit has more than 64 factors")
    return found


def _product(tokens: list[tuple[str, int]], position: int, text: str) -> tuple[int, Unit]:
    result, sign = Unit(1, 1, 0, NONE), 1
    while True:
        if position >= len(tokens):
            raise UnknownUnit(f"`{text}` is not a unit")
        symbol, exponent = tokens[position]
        if symbol == "(":
            position, factor = _product(tokens, position + 1, text)
            if position >= len(tokens) or tokens[position][0] != ")":
                raise UnknownUnit(f"`{text}` is not a unit")
            result = _times(result, factor, sign)
        elif symbol in "./*)":
            raise UnknownUnit(f"`{text}` is not a unit")
        else:
            result = _times(result, _symbol(symbol), sign * exponent)
        position += 1
        if position >= len(tokens) or tokens[position][0] not in ("/", ".", "*"):
            return position, result
        # a/b.c is a/(b.c), as in Modelica and ISO 80000
        sign = -1 if tokens[position][0] == "/" or sign < 0 else 1
        position += 1


def _times(a: Unit, b: Unit, exponent: int) -> Unit:
    num, den = (b.num, b.den) if exponent >= 0 else (b.den, b.num)
    power = abs(exponent)
    dim = tuple([x + exponent * y for x, y in zip(a.dimension, b.dimension)])
    return Unit(a.num * num**power, a.den * den**power, a.pi + exponent * b.pi, dim)


def _symbol(symbol: str) -> Unit:
    entry = _PLAIN.get(symbol) or _PREFIXED.get(symbol)
    if entry is not None:
        return Unit(*entry)
    for prefix, (num, den) in _PREFIXES.items():
        base = _PREFIXED.get(symbol[len(prefix) :]) if symbol.startswith(prefix) else None
        if base is not None:
            return Unit(base[0] * num, base[1] * den, base[2], base[3])
    raise UnknownUnit(f"`{symbol}` is not a unit")


def si_text(dim: Dimension) -> str:
    """Return the SI unit of a dimension, `kg.m2/s2`; "" for a number."""
    named = _NAMED.get(dim)
    if named is not None:
        return named
    over_line = [f"{b}{_exponent(x)}" for b, x in zip(BASE, dim) if x > 0]
    under = [f"{b}{_exponent(-x)}" for b, x in zip(BASE, dim) if x < 0]
    if not under:
        return ".".join(over_line)
    bottom = under[0] if len(under) == 1 else f"({'.'.join(under)})"
    return f"{'.'.join(over_line) or '1'}/{bottom}"


def _exponent(twelfths: int) -> str:
    if twelfths == PARTS:
        return ""
    if twelfths % PARTS == 0:
        return str(twelfths // PARTS)
    common = math.gcd(twelfths, PARTS)
    return f"^({twelfths // common}/{PARTS // common})"


_NAMED: dict[Dimension, str] = {
    NONE: "",
    FORCE: "N",
    ENERGY: "J",
    POWER: "W",
    dimension(kg=1, m=-1, s=-2): "Pa",
    dimension(A=1, s=1): "C",
    dimension(kg=1, m=2, s=-3, A=-1): "V",
    dimension(kg=1, s=-2, A=-1): "T",
    dimension(kg=1, s=-2): "N/m",
    dimension(kg=1, s=-1): "N.s/m",
}


def to_si(value: float, given: str, wanted: str) -> float:
    """Return `value` [given] in SI, where `wanted` is a unit of the quantity. Raises UnknownUnit, also if the
    two units have different dimensions."""
    written, expected = unit(given), unit(wanted or "1")
    if written.dimension != expected.dimension:
        raise UnknownUnit(f"`{given}` cannot be converted to `{wanted or '1'}`")
    return written.to_si(value)


def quotient(above: str, below: str) -> str:
    """Return a unit over another as text: `rad/s` over `m` is `rad/(s.m)`."""
    powers: dict[str, int] = {}
    for text, sense in ((above, 1), (below, -1)):
        for symbol, exponent in _tokens(text) if text else ():
            if exponent == 0:
                sense = -sense if symbol == "/" else sense
            elif symbol != "1":
                powers[symbol] = powers.get(symbol, 0) + sense * exponent
    top, bottom = (
        [f"{symbol}{abs(p) if abs(p) > 1 else ''}" for symbol, p in powers.items() if p * sense > 0]
        for sense in (1, -1)
    )
    if not bottom:
        return ".".join(top)
    under = bottom[0] if len(bottom) == 1 else f"({'.'.join(bottom)})"
    return f"{'.'.join(top) or '1'}/{under}"


@dataclass(frozen=True, slots=True)
class QuantityType:
    """A quantity type: the unit of its numbers without a unit, and the unit for display."""

    name: str
    unit: str
    display: str
    dimension: Dimension

    @property
    def in_words(self) -> str:
        """Return the type in words: `Torque [N.m]`, `a number`."""
        known = TYPES.get(self.name)
        if known is None or known.dimension == NONE or known.dimension != self.dimension:
            return describe(self.dimension)
        return f"{self.name} [{self.unit}]"


def quantity_type(name: str, si: str, display: str | None = None) -> QuantityType:
    return QuantityType(name, si, display or si, unit(si or "1").dimension)


_TABLE: dict[str, tuple[str, ...]] = {
    "Real": ("",), "Integer": ("",),
    "Mass": ("kg",), "Length": ("m",), "Time": ("s",), "Angle": ("rad", "deg"), "Area": ("m2",),
    "Volume": ("m3",),
    "Velocity": ("m/s",), "AngularVelocity": ("rad/s",), "Acceleration": ("m/s2",),
    "AngularAcceleration": ("rad/s2",), "Force": ("N",), "Energy": ("J",), "Torque": ("N.m",),
    "Power": ("W",),
    "Action": ("J.s",), "Inertia": ("kg.m2",), "Momentum": ("kg.m/s",), "AngularMomentum": ("kg.m2/s",),
    "Stiffness": ("N/m",), "RotationalStiffness": ("N.m/rad",), "Damping": ("N.s/m",),
    "RotationalDamping": ("N.m.s/rad",), "Pressure": ("Pa",), "Density": ("kg/m3",),
    "LinearDensity": ("kg/m",), "AreaDensity": ("kg/m2",), "Frequency": ("Hz",), "Charge": ("C",),
    "Current": ("A",), "Voltage": ("V",), "MagneticField": ("T",), "ElectricField": ("V/m",),
    "Temperature": ("K",), "Curvature": ("1/m",), "Viscosity": ("Pa.s",),
}  # fmt: skip

TYPES: dict[str, QuantityType] = {name: quantity_type(name, *row) for name, row in _TABLE.items()}

CONSTANTS: dict[str, float] = {"pi": math.pi}

_BY_DIMENSION: dict[Dimension, str] = {}
for _type in TYPES.values():
    _BY_DIMENSION.setdefault(_type.dimension, _type.name)
_BY_DIMENSION[NONE] = "a number"


def name_of(dimension: Dimension) -> str:
    """Return the type to declare a quantity of this dimension with: `Length`, `Real[kg/s]`."""
    if dimension == NONE:
        return "Real"
    return _BY_DIMENSION.get(dimension) or f"Real[{si_text(dimension)}]"


def describe(dimension: Dimension) -> str:
    """Return a dimension in words: `Length [m]`, `[kg.m/s3]`, `a number`."""
    name = _BY_DIMENSION.get(dimension)
    if dimension == NONE:
        return "a number"
    return f"{name} [{TYPES[name].unit}]" if name else f"[{si_text(dimension)}]"
