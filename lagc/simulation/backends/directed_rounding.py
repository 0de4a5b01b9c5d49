"""Arithmetic with directed rounding, in a thread of its own."""

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

LOOK = 0.05  # s between checks of the other thread
T = TypeVar("T")
Progress = Callable[[float], None]
# FE_UPWARD and FE_DOWNWARD of <fenv.h>: x86, ARM, Microsoft's library, POWER and MIPS and s390, RISC-V
MODES = ((0x800, 0x400), (0x400000, 0x800000), (0x200, 0x100), (2, 3), (3, 2))


@contextmanager
def directed(direction: int) -> Iterator[Callable[[int], None]]:
    """A block with arithmetic of this thread rounded up (1), down (-1) or to nearest (0). Yields a function
    that changes the direction.  Without support by the machine it does nothing.  All code inside is affected:
    use it within `apart`."""
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
    """Yield rounding directions, up and down without a pattern; opposite ones for -1."""
    k = 0
    while True:
        yield -direction if k * k * 0x9E3779B1 & 0x100000 else direction
        k += 1


def by_turns(run: Callable[[Progress], T], direction: int, progress: Progress | None) -> T:
    """Return `run(tell)`, run in another thread with a new rounding direction of `turns` after each call of
    `tell`."""

    def work(tell: Progress) -> T:
        directions = turns(direction)
        with directed(next(directions)) as turn:

            def reported(t: float) -> None:
                turn(next(directions))
                tell(t)

            return run(reported)

    return followed(work, progress)


def apart(work: Callable[[], T]) -> T:
    """Return `work()`, run in a thread of its own (see `followed`)."""
    return followed(lambda tell: work())


def followed(work: Callable[[Progress], T], progress: Progress | None = None) -> T:
    """Return `work(tell)`, run in a thread of its own, where no signals are handled and no objects finalized.

    The rounding mode belongs to a thread.  If no thread can be started, the work runs in this one.  Calls of
    `tell` are passed on to `progress` from time to time.  An exception raised here meanwhile, also by a
    signal, is raised there at the next call of `tell`, or here in the end.  Raises MemoryError if the other
    thread cannot begin."""
    done: list[T] = []
    failed: list[BaseException] = []
    reported: list[float] = []
    raised: list[BaseException] = []
    ended = allocate_lock()
    ended.acquire()

    def tell(t: float) -> None:
        reported[:] = [t]
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
                if reported and progress is not None and not raised:
                    progress(reported[0])
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
    """Return fesetround of the C library and its modes for up and down, or None if it does not work."""
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
