"""What rounding brings to a motion and what becomes of it.

The coarse pilot begins displaced by DISPLACED in the way of rounding.  It parts from a finer run by its own
errors and by what has become of the displacement: that bounds the growth at no cost.  Where the bound does
not show rounding to be harmless, one more run displaced by FAR tells the growth, as its own errors are
little beside that.  Where so much does not stay small, growth from the start says little of growth from
later on: a run is made twice more, with arithmetic rounded up and down by turns, and oppositely.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import accumulate
from math import hypot, inf, sqrt

from lagc.simulation.error_measure import Sizes, between, spread
from lagc.simulation.global_error.rounding import Quick, close_look, jolted, nudged, quick_bound
from lagc.simulation.system import FAILED, INTERRUPTED, System, Trajectory, arrived

LITTLE = 10.0  # of growth: a distance that tells no more may be all displacement
DISPLACED = 1e-7  # of the sizes: less than the errors of the coarse pilot in most motions
FAR = 1e-4  # of the sizes: more than these errors in most motions
NEWTON = 4  # steps: each takes away all but about a part FAR of what is missed
LINEAR = 1e-2  # of the sizes: what is no larger grows in proportion
ROUGHLY = 3.0  # on what rounding is seen to bring at a few states
BIASED = 0.3  # of what the same direction of all rounding in a slice adds up to

Looks = Sequence[tuple[int, float]]  # where, how far
Integrate = Callable[[float, Sequence[float], int], Trajectory]  # tolerance, start, way of rounding


class Rounding:
    """Of the motion `run`, whose states have the sizes `groups`; `look` is the quick one at it, `coarse` the
    tolerance of the pilot.

    `beside` is the displaced pilot; `bound` of the growth is infinite where it tells none.
    """

    def __init__(self, system: System, run: Trajectory, groups: Sizes, look: Quick, coarse: float,
                 integrate: Integrate):  # fmt: skip
        self.system, self.run, self.groups, self.integrate = system, run, groups, integrate
        changes, self.way = look
        self.quick = quick_bound(system, run, groups, changes)
        self.beside = self._displaced(coarse, DISPLACED)
        self.bound = self.bounded(run)
        self.grown: list[float] | None = None  # differences from the start, up to each recorded time
        self.looked: tuple[Trajectory, Looks] | None = None  # closely
        self.moved: list[float] = []  # by rounding, up to each recorded time: what was measured last

    def hides(self, accuracy: float) -> bool:
        """Whether it may be the displacement that keeps the pilots apart by more than `accuracy`."""
        return self.bound == inf or accuracy < self.bound * DISPLACED < LITTLE * DISPLACED

    def bounded(self, run: Trajectory) -> float:
        """The bound that the distance to `run` tells."""
        apart = self._apart(self.beside, run)
        return apart / DISPLACED if apart <= LINEAR else inf

    def drift(self, run: Trajectory, groups: Sizes, harmless: float) -> float:
        """What rounding brings to `run` where differences do not grow: a bound, a rough one to `harmless`."""
        if self.quick <= harmless:
            return self.quick
        return ROUGHLY * sum(moved for _, moved in self._looks(run, groups))

    def of(self, runs: Mapping[float, Trajectory], groups: Sizes, least: float, harmless: float,
           bearable: float) -> float:  # fmt: skip
        """What rounding brings to the finest of the runs (by their tolerances): a bound, where that is up to
        `harmless`; up to `bearable`, roughly.  Differences grow by `least` or more."""
        bound = max(self.bound, least)
        if self.quick * bound <= harmless:
            return self.quick * bound
        fine = runs[min(runs)]
        looks = self._looks(fine, groups)
        drift = sum(moved for _, moved in looks)
        if drift == 0.0 or drift * bound <= harmless:
            return drift and drift * bound
        if self.grown is None:
            self.grown = self._growth(self._coarse(runs), fine) if self.bound < inf else []
        if self.grown:
            self.moved = [ROUGHLY * drift * grown for grown in self.grown]
            return ROUGHLY * max(drift, drift * least, self._spread(looks, fine.steps))
        return self.seen(runs, groups, bearable)

    def seen(self, runs: Mapping[float, Trajectory], groups: Sizes, bearable: float) -> float:
        """The same as runs that are rounded otherwise tell: coarse ones, if that is up to `bearable`."""
        steps = runs[min(runs)].steps
        for tol in sorted({self._coarse(runs), min(runs)}, reverse=True):
            self.moved = self._seen(tol, runs[tol], groups, steps)
            if self.moved[-1] <= bearable:
                break
        return self.moved[-1]

    def _coarse(self, runs: Mapping[float, Trajectory]) -> float:
        """The tolerance of the coarsest that follows the finest."""
        fine = runs[min(runs)]
        return max(tol for tol, run in runs.items() if run is fine or self._apart(run, fine) <= LINEAR)

    def until(self, accuracy: float) -> float:
        """The time up to which rounding stays below `accuracy`, where it was measured."""
        times = self.run.times
        moved = self.moved or [0.0] * len(times)
        return max((t for t, far in zip(times, moved) if far <= accuracy), default=times[0])

    def _looks(self, run: Trajectory, groups: Sizes) -> Looks:
        if self.looked is None or self.looked[0] is not run:
            looks = close_look(self.system, run, groups)
            self.looked = run, [*looks, (0, jolted(self.system, run, groups))]
        return self.looked[1]

    def _growth(self, tol: float, run: Trajectory) -> list[float]:
        """Of differences from the start, up to each recorded time; nothing where they do not stay small."""
        there = self._displaced(tol, FAR)
        if there.status != INTERRUPTED and not self._apart(there, run) <= LINEAR:
            return []
        moving = [(group, FAR * size) for group, size in self.groups if FAR * size > 0.0]
        left_out = between(there, run)
        grown = [max([1.0, *(abs(x[i] - y[i]) / size for group, size in moving for i in group)])
                 if k not in left_out else 1.0
                 for k, (x, y) in enumerate(zip(there.states, run.states))]  # fmt: skip
        return [*accumulate(grown, max), *[inf] * (len(run.states) - len(grown))]

    def _spread(self, looks: Looks, steps: int) -> float:
        """What was seen at some states, grown: what begins at one grows as what began before, or as much as
        from the start in the time that is left.  Where that differs from time to time, the rounding of each
        step counts by itself."""
        grown = self.grown or [1.0]
        if grown[-1] == inf:
            return inf
        whole = hypot(*(moved * max(grown[-1] / grown[k], grown[-1 - k]) for k, moved in looks))
        return whole / sqrt(max(1.0, steps / len(looks)))

    def _seen(self, tol: float, run: Trajectory, groups: Sizes, steps: int) -> list[float]:
        """How far rounding moves `run`, of that tolerance, up to each recorded time, of the sizes; in `steps`
        it is as much more as these are.

        What two runs are away from it that are rounded oppositely has two parts.  One is chance, as the
        rounding of the run itself, and greater: that errs by up to half a last place, these by half of one
        beside their mean.  The other, half of the distance between them, is what the same direction of all
        rounding in a slice adds up to: of it, a part.  By one where the other does not arrive, without end
        where neither does.
        """
        sides: list[Trajectory] = []
        for way in (1, -1):
            if not sides or sides[0].status != INTERRUPTED:
                sides.append(self.integrate(tol, nudged(run.states[0], way), way))
        more = max(1.0, steps / max(run.steps, 1))
        left_out = {k for side in sides for k in between(side, run)}
        moving = [(i, more / size) for group, size in groups if size > 0.0 for i in group]
        found = []
        for k, x in enumerate(run.states):
            there = [side.states[k] for side in sides if k < len(side.states)]
            far = 0.0 if there else inf
            if k in left_out:
                there = []
            for i, part in moving if there else ():
                y, z = there[0][i], there[-1][i]
                far = max(far, part * (abs((y - x[i]) + (z - x[i])) + BIASED * abs(y - z)))
            found.append(far)
        return [*accumulate(found, max)]

    def _displaced(self, tol: float, by: float) -> Trajectory:
        """From the start moved in the way of rounding by that much of the sizes."""
        parts = [(i, self.way[i] / size) for group, size in self.groups if size > 0.0 for i in group]
        largest = max((abs(part) for _, part in parts), default=0.0)
        x = list(self.run.states[0])
        for i, _ in parts if largest > 0.0 else ():
            x[i] += by * (self.way[i] / largest)
        return self.integrate(tol, _consistent(self.system, self.run.times[0], x), 0)

    def _apart(self, run: Trajectory, other: Trajectory) -> float:
        """Of the sizes; infinite where a run did not arrive."""
        alike = run.status == other.status and arrived(run)
        return spread(run, other, self.groups, self.groups) if alike else inf


def _consistent(system: System, t: float, x: list[float]) -> list[float]:
    """`x` near its constraints, put back onto them by simplified Newton steps."""
    if system.nc == 0 or system.assemble(t, x) in FAILED:
        return x
    nq, nv, others = system.nq, system.nv, [0.0] * (system.nc - system.nh)
    for _ in range(NEWTON if system.nh else 0):
        d = system.solve([0.0] * nv + [-a for a in system.position(t, x)] + others)
        x = [a + b for a, b in zip(x, system.displace(t, x, d[:nv]))] + x[nq:]
    for _ in range(NEWTON):
        d = system.solve([0.0] * nv + [-a for a in system.velocity(t, x)])
        x = x[:nq] + [a + b for a, b in zip(x[nq:], d[:nv])] + x[nq + nv :]
    return x
