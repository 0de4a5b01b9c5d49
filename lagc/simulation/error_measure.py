"""Differences between trajectories, relative to the sizes of their scaling groups."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from math import ceil, inf, isfinite
from operator import sub

from lagc.codegen.python.support.contacts import RESTS
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


def contacts_of(run: Trajectory) -> Sequence[tuple[float, int, int, float, float, float]]:
    """Return what contacts did, as `ContactTrajectory` has it; nothing without contacts."""
    found: Sequence[tuple[float, int, int, float, float, float]] = getattr(run, "contacts", ())
    return found


def jump_times(run: Trajectory) -> dict[object, list[float]]:
    """Return the times of jumps by what makes them: clauses `when`, and each contact between two rests. The
    end of ever shorter bounces is a jump of its own, since runs may follow more or fewer of them."""
    found: dict[object, list[float]] = {"when": [*run.jumps]}
    rests: dict[int, int] = {}
    for t, contact, kind, _, _, end in contacts_of(run):
        key = (contact, rests.get(contact, 0))
        if kind == RESTS:
            found[(*key, kind)] = [end]
            rests[contact] = key[1] + 1
        else:
            found.setdefault(key, []).append(t)
    return found


def last_bounces(run: Trajectory) -> list[tuple[float, float]]:
    """The times between which a contact rests that would still bounce."""
    return [(t, end) for t, _, kind, _, _, end in contacts_of(run) if kind == RESTS]


def between(a: Trajectory, b: Trajectory) -> frozenset[int]:
    """The indices of recorded times at which one run has passed a jump that the other reaches a moment later,
    or rests where the other still bounces. States are not compared there."""
    one, other = jump_times(a), jump_times(b)
    found: set[int] = set()
    for key in one.keys() | other.keys():
        found.update(_between(a, b, one.get(key, []), other.get(key, [])))
    bounces = [*last_bounces(a), *last_bounces(b)]
    found.update(k for k, t in enumerate(a.times) if any(begin <= t <= end for begin, end in bounces))
    return frozenset(found)


def _between(a: Trajectory, b: Trajectory, one: Sequence[float], other: Sequence[float]) -> Iterator[int]:
    if not (one or other):
        return
    both, last = min(len(one), len(other)), min(len(a.times), len(b.times)) - 1
    more = (one if len(one) > len(other) else other)[both:]
    at_the_end = _near_the_end(a if len(one) > len(other) else b, more)
    for k, (t, u) in enumerate(zip(a.times, b.times)):
        i, j = bisect_right(one, t), bisect_right(other, u)
        if i != j and (max(i, j) <= both or (k == last and at_the_end)):
            yield k


def _near_the_end(run: Trajectory, jumps: Sequence[float]) -> bool:
    """Whether jumps that only this run has are near its end."""
    near = NEAR_THE_END * abs(run.times[-1] - run.times[0])
    return all(abs(run.times[-1] - t) <= near for t in jumps)


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
    other = jump_times(b)
    pairs = [pair for key, own in jump_times(a).items() for pair in zip(own, other.get(key, ()))]
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
