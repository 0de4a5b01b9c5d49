"""Integration methods as arrays, for what is integrated along the steps of a motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import cache
from importlib import import_module
from typing import Any

import numpy as np

from lagc.base.records import dataclass
from lagc.simulation.linearization.derivatives import Array


@dataclass(frozen=True)
class Tableau:
    """k_i = f(t + c_i h, x + h sum a_ij k_j), x1 = x + h sum b_i k_i.  Rows go over the stages, the rate at
    the new state and the stages of dense output, see `lagc.kernels.integrators.tableaus`."""

    order: int
    c: Array
    a: list[Array]
    b: Array
    error: list[Array]
    extra_c: Array
    extra_a: list[Array]
    dense: list[Array]

    @property
    def stages(self) -> int:
        return len(self.c)

    def error_of(self, table: Array, h: float) -> Array:
        """The error of a step, entry by entry; `table` are the rates at stages and new state."""
        first, *others = (h * combined(row, table) for row in self.error)
        if not others:
            return np.abs(first)
        size = np.hypot(first, 0.1 * others[0])
        return np.divide(np.square(first), size, out=np.zeros_like(size), where=size > 0.0)

    def coefficients(self, old: Array, new: Array, table: Array, h: float) -> list[Array]:
        """Of dense output of a step, `table` with the stages for it."""
        way, first, last = new - old, table[0], table[self.stages]
        bend = h * first - way
        return [old, way, bend, way - h * last - bend, *(h * combined(row, table) for row in self.dense)]


def within(coefficients: Sequence[Array], part: float) -> Array:
    """Dense output at this part of a step."""
    *lower, value = coefficients
    for j in range(len(lower) - 1, -1, -1):
        value = lower[j] + (part if j % 2 == 0 else 1.0 - part) * value
    return value


def combined(row: Array, table: Array) -> Array:
    found: Array = np.tensordot(row, table[: len(row)], 1)
    return found


@cache
def tableau(method: str) -> Tableau:
    m: Any = import_module(f"lagc.kernels.integrators.tableaus.{method}")
    n = len(m.C)
    full = n + 1 + len(m.EXTRA_C)
    return Tableau(
        m.ORDER, _numbers(m.C), [_row(row, k) for k, row in enumerate(m.A)], _row(m.B, n),
        [_row(row, n + 1) for row in m.ERROR], _numbers(m.EXTRA_C),
        [_row(row, n + 1 + k) for k, row in enumerate(m.EXTRA_A)], [_row(row, full) for row in m.DENSE],
    )  # fmt: skip


def _numbers(texts: Sequence[str]) -> Array:
    return np.array([float(Fraction(text)) for text in texts])


def _row(entries: Mapping[int, str], length: int) -> Array:
    found = np.zeros(length)
    for place, text in entries.items():
        found[place - 1] = float(Fraction(text))
    return found
