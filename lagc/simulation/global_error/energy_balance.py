"""The energy balance of a motion, as a check that is independent of other runs.

If the energy gained and the work done differ by far more than errors of the accuracy in all states explain,
the motion does not solve the equations, although a run and its check agree.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from lagc.base.records import dataclass
from lagc.simulation.system import System, Trajectory, work_of

RECORDED = 48  # states at which the balance is evaluated
FEW = 12  # states at first; more if a run had FEW times EVALUATIONS_PER_STATE evaluations
EVALUATIONS_PER_STATE = 400
PROBED = 6  # states at which errors of the states are tried
MARGIN = 10.0  # factor on the effect of state errors
WORK_MARGIN = 100.0  # factor on the work, whose integral has no error control
ROUNDED = 100.0  # factor on the change of the energy with the rounding unit of a state
NOISE = 4.0  # factor on the noise of the imbalance
ROUNDING = 1e3 * 2.0**-52  # of the energies: their round-off


@dataclass(frozen=True, slots=True)
class Balance:
    """The largest imbalance in J, its time in s, and the largest imbalance that the accuracy asked
    explains, in J."""

    imbalance: float
    t: float
    explained: float

    @property
    def holds(self) -> bool:
        return not self.imbalance > self.explained


def balance(
    system: System, run: Trajectory, scales: Sequence[float], accuracy: float, work_error: float = 0.0
) -> Balance:
    """Return the energy balance of a run with these scales of the states and this error of the work, in J.
    An imbalance below errors of the kinetic energy and the work is accepted without trying errors of each
    state, which costs an evaluation for each."""
    if not run.states:
        return Balance(0.0, 0.0, 0.0)
    found = _at(system, run, max(FEW, min(RECORDED, run.rhs // EVALUATIONS_PER_STATE)), accuracy, work_error)
    if found.holds:
        return found
    found = _at(system, run, RECORDED, accuracy, work_error)
    effect = max(_effect(system, run.times[k], run.states[k], scales, accuracy) for k in _picked(run, PROBED))
    return Balance(found.imbalance, found.t, found.explained + MARGIN * effect)


def _picked(run: Trajectory, count: int) -> list[int]:
    return sorted({k * (len(run.states) - 1) // count for k in range(count + 1)})


def _at(system: System, run: Trajectory, count: int, accuracy: float, work_error: float) -> Balance:
    picked = _picked(run, count)
    energies = [system.energies(run.times[k], run.states[k]) for k in picked]
    works = [work_of(system, run.states[k]) for k in picked]
    kinetic = max(abs(k) for k, _, _ in energies)
    done = sum(abs(b - a) for a, b in pairwise(works))
    largest = max(abs(e) for parts in energies for e in parts)
    explained = accuracy * (2.0 * MARGIN * kinetic + WORK_MARGIN * done) + ROUNDING * largest
    left = [e - energies[0][2] - (w - works[0]) for (_, _, e), w in zip(energies, works)]
    explained += NOISE * _noise(left) + MARGIN * work_error
    worst = max(range(len(left)), key=lambda k: abs(left[k]))
    return Balance(abs(left[worst]), run.times[picked[worst]], explained)


def _noise(values: Sequence[float]) -> float:
    """The median magnitude of second differences: round-off alternates, while one jump of the energy, or its
    drift, hardly shows in it (R. W. Hamming, Numerical Methods for Scientists and Engineers, 1962)."""
    second = sorted(abs(a - 2.0 * b + c) for a, b, c in zip(values, values[1:], values[2:]))
    return second[len(second) // 2] if len(second) > 2 else 0.0


def _effect(system: System, t: float, x: Sequence[float], scales: Sequence[float], accuracy: float) -> float:
    """The sum of the changes of the energy with errors of each state, and with its round-off, in J."""
    here = system.energies(t, x)[2]
    near = [a * (1.0 + (2.0**-50 if i % 2 else -(2.0**-50))) for i, a in enumerate(x)]
    total = ROUNDED * abs(system.energies(t, near)[2] - here)
    for i, scale in zip(range(system.nq + system.nv), scales):
        y = list(x)
        y[i] += accuracy * scale
        total += abs(system.energies(t, y)[2] - here)
    return total
