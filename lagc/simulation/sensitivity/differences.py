"""Derivatives by differences that are extrapolated to zero, with an estimate of their error."""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from lagc.simulation.linearization.derivatives import Array
    from lagc.simulation.sensitivity.sensitivities import Direction
    from lagc.simulation.system import System

SHRINKING = 1.4  # from one step of the differences to the next (Ridders)


def derivative_by_differences(
    values: Callable[[float], Array], longest: float, count: int
) -> tuple[Array, Array]:
    """The derivative of `values` at 0 and its error, by `count` central differences extrapolated to step 0
    (C. J. F. Ridders, Adv. Eng. Software 4, 1982, p. 75)."""
    found: Array | float = inf
    doubt: Array | float = inf
    before: list[Array] = []
    step = longest
    for _ in range(count):
        row = [(values(step) - values(-step)) / (2.0 * step)]
        for j, last in enumerate(before):
            factor = SHRINKING ** (2 * j + 2)
            row.append((row[j] * factor - last) / (factor - 1.0))
            apart = np.maximum(np.abs(row[-1] - row[j]), np.abs(row[-1] - last))
            found, doubt = np.where(apart < doubt, row[-1], found), np.minimum(apart, doubt)
        before, step = row, step / SHRINKING
    return np.asarray(found), np.asarray(doubt)


def size_of(system: System, direction: Direction) -> float:
    """The size of the parameter of a direction: its value, or the largest of its unit, or 1."""
    fields = [*system.interface.parameters, *system.interface.inputs]
    assert direction.parameter is not None
    alike = [abs(v) for v, field in zip(system.parameters, fields) if field.unit == direction.unit]
    return abs(system.parameters[direction.parameter]) or max(alike) or 1.0
