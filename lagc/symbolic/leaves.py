"""What a leaf of the graph stands for, and what it is called."""

from __future__ import annotations

import struct
from bisect import bisect_right
from collections.abc import Iterator, Sequence

from lagc.base.records import dataclass, replace
from lagc.host import cache

QUANTITIES = ("energy", "kinetic", "potential", "power", "momentum", "angular_momentum")
_RATES = {"coordinate": "rate", "rate": "acceleration", "speed": "acceleration"}


@dataclass(frozen=True, slots=True)
class Symbol:
    """`kind` keeps name spaces apart; `owner` is the name of what it belongs to, `component` which of its
    components it is; `order` counts the time derivatives of what these two name."""

    kind: str
    owner: str = ""
    component: str = ""
    order: int = 0

    @property
    def is_body_rate(self) -> bool:
        """Whether it is a body rate of an orientation, or the acceleration of one."""
        return self.component != "" and self.kind in ("rate", "acceleration")

    @property
    def derivative(self) -> Symbol:
        """The symbol of its time derivative."""
        return replace(self, kind=_RATES[self.kind], order=self.order + 1)

    @property
    def base(self) -> str:
        """Its name without time derivatives."""
        owner = f"{self.kind}({self.owner})" if self.kind in QUANTITIES else self.owner
        part = f"rate.{self.component}" if self.is_body_rate else self.component
        return f"{owner}.{part}" if part else owner

    @property
    def name(self) -> str:
        return derived(self.base, self.order)


def derived(name: str, order: int = 1) -> str:
    """A name with so many time derivatives, as in the language: `der(theta)`."""
    return "der(" * order + name + ")" * order


def underived(name: str) -> str:
    """`theta` of `der(theta)`, where a person wrote it."""
    return name.removeprefix("der(").removesuffix(")") if name.startswith("der(") else name


def digest(numbers: Sequence[float]) -> str:
    """A name for `numbers`."""
    return cache.digest(struct.pack(f"<{len(numbers)}d", *numbers))


class Curve:
    """A function through points: `rows` of the coefficients of its pieces, of powers of the way from the left
    end.  `name` is what people call it, `key` which it is."""

    __slots__ = ("key", "name", "rows")

    def __init__(self, name: str, key: str):
        self.name, self.key = name, key
        self.rows: list[Table] = []


class Table:
    """Numbers that stand once in generated code: knots, or the row of a `curve` with the coefficients of
    power `order`.  Two of the same are one."""

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
        """The last place whose number is not above x; 0 where there is none."""
        return float(max(bisect_right(self.numbers, x) - 1, 0))

    def entry(self, place: float) -> float:
        return self.numbers[int(place)]
