"""What rounding does to a motion: the part of its error that runs of every tolerance share.

First a quick look at four of the recorded states, from above; where that may matter, a close one at a
dozen.  The equations are evaluated again with each state changed in its last place, and arithmetic
rounded up and down, that on parameters too (backward errors: N. J. Higham, *Accuracy and Stability of
Numerical Algorithms*, SIAM 2002, ch. 1; rounding modes as a probe: W. Kahan, *How futile are mindless
assessments of roundoff*, 2006):
what comes out as usual one way, as a sum that happens to be rounded so, does not the other.  What changes
stands for all along the motion, as an ill-conditioned mass matrix is wrong in the same way at every step.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import inf, nextafter

from lagc.simulation.error_measure import Sizes
from lagc.simulation.system import FAILED, System, Trajectory, rates_at

ULP = 2.0**-52
SAMPLES = 12  # of the recorded states
# Of a rate, the rounding of a step, whose coefficients have last places too: where forces jump, a step may be
# as long as what is between, and exact but for these, which add up.
STEP = 16.0 * ULP
UNSEEN = 10.0  # what a quick look may miss

Quick = tuple[list[float], list[float]]
Look = tuple[int, list[float], list[float]]  # where, what each rate changes by, the rates


def picked(trajectory: Trajectory) -> list[int]:
    """A dozen of the recorded states."""
    n = len(trajectory.states)
    return sorted({k * (n - 1) // SAMPLES for k in range(SAMPLES + 1)}) if n else []


def quick_look(system: System, trajectory: Trajectory, groups: Sizes) -> Quick:
    """What rounding changes each rate by (infinite where that is not told), and the way in which it moves
    the states, at the start.

    `groups`: the indices of the states of each kind, and their size.  From the first state, the last and
    the fastest between.
    """
    states, times = trajectory.states, trajectory.times
    chosen = picked(trajectory)
    speeds = [(group, size) for group, size in groups if size > 0.0 and group[-1] >= system.nq]

    def pace(k: int) -> float:
        return sum(abs(states[k][i]) / size for group, size in speeds for i in group)

    where = sorted({0, max(chosen, key=pace), chosen[len(chosen) // 2], chosen[-1]})
    on = [system.on(times[k], states[k]) for k in where]
    plain = [rates_at(own, times[k], states[k]) for own, k in zip(on, where)]
    at = [times[k] for k in where], [_shifted(states[k], k) for k in where]
    least = _least(system)
    worst, span = [0.0] * system.nx, abs(times[-1] - times[0])
    way = [ULP * generic(i) * a for i, a in enumerate(states[0])]
    for k, one, up, down in zip(where, plain, rounded_rates(on, *at, 1), rounded_rates(on, *at, -1)):
        if one is None or up is None or down is None:
            worst = [inf] * system.nx
            continue
        worst = [max(w, abs(u - r), abs(d - r), least * abs(r)) for w, r, u, d in zip(worst, one, up, down)]
        a, b = span * generic(k), span * generic(-k - 1)
        way = [w + a * (u - r) + b * (d - r) for w, r, u, d in zip(way, one, up, down)]
    soon = span / max(trajectory.steps, 1)  # what moves the speeds moves the coordinates then
    moved = system.displace(times[0], states[0], way[system.nq : system.nq + system.nv])
    return worst, [w + soon * m for w, m in zip(way, moved)] + way[system.nq :]


def _least(system: System) -> float:
    return STEP if system.interface.switches else 0.0


def quick_bound(system: System, trajectory: Trajectory, groups: Sizes, changes: Sequence[float]) -> float:
    """How far rounding moves the states at most, relative to their sizes, where differences do not grow.
    Infinite where factors had to hold for any rank: a few states do not tell what those do."""
    if trajectory.fallbacks:
        return inf
    span = abs(trajectory.times[-1] - trajectory.times[0])
    worst = max((changes[i] / size for group, size in groups if size > 0.0 for i in group), default=0.0)
    return UNSEEN * worst * span + jolted(system, trajectory, groups)


def jolted(system: System, trajectory: Trajectory, groups: Sizes) -> float:
    """What is due to times at which switches changed being told to their last place, relative to the sizes of
    the states: in speeds, and in coordinates by these over the time."""
    jolts, nq = trajectory.event_roundoff, system.nq
    if not any(jolts):
        return 0.0
    span = abs(trajectory.times[-1] - trajectory.times[0])
    way = system.displace(trajectory.times[0], trajectory.states[0], jolts[nq : nq + system.nv])
    moved = [a + span * abs(b) for a, b in zip(jolts, way)] + [*jolts[nq:]]
    return max((moved[i] / size for group, size in groups if size > 0.0 for i in group), default=0.0)


def generic(k: int) -> float:
    """A number of magnitude 1/2 to 3/2, by a rule without pattern."""
    return (0.5 + 0.6180339887498949 * k % 1.0) * (1.0 if (k * 0x9E3779B1) & 0x4000 else -1.0)


def rounded_rates(
    systems: Sequence[System], times: Sequence[float], states: Sequence[Sequence[float]], way: int
) -> list[list[float] | None]:
    """The rates with arithmetic rounded up or down: in calls of compiled code, else in another thread."""
    found: list[list[float] | None] = []
    for system, t, x in zip(systems, times, states):
        xdot, lam = [0.0] * system.nx, [0.0] * system.nc
        status = system.rounded(t, x, xdot, lam, way)
        if status is None:
            break
        found.append(None if status in FAILED else xdot)
    else:
        return found
    from lagc.simulation.backends.directed_rounding import apart, directed

    def work() -> list[list[float] | None]:
        with directed(way):
            bound = [system.bind(system.parameters) for system in systems]
            return [rates_at(one, t, x) for one, t, x in zip(bound, times, states)]

    return apart(work)


def _shifted(x: Sequence[float], k: int) -> list[float]:
    """Every state changed in its last place, up or down by a rule without pattern, another at each k."""
    return [a * (1.0 + (ULP if (i * 0x9E3779B1 + k * 0x85EBCA6B) & 0x4000 else -ULP))
            for i, a in enumerate(x)]  # fmt: skip


def nudged(x: Sequence[float], way: int) -> list[float]:
    """Every state the next number, up or down by a rule without pattern; the other way for -1."""
    return [nextafter(a, inf if (i * 0x9E3779B1 & 0x4000 > 0) == (way > 0) else -inf) if a else a
            for i, a in enumerate(x)]  # fmt: skip


def close_look(system: System, trajectory: Trajectory, groups: Sizes) -> list[tuple[int, float]]:
    """How far rounding moves the states, around each of a dozen of the recorded.

    A kind of which every rate is nothing but rounding is at rest, and left out.  Around each state, a kind
    moves by the change of its rates over the time, and by no more than that share of the way that it goes: a
    close encounter is short.
    """
    from lagc.simulation.backends.directed_rounding import apart

    looks = apart(lambda: _looks(system, trajectory))
    n = len(trajectory.states)
    bounds = [0, *((a + b) // 2 for (a, _, _), (b, _, _) in pairwise(looks)), n - 1]
    changed, ran = ([max(values) for values in zip(*(look[j] for look in looks))] for j in (1, 2))
    moving = [(group, size) for group, size in groups
              if size > 0.0 and any(ran[i] > 100.0 * changed[i] for i in group if looks)]  # fmt: skip
    found = []
    for (k, changes, rates), first, last in zip(looks, bounds, bounds[1:]):
        time = abs(trajectory.times[last] - trajectory.times[first])
        worst = 0.0
        for group, size in moving:
            change, rate = max(changes[i] for i in group), max(rates[i] for i in group)
            way = _way(trajectory, group, first, last)
            worst = max(worst, change * (min(time, way / rate) if rate > 0.0 else time) / size)
        found.append((k, worst))
    return found


def _looks(system: System, trajectory: Trajectory) -> list[Look]:
    """Where the rates can be told: as they are, and twice with other rounding."""
    from lagc.simulation.backends.directed_rounding import directed

    looks, least = [], _least(system)
    for k in picked(trajectory):
        found, x = [], trajectory.states[k]
        on = system.on(trajectory.times[k], x)
        for way in (0, 1, -1):
            moved = [a * (1.0 + (way if i % 2 else -way) * ULP) for i, a in enumerate(x)]
            with directed(way):
                found.append(rates_at(on.bind(system.parameters), trajectory.times[k], moved))
        told = [f for f in found if f is not None]
        if len(told) == 3:
            changes = [max(abs(u - r), abs(d - r), least * abs(r)) for r, u, d in zip(*told)]
            looks.append((k, changes, [*map(abs, told[0])]))
    return looks


def _way(trajectory: Trajectory, group: Sequence[int], first: int, last: int) -> float:
    """How far the states of one kind go between two recorded times; turns that the recorded states do not
    show are as many as there are more steps."""
    states = trajectory.states[first : last + 1]
    way = sum(max(abs(y[i] - x[i]) for i in group) for x, y in pairwise(states))
    return way * max(1.0, trajectory.steps / max(len(trajectory.states) - 1, 1))
