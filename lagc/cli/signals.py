"""Signals that end the program: Ctrl-C, SIGTERM and SIGHUP, with the same effect.

A signal raises KeyboardInterrupt.  While there are results to keep, the first signal is only noted; the
second does not wait.  A signal that was ignored when the program began, as under `nohup`, stays ignored.  A
signal that arrives while an exception would be lost, as in a finalizer, is sent again.
"""

from __future__ import annotations

import _signal as signal  # type: ignore[import-not-found]  # the module `signal` takes 2 % of a short run
import sys
from _thread import get_ident, interrupt_main, start_new_thread
from collections.abc import Iterator
from contextlib import contextmanager
from time import sleep
from types import FrameType, TracebackType

ENDING = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
RETRY = 0.01  # s until a lost signal is sent again


class Signals:
    """The state of signal handling.

    `number` is the first signal received, or 0; `noted` tells whether a signal waits.
    """

    def __init__(self) -> None:
        self.number = 0
        self.patient = self.noted = self.over = False

    @property
    def code(self) -> int:
        """The exit code by the convention of shells; 0 without a signal."""
        return 128 + self.number if self.number else 0

    def __enter__(self) -> Signals:
        self.over, sys.unraisablehook = False, self._lost
        for each in ENDING:
            if signal.getsignal(each) is not signal.SIG_IGN:
                signal.signal(each, self._came)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> bool:
        """End signal handling: later signals are ignored."""
        self.over = True
        for each in ENDING:
            signal.signal(each, signal.SIG_IGN)
        return kind is KeyboardInterrupt

    def _came(self, number: int, frame: FrameType | None) -> None:
        self.number = self.number or number
        if self.over:
            return
        if not self.patient or self.noted:
            raise KeyboardInterrupt
        self.noted = True

    def _lost(self, unraisable: sys.UnraisableHookArgs) -> None:
        if unraisable.exc_type is KeyboardInterrupt:
            start_new_thread(self._repeat, (get_ident(),))
        else:
            sys.__unraisablehook__(unraisable)

    def _repeat(self, thread: int) -> None:
        sleep(RETRY)
        if hasattr(signal, "pthread_kill"):  # it also interrupts a system call
            signal.pthread_kill(thread, self.number)
        else:
            interrupt_main(self.number)  # type: ignore[arg-type]

    @contextmanager
    def patience(self, wanted: bool = True) -> Iterator[None]:
        """Finish the block even if a signal arrives; if not `wanted`, the first signal ends it."""
        before = self.patient
        self.patient, self.noted = wanted, False
        try:
            yield
        finally:
            self.patient = before


SIGNALS = Signals()
