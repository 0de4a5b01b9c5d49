"""The search for consistent initial conditions, with the names of the equations in a conflict.

Equations that force a value, or contradict each other, are found by leaving out one after the other while the
search still fails.
"""

from __future__ import annotations

from collections.abc import Sequence

from lagc.lowering.program import Interface
from lagc.simulation.initialization.result import Anchor, Change, Start, Unmet
from lagc.simulation.initialization.solver import Conditions, Consistency, least_norm
from lagc.simulation.system import FIXED, NOT_FINITE, OK, RUN, UNSTATED, System

_SHOWN = 1e-9  # of its size: a change that is worth a word
_TRIED = 3  # spreads after which conditions are taken to contradict each other
_PATIENCE = (1, 2, 4)  # times that such a search goes on from where it came to
_MOST_FOUND = 6  # values or conditions that are named in one note
_COMPARED = 24  # conditions among which the fewest that force a value are looked for
_PART = 1e-6  # of the largest: the share of a condition that takes part in a combination


def search(system: System, t: float, guess: list[float], levels: list[int]) -> Start:
    """The start near `guess`; `levels` says how firmly each unknown is stated."""
    interface, conditions = system.interface, conditions_of(system)
    tried = Consistency(conditions, t, guess, levels)
    status = tried.run()
    if status == NOT_FINITE:
        return Start(guess, (), _strange(interface, tried.culprit - system.nq - system.nv))
    found = _Words(system, conditions, t, guess, tried.levels)
    x = [*tried.y[: system.nq + system.nv], *guess[system.nq + system.nv :]]
    if status == OK:
        return Start(x, found.changes(tried))
    return Start(x, (), *found.conflict(tried))


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
        system.parameters, lambda p: system.bind(p).conditions,
        pieces=interface.row_pieces, some=system.some_conditions,
        massless=interface.massless,
    )  # fmt: skip


class _Words:
    """The names of what takes part in a start, and which of it matters."""

    def __init__(
        self, system: System, conditions: Conditions, t: float, guess: list[float], levels: list[int]
    ):
        interface = system.interface
        self.interface, self.conditions, self.t = interface, conditions, t
        self.guess, self.levels, self.state = guess, levels, system.nq + system.nv
        self.names = [*system.interface.state_names, *interface.rate_names]
        self.units = [*interface.state_units, *interface.rate_units]
        self.given = [*guess[: system.nq + system.nv], *system.measures()[0]]
        self.rows = _rows(interface)

    def changes(self, search: Consistency) -> tuple[Change, ...]:
        """Return the values that differ from the given ones, stated rates included."""
        y, weights, free, part = search.y, search.weights, search.free, search.part
        moved = []
        for i, (given, used) in enumerate(zip(self.given, y)):
            if abs(given - used) > _SHOWN * max(abs(given), weights[i]):
                moved.append(i)
        found: dict[tuple[int, ...], Change] = {}
        led = [i for i in moved if self.levels[i] != UNSTATED and free[i] and not part[i]]
        together = self._forced(search, led) if len(led) > _MOST_FOUND else ()
        for i in moved:
            stated = self.levels[i] != UNSTATED
            whole = _whole(self.conditions, i) if stated else (i,)
            if whole in found:
                continue
            name, given, used = self.names[i], self.given[i], y[i]
            forced = together
            if not together and stated and free[i]:
                forced = self._forced(search, [i])
            place = self.interface.start_places[i] if stated and self.levels[i] != RUN else ""
            share = max(abs(self.given[j] - y[j]) / weights[j] for j in whole)
            change = Change(name, given, used, self.units[i], stated, place, forced, share)
            if len(whole) > 1:
                parts = tuple([self.given[j] for j in whole]), tuple([y[j] for j in whole])
                change = Change(_owner(name), *parts, "", stated, place, forced, share)
            found[whole] = change
        return tuple(found.values())

    def _forced(self, search: Consistency, values: Sequence[int]) -> tuple[str, ...]:
        """Return the conditions that cannot hold with the given `values`: those whose combination, linear at
        the start, requires moves of these values and of nothing else that is free."""
        rows = self._tied(search, values)
        _, jacobian, _ = search.evaluate(search.y)
        weights, free = search.weights, [j for j, moves in enumerate(search.free) if moves]
        place = {j: k for k, j in enumerate(free)}
        slopes = [[0.0] * len(rows) for _ in free]
        for k, row in enumerate(rows):
            first = self.conditions.ends[row - 1] if row > 0 else 0
            largest = 0.0
            for entry in range(first, self.conditions.ends[row]):
                j = self.conditions.columns[entry]
                if j in place:
                    slopes[place[j]][k] = jacobian[entry] * weights[j]
                    largest = max(largest, abs(slopes[place[j]][k]))
            for slope in slopes if largest > 0.0 else ():
                slope[k] /= largest
        right = [1.0 + j / search.n if j in values else 0.0 for j in free]  # weights that hardly cancel
        everything = range(len(rows))
        kept = _combined(slopes, right, everything) or list(everything)
        for k in reversed(kept if len(kept) <= _COMPARED else ()):  # not all that depend on each other
            kept = (_combined(slopes, right, [i for i in kept if i != k]) if k in kept else None) or kept
        return tuple([self.rows[rows[k]][0] for k in kept])

    def conflict(self, search: Consistency) -> tuple[tuple[Unmet, ...], tuple[str, ...], tuple[Anchor, ...]]:
        """The conditions, and the values that are fixed, that contradict each other; none is superfluous."""
        c = search.evaluate(search.y)[0]
        at_guess = search.evaluate(search.guess)[0]
        strange = [k for k, value in enumerate(at_guess) if not abs(value) < float("inf")]
        if not strange and not search.has_begun:
            strange = [search.culprit]
        levels = [FIXED if level == FIXED else UNSTATED for level in self.levels]
        rows = strange or self._minimal(levels, search)
        part, held, anchors = search.part, [], []
        for i in [] if strange else range(search.n):
            if levels[i] == FIXED and not part[i]:
                whole = _whole(self.conditions, i)
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

    def _minimal(self, levels: list[int], search: Consistency) -> list[int]:
        """Return a minimal inconsistent set of the equations of `search`, which have no common solution. If
        none is found, return all of them, without the rates if the positions alone are inconsistent.

        Without some equations, others may have a solution far from the guess, as for all links of a chain but
        the last ones. So the search for one is repeated with more patience."""
        rows, ended = search.rows, self._ended(search, self.guess)
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
        """Whether no start is found from the guess, and from where the search came to, so many times."""
        for _ in range(patience):
            search = Consistency(self.conditions, self.t, guess, levels, rows)
            if search.solve(0, _TRIED):
                return False
            guess = self._ended(search, guess)
        return True

    def _ended(self, search: Consistency, guess: list[float]) -> list[float]:
        return [*search.y[: self.state], *guess[self.state :]]

    def _tied(self, search: Consistency, values: Sequence[int]) -> list[int]:
        """The rows that `values` reach, from row to row by what is free."""
        known, rows, free = {j for i in values for j in _whole(self.conditions, i)}, set[int](), search.free
        columns = [set(self.conditions.columns_of(k)) for k in range(len(self.rows))]
        while True:
            more = {k for k in range(len(self.rows)) if k not in rows and known & columns[k]}
            if not more:
                return sorted(rows)
            rows |= more
            known |= {j for k in more for j in columns[k] if free[j]}


def _combined(slopes: Sequence[Sequence[float]], right: list[float], rows: Sequence[int]) -> list[int] | None:
    """Those of `rows`, columns of `slopes`, that take part in a combination that is `right`, if one is."""
    table = [[slope[k] for k in rows] for slope in slopes]
    factors = least_norm(table, right, _SHOWN) if rows and slopes else []
    residuals = [
        abs(sum(a * b for a, b in zip(slope, factors)) - wanted) for slope, wanted in zip(table, right)
    ]
    if not factors or not max(residuals) < _PART:
        return None
    least = _PART * max(map(abs, factors))
    return [k for k, factor in zip(rows, factors) if abs(factor) > least]


def _whole(conditions: Conditions, i: int) -> tuple[int, ...]:
    """The unknowns that move together with i: the parts of a quaternion."""
    for k in conditions.quaternions:
        if k <= i < k + 4:
            return (k, k + 1, k + 2, k + 3)
    return (i,)


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
