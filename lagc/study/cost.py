"""The price of accuracy: errors and CPU times of many settings on one motion, against a reference.

The study is a work-precision diagram (E. Hairer, S. P. Norsett, G. Wanner, Solving ODEs I, 1993, II.10) with
its conclusions: the settings that nothing beats, the law that connects tolerance and error, and from it the
setting to take for a target.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from time import perf_counter

import numpy as np

from lagc.kernels import METHODS
from lagc.kernels.integrators.tableaus import adapts
from lagc.simulation.backends.compile import CannotCompile
from lagc.study.advice import Advice, Law, Point, advise, finest, fitted, setting_of
from lagc.study.probe import Array, Failed, Late, Probe, Setting, Shot

TARGETS = (1e-3, 1e-6, 1e-9, 1e-12)
ROUNDS = 9  # at least, in which all settings are timed in turn
LEFT = 0.15  # of the budget, for nearby parameters at least
LONGEST = 2.0  # of the rest of the budget, after which a run ends that goes on
CLOCK = 0.2  # of the budget, for which rounds go on
LEAST_TIME = 2e-3  # s of one measurement: shorter runs are repeated
REFERENCES = ((1e-22, 1e-20), (1e-20, 1e-18), (1e-18, 1e-16), (1e-16, 1e-15))
SECOND = (1e-16, 1e-15, 1e-14, 1e-13, 1e-12, 1e-11, 1e-10)  # tolerances of the second method
DEAR = 4.0  # runs in quadruple precision that the budget of the reference has to allow for a pair of its own
NEARBY = 20  # motions at nearby parameters, at which a setting has to meet its target
TRIES = 6  # corrections of a setting
CLEAR = 0.8  # of the target, at which a correction aims
TIMES = 4  # verified runs of a target; the fastest counts
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
    sizes: dict[tuple[str, float], float] = field(default_factory=dict)  # by method and target, as corrected
    met: dict[tuple[str, float], int] = field(default_factory=dict)  # of the motions at nearby parameters
    tried: int = 0  # of these
    advice: list[Advice] = field(default_factory=list)
    verified: list[Verified] = field(default_factory=list)
    compilers: dict[str, float] = field(default_factory=dict)  # s by words
    notes: list[str] = field(default_factory=list)
    budget: float = 0.0  # s of wall time from `began`, of `perf_counter`
    began: float = 0.0
    spent: float = 0.0
    complete: bool = False
    late: bool = False  # a run took longer than the budget

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
                self.laws[method] = law
        self.advice = [self._advice(target) for target in TARGETS]

    def _advice(self, target: float) -> Advice:
        found = advise(self.points, self.laws, target, self.sizes)
        met = self.met.get((found.setting.method, target)) if found.setting else None
        return found if met is None else replace(found, met=met, tried=self.tried)


def errors_of(hi: Array, lo: Array | float, reference: Reference) -> Array:
    """The largest error of each quantity of the values hi + lo over the recorded times, of its own scale."""
    exact = reference.shot
    if len(hi) < len(exact.hi):
        raise Failed(0)  # it ended before
    apart: Array = np.abs((hi - exact.hi) + (lo - exact.lo)).max(axis=0)
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
    words = "no quadruple precision"
    if exact is not None:
        exact.deadline = perf_counter() + 2.0 * budget
        try:
            return _exact(exact, times, sizes, budget)
        except Late:
            words = "quadruple precision takes too long"
    first, other = (plain.run(Setting(m, rtol=finest(m)), times) for m in ("dop853", "dopri5"))
    scales = scales_of(first.hi, sizes(first.hi))
    gap = _gap(first, other, scales)
    return Reference(first, scales, gap, gap, f"double precision, dop853 at its finest tolerance ({words})")


def _exact(exact: Probe, times: Sequence[float], sizes: Callable[[Array], Array], budget: float) -> Reference:
    """The reference in quadruple precision.  Raises Failed, and Late after twice the budget."""
    pilot = exact.run(Setting("dop853", rtol=1e-14), times)
    # The time of an order 8 method grows as tolerance^(-1/8), that of dopri5 as tolerance^(-1/5): the
    # finest runs that the budget allows are foreseen from one coarse run each.
    fine, coarse = next(
        (pair for pair in REFERENCES if 2.0 * pilot.seconds * (1e-14 / pair[0]) ** (1 / 8) < 0.6 * budget),
        REFERENCES[-1],
    )
    shots = [exact.run(Setting("dop853", rtol=fine), times)]
    if DEAR * pilot.seconds < budget:
        shots.append(exact.run(Setting("dop853", rtol=coarse), times))
    else:  # as where stability limits the steps: the pilot is exact enough
        coarse = 1e-14
        shots.append(pilot)
    second = exact.run(Setting("dopri5", rtol=1e-8), times)
    rtol = next((r for r in SECOND if second.seconds * (1e-8 / r) ** (1 / 5) < 0.4 * budget), 1e-8)
    if rtol < 1e-8:
        second = exact.run(Setting("dopri5", rtol=rtol), times)
    scales = scales_of(shots[0].hi, sizes(shots[0].hi))
    agreement, gap = (_gap(shots[0], other, scales) for other in (shots[1], second))
    words = f"quad, dop853 at tolerance {fine:.0e}: agrees with {coarse:.0e} to {agreement:.1e}, with dopri5"
    words += f" at {rtol:.0e} to {gap:.1e}"
    return Reference(shots[0], scales, agreement, gap, words)


def _gap(shot: Shot, other: Shot, scales: Array) -> float:
    return float(errors_of(other.hi, other.lo, Reference(shot, scales, 0.0, 0.0, "")).max(initial=0.0))


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
    began, budget, at = found.began, found.budget, (0.0, "compiling")

    def tell(share: float, words: str) -> None:
        nonlocal at
        at = share, words
        progress(share, words)

    try:
        tell(*at)
        plain, exact = _probes(make, lambda: progress(*at), found.notes)
        # The reference, the errors and times of all settings, and the advice for the targets.
        plain.deadline = max(began + LONGEST * budget, perf_counter() + budget)  # compiling may take longer
        tell(0.05, "reference")
        left = max(budget - (perf_counter() - began), 0.2 * budget)
        plain.deadline = perf_counter() + LONGEST * left
        found.reference = refer(exact, plain, times, sizes, 0.3 * left)
        recorded = len(found.reference.shot.hi)
        if found.reference.shot.ended:
            found.notes.append(f"the model ends the motion after {recorded} recorded times")
        measure(found, plain, times, perf_counter() + 0.5 * left, tell)
        found.conclude()
        deadline = max(began + 0.95 * budget, perf_counter() + LEFT * budget)
        look_nearby(found, plain, nearby, times[:recorded], deadline)
        found.conclude()
        # Then verified runs and other compiler options, as long as the budget lasts.
        for target in TARGETS:
            if perf_counter() - began > budget:
                break
            tell(0.85, f"lagc sim --accuracy {target:.0e}")
            found.verified.append(_verified(verify, target, found.reference, budget))
        if perf_counter() - began < budget:
            tell(0.95, "compiler options")
            compare_compilers(found, lambda flags: make("double", flags), times[:recorded])
        found.complete = True
    except (KeyboardInterrupt, Late) as error:
        if found.reference is None and isinstance(error, Late):
            raise
        found.late = isinstance(error, Late)
        why = "a run took too long" if found.late else "interrupted"
        found.notes.append(f"{why}: the results so far")
        found.conclude()
    found.spent = perf_counter() - began
    return found


def _probes(
    make: Callable[[str, tuple[str, ...]], Probe], look: Callable[[], None], notes: list[str]
) -> tuple[Probe, Probe | None]:
    """Return the probes in double and in quadruple precision, if there is one; a note says why not.  Raises
    CannotCompile without the first."""
    plain, exact = make("double", ()), None
    plain.look = look
    try:
        exact = make("quad", ())
        exact.look = look
    except CannotCompile as error:
        notes.append(f"there is no quadruple precision: {error}")
    return plain, exact


def _verified(
    verify: Callable[[float], tuple[Verified, Array | None]],
    target: float,
    reference: Reference,
    budget: float,
) -> Verified:
    """Return the outcome of a verified run with the error that it made; the fastest of several where one is
    short, as the first loads modules."""
    outcome, values = verify(target)
    for _ in range(TIMES if outcome.seconds < 0.01 * budget else 0):
        outcome = min(outcome, verify(target)[0], key=lambda each: each.seconds)
    error = float("nan")
    with suppress(Failed):
        if values is not None:
            error = float(errors_of(values, 0.0, reference).max(initial=0.0))
    return replace(outcome, error=error)


def settings(pilot: Shot, stop: float) -> Iterator[Setting]:
    """Yield all settings to try, in an order that covers the range early."""
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
    # The pilot gives the step size that fixed steps begin with. A model may end the motion early: only what
    # the reference has is compared.
    horizon = reference.shot.hi.shape[0]
    grid = times[:horizon]
    pilot = plain.run(Setting("dop853", rtol=1e-4), grid)
    began = perf_counter()
    dearest: dict[str, float] = {}
    # First the errors, with half of the time.  Settings go from coarse to fine, and a method ends where its
    # next run, about four times its dearest so far, would take a fiftieth of the time.
    for setting in settings(pilot, times[-1]):
        left = deadline - perf_counter()
        if left < 0.5 * (deadline - began) or dearest.get(setting.method, 0.0) * 4.0 > 0.02 * left:
            continue  # the rest is for the clock
        try:
            shot = plain.run(setting, grid)
            errors = errors_of(shot.hi, shot.lo, reference)
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
    # Then the clock. All settings are timed in turn, so that a disturbance of the machine meets all of
    # them, and short runs are repeated up to LEAST_TIME. The least time of a point counts.
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
    study: Study, plain: Probe, probe: Callable[[int], Probe | None], times: Sequence[float], deadline: float
) -> None:
    """Correct the settings for the targets until they meet them, on this motion and on those at nearby
    parameters; `probe(k)` is the k-th of them.  The finest run in double precision is the reference there.
    Raises Late at the deadline of `plain`; a run that goes on at `deadline` ends the corrections."""
    assert study.reference is not None
    beside = [(plain, study.reference)]
    # Half of the time makes the references at nearby parameters, the rest corrects the settings.
    middle = 0.5 * (perf_counter() + deadline)
    for k in range(NEARBY if study.laws else 0):
        with suppress(Failed, Late):
            found = probe(k) if perf_counter() < middle else None
            if found is not None:
                found.deadline = deadline
                exact = found.run(Setting("dop853", rtol=1e-14), times)
                beside.append((found, replace(study.reference, shot=exact)))
    try:
        for target in TARGETS:
            _settle(study, target, beside, times, deadline)
    except Late:
        if perf_counter() > plain.deadline:
            raise


def _settle(
    study: Study, target: float, beside: Sequence[tuple[Probe, Reference]], times: Sequence[float],
    deadline: float,
) -> None:  # fmt: skip
    sizes = {(m, target): replace(law, scatter=1.0).size_for(target) for m, law in study.laws.items()}
    for _ in range(TRIES):
        setting = advise(study.points, study.laws, target, sizes).setting
        if setting is None or setting.method not in study.laws or perf_counter() > deadline:
            return
        made = [_error_with(setting, probe, times, reference) / target for probe, reference in beside]
        key = setting.method, target
        study.sizes[key], study.met[key] = setting.size, sum(error <= 1.0 for error in made[1:])
        study.tried = len(beside) - 1
        if max(made) <= 1.0:
            return
        # By the law error = factor size^power the worst error becomes CLEAR times the target; at most a
        # decade a correction.
        part = max(CLEAR / max(made), 0.1) ** (1.0 / study.laws[setting.method].power)
        sizes[key] = study.sizes[key] = setting.size * part


def _error_with(setting: Setting, probe: Probe, times: Sequence[float], reference: Reference) -> float:
    try:
        shot = probe.run(setting, times)
        return float(errors_of(shot.hi, shot.lo, reference).max(initial=0.0))
    except Failed:
        return float("inf")


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
