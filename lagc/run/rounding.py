"""What rounding does to a motion: the part of its error that runs of every tolerance share.

First a quick look at four of the recorded states, from above; where that may matter, a close one at a
dozen.  The equations are evaluated again with each state changed in its last place, and arithmetic
rounded up and down (backward errors: N. J. Higham, *Accuracy and Stability of Numerical Algorithms*, SIAM
2002, ch. 1; rounding modes as a probe: W. Kahan, *How futile are mindless assessments of roundoff*, 2006):
what comes out as usual one way, as a sum that happens to be rounded so, does not the other.  What changes
stands for all along the motion, as an ill-conditioned mass matrix is wrong in the same way at every step.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from lagc.run.problem import FAILED, System, Trajectory

ULP = 2.0**-52
SAMPLES = 12  # of the recorded states
UNSEEN = 10.0  # what a quick look may miss

Groups = Sequence[tuple[Sequence[int], float]]
Look = tuple[int, list[float], list[float]]  # where, what rates of each kind change by, the rates


def rounding_drift(system: System, trajectory: Trajectory, groups: Groups, harmless: float) -> float:
    """How far rounding moves the states, relative to their sizes, where differences do not grow.

    `groups`: the indices of the states of each kind, and their size.  Up to `harmless` it is a bound, from
    a quick look.
    """
    picked = _picked(trajectory)
    if not picked:
        return 0.0
    bound = _quick(system, trajectory, groups, picked)
    return bound if bound <= harmless else _close(system, trajectory, groups, picked)


def _picked(trajectory: Trajectory) -> list[int]:
    n = len(trajectory.states)
    return sorted({k * (n - 1) // SAMPLES for k in range(SAMPLES + 1)}) if n else []


def _quick(system: System, trajectory: Trajectory, groups: Groups, picked: list[int]) -> float:
    """A bound, from the first state, the last and the fastest between; infinite where it is not told."""
    states, times = trajectory.states, trajectory.times
    moving = [(group, size) for group, size in groups if size > 0.0]
    speeds = [(group, size) for group, size in moving if group[-1] >= system.nq]

    def pace(k: int) -> float:
        return sum(abs(states[k][i]) / size for group, size in speeds for i in group)

    if trajectory.fallbacks:
        return float("inf")
    where = sorted({0, max(picked, key=pace), picked[len(picked) // 2], picked[-1]})
    plain = [_rates(system, times[k], states[k]) for k in where]
    at = [times[k] for k in where], [_shifted(states[k], k) for k in where]
    worst = 0.0
    for one, up, down in zip(plain, _rounded(system, *at, 1), _rounded(system, *at, -1)):
        if one is None or up is None or down is None:
            return float("inf")
        changes = _changes(one, [up, down], moving)
        worst = max([worst, *(c / size for c, (_, size) in zip(changes, moving))])
    return UNSEEN * worst * abs(times[-1] - times[0])


def _rounded(
    system: System, times: Sequence[float], states: Sequence[Sequence[float]], way: int
) -> list[list[float] | None]:
    """The rates with arithmetic rounded up or down: in calls of compiled code, else in another thread."""
    found: list[list[float] | None] = []
    for t, x in zip(times, states):
        xdot, lam = [0.0] * system.nx, [0.0] * system.nc
        status = system.rounded(t, x, xdot, lam, way)
        if status is None:
            break
        found.append(None if status in FAILED else xdot)
    else:
        return found
    from lagc.run.directed import apart, directed

    def work() -> list[list[float] | None]:
        with directed(way):
            return [_rates(system, t, x) for t, x in zip(times, states)]

    return apart(work)


def _shifted(x: Sequence[float], k: int) -> list[float]:
    """Every state changed in its last place, up or down by a rule without pattern, another at each k."""
    return [a * (1.0 + (ULP if (i * 0x9E3779B1 + k * 0x85EBCA6B) & 0x4000 else -ULP))
            for i, a in enumerate(x)]  # fmt: skip


def _changes(plain: Sequence[float], others: Sequence[Sequence[float]], groups: Groups) -> list[float]:
    return [max(abs(f[i] - plain[i]) for f in others for i in group) for group, _ in groups]


def _rates(system: System, t: float, x: Sequence[float]) -> list[float] | None:
    xdot, lam = [0.0] * system.nx, [0.0] * system.nc
    return None if system.rhs(t, x, xdot, lam) in FAILED else xdot


def _close(system: System, trajectory: Trajectory, groups: Groups, picked: list[int]) -> float:
    """From all of the picked states.  A kind whose rates are nothing but rounding is at rest, and left out.
    Around each state, a kind moves by the change of its rate over the time, and by no more than that share
    of the way that it goes: a close encounter is short."""
    from lagc.run.directed import apart

    looks = apart(lambda: _looks(system, trajectory, groups, picked))
    n = len(trajectory.states)
    bounds = [0, *((a + b) // 2 for (a, _, _), (b, _, _) in pairwise(looks)), n - 1]
    total = 0.0
    for (_, changes, rates), first, last in zip(looks, bounds, bounds[1:]):
        time = abs(trajectory.times[last] - trajectory.times[first])
        worst = 0.0
        for j, (group, size) in enumerate(groups):
            alive = max(r[j] for _, _, r in looks) > 100.0 * max(c[j] for _, c, _ in looks)
            if size > 0.0 and alive:
                way = _way(trajectory, group, first, last)
                moved = changes[j] * (min(time, way / rates[j]) if rates[j] > 0.0 else time)
                worst = max(worst, moved / size)
        total += worst
    return total


def _looks(system: System, trajectory: Trajectory, groups: Groups, picked: list[int]) -> list[Look]:
    """Where the rates can be told: as they are, and twice with other rounding."""
    from lagc.run.directed import directed

    looks = []
    for k in picked:
        found = []
        for way in (0, 1, -1):
            x = trajectory.states[k]
            moved = [a * (1.0 + (way if i % 2 else -way) * ULP) for i, a in enumerate(x)]
            with directed(way):
                found.append(_rates(system, trajectory.times[k], moved))
        told = [f for f in found if f is not None]
        if len(told) == 3:
            rates = [max(abs(told[0][i]) for i in group) for group, _ in groups]
            looks.append((k, _changes(told[0], told[1:], groups), rates))
    return looks


def _way(trajectory: Trajectory, group: Sequence[int], first: int, last: int) -> float:
    """How far the states of one kind go between two recorded times; turns that the recorded states do not
    show are as many as there are more steps."""
    states = trajectory.states[first : last + 1]
    way = sum(max(abs(y[i] - x[i]) for i in group) for x, y in pairwise(states))
    return way * max(1.0, trajectory.steps / max(len(trajectory.states) - 1, 1))
