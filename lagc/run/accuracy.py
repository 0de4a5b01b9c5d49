"""The global error of a run: chosen in advance, estimated by comparing two tolerances.

The error of a trajectory is the largest |x_i - exact_i| / scale_i over all recorded times and all
coordinates and speeds; scale_i is the largest magnitude, over the trajectory, of the states of the
same kind (coordinates, or speeds, of the same unit).  It behaves as C tol^p.  Pilots
at 1e-5 and 1e-6 give C and p; the run is made at the predicted tolerance and at ten times it, and the
finer one is returned with the error that their difference tells.  Where forces may bend or jump, C is
chance, and three differences tell it.  What all runs share is added, the part of rounding
(`lagc.run.rounding`), and the energy has to be in balance (`lagc.run.balance`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import floor, inf, log10
from typing import TYPE_CHECKING

from lagc.kernels.methods import order
from lagc.records import dataclass, field
from lagc.run.distance import Sizes, difference, moving, sizes, spread
from lagc.run.problem import INTERRUPTED, OK, Options, System, Trajectory
from lagc.run.remembered import Remembered, name_of, recall, remember, strays

if TYPE_CHECKING:
    from lagc.run.balance import Balance
    from lagc.run.growth import Rounding

SAFETY = 2.0  # on every estimate
FEW = 8.0  # steps: errors of that many follow no law, and differ by less than they are now and then
BENT = 30.0  # on errors in proportion to their tolerances, where forces may bend or jump
SAMPLES = 3  # of these
NEAR = 4.0  # times the finest tolerance is the next
HARMLESS = 0.25  # of the accuracy asked: of less rounding than that a bound is enough
CAUTION = 0.9  # of the slope found is believed for the decade that no finer run covers
COARSE, FINE = 1e-5, 1e-6  # the tolerances of the pilots
FINEST = 1e-15  # no tolerance is below this
MOST_ALIKE = 3.0  # steps may be as many for another reason: the stability of the method
SMALLEST = 1e-14  # rounding in a few steps; no difference tells of a smaller error
RETRY = 1e-9  # the tolerance that is tried where a coarser one fails
ATTEMPTS = 5  # at a finer tolerance after the first estimate missed the target
# Of the time, the longest step at the tolerance COARSE: of any motion; where the rates depend on time itself.
LONGEST, LONGEST_TIMED = 0.5, 0.02
SLOPES = (0.5, 1.6)  # of log(error) over log(tolerance) where they are believed
MEANINGLESS = 1e-2  # an estimate above it says that the end of the motion is not known at all

Progress = Callable[[float], None]


@dataclass
class Verified:
    """The trajectory to return and what is known of its error.

    `estimated` is infinite where no two runs could be compared; `rounding` is the part of it that no
    tolerance makes smaller, `drift` what it would be if differences did not grow.  `horizon` is the time
    until which the two finest runs agree to the accuracy asked; None where they do to the end.
    `balance` is None where the estimate missed the target anyway.
    """

    trajectory: Trajectory
    options: Options
    estimated: float
    horizon: float | None = None
    tried: list[Trajectory] = field(default_factory=list)
    failed: Trajectory | None = None  # at a finer tolerance
    rounding: float = 0.0
    drift: float = 0.0
    balance: Balance | None = None
    beside: Trajectory | None = None  # the next finest run
    still: dict[int, float] = field(default_factory=dict)  # see `lagc.run.still`


def method_for(accuracy: float) -> str:
    return "dopri5" if accuracy >= 1e-5 else "dop853"


def verified_run(
    system: System,
    x0: Sequence[float],
    times: Sequence[float],
    accuracy: float,
    progress: Progress | None = None,
) -> Verified:
    """The motion from (times[0], x0) to a global relative error of `accuracy`, where it can be had."""
    search = _Search(system, x0, times, accuracy, progress)
    name = name_of(system, x0, times, accuracy, search.method)
    remembered = recall(name)
    if remembered is not None:
        options = search.options(remembered.rtol)
        trajectory = search.run(remembered.rtol)
        if trajectory.status == OK:
            still = dict(remembered.still)
            away = strays(trajectory, remembered.end, moving(sizes(trajectory, system.interface), still))
            if away <= remembered.estimated:
                return Verified(trajectory, options, remembered.estimated, tried=search.tried, still=still)
    before = search.tried
    search = _Search(system, x0, times, accuracy, progress)
    found = search.verify()
    found.tried = [*before, *found.tried]
    trusted = found.balance is not None and found.balance.holds and found.estimated <= accuracy
    if found.trajectory.status == OK and trusted:
        last = found.trajectory.states[-1]
        remember(name, Remembered(found.options.rtol, found.estimated, last, [*found.still.items()]))
    return found


@dataclass
class _Search:
    system: System
    x0: Sequence[float]
    times: Sequence[float]
    accuracy: float
    progress: Progress | None
    tried: list[Trajectory] = field(default_factory=list)
    runs: dict[float, Trajectory] = field(default_factory=dict)  # by tolerance
    compared: dict[tuple[float, float], float] = field(default_factory=dict)
    rounded: dict[float, float] = field(default_factory=dict)  # by tolerance
    scales: dict[float, Sizes] = field(default_factory=dict)  # by tolerance
    balance: Balance | None = None
    along: Rounding | None = None  # the motion
    still: dict[int, float] = field(default_factory=dict)  # kinds that rounding alone moves, and how far

    @property
    def _bends(self) -> bool:
        """Whether steps may cross a bend or a jump, and errors follow no law."""
        return self.system.interface.bends

    @property
    def method(self) -> str:
        return method_for(self.accuracy)

    def options(self, tol: float) -> Options:
        """A run after the first may take many times the steps of the ones before, not any number, and none
        may creep.  Where time itself moves the system, no step is so long that it would see little of it.
        The longest step goes with the tolerance, as those do that the tolerance makes short: runs of the
        same steps have the same errors, and their difference would tell nothing."""
        before = max((r.steps + r.rejected for r in self.runs.values()), default=0)
        limit = 100 * before + 10_000 if before else 0
        share = LONGEST_TIMED if self.system.interface.timed else LONGEST
        longest = share * abs(self.times[-1] - self.times[0]) * (tol / COARSE) ** (1.0 / order(self.method))
        return Options(method=self.method, rtol=tol, max_steps=limit, max_step=longest, watch=self._watch())

    def _watch(self) -> Callable[[Trajectory], bool]:
        looks = [(self.times[0], 0, 0.0)]

        def watch(run: Trajectory) -> bool:
            from lagc.run.watch import hopeless  # where a run is long

            return hopeless(self.system, run, self.times[-1], looks)

        return watch

    def run(self, tol: float) -> Trajectory:
        self.runs[tol] = done = self._integrate(tol, self.x0)
        return done

    def _integrate(self, tol: float, start: Sequence[float], way: int = 0) -> Trajectory:
        options = self.options(tol)
        done = self.system.integrate(options, self.times[0], start, self.times, self.progress, way)
        self.tried.append(done)
        return done

    def verify(self) -> Verified:
        stopped = self._pilots()
        for _ in range(ATTEMPTS + 1):
            if stopped is not None:
                return stopped
            settled = self._settled()
            if self._interrupted:
                return self._kept()
            if settled or min(self.runs) <= FINEST:
                break
            for tol in self._following():
                if tol not in self.runs and stopped is None:
                    stopped = self._stopped(tol)
        return stopped or self._result()

    def _pilots(self) -> Verified | None:
        """The first runs.  The coarse one begins displaced; at the start itself, where that would not do."""
        from lagc.run.growth import Rounding  # where there is no answer yet
        from lagc.run.rounding import quick_look
        from lagc.run.still import still_kinds

        stopped = self._stopped(FINE)
        if stopped is not None:
            return stopped
        tol = min(self.runs)
        system, run, groups = self.system, self.runs[tol], self._sizes(tol)
        look = quick_look(system, run, groups)
        self.still = still_kinds(system, run, groups, look)
        self.scales.clear()
        self.along = Rounding(system, run, self._sizes(tol), look, COARSE, self._integrate)
        if self._interrupted:
            return self._kept()
        if not self.along.hides(self.accuracy / SAFETY):
            self.runs[COARSE] = self.along.beside
            return None
        stopped = self._stopped(COARSE)
        if stopped is None and len(self.runs) == 1:  # both failed, and the same finer one did not
            stopped = self._stopped(_plain(RETRY / 10.0))
        if stopped is None:
            self.along.bound = self.along.bounded(self.runs[max(self.runs)])
        return stopped

    def _stopped(self, tol: float) -> Verified | None:
        """Integrate; a result where that ended before its time, at this and at a finer tolerance.

        It is the finest of the complete runs, where there is one: too fine a tolerance may fail by
        rounding alone.
        """
        done = self.run(tol)
        if done.status not in (OK, INTERRUPTED) and tol > RETRY:
            del self.runs[tol]
            tol = RETRY
            done = self.run(tol)  # what fails coarsely may go well finely
        if done.status == OK:
            return None
        del self.runs[tol]
        if done.status == INTERRUPTED and self.runs:
            return self._kept()
        if self.runs:
            kept = self._result()
            kept.failed = done
            return kept
        estimated, _ = self._compare(done)
        return Verified(done, self.options(tol), estimated, None, self.tried)

    @property
    def _interrupted(self) -> bool:
        return self.tried[-1].status == INTERRUPTED

    def _kept(self) -> Verified:
        """A complete run, where a later one was interrupted: more than the beginning of that one."""
        kept = self._result()
        kept.trajectory = kept.trajectory.changed(status=INTERRUPTED)
        return kept

    def _settled(self) -> bool:
        """Whether no finer run is needed, or none would help."""
        if self._bends and len(self.runs) <= SAMPLES:
            return False
        if self.truncation() > self.accuracy:
            return len(self.runs) > 2 and self.drift() > self.accuracy
        if self.estimate() > self.accuracy:
            return self.rounding() >= self.accuracy
        before, self.balance = self.balance, self._balance()
        return self.balance.holds or (before is not None and self.balance.imbalance > 0.5 * before.imbalance)

    def estimate(self) -> float:
        """The error of the finest run."""
        return self.truncation() + (self.rounding() if len(self.runs) > 1 else 0.0)

    def rounding(self) -> float:
        """What rounding may bring to the finest run."""
        tol = min(self.runs)
        if tol not in self.rounded:
            left, harmless = self.accuracy - self.truncation(), HARMLESS * self.accuracy
            if self._interrupted:
                left = harmless = inf
            elif left <= 0.0:
                left = harmless
            injected = SAFETY * max(self.runs[tol].steps, 1) * tol  # by the method: it grows alike
            least = self.truncation() / injected
            assert self.along is not None
            found = self.along.of(self.runs, self._sizes(tol), least, min(left, harmless), left)
            self.rounded[tol] = found
        return self.rounded[tol]

    def drift(self) -> float:
        """What rounding brings to the finest run, where it does not grow."""
        tol = min(self.runs)
        assert self.along is not None
        return self.along.drift(self.runs[tol], self._sizes(tol), self.accuracy)

    def _balance(self) -> Balance:
        from lagc.run.balance import balance

        tol = min(self.runs)
        return balance(self.system, self.runs[tol], self._sizes(tol), self.accuracy)

    def _sizes(self, tol: float) -> Sizes:
        if tol not in self.scales:
            run = self.runs[tol]
            self.scales[tol] = moving(sizes(run, self.system.interface), self._rounded_away(run))
        return self.scales[tol]

    def _rounded_away(self, run: Trajectory) -> dict[int, float]:
        """How far rounding alone moves some kinds in a run; whatever they do where it began displaced."""
        displaced = self.along is not None and run is self.along.beside
        return dict.fromkeys(self.still, inf) if displaced else self.still

    def truncation(self) -> float:
        """The error of the finest run that its steps bring."""
        return self._across_bends() if self._bends else self._by_differences()

    def _across_bends(self) -> float:
        """Where in a step a bend lies is chance, at every tolerance anew, and so is the part that the step
        errs by of what it may.

        What it may goes with the tolerance.  So each run is a sample of one distribution, of errors over
        tolerances.  Few are beyond 30 times its median, and that all samples are far below it, or that the
        finest run and all others err alike, is seldom enough where there are three.  Now and then one of
        them is a freak, where all that a formula sees of a bend cancels: the largest of four is left out.
        """
        tols = sorted(self.runs)
        if len(tols) < 2:
            return inf
        found = sorted(self._difference(tols[0], tol) / tol for tol in tols[1 : 2 + SAMPLES])[:SAMPLES]
        return max(BENT * found[-1] * tols[0], SMALLEST)

    def _by_differences(self) -> float:
        """The error of the finest run: of the next coarser one by their difference, carried on by the
        slope over three runs where that is consistent.

        Two runs may happen to err alike: their difference counts for no less than the one before
        lets expect.
        """
        tols = sorted(self.runs)
        if len(tols) < 2:
            return inf
        difference = self._difference(tols[0], tols[1])
        alike = self._alike(self.runs[tols[0]].steps, self.runs[tols[1]].steps)
        if len(tols) == 2:
            return max(self._safety() * difference * max(1.0, alike), SMALLEST)
        before = self._difference(tols[0], tols[2])
        slope, step = self._slope(), tols[1] / tols[2]
        if slope is None:
            return max(self._safety() * max(difference, before * step * step) * max(1.0, alike), SMALLEST)
        gain: float = (tols[0] / tols[1]) ** (CAUTION * slope)
        return max(self._safety() * max(difference, before * step) * max(gain, alike), SMALLEST)

    def _safety(self) -> float:
        """On what a difference tells of the finest run."""
        return SAFETY * (1.0 + FEW / max(self.runs[min(self.runs)].steps, 1))

    def _alike(self, fine: int, coarse: int) -> float:
        """The error of the finer run over the difference, as the numbers of steps let expect: an error
        goes with the power -order of it, so that runs of like numbers differ by less than they err."""
        ratio = (fine / max(coarse, 1)) ** order(self.method)
        return min(1.0 / (ratio - 1.0), MOST_ALIKE) if ratio > 1.0 else MOST_ALIKE

    def _slope(self) -> float | None:
        """p of C tol^p, from the three finest runs; None where two decades disagree."""
        tols = sorted(self.runs)[:4]
        if len(tols) < 3:
            return None
        errors = [self._difference(tols[0], tol) for tol in tols[1:]]
        if any(e <= 1e-14 for e in errors):
            return None
        slopes = [(log10(b) - log10(a)) / (log10(s) - log10(r))
                  for a, b, r, s in zip(errors, errors[1:], tols[1:], tols[2:])]  # fmt: skip
        consistent = all(SLOPES[0] <= s <= SLOPES[1] for s in slopes)
        return min(1.0, *slopes) if consistent else None

    def _following(self) -> list[float]:
        """The tolerances of the next runs.  Across bends a near one tells most: a run that errs by much
        differs from it."""
        fine = self._predicted()
        if not self._bends:
            coarse = max(10.0 * FINEST, min(10.0 * fine, *self.runs))
            return [_plain(coarse), _plain(coarse / 10.0)]
        near = len(self.runs) >= SAMPLES and min(self.runs) <= NEAR * fine
        return [_plain(fine)] if near else [_plain(NEAR * fine), _plain(fine)]

    def _predicted(self) -> float:
        """The tolerance that should meet the target, in steps of a quarter decade."""
        tols = sorted(self.runs)
        if self.balance is not None:  # the runs agree, and yet they are wrong
            return max(FINEST, tols[0] / 100.0)
        slope, error = 1.0, self.truncation()
        if not self._bends:
            slope = self._slope() or 1.0
            difference = self._difference(tols[0], tols[1])
            error = self._safety() * max(difference, SMALLEST) * (tols[0] / tols[1]) ** slope
        tol: float = tols[0] * (0.5 * self.accuracy / error) ** (1.0 / slope)
        tol = max(min(tol, tols[0] / 2.0), FINEST)
        if len(tols) > 2:  # one prediction has missed: where errors do not follow the law, go slowly
            tol = max(tol, tols[0] / (NEAR if self._bends else 100.0))
        fine: float = 10.0 ** (0.25 * floor(4.0 * log10(tol)))
        return max(FINEST, fine)

    def _difference(self, fine: float, coarse: float) -> float:
        found = self.compared.get((fine, coarse))
        if found is None:
            found = spread(self.runs[fine], self.runs[coarse], self._sizes(fine), self._sizes(coarse))
            self.compared[fine, coarse] = found
        return found

    def _compare(self, done: Trajectory) -> tuple[float, float | None]:
        """`done`, which ended early, against the finest other run, over their common times."""
        others = [r for r in self.tried if r is not done and len(r.states) >= len(done.states)]
        if not others or len(done.states) < 2:
            return inf, None
        return difference(done, others[-1], self.system.interface, self.accuracy, self.still)

    def _result(self) -> Verified:
        tols = sorted(self.runs)
        found = Verified(self.runs[tols[0]], self.options(tols[0]), self.estimate(), None, self.tried)
        found.still = self.still
        if len(tols) > 1:
            found.rounding, found.drift = self.rounding(), self.drift()
            found.balance, found.beside = self.balance, self.runs[tols[1]]
            if found.estimated > self.accuracy:
                finest, interface = self.runs[tols[0]], self.system.interface
                noise = self._rounded_away(found.beside)
                safety = BENT * tols[0] / tols[1] if self._bends else SAFETY
                _, found.horizon = difference(finest, found.beside, interface, self.accuracy / safety, noise)
                if found.horizon is not None and self.along is not None:
                    found.horizon = min(found.horizon, self.along.until(self.accuracy))
        return found


def _plain(tol: float) -> float:
    """To three digits: 1e-8/10 is the tolerance 1e-9 that may have been run already."""
    return float(f"{tol:.2e}")
