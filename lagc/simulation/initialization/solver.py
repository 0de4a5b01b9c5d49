"""The search for a consistent start of any conditions, by the kernels of generated code."""

from __future__ import annotations

from _thread import RLock
from array import array
from collections.abc import Callable, Sequence
from functools import lru_cache
from types import SimpleNamespace
from typing import Any, TypeAlias

from lagc.base.records import once
from lagc.codegen.kernel_compiler.linker import (
    marked,
    of_conditions,
    sizes_of_start,
    stretches,
    with_quaternions,
)
from lagc.codegen.python.initialization import FLAGS, code
from lagc.simulation.system import OK, UNSTATED

MET = 8  # points whose conditions are remembered: a search of all of them comes back, two times of three

Found: TypeAlias = tuple[list[float], list[float], list[float]]
Evaluate: TypeAlias = Callable[[float, Sequence[float]], Found]


class Conditions:
    """The conditions of a consistent start.

    `evaluate(t, x)` returns c, J and sizes: residuals, derivatives row by row (row i ends at `ends[i]`;
    `columns` are their unknowns), sizes of the terms. `measures()`: the stated rates, and the largest
    parameter of each unit. `elsewhere(p)` is `evaluate` with other parameters. `units[i]` is the number of
    the unit of unknown i; `angles` are the coordinates that are angles. If conditions consist of blocks
    without common unknowns, `pieces[i]` is the block of condition i (-1: none), and `some(t, x, c, J, sizes,
    first, last)` evaluates some of them. `massless` are the speeds without inertia."""

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
        parameters: Sequence[float] = (),
        elsewhere: Callable[[Sequence[float]], Evaluate] | None = None,
        pieces: Sequence[int] = (),
        some: Callable[..., None] | None = None,
        massless: Sequence[int] = (),
    ):
        self.nq, self.nv, self.quaternions = nq, nv, tuple(quaternions)
        self.units, self.angles = tuple(units), tuple(angles)
        self.n, self.own = len(units), len(ends)
        self.sizes = sizes_of_start(
            nq, nv, self.n - nq - nv, ends, columns, quaternions, pieces, len(massless)
        )
        self.massless = marked(nq, massless, self.n)
        self.ends, self.columns = with_quaternions(ends, columns, quaternions)
        self.row_pieces = of_conditions(pieces, len(self.ends))
        self.evaluate, self.measures = evaluate, measures
        self.parameters, self.elsewhere = list(parameters), elsewhere
        self.some = some
        self._met = lru_cache(MET)(self._evaluated)
        self.lock = RLock()

    def columns_of(self, i: int) -> list[int]:
        """The unknowns in condition i."""
        return self.columns[self.ends[i - 1] if i > 0 else 0 : self.ends[i]]

    @once
    def kernels(self) -> dict[str, Any]:
        """The kernels of the search, with the sizes, tables and functions of these conditions."""
        begins, stops = stretches(self.ends, self.columns)
        found: dict[str, Any] = {
            **self.sizes, "NP": len(self.parameters), "NALL": len(self.parameters),
            "quaternion": self.quaternions, "level": (UNSTATED,) * self.n, "unit": self.units,
            "angle": tuple([int(i in self.angles) for i in range(self.n)]), "ends": self.ends,
            "stretch_begins": begins, "stretch_ends": stops,
            "row_piece": self.row_pieces, "massless": self.massless, "fn_measures": self._measures,
            "fn_conditions": self._conditions, "fn_conditions_some": self._some,
        }  # fmt: skip
        exec(code(tuple([found[name] > 0 for name in FLAGS])), found)
        return found

    def _conditions(self, p: list[float], t: float, y: list[float], c: list[float], jacobian: list[float],
                    sizes: list[float]) -> None:  # fmt: skip
        changed = self.elsewhere is not None and p is not self.parameters
        x = array("d", y[: self.nq + self.nv])
        found = self._met(array("d", p).tobytes() if changed else b"", t, x.tobytes())
        c[: self.own], jacobian[: len(found[1])], sizes[: self.own] = found

    def _some(self, p: list[float], t: float, y: list[float], c: list[float], jacobian: list[float],
              sizes: list[float], first: int, last: int) -> None:  # fmt: skip
        """The same of the pieces first..last-1, written where it belongs."""
        if self.elsewhere is not None and p is not self.parameters:
            self._conditions(p, t, y, c, jacobian, sizes)
        else:
            assert self.some is not None
            self.some(t, y, c, jacobian, sizes, first, last)

    def _evaluated(self, p: bytes, t: float, x: bytes) -> tuple[list[float], list[float], list[float]]:
        """`evaluate` at these doubles, -0.0 apart from 0.0; with parameters p where there are any."""
        evaluate = self.evaluate
        if p and self.elsewhere is not None:
            evaluate = self.elsewhere(array("d", p).tolist())
        return evaluate(t, array("d", x).tolist())

    def _measures(self, p: list[float], rates: list[float], largest: list[float]) -> None:
        s, most = self.measures()
        rates[: len(s)], largest[: len(most)] = s, most


class Consistency:
    """The search for values near the guess `x` at time t that meet the conditions. `levels` of q, v and the
    stated rates; `given` are the conditions that count (None: all). Afterwards `y` is the best point, `free`
    the unknowns that might move, `culprit` the row with the largest residual or the unknown that is not
    finite, and `rows`, after a failure, the block that cannot be met."""

    def __init__(self, conditions: Conditions, t: float, x: Sequence[float], levels: Sequence[int],
                 given: Sequence[int] | None = None):  # fmt: skip
        self.conditions, self.t = conditions, t
        self.kernels, self.n = conditions.kernels, conditions.n
        self.work_space = self.kernels["StartWork"]()
        self.status: int = self.kernels["prepare"](conditions.parameters, t, x, levels, self.work_space)
        self.has_begun = self.status == OK  # else `culprit` is what of the guess has no value or no direction
        if not self.has_begun:
            self.work_space.y[:] = self.work_space.guess
        elif given is not None:
            self.work_space.selected[: len(given)] = given
            self.kernels["select_equations"](len(given), self.work_space)

    def run(self) -> int:
        """OK, INCONSISTENT or NOT_FINITE."""
        if self.has_begun:
            self.status = self.kernels["reach_start"](self.conditions.parameters, self.t, self.work_space)
        return self.status

    def solve(self, first: int, end: int) -> bool:
        """Whether attempts first..end-1 alone lead to a start, what is free moving."""
        found: bool = self.has_begun and self.kernels["multistart"](
            self.conditions.parameters, self.t, first, end, self.work_space
        )
        return found

    def evaluate(self, y: Sequence[float]) -> tuple[list[float], list[float], list[float]]:
        """Residuals, derivatives and sizes of the terms of all conditions."""
        m = len(self.conditions.ends)
        found = [0.0] * m, [0.0] * len(self.conditions.columns), [0.0] * m
        self.kernels["evaluate_all"](self.conditions.parameters, self.t, y, *found)
        return found

    @property
    def y(self) -> list[float]:
        return list(self.work_space.y)

    @property
    def guess(self) -> list[float]:
        return list(self.work_space.guess)

    @property
    def weights(self) -> list[float]:
        return list(self.work_space.scaling)

    @property
    def levels(self) -> list[int]:
        return list(self.work_space.levels)

    @property
    def free(self) -> list[bool]:
        return [free == 1 for free in self.work_space.free]

    @property
    def part(self) -> list[bool]:
        """Of a quaternion, behind its first."""
        return [part == 1 for part in self.work_space.part]

    @property
    def rows(self) -> list[int]:
        return list(self.work_space.rows[: self.work_space.row_count])

    @property
    def culprit(self) -> int:
        return int(self.work_space.culprit)

    @property
    def work(self) -> int:
        return int(self.work_space.work)


def least_norm(rows: Sequence[Sequence[float]], right: Sequence[float], dependent: float) -> list[float]:
    """Return the shortest y with rows . y = right; empty if a number is not finite. Dependent rows (to
    `dependent` of their length) are left out, the row with the longest remainder coming next."""
    kernels: dict[str, Any] = {}
    exec(code((False,) * len(FLAGS)), kernels)
    m, n = len(rows), len(rows[0])
    filled = [[j for j, value in enumerate(row) if value != 0.0] for row in rows]
    line = list(dict.fromkeys([*(j for own in filled for j in own), *range(n)]))  # so that rows are narrow
    place = {j: k for k, j in enumerate(line)}
    ends = [(min(own), max(own) + 1) if own else (0, 0) for own in ([place[j] for j in f] for f in filled)]
    work_space = SimpleNamespace(
        matrix=[[row[j] for j in line] for row in rows],
        orthogonal=[[0.0] * n for _ in rows], right=list(right),
        first_column=[begin for begin, _ in ends], end_column=[stop for _, stop in ends],
        first_counts=[0] * (n + 1), tournament=[0] * (2 * m), remaining=[0.0] * m, step=[0.0] * n,
        **{name: [0] * m for name in ("first_nonzero", "end_nonzero", "by_first", "reach_so_far",
                                      "neighbours", "chosen")},
    )  # fmt: skip
    if not kernels["least_norm"](work_space, m, n, dependent, 0.0):
        return []
    return [work_space.step[place[j]] for j in range(n)]
