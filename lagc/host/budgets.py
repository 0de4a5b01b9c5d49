"""Limits on time and memory.

    with Limits(time=10.0, memory=2e9):
        ...

After the time, a system timer interrupts the work like Ctrl-C: a run keeps its results, a C compiler is
stopped, and files stay complete.  Without a timer (Windows, threads other than the first) the clock is
checked between stages and during runs.  Memory is limited by the system (`RLIMIT_AS`), where it supports
that.
"""

from __future__ import annotations

import sys
from _thread import _local as Local
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from errno import ENOMEM
from math import inf
from time import monotonic
from types import FrameType, TracebackType
from typing import Any

from lagc.diagnostics.faults import Fault, Refused

ALLOWED = 60.0  # s for a stage of any model
GRACE = 5.0  # s for work to end with its results
RETRY = 1e-3  # s to the next signal after one at a bad moment
LONGEST = 86400.0  # s to the next signal, within the range of any timer
LARGEST = 1e300  # a larger limit is no limit
COMMON = 4e9  # bytes, the least default limit

Progress = Callable[[float], None]


class Exhausted(KeyboardInterrupt):
    """The time is up.  Code that keeps results after an interrupt keeps them now."""


def _within(limit: float | None) -> float | None:
    """Return the limit as a float; an integer may be too large for that."""
    return inf if limit is not None and limit > LARGEST else limit


class Limits:
    """Limits of a block of work: `time` in s, `memory` in bytes; None: no limit. With `careful`, each `stage`
    has its own limit unless a time is given.  At the end of the block Refused is raised (LAG0801, LAG0802) if
    a limit stopped the work.  Blocks can be nested; the limits of outer blocks hold in inner ones."""

    def __init__(self, time: float | None = None, memory: float | None = None, careful: bool = False):
        # `not limit > 0` also refuses nan.
        if any(limit is not None and not limit > 0.0 for limit in (time, memory)):
            raise ValueError("a limit is positive")
        self.time, self.memory, self.careful = _within(time), _within(memory), careful
        self.end = inf
        self.limit = ""  # the limit that is reached then, in words
        self.doing = "the work"
        self.reached = ""  # the limit that was reached
        self.before = inf, ""  # end and limit outside the stage
        self.own = ""  # the limit of the stage, in words
        self.patient = False  # the run itself asks for the time
        self.timer: Any = None
        self.outer: Limits | None = None
        self.most = inf  # bytes, with what the system itself allows
        self.room: tuple[int, int] | None = None  # RLIMIT_AS before

    def __enter__(self) -> Limits:
        if self.memory is not None and self.memory < reserved():
            # The process holds more than that already; RLIMIT_AS below it would fail each allocation, that of
            # the message too.
            self.most = self.memory
            raise self._too_small()  # below this nothing works, not even a message
        self.outer, _inside.block = _inside.block, self
        self.reached = ""
        if self.outer is not None:
            # Inner blocks begin with the limits of the outer one and can only tighten them.
            self.end, self.limit, self.doing = self.outer.end, self.outer.limit, self.outer.doing
        if self.time is not None:
            self._bound_time(self.time, f"the limit of {time_text(self.time)}")
        if self.memory is not None:
            self._bound_memory(self.memory)
        self._set()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.disarm()
        _inside.block = self.outer
        # Before anything else is allocated, in case the block ended for lack of memory.
        if self.room is not None:
            import resource

            resource.setrlimit(resource.RLIMIT_AS, self.room)
        # The timer of the process is one for all blocks: the outer block takes it back.
        if self.outer is not None:
            self.outer._set()
        if isinstance(error, Exhausted):
            message, remedy = (
                f"{self.doing} took longer than {self.reached}",
                "allow more time: `--max-time 1h`, or `none`",
            )
            raise Refused([Fault("LAG0801", message, remedy=remedy)]) from None
        # Only the block that set the limit of memory turns the error into a message.
        if error is not None and self.memory is not None and _of_memory(error):
            raise self._too_small() from None

    def _too_small(self) -> Refused:
        most, more = "there is", None
        if self.most < inf:
            most = f"{size_text(self.most)}, the limit"
            more = "allow more memory: `--max-memory 8G`, or `none`"
        return Refused([Fault("LAG0802", f"{self.doing} needs more memory than {most}", remedy=more)])

    def ask(self) -> None:
        """Raise Exhausted if the time is up."""
        # Without a timer (Windows, other threads) the work asks here; with one this is where the signal ends
        # up.
        if monotonic() >= self.end:
            self.reached = self.limit
            raise Exhausted

    def disarm(self) -> None:
        """Do not interrupt from now on."""
        self.patient, self.end = False, inf
        if self.timer is not None:
            # No signal between removing the handler and forgetting it: the timer is stopped first.
            self.timer[0].setitimer(self.timer[0].ITIMER_REAL, 0.0)
            self.timer[0].signal(self.timer[0].SIGALRM, self.timer[1])
            self.timer = None

    def _bound_time(self, allowed: float, limit: str) -> None:
        """Limit the time to `allowed` s from now on."""
        end = monotonic() + allowed
        if end < self.end:
            self.end, self.limit = end, limit

    def _set(self, soonest: float = RETRY) -> None:
        """Set the timer to the end of the time, or to a time before it, if there is a timer."""
        if self.end == inf:
            return
        import signal

        # Windows has no timers of this kind: there the limit is noticed at the next `ask`.
        if not hasattr(signal, "setitimer"):
            return
        try:
            before = signal.signal(signal.SIGALRM, self._rang)
        except ValueError:  # not the first thread
            return
        self.timer = self.timer or (signal, before)
        # A time in the past, or zero, would stop the timer in place of ringing at once.
        signal.setitimer(signal.ITIMER_REAL, min(max(self.end - monotonic(), soonest), LONGEST))

    def _rang(self, number: int, frame: FrameType | None) -> None:
        if self.end == inf:
            return
        # At a bad moment, or too early because LONGEST cut the time: ring again later.
        if _at_an_edge(frame) or monotonic() < self.end:
            self._set()
        # The run asks for the time itself at its next step. If it does not within GRACE, it is interrupted.
        elif self.patient:
            self.patient = False
            self._set(GRACE)
        else:
            self.ask()

    def _bound_memory(self, most: float) -> None:
        try:
            import resource
        except ImportError:
            return
        now, hard = resource.getrlimit(resource.RLIMIT_AS)
        # An inherited limit of the shell or of a batch system stays in force if it is smaller.
        self.most = min([most, *(a for a in (now, hard) if a != resource.RLIM_INFINITY)])
        if self.most < sys.maxsize:  # larger limits cannot be set
            resource.setrlimit(resource.RLIMIT_AS, (int(self.most), hard))
            self.room = now, hard

    @contextmanager
    def stage(self, doing: str, size: float) -> Iterator[None]:
        self.doing, self.patient = doing, False
        self.ask()
        # A time that was given is for all stages together; each stage has one of its own only by default.
        if not self.careful or self.time is not None:
            yield
            return
        self.before = self.end, self.limit
        allowed = ALLOWED + size
        self.own = f"{time_text(allowed)}, which is enough for most models of this size"
        self._bound_time(allowed, self.own)
        self._set()
        try:
            yield
        finally:
            self.disarm()
            # After Exhausted the limits stay as they are until `go_on` decides whether to continue.
            if not self.reached:
                self._leave()

    def _leave(self) -> None:
        """Restore the limits from before the stage."""
        self.end, self.limit = self.before
        self._set()

    def go_on(self) -> bool:
        """Return whether Exhausted came from the limit of the stage alone, so that work continues without its
        result."""
        # The same text only if the limit of the stage itself was the earlier one.
        if self.reached != self.own:
            return False
        self.reached = ""
        self._leave()
        return True


def _of_memory(error: BaseException) -> bool:
    """Return whether an error means that memory ran out: for an object, a process or a library."""
    if isinstance(error, ImportError):  # hashlib hides the reason and lacks a name
        return any(words in str(error) for words in ("failed to map", "allocate memory", "from 'hashlib'"))
    if isinstance(error, ValueError):  # the parser of Python leaves a field of a node empty
        return " is required for " in str(error)
    return isinstance(error, MemoryError) or (isinstance(error, OSError) and error.errno == ENOMEM)


def _at_an_edge(frame: FrameType | None) -> bool:
    """Return whether a block is being entered or left, where an exception would not be handled."""
    while frame is not None:
        if frame.f_code in _EDGES:
            return True
        frame = frame.f_back
    return False


_EDGES = (Limits.__enter__.__code__, Limits.__exit__.__code__)


class _Inside(Local):
    """The innermost block of a thread."""

    block: Limits | None = None


_inside = _Inside()


@contextmanager
def stage(doing: str, size: float = 0.0) -> Iterator[None]:
    """Name the work inside for messages. Without a given time it may take `ALLOWED` + `size` seconds, if the
    limits are careful."""
    block = _inside.block
    if block is None:
        yield
    else:
        with block.stage(doing, size):
            yield


def doing(what: str) -> None:
    """Name the work from now on for messages."""
    if _inside.block is not None:
        _inside.block.doing = what


def go_on() -> bool:
    """See `Limits.go_on`."""
    return _inside.block is not None and _inside.block.go_on()


def running(progress: Progress | None) -> Progress | None:
    """Return a `progress` callback that stops a run in time, so that its results are kept."""
    block = _inside.block
    if block is None or block.end == inf:
        return progress
    block.doing = "the run"

    def ask_at(t: float) -> None:
        block.doing = "the run"
        block.ask()
        # A run that has results keeps them when it asks; before its first step there is nothing to keep.
        block.patient = t > 0.0
        if progress is not None:
            progress(t)

    return ask_at


def reached() -> str:
    """Return the limit that stopped the run, in words, or ""."""
    return _inside.block.reached if _inside.block is not None else ""


def finish_uninterrupted() -> None:
    """Do not interrupt from now on, since the results exist."""
    if _inside.block is not None:
        _inside.block.disarm()


def time_text(s: float) -> str:
    if s > 1e18:
        return "more than 1e10 years"
    # From two of a unit on: 90 s are 90 s, 150 s are 2.5 min.
    for unit, name in ((31557600.0, "years"), (86400.0, "days"), (3600.0, "h"), (60.0, "min")):
        if s >= 2.0 * unit:
            return f"{s / unit:.3g} {name}"
    return f"{s:.3g} s"


def size_text(size: float) -> str:
    """Return a number of bytes in words."""
    for unit, name in ((1e9, "GB"), (1e6, "MB"), (1e3, "kB")):
        if size >= unit:
            return f"{size / unit:.3g} {name}"
    return f"{size:.0f} bytes"


def reserved() -> float:
    """Return the bytes of memory that this process has reserved; 0 if unknown."""
    import os

    try:
        # statm counts pages; its first number is the size of the address space, which RLIMIT_AS bounds.
        with open("/proc/self/statm", "rb", buffering=0) as file:
            return float(int(file.read().split()[0]) * os.sysconf("SC_PAGE_SIZE"))
    except (OSError, AttributeError, ValueError, IndexError):
        return 0.0


def of_this_machine() -> float:
    """Return the default memory limit of a command in bytes: three quarters of the memory."""
    import os

    try:
        there = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return inf
    return max(COMMON, 0.75 * there)
