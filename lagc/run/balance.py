"""Whether the energy of a motion is as exact as the motion is said to be.

States with errors of A times their sizes s_i have an energy wrong by A times the sum of |dE/dx_i| s_i
at most, to first order.  What is left between the energy gained and the work done must not be far more:
if it is, the motion is not what the equations say, however well two runs of it agree.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from lagc.records import dataclass
from lagc.run.problem import System, Trajectory
from lagc.run.rounding import directed

RECORDED = 48  # states at which the balance is drawn
PROBED = 6  # states at which the sensitivity of the energy is told
STEP = 1e-6  # of a size, for differences
MARGIN = 10.0  # on what errors of the states explain
WORK_MARGIN = 100.0  # on the work, whose integral has no error control of its own
ROUNDING = 1e3  # rounding of the terms, over that of one evaluation


@dataclass(frozen=True, slots=True)
class Balance:
    """The largest imbalance, in J, its time, and the most that errors of the accuracy asked explain."""

    imbalance: float
    t: float
    explained: float

    @property
    def holds(self) -> bool:
        return not self.imbalance > self.explained


def balance(
    system: System, trajectory: Trajectory, groups: Sequence[tuple[Sequence[int], float]], accuracy: float
) -> Balance:
    """`groups`: the indices of the states of each kind, and their size."""
    times, states = trajectory.times, trajectory.states
    picked = _picked(len(states), RECORDED)
    if not picked:
        return Balance(0.0, 0.0, 0.0)
    energies = [system.energies(times[k], states[k])[2] for k in picked]
    works = [states[k][-1] if system.nz else 0.0 for k in picked]
    left = [abs(e - energies[0] - (w - works[0])) for e, w in zip(energies, works)]
    moved = sum(abs(b - a) for a, b in pairwise(works))
    slopes = noise = 0.0
    for k in _picked(len(states), PROBED):
        slopes = max(slopes, _slopes(system, times[k], states[k], groups))
        noise = max(noise, _noise(system, times[k], states[k]))
    explained = accuracy * (MARGIN * slopes + WORK_MARGIN * moved) + ROUNDING * noise
    worst = max(range(len(left)), key=left.__getitem__)
    return Balance(left[worst], times[picked[worst]], explained)


def _picked(n: int, count: int) -> list[int]:
    return sorted({k * (n - 1) // count for k in range(count + 1)}) if n else []


def _slopes(
    system: System, t: float, x: Sequence[float], groups: Sequence[tuple[Sequence[int], float]]
) -> float:
    """The sum of |dE/dx_i| s_i."""
    here, total = system.energies(t, x)[2], 0.0
    for group, size in groups:
        for i in group:
            y = list(x)
            y[i] += STEP * size
            change = abs(system.energies(t, y)[2] - here) / STEP
            total += change if change < 1e300 else 0.0
    return total


def _noise(system: System, t: float, x: Sequence[float]) -> float:
    """How far rounding moves the energy at one state."""
    found = [system.energies(t, x)]
    for way in (1, -1):
        with directed(way):
            found.append(system.energies(t, x))
    return max(abs(e[2] - found[0][2]) for e in found) + 2.0**-52 * max(abs(a) for a in found[0])
