"""The truncation error of the finest of several runs, from their differences, and the tolerances of the
next runs.

The error behaves as C tol^p; with few steps, p is random.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import floor, inf, log10

from lagc.base.text import FINEST
from lagc.simulation.system import Trajectory

SAFETY = 2.0  # factor on every estimate
FEW = 24.0  # steps: half of the measured slope is used
CAUTION = 0.9  # share of the slope that is used for the decade below the finest run
MOST_ALIKE = 3.0  # largest correction for runs with similar numbers of steps, which stability may cause
SMALLEST = 1e-14  # round-off of a few steps: differences do not show a smaller error
SLOPES = (0.5, 1.6)  # range of p that is accepted


def is_tied(steps: int, changes: int) -> bool:
    """Whether events, rather than the tolerance, determine where the steps end."""
    return steps < FEW * changes


class Truncation:
    """The truncation error of `runs` (by tolerance), to which more are added. `apart` returns the scaled
    difference of two runs, the finer one first; `order` is that of the method, 0 if it varies."""

    def __init__(
        self, runs: Mapping[float, Trajectory], apart: Callable[[Trajectory, Trajectory], float], order: int
    ):
        self.runs, self.apart, self.order = runs, apart, order
        self.found: dict[tuple[float, float], float] = {}

    def error(self) -> float:
        """The error of the finest run; infinite if it is the only one."""
        if len(self.runs) < 2:
            return inf
        return max(self._by_law(), SMALLEST)

    def factor(self) -> float:
        """The error of the finest run over its difference to the next coarser one."""
        apart = self._difference(*sorted(self.runs)[:2])
        return self.error() / apart if 0.0 < apart < inf else 1.0

    def _by_law(self) -> float:
        """The error of the next coarser run from their difference, extrapolated by the slope over three runs.
        Two runs may have equal errors by chance, so their difference counts for at least the value that the
        previous difference predicts."""
        tols = sorted(self.runs)
        difference, alike = self._difference(tols[0], tols[1]), self._alike(tols)
        if len(tols) == 2:
            return SAFETY * difference * max(1.0, alike)
        before, step = self._difference(tols[0], tols[2]), tols[1] / tols[2]
        if self._slope() is None:
            return SAFETY * max(difference, before * step * step) * max(1.0, alike)
        return SAFETY * max(difference, before * step) * max(self._gain(), alike)

    def _gain(self) -> float:
        """The ratio of the errors of the two finest runs, from the slope; with few steps between events it
        is used in part."""
        tols = sorted(self.runs)[:2]
        fine = self.runs[tols[0]]
        steps = fine.steps / (fine.changes + 1)
        believed = CAUTION * steps / (steps + FEW)
        gain: float = (tols[0] / tols[1]) ** (believed * (self._slope() or 1.0))
        return gain

    def _alike(self, tols: Sequence[float]) -> float:
        """The ratio of the error of the finer run to the difference, from the numbers of steps. An error is
        proportional to the power -order of the number of steps, or to the tolerance if the order varies.
        Runs with similar numbers differ by less than their errors."""
        fine, coarse = (self.runs[tol].steps for tol in tols[:2])
        ratio = (fine / max(coarse, 1)) ** self.order if self.order else tols[1] / tols[0]
        return min(1.0 / (ratio - 1.0), MOST_ALIKE) if ratio > 1.0 else MOST_ALIKE

    def _slope(self) -> float | None:
        """The exponent p of C tol^p from the finest runs; None if two decades disagree."""
        tols = sorted(self.runs)[:4]
        if len(tols) < 3:
            return None
        errors = [self._difference(tols[0], tol) for tol in tols[1:]]
        if any(e <= SMALLEST for e in errors):
            return None
        slopes = [(log10(b) - log10(a)) / (log10(s) - log10(r))
                  for a, b, r, s in zip(errors, errors[1:], tols[1:], tols[2:])]  # fmt: skip
        consistent = all(SLOPES[0] <= s <= SLOPES[1] for s in slopes)
        return min(1.0, *slopes) if consistent else None

    def following(self, accuracy: float, unbalanced: bool) -> list[float]:
        """The tolerances of the next runs for `accuracy`. `unbalanced`: the finest runs agree, but violate
        the energy balance.  At the finest tolerance, one run between tells how the error falls."""
        if min(self.runs) <= FINEST:
            between = plain(10.0**0.75 * FINEST)
            return [] if between in self.runs or unbalanced else [between]
        fine = self._predicted(accuracy) if not unbalanced else max(FINEST, min(self.runs) / 100.0)
        coarse = max(10.0 * FINEST, min(10.0 * fine, *self.runs))
        return [plain(coarse), plain(coarse / 10.0)]

    def _predicted(self, accuracy: float) -> float:
        """The tolerance that should reach the accuracy, in steps of a quarter decade."""
        tols = sorted(self.runs)
        slope = self._slope() or 1.0
        error = SAFETY * max(self._difference(tols[0], tols[1]), SMALLEST) * self._gain()
        tol: float = tols[0] * (0.5 * accuracy / error) ** (1.0 / slope)
        tol = max(min(tol, tols[0] / 2.0), FINEST)
        if len(tols) > 2:  # one prediction has missed: where errors do not follow the law, go slowly
            most = tols[0] / 100.0
            tol = most if self._is_flat(tols) else max(tol, most)
        fine: float = 10.0 ** (0.25 * floor(4.0 * log10(tol)))
        return max(FINEST, fine)

    def _is_flat(self, tols: Sequence[float]) -> bool:
        """Whether the difference does not fall yet, because events determine the steps."""
        fine = self.runs[tols[0]]
        falls = self._difference(tols[0], tols[1]) < 0.5 * self._difference(tols[0], tols[2])
        return is_tied(fine.steps, fine.changes) and not falls

    def forget(self, tol: float) -> None:
        """Discard the differences with the run of this tolerance, which was replaced."""
        self.found = {pair: apart for pair, apart in self.found.items() if tol not in pair}

    def _difference(self, fine: float, coarse: float) -> float:
        if (fine, coarse) not in self.found:
            self.found[fine, coarse] = self.apart(self.runs[fine], self.runs[coarse])
        return self.found[fine, coarse]


def plain(tol: float) -> float:
    """Round to three digits, so that 1e-8/10 is the tolerance 1e-9 of an earlier run."""
    return float(f"{tol:.2e}")
