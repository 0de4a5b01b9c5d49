"""The error that its steps bring to the finest of some runs, as their differences tell, and which is next.

It behaves as C tol^p; where steps are few, p is chance.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import floor, inf, log10

from lagc.base.text import FINEST
from lagc.simulation.error_measure import Sizes, spread
from lagc.simulation.system import Trajectory

SAFETY = 2.0  # on every estimate
FEW = 24.0  # steps: half of the slope found is believed
CAUTION = 0.9  # of the slope found is believed for the decade that no finer run covers
MOST_ALIKE = 3.0  # steps may be as many for another reason: the stability of the method
SMALLEST = 1e-14  # rounding in a few steps; no difference tells of a smaller error
SLOPES = (0.5, 1.6)  # of log(error) over log(tolerance) where they are believed


def is_tied(steps: int, changes: int) -> bool:
    """Whether changes, more than the tolerance, tell where the steps of a run end: one at another tolerance
    has most of them too."""
    return steps < FEW * changes


class Truncation:
    """Of `runs`, by tolerance, to which more are added, by a method of this order; `sizes` of each by its
    tolerance."""

    def __init__(self, runs: Mapping[float, Trajectory], sizes: Callable[[float], Sizes], order: int):
        self.runs, self.sizes, self.order = runs, sizes, order
        self.found: dict[tuple[float, float], float] = {}

    def error(self) -> float:
        """Of the finest run; infinite where there is no other."""
        if len(self.runs) < 2:
            return inf
        return max(self._by_law(), SMALLEST)

    def _by_law(self) -> float:
        """The error of the next coarser run by their difference, carried on by the slope over three runs
        where that is consistent.

        Two runs may happen to err alike: their difference counts for no less than the one before
        lets expect.
        """
        tols = sorted(self.runs)
        difference, alike = self._difference(tols[0], tols[1]), self._alike(tols)
        if len(tols) == 2:
            return SAFETY * difference * max(1.0, alike)
        before, step = self._difference(tols[0], tols[2]), tols[1] / tols[2]
        if self._slope() is None:
            return SAFETY * max(difference, before * step * step) * max(1.0, alike)
        return SAFETY * max(difference, before * step) * max(self._gain(), alike)

    def _gain(self) -> float:
        """The error of the finest run over that of the next.  Errors of few steps between changes follow no
        law: the slope is believed in part."""
        tols = sorted(self.runs)[:2]
        fine = self.runs[tols[0]]
        steps = fine.steps / (fine.changes + 1)
        believed = CAUTION * steps / (steps + FEW)
        gain: float = (tols[0] / tols[1]) ** (believed * (self._slope() or 1.0))
        return gain

    def _alike(self, tols: Sequence[float]) -> float:
        """The error of the finer run over the difference, as the numbers of steps let expect: an error
        goes with the power -order of it, so that runs of like numbers differ by less than they err."""
        fine, coarse = (self.runs[tol].steps for tol in tols[:2])
        ratio = (fine / max(coarse, 1)) ** self.order
        return min(1.0 / (ratio - 1.0), MOST_ALIKE) if ratio > 1.0 else MOST_ALIKE

    def _slope(self) -> float | None:
        """p of C tol^p, from the finest runs; None where two decades disagree."""
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
        """The tolerances of the next runs, to this accuracy; the finest agree, and yet are wrong, where they
        are `unbalanced`.  Where there is no finer one, one between tells how errors fall to there."""
        if min(self.runs) <= FINEST:
            between = plain(10.0**0.75 * FINEST)
            return [] if between in self.runs or unbalanced else [between]
        fine = self._predicted(accuracy) if not unbalanced else max(FINEST, min(self.runs) / 100.0)
        coarse = max(10.0 * FINEST, min(10.0 * fine, *self.runs))
        return [plain(coarse), plain(coarse / 10.0)]

    def _predicted(self, accuracy: float) -> float:
        """The tolerance that should meet it, in steps of a quarter decade."""
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
        """Whether changes, not yet the tolerance, tell where steps end."""
        fine = self.runs[tols[0]]
        falls = self._difference(tols[0], tols[1]) < 0.5 * self._difference(tols[0], tols[2])
        return is_tied(fine.steps, fine.changes) and not falls

    def forget(self, tol: float) -> None:
        """The run of this tolerance is another."""
        self.found = {pair: apart for pair, apart in self.found.items() if tol not in pair}

    def _difference(self, fine: float, coarse: float) -> float:
        if (fine, coarse) not in self.found:
            runs = self.runs[fine], self.runs[coarse]
            self.found[fine, coarse] = spread(*runs, self.sizes(fine), self.sizes(coarse))
        return self.found[fine, coarse]


def plain(tol: float) -> float:
    """To three digits: 1e-8/10 is the tolerance 1e-9 that may have been run already."""
    return float(f"{tol:.2e}")
