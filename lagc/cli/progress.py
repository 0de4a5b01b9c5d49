"""A progress bar on a terminal, where a run takes more than a second."""

from __future__ import annotations

import sys
from time import perf_counter

from lagc.cli.output import draw
from lagc.cli.signals import SIGNALS

PATIENCE = 1.0  # s before the bar appears
REDRAW = 0.1  # s between two drawings
WIDTH = 30


class Bar:
    """Called with the time reached.  A run may begin again from 0: the bar follows.

    A signal waits for the next call, so that the run ends with all that it computed; the second one
    does not wait, nor one that comes where nothing was computed yet.
    """

    def __init__(self, stop: float, quiet: bool = False):
        self.stop = stop
        self.shown = False
        self.wanted = not quiet and sys.stderr is not None and sys.stderr.isatty()
        self.next = perf_counter() + PATIENCE

    def __enter__(self) -> Bar:
        return self

    def __exit__(self, *_: object) -> None:
        SIGNALS.patient = False
        if self.shown:
            draw("\r\033[K")

    def __call__(self, t: float) -> None:
        if SIGNALS.noted:
            raise KeyboardInterrupt
        SIGNALS.patient = t > 0.0
        if not self.wanted or perf_counter() < self.next:
            return
        self.next = perf_counter() + REDRAW
        self.shown = True
        part = min(max(t / self.stop, 0.0), 1.0) if self.stop > 0.0 else 1.0
        done = int(WIDTH * part)
        bar = "#" * done + "." * (WIDTH - done)
        draw(f"\r[{bar}] {100 * part:3.0f} %  t = {t:.4g} s of {self.stop:.4g} s\033[K")
