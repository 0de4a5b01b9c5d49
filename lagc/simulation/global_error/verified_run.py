"""A run with a given global error, by the kernel `verified`: its options, its limits, and notes on it.

The error of a trajectory is the largest |y_i - exact_i| / s_i over its times and all quantities: coordinates,
speeds, outputs and discrete variables.  The scale s_i is what the user gives; else the range of the quantity,
or for one that does not move the size of its terms.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

from lagc.base.records import dataclass, field
from lagc.kernels import DEFAULT_METHOD
from lagc.simulation.error_measure import quantity_names, quantity_units
from lagc.simulation.system import Checked, Options, System, Trajectory, arrived, more

# The longest step relative to the time: in general, and if the rates depend on time.
LONGEST, LONGEST_FLOWING = 0.5, 0.02
MEANINGLESS = 1e-2  # estimate above which the end of the motion is unknown
ULP = 2.0**-52
MOST_NAMED = 6

Progress = Callable[[float], None]


@dataclass
class Verified:
    """The trajectory to return and its error: `estimated` is infinite if the run does not reach its end.
    The accuracy is met until `horizon`. `errors` and `scales` are those of each quantity, `limit` the one
    with the largest rounding unit over its scale, and this ratio. `rhs` counts the evaluations of all
    `attempts`. `work_error` is that of the work integral, in J, `time_error` that of the times of jumps over
    the time of the run."""

    trajectory: Trajectory
    options: Options
    estimated: float
    horizon: float
    errors: list[float]
    scales: list[float]
    attempts: int
    rhs: int
    notes: list[str] = field(default_factory=list)
    limit: tuple[int, float] = (0, 0.0)
    work_error: float = 0.0
    time_error: float = 0.0


def verified_run(
    system: System,
    x0: Sequence[float],
    times: Sequence[float],
    accuracy: float,
    progress: Progress | None = None,
    max_step: float | None = None,
    scales: Mapping[str, float] = {},
    method: str = DEFAULT_METHOD,
    most: int = 0,
    long: float = 0.0,
) -> Verified:
    """Return the motion from (times[0], x0) with a global relative error of `accuracy`, if it can be reached.
    Steps are at most `max_step` (s), and at most `most` (0: any number); `scales` are those that the user
    gives, by name.  Raises StabilityLimited where `most` is negative and stability limits the steps of a long
    run, and LongRun where the run would be smooth and have `long` steps or more (0: never)."""
    longest = longest_step(system, times[-1] - times[0], max_step)
    watch = _Watch(system, times, longest, most, long)
    options = Options(method=method, max_step=longest, report=True, watch=watch)
    given = [scales.get(name, 0.0) for name in quantity_names(system.interface)]
    found = system.verify(options, x0, times, accuracy, given, progress)
    options.rtol, options.alone = found.rtol, found.alone
    notes = notes_on(system, found)
    floors = [ULP * size / scale if scale else 0.0 for size, scale in zip(found.sizes, found.scales)]
    limit = max(enumerate(floors), key=lambda each: each[1], default=(0, 0.0))
    return Verified(
        found.trajectory, options, found.estimated, found.until, found.errors, found.scales, found.attempts,
        found.rhs, notes, limit, found.work_error, found.time_error / ((times[-1] - times[0]) or 1.0),
    )  # fmt: skip


def longest_step(system: System, time: float, max_step: float | None) -> float:
    """The longest step of a run of the duration `time`, in s."""
    longest = (LONGEST_FLOWING if system.interface.flowing else LONGEST) * abs(time)
    return min(longest, max_step or longest)


class _Watch:
    """Ends runs that get on too slowly, or take too many steps."""

    def __init__(self, system: System, times: Sequence[float], longest: float, most: int, long: float):
        self.system, self.begin, self.end = system, times[0], times[-1]
        self.longest, self.most, self.long = longest, most, long
        self.checks: list[tuple[float, int, float]] = []

    def __call__(self, run: Trajectory) -> bool:
        # Only for long runs.
        from lagc.simulation.supervision import check_length, check_stability, is_stuck

        first = not self.checks
        if first or run.steps <= self.checks[-1][1]:  # an attempt begins
            self.checks = [(self.begin, 0, 0.0)]
        if self.long and first:
            check_length(run, self.begin, self.end, self.long)
        if self.most < 0:
            check_stability(run, self.begin, self.end)
        if 0 < self.most < run.steps + run.rejected:
            return True
        return is_stuck(self.system, run, self.end, self.longest, self.checks)


def notes_on(system: System, found: Checked) -> list[str]:
    """Notes on the quantities that do not move, and on those that round-off keeps from the accuracy."""
    if not arrived(found.trajectory):
        return []
    interface = system.interface
    names, units = quantity_names(interface), quantity_units(interface)
    continuous, states = range(len(names) - len(interface.discretes)), range(interface.nq + interface.nv)

    def named(places: Iterable[int], values: Sequence[float]) -> str:
        shown = [f"`{names[k]}` ({values[k]:.1g} {units[k]}".rstrip() + ")" for k in places if values[k]]
        return ", ".join(shown[:MOST_NAMED]) + more(shown, MOST_NAMED)

    run = found.trajectory
    largest = [max(abs(low), abs(high)) for low, high in zip(run.lowest, run.highest)]
    said = {
        "moved only by round-off, and not accurate": named(
            [k for k in states if not found.scales[k] and largest[k]], largest),
        "nothing but round-off (in brackets its difference in two runs)": named(
            [k for k in continuous if found.constant[k] == 3], found.errors),
        "constant, so that the accuracy is relative to the size of the terms": named(
            [k for k in continuous if found.constant[k] == 1], found.scales),
        "so small beside others of the unit that round-off exceeds the accuracy of the own range "
        "(in brackets the error)": named([k for k in states if found.constant[k] == 2], found.errors),
    }  # fmt: skip
    return [f"{what}: {which}" for what, which in said.items() if which]
