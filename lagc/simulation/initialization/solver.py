"""The search for a consistent start of any conditions, by the kernels of generated code."""

from __future__ import annotations

from _thread import RLock
from array import array
from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any, TypeAlias

from lagc.base.records import once
from lagc.codegen.python.initialization import FLAGS, code
from lagc.codegen.sizes import marked, sizes_of_start, stretches, with_quaternions
from lagc.simulation.system import OK, UNSTATED

MET = 8  # points whose conditions are remembered: searches for a conflict begin at the same

Found: TypeAlias = tuple[list[float], list[float], list[float]]
Evaluate: TypeAlias = Callable[[float, Sequence[float]], Found]


class Conditions:
    """The conditions of a consistent start.

    `evaluate(t, x)` returns c, J and sizes: residuals, derivatives row by row (row i ends at `ends[i]`;
    `columns` are their unknowns), sizes of the terms. `measures()`: the stated rates, and the largest
    parameter of each unit. `units[i]` is the number of the unit of unknown i; `angles` are the coordinates
    that are angles. `massless` are the speeds without inertia."""

    def __init__(
        self,
        nq: int,
        nv: int,
        quaternions: Sequence[int],
        units: Sequence[int],
        angles: Sequence[int],
        ends: Sequence[int],
        columns: Sequence[int],
        evaluate: Evaluate,
        measures: Callable[[], tuple[list[float], list[float]]],
        massless: Sequence[int] = (),
    ):
        self.nq, self.nv, self.quaternions = nq, nv, tuple(quaternions)
        self.units, self.angles = tuple(units), frozenset(angles)
        self.n, self.own, self.evaluate, self.measures = len(units), len(ends), evaluate, measures
        rates = self.n - nq - nv
        self.sizes = sizes_of_start(nq, nv, rates, ends, columns, quaternions, len(massless))
        self.massless = marked(nq, massless, self.n)
        self.ends, self.columns = with_quaternions(ends, columns, quaternions)
        self._met = lru_cache(MET)(lambda t, x: evaluate(t, array("d", x).tolist()))
        self.lock = RLock()

    def entries_of(self, i: int) -> range:
        """The places of the derivatives of condition i; `columns` are their unknowns."""
        return range(self.ends[i - 1] if i > 0 else 0, self.ends[i])

    def columns_of(self, i: int) -> set[int]:
        """The unknowns in condition i."""
        return {self.columns[entry] for entry in self.entries_of(i)}

    def whole(self, i: int) -> tuple[int, ...]:
        """The unknowns that move together with i: the parts of a quaternion."""
        for k in self.quaternions:
            if k <= i < k + 4:
                return (k, k + 1, k + 2, k + 3)
        return (i,)

    @once
    def kernels(self) -> dict[str, Any]:
        """The kernels of the search, with the sizes, tables and functions of these conditions."""
        begins, stops = stretches(self.ends, self.columns)
        found: dict[str, Any] = {
            **self.sizes, "quaternion": self.quaternions, "level": (UNSTATED,) * self.n, "unit": self.units,
            "angle": tuple([int(i in self.angles) for i in range(self.n)]), "ends": self.ends,
            "stretch_begins": begins, "stretch_ends": stops, "massless": self.massless,
            "fn_measures": self._measures, "fn_conditions": self._conditions,
        }  # fmt: skip
        exec(code(tuple([found[name] > 0 for name in FLAGS])), found)
        return found

    def _conditions(self, p: object, t: float, y: list[float], c: list[float], jacobian: list[float],
                    sizes: list[float]) -> None:  # fmt: skip
        found = self._met(t, array("d", y[: self.nq + self.nv]).tobytes())  # -0.0 apart from 0.0
        c[: self.own], jacobian[: len(found[1])], sizes[: self.own] = found

    def _measures(self, p: object, rates: list[float], largest: list[float]) -> None:
        s, most = self.measures()
        rates[: len(s)], largest[: len(most)] = s, most


class Consistency:
    """The search for values near the guess `x` at time t that meet the conditions.

    `levels` are those of q, v and the stated rates; `given` are the conditions that count (None: all).
    Afterwards `space`, the workspace of the kernels, has in `y` the point that was found, else the last one;
    in `free` 1 for the unknowns that might move; in `culprit` the condition with the largest residual, or the
    unknown that is not finite; in `work` the number of factorizations."""

    def __init__(self, conditions: Conditions, t: float, x: Sequence[float], levels: Sequence[int],
                 given: Sequence[int] | None = None):  # fmt: skip
        self.conditions, self.t, self.n = conditions, t, conditions.n
        self.kernels = conditions.kernels
        self.space = self.kernels["StartWork"]()
        self.status: int = self.kernels["prepare"]([], t, x, levels, self.space)
        self.has_begun = self.status == OK  # else `culprit` is what of the guess has no value or no direction
        if not self.has_begun:
            self.space.y[:] = self.space.guess
        elif given is not None:
            asked = set(given)
            self.space.asked[:] = [int(i in asked) for i in range(len(conditions.ends))]
            self.kernels["select_equations"](self.space)

    def run(self) -> int:
        """OK, INCONSISTENT or NOT_FINITE."""
        if self.has_begun:
            self.status = self.kernels["reach_start"]([], self.t, self.space)
        return self.status

    def evaluate(self, y: Sequence[float]) -> Found:
        """Residuals, derivatives and sizes of the terms of all conditions."""
        space = self.space
        self.kernels["evaluate"]([], self.t, y, space)
        return list(space.c), list(space.J), list(space.term_sizes)

    @property
    def y(self) -> list[float]:
        return list(self.space.y)
