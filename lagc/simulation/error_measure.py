"""Differences between trajectories, relative to the sizes of their scaling groups."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from itertools import pairwise
from math import ceil, inf, isfinite
from operator import sub

from lagc.lowering.program import Interface
from lagc.simulation.system import TERMINATED, Trajectory

NEAR_THE_END = 1e-5  # of the time
FEWEST_PARTS = 32  # of the time, for a comparison of runs

Sizes = Sequence[tuple[Sequence[int], float]]


def sizes(trajectory: Trajectory, interface: Interface) -> list[tuple[list[int], float]]:
    """Return the state indices of each scaling group and the largest magnitude of these states. The magnitude
    is taken over the recorded times and the ends of all steps."""
    largest = [max(max(column), -min(column)) for column in zip(*trajectory.states)]
    found = []
    for group in scaling_groups(interface):
        seen = [trajectory.sizes[interface.kinds[group[0]]]] if trajectory.sizes else [0.0]
        found.append((group, max(seen + [largest[i] for i in group] if largest else seen)))
    return found


def moving(groups: Sizes, noise: Mapping[int, float]) -> list[tuple[Sequence[int], float]]:
    """Return `groups` with size 0 for the groups (by number) that are no larger than their round-off
    `noise`."""
    return [(group, 0.0 if size <= noise.get(k, 0.0) else size) for k, (group, size) in enumerate(groups)]


def scaling_groups(interface: Interface) -> list[list[int]]:
    """The indices of the coordinates and speeds that share a scale."""
    groups: dict[int, list[int]] = {}
    for i, kind in enumerate(interface.kinds):
        groups.setdefault(kind, []).append(i)
    return list(groups.values())


def discrete_sizes(trajectory: Trajectory, interface: Interface) -> list[tuple[Sequence[int], float]]:
    """Return the state index of each discrete variable and its largest magnitude."""
    first = interface.nx - len(interface.discretes)
    return [
        ([i], max([abs(x[i]) for x in trajectory.states], default=0.0)) for i in range(first, interface.nx)
    ]


def between(a: Trajectory, b: Trajectory) -> frozenset[int]:
    """The indices of recorded times at which one run has passed a jump that the other reaches a moment later.
    States are not compared there."""
    if not (a.jumps or b.jumps):
        return frozenset()
    both, last, found = min(len(a.jumps), len(b.jumps)), min(len(a.times), len(b.times)) - 1, []
    for k, (t, u) in enumerate(zip(a.times, b.times)):
        i, j = bisect_right(a.jumps, t), bisect_right(b.jumps, u)
        if i != j and (max(i, j) <= both or (k == last and _at_the_end(a, b))):
            found.append(k)
    return frozenset(found)


def _at_the_end(a: Trajectory, b: Trajectory) -> bool:
    """Whether the jumps that only one of the runs has are near the end."""
    more, both = (a if len(a.jumps) > len(b.jumps) else b), min(len(a.jumps), len(b.jumps))
    near = NEAR_THE_END * abs(more.times[-1] - more.times[0])
    return all(abs(more.times[-1] - t) <= near for t in more.jumps[both:])


def difference(
    a: Trajectory,
    b: Trajectory,
    interface: Interface,
    target: float,
    noise: Mapping[int, float] | None = None,
) -> tuple[float, float | None]:
    """The largest scaled difference over the common times, and the last time until which it stays below
    `target`.

    The time is None if that is the end.  It is relative to the sizes until then, so that later growth does
    not hide earlier errors.  `noise` is the round-off of some groups by number; a group within its noise is
    not compared."""
    alike = [True] * min(len(a.states), len(b.states))
    largest, left_out = _apart_in_time(a, b), between(a, b)
    discrete = [[i] for i in range(interface.nx - len(interface.discretes), interface.nx)]
    for place, group in enumerate([*scaling_groups(interface), *discrete]):
        size = apart = 0.0
        limit = noise.get(place, 0.0) if noise else 0.0
        for k, (x, y) in enumerate(zip(a.states, b.states)):
            for i in group if k not in left_out else ():
                size = max(size, abs(x[i]), abs(y[i]))
                if not abs(x[i] - y[i]) <= apart:
                    apart = abs(x[i] - y[i])
            if not (apart <= target * size or size <= limit):
                alike[k] = False
        if not (apart <= largest * size or size <= limit):
            largest = apart / size if apart < inf else inf
    if not alike or alike[-1]:
        return largest, None
    return largest, a.times[max((k for k, same in enumerate(alike) if same), default=0)]


def spread(a: Trajectory, b: Trajectory, of_a: Sizes, of_b: Sizes) -> float:
    """The largest scaled difference of two runs over the same times, with the sizes of each."""
    left_out, worst = between(a, b), _apart_in_time(a, b)
    one, other = a.states, b.states
    if left_out:
        one, other = ([x for k, x in enumerate(s) if k not in left_out] for s in (one, other))
    columns = [*zip(zip(*one), zip(*other))]
    if not columns:
        return inf
    for (group, here), (_, there) in zip(of_a, of_b):
        size = max(here, there)
        for i in group if size > 0.0 else ():
            gaps = [*map(abs, map(sub, *columns[i]))]
            worst = max(worst, max(gaps) / size if isfinite(sum(gaps)) else inf)
    return worst


def _apart_in_time(a: Trajectory, b: Trajectory) -> float:
    """The largest difference between the times of jumps, and of termination, relative to the whole time."""
    pairs = [*zip(a.jumps, b.jumps)]
    if TERMINATED in (a.status, b.status):
        pairs.append((a.times[-1], b.times[-1]))
    span = max((abs(run.times[-1] - run.times[0]) for run in (a, b)), default=0.0)
    far = max((abs(t - u) for t, u in pairs), default=0.0)
    return far / span if span > 0.0 else 0.0


class ComparisonGrid:
    """The times at which runs are compared: those that are recorded, and times between these if they are few.
    Two runs may have equal errors at one or two times by chance, but seldom along the whole motion."""

    def __init__(self, recorded: Sequence[float]):
        self.parts = parts = ceil(FEWEST_PARTS / max(len(recorded) - 1, 1))  # of each recorded interval
        self.times = [a + (b - a) * (k / parts) for a, b in pairwise(recorded) for k in range(parts)]
        self.times += recorded[-1:]

    def recorded(self, run: Trajectory) -> Trajectory:
        if self.parts == 1:
            return run
        return run.changed(times=run.times[:: self.parts], states=run.states[:: self.parts])
