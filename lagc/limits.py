"""How long something may take, and how much memory.

    with Limits(time=10.0, memory=2e9):
        ...

Where the time is up, a timer of the system interrupts whatever is done, as Ctrl-C would: a run ends with
what it computed, a compiler is ended, files stay whole.  Where there is no such timer (Windows, threads
that are not the first), the clock is looked at between stages and in the progress of runs.  Of memory the
system gives no more (`RLIMIT_AS`); where it knows no such limit there is none.
"""

from __future__ import annotations

from _thread import _local as Local
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from math import inf
from time import monotonic
from types import FrameType, TracebackType
from typing import Any

from lagc.diagnostics.faults import Fault, Refused

ALLOWED = 60.0  # s of a stage whatever the model
GRACE = 5.0  # s that something may take to come to an end where its results are kept
COMMON = 4e9  # bytes that every machine can address

Progress = Callable[[float], None]


class Exhausted(KeyboardInterrupt):
    """The time is up.  All that keeps results when it is interrupted keeps them now."""


class Limits:
    """What a block of work may take: `time` in s, in all; `memory` in bytes.  None: no limit.

    Where `careful`, stages (`stage`) have limits of their own as long as no time is given.  At its end
    Refused is raised (LAG0801, LAG0802) where a limit ended the work.  Blocks may be inside one another:
    the inner one counts as long as it lasts.
    """

    def __init__(self, time: float | None = None, memory: float | None = None, careful: bool = False):
        if any(limit is not None and not limit > 0.0 for limit in (time, memory)):
            raise ValueError("a limit is positive")
        self.time, self.memory, self.careful = time, memory, careful
        self.end = inf if time is None else monotonic() + time
        self.doing = "the work"
        self.told = ""  # what the limit is, where one was reached
        self.patient = False  # a ring is answered when it is asked for
        self.timer: Any = None
        self.outer: Limits | None = None
        self.room: tuple[int, int] | None = None  # RLIMIT_AS before

    def __enter__(self) -> Limits:
        self.outer, _inside.block = _inside.block, self
        if self.memory is not None and self.memory < inf:
            self._bound_memory(self.memory)
        if self.end < inf:
            self._set(self.end)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.rest()
        _inside.block = self.outer
        if self.room is not None:
            import resource

            resource.setrlimit(resource.RLIMIT_AS, self.room)
        if kind is Exhausted:
            message, remedy = (
                f"{self.doing} took longer than {self.told}",
                "give it more: `--max-time 1h`, or `none`",
            )
            raise Refused([Fault("LAG0801", message, remedy=remedy)]) from None
        if kind is MemoryError and self.memory is not None:
            message = f"{self.doing} needs more memory than {size_text(self.memory)}, the limit"
            raise Refused(
                [Fault("LAG0802", message, remedy="allow more: `--max-memory 8G`, or `none`")]
            ) from None

    def ask(self) -> None:
        """Raises Exhausted where the time is up."""
        if monotonic() >= self.end:
            self.told = self.told or f"the {time_text(self.time or 0.0)} that were given"
            raise Exhausted

    def rest(self) -> None:
        """What is done from here on is not interrupted."""
        self.patient, self.end = False, inf
        if self.timer is not None:
            self.timer[0].setitimer(self.timer[0].ITIMER_REAL, 0.0)
            self.timer[0].signal(self.timer[0].SIGALRM, self.timer[1])
            self.timer = None

    def _set(self, end: float) -> None:
        """Let the timer ring at `end`, where there is one."""
        import signal

        if not hasattr(signal, "setitimer"):
            return
        try:
            before = signal.signal(signal.SIGALRM, self._rang)
        except ValueError:  # not the first thread
            return
        self.timer = self.timer or (signal, before)
        signal.setitimer(signal.ITIMER_REAL, max(end - monotonic(), 1e-6))

    def _rang(self, number: int, frame: FrameType | None) -> None:
        if self.patient:
            self.patient = False
            self._set(monotonic() + GRACE)
        else:
            self.end = min(self.end, monotonic())
            self.ask()

    def _bound_memory(self, most: float) -> None:
        try:
            import resource
        except ImportError:
            return
        now, hard = resource.getrlimit(resource.RLIMIT_AS)
        lower = [a for a in (now, hard) if a != resource.RLIM_INFINITY]
        resource.setrlimit(resource.RLIMIT_AS, (int(min([most, *lower])), hard))
        self.room = now, hard

    @contextmanager
    def stage(self, doing: str, size: float) -> Iterator[None]:
        self.doing, self.patient = doing, False
        self.ask()
        if not self.careful or self.time is not None:
            yield
            return
        allowed = ALLOWED + size
        self.end = monotonic() + allowed
        self.told = f"{time_text(allowed)}, which is enough for most models of this size"
        self._set(self.end)
        try:
            yield
        finally:
            self.rest()
        self.told = ""


class _Inside(Local):
    """Of a thread: the innermost block it is in."""

    block: Limits | None = None


_inside = _Inside()


@contextmanager
def stage(doing: str, size: float = 0.0) -> Iterator[None]:
    """What is done inside is called `doing` where a limit ends it.  Without a given time it may take
    `ALLOWED` + `size` seconds where the limits are careful."""
    block = _inside.block
    if block is None:
        yield
    else:
        with block.stage(doing, size):
            yield


@contextmanager
def running(progress: Progress | None) -> Iterator[Progress | None]:
    """`progress` for a run, which ends in time with what it computed."""
    block = _inside.block
    if block is None or block.end == inf:
        yield progress
        return
    block.doing = "the run"

    def asked(t: float) -> None:
        block.ask()
        block.patient = t > 0.0
        if progress is not None:
            progress(t)

    try:
        yield asked
    finally:
        block.patient = False


def reached() -> str:
    """The limit that ended the run, in words; nothing where none did."""
    return _inside.block.told if _inside.block is not None else ""


def rest() -> None:
    """Results are there: what is done with them is not interrupted."""
    if _inside.block is not None:
        _inside.block.rest()


def time_text(s: float) -> str:
    """A time as a person would say it."""
    if s > 1e18:
        return "more than 1e10 years"
    for unit, name in ((31557600.0, "years"), (86400.0, "days"), (3600.0, "h"), (60.0, "min")):
        if s >= 2.0 * unit:
            return f"{s / unit:.3g} {name}"
    return f"{s:.3g} s"


def size_text(size: float) -> str:
    """A number of bytes as a person would say it."""
    for unit, name in ((1e9, "GB"), (1e6, "MB"), (1e3, "kB")):
        if size >= unit:
            return f"{size / unit:.3g} {name}"
    return f"{size:.0f} bytes"


def of_this_machine() -> float:
    """Bytes of memory that a command may have where nothing is said: three quarters of what there is."""
    import os

    try:
        there = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return inf
    return max(COMMON, 0.75 * there)
