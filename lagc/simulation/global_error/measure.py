"""The scale of each quantity, and differences of two runs by these scales.

The quantities are the coordinates, speeds, outputs and discrete variables, in this order.  The scale of a
quantity is what the user gives; else its range, the largest minus the least value over the motion; for a
quantity that does not move, the size of its terms.  A quantity that only round-off moves has no scale.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Mapping, Sequence, Set
from itertools import compress
from math import inf, isfinite, tau
from operator import sub

from lagc.base.records import dataclass
from lagc.lowering.program import Interface
from lagc.simulation.error_measure import (
    Sizes,
    apart_in_time,
    between,
    quantity_names,
    quantity_units,
    scaling_groups,
    state_groups,
)
from lagc.simulation.system import System, Trajectory, more, rates_at

COMPARED = 200  # recorded times, at least, at which outputs are compared if there are so many
SMALL = 1e-3  # range over size of terms: a quantity that moves by less may not move at all
STATE_PACE = 1e-12  # pace (motion in the shortest time scale, over the size) of a state that does not move
OUTPUT_PACE = 1e-10  # the same for an output, whose rate is a difference
FAINT = 1e-8  # pace below which a quantity does not move whose pace falls with the tolerance
SURE = 1e-5  # pace of a quantity that moves
FALLS = 3.0  # ratio of the paces in two runs: errors alone move the quantity
ROUNDING = 2.0**-42  # range over size of terms: several rounding units
NOTHING = 1e-9  # range over largest value: no motion
PART = 1e-4  # of the shortest time scale: the step of that difference
OFF = 2.0**-26  # relative perturbation of states that shows the size of terms
FARTHER = 2.0**10  # ratio of a second one, by which terms, but no rounding, would change more
ALIKE = 16.0  # ratio of changes that are all round-off
ULP = 2.0**-52
MOST_APART = 1e-3  # of the time: one event in two runs
MOST_NAMED = 6

Columns = list[Sequence[float]]  # the values of each quantity at several times


@dataclass
class Scales:
    """The scale of each quantity in one run (0: none), the size of its terms, its pace (infinite if it
    surely moves), and whether it does not move."""

    scales: list[float]
    sizes: list[float]
    paces: list[float]
    constant: list[bool]

    @property
    def floors(self) -> list[float]:
        """One rounding unit of the terms of each quantity, over its scale: no computed value is closer."""
        return [ULP * size / scale if scale else 0.0 for size, scale in zip(self.sizes, self.scales)]


class _Seen:
    """A run by quantities: the values of each state at the recorded times, and of each output at the times at
    which it is compared. `aside` is the same run at times that only show the ranges of outputs."""

    def __init__(self, system: System, run: Trajectory, aside: Trajectory | None):
        self.system, self.run = system, run
        self.states: Columns = [*zip(*run.states)] or [(0.0,)] * system.nx
        self.low, self.high = [*map(min, self.states)], [*map(max, self.states)]
        if run.lowest:
            self.low, self.high = [*map(min, self.low, run.lowest)], [*map(max, self.high, run.highest)]
        self._shown: dict[int, Columns] = {}
        columns: Columns = []
        if system.interface.outputs:
            columns = self.shown(len(run.states))
            if aside is not None:
                others = system.output_columns(aside.times, aside.states)
                columns = [[*a, *b] for a, b in zip(columns, others)]
        finite = [[*filter(isfinite, column)] or [0.0] for column in columns]
        self.wide = [max(column) - min(column) for column in finite]  # ranges and magnitudes of outputs
        self.largest = [max(max(column), -min(column)) for column in finite]
        self.terms: tuple[list[float], list[bool]] = [], []
        self.paces: list[float] | None = None
        self.scales: Scales | None = None

    def shown(self, n: int) -> Columns:
        """The outputs at the times among the first `n` at which they are compared."""
        if n not in self._shown:
            chosen, run = compared(range(n)), self.run
            self._shown[n] = self.system.output_columns(
                [run.times[k] for k in chosen], [run.states[k] for k in chosen]
            )
        return self._shown[n]


class Measure:
    """Differences of runs of `system`, over the scales of the quantities. `given` are scales by name,
    `unresolved` the states that `find_unresolved` has found before."""

    def __init__(self, system: System, given: Mapping[str, float], unresolved: Iterable[int] = ()):
        self.system, self.unresolved = system, set(unresolved)
        self.given = [given.get(name, 0.0) for name in quantity_names(system.interface)]
        self.noise: dict[int, float] = {}  # bounds of the state groups that only round-off moves
        self.steady: set[int] = set()  # quantities that errors alone move
        self.moving: set[int] = set()  # quantities that do move
        self._runs: dict[int, _Seen] = {}
        self._aside: dict[int, Trajectory] = {}
        self._terms: tuple[int, list[float], list[bool]] = 0, [], []  # the last, and the length of its run
        self._gaps: dict[tuple[int, int], list[float]] = {}

    def ignore(self, noise: Mapping[int, float]) -> None:
        """Take the state groups out that round-off moves by no more than these bounds."""
        self.noise = dict(noise)
        self._forget()

    def _forget(self) -> None:
        for seen in self._runs.values():
            seen.scales = None

    def without(self, run: Trajectory, aside: Set[float]) -> Trajectory:
        """`run` without the states at the times `aside`, which only show the ranges of its outputs."""
        if not aside:
            return run
        left = [t in aside for t in run.times]
        kept = [not out for out in left]
        found, other = (
            run.changed(times=[*compress(run.times, where)], states=[*compress(run.states, where)])
            for where in (kept, left)
        )
        self._aside[id(found)] = other
        self._see(found)  # keeps the run, and its id
        return found

    def _see(self, run: Trajectory) -> _Seen:
        if id(run) not in self._runs:
            self._runs[id(run)] = _Seen(self.system, run, self._aside.pop(id(run), None))
        return self._runs[id(run)]

    def of(self, run: Trajectory) -> Scales:
        """The scales of a run."""
        seen = self._see(run)
        if seen.scales is None:
            seen.scales = self._found(seen)
        return seen.scales

    def sizes(self, run: Trajectory) -> Sizes:
        """The state groups with their scales."""
        scales = self.of(run).scales
        return [(group, max(scales[i] for i in group)) for group in state_groups(self.system.interface)]

    def apart(self, fine: Trajectory, coarse: Trajectory) -> float:
        """The largest difference of two runs, over the scales in the first one."""
        for i, (here, there) in enumerate(zip(self.of(fine).paces, self.of(coarse).paces)):
            if here <= FAINT and FALLS * here <= there and i not in self.steady:
                self.steady.add(i)
                self._forget()
        shares = self.shares(self.gaps(fine, coarse), fine)
        return max([apart_in_time(fine, coarse), *shares])

    def find_unresolved(self, fine: Trajectory, coarse: Trajectory, coarser: Trajectory, fall: float) -> bool:
        """Whether more states turn out to be unresolved: they move so little beside others of their scaling
        group that runs differ by round-off of the group. No smaller step reduces such a difference: from
        `coarser` to `coarse`, it falls to more than `fall`."""
        scales, before = self.of(fine).scales, len(self.unresolved)
        now, earlier = self.gaps(fine, coarse), self.gaps(fine, coarser)
        share = NOTHING if self.system.interface.nc else ROUNDING
        for group in scaling_groups(self.system.interface):
            largest = max(scales[i] for i in group)
            small = (i for i in group if scales[i] <= SMALL * largest)
            self.unresolved.update(i for i in small if fall * earlier[i] < now[i] <= share * largest)
        return len(self.unresolved) > before

    def shares(self, errors: Iterable[float], run: Trajectory) -> list[float]:
        """Errors over the scales in `run`."""
        return [error / scale if scale else 0.0 for error, scale in zip(errors, self.of(run).scales)]

    def gaps(self, one: Trajectory, other: Trajectory) -> list[float]:
        """The largest difference of each quantity over the recorded times that both runs have."""
        pair = id(one), id(other)
        if pair not in self._gaps:
            self._gaps[pair] = self._differences(self._see(one), self._see(other))
        return self._gaps[pair]

    def _differences(self, here: _Seen, there: _Seen) -> list[float]:
        one, other = here.run, there.run
        n, left_out = min(len(one.states), len(other.states)), between(one, other)
        kept = [k not in left_out for k in range(n)] if left_out else None
        if n == 0 or (kept and not any(kept)):
            return [inf] * len(self.given)
        states = [_differ(a, b, kept) for a, b in zip(here.states, there.states)]
        outputs: list[list[float]] = []
        if self.system.interface.outputs:
            passed = left_out | _passing(one, other)
            open_ones = [k not in passed for k in compared(range(n))] if passed else None
            outputs = [_differ(a, b, open_ones) for a, b in zip(here.shown(n), there.shown(n))]
        moving, discrete = self.system.nq + self.system.nv, len(self.system.interface.discretes)
        found = [max(gaps) if isfinite(sum(gaps)) else inf for gaps in states]
        values = [max(filter(isfinite, gaps), default=0.0) for gaps in outputs]
        return [*found[:moving], *values, *found[self.system.nx - discrete :]]

    def agree_until(self, one: Trajectory, other: Trajectory, target: float) -> float | None:
        """The last time until which the states of two runs agree to `target`, over their scales, or over
        their magnitudes so far where these are smaller but more than noise; None if that is the end."""
        n, left_out = min(len(one.states), len(other.states)), between(one, other)
        alike = [True] * n
        for place, (group, scale) in enumerate(self.sizes(one)):
            size, noise = 0.0, self.noise.get(place, 0.0)
            for k in range(n) if scale else ():
                x, y = one.states[k], other.states[k]
                size = max(size, *(abs(x[i]) for i in group))
                gap = max(abs(x[i] - y[i]) for i in group)
                alike[k] &= k in left_out or size <= noise or gap <= target * min(size, scale)
        if not alike or alike[-1]:
            return None
        return one.times[max((k for k, same in enumerate(alike) if same), default=0)]

    def notes(self, run: Trajectory, errors: Sequence[float], accuracy: float) -> list[str]:
        """Notes on the quantities that do not move, and on those that `errors` leave less accurate over their
        own ranges than `accuracy`."""
        found, interface = self.of(run), self.system.interface
        names, units, seen = quantity_names(interface), quantity_units(interface), self._see(run)
        continuous = range(len(names) - len(interface.discretes))
        constant = [k for k in continuous if found.constant[k]]
        beyond = [i for i in sorted(self.unresolved)
                  if errors and errors[i] > accuracy * (seen.high[i] - seen.low[i])]  # fmt: skip

        def named(places: Sequence[int], values: Sequence[float]) -> str:
            shown = [f"`{names[k]}` ({values[k]:.1g} {units[k]}".rstrip() + ")" for k in places if values[k]]
            return ", ".join(shown[:MOST_NAMED]) + more(shown, MOST_NAMED)

        said = {
            "constant, so that the accuracy is relative to the size of the terms": (constant, found.scales),
            "so small beside others of the unit that round-off exceeds the accuracy of the own range "
            "(in brackets the error)": (beyond, errors),
        }
        notes = {what: named(*which) for what, which in said.items()}
        return [f"{what}: {which}" for what, which in notes.items() if which]

    # -- scales --------------------------------------------------------------------------------

    def _terms_of(self, seen: _Seen) -> tuple[list[float], list[bool]]:
        """The terms of outputs, as `_term_sizes` has them: those of an earlier run as long, unless an output
        may be round-off."""
        count, sizes, noise = self._terms
        least = [ALIKE * OFF * size for size in sizes]
        if not count or len(seen.run.states) > count or any(a <= b for a, b in zip(seen.largest, least)):
            sizes, noise = _term_sizes(self.system, seen.run) if seen.largest else ([], [])
            self._terms = len(seen.run.states), sizes, noise
        return sizes, noise

    def _found(self, seen: _Seen) -> Scales:
        system, interface, run = self.system, self.system.interface, seen.run
        spans, sizes = [*map(sub, seen.high, seen.low)], [max(b, -a) for a, b in zip(seen.low, seen.high)]
        n, discrete = system.nq + system.nv, len(interface.discretes)
        for first in interface.quaternions:
            spans[first : first + 4] = [max(spans[first : first + 4])] * 4
            sizes[first : first + 4] = [1.0] * 4
        if seen.paces is None:
            seen.terms = self._terms_of(seen)
        of_outputs, noise = seen.terms
        spans = [*spans[:n], *seen.wide, *spans[system.nx - discrete :]]
        sizes = [*sizes[:n], *of_outputs, *sizes[system.nx - discrete :]]
        values = [*sizes[:n], *seen.largest, *sizes[n + len(of_outputs) :]]
        limits = [STATE_PACE] * n + [OUTPUT_PACE] * len(of_outputs) + [STATE_PACE] * discrete
        terms, groups = list(sizes), scaling_groups(interface)
        for group in groups:
            largest = max(sizes[i] for i in group)
            for i in group:
                if run.states and run.states[0][i] == 0.0 < sizes[i]:  # it has no size before it moves
                    terms[i], limits[i] = largest, 0.0
                elif interface.nc:
                    sizes[i] = largest  # a projection rounds to that
        shares = [NOTHING if interface.nc else ROUNDING] * n + [ROUNDING] * (len(terms) - n)
        least = [max(share * term, NOTHING * value) for share, term, value in zip(shares, terms, values)]
        doubtful = [i for i, (span, size) in enumerate(zip(spans, terms)) if span <= SMALL * size]
        open_ones = [i for i in doubtful if i not in self.steady and i not in self.moving]
        if seen.paces is None:
            nothing = [span <= little for span, little in zip(spans, least)]
            seen.paces = _paces(system, run, open_ones, nothing, terms)
        paces = seen.paces
        self.steady.update(i for i in open_ones if paces[i] <= limits[i])
        self.moving.update(i for i in open_ones if paces[i] > SURE)
        constant = [i in self.steady and span <= SMALL * size
                    for i, (span, size) in enumerate(zip(spans, terms))]  # fmt: skip
        scales = [size if same else span for same, span, size in zip(constant, spans, terms)]
        for i, unit in enumerate(interface.state_units[: system.nq]):
            if constant[i] and unit == "rad":  # whole turns are no size
                scales[i] = min(scales[i], tau)
        for k, group in enumerate(state_groups(interface) if self.noise else ()):
            if k in self.noise and max(spans[i] for i in group) <= self.noise[k]:
                for i in group:
                    scales[i], constant[i] = 0.0, False
        for group in groups if self.unresolved else ():
            largest = max(scales[i] for i in group)
            for i in self.unresolved.intersection(group):
                scales[i], constant[i] = largest, False
        for i, round_off in enumerate(noise, n):
            if round_off:
                scales[i], constant[i] = 0.0, False
        for i, given in enumerate(self.given):
            if given:
                scales[i], constant[i] = given, False
        return Scales(scales, sizes, paces, constant)


def _differ(one: Sequence[float], other: Sequence[float], kept: Sequence[bool] | None) -> list[float]:
    """The magnitudes of the differences of two columns, at the places that are `kept` (None: all)."""
    gaps = map(abs, map(sub, one, other))
    return [*gaps] if kept is None else [*compress(gaps, kept)]


def compared(kept: Sequence[int]) -> list[int]:
    """The times of `kept` at which outputs are compared; the last one is among them."""
    return sorted(kept[:: -max(len(kept) // COMPARED, 1)])


def _passing(one: Trajectory, other: Trajectory) -> set[int]:
    """The indices of recorded times at which one run has passed an event that the other reaches a moment
    later: outputs may jump there."""
    if not (one.events and other.events):
        return set()
    times = [[t for t, _ in run.events] for run in (one, other)]
    most, found = MOST_APART * abs(one.times[-1] - one.times[0]), set[int]()
    for k, (t, u) in enumerate(zip(one.times, other.times)):
        i, j = bisect_right(times[0], t), bisect_right(times[1], u)
        passed = min(i, j)
        if i != j and passed < min(len(times[0]), len(times[1])):
            same = one.events[passed][1] == other.events[passed][1]
            if same and abs(times[0][passed] - times[1][passed]) <= most:
                found.add(k)
    return found


def _term_sizes(system: System, run: Trajectory) -> tuple[list[float], list[bool]]:
    """The size of the terms of each output: its largest value, or its change if every state is perturbed by
    a small part, over that part (stochastic arithmetic: J. Vignes, Math. Comput. Simul. 35, 1993). And
    whether the output is nothing but round-off: its values are as small as these changes, which do not grow
    with the perturbation."""
    from lagc.simulation.global_error.roundoff_estimate import generic, picked

    largest, changes, farther = ([0.0] * len(system.interface.outputs) for _ in range(3))

    def widen(sizes: list[float], values: Iterable[float]) -> list[float]:
        return [max(size, abs(y)) if isfinite(y) else size for size, y in zip(sizes, values)]

    for k in picked(run):
        t, x = run.times[k], run.states[k]
        draws = [[generic(7 * i + k + 3 * draw) for i in range(len(x))] for draw in range(2)]
        moved = [[a * (1.0 + off * r) for a, r in zip(x, drawn)]
                 for off in (OFF, FARTHER * OFF) for drawn in draws]  # fmt: skip
        here, *rows = zip(*system.on(t, x).output_columns([t] * 5, [x, *moved]))
        largest = widen(largest, here)
        for near, far in zip(rows[:2], rows[2:]):
            changes, farther = widen(changes, map(sub, here, near)), widen(farther, map(sub, here, far))
    noise = [0.0 < y <= ALIKE * c and d <= ALIKE * c for y, c, d in zip(largest, changes, farther)]
    return [max(y, c / OFF) for y, c in zip(largest, changes)], noise


def _paces(
    system: System, run: Trajectory, doubtful: Sequence[int], nothing: Sequence[bool], sizes: Sequence[float]
) -> list[float]:
    """The pace of each quantity among `doubtful`, at some recorded states; infinite for the others, and 0 for
    those whose range is `nothing`."""
    from lagc.simulation.global_error.roundoff_estimate import picked

    n, ny = system.nq + system.nv, len(system.interface.outputs)
    found = [inf] * len(sizes)
    for i in doubtful:
        found[i] = 0.0 if nothing[i] or i < n + ny else inf
    left = [i for i in doubtful if i < n + ny and not nothing[i]]
    for k in picked(run)[::2] if left else ():
        t, x = run.times[k], run.states[k]
        on = system.on(t, x)
        rates = rates_at(on, t, x)
        time = 0.0 if rates is None else _time_scale(system.interface, sizes, rates)
        if rates is None or not isfinite(time):
            continue
        step, outputs = PART * time, [0.0] * ny
        if any(i >= n for i in left):
            shifts = [s * step for s in (-2.0, -1.0, 1.0, 2.0)]
            columns = on.output_columns(
                [t + s for s in shifts], [[y + s * r for y, r in zip(x, rates)] for s in shifts]
            )
            outputs = [(8.0 * (r - q) - (u - p)) / (12.0 * PART) for p, q, r, u in columns]
        for i in left:
            pace = abs(rates[i]) * time / sizes[i] if i < n else abs(outputs[i - n]) / sizes[i]
            if not pace <= found[i]:
                found[i] = pace
    return found


def _time_scale(interface: Interface, sizes: Sequence[float], rates: Sequence[float]) -> float:
    """The shortest time in which a scaling group changes by its own size; infinite at rest."""
    shortest = inf
    for group in scaling_groups(interface):
        size, rate = (max(abs(values[i]) for i in group) for values in (sizes, rates))
        if rate > 0.0 and size > 0.0:
            shortest = min(shortest, size / rate)
    return shortest
