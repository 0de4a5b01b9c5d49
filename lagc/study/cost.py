"""The price of accuracy: errors and CPU times of many settings on one motion, against a reference.

The study is a work-precision diagram (E. Hairer, S. P. Norsett, G. Wanner, Solving ODEs I, 1993, II.10) with
its conclusions: the settings that nothing beats, the law that connects tolerance and error, and from it the
setting to take for a target.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from statistics import median
from time import perf_counter

import numpy as np

from lagc.kernels import METHODS
from lagc.kernels.integrators.tableaus import adapts
from lagc.simulation.backends.compile import CannotCompile
from lagc.study.probe import Array, Failed, Probe, Setting, Shot

TARGETS = (1e-3, 1e-6, 1e-9, 1e-12)
ROUNDS = 9  # at least, in which all settings are timed in turn
CLOCK = 0.2  # of the budget, for which rounds go on
LEAST_TIME = 2e-3  # s of one measurement: shorter runs are repeated
REFERENCES = ((1e-22, 1e-20), (1e-20, 1e-18), (1e-18, 1e-16), (1e-16, 1e-15))
SECOND = (1e-16, 1e-15, 1e-14, 1e-13, 1e-12, 1e-11, 1e-10)  # tolerances of the second method
FINEST = {"dop853": 3e-15, "bs32": 1e-10}  # tolerances
USUAL = 1e-13  # the finest tolerance of the other methods
NEARBY = 10  # motions at nearby parameters, for the scatter of the laws
TRIED = (1e-3, 1e-5, 1e-7, 1e-9)  # errors near which these are made
TIMES = 4  # verified runs of a target; the fastest counts
SAFE = 0.9  # share of runs that meet the target with the setting for it
FLOOR = 30.0  # times the uncertainty of the reference, or of double precision: errors above follow a law
LEAST_POWER = 0.3  # of a tolerance or step in the law of the error
COARSE = 0.03  # errors above follow no law yet
CONSTANT = 1e-9  # of its largest value: a quantity with less range does not move

Progress = Callable[[float, str], None]


@dataclass(frozen=True)
class Reference:
    """The values that errors are measured against, and how far they are trusted."""

    shot: Shot
    scales: Array  # of each quantity: 0 where all its values are 0
    agreement: float  # of runs at two tolerances
    second: float  # of runs by two methods
    words: str


@dataclass
class Point:
    """A setting with its errors, by quantity, and its CPU times in s."""

    setting: Setting
    errors: Array
    rhs: int
    steps: int
    rejected: int
    estimate: float  # s, from the run that gave the errors
    times: list[float] = field(default_factory=list)

    @property
    def error(self) -> float:
        return float(self.errors.max(initial=0.0))

    @property
    def seconds(self) -> float:
        """The least of all times: other work on the machine makes a run slower, never faster."""
        return min(self.times, default=self.estimate)

    @property
    def spread(self) -> float:
        """The median over the least time, less 1."""
        return median(self.times) / self.seconds - 1.0 if self.times else 0.0


@dataclass(frozen=True)
class Law:
    """error = factor size^power; nine of ten runs, also at nearby parameters, err by less than `scatter`
    times that."""

    factor: float
    power: float
    scatter: float

    def size_for(self, target: float) -> float:
        """The tolerance or step with which an error above `target` is unlikely."""
        return float((target / (self.factor * self.scatter)) ** (1.0 / self.power))


@dataclass(frozen=True)
class Advice:
    """The setting for a target, its predicted time, and the price of one digit more (None: not reached)."""

    target: float
    setting: Setting | None
    seconds: float
    digit: float | None


@dataclass(frozen=True)
class Verified:
    """A run of `lagc sim --accuracy`: what was asked, estimated and made, and the CPU time in all."""

    asked: float
    status: str
    estimated: float | None
    error: float
    seconds: float
    rhs: int


@dataclass
class Study:
    """The results; `complete` is False where the budget or the user ended it early."""

    names: tuple[str, ...]
    stop: float
    recorded: int
    operations: int
    reference: Reference | None = None
    points: list[Point] = field(default_factory=list)
    laws: dict[str, Law] = field(default_factory=dict)
    nearby: dict[str, list[float]] = field(default_factory=dict)  # errors there over those of the law
    advice: list[Advice] = field(default_factory=list)
    verified: list[Verified] = field(default_factory=list)
    compilers: dict[str, float] = field(default_factory=dict)  # s by words
    notes: list[str] = field(default_factory=list)
    budget: float = 0.0  # s of wall time from `began`, of `perf_counter`
    began: float = 0.0
    spent: float = 0.0
    complete: bool = False

    @property
    def floor(self) -> float:
        """Errors below are those of the reference, or of one rounding."""
        known = 0.0 if self.reference is None else self.reference.agreement
        return max(known, 1e-15)

    @property
    def front(self) -> list[Point]:
        """The points that no other point beats in error and time, the coarsest first."""
        found: list[Point] = []
        least = float("inf")
        for point in sorted(self.points, key=lambda p: (p.seconds, p.error)):
            if point.error < least:
                found.append(point)
                least = point.error
        return found

    def conclude(self) -> None:
        """Set the laws and the advice from the points."""
        self.laws = {}
        for method in METHODS:
            law = fitted([p for p in self.points if p.setting.method == method], self.floor)
            if law is not None:
                beside = self.nearby.get(method, [])
                there = float(np.quantile(beside, SAFE)) if beside else 1.0
                self.laws[method] = replace(law, scatter=max(law.scatter, there))
        self.advice = [advise(self.points, self.laws, target) for target in TARGETS]


def fitted(points: Sequence[Point], floor: float) -> Law | None:
    """The law of the points of one method by least squares in logarithms; None for fewer than four."""
    used = [p for p in points if FLOOR * floor < p.error < COARSE]
    if len(used) < 4:
        return None
    x, y = np.log([p.setting.size for p in used]), np.log([p.error for p in used])
    power, offset = np.polyfit(x, y, 1)
    if not power > LEAST_POWER:
        return None  # the error does not follow the setting
    above = float(np.quantile(y - offset - power * x, SAFE))
    return Law(float(np.exp(offset)), float(power), float(np.exp(max(above, 0.0))))


def advise(points: Sequence[Point], laws: Mapping[str, Law], target: float) -> Advice:
    """The cheapest setting that meets `target` by the laws."""
    found: list[tuple[float, Setting, float | None]] = []
    for method, law in laws.items():
        own = sorted((p for p in points if p.setting.method == method), key=lambda p: p.setting.size)
        size = min(law.size_for(target), own[-1].setting.size)
        cost = predicted(own, size)
        if cost is None:
            continue
        more = predicted(own, law.size_for(0.1 * target))
        digit = None if more is None else max(more / cost - 1.0, 0.0)
        found.append((cost, setting_of(method, size), digit))
    for method in dict.fromkeys(p.setting.method for p in points if p.setting.method not in laws):
        own = [p for p in points if p.setting.method == method]
        if len(own) > 3 and max(p.error for p in own) <= target:  # as where only events limit the steps
            best = min(own, key=lambda p: p.seconds)
            found.append((best.seconds, best.setting, 0.0))
    if not found:
        return Advice(target, None, 0.0, None)
    cost, setting, digit = min(found, key=lambda each: each[0])
    return Advice(target, setting, cost, digit)


def predicted(points: Sequence[Point], size: float) -> float | None:
    """The time at a tolerance or step, from the line through the logarithms of the points nearest to it; None
    below the finest point."""
    if len(points) < 2 or size < 0.99 * points[0].setting.size:
        return None
    near = sorted(points, key=lambda p: abs(np.log(p.setting.size / size)))[:4]
    x, y = np.log([p.setting.size for p in near]), np.log([p.seconds for p in near])
    slope, offset = np.polyfit(x, y, 1)
    return float(np.exp(offset + slope * np.log(size)))


def errors_of(shot: Shot, reference: Reference) -> Array:
    """The largest error of each quantity over the recorded times, of its own scale."""
    exact = reference.shot
    n = min(len(shot.hi), len(exact.hi))
    if n < len(exact.hi):
        raise Failed(0)  # it ended before
    apart: Array = np.abs((shot.hi[:n] - exact.hi[:n]) + (shot.lo[:n] - exact.lo[:n])).max(axis=0)
    return scaled(apart, reference)


def scaled(apart: Array, reference: Reference) -> Array:
    """Differences over the scales of the quantities; 0 for a quantity without a scale."""
    apart = np.where(np.isfinite(apart), apart, np.inf)  # no value where the reference has one
    return np.divide(apart, reference.scales, out=np.zeros_like(apart), where=reference.scales > 0.0)


def scales_of(values: Array, sizes: Array) -> Array:
    """The range of each quantity; where it does not move, the size of its terms.  Values that are not finite
    have no scale."""
    with np.errstate(invalid="ignore"):
        span: Array = np.ptp(values, axis=0)
    found = np.where(span > CONSTANT * sizes, span, sizes)
    return np.where(np.isfinite(span) & np.isfinite(found), found, 0.0)


def refer(
    exact: Probe | None, plain: Probe, times: Sequence[float], sizes: Callable[[Array], Array], budget: float
) -> Reference:
    """The reference: quadruple precision at the finest pair of tolerances that the budget in s allows, and by
    a second method; without quadruple precision, two methods in double at their finest.  `sizes` as in
    `study`.  Raises Failed."""
    if exact is None:
        first, other = (plain.run(Setting(m, rtol=finest(m)), times) for m in ("dop853", "dopri5"))
        scales = scales_of(first.hi, sizes(first.hi))
        gap = _gap(first, other, scales)
        words = "double precision, dop853 at its finest tolerance (no quadruple precision)"
        return Reference(first, scales, gap, gap, words)
    pilot = exact.run(Setting("dop853", rtol=1e-14), times)
    fine, coarse = next(
        (pair for pair in REFERENCES if 2.0 * pilot.seconds * (1e-14 / pair[0]) ** (1 / 8) < 0.6 * budget),
        REFERENCES[-1],
    )
    shots = [exact.run(Setting("dop853", rtol=rtol), times) for rtol in (fine, coarse)]
    trial = exact.run(Setting("dopri5", rtol=1e-8), times)
    rtol = next((r for r in SECOND if trial.seconds * (1e-8 / r) ** (1 / 5) < 0.4 * budget), SECOND[-1])
    second = exact.run(Setting("dopri5", rtol=rtol), times)
    scales = scales_of(shots[0].hi, sizes(shots[0].hi))
    agreement, gap = (_gap(shots[0], other, scales) for other in (shots[1], second))
    words = f"quad, dop853 at tolerance {fine:.0e}: agrees with {coarse:.0e} to {agreement:.1e}, with dopri5"
    words += f" at {rtol:.0e} to {gap:.1e}"
    return Reference(shots[0], scales, agreement, gap, words)


def _gap(shot: Shot, other: Shot, scales: Array) -> float:
    return float(errors_of(other, Reference(shot, scales, 0.0, 0.0, "")).max(initial=0.0))


def study(
    make: Callable[[str, tuple[str, ...]], Probe],
    verify: Callable[[float], tuple[Verified, Array | None]],
    sizes: Callable[[Array], Array],
    nearby: Callable[[int], Probe | None],
    found: Study,
    times: Sequence[float],
    progress: Progress,
) -> Study:
    """Fill in the study `found` within about its budget; an interruption ends it early.

    `make(real, flags)` gives the probe of a type of numbers, with more compiler flags.  `verify(accuracy)`
    makes a run of that accuracy, and returns the outcome and its values at the recorded times.
    `sizes(values)` gives the size of the terms of each quantity over the motion, `nearby(k)` the probe of the
    k-th motion at nearby parameters, or None.  Raises CannotCompile, and
    Failed where not even the reference reaches its end.
    """
    began, budget = found.began, found.budget
    try:
        progress(0.0, "compiling")
        plain = make("double", ())
        try:
            exact = make("quad", ())
        except CannotCompile as error:
            found.notes.append(f"there is no quadruple precision: {error}")
            exact = None
        progress(0.05, "reference")
        left = max(budget - (perf_counter() - began), 0.2 * budget)
        found.reference = refer(exact, plain, times, sizes, 0.3 * left)
        if found.reference.shot.ended:
            found.notes.append(
                f"the model ends the motion after {len(found.reference.shot.hi)} recorded times"
            )
        measure(found, plain, times, perf_counter() + 0.5 * left, progress)
        found.conclude()
        look_nearby(found, nearby, times[: len(found.reference.shot.hi)], began + 0.95 * budget)
        found.conclude()
        for target in TARGETS:
            if perf_counter() - began > budget:
                break
            progress(0.85, f"lagc sim --accuracy {target:.0e}")
            outcome, values = verify(target)
            for _ in range(TIMES if outcome.seconds < 0.01 * budget else 0):  # the first run loads modules
                outcome = min(outcome, verify(target)[0], key=lambda each: each.seconds)
            made = float("nan") if values is None else _error_of(values, found.reference)
            found.verified.append(replace(outcome, error=made))
        if perf_counter() - began < budget:
            progress(0.95, "compiler options")
            compare_compilers(
                found, lambda flags: make("double", flags), times[: len(found.reference.shot.hi)]
            )
        found.complete = True
    except KeyboardInterrupt:
        found.notes.append("interrupted: the results so far")
        found.conclude()
    found.spent = perf_counter() - began
    return found


def _error_of(values: Array, reference: Reference) -> float:
    n = min(len(values), len(reference.shot.hi))
    apart: Array = np.abs(values[:n] - reference.shot.hi[:n]).max(axis=0)
    return float(scaled(apart, reference).max(initial=0.0))


def setting_of(method: str, size: float) -> Setting:
    """The setting with a tolerance, or with a step in s where the method takes fixed steps."""
    return Setting(method, rtol=size) if adapts(method) else Setting(method, step=size)


def finest(method: str) -> float:
    """The finest tolerance, or step, that is tried."""
    return FINEST.get(method, USUAL) if adapts(method) else 0.0


def settings(pilot: Shot, stop: float) -> Iterator[Setting]:
    """All settings to try, in an order that covers the range early."""
    decades = [10.0**-k for k in range(2, 15)]
    halves = [3.1622776601683795 * d for d in decades]
    step = stop / max(pilot.steps, 1)
    for part, sizes in enumerate((decades, halves)):
        for method in METHODS:
            if adapts(method):
                yield from (setting_of(method, r) for r in sizes if r >= finest(method))
            else:
                yield from (setting_of(method, step * 2.0 ** -(2 * k + part)) for k in range(-1, 5))


def measure(study: Study, plain: Probe, times: Sequence[float], deadline: float, progress: Progress) -> None:
    """Fill in the points of a study: first all errors, then the times in turn, until `deadline` (of
    `perf_counter`)."""
    reference = study.reference
    assert reference is not None
    horizon = reference.shot.hi.shape[0]
    grid = times[:horizon]
    pilot = plain.run(Setting("dop853", rtol=1e-4), grid)
    began = perf_counter()
    dearest: dict[str, float] = {}
    for setting in settings(pilot, times[-1]):
        left = deadline - perf_counter()
        if left < 0.5 * (deadline - began) or dearest.get(setting.method, 0.0) * 4.0 > 0.02 * left:
            continue  # the rest is for the clock
        try:
            shot = plain.run(setting, grid)
            errors = errors_of(shot, reference)
        except Failed:
            continue
        if not np.isfinite(errors).all():
            continue
        dearest[setting.method] = max(dearest.get(setting.method, 0.0), shot.seconds)
        study.points.append(
            Point(setting, errors, shot.rhs, shot.steps, shot.rejected, max(shot.seconds, 1e-9))
        )
        progress(0.2, f"{setting.method} {setting}")
    study.points.sort(key=lambda p: (METHODS.index(p.setting.method), -p.setting.size))
    enough = perf_counter() + CLOCK * study.budget
    rounds = 0
    while rounds < ROUNDS or perf_counter() < enough:
        for point in study.points:
            if perf_counter() > deadline and rounds > 0:
                return
            repeats = max(1, int(LEAST_TIME / point.seconds))
            point.times.append(max(plain.run(point.setting, grid, repeats).seconds, 1e-9))
        rounds += 1
        progress(0.2 + 0.6 * min(rounds / ROUNDS, 1.0), f"round {rounds}")


def look_nearby(
    study: Study, probe: Callable[[int], Probe | None], times: Sequence[float], deadline: float
) -> None:
    """Compare errors at nearby parameters with the laws; `probe(k)` is the k-th of them.  The finest run in
    double precision is the reference."""
    reference = study.reference
    settings: dict[str, list[Setting]] = {}
    for method, law in study.laws.items():
        sizes = [law.size_for(error) for error in TRIED]
        settings[method] = [setting_of(method, size) for size in sizes if size >= finest(method)]
    for k in range(NEARBY if settings and reference is not None else 0):
        beside = probe(k) if perf_counter() < deadline else None
        with suppress(Failed):
            if beside is not None and reference is not None:
                exact = replace(reference, shot=beside.run(Setting("dop853", rtol=1e-14), times))
                for method, law in study.laws.items():
                    for setting in settings[method]:
                        made = float(errors_of(beside.run(setting, times), exact).max(initial=0.0))
                        found = study.nearby.setdefault(method, [])
                        found.append(made / (law.factor * setting.size**law.power))


def compare_compilers(study: Study, make: Callable[[tuple[str, ...]], Probe], times: Sequence[float]) -> None:
    """Time the same setting with other compiler options: in turn, the least of all rounds."""
    setting = next((a.setting for a in study.advice if a.target == 1e-9 and a.setting), None)
    if setting is None:
        return
    options = ("-O2", "-O3 -march=native")
    try:
        probes = [make(tuple(words.split())) for words in options]
    except CannotCompile as error:
        study.notes.append(f"compiler options were not compared: {error}")
        return
    repeats = max(1, int(5.0 * LEAST_TIME / max(probes[0].run(setting, times).seconds, 1e-9)))
    least = [float("inf")] * len(probes)
    for _ in range(ROUNDS):
        for k, probe in enumerate(probes):
            least[k] = min(least[k], probe.run(setting, times, repeats).seconds)
    study.compilers = dict(zip(options, least))
