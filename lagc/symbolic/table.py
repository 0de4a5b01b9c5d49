"""Numbers that a function looks up."""

from __future__ import annotations

import struct
from bisect import bisect_right
from collections.abc import Iterator, Sequence

from lagc.host import cache


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
