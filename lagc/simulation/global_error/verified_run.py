"""The global error of a run: chosen in advance, estimated by comparing two tolerances.

The error of a trajectory is the largest |x_i - exact_i| / scale_i over all its times and all coordinates
and speeds; scale_i is the largest magnitude, over the trajectory, of the states of the same kind
(coordinates, or speeds, of the same unit).  Pilots at 1e-5 and 1e-6 tell how it goes with the tolerance;
the run is made at the predicted one and at ten times it, and the finer one is returned with the error that
their difference tells (`lagc.simulation.global_error.truncation`).  What all runs share is added, the part
of rounding (`lagc.simulation.global_error.rounding`), and the energy has to be in balance
(`lagc.simulation.global_error.energy_balance`)."""

from __future__ import annotations

import marshal
from collections.abc import Callable, Sequence
from math import inf
from typing import TYPE_CHECKING

from lagc.base.records import dataclass, field, names
from lagc.base.text import FINEST
from lagc.host import cache
from lagc.host.cache import tool_fingerprint
from lagc.kernels.integrators.tableaus import order
from lagc.simulation.error_measure import Sizes, difference, moving, sizes
from lagc.simulation.global_error.truncation import SAFETY, Truncation, is_tied, plain
from lagc.simulation.system import INTERRUPTED, Options, System, Trajectory, arrived

if TYPE_CHECKING:
    from lagc.simulation.global_error.energy_balance import Balance
    from lagc.simulation.global_error.error_growth import Rounding


FORMAT = 4  # which every Python reads


def name_of(
    system: System, x0: Sequence[float], times: Sequence[float], accuracy: float, method: str,
    max_step: float | None,
) -> str:  # fmt: skip
    """The same question has the same answer, whether it is remembered or not; so all of it counts."""
    interface = system.interface
    values = [repr(v) for v in (accuracy, max_step, list(system.parameters), list(x0), list(times))]
    tool = tool_fingerprint()
    return cache.key("accuracy 8", tool, interface.model_hash, method, system.backend, *values)


@dataclass
class Remembered:
    """`end`: the last state, which the same run reaches again.  `still`: see
    `lagc.simulation.global_error.noise_groups`."""

    rtol: float
    estimated: float
    end: list[float]
    still: list[tuple[int, float]]


def recall(name: str) -> Remembered | None:
    return cache.load("accuracy", name, lambda body: Remembered(*marshal.loads(body)))


def remember(name: str, found: Remembered) -> None:
    cache.store("accuracy", name, marshal.dumps([getattr(found, name) for name in names(Remembered)], FORMAT))


def strays(trajectory: Trajectory, end: Sequence[float], groups: Sizes) -> float:
    """The scaled distance between the last state and `end`."""
    last = trajectory.states[-1]
    return max((abs(last[i] - end[i]) / size for group, size in groups if size for i in group), default=0.0)


HARMLESS = 0.25  # of the accuracy asked: of less rounding than that a bound is enough
COARSE, FINE = 1e-5, 1e-6  # the tolerances of the pilots
RETRY = 1e-9  # the tolerance that is tried where a coarser one fails
COARSER = 9.0  # times the tolerance: runs that differ by enough
ATTEMPTS = 5  # at a finer tolerance after the first estimate missed the target
# Of the time, the longest step at the tolerance COARSE: of any motion; where the rates depend on time itself
# between changes.
LONGEST, LONGEST_FLOWING = 0.5, 0.02
MEANINGLESS = 1e-2  # an estimate above it says that the end of the motion is not known at all

Progress = Callable[[float], None]


@dataclass
class Verified:
    """The trajectory to return and what is known of its error.

    `estimated` is infinite where no two runs could be compared; `rounding` is the part of it that no
    tolerance makes smaller, `drift` what it would be if differences did not grow.  `horizon` is the time
    until which the two finest runs agree to the accuracy asked, and rounding is known to stay below it; None
    where that is to the end.
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
    beside: Trajectory | None = None  # the finest of those far coarser, else the next
    still: dict[int, float] = field(default_factory=dict)  # see `lagc.simulation.global_error.noise_groups`


def method_for(accuracy: float) -> str:
    return "dopri5" if accuracy >= 1e-5 else "dop853"


def verified_run(
    system: System,
    x0: Sequence[float],
    times: Sequence[float],
    accuracy: float,
    progress: Progress | None = None,
    max_step: float | None = None,
) -> Verified:
    """The motion from (times[0], x0) to a global relative error of `accuracy`, where it can be had, in steps
    of at most `max_step`."""
    search = _Search(system, x0, times, accuracy, progress, max_step)
    name = name_of(system, x0, times, accuracy, search.method, max_step)
    remembered = recall(name)
    if remembered is not None:
        options = search.options(remembered.rtol)
        trajectory = search.run(remembered.rtol)
        if arrived(trajectory):
            still = dict(remembered.still)
            groups = moving(sizes(trajectory, system.interface), still)
            if strays(trajectory, remembered.end, groups) <= remembered.estimated:
                return Verified(trajectory, options, remembered.estimated, tried=search.tried, still=still)
    before = search.tried
    search = _Search(system, x0, times, accuracy, progress, max_step)
    found = search.verify()
    found.tried = [*before, *found.tried]
    trusted = found.balance is not None and found.balance.holds and found.estimated <= accuracy
    if arrived(found.trajectory) and trusted:
        last = found.trajectory.states[-1]
        remember(name, Remembered(found.options.rtol, found.estimated, last, [*found.still.items()]))
    return found


def longest_step(system: System, method: str, tol: float, time: float, max_step: float | None) -> float:
    """Of a run over a time, at a tolerance."""
    longest = (LONGEST_FLOWING if system.interface.flowing else LONGEST) * abs(time)
    found: float = min(longest, max_step or longest) * (tol / COARSE) ** (1.0 / order(method))
    return found


class _Search:
    def __init__(self, system: System, x0: Sequence[float], times: Sequence[float], accuracy: float,
                 progress: Progress | None, max_step: float | None):  # fmt: skip
        self.system, self.x0, self.times = system, x0, times
        self.accuracy, self.progress, self.max_step = accuracy, progress, max_step
        self.tried: list[Trajectory] = []
        self.runs: dict[float, Trajectory] = {}  # by tolerance
        self.whole: set[float] = set()  # tolerances of runs whose steps that end at a change are not halved
        self.rounded: dict[float, float] = {}  # by tolerance
        self.scales: dict[float, Sizes] = {}  # by tolerance
        self.truncation = Truncation(self.runs, self._sizes, order(self.method))
        self.balance: Balance | None = None
        self.along: Rounding | None = None  # the motion
        self.still: dict[int, float] = {}  # kinds that rounding alone moves, and how far

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
        longest = longest_step(self.system, self.method, tol, self.times[-1] - self.times[0], self.max_step)
        return Options(method=self.method, rtol=tol, max_steps=limit, max_step=longest, report=True,
                       watch=self._watch(longest), halves=tol not in self.whole)  # fmt: skip

    def _watch(self, longest: float) -> Callable[[Trajectory], bool]:
        checks = [(self.times[0], 0, 0.0)]

        def watch(run: Trajectory) -> bool:
            from lagc.simulation.supervision import is_stuck  # only for long runs

            return is_stuck(self.system, run, self.times[-1], longest, checks)

        return watch

    def run(self, tol: float, whole: bool = False) -> Trajectory:
        (self.whole.add if whole else self.whole.discard)(tol)
        self.truncation.forget(tol)
        self.rounded.pop(tol, None)
        self.scales.pop(tol, None)
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
            more = [] if settled else self.truncation.following(self.accuracy, self.balance is not None)
            if not more:
                break
            for tol in more:
                coarse = tol > min(*more, *self.runs)
                if stopped is None and (tol not in self.runs or (coarse and self._is_alike(tol))):
                    stopped = self._stopped(tol, whole=coarse)
        return stopped or self._result()

    def _pilots(self) -> Verified | None:
        """The first runs.  The coarse one begins displaced; at the start itself, where that would not do."""
        from lagc.simulation.global_error.error_growth import Rounding  # where there is no answer yet
        from lagc.simulation.global_error.noise_groups import still_kinds
        from lagc.simulation.global_error.rounding import quick_look

        stopped = self._stopped(FINE)
        if stopped is not None:
            return stopped
        tol = min(self.runs)
        system, run, groups = self.system, self.runs[tol], self._sizes(tol)
        look = quick_look(system, run, groups)
        self.still = still_kinds(system, run, groups, look)
        self.scales.clear()
        self.whole.add(COARSE)
        self.along = Rounding(system, run, self._sizes(tol), look, COARSE, self._integrate)
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

    def _is_alike(self, tol: float) -> bool:
        """Whether most steps of this run are those of a finer one, as they end where switches change."""
        run = self.runs[tol]
        return tol not in self.whole and is_tied(run.steps, run.changes)

    def _stopped(self, tol: float, whole: bool = False) -> Verified | None:
        """Integrate; a result where that ended before its time, at this and at a finer tolerance.

        It is the finest of the complete runs, where there is one: too fine a tolerance may fail by
        rounding alone.
        """
        before = {tol: self.runs[tol]} if tol in self.runs else {}
        done = self.run(tol, whole)
        if not arrived(done) and done.status != INTERRUPTED and tol > RETRY:
            del self.runs[tol]
            tol = RETRY
            done = self.run(tol, whole)  # what fails coarsely may go well finely
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
        if self.truncation.error() > self.accuracy:
            return len(self.runs) > 2 and self.drift() > self.accuracy
        if self.estimate() > self.accuracy:
            return self.rounding() >= self.accuracy
        before, self.balance = self.balance, self._balance()
        return self.balance.holds or (before is not None and self.balance.imbalance > 0.5 * before.imbalance)

    def estimate(self) -> float:
        """The error of the finest run."""
        return self.truncation.error() + (self.rounding() if len(self.runs) > 1 else 0.0)

    def rounding(self) -> float:
        """What rounding may bring to the finest run."""
        tol = min(self.runs)
        if tol not in self.rounded:
            left, harmless = self.accuracy - self.truncation.error(), HARMLESS * self.accuracy
            if self._interrupted:
                left = harmless = inf
            elif left <= 0.0:
                left = harmless
            injected = SAFETY * max(self.runs[tol].steps, 1) * tol  # by the method: it grows alike
            least = self.truncation.error() / injected
            assert self.along is not None
            sizes = self._sizes(tol)
            found = self.along.of(self.runs, sizes, least, min(left, harmless), left)
            if self.along.grown and found > (left if tol <= FINEST else self.accuracy):
                found = self.along.seen(self.runs, sizes, left)  # a rough bound is not what ends the search
            self.rounded[tol] = found
        return self.rounded[tol]

    def drift(self) -> float:
        """What rounding brings to the finest run, where it does not grow."""
        tol = min(self.runs)
        assert self.along is not None
        return self.along.drift(self.runs[tol], self._sizes(tol), self.accuracy)

    def _balance(self) -> Balance:
        from lagc.simulation.global_error.energy_balance import balance

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
            assert self.along is not None
            found.rounding, found.drift = self.rounding(), self.drift()
            apart = next((tol for tol in tols if tol > COARSER * tols[0]), tols[1])
            found.balance, found.beside = self.balance, self.runs[apart]
            if found.estimated > self.accuracy:
                finest, interface = self.runs[tols[0]], self.system.interface
                noise = self._rounded_away(found.beside)
                least = self.accuracy / SAFETY
                _, alike = difference(finest, found.beside, interface, least, noise)
                until, last = self.along.until(self.accuracy), self.times[-1]
                if alike is not None or self.times[0] < until < last:
                    found.horizon = min(last if alike is None else alike, until)
        return found
