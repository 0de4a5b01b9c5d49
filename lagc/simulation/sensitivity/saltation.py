"""What the change of a switch moves the sensitivities S of a motion by.

At its time, which moves by dt = -(g_x S + g_theta)/(g_x f- + g_t) as its side g is 0 there, the motion
x + f- dt is x+ + f+ dt, where x+ are new values or the same.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from lagc.simulation.linearization.derivatives import Array, Point
from lagc.simulation.system import FAILED

if TYPE_CHECKING:
    from lagc.simulation.backends.python import NumpySystem

SLOWEST = 1e-7  # of its terms: the rate of a side that only touches its change
ROUNDED = 1e-14  # of the terms of a side: less is none
LOCATED = 1e-6  # of a step: how far from its end a change may be that it ends at
ALIKE = 1e-6  # times of one change, relative


class Stopped(Exception):
    """Why S ends before the motion does, in the directions `lost`: where there are none, in all."""

    def __init__(self, reason: str, lost: Iterable[int] = ()):
        super().__init__(reason)
        self.lost = list(lost)


class Changes:
    def __init__(self, system: NumpySystem, directions: Sequence[int], columns: Sequence[int]):
        """`directions` are by the parameters `columns`."""
        self.system, self.by_p, self.columns = system, list(directions), list(columns)

    def beyond(self, s: Any, now: Array, before: Sequence[float], jumped: bool) -> tuple[Array, Array]:
        """S behind a change from the modes `before`, of the motion `s` that has just made it, and the sum of
        the sizes of its terms; `now` is that ahead of it.  Raises Stopped where there is none."""
        system, n = self.system, self.system.nq + self.system.nv
        point = Point(system, s.t, end_of_step(s, system)[:n], modes=before)
        first, second = np.array([*point.value("qdot"), *point.a]), [0.0] * system.nx
        if system.rhs_on(list(s.modes), s.t, s.x, second, [0.0] * system.nc) in FAILED:
            raise Stopped("the motion is not determined")
        rates = np.array(second[:n])
        if not (jumped or (first != rates).any()):
            return now, np.zeros_like(now)
        way = self._way(point, now, first, s)
        moved, terms = now + np.outer(first, way), np.abs(now) + np.abs(np.outer(first, way))
        if jumped:
            moved, terms = self._renewed(point, moved, terms, way, s.acted[: s.acts])
        return moved - np.outer(rates, way), terms + np.abs(np.outer(rates, way))

    def refuse_at_start(self, point: Point, now: Array) -> None:
        """Where a motion begins on the change of a condition, and what is varied moves it off, its derivative
        is another on each side."""
        interface, sides = self.system.interface, point.value("indicator")
        by_x, by_t = point.partial("indicator", "state"), point.partial("indicator", "time")[:, 0]
        terms = np.abs(by_x) @ np.abs(np.array(point.x)) + np.abs(by_t * point.t)
        terms += np.abs(point.partial("indicator", "parameter")) @ np.abs(np.array(self.system.parameters))
        moved, sizes = self._moved(point, now)
        for k, counted in enumerate(interface.counted_switches):
            touches = not counted and abs(sides[k]) <= ROUNDED * terms[k]
            lost = np.flatnonzero(np.abs(moved[k]) > ALIKE * sizes[k])
            if touches and lost.size and self._matters(point, k):
                words = interface.switches[k]
                raise Stopped(f"`{words}` at the start itself: another derivative on each side", lost)

    def _matters(self, point: Point, k: int) -> bool:
        """Whether the motion, or what clauses `when` wait for, is another on each side of a switch."""
        modes = self.system.modes(point.t, point.x)
        one, two = (self._branch(point, [*modes[:k], side, *modes[k + 1 :]]) for side in (-1.0, 1.0))
        return any((first != second).any() for first, second in zip(one, two))

    def _branch(self, point: Point, modes: Sequence[float]) -> list[Array]:
        there = Point(self.system, point.t, point.x, modes=modes)
        found = [there.value("qdot"), np.array(there.a), np.array(self.system.holds(modes, point.t, point.x))]
        for group in ("state", "parameter"):
            found += [there.partial("qdot", group), there.motion(group), there.partial("condition", group)]
        return found

    def _moved(self, point: Point, now: Array) -> tuple[Array, Array]:
        """What the sides are moved by, and the sizes of its terms."""
        by_x, by_p = point.partial("indicator", "state"), point.partial("indicator", "parameter")
        moved, sizes = by_x @ now, np.abs(by_x) @ np.abs(now)
        if self.columns:
            moved[:, self.by_p] += by_p[:, self.columns]
            sizes[:, self.by_p] += np.abs(by_p[:, self.columns])
        return moved, sizes

    def _way(self, point: Point, now: Array, rates: Array, s: Any) -> Array:
        """What the time of a change is moved by."""
        interface = self.system.interface
        by_x, by_t = point.partial("indicator", "state"), point.partial("indicator", "time")[:, 0]
        moved, sizes = self._moved(point, now)
        own = self._causes(point, by_x @ rates + by_t, s)
        names, ways, spans = [interface.switches[k] for k in own], [], []
        for k in own:
            rate, terms = by_x[k] @ rates + by_t[k], np.abs(by_x[k]) @ np.abs(rates) + abs(by_t[k])
            if not abs(rate) > SLOWEST * terms:
                raise Stopped(f"`{names[0]}` only just: a little of any change decides whether")
            ways.append(-moved[k] / rate)
            spans.append(sizes[k] / abs(rate))
        for other, span in zip(ways[1:], spans[1:]):
            lost = np.flatnonzero(np.abs(other - ways[0]) > ALIKE * (span + spans[0]))
            if lost.size:
                raise Stopped(f"`{names[0]}` and `{names[1]}`, at one time here, one by one beside", lost)
        if not ways:
            raise Stopped("conditions change, by what is not known")
        found: Array = ways[0]
        return found

    def _causes(self, point: Point, rates: Array, s: Any) -> list[int]:
        """The switches that have changed by themselves, of sides with these rates: others jump with them, or
        with new values, which may move these too."""
        work, sides = s.problem.work, point.value("indicator")
        late = LOCATED * abs(s.h_old) * np.abs(rates)
        counted = self.system.interface.counted_switches
        return [
            k
            for k, crossed in enumerate(work.crossed)
            if crossed and (not work.indicator_jumped[k] or counted[k] or abs(sides[k]) <= late[k])
        ]

    def _renewed(
        self, point: Point, moved: Array, terms: Array, way: Array, acted: Sequence[int]
    ) -> tuple[Array, Array]:
        """Where clauses `when` give new values, one after the other, what the states are moved by, and the
        sizes of its terms."""
        whens = self.system.interface.whens
        for k in acted:
            if whens[k].states:
                first, places = sum(len(clause.states) for clause in whens[:k]), list(whens[k].states)
                rows = slice(first, first + len(places))
                moved, terms = self._given(point, rows, places, moved, terms, way)
                x = list(point.x)
                for place, value in zip(places, point.value("reinit")[rows]):
                    x[place] = float(value)
                point = Point(self.system, point.t, x)
        return moved, terms

    def _given(
        self, point: Point, rows: slice, places: list[int], moved: Array, terms: Array, way: Array
    ) -> tuple[Array, Array]:
        """The same behind one clause, whose new values are these."""
        by_state, by_time = point.partial("reinit", "state")[rows], point.partial("reinit", "time")[rows, 0]
        own, sizes = by_state @ moved + np.outer(by_time, way), np.abs(by_state) @ terms
        sizes += np.abs(np.outer(by_time, way))
        if self.columns:
            by_p = point.partial("reinit", "parameter")[rows][:, self.columns]
            own[:, self.by_p] += by_p
            sizes[:, self.by_p] += np.abs(by_p)
        found, terms = moved.copy(), terms.copy()
        found[places], terms[places] = own, sizes
        return found, terms


def end_of_step(s: Any, system: NumpySystem) -> list[float]:
    """Where the last step of `s` ended, before states took new values."""
    found: list[float] = s.x_before_event if system.interface.whens else s.x
    return found
