"""Scaling groups whose states are zero but for round-off, such as those of a cart with two opposite
pendulums.

Such a group starts at zero.  With its states set to zero, its rates are no larger than their round-off at
any recorded state.  Its motion is accumulated round-off, and has no size to compare errors with.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import isfinite

from lagc.simulation.error_measure import Sizes, sizes
from lagc.simulation.global_error.rounding import ULP, Quick, generic, picked
from lagc.simulation.system import System, Trajectory, more, rates_at, state_name

FAINT = 1e4  # times the round-off of its rates over the time: a group that exceeds this soon moves
SEVERAL = 10.0  # factor on the round-off estimated at a few states
LITTLE = 1e-3  # ratio of rates: a group of coordinates moves only by its speeds
MOST_NAMED = 6  # states of a group in a note

States = Sequence[tuple[float, Sequence[float]]]  # t, x
Bounds = dict[int, float]  # by the number of the group: how far round-off may move it


def find_noise_groups(system: System, run: Trajectory, groups: Sizes, estimate: Quick) -> Bounds:
    """Return the groups that only round-off moves, with bounds.

    `groups` are the scaling groups with their sizes, `estimate` is the quick estimate of round-off.
    """
    changes, direction = estimate
    if len(run.states) < 2 or not all(map(isfinite, changes)):
        return {}
    span, first, nq = abs(run.times[-1] - run.times[0]), run.states[0], system.nq
    fresh = [k for k, (group, _) in enumerate(groups) if not any(first[i] for i in group)]
    amounts = [span * max(changes[i] for i in group) for group, _ in groups]
    where = picked(run)
    soon = run.states[: where[1] + 1]  # later, round-off may have grown
    speeds = [k for k in fresh if groups[k][0][0] >= nq and amounts[k] > 0.0
              and max(abs(x[i]) for x in soon for i in groups[k][0]) <= FAINT * amounts[k]]  # fmt: skip
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


def noise_note(system: System, run: Trajectory, noise: Bounds) -> list[str]:
    """Return a note on the groups that round-off has moved by no more than their bounds, or []."""
    found, units = [], system.interface.state_units
    for k, (group, size) in enumerate(sizes(run, system.interface)):
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
    """The round-off of each rate.

    State perturbations are one unit in the last place, and the accumulated round-off of the speeds, and of
    the coordinates through the speeds.
    """
    nq, n, found = system.nq, system.nq + system.nv, list(changes)
    step = abs(run.times[-1] - run.times[0]) / max(run.steps, 1)
    for k, (t, x) in enumerate(states):
        y = _without(x, zero)
        last = [generic(7 * k + i) * ULP * abs(a) for i, a in enumerate(y[:n])]
        off = [a + generic(5 * k) * b for a, b in zip(last[nq:], direction[nq:])]
        soon = max(step, abs(t - run.times[0]))
        directions = [a + soon * b for a, b in zip(last, system.displace(t, y, off))] + off
        other = _without([a + b for a, b in zip(y, directions)] + y[n:], zero)
        on = system.on(t, x)
        one, two = rates_at(on, t, y), rates_at(on, t, other)
        if one is not None and two is not None:
            found = [max(f, abs(a - b)) for f, a, b in zip(found, one, two)]
    return found


def _bounds(
    system: System,
    states: States,
    span: float,
    noise: dict[int, Sequence[int]],
    limits: Sequence[float],
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
