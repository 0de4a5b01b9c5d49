"""Limits of a run: its memory, its time, the change from NumPy to C, and runs that do not get on."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from math import inf
from time import monotonic, perf_counter
from typing import TypeAlias

from lagc.diagnostics.faults import Fault, Refused
from lagc.host.budgets import size_text, time_text
from lagc.lowering.program import Interface
from lagc.simulation.error_measure import scaling_groups
from lagc.simulation.request import Request
from lagc.simulation.system import System, Trajectory, rates_at

# Stability
LONG_RUN = 100_000  # steps
TESTED = 1000  # steps for each test of stability, see `kernels/integrators/stiffness`
LIMITED = 0.5  # share of the steps that stability limits
# Memory and time of a whole run
MOST_MEMORY = 2e9  # bytes, unless the user allows more
MOST_TIME = 300.0  # s for one integration, unless the user allows more
FIRST_CHECK = 1.0  # s before the remaining time is estimated
NUMBER = 40.0  # bytes for a recorded number: the object and its references in lists
POINT = 100.0  # further bytes for a recorded state
RUNS = 3.0  # integrations that are kept for comparison

# Progress of one integration
CREEPING = 1e-4  # relative change of a state: in a smooth motion, no step is as short as this
NO_ENERGY = 1e-20  # of the kinetic energy
ALLOWED = 0.5  # of the longest step: the user asked for steps that short
LONG = 1e9  # operations, about one second: such a run ends if a reason is found
TOO_LONG = 1e11  # operations, minutes: such a run ends in any case
SHORTER = 0.8  # ratio of successive intervals of time, each with twice as many steps
CONVERGING = 3  # successive intervals with that ratio
CALL = 50.0  # operations for the call of a right-hand side

Progress: TypeAlias = Callable[[float], None]
Check: TypeAlias = tuple[float, int, float]  # time reached, steps, operations


def check_memory(request: Request, states: int, most: float = MOST_MEMORY, remedy: str = "") -> None:
    """Raise Refused (LAG0804) if the points that `request` (complete) records need more than `most` bytes."""
    points, columns = request.size(), states * (1 + len(request.sensitivity))
    needed = points * (POINT + NUMBER * columns) * (1.0 if request.by_hand else RUNS)
    if needed > most:
        message = f"{points} points of {columns} numbers need about {size_text(needed)} of memory"
        allowed = f"`--max-memory {max(1.25e-9 * needed, 1.0):.0f}G`"
        remedy = remedy or f"record fewer (`--points`, `--every`), or allow it: {allowed}"
        raise Refused([Fault("LAG0804", message, remedy=remedy)])


class Forecast:
    """Progress callback that raises Refused (LAG0803) if a run to `stop` would take more than `most` seconds.
    The remaining time is extrapolated after 1 s, 2 s, 4 s, ... from the progress since the last check.  Two
    successive checks must exceed the limit.  A run may start again from 0."""

    def __init__(self, inner: Progress, stop: float, most: float = MOST_TIME):
        self.inner, self.stop, self.most = inner, stop, most
        self.t = inf  # before the first call

    def __call__(self, t: float) -> None:
        self.inner(t)
        now = monotonic()
        if t < self.t:
            self.began = self.checked = now
            self.checked_t, self.slow = t, False
        elif now - self.checked >= max(FIRST_CHECK, 0.5 * (now - self.began)):
            advance, taken = t - self.checked_t, now - self.checked
            left = (self.stop - t) / advance * taken if advance > 0.0 else inf if t < self.stop else 0.0
            if left > self.most and self.slow:
                raise Refused([self._fault(t, left, now - self.began)])
            self.slow, self.checked, self.checked_t = left > self.most, now, t
        self.t = t

    def _fault(self, t: float, left: float, elapsed: float) -> Fault:
        message = (f"the run would take {time_text(left)} more: after {time_text(elapsed)} it has reached "
                   f"t = {t:.4g} s of {self.stop:.6g} s")  # fmt: skip
        remedy = ("`--max-time none` removes the limit; `--max-time 1h` sets another one and keeps the "
                  "results until then; or ask for a shorter motion")  # fmt: skip
        return Fault("LAG0803", message, remedy=remedy)


class SlowRun(Exception):
    """The run in NumPy has taken as long as compiling it to C would, and there is a compiler."""


class CompileTimer:
    """Progress callback that raises SlowRun after `limit` seconds, if a C compiler exists. With the compile
    time as the limit, a run costs at most twice the minimum."""

    def __init__(self, limit: float, inner: Progress | None):
        self.end = perf_counter() + limit
        self.inner = inner

    def __call__(self, t: float) -> None:
        if perf_counter() > self.end:
            if has_compiler():
                raise SlowRun
            self.end = inf
        if self.inner is not None:
            try:
                self.inner(t)
            except Refused:  # too long in NumPy, but perhaps not in C
                if has_compiler():
                    raise SlowRun from None
                raise


class StabilityLimited(Exception):
    """Stability limits the steps of an explicit method: to `step` s in a run of about `steps` steps."""

    def __init__(self, steps: float, step: float):
        super().__init__(steps, step)
        self.steps, self.step = steps, step


class LongRun(Exception):
    """A run is smooth and would have about `steps` steps."""

    def __init__(self, steps: float):
        super().__init__(steps)
        self.steps = steps


def check_length(run: Trajectory, begin: float, end: float, least: float) -> None:
    """Raise LongRun if the run has had no event, and would have `least` steps or more."""
    if run.steps >= TESTED and run.changes == 0 and run.t != begin:
        steps = run.steps * (end - begin) / (run.t - begin)
        if steps >= least and not is_limited(run):
            raise LongRun(steps)


def is_limited(run: Trajectory) -> bool:
    """Whether stability limits the steps of a run of 1000 steps or more."""
    return run.steps >= TESTED and run.stiff * TESTED >= LIMITED * run.steps


def check_stability(run: Trajectory, begin: float, end: float) -> None:
    """Raise StabilityLimited if stability limits the steps so far and the run would be a long one."""
    steps = run.steps * (end - begin) / (run.t - begin) if run.t != begin else 0.0
    if steps >= LONG_RUN and run.steps >= 2 * TESTED and is_limited(run):
        raise StabilityLimited(steps, abs(run.t - begin) / run.steps)


def compile_time(interface: Interface) -> float:
    """Estimate the time of a C compiler in s, within a factor of two on a machine of 2021."""
    projections = 1.2 if interface.nc else 0.0
    events = 0.4 if interface.relations else 0.0
    contacts = 0.8 if interface.contacts else 0.0
    return 0.5 + projections + events + contacts + 2e-4 * interface.written


def has_compiler() -> bool:
    """Return whether there is a C compiler."""
    from lagc.simulation.backends.compile import compiler

    return compiler() is not None


def is_stuck(system: System, run: Trajectory, end: float, longest: float, checks: list[Check]) -> bool:
    """Return True if `run` should end before the time `end`, because it would take long and makes no
    progress.

    Called each time the number of steps has doubled; appends the present progress to `checks`.  A run ends if
    the times it reaches converge, or if its steps (at most `longest`) are far shorter than any smooth motion
    needs.  A smooth motion may take as many steps as it needs."""
    checks.append((run.t, run.steps, _operations(system, run)))
    advance, steps, operations = (b - a for a, b in zip(checks[-2], checks[-1]))
    left = operations * (end - run.t) / advance if advance != 0.0 else operations
    if left < LONG:
        return False
    if _converges(checks, end):
        return True
    step = abs(advance) / steps
    if step > ALLOWED * longest or not _creeps(system, run, step):
        return False
    from lagc.simulation.diagnosis import obstacle

    return left > TOO_LONG or obstacle(system, run, run.t, run.x) != ""


def _converges(checks: Sequence[Check], end: float) -> bool:
    """Whether the times reached converge before `end`: the last intervals shrink although each has twice as
    many steps as the one before."""
    intervals = [abs(b[0] - a[0]) for a, b in pairwise(checks[-CONVERGING - 2 :])]
    if len(intervals) <= CONVERGING or any(b > SHORTER * a for a, b in pairwise(intervals)):
        return False
    return intervals[-1] * SHORTER / (1.0 - SHORTER) < abs(end - checks[-1][0])


def _operations(system: System, run: Trajectory) -> float:
    """Arithmetic operations of the run so far.  A dense solve counts its products; without a dense matrix it
    counts as eight right-hand sides."""
    nv, nc, own = system.nv, system.nc, system.interface.operations
    dense = 4.0 * nv * (nc * nc + nv * nv) if "system" in system.interface.functions else 8.0 * own
    return run.rhs * (own + CALL) + run.fallbacks * dense


def _creeps(system: System, run: Trajectory, step: float) -> bool:
    """Whether no state changes by CREEPING of the size of its scaling group in a step. Speeds of a group
    without kinetic energy are round-off, and are set to zero."""
    groups = scaling_groups(system.interface)
    x, moving = list(run.x), list(groups)
    kinetic = system.energies(run.t, x)[0]
    for group in groups:
        y = [0.0 if i in group else a for i, a in enumerate(x)]
        if min(group) >= system.nq and abs(system.energies(run.t, y)[0] - kinetic) <= NO_ENERGY * kinetic:
            moving.remove(group)
            x = y
    rates = rates_at(system, run.t, x)
    if rates is None:
        return True
    for group in moving:
        size = max((abs(y[i]) for y in [*run.states, run.x] for i in group), default=0.0)
        if any(abs(rates[i]) * step > CREEPING * size for i in group):
            return False
    return True
