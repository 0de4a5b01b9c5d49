"""The part of the global error that round-off causes, and its growth along the motion.

The coarse pilot run starts from a state displaced by DISPLACED in the direction of round-off.  Its distance
to a finer run bounds the growth of perturbations at no cost.  If the bound is too large, one more run
displaced by FAR measures the growth.  If such a displacement does not stay small, growth from the start
says little about later growth; then two runs with arithmetic rounded up and down in turns measure the
effect of round-off itself.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import accumulate
from math import hypot, inf, sqrt

from lagc.simulation.error_measure import Sizes, between, spread
from lagc.simulation.global_error.roundoff_estimate import (
    Quick,
    close_estimate,
    event_shift,
    neighbour,
    quick_bound,
)
from lagc.simulation.system import FAILED, INTERRUPTED, System, Trajectory, arrived

LITTLE = 10.0  # growth: a smaller distance may be all displacement
DISPLACED = 1e-7  # of the sizes: less than the errors of the coarse pilot in most motions
FAR = 1e-4  # of the sizes: more than these errors in most motions
NEWTON = 4  # steps; each reduces the residual to about FAR times itself
LINEAR = 1e-2  # of the sizes: smaller perturbations grow in proportion
ROUGHLY = 3.0  # factor on the round-off estimated at a few states
BIASED = 0.3  # share of the distance of oppositely rounded runs that counts as systematic

Estimates = Sequence[tuple[int, float]]  # index of the recorded state, effect
Integrate = Callable[
    [float, Sequence[float], int], Trajectory
]  # tolerance, initial state, rounding direction


class Rounding:
    """The effect of round-off on the motion `run`. `groups` are the scaling groups with their sizes,
    `estimate` the quick estimate of round-off, `coarse` the tolerance of the pilot.  `beside` is the
    displaced pilot, and `bound` the bound of the growth, infinite if unknown."""

    def __init__(self, system: System, run: Trajectory, groups: Sizes, estimate: Quick, coarse: float,
                 integrate: Integrate):  # fmt: skip
        self.system, self.run, self.groups, self.integrate = system, run, groups, integrate
        changes, self.direction = estimate
        self.quick = quick_bound(system, run, groups, changes)
        self.beside = self._displaced(coarse, DISPLACED)
        self.bound = self.bounded(run)
        self.grown: list[float] | None = None  # differences from the start, up to each recorded time
        self.estimated: tuple[Trajectory, Estimates] | None = None  # the close estimate
        self.moved: list[float] = []  # the effect of round-off up to each recorded time, measured last

    def hides(self, accuracy: float) -> bool:
        """Whether the displacement may keep the pilots apart by more than `accuracy`."""
        return self.bound == inf or accuracy < self.bound * DISPLACED < LITTLE * DISPLACED

    def bounded(self, run: Trajectory) -> float:
        """The bound of the growth from the distance to `run`."""
        apart = self._apart(self.beside, run)
        return apart / DISPLACED if apart <= LINEAR else inf

    def drift(self, run: Trajectory, groups: Sizes, harmless: float) -> float:
        """The effect of round-off on `run` without growth; a quick bound if it is below `harmless`."""
        if self.quick <= harmless:
            return self.quick
        return ROUGHLY * sum(moved for _, moved in self._estimates(run, groups))

    def of(self, runs: Mapping[float, Trajectory], groups: Sizes, least: float, harmless: float,
           bearable: float) -> float:  # fmt: skip
        """The effect of round-off on the finest run (of `runs`, by tolerance). A bound suffices below
        `harmless`, a rough value below `bearable`.  Perturbations grow by `least` or more."""
        bound = max(self.bound, least)
        if self.quick * bound <= harmless:
            return self.quick * bound
        fine = runs[min(runs)]
        estimates = self._estimates(fine, groups)
        drift = sum(moved for _, moved in estimates)
        if drift == 0.0 or drift * bound <= harmless:
            return drift and drift * bound
        if self.grown is None:
            self.grown = self._growth(self._coarse(runs), fine) if self.bound < inf else []
        if self.grown:
            self.moved = [ROUGHLY * drift * grown for grown in self.grown]
            return ROUGHLY * max(drift, drift * least, self._spread(estimates, fine.steps))
        return self.seen(runs, groups, bearable)

    def seen(self, runs: Mapping[float, Trajectory], groups: Sizes, bearable: float) -> float:
        """The effect of round-off from runs with directed rounding: coarse ones, if the result is below
        `bearable`."""
        steps = runs[min(runs)].steps
        for tol in sorted({self._coarse(runs), min(runs)}, reverse=True):
            self.moved = self._seen(tol, runs[tol], groups, steps)
            if self.moved[-1] <= bearable:
                break
        return self.moved[-1]

    def _coarse(self, runs: Mapping[float, Trajectory]) -> float:
        """The largest tolerance whose run follows the finest one."""
        fine = runs[min(runs)]
        return max(tol for tol, run in runs.items() if run is fine or self._apart(run, fine) <= LINEAR)

    def until(self, accuracy: float) -> float:
        """The time until which the effect of round-off is below `accuracy`, if it was measured."""
        times = self.run.times
        moved = self.moved or [0.0] * len(times)
        return max((t for t, far in zip(times, moved) if far <= accuracy), default=times[0])

    def effect(self, time: float, otherwise: float) -> float:
        """The effect of round-off up to `time`, a recorded one, if it was measured."""
        return self.moved[self.run.times.index(time)] if self.moved else otherwise

    def _estimates(self, run: Trajectory, groups: Sizes) -> Estimates:
        if self.estimated is None or self.estimated[0] is not run:
            estimates = close_estimate(self.system, run, groups)
            self.estimated = run, [*estimates, (0, event_shift(self.system, run, groups))]
        return self.estimated[1]

    def _growth(self, tol: float, run: Trajectory) -> list[float]:
        """The growth of perturbations from the start to each recorded time; empty if they do not stay
        small."""
        there = self._displaced(tol, FAR)
        if there.status != INTERRUPTED and not self._apart(there, run) <= LINEAR:
            return []
        moving = [(group, FAR * size) for group, size in self.groups if FAR * size > 0.0]
        left_out = between(there, run)
        grown = [max([1.0, *(abs(x[i] - y[i]) / size for group, size in moving for i in group)])
                 if k not in left_out else 1.0
                 for k, (x, y) in enumerate(zip(there.states, run.states))]  # fmt: skip
        return [*accumulate(grown, max), *[inf] * (len(run.states) - len(grown))]

    def _spread(self, estimates: Estimates, steps: int) -> float:
        """The effect of round-off estimated at some states, with growth. A perturbation that begins at a
        state grows as an earlier one does from there, or as one from the start in the time that remains.  If
        growth varies, the round-off of each step counts independently."""
        grown = self.grown or [1.0]
        if grown[-1] == inf:
            return inf
        whole = hypot(*(moved * max(grown[-1] / grown[k], grown[-1 - k]) for k, moved in estimates))
        return whole / sqrt(max(1.0, steps / len(estimates)))

    def _seen(self, tol: float, run: Trajectory, groups: Sizes, steps: int) -> list[float]:
        """The effect of round-off on `run` up to each recorded time, relative to the sizes.

        Two oppositely rounded runs differ from it by two parts.  The random part is the mean of both
        differences.  The systematic part is half of their distance; a share of it counts.  If one run fails,
        the other one counts alone; if both fail, the result is infinite.  `steps` scales the result to a run
        with more steps."""
        sides: list[Trajectory] = []
        for direction in (1, -1):
            if not sides or sides[0].status != INTERRUPTED:
                sides.append(self.integrate(tol, neighbour(run.states[0], direction), direction))
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
        """The run of tolerance `tol` from the initial state displaced in the direction of round-off, by
        that share of the sizes."""
        parts = [(i, self.direction[i] / size) for group, size in self.groups if size > 0.0 for i in group]
        largest = max((abs(part) for _, part in parts), default=0.0)
        x = list(self.run.states[0])
        for i, _ in parts if largest > 0.0 else ():
            x[i] += by * (self.direction[i] / largest)
        x = _consistent(self.system, self.run.times[0], x)
        if self.system.interface.contacts:
            x = self.system.seated(self.run.times[0], x)
        return self.integrate(tol, x, 0)

    def _apart(self, run: Trajectory, other: Trajectory) -> float:
        """The distance relative to the sizes; infinite if a run did not reach its end."""
        alike = run.status == other.status and arrived(run)
        return spread(run, other, self.groups, self.groups) if alike else inf


def _consistent(system: System, t: float, x: list[float]) -> list[float]:
    """Return `x`, near its constraints, projected onto them by simplified Newton steps."""
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
