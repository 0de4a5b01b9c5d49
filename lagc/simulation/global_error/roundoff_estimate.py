"""Round-off of the rates, how far it moves the states, and scaling groups that only round-off moves.

Some scaling groups are zero but for round-off, such as those of a cart with two opposite pendulums.  Such a
group starts at zero.  With its states set to zero, its rates are no larger than their round-off at any
recorded state.  Its motion is accumulated round-off, and has no size to compare errors with.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from math import inf, isfinite, nextafter

from lagc.simulation.error_measure import Sizes, state_groups
from lagc.simulation.system import FAILED, System, Trajectory, more, rates_at, state_name

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
    """Return the round-off of each rate (infinite if unknown) and the direction in which it moves the states.
    `groups` are the scaling groups with their sizes.  Evaluated at the first, middle, last and fastest
    state."""
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
    step = span / max(trajectory.steps, 1)  # what moves the speeds moves the coordinates then
    moved = system.displace(times[0], states[0], direction[system.nq : system.nq + system.nv])
    return worst, [w + step * m for w, m in zip(direction, moved)] + direction[system.nq :]


def _least(system: System) -> float:
    """The smallest relative round-off of a rate: that of a step, if the model has relations."""
    return STEP if system.interface.relations else 0.0


def quick_bound(system: System, trajectory: Trajectory, groups: Sizes, changes: Sequence[float]) -> float:
    """A bound of how far round-off moves the states, relative to their sizes, without growth. Infinite if a
    rank-deficient solve occurred, because a few states do not represent those."""
    if trajectory.fallbacks:
        return inf
    span = abs(trajectory.times[-1] - trajectory.times[0])
    worst = max((changes[i] / size for group, size in groups if size > 0.0 for i in group), default=0.0)
    return UNSEEN * worst * span + event_shift(system, trajectory, groups)


def event_shift(system: System, trajectory: Trajectory, groups: Sizes) -> float:
    """How far the round-off of event times moves the states, relative to their sizes."""
    shifts, nq = trajectory.event_roundoff, system.nq
    if not any(shifts):
        return 0.0
    span = abs(trajectory.times[-1] - trajectory.times[0])
    direction = system.displace(trajectory.times[0], trajectory.states[0], shifts[nq : nq + system.nv])
    moved = [a + span * abs(b) for a, b in zip(shifts, direction)] + [*shifts[nq:]]
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
    """Every state changed by one rounding unit, with signs that have no pattern and depend on k."""
    return [a * (1.0 + (ULP if (i * 0x9E3779B1 + k * 0x85EBCA6B) & 0x4000 else -ULP))
            for i, a in enumerate(x)]  # fmt: skip


def neighbour(x: Sequence[float], direction: int) -> list[float]:
    """Every state replaced by the next number, up or down without a pattern; the other way for -1."""
    return [nextafter(a, inf if (i * 0x9E3779B1 & 0x4000 > 0) == (direction > 0) else -inf) if a else a
            for i, a in enumerate(x)]  # fmt: skip


def close_estimate(system: System, trajectory: Trajectory, groups: Sizes) -> list[tuple[int, float]]:
    """Estimate how far round-off moves the states around each of a dozen recorded ones. A group moves by the
    round-off of its rates times the time, and by no more than that share of the distance that it travels,
    because a close encounter is short.  Scaling groups whose rates are all round-off are left out."""
    from lagc.simulation.backends.directed_rounding import apart

    estimates = apart(lambda: _estimates(system, trajectory))
    n = len(trajectory.states)
    bounds = [0, *((a + b) // 2 for (a, _, _), (b, _, _) in pairwise(estimates)), n - 1]
    changed, ran = ([max(values) for values in zip(*(estimate[j] for estimate in estimates))] for j in (1, 2))
    kinds = system.interface.kinds
    driven = {kind for i, kind in enumerate(kinds) if estimates and ran[i] > 100.0 * changed[i]}
    moving = [(group, size) for group, size in groups if size > 0.0 and kinds[group[0]] in driven]
    found = []
    for (k, changes, rates), first, last in zip(estimates, bounds, bounds[1:]):
        time = abs(trajectory.times[last] - trajectory.times[first])
        worst = 0.0
        for group, size in moving:
            change, rate = max(changes[i] for i in group), max(rates[i] for i in group)
            distance = _distance(trajectory, group, first, last)
            worst = max(worst, change * (min(time, distance / rate) if rate > 0.0 else time) / size)
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
        values = [f for f in found if f is not None]
        if len(values) == 3:
            changes = [max(abs(u - r), abs(d - r), least * abs(r)) for r, u, d in zip(*values)]
            estimates.append((k, changes, [*map(abs, values[0])]))
    return estimates


def _distance(trajectory: Trajectory, group: Sequence[int], first: int, last: int) -> float:
    """The distance that a group travels between two recorded states. Turns between recorded states are
    counted by the number of steps."""
    states = trajectory.states[first : last + 1]
    distance = sum(max(abs(y[i] - x[i]) for i in group) for x, y in pairwise(states))
    return distance * max(1.0, trajectory.steps / max(len(trajectory.states) - 1, 1))


FAINT = 1e4  # times the round-off of its rates over the time: a group that exceeds this soon moves
SEVERAL = 10.0  # factor on the round-off estimated at a few states
LITTLE = 1e-3  # ratio of rates: a group of coordinates moves only by its speeds
MOST_NAMED = 6  # states of a group in a note

States = Sequence[tuple[float, Sequence[float]]]  # t, x
Bounds = dict[int, float]  # by the number of the group: how far round-off may move it


def find_noise_groups(system: System, run: Trajectory, groups: Sizes, estimate: Quick) -> Bounds:
    """Return the groups that only round-off moves, with bounds. `groups` are the scaling groups with their
    sizes, `estimate` is the quick estimate of round-off."""
    changes, direction = estimate
    if len(run.states) < 2 or not all(map(isfinite, changes)):
        return {}
    if system.interface.contacts:  # their friction moves states that no load moves
        return {}
    span, first, nq = abs(run.times[-1] - run.times[0]), run.states[0], system.nq
    fresh = [k for k, (group, _) in enumerate(groups) if not any(first[i] for i in group)]
    amounts = [span * max(changes[i] for i in group) for group, _ in groups]
    where = picked(run)
    early = run.states[: where[1] + 1]  # later, round-off may have grown
    speeds = [k for k in fresh if groups[k][0][0] >= nq and amounts[k] > 0.0
              and max(abs(x[i]) for x in early for i in groups[k][0]) <= FAINT * amounts[k]]  # fmt: skip
    if not speeds:
        return {}
    small = [(i, SEVERAL * amounts[k]) for k in speeds for i in groups[k][0]]
    states = [(run.times[k], run.states[k]) for k in where
              if all(abs(run.states[k][i]) <= limit for i, limit in small)]  # fmt: skip
    before = _largest(system, states, ())
    after = _largest(system, states, [i for k in speeds for i in groups[k][0]])
    places = [k for k in fresh if groups[k][0][0] < nq
              and all(after[i] <= LITTLE * before[i] for i in groups[k][0])]  # fmt: skip
    noise = [*places, *speeds]
    while noise:
        zero = [i for k in noise for i in groups[k][0]]
        rates, limits = _largest(system, states, zero), _limits(system, run, states, zero, changes, direction)
        kept = [k for k in noise if all(rates[i] <= SEVERAL * limits[i] for i in groups[k][0])]
        if kept == noise:
            return _bounds(system, states, span, {k: groups[k][0] for k in noise}, limits)
        noise = kept
    return {}


def harmless(system: System, run: Trajectory, groups: Sizes, noise: Bounds, accuracy: float) -> Bounds:
    """Return `noise`, or nothing if its speeds move other coordinates by more than `accuracy` of their sizes
    over the time: these coordinates are then round-off too."""
    nq, nv, span = system.nq, system.nv, abs(run.times[-1] - run.times[0])
    off = [0.0] * system.nx
    for k in noise:
        for i in groups[k][0]:
            off[i] = max(abs(x[i]) for x in run.states)
    others = [(group, size) for k, (group, size) in enumerate(groups) if k not in noise and group[0] < nq]
    for k in picked(run) if noise else ():
        moved = system.displace(run.times[k], run.states[k], off[nq : nq + nv])
        if any(span * abs(moved[i]) > accuracy * size for group, size in others for i in group):
            return {}
    return noise


def noise_note(system: System, run: Trajectory, noise: Bounds) -> list[str]:
    """Return a note on the groups that round-off has moved by no more than their bounds, or []."""
    found, units = [], system.interface.state_units
    for k, group in enumerate(state_groups(system.interface)):
        size = max((abs(x[i]) for x in run.states for i in group), default=0.0)
        if 0.0 < size <= noise.get(k, 0.0):
            names = ", ".join([state_name(system, i) for i in group[:MOST_NAMED]])
            found.append(
                f"{names}{more(group, MOST_NAMED)} (up to {size:.1g} {units[group[0]]}".rstrip() + ")"
            )
    return [f"moved only by round-off, and not accurate: {'; '.join(found)}"] if found else []


def _largest(system: System, states: States, zero: Iterable[int]) -> list[float]:
    """The largest magnitude of each rate, with the states `zero` set to zero."""
    found = [0.0] * system.nx
    for t, x in states:
        rates = rates_at(system.on(t, x), t, _without(x, zero))
        if rates is not None:
            found = [max(a, abs(b)) for a, b in zip(found, rates)]
    return found


def _without(x: Sequence[float], zero: Iterable[int]) -> list[float]:
    y = list(x)
    for i in zero:
        y[i] = 0.0
    return y


def _limits(
    system: System,
    run: Trajectory,
    states: States,
    zero: Iterable[int],
    changes: Sequence[float],
    direction: Sequence[float],
) -> list[float]:
    """The round-off of each rate. State perturbations are one rounding unit, and the accumulated round-off of
    the speeds, and of the coordinates through the speeds."""
    nq, n, found = system.nq, system.nq + system.nv, list(changes)
    step = abs(run.times[-1] - run.times[0]) / max(run.steps, 1)
    for k, (t, x) in enumerate(states):
        y = _without(x, zero)
        last = [generic(7 * k + i) * ULP * abs(a) for i, a in enumerate(y[:n])]
        off = [a + generic(5 * k) * b for a, b in zip(last[nq:], direction[nq:])]
        elapsed = max(step, abs(t - run.times[0]))
        directions = [a + elapsed * b for a, b in zip(last, system.displace(t, y, off))] + off
        other = _without([a + b for a, b in zip(y, directions)] + y[n:], zero)
        on = system.on(t, x)
        one, two = rates_at(on, t, y), rates_at(on, t, other)
        if one is not None and two is not None:
            found = [max(f, abs(a - b)) for f, a, b in zip(found, one, two)]
    return found


def _bounds(
    system: System, states: States, span: float, noise: dict[int, Sequence[int]], limits: Sequence[float]
) -> Bounds:
    """How far rates of the size of `limits` move the states over the time."""
    nq, nv = system.nq, system.nv
    direction = [0.0] * system.nx
    for group in noise.values():
        for i in group:
            direction[i] = SEVERAL * span * limits[i]
    for t, x in states:
        moved = system.displace(t, x, direction[nq : nq + nv])
        for i, a in enumerate(moved):
            direction[i] = max(direction[i], span * abs(a))
    return {k: max(direction[i] for i in group) for k, group in noise.items()}
