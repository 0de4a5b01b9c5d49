"""States at which modes change: the branches that meet there, and whether forces jump or have a kink."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from lagc.simulation.linearization.derivatives import Array, Point
from lagc.simulation.system import FAILED

AT = 16.0  # times the round-off of an event indicator: it is at its crossing
BESIDE = 1e-6  # of the sizes of states: the distance of points on either side
JUMP = 1e-9  # of the terms of rates: smaller differences are none
ALIKE = 1e-12  # of entries: smaller differences are round-off


class Branch(NamedTuple):
    """The branch beyond one event indicator."""

    words: str
    modes: list[float]


def branches(point: Point, sizes: Array) -> tuple[list[float] | None, list[Branch]]:
    """The modes with all indicators that change at the state on their larger side, and the branch beyond each
    of them. None if no mode changes there.  `sizes` are those of states.  Indicators of time alone do not
    count."""
    system = point.system
    at = _changing(point)
    if not at:
        return None, []
    directions = {}
    for k in at:
        slope = point.partial("indicator", "state")[k] * sizes
        if slope.any():
            directions[k] = sizes * slope / np.abs(slope).max()
    if not directions:
        return None, []
    own = system.modes(point.t, point.x)

    def beyond(signs: dict[int, float]) -> list[float]:
        place = point.x + BESIDE * sum(signs[k] * direction for k, direction in directions.items())
        there = system.modes(point.t, place.tolist())
        return [there[k] if k in at else mode for k, mode in enumerate(own)]

    everywhere = dict.fromkeys(directions, 1.0)
    others = [Branch(system.interface.relations[k], beyond({**everywhere, k: -1.0})) for k in directions]
    return beyond(everywhere), others


def _changing(point: Point) -> list[int]:
    """The relations whose indicators are at their crossing, to round-off."""
    system, interface = point.system, point.system.interface
    if not interface.relations:
        return []
    sides, modes = point.value("indicator"), system.modes(point.t, point.x)
    rows, n = interface.stack["indicator"], len(interface.relations)
    doubt = np.zeros(n)
    for other in point.beside:
        there = other.system.stack(other.t, other.x, other.a, other.lam, modes)[rows.start : rows.stop]
        doubt = np.maximum(doubt, np.abs(np.array(there) - sides))
    edges = [0.0] * (2 * n)
    if any(interface.counted_relations):
        system.model.module["fn_edges_on"](modes, edges)
    found = []
    for k in range(interface.timed_relations, n):
        places = edges[2 * k : 2 * k + 2] if interface.counted_relations[k] else [0.0]
        if k in interface.noted and min(abs(sides[k] - place) for place in places) <= AT * doubt[k]:
            found.append(k)
    return found


def jumps(point: Point, one: Sequence[float], two: Sequence[float], far: Array) -> bool:
    """Whether rates differ between two branches; `far` are sizes of states."""
    found = []
    for modes in (one, two):
        rates, lam = [0.0] * point.system.nx, [0.0] * point.system.nc
        if point.system.rhs_on(modes, point.t, point.x, rates, lam) in FAILED:
            return True
        found.append(np.array(rates[: len(point.x)]))
    terms = point.rate_sizes("state") @ far + np.abs(found[0]) + np.abs(found[1])
    return bool((np.abs(found[0] - found[1]) > JUMP * terms).any())


def differing(one: Array, two: Array) -> list[tuple[int, ...]]:
    """The indices of entries that differ, the largest relative difference first."""
    sizes = np.abs(one) + np.abs(two)
    share = np.divide(np.abs(one - two), sizes, out=np.zeros_like(sizes), where=sizes > 0.0)
    places = [tuple(map(int, place)) for place in np.argwhere(share > ALIKE)]
    return sorted(places, key=lambda place: -share[place])
