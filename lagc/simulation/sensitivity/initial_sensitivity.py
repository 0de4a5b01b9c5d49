"""What a consistent start changes by with parameters and stated values: dx0/dtheta.

Stated values change as they are stated, and c(y, p) = 0 tells the rest: c_y dy + c_p dp = 0 in the unknowns
y = (q, v, stated rates).  Which of them moves, the search for the start tells, made once more beside.  Where
the conditions leave a choice, the search makes it, and its own differences tell what that changes by.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from lagc.simulation.initialization.conflicts import conditions_of
from lagc.simulation.initialization.solver import RUN, Consistency
from lagc.simulation.linearization.derivatives import DEPENDENT, Array, Point
from lagc.simulation.sensitivity.sensitivities import Direction
from lagc.simulation.system import OK

if TYPE_CHECKING:
    from lagc.simulation.backends.python import NumpySystem

BESIDE = 1e-4  # of its size: how far beside the search is made
LONGEST = (1e-2, 1e-3, 1e-4)  # the same, where the search is differenced: as far as there is a start
SHRINKING, DIFFERENCES = 1.4, 10
SMOOTH = 0.1  # of what the slopes tell: a search that goes elsewhere beside
MET = 1e-6  # of the terms of a condition, to first order; of the differences of a search that is smooth


def start_slopes(
    system: NumpySystem, x0: Sequence[float], given: Mapping[str, float], directions: Sequence[Direction]
) -> tuple[Array, Array, dict[int, str]]:
    """(nq + nv, directions) at the start x0, which was found where the run states `given`; how far each may
    be off where it is not exact; and why there is no derivative, of the directions that have none."""
    interface, n = system.interface, system.nq + system.nv
    point = Point(system, 0.0, x0[:n], [0.0] * system.nv, [0.0] * system.nc, clean=True)
    stated = [i for i, name in enumerate(system.interface.state_names) if name in given]
    found = np.zeros((n + len(interface.rate_names), len(directions)))
    doubts = np.zeros_like(found)
    for k, d in enumerate(directions):
        if d.parameter is not None:
            found[:, k] = point.partial("start", "parameter")[:, d.parameter]
            found[stated, k] = 0.0
        elif d.state is not None:
            found[d.state, k] = 1.0
    reasons: dict[int, str] = {}
    for k, d in enumerate(directions):
        try:
            if not np.isfinite(found[:, k]).all():
                raise ArithmeticError(f"the start values have no finite derivatives by `{d.name}`")
            if interface.needs_consistency:
                found[:, k], doubts[:, k] = _Consistent(point, d, given).slopes(found[:, k])
        except ArithmeticError as error:
            reasons[k] = str(error)
    return found[:n], doubts[:n], reasons


class _Consistent:
    """What one direction moves a start by that meets conditions."""

    def __init__(self, point: Point, direction: Direction, given: Mapping[str, float]):
        self.point, self.system, self.d, self.given = point, point.system, direction, given
        home = self._search(0.0)
        self.weights, self.size = np.array(home.weights), 1.0
        if direction.state is not None:
            self.size = abs(point.x[direction.state]) or home.weights[direction.state]
            self._demand_the_same(home)
        elif direction.parameter is not None:
            fields = [*self.system.interface.parameters, *self.system.interface.inputs]
            alike = [abs(value) for value, field in zip(self.system.parameters, fields)
                     if field.unit == direction.unit]  # fmt: skip
            self.size = abs(self.system.parameters[direction.parameter]) or max(alike) or 1.0

    def _demand_the_same(self, home: Consistency) -> None:
        """What is stated where the run starts leads there: raises ArithmeticError where it does not, as the
        search chose otherwise before it was stated."""
        x = np.array(self.point.x)
        if home.run() != OK or (np.abs(np.array(home.y)[: len(x)] - x) > MET * self.weights[: len(x)]).any():
            raise ArithmeticError(f"`{self.d.name}` was moved to meet conditions, and stated where it is now "
                                  "leads to another start: state it")  # fmt: skip

    def slopes(self, own: Array) -> tuple[Array, Array]:
        """Of the unknowns, where stated values alone would change by `own`; and how far these may be off."""
        doubts = np.zeros_like(own)
        rows, missed = self._conditions(own)
        above, below = self._reached(BESIDE), self._reached(-BESIDE)
        free = _moving(above)
        if self.d.state in free:
            raise ArithmeticError(f"`{self.d.name}` cannot be stated: conditions tell what it is")
        self._demand(free, _moving(below))
        way, rank = self._shortest(rows, missed, own, free)
        if rank < len(free):
            own[free], doubts[free] = self._chosen(free)
            way, _ = self._shortest(rows, missed, own, free)
        own[free] += self.weights[free] * way
        ahead = 2.0 * BESIDE * self.size * own
        apart = np.abs(np.array(above.y) - below.y - ahead) / self.weights
        if apart.max(initial=0.0) > SMOOTH * max(np.abs(ahead / self.weights).max(initial=0.0), 2.0 * BESIDE):
            raise ArithmeticError(f"the start that is found jumps beside, by `{self.d.name}`")
        return own, doubts

    def _conditions(self, own: Array) -> tuple[Array, Array]:
        """c_y, and c_p dp; of quaternions `own` keeps the length."""
        point, system, n = self.point, self.system, len(self.point.x)
        count, rates = len(point.value("condition")), len(own) - n
        rows = np.zeros((count + len(system.quaternions), len(own)))
        missed = np.zeros(len(rows))
        rows[:count, :n] = point.partial("condition", "state")
        for k in range(rates):
            rows[count - rates + k, n + k] = -1.0
        for k, first in enumerate(system.quaternions):
            q = np.array(point.x[first : first + 4])
            rows[count + k, first : first + 4] = q
            own[first : first + 4] -= q * (q @ own[first : first + 4])
        if self.d.parameter is not None:
            missed[:count] = point.partial("condition", "parameter")[:, self.d.parameter]
        if not (np.isfinite(rows).all() and np.isfinite(missed).all()):
            raise ArithmeticError(
                f"the conditions of the start have no finite derivatives by `{self.d.name}`"
            )
        return rows, missed

    def _shortest(self, rows: Array, missed: Array, own: Array, free: list[int]) -> tuple[Array, int]:
        """The shortest way of what is free, in its sizes, that meets the conditions where all moves by `own`,
        and their rank."""
        terms = np.abs(missed) + np.abs(rows) @ np.abs(own)
        missed = missed + rows @ own
        table = rows[:, free] * self.weights[free]
        lengths = np.abs(table).max(axis=1, initial=0.0)
        scale = 1.0 / np.where(lengths > 0.0, lengths, 1.0)
        way, _, rank, _ = np.linalg.lstsq(table * scale[:, None], -missed * scale, rcond=DEPENDENT)
        left = np.abs(table @ way + missed)
        rounding = DEPENDENT * np.abs(table).sum(axis=1) * np.abs(way).max(initial=0.0)
        if (left > MET * (terms + np.abs(table) @ np.abs(way)) + rounding).any():
            raise ArithmeticError(f"the start has no derivative by `{self.d.name}`: none beside meets the "
                                  "conditions")  # fmt: skip
        return way, int(rank)

    def _chosen(self, free: list[int]) -> tuple[Array, Array]:
        """What the search moves the unknowns `free` by, and how far that may be off."""

        def values(way: float) -> Array:
            search = self._reached(way)
            self._demand(free, _moving(search))
            return np.array(search.y)[free]

        for longest in LONGEST:
            try:
                found, doubt = _extrapolated(values, longest)
            except ArithmeticError:
                if longest == LONGEST[-1]:
                    raise
                continue
            sizes = np.maximum(np.abs(found), self.weights[free])
            if (doubt <= MET * sizes.max(initial=0.0)).all():
                return found / self.size, doubt / self.size
        raise ArithmeticError(f"the start that is found has no derivative by `{self.d.name}`")

    def _demand(self, free: list[int], others: list[int]) -> None:
        """Raises ArithmeticError where not the same values move on both sides."""
        if others == free:
            return
        known = [*self.system.interface.state_names, *self.system.interface.rate_names]
        one, two = (", ".join([f"`{known[i]}`" for i in a if i not in b]) or "nothing more"
                    for a, b in ((free, others), (others, free)))  # fmt: skip
        raise ArithmeticError(f"for a start beside, by `{self.d.name}`, {one} moves on one side and {two} on "
                              "another: state fewer of them")  # fmt: skip

    def _reached(self, way: float) -> Consistency:
        """The search so far beside, in the size of what is varied."""
        search = self._search(way * self.size)
        if search.run() != OK:
            raise ArithmeticError(f"there is no start beside, by `{self.d.name}`")
        return search

    def _search(self, way: float) -> Consistency:
        system, d = self.system, self.d
        parameters, states, known = list(system.parameters), dict(self.given), system.interface.state_names
        if d.parameter is not None:
            parameters[d.parameter] += way
        beside = system.model.bind(parameters)
        guess, levels = beside.start(), list(system.interface.start_levels)
        if d.state is not None:
            states[known[d.state]] = self.point.x[d.state] + way
        for i, name in enumerate(known):
            if name in states:
                guess[i], levels[i] = states[name], max(levels[i], RUN)
        return Consistency(conditions_of(beside), 0.0, guess, levels)


def _moving(search: Consistency) -> list[int]:
    return [i for i, moves in enumerate(search.free) if moves]


def _extrapolated(values: Callable[[float], Array], longest: float) -> tuple[Array, Array]:
    """The derivative of `values` at 0, and how far it may be off: central differences over ever shorter
    steps, extrapolated to none (C. J. F. Ridders, Adv. Eng. Software 4 (1982) 75)."""
    found: Array | float = inf
    doubt: Array | float = inf
    before, step = list[Array](), longest
    for _ in range(DIFFERENCES):
        row = [(values(step) - values(-step)) / (2.0 * step)]
        for j, last in enumerate(before):
            factor = SHRINKING ** (2 * j + 2)
            row.append((row[j] * factor - last) / (factor - 1.0))
            apart = np.maximum(np.abs(row[-1] - row[j]), np.abs(row[-1] - last))
            found, doubt = np.where(apart < doubt, row[-1], found), np.minimum(apart, doubt)
        before, step = row, step / SHRINKING
    return np.asarray(found), np.asarray(doubt)
