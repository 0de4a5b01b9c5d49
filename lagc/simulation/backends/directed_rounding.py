"""Arithmetic that is rounded up or down, where nothing else runs."""

from __future__ import annotations

import ctypes
import gc
import sys
from _thread import allocate_lock, start_new_thread
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import lru_cache
from typing import Any, TypeVar
from weakref import ref

LOOK = 0.05  # s after which it is looked whether a thread has begun at all, and where it is
T = TypeVar("T")
Progress = Callable[[float], None]
# FE_UPWARD and FE_DOWNWARD of <fenv.h>: x86, ARM, Microsoft's library, POWER and MIPS and s390, RISC-V
MODES = ((0x800, 0x400), (0x400000, 0x800000), (0x200, 0x100), (2, 3), (3, 2))


@contextmanager
def directed(direction: int) -> Iterator[Callable[[int], None]]:
    """Arithmetic of this thread rounded up (1) or down (-1), as usual for 0 and where it cannot be; what it
    gives turns it another direction.  All that runs meanwhile is rounded so: to be used `apart`."""
    found = control()

    def turned(direction: int) -> None:
        if found is not None:
            turn, up, down = found
            turn((0, up, down)[direction])

    turned(direction)
    try:
        yield turned
    finally:
        turned(0)


def turns(direction: int) -> Iterator[int]:
    """Ways of rounding, up and down without pattern; for -1 the opposite ones."""
    k = 0
    while True:
        yield -direction if k * k * 0x9E3779B1 & 0x100000 else direction
        k += 1


def by_turns(run: Callable[[Progress], T], direction: int, progress: Progress | None) -> T:
    """What `run(tell)` returns, apart, with arithmetic rounded another direction of `turns` after each time that it
    tells."""

    def work(tell: Progress) -> T:
        directions = turns(direction)
        with directed(next(directions)) as turn:

            def told(t: float) -> None:
                turn(next(directions))
                tell(t)

            return run(told)

    return followed(work, progress)


def apart(work: Callable[[], T]) -> T:
    """What `work` returns, in a thread of its own: see `followed`."""
    return followed(lambda tell: work())


def followed(work: Callable[[Progress], T], progress: Progress | None = None) -> T:
    """What `work(tell)` returns, in a thread of its own, where neither signals are handled nor objects
    finalised; the rounding mode is a thread's own.  In this thread where the machine gives no other.

    What it tells comes to `progress` here now and then.  What is raised here meanwhile, by a signal too, is
    raised there when it tells next, and here in the end where it does not.  Raises MemoryError where the
    other thread has not enough to begin.
    """
    done: list[T] = []
    failed: list[BaseException] = []
    told: list[float] = []
    raised: list[BaseException] = []
    ended = allocate_lock()
    ended.acquire()

    def tell(t: float) -> None:
        told[:] = [t]
        if raised:
            raise raised.pop(0)

    def run() -> None:
        try:
            done.append(work(tell))
        except BaseException as error:
            failed.append(error)
        finally:
            ended.release()

    collecting = gc.isenabled()
    gc.disable()
    try:
        try:
            start_new_thread(run, ())
        except RuntimeError:
            run()
        begun = ref(run)
        del run
        while not (done or failed):
            if begun() is None and not (done or failed):
                raise MemoryError
            try:
                ended.acquire(timeout=LOOK)
                if told and progress is not None and not raised:
                    progress(told[0])
            except BaseException as error:
                raised.append(error)
    finally:
        if collecting:
            gc.enable()
    if failed or raised:
        raise (failed or raised)[0]
    return done[0]


@lru_cache(maxsize=1)
def control() -> tuple[Callable[[int], Any], int, int] | None:
    """fesetround of the C library and its modes for up and down; None where there is none that works."""
    try:
        turn = ctypes.CDLL("ucrtbase" if sys.platform == "win32" else None).fesetround
    except (OSError, AttributeError):
        return None
    return apart(lambda: _working(turn))


def _working(turn: Callable[[int], Any]) -> tuple[Callable[[int], Any], int, int] | None:
    one, little = float("1"), float("1e-30")
    for up, down in MODES:
        turn(up)
        above = one + little
        turn(down)
        below = one - little
        turn(0)
        if above > one > below and one + little == one:
            return turn, up, down
    return None
