"""Round-off of the rates, and how far it moves the states if perturbations do not grow."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import inf, nextafter

from lagc.simulation.error_measure import Sizes
from lagc.simulation.system import FAILED, System, Trajectory, rates_at

ULP = 2.0**-52
SAMPLES = 12  # recorded states
# Relative round-off of a step: its coefficients are rounded too.  Between discontinuities, a step may be
# long and exact but for this.
STEP = 16.0 * ULP
UNSEEN = 10.0  # factor on a quick estimate

Quick = tuple[list[float], list[float]]
Estimate = tuple[int, list[float], list[float]]  # index of the state, round-off of each rate, the rates


def picked(trajectory: Trajectory) -> list[int]:
    """The indices of about a dozen recorded states."""
    n = len(trajectory.states)
    return sorted({k * (n - 1) // SAMPLES for k in range(SAMPLES + 1)}) if n else []


def quick_estimate(system: System, trajectory: Trajectory, groups: Sizes) -> Quick:
    """Return the round-off of each rate (infinite if unknown) and the direction in which it moves the
    states.

    `groups` are the scaling groups with their sizes.  Evaluated at the first, middle, last and fastest
    state.
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
    direction = [ULP * generic(i) * a for i, a in enumerate(states[0])]
    for k, one, up, down in zip(where, plain, rounded_rates(on, *at, 1), rounded_rates(on, *at, -1)):
        if one is None or up is None or down is None:
            worst = [inf] * system.nx
            continue
        worst = [max(w, abs(u - r), abs(d - r), least * abs(r)) for w, r, u, d in zip(worst, one, up, down)]
        a, b = span * generic(k), span * generic(-k - 1)
        direction = [w + a * (u - r) + b * (d - r) for w, r, u, d in zip(direction, one, up, down)]
    soon = span / max(trajectory.steps, 1)  # what moves the speeds moves the coordinates then
    moved = system.displace(times[0], states[0], direction[system.nq : system.nq + system.nv])
    return worst, [w + soon * m for w, m in zip(direction, moved)] + direction[system.nq :]


def _least(system: System) -> float:
    """The smallest relative round-off of a rate: that of a step, if the model has relations."""
    return STEP if system.interface.switches else 0.0


def quick_bound(system: System, trajectory: Trajectory, groups: Sizes, changes: Sequence[float]) -> float:
    """A bound of how far round-off moves the states, relative to their sizes, without growth.

    Infinite if a rank-deficient solve occurred, because a few states do not represent those.
    """
    if trajectory.fallbacks:
        return inf
    span = abs(trajectory.times[-1] - trajectory.times[0])
    worst = max((changes[i] / size for group, size in groups if size > 0.0 for i in group), default=0.0)
    return UNSEEN * worst * span + event_shift(system, trajectory, groups)


def event_shift(system: System, trajectory: Trajectory, groups: Sizes) -> float:
    """What is due to times at which switches changed being told to their last place, relative to the sizes of
    the states: in speeds, and in coordinates by these over the time."""
    jolts, nq = trajectory.event_roundoff, system.nq
    if not any(jolts):
        return 0.0
    span = abs(trajectory.times[-1] - trajectory.times[0])
    direction = system.displace(trajectory.times[0], trajectory.states[0], jolts[nq : nq + system.nv])
    moved = [a + span * abs(b) for a, b in zip(jolts, direction)] + [*jolts[nq:]]
    return max((moved[i] / size for group, size in groups if size > 0.0 for i in group), default=0.0)


def generic(k: int) -> float:
    """A number of magnitude 1/2 to 3/2, without a pattern in k."""
    return (0.5 + 0.6180339887498949 * k % 1.0) * (1.0 if (k * 0x9E3779B1) & 0x4000 else -1.0)


def rounded_rates(
    systems: Sequence[System], times: Sequence[float], states: Sequence[Sequence[float]], direction: int
) -> list[list[float] | None]:
    """The rates with arithmetic rounded up (1) or down (-1): by compiled code, or else in another thread."""
    found: list[list[float] | None] = []
    for system, t, x in zip(systems, times, states):
        xdot, lam = [0.0] * system.nx, [0.0] * system.nc
        status = system.rounded(t, x, xdot, lam, direction)
        if status is None:
            break
        found.append(None if status in FAILED else xdot)
    else:
        return found
    from lagc.simulation.backends.directed_rounding import apart, directed

    def work() -> list[list[float] | None]:
        with directed(direction):
            bound = [system.bind(system.parameters) for system in systems]
            return [rates_at(one, t, x) for one, t, x in zip(bound, times, states)]

    return apart(work)


def _shifted(x: Sequence[float], k: int) -> list[float]:
    """Every state changed by one unit in the last place, with signs that have no pattern and depend on k."""
    return [a * (1.0 + (ULP if (i * 0x9E3779B1 + k * 0x85EBCA6B) & 0x4000 else -ULP))
            for i, a in enumerate(x)]  # fmt: skip


def nudged(x: Sequence[float], direction: int) -> list[float]:
    """Every state replaced by the next number, up or down without a pattern; the other way for -1."""
    return [nextafter(a, inf if (i * 0x9E3779B1 & 0x4000 > 0) == (direction > 0) else -inf) if a else a
            for i, a in enumerate(x)]  # fmt: skip


def close_estimate(system: System, trajectory: Trajectory, groups: Sizes) -> list[tuple[int, float]]:
    """Estimate how far round-off moves the states around each of a dozen recorded ones.

    A group moves by the round-off of its rates times the time, and by no more than that share of the
    distance that it travels, because a close encounter is short.  Groups whose rates are all round-off are
    left out.
    """
    from lagc.simulation.backends.directed_rounding import apart

    estimates = apart(lambda: _estimates(system, trajectory))
    n = len(trajectory.states)
    bounds = [0, *((a + b) // 2 for (a, _, _), (b, _, _) in pairwise(estimates)), n - 1]
    changed, ran = ([max(values) for values in zip(*(estimate[j] for estimate in estimates))] for j in (1, 2))
    moving = [(group, size) for group, size in groups
              if size > 0.0 and any(ran[i] > 100.0 * changed[i] for i in group if estimates)]  # fmt: skip
    found = []
    for (k, changes, rates), first, last in zip(estimates, bounds, bounds[1:]):
        time = abs(trajectory.times[last] - trajectory.times[first])
        worst = 0.0
        for group, size in moving:
            change, rate = max(changes[i] for i in group), max(rates[i] for i in group)
            direction = _way(trajectory, group, first, last)
            worst = max(worst, change * (min(time, direction / rate) if rate > 0.0 else time) / size)
        found.append((k, worst))
    return found


def _estimates(system: System, trajectory: Trajectory) -> list[Estimate]:
    """The rates at the picked states, and their round-off from evaluations with directed rounding."""
    from lagc.simulation.backends.directed_rounding import directed

    estimates, least = [], _least(system)
    for k in picked(trajectory):
        found, x = [], trajectory.states[k]
        on = system.on(trajectory.times[k], x)
        for direction in (0, 1, -1):
            moved = [a * (1.0 + (direction if i % 2 else -direction) * ULP) for i, a in enumerate(x)]
            with directed(direction):
                found.append(rates_at(on.bind(system.parameters), trajectory.times[k], moved))
        told = [f for f in found if f is not None]
        if len(told) == 3:
            changes = [max(abs(u - r), abs(d - r), least * abs(r)) for r, u, d in zip(*told)]
            estimates.append((k, changes, [*map(abs, told[0])]))
    return estimates


def _way(trajectory: Trajectory, group: Sequence[int], first: int, last: int) -> float:
    """The distance that a group travels between two recorded states.

    Turns between recorded states are counted by the number of steps.
    """
    states = trajectory.states[first : last + 1]
    direction = sum(max(abs(y[i] - x[i]) for i in group) for x, y in pairwise(states))
    return direction * max(1.0, trajectory.steps / max(len(trajectory.states) - 1, 1))
