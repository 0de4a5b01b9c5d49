"""The search for consistent initial conditions, with the names of the equations in a conflict.

Equations and stated values that contradict each other are found by leaving out one after the other while the
search still fails.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from lagc.lowering.program import Interface
from lagc.simulation.initialization.result import Anchor, Change, Start, Unmet
from lagc.simulation.initialization.solver import Conditions, Consistency
from lagc.simulation.system import FIXED, NOT_FINITE, OK, RUN, UNSTATED, System

_SHOWN = 1e-9  # of its size: a change that is worth a word
_PATIENCE = (1, 2, 4)  # times that a search continues from its last point
_MOST_FOUND = 6  # values or conditions that are named in one note
_COMPARED = 24  # conditions among which the fewest that force a value are looked for
_PART = 1e-6  # of the largest: the share of a condition that takes part in a combination


def search(system: System, t: float, guess: list[float], levels: list[int]) -> Start:
    """The start near `guess`; `levels` says how firmly each unknown is stated."""
    interface = system.interface
    tried = Consistency(conditions_of(system), t, guess, levels)
    status = tried.run()
    if status == NOT_FINITE:
        return Start(guess, (), _strange(interface, tried.space.culprit - system.nq - system.nv))
    words = _Words(system, tried, guess)
    x = [*tried.y[: words.state], *guess[words.state :]]
    if status == OK:
        return Start(x, words.changes())
    return Start(x, (), *words.conflict())


def _strange(interface: Interface, rate: int) -> tuple[Unmet, ...]:
    """The stated rate that is not finite; nothing where it is another start value."""
    if rate < 0:
        return ()
    place = interface.start_places[len(interface.start_places) - len(interface.rate_names) + rate]
    name = f"what `{interface.rate_names[rate]}` ({place}) is stated to be"
    return (Unmet(name, float("nan"), interface.rate_units[rate], ("start", interface.rate_names[rate])),)


def conditions_of(system: System) -> Conditions:
    interface = system.interface
    return Conditions(
        system.nq, system.nv, system.quaternions, interface.start_units, interface.angles,
        interface.condition_ends, interface.condition_columns, system.conditions, system.measures,
        interface.massless,
    )  # fmt: skip


class _Words:
    """The names of what takes part in a search from `guess`, after it has ended, and which of it matters."""

    def __init__(self, system: System, search: Consistency, guess: list[float]):
        interface = system.interface
        self.interface, self.search, self.conditions = interface, search, search.conditions
        self.guess, self.state, self.levels = guess, system.nq + system.nv, list(search.space.levels)
        self.names = [*interface.state_names, *interface.rate_names]
        self.units = [*interface.state_units, *interface.rate_units]
        self.given = [*guess[: self.state], *system.measures()[0]]
        self.rows = _rows(interface)

    def changes(self) -> tuple[Change, ...]:
        """Return the values that differ from the given ones, stated rates included."""
        y, sizes, free, part = (getattr(self.search.space, name) for name in ("y", "scaling", "free", "part"))
        moved = [i for i, (given, used) in enumerate(zip(self.given, y))
                 if abs(given - used) > _SHOWN * max(abs(given), sizes[i])]  # fmt: skip
        found: dict[tuple[int, ...], Change] = {}
        stated = [i for i in moved if self.levels[i] != UNSTATED]
        led = [i for i in stated if free[i] and not part[i]]
        together = self._forced(led) if len(led) > _MOST_FOUND else ()
        for i in moved:
            whole = self.conditions.whole(i) if i in stated else (i,)
            if whole in found:
                continue
            forced = together or (self._forced([i]) if i in stated and free[i] else ())
            place = self.interface.start_places[i] if i in stated and self.levels[i] != RUN else ""
            share = max(abs(self.given[j] - y[j]) / sizes[j] for j in whole)
            change = Change(
                self.names[i], self.given[i], y[i], self.units[i], i in stated, place, forced, share
            )
            if len(whole) > 1:
                parts = tuple([self.given[j] for j in whole]), tuple([y[j] for j in whole])
                change = Change(_owner(self.names[i]), *parts, "", True, place, forced, share)
            found[whole] = change
        return tuple(found.values())

    def _forced(self, values: Sequence[int]) -> tuple[str, ...]:
        """Return the conditions that cannot hold with the given `values`: those whose combination, linear at
        the start, requires moves of these values and of nothing else that is free."""
        import numpy as np

        space, rows = self.search.space, self._connected(values)
        jacobian = self.search.evaluate(space.y)[1]
        slopes = np.zeros((self.search.n, len(rows)))
        for k, row in enumerate(rows):
            for entry in self.conditions.entries_of(row):
                j = self.conditions.columns[entry]
                slopes[j, k] = jacobian[entry] * space.scaling[j] if space.free[j] else 0.0
        largest = np.abs(slopes).max(axis=0, initial=0.0)
        slopes /= np.where(largest > 0.0, largest, 1.0)
        right = np.zeros(self.search.n)
        for j in values:  # weights that hardly cancel
            right[j] = 1.0 + j / self.search.n
        everything = range(len(rows))
        kept = _combined(slopes, right, everything) or self._direct(rows, values)  # several share a move
        for k in reversed(kept if len(kept) <= _COMPARED else ()):  # not all that depend on each other
            kept = (_combined(slopes, right, [i for i in kept if i != k]) if k in kept else None) or kept
        return tuple([self.rows[rows[k]][0] for k in kept])

    def _direct(self, rows: Sequence[int], values: Sequence[int]) -> list[int]:
        """Return those of `rows`, by index, that contain one of the values; without speeds if these are
        positions."""
        later = max(values) >= self.conditions.nq
        columns = [self.conditions.columns_of(row) for row in rows]
        return [k for k, own in enumerate(columns)
                if own & {*values} and (max(own) >= self.conditions.nq) == later]  # fmt: skip

    def _connected(self, values: Sequence[int]) -> list[int]:
        """The rows that `values` reach, from row to row by what is free."""
        known, rows = {j for i in values for j in self.conditions.whole(i)}, set[int]()
        columns = [self.conditions.columns_of(k) for k in range(len(self.rows))]
        while more := {k for k, own in enumerate(columns) if k not in rows and known & own}:
            rows |= more
            known |= {j for k in more for j in columns[k] if self.search.space.free[j]}
        return sorted(rows)

    def conflict(self) -> tuple[tuple[Unmet, ...], tuple[str, ...], tuple[Anchor, ...]]:
        """The conditions, and the values that are fixed, that contradict each other; none is superfluous."""
        search, part, held, anchors = self.search, self.search.space.part, [], []
        c = search.evaluate(search.y)[0]
        at_guess = search.evaluate(search.space.guess)[0]
        strange = [k for k, value in enumerate(at_guess) if not abs(value) < float("inf")]
        if not strange and not search.has_begun:
            strange = [search.space.culprit]
        levels = [FIXED if level == FIXED else UNSTATED for level in self.levels]
        rows = strange or self._minimal(levels)
        for i in [] if strange else range(search.n):
            if levels[i] == FIXED and not part[i]:
                whole = self.conditions.whole(i)
                tried = [UNSTATED if j in whole else level for j, level in enumerate(levels)]
                if self._fails(tried, rows, self.guess):
                    levels = tried
                else:
                    name = _owner(self.names[i]) if len(whole) > 1 else self.names[i]
                    held.append(f"`{name}` ({self.interface.start_places[i]})")
                    anchors.append(("start", self.names[i]))
        amounts = [abs(c[k]) if abs(at_guess[k]) < float("inf") else float("nan") for k in rows]
        unmet = [Unmet(self.rows[k][0], a, *self.rows[k][1:]) for k, a in zip(rows, amounts)]
        return tuple(unmet), tuple(held), tuple(anchors)

    def _minimal(self, levels: list[int]) -> list[int]:
        """Return a minimal inconsistent set of the equations, which have no common solution. If none is
        found, return all of them, without the rates if the positions alone are inconsistent.

        Without some equations, others may have a solution far from the guess, as for all links of a chain but
        the last ones. So the search for one is repeated with more patience."""
        rows, ended = [*range(len(self.rows))], self._last_point(self.search, self.guess)
        for patience in _PATIENCE:
            kept = rows
            for k in sorted(rows, reverse=True):
                fewer = [row for row in kept if row != k]
                if self._fails(levels, fewer, self.guess, patience):
                    kept = fewer
            if all(self._fails(levels, kept, guess, 2 * patience) for guess in (ended, self.guess)):
                return sorted(kept)
        positions = [row for row in rows if row < self.interface.nh]
        return positions if self._fails(levels, positions, self.guess, patience) else rows

    def _fails(self, levels: list[int], rows: Sequence[int], guess: list[float], patience: int = 1) -> bool:
        """Whether no start is found from the guess, and then from the last point, `patience` times."""
        for _ in range(patience):
            search = Consistency(self.conditions, self.search.t, guess, levels, rows)
            if search.run() == OK:
                return False
            guess = self._last_point(search, guess)
        return True

    def _last_point(self, search: Consistency, guess: list[float]) -> list[float]:
        return [*search.y[: self.state], *guess[self.state :]]


def _combined(slopes: Any, right: Any, rows: Sequence[int]) -> list[int] | None:
    """Return those of `rows`, columns of `slopes`, whose combination is `right`; None without one."""
    import numpy as np

    table = slopes[:, rows]
    if not len(rows) or not np.isfinite(table).all():
        return None
    factors = np.linalg.lstsq(table, right, _SHOWN)[0]
    if not np.abs(table @ factors - right).max() < _PART:
        return None
    least = _PART * np.abs(factors).max()
    return [k for k, factor in zip(rows, factors) if abs(factor) > least]


def _rows(interface: Interface) -> list[tuple[str, str, Anchor]]:
    """The name and unit of each condition, and what of the model it is."""
    labels = list(zip(interface.row_labels, interface.row_units, interface.row_places))
    found: list[tuple[str, str, Anchor]] = []
    for label, unit, place in labels[: interface.nh]:
        found.append((f"constraint `{label}` ({place})", unit, ("row", label)))
    for k, (label, unit, place) in enumerate(labels):
        rate = "the rate of " if k < interface.nh else ""
        found.append((f"{rate}constraint `{label}` ({place})", _rate_unit(unit) if rate else unit,
                      ("row", label)))  # fmt: skip
    for k, place in enumerate(interface.initial_places):
        found.append((f"the condition at {place}", "", ("initial", str(k))))
    places = interface.start_places[len(interface.start_places) - len(interface.rate_names) :]
    for name, unit, place in zip(interface.rate_names, interface.rate_units, places):
        found.append((f"what `{name}` ({place}) is made of", unit, ("start", name)))
    for k in interface.quaternions:
        name = interface.q_names[k]
        found.append((f"the unit length of `{_owner(name)}`", "", ("start", name)))
    return found


def _owner(part: str) -> str:
    """The orientation that a part such as `o.w` is of."""
    return part.rpartition(".")[0]


def _rate_unit(unit: str) -> str:
    return f"{unit}/s" if unit else "1/s"
