"""Leaves of the graph: symbols with their names, and tables of numbers."""

from __future__ import annotations

import struct
from bisect import bisect_right
from collections.abc import Iterator, Sequence

from lagc.base.records import dataclass, replace
from lagc.host import cache

QUANTITIES = (
    "energy", "kinetic", "potential", "power", "momentum", "angular_momentum", "generalized_force",
    "reaction",
)  # fmt: skip
_RATES = {"coordinate": "rate", "rate": "acceleration", "speed": "acceleration"}


@dataclass(frozen=True, slots=True)
class Symbol:
    """A symbol: `kind` separates name spaces, `owner` is the object, `component` its part, `order` counts
    time derivatives."""

    kind: str
    owner: str = ""
    component: str = ""
    order: int = 0

    @property
    def is_body_rate(self) -> bool:
        """Whether it is a body rate of an orientation, or its derivative."""
        return self.component != "" and self.kind in ("rate", "acceleration")

    @property
    def derivative(self) -> Symbol:
        return replace(self, kind=_RATES[self.kind], order=self.order + 1)

    @property
    def base(self) -> str:
        """Return the name without time derivatives."""
        kind = "reaction" if self.kind == "multiplier" else self.kind
        owner = f"{kind}({self.owner})" if kind in QUANTITIES else self.owner
        part = f"rate.{self.component}" if self.is_body_rate else self.component
        return f"{owner}.{part}" if part else owner

    @property
    def name(self) -> str:
        return derived(self.base, self.order)


def derived(name: str, order: int = 1) -> str:
    """Return a name with `order` time derivatives, as in the language: `der(theta)`."""
    return "der(" * order + name + ")" * order


def underived(name: str) -> str:
    """Return `theta` for `der(theta)` as written by the user."""
    return name.removeprefix("der(").removesuffix(")") if name.startswith("der(") else name


def digest(numbers: Sequence[float]) -> str:
    return cache.digest(struct.pack(f"<{len(numbers)}d", *numbers))


class Curve:
    """An interpolated function: `rows` are the coefficients of its pieces by power; `key` identifies it."""

    __slots__ = ("key", "name", "rows")

    def __init__(self, name: str, key: str):
        self.name, self.key = name, key
        self.rows: list[Table] = []


class Table:
    """Numbers stored once in generated code: knots, or the coefficients of power `order` of a `curve`. Tables
    with the same key are equal."""

    __slots__ = ("curve", "is_constant", "key", "numbers", "order")

    def __init__(self, numbers: Sequence[float], curve: Curve | None = None, order: int = 0):
        self.numbers = tuple([x + 0.0 for x in numbers])
        self.curve, self.order = curve, order
        self.is_constant = len(set(self.numbers)) == 1
        self.key = digest(self.numbers) if curve is None else cache.key(curve.key, str(order))

    @property
    def name(self) -> str:
        return f"knots_{self.key[:6]}" if self.curve is None else f"{self.curve.name}{self.order}"

    def __len__(self) -> int:
        return len(self.numbers)

    def __getitem__(self, k: int) -> float:
        return self.numbers[k]

    def __iter__(self) -> Iterator[float]:
        return iter(self.numbers)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Table) and self.key == other.key

    def __hash__(self) -> int:
        return hash(self.key)

    def __repr__(self) -> str:
        return f"Table {self.key}"

    def piece(self, x: float) -> float:
        """Return the last position whose number is not above x, or 0."""
        return float(max(bisect_right(self.numbers, x) - 1, 0))

    def entry(self, place: float) -> float:
        return self.numbers[int(place)]
