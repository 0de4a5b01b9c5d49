"""What rounding brings to a motion and what becomes of it, told by runs whose start is displaced as rounding
displaces it.

The coarse pilot begins displaced by DISPLACED.  It parts from a finer run by its own errors and by what has
become of the displacement: that bounds the growth at no cost.  Where the bound does not show rounding to be
harmless, one more run displaced by FAR tells the growth, as its own errors are little beside that.  Where so
much does not stay small, two runs displaced to either side by MAGNIFIED times the rounding tell it: of one
tolerance, they mostly err alike.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import accumulate
from math import inf, sqrt

from lagc.run.distance import Sizes, spread
from lagc.run.problem import FAILED, INTERRUPTED, OK, System, Trajectory
from lagc.run.rounding import ULP, Quick, close_look, quick_bound

LITTLE = 10.0  # of growth: a distance that tells no more may be all displacement
DISPLACED = 1e-7  # of the sizes: less than the errors of the coarse pilot in most motions
FAR = 1e-4  # of the sizes: more than these errors in most motions
MAGNIFIED = 100.0  # rounding in itself is too little to be told from that of the run
NEWTON = 4  # steps: each takes away all but about a part FAR of what is missed
LINEAR = 1e-2  # of the sizes: what is no larger grows in proportion
ROUGHLY = 3.0  # on what rounding is seen to bring at a few states

Integrate = Callable[[float, Sequence[float], float], Trajectory]  # tolerance, start, first step


class Rounding:
    """Of the motion `run`, whose states have the sizes `groups`; `look` is the quick one at it, `coarse` the
    tolerance of the pilot.

    `beside` is the displaced pilot; `bound` of the growth is infinite where it tells none.
    """

    def __init__(self, system: System, run: Trajectory, groups: Sizes, look: Quick, coarse: float,
                 integrate: Integrate):  # fmt: skip
        self.system, self.run, self.groups, self.integrate = system, run, groups, integrate
        changes, self.way = look
        self.quick = quick_bound(run, groups, changes)
        self.beside = self._displaced(coarse, DISPLACED)
        self.bound = self.bounded(run)
        self.measured: list[float] | None = None  # at the recorded times

    def hides(self, accuracy: float) -> bool:
        """Whether it may be the displacement that keeps the pilots apart by more than `accuracy`."""
        return self.bound == inf or accuracy < self.bound * DISPLACED < LITTLE * DISPLACED

    def bounded(self, run: Trajectory) -> float:
        """The bound that the distance to `run` tells."""
        apart = self._apart(self.beside, run)
        return apart / DISPLACED if apart <= LINEAR else inf

    def of(self, runs: Mapping[float, Trajectory], groups: Sizes, harmless: float) -> tuple[float, float]:
        """What rounding brings to the finest of the runs (by their tolerances) where differences do not
        grow, and with their growth: bounds, where the latter is up to `harmless`."""
        if self.measured is None and self.quick * self.bound <= harmless:
            return self.quick, self.quick * self.bound
        looks = close_look(self.system, runs[min(runs)], groups)
        drift = sum(moved for _, moved in looks)
        if drift == 0.0 or (self.measured is None and drift * self.bound <= harmless):
            return drift, drift and drift * self.bound
        if self.measured is None:
            self.measured = self._measure(runs, ROUGHLY * drift)
        # What begins at k grows as what began before, or as much as from the start in the time that is left.
        # Where that differs from time to time, the rounding of each step counts by itself.
        before = [*accumulate(self.measured, max)]
        squares = sum((moved * max(before[-1] / before[k], before[-1 - k])) ** 2 for k, moved in looks)
        alone = max(1.0, runs[min(runs)].steps / len(looks))
        return ROUGHLY * drift, ROUGHLY * max(drift, sqrt(squares / alone))

    def until(self, drift: float, accuracy: float) -> float:
        """The time up to which rounding stays below `accuracy`, where its growth was measured."""
        times = self.run.times
        grown = accumulate(self.measured or [0.0] * len(times), max)
        return max((t for t, g in zip(times, grown) if drift * g <= accuracy), default=times[0])

    def _measure(self, runs: Mapping[float, Trajectory], drift: float) -> list[float]:
        """Of differences from the start, at each recorded time: by one side where the other does not arrive,
        without end where neither does; none where displaced runs cannot even begin."""
        fine = back = runs[min(runs)]
        tol = max(tol for tol, run in runs.items() if self._apart(run, fine) <= LINEAR)
        near, by = self.bound < inf, FAR  # where the first displacement grew large, a larger one is vain
        there = self._displaced(tol, FAR) if near else self.beside
        if there.status != INTERRUPTED and not (near and self._apart(there, fine) <= LINEAR):
            # kinds that rest but for the displacement would choose their first step by rounding
            step = 0.1 * abs(self.run.times[-1] - self.run.times[0]) / max(self.run.steps, 1)
            by = MAGNIFIED * max(drift, ULP)
            sides = [self._displaced(tol, side, step) for side in (by, -by)]
            if any(run.status != OK for run in sides):
                sides = [self._displaced(tol, 0.0, step), *sorted(sides, key=lambda run: -len(run.states))]
                there, back = sides[:2]
            else:
                there, back = sides
                by *= 2.0
        known = min(len(there.states), len(back.states))
        if known < 2:
            return [1.0] * len(fine.states)
        moving = [(group, by * size) for group, size in self.groups if size > 0.0]
        grown = [max([1.0, *(abs(x[i] - y[i]) / size for group, size in moving for i in group)])
                 for x, y in zip(there.states, back.states)]  # fmt: skip
        return grown + [inf] * (len(fine.states) - known)

    def _displaced(self, tol: float, by: float, step: float = 0.0) -> Trajectory:
        """From the start moved in the way of rounding by that much of the sizes."""
        parts = [(i, self.way[i] / size) for group, size in self.groups if size > 0.0 for i in group]
        largest = max((abs(part) for _, part in parts), default=0.0)
        x = list(self.run.states[0])
        for i, _ in parts if largest > 0.0 else ():
            x[i] += by * (self.way[i] / largest)
        return self.integrate(tol, _consistent(self.system, self.run.times[0], x), step)

    def _apart(self, run: Trajectory, other: Trajectory) -> float:
        """Of the sizes; infinite where a run did not arrive."""
        arrived = run.status == other.status == OK
        return spread(run, other, self.groups, self.groups) if arrived else inf


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
