"""Sizes of scaling groups, differences between trajectories, and the times at which these are compared."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import ceil, inf, isfinite
from operator import sub

from lagc.codegen.python.support.contacts import RESTS
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
    if bounces:
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
    other = jump_times(b)
    pairs = [pair for key, own in jump_times(a).items() for pair in zip(own, other.get(key, ()))]
    if TERMINATED in (a.status, b.status):
        pairs.append((a.times[-1], b.times[-1]))
    span = max((abs(run.times[-1] - run.times[0]) for run in (a, b)), default=0.0)
    far = max((abs(t - u) for t, u in pairs), default=0.0)
    return far / span if span > 0.0 else 0.0


class ComparisonGrid:
    """The times at which runs are compared: those that are recorded, and times between these if they are few.
    Two runs may have equal errors at one or two times by chance, but seldom along the whole motion.  `aside`
    are more times without a pattern: the recorded times may always meet an output at the same phase, and then
    do not show its range."""

    def __init__(self, recorded: Sequence[float], aside: int = 0):
        self._parts = ceil(FEWEST_PARTS / max(len(recorded) - 1, 1))  # of each recorded interval
        times = [a + (b - a) * (k / self._parts) for a, b in pairwise(recorded) for k in range(self._parts)]
        self.times = [*times, *recorded[-1:]]
        last, more = len(self.times) - 1, set[float]()
        for k in range(aside if last > 0 else 0):
            a, b = self.times[k * last // aside : k * last // aside + 2]
            more.add(a + (b - a) * (0.6180339887498949 * (k + 1) % 1.0))
        self.aside = sorted(more - {*self.times})

    def recorded(self, run: Trajectory) -> Trajectory:
        if self._parts == 1:
            return run
        return run.changed(times=run.times[:: self._parts], states=run.states[:: self._parts])
