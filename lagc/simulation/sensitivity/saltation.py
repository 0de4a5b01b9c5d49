"""The change of the sensitivities S of a motion at an event.

The event indicator g is zero at the event, whose time changes by dt = -(g_x S + g_theta)/(g_x f- + g_t).
The state before the event changes by x + f- dt, that after it by x+ + f+ dt, with new values x+ or x+ = x.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from lagc.simulation.linearization.derivatives import Array, Point
from lagc.simulation.system import FAILED

if TYPE_CHECKING:
    from lagc.simulation.backends.python import NumpySystem
    from lagc.simulation.sensitivity.followers import Follower

Causes: TypeAlias = (
    "tuple[list[int], list[int]]"  # relations that crossed; for each, whether it jumped with others
)

SLOWEST = 1e-7  # of its terms: the rate of an indicator that only touches zero
ROUNDED = 1e-14  # of the terms of an indicator: smaller values are zero
LOCATED = 1e-6  # of a step: distance of an event from the end of the step
ALIKE = 1e-6  # relative difference of the times of one event


class Stopped(Exception):
    """The reason why S ends before the motion does, in the directions `lost`, or in all of them."""

    def __init__(self, reason: str, lost: Iterable[int] = ()):
        super().__init__(reason)
        self.lost = list(lost)


def common_shift(causes: Sequence[tuple[str, float, float, Array, Array]]) -> Array:
    """The change of the time of an event by directions. Of each cause: its name, the rate of its indicator
    and the magnitudes of the terms of it, the changes of the indicator and the magnitudes of their terms.
    Raises Stopped if it barely happens, or if causes happen at one time here alone."""
    shifts, spans = list[Array](), list[Array]()
    for name, rate, terms, moved, sizes in causes:
        if not abs(rate) > SLOWEST * terms:
            raise Stopped(f"`{name}` barely happens: the smallest change decides whether it does")
        shifts.append(-moved / rate)
        spans.append(sizes / abs(rate))
    for (name, *_), other, span in zip(causes[1:], shifts[1:], spans[1:]):
        lost = np.flatnonzero(np.abs(other - shifts[0]) > ALIKE * (span + spans[0]))
        if lost.size:
            words = f"`{causes[0][0]}` and `{name}` happen at one time here, but not for nearby values"
            raise Stopped(words, lost)
    if not shifts:
        raise Stopped("modes change for an unknown reason")
    return shifts[0]


class Changes:
    """The changes of S at events."""

    def __init__(self, system: NumpySystem, directions: Sequence[int], columns: Sequence[int]):
        self.system, self.by_p, self.columns = system, list(directions), list(columns)

    def beyond(
        self, s: Follower, now: Array, before: Sequence[float], after: Sequence[float], causes: Causes,
        jumped: bool,
    ) -> tuple[Array, Array]:  # fmt: skip
        """Return S after an event and the sum of the magnitudes of its terms. `before` and `after` are the
        modes, `s` is the motion just after it, and `now` is S before it. Raises Stopped if there is no
        derivative."""
        system, n = self.system, self.system.nq + self.system.nv
        end = s.s.x_before_event if system.interface.whens else s.s.x
        point = Point(system, s.s.t, list(end[:n]), modes=before)
        first, second = np.array([*point.value("qdot"), *point.a]), [0.0] * system.nx
        if system.rhs_on(after, s.s.t, list(s.s.x), second, [0.0] * system.nc) in FAILED:
            raise Stopped("the motion is not determined")
        rates = np.array(second[:n])
        if not (jumped or (first != rates).any()):
            return now, np.zeros_like(now)
        shift = self._shift(point, now, first, causes, s.s.t - s.s.t_old)
        moved, terms = now + np.outer(first, shift), np.abs(now) + np.abs(np.outer(first, shift))
        if jumped:
            self._refuse_following(point.x, s.s.x)
            moved, terms = self._renewed(point, moved, terms, shift, list(s.s.acted[: s.s.acts]))
        return moved - np.outer(rates, shift), terms + np.abs(np.outer(rates, shift))

    def refuse_at_start(self, point: Point, now: Array) -> None:
        """Raise Stopped if the initial state is on an event and a direction moves it off, with different
        derivatives on each side."""
        interface, indicators = self.system.interface, point.value("indicator")
        by_x, by_t = point.total("indicator", "state"), point.total("indicator", "time")[:, 0]
        terms = np.abs(by_x) @ np.abs(np.array(point.x)) + np.abs(by_t * point.t)
        terms += np.abs(point.total("indicator", "parameter")) @ np.abs(np.array(self.system.parameters))
        moved, sizes = self._indicator_changes(point, now)
        for k, counted in enumerate(interface.counted_relations):
            touches = not counted and abs(indicators[k]) <= ROUNDED * terms[k]
            lost = np.flatnonzero(np.abs(moved[k]) > ALIKE * sizes[k])
            if touches and lost.size and self._matters(point, k):
                words = interface.relations[k]
                raise Stopped(
                    f"`{words}` at the initial state itself: the derivatives differ on both sides", lost
                )

    def _matters(self, point: Point, k: int) -> bool:
        """Whether the motion, or the conditions of `when` clauses, differ on both sides of a relation."""
        modes = self.system.modes(point.t, point.x)
        one, two = (self._branch(point, [*modes[:k], side, *modes[k + 1 :]]) for side in (-1.0, 1.0))
        return any((first != second).any() for first, second in zip(one, two))

    def _branch(self, point: Point, modes: Sequence[float]) -> list[Array]:
        there = Point(self.system, point.t, point.x, modes=modes)
        found = [there.value("qdot"), np.array(there.a), np.array(self.system.holds(modes, point.t, point.x))]
        for group in ("state", "parameter"):
            found += [there.partial("qdot", group), there.motion(group), there.partial("condition", group)]
        return found

    def _indicator_changes(self, point: Point, now: Array) -> tuple[Array, Array]:
        """The changes of the event indicators, and the sums of magnitudes of their terms."""
        by_x, by_p = point.total("indicator", "state"), point.total("indicator", "parameter")
        moved, sizes = by_x @ now, np.abs(by_x) @ np.abs(now)
        if self.columns:
            moved[:, self.by_p] += by_p[:, self.columns]
            sizes[:, self.by_p] += np.abs(by_p[:, self.columns])
        return moved, sizes

    def _shift(self, point: Point, now: Array, rates: Array, causes: Causes, step: float) -> Array:
        """The change of the time of an event."""
        interface = self.system.interface
        by_x, by_t = point.total("indicator", "state"), point.total("indicator", "time")[:, 0]
        moved, sizes = self._indicator_changes(point, now)
        own = self._causes(point, by_x @ rates + by_t, causes, step)
        terms = np.abs(by_x) @ np.abs(rates) + np.abs(by_t)
        found = [
            (interface.relations[k], by_x[k] @ rates + by_t[k], terms[k], moved[k], sizes[k]) for k in own
        ]
        return common_shift(found)

    def _causes(self, point: Point, rates: Array, causes: Causes, step: float) -> list[int]:
        """The relations that changed by themselves; others jump with them, or with new values."""
        (crossed, jumped), indicators = causes, point.value("indicator")
        late = LOCATED * abs(step) * np.abs(rates)
        counted = self.system.interface.counted_relations
        return [k for k in crossed if not jumped[k] or counted[k] or abs(indicators[k]) <= late[k]]

    def _refuse_following(self, before: Sequence[float], after: Sequence[float]) -> None:
        """Raise Stopped if a speed without inertia has jumped: it follows new values by the constraints."""
        interface = self.system.interface
        for i in interface.massless:
            k = interface.nq + i
            if abs(after[k] - before[k]) > ALIKE * abs(before[k]):
                raise Stopped(f"`{interface.v_names[i]}`, which has no inertia, follows new values")

    def _renewed(
        self, point: Point, moved: Array, terms: Array, shift: Array, acted: Sequence[int]
    ) -> tuple[Array, Array]:
        """The changes of the states and the magnitudes of their terms, after `when` clauses have set new
        values in turn."""
        whens = self.system.interface.whens
        for k in acted:
            if whens[k].states:
                first, places = sum(len(clause.states) for clause in whens[:k]), list(whens[k].states)
                rows = slice(first, first + len(places))
                moved, terms = self._after_clause(point, rows, places, moved, terms, shift)
                x = list(point.x)
                for place, value in zip(places, point.value("reinit")[rows]):
                    x[place] = float(value)
                point = Point(self.system, point.t, x)
        return moved, terms

    def _after_clause(
        self, point: Point, rows: slice, places: list[int], moved: Array, terms: Array, shift: Array
    ) -> tuple[Array, Array]:
        """Return the same after one clause with these new values."""
        by_state, by_time = point.partial("reinit", "state")[rows], point.partial("reinit", "time")[rows, 0]
        own, sizes = by_state @ moved + np.outer(by_time, shift), np.abs(by_state) @ terms
        sizes += np.abs(np.outer(by_time, shift))
        if self.columns:
            by_p = point.partial("reinit", "parameter")[rows][:, self.columns]
            own[:, self.by_p] += by_p
            sizes[:, self.by_p] += np.abs(by_p)
        found, terms = moved.copy(), terms.copy()
        found[places], terms[places] = own, sizes
        return found, terms
