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

LOOK = 1.0  # s after which it is looked whether a thread has begun at all
T = TypeVar("T")
# FE_UPWARD and FE_DOWNWARD of <fenv.h>: x86, ARM, Microsoft's library, POWER and MIPS and s390, RISC-V
MODES = ((0x800, 0x400), (0x400000, 0x800000), (0x200, 0x100), (2, 3), (3, 2))


@contextmanager
def directed(way: int) -> Iterator[None]:
    """Arithmetic of this thread rounded up (1) or down (-1), as usual for 0 and where it cannot be.  All that
    runs meanwhile is rounded so: to be used `apart`."""
    found = control() if way else None
    if found is None:
        yield
        return
    turn, up, down = found
    turn(up if way > 0 else down)
    try:
        yield
    finally:
        turn(0)


def apart(work: Callable[[], T]) -> T:
    """What `work` returns, in a thread of its own, where neither signals are handled nor objects finalised;
    the rounding mode is a thread's own.  In this thread where the machine gives no other.  Raises
    MemoryError where the other has not enough to begin."""
    done: list[T] = []
    failed: list[BaseException] = []
    ended = allocate_lock()
    ended.acquire()

    def run() -> None:
        try:
            done.append(work())
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
        while not ended.acquire(timeout=LOOK):
            if begun() is None and not ended.acquire(blocking=False):
                raise MemoryError
    finally:
        if collecting:
            gc.enable()
    if failed:
        raise failed[0]
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
