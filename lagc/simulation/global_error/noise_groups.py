"""Kinds of states that are zero but for rounding, as of a cart with two pendulums that swing oppositely.

Such a kind starts at zero, and where its states are put back to zero its rates are rounding, at any of the
recorded states: they are no more than what changes them where last places do, or where the others are as far
off as rounding brings them.  What it moves by is rounding summed up, of no size by which to judge it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import isfinite

from lagc.simulation.error_measure import Sizes, sizes
from lagc.simulation.global_error.rounding import ULP, Quick, generic, picked
from lagc.simulation.system import System, Trajectory, more, rates_at, state_name

FAINT = 1e4  # times the rounding of its rates over the time: a kind that goes farther soon moves
SEVERAL = 10.0  # times what is seen at a few states is rounding
LITTLE = 1e-3  # of its rates is left where speeds are put back to zero: a kind that moves by these alone
MOST_NAMED = 6  # states of a kind

States = Sequence[tuple[float, Sequence[float]]]  # with their times
Bounds = dict[int, float]  # by kind (place in the groups): how far rounding may move it


def still_kinds(system: System, run: Trajectory, groups: Sizes, look: Quick) -> Bounds:
    """Those that rounding alone moves.  `groups`: the indices of the states of each kind, and their size;
    `look`: the quick one at the run."""
    changes, way = look
    if len(run.states) < 2 or not all(map(isfinite, changes)):
        return {}
    span, first, nq = abs(run.times[-1] - run.times[0]), run.states[0], system.nq
    fresh = [k for k, (group, _) in enumerate(groups) if not any(first[i] for i in group)]
    noise = [span * max(changes[i] for i in group) for group, _ in groups]
    where = picked(run)
    soon = run.states[: where[1] + 1]  # later, rounding may have grown: that is not looked at
    speeds = [k for k in fresh if groups[k][0][0] >= nq and noise[k] > 0.0
              and max(abs(x[i]) for x in soon for i in groups[k][0]) <= FAINT * noise[k]]  # fmt: skip
    if not speeds:
        return {}
    small = [(i, SEVERAL * noise[k]) for k in speeds for i in groups[k][0]]
    states = [(run.times[k], run.states[k]) for k in where
              if all(abs(run.states[k][i]) <= limit for i, limit in small)]  # fmt: skip
    before = _largest(system, states, ())
    after = _largest(system, states, [i for k in speeds for i in groups[k][0]])
    places = [k for k in fresh if groups[k][0][0] < nq
              and all(after[i] <= LITTLE * before[i] for i in groups[k][0])]  # fmt: skip
    still = [*places, *speeds]
    while still:
        zero = [i for k in still for i in groups[k][0]]
        rates, limits = _largest(system, states, zero), _limits(system, run, states, zero, changes, way)
        kept = [k for k in still if all(rates[i] <= SEVERAL * limits[i] for i in groups[k][0])]
        if kept == still:
            return _bounds(system, states, span, {k: groups[k][0] for k in still}, limits)
        still = kept
    return {}


def told(system: System, run: Trajectory, still: Bounds) -> list[str]:
    """A note on these kinds, where rounding has moved them by no more than that."""
    found, units = [], system.interface.state_units
    for k, (group, size) in enumerate(sizes(run, system.interface)):
        if 0.0 < size <= still.get(k, 0.0):
            names = ", ".join([state_name(system, i) for i in group[:MOST_NAMED]])
            found.append(
                f"{names}{more(group, MOST_NAMED)} (up to {size:.1g} {units[group[0]]}".rstrip() + ")"
            )
    return [f"moved by rounding only, and of no accuracy: {'; '.join(found)}"] if found else []


def _largest(system: System, states: States, zero: Iterable[int]) -> list[float]:
    """Magnitude of each rate, with some states put to zero."""
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
    way: Sequence[float],
) -> list[float]:
    """What each rate changes by where last places do, or the states are off by what rounding brings, in its
    way, over the time, speeds, and coordinates by these over the time so far."""
    nq, n, found = system.nq, system.nq + system.nv, list(changes)
    step = abs(run.times[-1] - run.times[0]) / max(run.steps, 1)
    for k, (t, x) in enumerate(states):
        y = _without(x, zero)
        last = [generic(7 * k + i) * ULP * abs(a) for i, a in enumerate(y[:n])]
        off = [a + generic(5 * k) * b for a, b in zip(last[nq:], way[nq:])]
        soon = max(step, abs(t - run.times[0]))
        ways = [a + soon * b for a, b in zip(last, system.displace(t, y, off))] + off
        other = _without([a + b for a, b in zip(y, ways)] + y[n:], zero)
        on = system.on(t, x)
        one, two = rates_at(on, t, y), rates_at(on, t, other)
        if one is not None and two is not None:
            found = [max(f, abs(a - b)) for f, a, b in zip(found, one, two)]
    return found


def _bounds(
    system: System,
    states: States,
    span: float,
    still: dict[int, Sequence[int]],
    limits: Sequence[float],
) -> Bounds:
    """How far rates of that size take the states over the time."""
    nq, nv = system.nq, system.nv
    way = [0.0] * system.nx
    for group in still.values():
        for i in group:
            way[i] = SEVERAL * span * limits[i]
    for t, x in states:
        moved = system.displace(t, x, way[nq : nq + nv])
        for i, a in enumerate(moved):
            way[i] = max(way[i], span * abs(a))
    return {k: max(way[i] for i in group) for k, group in still.items()}
