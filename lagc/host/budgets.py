"""How long something may take, and how much memory.

    with Limits(time=10.0, memory=2e9):
        ...

Where the time is up, a timer of the system interrupts whatever is done, as Ctrl-C would: a run ends with
what it computed, a compiler is ended, files stay whole.  Where there is no such timer (Windows, threads
that are not the first), the clock is looked at between stages and in the progress of runs.  Of memory the
system gives no more (`RLIMIT_AS`); where it knows no such limit there is none.
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

ALLOWED = 60.0  # s of a stage whatever the model
GRACE = 5.0  # s that something may take to come to an end where its results are kept
SOON = 1e-3  # s to the next ring where one comes at a bad moment
LONGEST = 86400.0  # s to the next ring: any timer can count that
LARGEST = 1e300  # of a limit: more is none
COMMON = 4e9  # bytes that every machine can address

Progress = Callable[[float], None]


class Exhausted(KeyboardInterrupt):
    """The time is up.  All that keeps results when it is interrupted keeps them now."""


def _within(limit: float | None) -> float | None:
    """As a float; an integer may be larger."""
    return inf if limit is not None and limit > LARGEST else limit


class Limits:
    """What a block of work may take: `time` in s, in all; `memory` in bytes.  None: no limit.

    Where `careful`, stages (`stage`) have limits of their own as long as no time is given.  At its end
    Refused is raised (LAG0801, LAG0802) where a limit ended the work.  Blocks may be inside one another:
    the limits of the outer ones hold in the inner ones too.
    """

    def __init__(self, time: float | None = None, memory: float | None = None, careful: bool = False):
        if any(limit is not None and not limit > 0.0 for limit in (time, memory)):
            raise ValueError("a limit is positive")
        self.time, self.memory, self.careful = _within(time), _within(memory), careful
        self.end = inf
        self.limit = ""  # what ends then, in words
        self.doing = "the work"
        self.told = ""  # the limit that was reached
        self.before = inf, ""  # end and limit outside the stage
        self.own = ""  # the limit of the stage, in words
        self.patient = False  # a ring is answered when it is asked for
        self.timer: Any = None
        self.outer: Limits | None = None
        self.most = inf  # bytes, with what the system itself allows
        self.room: tuple[int, int] | None = None  # RLIMIT_AS before

    def __enter__(self) -> Limits:
        if self.memory is not None and self.memory < reserved():
            self.most = self.memory
            raise self._too_small()  # where nothing more is given, nothing can be done, not even told
        self.outer, _inside.block = _inside.block, self
        self.told = ""
        if self.outer is not None:
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
        self.rest()
        _inside.block = self.outer
        if self.room is not None:
            import resource

            resource.setrlimit(resource.RLIMIT_AS, self.room)
        if self.outer is not None:
            self.outer._set()
        if isinstance(error, Exhausted):
            message, remedy = (
                f"{self.doing} took longer than {self.told}",
                "allow more time: `--max-time 1h`, or `none`",
            )
            raise Refused([Fault("LAG0801", message, remedy=remedy)]) from None
        if error is not None and self.memory is not None and _of_memory(error):
            raise self._too_small() from None

    def _too_small(self) -> Refused:
        most, more = "there is", None
        if self.most < inf:
            most = f"{size_text(self.most)}, the limit"
            more = "allow more memory: `--max-memory 8G`, or `none`"
        return Refused([Fault("LAG0802", f"{self.doing} needs more memory than {most}", remedy=more)])

    def ask(self) -> None:
        """Raises Exhausted where the time is up."""
        if monotonic() >= self.end:
            self.told = self.limit
            raise Exhausted

    def rest(self) -> None:
        """What is done from here on is not interrupted."""
        self.patient, self.end = False, inf
        if self.timer is not None:
            self.timer[0].setitimer(self.timer[0].ITIMER_REAL, 0.0)
            self.timer[0].signal(self.timer[0].SIGALRM, self.timer[1])
            self.timer = None

    def _bound_time(self, allowed: float, limit: str) -> None:
        """Nothing takes longer than `allowed` s from now on, where it may so far."""
        end = monotonic() + allowed
        if end < self.end:
            self.end, self.limit = end, limit

    def _set(self, soonest: float = SOON) -> None:
        """Let the timer ring at the end, or now and then before it, where there are an end and a timer."""
        if self.end == inf:
            return
        import signal

        if not hasattr(signal, "setitimer"):
            return
        try:
            before = signal.signal(signal.SIGALRM, self._rang)
        except ValueError:  # not the first thread
            return
        self.timer = self.timer or (signal, before)
        signal.setitimer(signal.ITIMER_REAL, min(max(self.end - monotonic(), soonest), LONGEST))

    def _rang(self, number: int, frame: FrameType | None) -> None:
        if self.end == inf:
            return
        if _at_an_edge(frame) or monotonic() < self.end:
            self._set()
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
        self.most = min([most, *(a for a in (now, hard) if a != resource.RLIM_INFINITY)])
        if self.most < sys.maxsize:  # else there are no addresses for more
            resource.setrlimit(resource.RLIMIT_AS, (int(self.most), hard))
            self.room = now, hard

    @contextmanager
    def stage(self, doing: str, size: float) -> Iterator[None]:
        self.doing, self.patient = doing, False
        self.ask()
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
            self.rest()
            if not self.told:
                self._leave()

    def _leave(self) -> None:
        """The stage is over: what holds is what held before it."""
        self.end, self.limit = self.before
        self._set()

    def go_on(self) -> bool:
        """After Exhausted: whether it was the stage alone that had no more time, and the work goes on without
        what it was to find."""
        if self.told != self.own:
            return False
        self.told = ""
        self._leave()
        return True


def _of_memory(error: BaseException) -> bool:
    """Whether there was no memory left: for an object, a process, or a library, in the words of loaders."""
    if isinstance(error, ImportError):  # hashlib keeps the reason to itself, and then lacks a name
        return any(words in str(error) for words in ("failed to map", "allocate memory", "from 'hashlib'"))
    return isinstance(error, MemoryError) or (isinstance(error, OSError) and error.errno == ENOMEM)


def _at_an_edge(frame: FrameType | None) -> bool:
    """Whether a block begins or ends: nobody would answer there."""
    while frame is not None:
        if frame.f_code in _EDGES:
            return True
        frame = frame.f_back
    return False


_EDGES = (Limits.__enter__.__code__, Limits.__exit__.__code__)


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


def doing(what: str) -> None:
    """What is done from here on is called so where a limit ends it."""
    if _inside.block is not None:
        _inside.block.doing = what


def go_on() -> bool:
    """After Exhausted in a stage: see `Limits.go_on`."""
    return _inside.block is not None and _inside.block.go_on()


def running(progress: Progress | None) -> Progress | None:
    """`progress` for a run, which ends in time with what it computed."""
    block = _inside.block
    if block is None or block.end == inf:
        return progress
    block.doing = "the run"

    def asked(t: float) -> None:
        block.doing = "the run"
        block.ask()
        block.patient = t > 0.0
        if progress is not None:
            progress(t)

    return asked


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


def reserved() -> float:
    """Bytes of memory that this process has reserved by now; 0 where the system does not tell."""
    import os

    try:
        with open("/proc/self/statm", "rb", buffering=0) as file:
            return float(int(file.read().split()[0]) * os.sysconf("SC_PAGE_SIZE"))
    except (OSError, AttributeError, ValueError, IndexError):
        return 0.0


def of_this_machine() -> float:
    """Bytes of memory that a command may have where nothing is said: three quarters of what there is."""
    import os

    try:
        there = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return inf
    return max(COMMON, 0.75 * there)
