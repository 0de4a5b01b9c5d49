"""What a run will take: its memory before it begins, its time while it goes on."""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from time import monotonic

from lagc.diagnostics.faults import Fault, Refused
from lagc.host.budgets import size_text, time_text
from lagc.simulation.request import Request

MOST_MEMORY = 2e9  # bytes that a run takes without being told to
MOST_TIME = 300.0  # s, likewise, of one integration
FIRST_LOOK = 1.0  # s after which it is known how a run goes
NUMBER = 40.0  # bytes of a recorded number: itself, and its places in lists
POINT = 100.0  # bytes of a recorded state besides
RUNS = 3.0  # integrations that are compared

Progress = Callable[[float], None]


def check_memory(request: Request, states: int, most: float = MOST_MEMORY, remedy: str = "") -> None:
    """Raises Refused (LAG0804) where what the complete `request` records needs more than `most` bytes."""
    points, columns = request.size(), states * (1 + len(request.sensitivity))
    needed = points * (POINT + NUMBER * columns) * (1.0 if request.by_hand else RUNS)
    if needed > most:
        message = f"{points} points of {columns} numbers need about {size_text(needed)} of memory"
        allowed = f"`--max-memory {max(1.25e-9 * needed, 1.0):.0f}G`"
        remedy = remedy or f"record fewer (`--points`, `--every`), or allow it: {allowed}"
        raise Refused([Fault("LAG0804", message, remedy=remedy)])


class Forecast:
    """Progress that raises Refused (LAG0803) where a run to `stop` would take longer than `most` seconds.

    How a run goes is looked at after 1 s, 2 s, 4 s, ..., each time since the last look; it is ended where
    two looks in succession say so.  A run may begin again from 0.
    """

    def __init__(self, inner: Progress, stop: float, most: float = MOST_TIME):
        self.inner, self.stop, self.most = inner, stop, most
        self.t = inf  # before the first

    def __call__(self, t: float) -> None:
        self.inner(t)
        now = monotonic()
        if t < self.t:
            self.began = self.seen = now
            self.seen_t, self.slow = t, False
        elif now - self.seen >= max(FIRST_LOOK, 0.5 * (now - self.began)):
            way, taken = t - self.seen_t, now - self.seen
            left = (self.stop - t) / way * taken if way > 0.0 else inf
            if left > self.most and self.slow:
                raise Refused([self._fault(t, left, now - self.began)])
            self.slow, self.seen, self.seen_t = left > self.most, now, t
        self.t = t

    def _fault(self, t: float, left: float, elapsed: float) -> Fault:
        message = (f"the run would take {time_text(left)} more: in {time_text(elapsed)} it has come to "
                   f"t = {t:.4g} s of {self.stop:.6g} s")  # fmt: skip
        return Fault("LAG0803", message, remedy="`--max-time none` lets it go on, `--max-time 1h` as long as "
                     "that, keeping what it has then; or ask for a shorter motion")  # fmt: skip
