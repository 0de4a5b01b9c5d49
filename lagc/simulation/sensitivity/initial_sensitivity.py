"""Derivatives of a consistent initial state by parameters and stated values: dx0/dtheta.

Stated values change as stated.  The initial equations c(y, p) = 0 determine the rest: c_y dy + c_p dp = 0
in the unknowns y = (q, v, stated rates).  A repeated search for the initial state at a nearby value tells
which unknowns move.  If the equations leave a choice, differences of the search tell how it changes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from lagc.simulation.initialization.conflicts import conditions_of
from lagc.simulation.initialization.initialize import guess_and_levels
from lagc.simulation.initialization.solver import Consistency
from lagc.simulation.linearization.derivatives import DEPENDENT, Array, Point
from lagc.simulation.sensitivity.differences import derivative_by_differences, size_of
from lagc.simulation.sensitivity.sensitivities import Direction
from lagc.simulation.system import OK

if TYPE_CHECKING:
    from lagc.simulation.backends.python import NumpySystem

NEARBY = 1e-4  # of the size of the value: the offset of a nearby search
LONGEST = (1e-2, 1e-3, 1e-4)  # the same for differences of searches
DIFFERENCES = 10
SMOOTH = 0.1  # of the predicted change: a larger deviation means that the search jumps
MET = 1e-6  # of the terms of an equation; of the differences of a smooth search


def start_slopes(
    system: NumpySystem,
    x0: Sequence[float],
    given: Mapping[str, float],
    directions: Sequence[Direction],
    guesses: Mapping[str, float],
) -> tuple[Array, Array, dict[int, str]]:
    """Return dx0/dtheta at the initial state x0, (nq + nv, directions), its error, and reasons. `given` are
    the initial values stated for the run.  The error is 0 where the derivative is exact.  The reasons tell
    why a direction (by its index) has no derivative."""
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
                raise ArithmeticError(f"the initial values have no finite derivatives by `{d.name}`")
            if interface.needs_consistency:
                found[:, k], doubts[:, k] = _Consistent(point, d, given, guesses).slopes(found[:, k])
        except ArithmeticError as error:
            reasons[k] = str(error)
    return found[:n], doubts[:n], reasons


class _Consistent:
    """The derivative of an initial state that satisfies equations, in one direction."""

    def __init__(self, point: Point, direction: Direction, given: Mapping[str, float],
                 guesses: Mapping[str, float]):  # fmt: skip
        self.point, self.system, self.d = point, point.system, direction
        self.given, self.guesses = given, guesses
        base = self._search(0.0)
        self.weights, self.size = np.array(base.space.scaling), 1.0
        if direction.state is not None:
            self.size = abs(point.x[direction.state]) or base.space.scaling[direction.state]
            self._demand_the_same(base)
        elif direction.parameter is not None:
            self.size = size_of(self.system, direction)

    def _demand_the_same(self, base: Consistency) -> None:
        """Raise ArithmeticError if stating the present value leads to another initial state."""
        x = np.array(self.point.x)
        if base.run() != OK or (np.abs(np.array(base.y)[: len(x)] - x) > MET * self.weights[: len(x)]).any():
            raise ArithmeticError(f"`{self.d.name}` was changed by the initialization, and stating its "
                                  "present value leads to another initial state: state it")  # fmt: skip

    def slopes(self, own: Array) -> tuple[Array, Array]:
        """The derivatives of the unknowns and their errors, if stated values change by `own`."""
        doubts = np.zeros_like(own)
        rows, residual = self._conditions(own)
        above, below = self._reached(NEARBY), self._reached(-NEARBY)
        free = _moving(above)
        if self.d.state in free:
            raise ArithmeticError(f"`{self.d.name}` cannot be stated: the initial equations determine it")
        self._demand(free, _moving(below))
        offset, rank = self._shortest(rows, residual, own, free)
        if rank < len(free):
            own[free], doubts[free] = self._chosen(free)
            offset, _ = self._shortest(rows, residual, own, free)
        own[free] += self.weights[free] * offset
        ahead = 2.0 * NEARBY * self.size * own
        apart = np.abs(np.array(above.y) - below.y - ahead) / self.weights
        if apart.max(initial=0.0) > SMOOTH * max(np.abs(ahead / self.weights).max(initial=0.0), 2.0 * NEARBY):
            raise ArithmeticError(f"the initial state is discontinuous in `{self.d.name}`")
        return own, doubts

    def _conditions(self, own: Array) -> tuple[Array, Array]:
        """Return c_y and c_p dp; makes `own` keep the length of quaternions."""
        point, system, n = self.point, self.system, len(self.point.x)
        count, rates = len(point.value("condition")), len(own) - n
        rows = np.zeros((count + len(system.quaternions), len(own)))
        residual = np.zeros(len(rows))
        rows[:count, :n] = point.partial("condition", "state")
        for k in range(rates):
            rows[count - rates + k, n + k] = -1.0
        for k, first in enumerate(system.quaternions):
            q = np.array(point.x[first : first + 4])
            rows[count + k, first : first + 4] = q
            own[first : first + 4] -= q * (q @ own[first : first + 4])
        if self.d.parameter is not None:
            residual[:count] = point.partial("condition", "parameter")[:, self.d.parameter]
        if not (np.isfinite(rows).all() and np.isfinite(residual).all()):
            raise ArithmeticError(f"the initial equations have no finite derivatives by `{self.d.name}`")
        return rows, residual

    def _shortest(self, rows: Array, residual: Array, own: Array, free: list[int]) -> tuple[Array, int]:
        """The smallest change of the free unknowns, relative to their sizes, that satisfies the equations
        when all unknowns change by `own`; and the rank."""
        terms = np.abs(residual) + np.abs(rows) @ np.abs(own)
        residual = residual + rows @ own
        table = rows[:, free] * self.weights[free]
        lengths = np.abs(table).max(axis=1, initial=0.0)
        scale = 1.0 / np.where(lengths > 0.0, lengths, 1.0)
        offset, _, rank, _ = np.linalg.lstsq(table * scale[:, None], -residual * scale, rcond=DEPENDENT)
        left = np.abs(table @ offset + residual)
        rounding = DEPENDENT * np.abs(table).sum(axis=1) * np.abs(offset).max(initial=0.0)
        if (left > MET * (terms + np.abs(table) @ np.abs(offset)) + rounding).any():
            raise ArithmeticError(f"the initial state has no derivative by `{self.d.name}`: no nearby "
                                  "one satisfies the initial equations")  # fmt: skip
        return offset, int(rank)

    def _chosen(self, free: list[int]) -> tuple[Array, Array]:
        """The derivatives of the `free` unknowns by differences of the search, and their errors."""

        def values(offset: float) -> Array:
            search = self._reached(offset)
            self._demand(free, _moving(search))
            return np.array(search.y)[free]

        for longest in LONGEST:
            try:
                found, doubt = derivative_by_differences(values, longest, DIFFERENCES)
            except ArithmeticError:
                if longest == LONGEST[-1]:
                    raise
                continue
            sizes = np.maximum(np.abs(found), self.weights[free])
            if (doubt <= MET * sizes.max(initial=0.0)).all():
                return found / self.size, doubt / self.size
        raise ArithmeticError(f"the initial state has no derivative by `{self.d.name}`")

    def _demand(self, free: list[int], others: list[int]) -> None:
        """Raise ArithmeticError if other unknowns move on the other side."""
        if others == free:
            return
        known = [*self.system.interface.state_names, *self.system.interface.rate_names]
        one, two = (", ".join([f"`{known[i]}`" for i in a if i not in b]) or "nothing more"
                    for a, b in ((free, others), (others, free)))  # fmt: skip
        raise ArithmeticError(f"when `{self.d.name}` changes, {one} moves on one side and {two} on the "
                              "other: state fewer of them")  # fmt: skip

    def _reached(self, offset: float) -> Consistency:
        """The search at a nearby value, relative to the size of the value."""
        search = self._search(offset * self.size)
        if search.run() != OK:
            raise ArithmeticError(f"there is no initial state for nearby values of `{self.d.name}`")
        return search

    def _search(self, offset: float) -> Consistency:
        system, d = self.system, self.d
        parameters, states, known = list(system.parameters), dict(self.given), system.interface.state_names
        if d.parameter is not None:
            parameters[d.parameter] += offset
        beside = system.model.bind(parameters)
        if d.state is not None:
            states[known[d.state]] = self.point.x[d.state] + offset
        guess, levels = guess_and_levels(system, beside.start(), states, self.guesses)
        return Consistency(conditions_of(beside), 0.0, guess, levels)


def _moving(search: Consistency) -> list[int]:
    return [i for i, moves in enumerate(search.space.free) if moves == 1]
