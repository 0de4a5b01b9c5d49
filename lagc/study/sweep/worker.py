"""The runs of one chunk of a sweep, in this process or in another one.

A model is a `Loaded` of `lagc.compiler.loaded`.
"""

from __future__ import annotations

import pickle
from _thread import _local as Local
from array import array
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from math import fsum, inf, nan, sqrt
from time import perf_counter
from typing import TYPE_CHECKING, Any

from lagc.base.records import dataclass, replace
from lagc.diagnostics.faults import Fault, Refused
from lagc.host.cache import tool_fingerprint
from lagc.kernels import DEFAULT_METHOD
from lagc.simulation.repeated import RunsByHand, repeated
from lagc.simulation.request import Request, given_values
from lagc.simulation.solution import columns_of
from lagc.simulation.supervision import MOST_TIME, Forecast
from lagc.version import __version__

if TYPE_CHECKING:
    from lagc.lowering.program import Field
    from lagc.simulation.solution import Solution

STATUSES = ("ok", "terminated", "failed", "refused")  # a row has the index of one, or NaN: not run
FIRST = ("status", "t", "estimated")  # numbers of a row before its columns
BLOCK = 256  # runs that are made at once
ALONE = 1.0  # s of runs before they are: the code for that is compiled first
MOST_WORDS = 300  # characters of a message

Progress = Callable[[float], None]
Point = tuple[float, ...]


@dataclass(frozen=True)
class Task:
    """Everything that the runs of a sweep share.  `model` is pickled, `key` names all of it; `fingerprint` is
    that of lagc; `values` is the array p, `names` are parameters and `start(...)` that vary."""

    model: bytes
    key: str
    fingerprint: str
    backend: str
    request: Request
    values: tuple[float, ...]
    names: tuple[str, ...]
    keep: tuple[str, ...]
    most_time: float = MOST_TIME  # s for one run


@dataclass(frozen=True)
class Record:
    """The runs of a chunk from the point `first` on: the rows of numbers as bytes of doubles, the codes and
    messages of some by their place in the chunk, and the time that they took in s.  `other` is the version of
    a worker that is refused."""

    first: int
    rows: bytes
    reasons: Mapping[int, tuple[str, str]]
    seconds: float = 0.0
    other: str = ""


def version() -> str:
    """This lagc: its version and the beginning of the hash of its sources."""
    return f"{__version__} ({tool_fingerprint()[:12]})"


class _Last(Local):
    """The runner of the last sweep of a thread."""

    key = ""
    runner: Runner


_last = _Last()


def run(task: Task, first: int, points: Sequence[Point], progress: Progress = lambda t: None) -> Record:
    """Run the points of a chunk from `first` on.  KeyboardInterrupt in `progress` ends it without a
    result."""
    if task.fingerprint != version():
        return Record(first, b"", {}, 0.0, version())
    began = perf_counter()
    if _last.key != task.key:
        _last.runner, _last.key = Runner(task, pickle.loads(task.model)), task.key
    runner = _last.runner
    rows, reasons = array("d"), dict[int, tuple[str, str]]()
    watched = Forecast(progress, task.request.stop or 0.0, task.most_time)
    for k, point in enumerate(points):
        if k % BLOCK == 0 and runner.spent > ALONE:
            runner.run_side_by_side(points[k : k + BLOCK])
        row, reason = runner.row(point, watched)
        rows.extend(row)
        if reason is not None:
            reasons[k] = reason
    seconds = perf_counter() - began
    runner.spent += seconds
    return Record(first, rows.tobytes(), reasons, seconds)


class Runner:
    """The runs of a task in this thread."""

    def __init__(self, task: Task, model: Any):
        self.task, self.model, self.spent = task, model, 0.0
        interface = model.artifact.interface
        self.columns, self.last = columns_of(interface), task.keep == ("final",)
        # Where the values of a point go: the places of parameters in p, and of initial values in x.
        fields = [*interface.parameters, *interface.inputs]
        own = {f.name: (i, f) for i, f in enumerate(fields)}
        self.varied = [(k, *own[name]) for k, name in enumerate(task.names) if name in own]
        first = interface.nx - len(interface.discretes)
        known = [*enumerate(interface.state_names), *enumerate([d.name for d in interface.discretes], first)]
        self.place = {name: i for i, name in known}
        self.starts = [(k, start) for k, name in enumerate(task.names) if (start := started(name))]
        self.repeated = None
        if task.backend == "c":
            taking = model.taking(task.request.method or DEFAULT_METHOD)
            self.repeated = repeated(taking.system("c"), task.request, self.columns, self.last)

    def _values_of(self, point: Point) -> tuple[list[float], dict[str, float]]:
        """Return the array p and the initial values of a point.  Raises Refused."""
        values, starts = list(self.task.values), {**self.task.request.starts}
        for k, i, field in self.varied:
            value = values[i] = point[k]
            if field.whole or not field.minimum <= value <= field.maximum:
                _keep_bounds(field, value)
        for k, name in self.starts:
            starts[name] = point[k]
        return values, starts

    def _places(self, starts: Mapping[str, float]) -> dict[int, float]:
        return {self.place[name]: value for name, value in starts.items()}

    def run_side_by_side(self, points: Sequence[Point]) -> None:
        """Make the next runs side by side, where that is possible."""
        if isinstance(self.repeated, RunsByHand):
            given = []
            for point in points:
                with suppress(Refused):
                    values, starts = self._values_of(point)
                    given.append((values, self._places(starts)))
            self.repeated.run_lanes(given)

    def row(self, point: Point, progress: Progress) -> tuple[list[float], tuple[str, str] | None]:
        """Return the numbers of a run, and the code and the message of one that did not go as asked."""
        try:
            values, starts = self._values_of(point)
            plain = self.repeated
            if plain is not None and plain.run(values, self._places(starts), progress):
                status = float(STATUSES.index("terminated" if plain.ended else "ok"))
                known, reason = (status, plain.times[-1], plain.estimated), ("", _short(plain.ended))
                if self.last:
                    numbers = [*known, *plain.row(len(plain.times) - 1)]
                else:
                    numbers = [*known, *statistics(self.task.keep, plain.times, plain.columns())]
                return numbers, reason if plain.ended else None
            request = replace(self.task.request, starts=starts)
            return self._of(self.model.simulate(request, values, progress))
        except Refused as refused:
            fault = refused.faults[0]
            return self._empty(), (fault.code, _short(str(fault.message)))
        except (ArithmeticError, ValueError, LookupError, TypeError) as error:  # of lagc: the sweep goes on
            return self._empty(), ("LAG0799", _short(f"internal error ({type(error).__name__}: {error})"))

    def _empty(self) -> list[float]:
        count = len(self.columns) * len(self.task.keep)
        return [float(STATUSES.index("refused")), nan, nan, *[nan] * count]

    def _of(self, found: Solution) -> tuple[list[float], tuple[str, str] | None]:
        if found.interrupted:
            raise KeyboardInterrupt
        estimated = nan if found.estimated is None else found.estimated
        numbers = [float(STATUSES.index(found.status)), found.times[-1] if found.times else nan, estimated]
        if not found.times:
            columns = [[nan] for _ in self.columns]
        elif self.last:
            columns = [[value] for value in map(found.final.__getitem__, self.columns)]
        else:
            columns = [found.column(name) for name in self.columns]
        numbers += statistics(self.task.keep, found.times or [nan], columns)
        if found.status == "ok":
            return numbers, None
        return numbers, ("LAG0620" if found.status == "failed" else "", _short(found.message))


def _keep_bounds(field: Field, value: float) -> None:
    """Raise Refused (LAG0602) if a value is out of the bounds of its parameter."""
    faults: list[Fault] = []
    given_values({field.name: value}, [field], faults)
    if faults:
        raise Refused(faults)


def started(name: str) -> str | None:
    """Return the quantity of `start(quantity)`; None for another name."""
    return name[6:-1].strip() if name.startswith("start(") and name.endswith(")") else None


def statistics(
    keep: Sequence[str], times: Sequence[float], columns: Sequence[Sequence[float]]
) -> list[float]:
    """Return the numbers that are kept of each column, all of one kind first."""
    return [KEPT[kind](times, column) for kind in keep for column in columns]


def root_mean_square(times: Sequence[float], values: Sequence[float]) -> float:
    """The root of the mean square over time, by the trapezoidal rule."""
    span = times[-1] - times[0]
    if not span > 0.0:
        return abs(values[-1])
    squares = [value * value for value in values]
    parts = [0.5 * (b - a) / span * (x + y) for a, b, x, y in zip(times, times[1:], squares, squares[1:])]
    return inf if inf in parts else sqrt(fsum(parts))


KEPT: dict[str, Callable[[Sequence[float], Sequence[float]], float]] = {
    "final": lambda times, values: values[-1],
    "max": lambda times, values: max(values),
    "min": lambda times, values: min(values),
    "rms": root_mean_square,
}


def _short(message: str) -> str:
    return message if len(message) <= MOST_WORDS else f"{message[: MOST_WORDS - 3]}..."
