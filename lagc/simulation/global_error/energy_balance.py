"""The energy balance of a motion, as a check of its accuracy.

States with errors of A times their sizes s_i have an energy error of at most A times the sum of |dE/dx_i|
s_i, to first order.  If the energy gained and the work done differ by far more, the motion does not solve
the equations, although runs of different tolerance agree.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from lagc.base.records import dataclass
from lagc.simulation.error_measure import Sizes
from lagc.simulation.system import System, Trajectory, work_of

RECORDED = 48  # states at which the balance is evaluated
FEW = 12  # states at first; more if a run had FEW times EVALUATIONS_PER_STATE evaluations
EVALUATIONS_PER_STATE = 400
PROBED = 6  # states at which the derivative of the energy is estimated
STEP = 1e-6  # of a size, for differences
MARGIN = 10.0  # factor on the effect of state errors
WORK_MARGIN = 100.0  # factor on the work, whose integral has no error control
ROUNDING = 1e3  # factor on the round-off of one evaluation


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
    system: System, trajectory: Trajectory, groups: Sizes, accuracy: float, others: Sequence[Trajectory] = ()
) -> Balance:
    """Return the energy balance of a run; `groups` are the scaling groups with their sizes, and `others` runs
    of other tolerances, whose works tell the error of its integral. The sum over the speeds alone is twice
    the kinetic energy, if no part depends on time.  An imbalance below a tenth of its effect is accepted
    without further evaluations."""
    states = trajectory.states
    if not states:
        return Balance(0.0, 0.0, 0.0)
    times, count = trajectory.times, max(FEW, min(RECORDED, trajectory.rhs // EVALUATIONS_PER_STATE))
    drawn = _Drawn(system, times, states, _picked(len(states), count))
    explained = accuracy * MARGIN * 2.0 * drawn.kinetic()
    found = drawn.balance(explained)
    if found.imbalance <= 0.1 * explained:
        return found
    drawn = _Drawn(system, times, states, _picked(len(states), RECORDED))
    explained = accuracy * WORK_MARGIN * drawn.work() + MARGIN * drawn.error_of_work(system, others)
    found = drawn.balance(explained)
    if found.holds:  # without the derivatives of the energy, which cost one evaluation for each state
        return found
    return drawn.balance(explained + _explained(system, times, states, groups, accuracy))


class _Drawn:
    """The energies and works at the states `picked`."""

    def __init__(
        self, system: System, times: Sequence[float], states: Sequence[Sequence[float]], picked: list[int]
    ):
        self.picked = picked
        self.times = [times[k] for k in picked]
        self.energies = [system.energies(times[k], states[k]) for k in picked]
        self.works = [work_of(system, states[k]) for k in picked]

    def kinetic(self) -> float:
        """The largest kinetic energy; 0 if a part of the energy is neither potential nor quadratic in the
        speeds."""
        whole = all(abs(k + v - e) <= 1e-12 * (abs(k) + abs(v)) for k, v, e in self.energies)
        return max(k for k, _, _ in self.energies) if whole else 0.0

    def work(self) -> float:
        """The sum of the magnitudes of the work done."""
        return sum(abs(b - a) for a, b in pairwise(self.works))

    def error_of_work(self, system: System, others: Sequence[Trajectory]) -> float:
        """The largest difference from the works of other runs at the same times: where the motion is known
        exactly, as on a path that a motor holds, steps are long, and the power may not be smooth on them."""
        found = 0.0
        for run in others:
            for k, t, work in zip(self.picked, self.times, self.works):
                if k < len(run.times) and run.times[k] == t:
                    found = max(found, abs(work_of(system, run.states[k]) - work))
        return found

    def balance(self, explained: float) -> Balance:
        """The largest imbalance."""
        e0, w0 = self.energies[0][2], self.works[0]
        left = [abs(e[2] - e0 - (w - w0)) for e, w in zip(self.energies, self.works)]
        worst = max(range(len(left)), key=left.__getitem__)
        return Balance(left[worst], self.times[worst], explained)


def _explained(
    system: System, times: Sequence[float], states: Sequence[Sequence[float]], groups: Sizes, accuracy: float
) -> float:
    """The largest imbalance that state errors of the accuracy, and round-off, explain, in J."""
    from lagc.simulation.backends.directed_rounding import apart

    picked = _picked(len(states), PROBED)
    slopes = max(_slopes(system, times[k], states[k], groups) for k in picked)
    lasts = abs(times[-1] - times[0])
    noise = apart(lambda: [_noise(system, times[k], states[k]) for k in picked])
    power = sum(power for _, power in noise) / len(noise)
    return accuracy * MARGIN * slopes + ROUNDING * (max(energy for energy, _ in noise) + lasts * power)


def _picked(n: int, count: int) -> list[int]:
    return sorted({k * (n - 1) // count for k in range(count + 1)}) if n else []


def _slopes(system: System, t: float, x: Sequence[float], groups: Sizes) -> float:
    """The sum of |dE/dx_i| s_i, in J."""
    here, total = system.energies(t, x)[2], 0.0
    for group, size in groups:
        for i in group:
            y = list(x)
            y[i] += STEP * size
            change = abs(system.energies(t, y)[2] - here) / STEP
            total += change if change < 1e300 else 0.0
    return total


def _noise(system: System, t: float, x: Sequence[float]) -> tuple[float, float]:
    """The round-off of the energy at one state in J, and that of the power in W, from evaluations with
    directed rounding. Large forces that cancel leave a power that nothing balances."""
    from lagc.simulation.backends.directed_rounding import directed

    found, powers = [system.energies(t, x)], []
    for direction in (1, -1):
        with directed(direction):
            turned = system.bind(system.parameters)
            found.append(turned.energies(t, x))
            xdot, lam = [0.0] * system.nx, [0.0] * system.nc
            turned.rhs(t, x, xdot, lam)
            powers.append(work_of(system, xdot))
    energy = max(abs(e[2] - found[0][2]) for e in found) + 2.0**-52 * max(abs(a) for a in found[0])
    return energy, abs(powers[0] - powers[1])
