"""A progress bar on a terminal, where a run takes more than a second, and the key that ends a run."""

from __future__ import annotations

import signal
import sys
from collections.abc import Callable
from time import perf_counter
from types import FrameType
from typing import Any, TypeAlias

Handler: TypeAlias = Callable[[int, FrameType | None], Any] | int | signal.Handlers | None

PATIENCE = 1.0  # s before the bar appears
REDRAW = 0.1  # s between two drawings
WIDTH = 30


class Bar:
    """Called with the time reached.  A run may begin again from 0: the bar follows.

    Ctrl-C waits for the next call, so that the run ends with all that it computed; the second one
    does not wait.
    """

    def __init__(self, stop: float, quiet: bool = False):
        self.stop = stop
        self.shown = False
        self.wanted = not quiet and sys.stderr.isatty()
        self.next = perf_counter() + PATIENCE
        self.interrupted = False
        self.before: Handler = signal.SIG_DFL

    def __enter__(self) -> Bar:
        self.before = signal.signal(signal.SIGINT, self._interrupt)
        return self

    def __exit__(self, *_: object) -> None:
        signal.signal(signal.SIGINT, self.before)
        if self.shown:
            print("\r\033[K", end="", file=sys.stderr, flush=True)

    def _interrupt(self, number: int, frame: FrameType | None) -> None:
        if self.interrupted:
            raise KeyboardInterrupt
        self.interrupted = True

    def __call__(self, t: float) -> None:
        if self.interrupted:
            raise KeyboardInterrupt
        if not self.wanted or perf_counter() < self.next:
            return
        self.next = perf_counter() + REDRAW
        self.shown = True
        part = min(max(t / self.stop, 0.0), 1.0) if self.stop > 0.0 else 1.0
        done = int(WIDTH * part)
        bar = "#" * done + "." * (WIDTH - done)
        print(f"\r[{bar}] {100 * part:3.0f} %  t = {t:.4g} s of {self.stop:.4g} s\033[K", end="",
              file=sys.stderr, flush=True)  # fmt: skip
