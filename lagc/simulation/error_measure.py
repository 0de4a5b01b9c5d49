"""Sizes of scaling groups, differences between trajectories, and the times at which these are compared."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from itertools import pairwise
from math import ceil, inf, isfinite
from operator import sub

from lagc.lowering.program import Interface
from lagc.simulation.system import TERMINATED, Trajectory

NEAR_THE_END = 1e-5  # of the time
FEWEST_PARTS = 32  # of the time, for a comparison of runs
ASIDE = 32  # times without a pattern, for the ranges of outputs

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


def scaling_groups(interface: Interface) -> list[list[int]]:
    """The indices of the coordinates and speeds that share a scale."""
    groups: dict[int, list[int]] = {}
    for i, kind in enumerate(interface.kinds):
        groups.setdefault(kind, []).append(i)
    return list(groups.values())


def quantity_names(interface: Interface) -> list[str]:
    fields = (*interface.outputs, *interface.discretes)
    return [*interface.state_names, *(field.name for field in fields)]


def quantity_units(interface: Interface) -> list[str]:
    fields = (*interface.outputs, *interface.discretes)
    return [*interface.state_units, *(field.unit for field in fields)]


def state_groups(interface: Interface) -> list[list[int]]:
    """The indices of coordinates and speeds that are one quantity: the components of a quaternion, else each
    alone."""
    found, parts = list[list[int]](), {k + i for k in interface.quaternions for i in range(4)}
    for i in range(interface.nq + interface.nv):
        if i in interface.quaternions:
            found.append([i, i + 1, i + 2, i + 3])
        elif i not in parts:
            found.append([i])
    return found


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


def spread(a: Trajectory, b: Trajectory, of_a: Sizes, of_b: Sizes) -> float:
    """The largest scaled difference of two runs over the same times, with the sizes of each."""
    left_out, worst = between(a, b), apart_in_time(a, b)
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


def apart_in_time(a: Trajectory, b: Trajectory) -> float:
    """The largest difference between the times of jumps, and of termination, relative to the whole time."""
    pairs = [*zip(a.jumps, b.jumps)]
    if TERMINATED in (a.status, b.status):
        pairs.append((a.times[-1], b.times[-1]))
    span = max((abs(run.times[-1] - run.times[0]) for run in (a, b)), default=0.0)
    far = max((abs(t - u) for t, u in pairs), default=0.0)
    return far / span if span > 0.0 else 0.0


class ComparisonGrid:
    """The times at which runs are compared: those that are recorded, and times between these if they are few.
    Two runs may have equal errors at one or two times by chance, but seldom along the whole motion. `aside`
    more times follow no pattern: the recorded times may always meet an output at the same phase, and then do
    not show its range."""

    def __init__(self, recorded: Sequence[float], aside: int = 0):
        parts = ceil(FEWEST_PARTS / max(len(recorded) - 1, 1))  # of each recorded interval
        times = [a + (b - a) * (k / parts) for a, b in pairwise(recorded) for k in range(parts)]
        times += recorded[-1:]
        last, more = len(times) - 1, list[float]()
        for k in range(aside if last > 0 else 0):
            j = k * last // aside
            more.append(times[j] + (times[j + 1] - times[j]) * (0.6180339887498949 * (k + 1) % 1.0))
        marked = sorted([*((t, k % parts == 0) for k, t in enumerate(times)), *((t, False) for t in more)])
        self.times = [t for t, _ in marked]
        self._places = [k for k, (_, asked) in enumerate(marked) if asked]

    def recorded(self, run: Trajectory) -> Trajectory:
        if len(self._places) == len(self.times):
            return run
        kept = self._places[: bisect_left(self._places, len(run.times))]
        return run.changed(times=[run.times[k] for k in kept], states=[run.states[k] for k in kept])
