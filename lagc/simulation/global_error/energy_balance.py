"""The energy balance of a motion, as a check that is independent of other runs.

If the energy gained and the work done differ by far more than errors of the accuracy in all states explain,
the motion does not solve the equations, although a run and its check agree.
"""

from __future__ import annotations

from itertools import pairwise

from lagc.base.records import dataclass
from lagc.simulation.system import System, Trajectory, work_of

RECORDED = 48  # states at which the balance is evaluated
FEW = 12  # states at first; more if a run had FEW times EVALUATIONS_PER_STATE evaluations
EVALUATIONS_PER_STATE = 400
MARGIN = 20.0  # factor on the changes of the energies that errors of the states cause
WORK_MARGIN = 100.0  # factor on the work, whose integral has no error control
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


def balance(system: System, run: Trajectory, accuracy: float) -> Balance:
    """Return the energy balance of a run. States with errors of A times their ranges have energies with errors
    of about A times the ranges of these; the largest kinetic energy stands for that of the speeds."""
    if not run.states:
        return Balance(0.0, 0.0, 0.0)
    count = max(FEW, min(RECORDED, run.rhs // EVALUATIONS_PER_STATE))
    found = _at(system, run, count, accuracy)
    return found if found.holds or count == RECORDED else _at(system, run, RECORDED, accuracy)


def _at(system: System, run: Trajectory, count: int, accuracy: float) -> Balance:
    n = len(run.states)
    picked = sorted({k * (n - 1) // count for k in range(count + 1)})
    energies = [system.energies(run.times[k], run.states[k]) for k in picked]
    works = [work_of(system, run.states[k]) for k in picked]
    kinetic, potential, total = zip(*energies)
    moved = max(map(abs, kinetic)) + max(kinetic) - min(kinetic) + max(potential) - min(potential)
    done = sum(abs(b - a) for a, b in pairwise(works))
    largest = max(abs(e) for parts in energies for e in parts)
    explained = accuracy * (MARGIN * moved + WORK_MARGIN * done) + ROUNDING * largest
    left = [abs(e - total[0] - (w - works[0])) for e, w in zip(total, works)]
    worst = max(range(len(left)), key=left.__getitem__)
    return Balance(left[worst], run.times[picked[worst]], explained)
