"""What ends the program from outside: Ctrl-C, SIGTERM and SIGHUP, which all mean the same.

A signal raises KeyboardInterrupt, wherever the program is.  While there is something to be kept, the
first one is only noted, and the second one does not wait.  One that was ignored when the program began,
as `nohup` has it, stays ignored.  One that comes while the interpreter calls what may raise nothing, as for
objects that go, comes again.
"""

from __future__ import annotations

import _signal as signal  # type: ignore[import-not-found]  # `signal` makes enumerations: 2 % of a short run
import sys
from _thread import get_ident, interrupt_main, start_new_thread
from collections.abc import Iterator
from contextlib import contextmanager
from time import sleep
from types import FrameType, TracebackType

ENDING = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
SOON = 0.01  # s: what could raise nothing is over


class Signals:
    """`number` is that of the first signal that came, else 0; `noted` whether one waits for an answer."""

    def __init__(self) -> None:
        self.number = 0
        self.patient = self.noted = self.over = False

    @property
    def code(self) -> int:
        """The exit code, by the convention of shells; 0 where nothing came."""
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
        """From here on the process ends, and nothing disturbs it."""
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
            start_new_thread(self._again, (get_ident(),))
        else:
            sys.__unraisablehook__(unraisable)

    def _again(self, thread: int) -> None:
        sleep(SOON)
        if hasattr(signal, "pthread_kill"):  # it ends a call of the system too
            signal.pthread_kill(thread, self.number)
        else:
            interrupt_main(self.number)  # type: ignore[arg-type]

    @contextmanager
    def patience(self, wanted: bool = True) -> Iterator[None]:
        """What is done inside is finished, though a signal comes; where it is not `wanted`, also inside of
        such a block, the first one ends it."""
        before = self.patient
        self.patient, self.noted = wanted, False
        try:
            yield
        finally:
            self.patient = before


SIGNALS = Signals()
