"""A run with a given global error: the tolerance is chosen, and the error is estimated by comparing runs.

The error of a trajectory is the largest |y_i - exact_i| / s_i over its recorded times and all quantities:
coordinates, speeds, outputs and discrete variables.  `measure` gives the scale s_i of each of them.

Pilot runs at the tolerances 1e-5 and 1e-6 tell how the error depends on the tolerance.  A run at the
predicted tolerance and one at ten times that follow; the finer one is returned.  Its error is the
truncation error from the difference (`truncation`) plus the effect of round-off (`error_growth`).  The
energy must be in balance (`energy_balance`).
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from math import inf, sqrt
from typing import TYPE_CHECKING

from lagc.base.records import dataclass, field
from lagc.base.text import FINEST
from lagc.kernels import DEFAULT_METHOD, SERIES
from lagc.kernels.integrators.tableaus import order
from lagc.simulation.error_measure import Sizes, sizes
from lagc.simulation.global_error.measure import ROUNDING, ULP, Measure
from lagc.simulation.global_error.remembered_runs import Remembered, name_of, recall, remember
from lagc.simulation.global_error.truncation import SAFETY, Truncation, is_tied, plain
from lagc.simulation.system import INTERRUPTED, Options, System, Trajectory, arrived

if TYPE_CHECKING:
    from lagc.simulation.global_error.energy_balance import Balance
    from lagc.simulation.global_error.error_growth import Rounding


def distance_from(trajectory: Trajectory, end: Sequence[float], scales: Sequence[float]) -> float:
    """The distance between the last state of `trajectory` and `end`, over the scales of the states."""
    last = trajectory.states[-1]
    return max((abs(a - b) / scale for a, b, scale in zip(last, end, scales) if scale), default=0.0)


HARMLESS = 0.25  # of the accuracy asked: a bound of the round-off suffices below it
COARSE, FINE = 1e-5, 1e-6  # the tolerances of the pilots
RETRY = 1e-9  # the tolerance that is tried if a coarser one fails
COARSER = 9.0  # ratio of tolerances of runs that differ enough
ATTEMPTS = 5  # at finer tolerances after the first estimate
DWARFED = 100.0  # ratio of errors over own magnitudes and over sizes of groups: states get own weights
# The longest step at the tolerance COARSE, relative to the time: in general, and if the rates depend on time.
LONGEST, LONGEST_FLOWING = 0.5, 0.02
WALK = 0.58  # two standard deviations of a rounding to nearest, in units in the last place
MEANINGLESS = 1e-2  # estimate above which the end of the motion is unknown

Progress = Callable[[float], None]


@dataclass
class Verified:
    """The trajectory to return and its error.

    `estimated` is infinite if no two runs could be compared.  `rounding` is the part of it that no tolerance
    reduces, `drift` the same without growth.  Until `horizon`, the two finest runs agree to the accuracy
    asked and round-off is below it; None if that is the end.  `balance` is None if the estimate missed the
    accuracy.  `errors` and `scales` are those of each quantity.  `beside` is the coarser run for comparison,
    `failed` a run that failed at a finer tolerance, `limit` the quantity with the largest rounding unit over
    its scale, and this ratio."""

    trajectory: Trajectory
    options: Options
    estimated: float
    horizon: float | None = None
    tried: list[Trajectory] = field(default_factory=list)
    failed: Trajectory | None = None
    rounding: float = 0.0
    drift: float = 0.0
    balance: Balance | None = None
    beside: Trajectory | None = None
    errors: list[float] = field(default_factory=list)
    scales: list[float] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    limit: tuple[int, float] = (0, 0.0)


def verified_run(
    system: System,
    x0: Sequence[float],
    times: Sequence[float],
    accuracy: float,
    progress: Progress | None = None,
    max_step: float | None = None,
    scales: Mapping[str, float] = {},
    aside: Sequence[float] = (),
    method: str = DEFAULT_METHOD,
    most: int = 0,
    long: float = 0.0,
) -> Verified:
    """Return the motion from (times[0], x0) with a global relative error of `accuracy`, if it can be reached.
    Steps are at most `max_step` (s), and in the first run at most `most` (0: any number); `scales` are those
    that the user gives, by name; `aside` are times that show the ranges of outputs.  Raises StabilityLimited
    where `most` is negative and stability limits the steps of a long run, and LongRun where the first run
    would be smooth and have `long` steps or more (0: never).  A remembered run is repeated with its
    tolerance, and accepted if it ends at the same state."""
    given = (system, x0, times, accuracy, progress, max_step, scales, aside, method, most, long)
    search = _Search(*given)
    chosen_among = f"{search.method} below {long} steps" if long else search.method
    name = name_of(system, x0, times, accuracy, chosen_among, max_step, scales)
    remembered = recall(system, name)
    if remembered is not None:
        search.alone = remembered.alone
        options = search.options(remembered.rtol)
        trajectory = search.run(remembered.rtol)
        if arrived(trajectory):
            known = remembered.scales[: system.nq + system.nv]
            if distance_from(trajectory, remembered.end, known) <= remembered.estimated:
                return Verified(
                    trajectory, options, remembered.estimated, tried=search.tried, notes=remembered.notes,
                    errors=remembered.errors, scales=remembered.scales,
                )  # fmt: skip
    before = search.tried
    search = _Search(*given)
    found = search.verify()
    found.tried = [*before, *found.tried]
    trusted = found.balance is not None and found.balance.holds and found.estimated <= accuracy
    if arrived(found.trajectory) and trusted:
        last = found.trajectory.states[-1]
        remember(
            system, name,
            Remembered(found.options.rtol, found.options.alone, found.estimated, last, found.errors,
                       found.scales, found.notes),
        )  # fmt: skip
    return found


def longest_step(system: System, method: str, tol: float, time: float, max_step: float | None) -> float:
    """The longest step of a run of the duration `time` at the tolerance `tol`, in s. It decreases with the
    tolerance, as chosen steps do: runs with the same steps would have the same errors."""
    longest = (LONGEST_FLOWING if system.interface.flowing else LONGEST) * abs(time)
    found: float = min(longest, max_step or longest) * (tol / COARSE) ** (1.0 / order(method))
    return found


class _Search:
    def __init__(self, system: System, x0: Sequence[float], times: Sequence[float], accuracy: float,
                 progress: Progress | None, max_step: float | None, scales: Mapping[str, float],
                 aside: Sequence[float], method: str, most: int, long: float):  # fmt: skip
        self.method, self.most, self.long = method, most, long
        self.system, self.x0, self.times = system, x0, times
        self.accuracy, self.progress, self.max_step = accuracy, progress, max_step
        self.scales, self.aside = scales, frozenset(aside)
        self.all_times = sorted([*times, *aside]) if aside else times
        self.tried: list[Trajectory] = []
        self.alone = False  # whether the tolerance holds for each state, not for its scaling group
        self.measure = Measure(system, scales)
        self._begin()

    def _begin(self) -> None:
        self.runs: dict[float, Trajectory] = {}  # by tolerance
        self.whole: set[float] = set()  # tolerances of runs whose steps before an event are not halved
        self.rounded: dict[float, float] = {}  # the effect of round-off by tolerance
        self.measure = Measure(self.system, self.scales, self.measure.unresolved)
        fixed = 0 if self.method in SERIES else order(self.method)
        self.truncation = Truncation(self.runs, self.measure.apart, fixed)
        self.balance: Balance | None = None
        self.along: Rounding | None = None

    def options(self, tol: float) -> Options:
        """The options of a run; after the first run, the number of steps is limited."""
        before = max((r.steps + r.rejected for r in self.runs.values()), default=0)
        limit = 100 * before + 10_000 if before else max(self.most, 0)
        longest = longest_step(self.system, self.method, tol, self.times[-1] - self.times[0], self.max_step)
        watch, halves = self._watch(longest, tol), tol not in self.whole
        return Options(method=self.method, rtol=tol, max_steps=limit, max_step=longest, report=True,
                       watch=watch, halves=halves, alone=self.alone)  # fmt: skip

    def _watch(self, longest: float, tol: float) -> Callable[[Trajectory], bool]:
        checks = [(self.times[0], 0, 0.0)]

        def watch(run: Trajectory) -> bool:
            # Only for long runs.
            from lagc.simulation.supervision import check_length, check_stability, is_stuck

            if self.long and tol == FINE and not self.runs:
                check_length(run, self.times[0], self.times[-1], self.long)
            if self.most < 0:
                check_stability(run, self.times[0], self.times[-1])
            return is_stuck(self.system, run, self.times[-1], longest, checks)

        return watch

    def run(self, tol: float, whole: bool = False) -> Trajectory:
        (self.whole.add if whole else self.whole.discard)(tol)
        self.truncation.forget(tol)
        self.rounded.pop(tol, None)
        self.runs[tol] = done = self._integrate(tol, self.x0)
        return done

    def _integrate(self, tol: float, start: Sequence[float], direction: int = 0) -> Trajectory:
        options = self.options(tol)
        done = self.system.integrate(options, self.times[0], start, self.all_times, self.progress, direction)
        done = self.measure.without(done, self.aside)
        self.tried.append(done)
        return done

    def verify(self) -> Verified:
        stopped = self._pilots()
        attempts = ATTEMPTS + 1
        while attempts > 0:
            attempts -= 1
            if stopped is not None:
                return stopped
            settled = self._settled()
            if self._interrupted:
                return self._kept()
            unmet = not settled or self.estimate() > self.accuracy
            dwarfed = not settled and self._is_dwarfed()
            if dwarfed or (unmet and self._is_unresolved()):
                self.alone |= dwarfed
                self._begin()
                stopped, attempts = self._pilots(), ATTEMPTS + 1
                continue
            more = [] if settled else self.truncation.following(self.accuracy, self.balance is not None)
            if not more:
                break
            for tol in more:
                coarse = tol > min(*more, *self.runs)
                if stopped is None and (tol not in self.runs or (coarse and self._is_alike(tol))):
                    stopped = self._stopped(tol, whole=coarse)
        return stopped or self._result()

    def _pilots(self) -> Verified | None:
        """The first two runs; the coarse one starts from a displaced state, if that does not hide its
        error."""
        from lagc.simulation.global_error.error_growth import Rounding
        from lagc.simulation.global_error.roundoff_estimate import find_noise_groups, harmless, quick_estimate

        stopped = self._stopped(FINE)
        if stopped is not None:
            return stopped
        tol = min(self.runs)
        system, run, groups = self.system, self.runs[tol], self._sizes(tol)
        estimate = quick_estimate(system, run, groups)
        noise = find_noise_groups(system, run, groups, estimate)
        self.measure.ignore(harmless(system, run, groups, noise, self.accuracy))
        self.whole.add(COARSE)
        self.along = Rounding(system, run, self._sizes(tol), estimate, COARSE, self._integrate)
        if self._interrupted:
            return self._kept()
        if not self.along.hides(self.accuracy / SAFETY):
            self.runs[COARSE] = self.along.beside
            return None
        stopped = self._stopped(COARSE, whole=True)
        if stopped is None and len(self.runs) == 1:  # both failed, and the same finer one did not
            stopped = self._stopped(plain(RETRY / 10.0))
        if stopped is None:
            self.along.bound = self.along.bounded(self.runs[max(self.runs)])
        return stopped

    def _is_dwarfed(self) -> bool:
        """Whether states miss the accuracy that are so small beside others of their scaling groups that the
        tolerance says nothing about them."""
        if self.alone or len(self.runs) < 2:
            return False
        fine, coarse = (self.runs[tol] for tol in sorted(self.runs)[:2])
        n = self.system.nq + self.system.nv
        gaps = self.measure.gaps(fine, coarse)[:n]
        shares = self.measure.shares(gaps, fine)
        largest = [max(abs(low), abs(high)) for low, high in zip(fine.lowest, fine.highest)]
        groups = sizes(fine, self.system.interface)
        shared = max((gaps[i] / size for group, size in groups if size for i in group), default=0.0)
        return any(
            share > self.accuracy / SAFETY and gap > DWARFED * shared * own
            for share, gap, own in zip(shares, gaps, largest)
        )

    def _is_unresolved(self) -> bool:
        """Whether the finest runs tell of more states that are unresolved."""
        if len(self.runs) < 3:
            return False
        fine, coarse, *others = sorted(self.runs)
        fall = sqrt(coarse / others[0])
        return self.measure.find_unresolved(self.runs[fine], self.runs[coarse], self.runs[others[0]], fall)

    def _is_alike(self, tol: float) -> bool:
        """Whether most steps of this run are those of a finer one, because events end them."""
        run = self.runs[tol]
        return tol not in self.whole and is_tied(run.steps, run.changes)

    def _stopped(self, tol: float, whole: bool = False) -> Verified | None:
        """Integrate; return a result if the run fails, at this tolerance and at a finer one. The result is
        the finest complete run, if there is one, because a very fine tolerance may fail by round-off."""
        before = {tol: self.runs[tol]} if tol in self.runs else {}
        done = self.run(tol, whole)
        if not arrived(done) and done.status != INTERRUPTED and tol > RETRY:
            del self.runs[tol]
            tol = RETRY
            done = self.run(tol, whole)
        if arrived(done):
            return None
        del self.runs[tol]
        self.runs.update(before)
        self.whole -= before.keys()
        if done.status == INTERRUPTED and self.runs:
            return self._kept()
        if self.runs:
            kept = self._result()
            kept.failed = done
            return kept
        scales = self.measure.of(done).scales
        return Verified(done, self.options(tol), self._compare(done), tried=self.tried, scales=scales)

    @property
    def _interrupted(self) -> bool:
        return self.tried[-1].status == INTERRUPTED

    def _kept(self) -> Verified:
        """A complete run, after a later one was interrupted."""
        kept = self._result()
        kept.trajectory = kept.trajectory.changed(status=INTERRUPTED)
        return kept

    def _settled(self) -> bool:
        """Whether no finer run is needed, or none would help."""
        if self.truncation.error() > self.accuracy:
            return len(self.runs) > 2 and max(self.drift(), self._floor()) > self.accuracy
        if self.estimate() > self.accuracy:
            return self.rounding() >= self.accuracy
        before, self.balance = self.balance, self._balance()
        return self.balance.holds or (before is not None and self.balance.imbalance > 0.5 * before.imbalance)

    def estimate(self) -> float:
        """The error of the finest run."""
        return self.truncation.error() + (self.rounding() if len(self.runs) > 1 else 0.0)

    def rounding(self) -> float:
        """The effect of round-off on the finest run."""
        tol = min(self.runs)
        if tol not in self.rounded:
            left, harmless = self.accuracy - self.truncation.error(), HARMLESS * self.accuracy
            if self._interrupted:
                left = harmless = inf
            elif left <= 0.0:
                left = harmless
            # local errors, which grow as round-off does
            injected = SAFETY * max(self.runs[tol].steps, 1) * tol
            least = self.truncation.error() / injected
            assert self.along is not None
            sizes = self._sizes(tol)
            found = self.along.of(self.runs, sizes, least, min(left, harmless), left)
            if self.along.grown and found > (left if tol <= FINEST else self.accuracy):
                found = self.along.seen(self.runs, sizes, left)  # a rough bound does not end the search
            self.rounded[tol] = max(found, self._floor())
        return self.rounded[tol]

    def _floor(self) -> float:
        """The largest rounding of a quantity of the finest run, over its scale."""
        return max(self._floors(), default=0.0)

    def _floors(self) -> list[float]:
        """The rounding of coordinates, speeds and outputs of the finest run over their scales, as a random
        walk over the steps (P. Henrici, Discrete Variable Methods, 1962, section 1.5)."""
        run = self.runs[min(self.runs)]
        floors, walk = self.measure.of(run).floors, sqrt(max(run.steps, 1))
        first, discrete = self.system.nq + self.system.nv, len(self.system.interface.discretes)
        parts = [WALK] * first + [1.0] * (len(floors) - discrete - first)
        return [part * walk * floor for part, floor in zip(parts, floors)]

    def drift(self) -> float:
        """The effect of round-off on the finest run without growth."""
        tol = min(self.runs)
        assert self.along is not None
        return self.along.drift(self.runs[tol], self._sizes(tol), self.accuracy)

    def _balance(self) -> Balance:
        from lagc.simulation.global_error.energy_balance import balance

        tol = min(self.runs)
        others = [run for other, run in self.runs.items() if other != tol]
        return balance(self.system, self.runs[tol], self._sizes(tol), self.accuracy, others)

    def _sizes(self, tol: float) -> Sizes:
        return self.measure.sizes(self.runs[tol])

    def _compare(self, done: Trajectory) -> float:
        """The distance of `done`, which ended early, from the finest other run over their common times."""
        others = [r for r in self.tried if r is not done and len(r.states) >= len(done.states)]
        return inf if not others or len(done.states) < 2 else self.measure.apart(done, others[-1])

    def _errors(self, until: float = inf) -> list[float]:
        """The errors of each quantity of the finest run, from its difference to the next coarser one and
        round-off; empty if it is the only one.  `until` a horizon, from the runs that agree until then."""
        if len(self.runs) < 2:
            return []
        fine, coarse = (self.runs[tol] for tol in sorted(self.runs)[:2])
        factor, rounding, found = self.truncation.factor(), self.rounding(), self.measure.of(fine)
        if until < inf:
            assert self.along is not None
            factor, rounding = SAFETY, self.along.effect(until, min(rounding, self.accuracy))
            n = bisect_right(fine.times, until)
            fine, coarse = (run.changed(times=run.times[:n], states=run.states[:n])
                            for run in (fine, self._apart_from_finest()))  # fmt: skip
        errors = [factor * gap for gap in self.measure.gaps(fine, coarse)]
        moving = len(errors) - len(self.system.interface.discretes)
        for i, (scale, size) in enumerate(zip(found.scales[:moving], found.sizes)):
            share = min(rounding, ROUNDING) if i in self.measure.unresolved else rounding
            errors[i] += max(share * scale, ULP * size)
        return errors

    def _apart_from_finest(self) -> Trajectory:
        """The run at the finest tolerance that differs enough from the finest one, or else the next one."""
        finest, *others = sorted(self.runs)
        return self.runs[next((tol for tol in others if tol > COARSER * finest), others[0])]

    def _result(self) -> Verified:
        tols = sorted(self.runs)
        found = Verified(self.runs[tols[0]], self.options(tols[0]), self.estimate(), None, self.tried)
        finest, measure = self.runs[tols[0]], self.measure
        scales = measure.of(finest)
        found.errors, found.scales = self._errors(), scales.scales
        found.notes = measure.notes(finest, found.errors, self.accuracy)
        if measure.noise:
            from lagc.simulation.global_error.roundoff_estimate import noise_note

            found.notes = noise_note(self.system, finest, measure.noise) + found.notes
        found.limit = max(enumerate(scales.floors), key=lambda each: each[1], default=(0, 0.0))
        if len(tols) > 1:
            assert self.along is not None
            found.rounding, found.drift = self.rounding(), self.drift()
            found.balance, found.beside = self.balance, self._apart_from_finest()
            if found.estimated > self.accuracy:
                alike = measure.agree_until(finest, found.beside, self.accuracy / SAFETY)
                until, last = self.along.until(self.accuracy), self.times[-1]
                if alike is not None or self.times[0] < until < last:
                    found.horizon = min(last if alike is None else alike, until)
                    if found.estimated >= MEANINGLESS:
                        found.errors = self._errors(found.horizon)
        return found
