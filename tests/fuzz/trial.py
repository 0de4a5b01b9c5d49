"""One model text through the whole compiler, and a moment of its motion, within bounds."""

from __future__ import annotations

import resource
import signal
import types

import lagc
from lagc.diagnostics.faults import Refused
from lagc.diagnostics.report import as_json, report

SECONDS = 10
MEMORY = 4 << 30  # bytes of address space


class TooLong(BaseException):
    """Not an Exception, so that nothing on the way takes it for an error of its own."""


def bound_memory() -> None:
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, resource.getrlimit(resource.RLIMIT_AS)[1]))


def trial(text: str) -> str:
    """What became of the text: "refused", "failed" (a run that stops and says why) or "ran".

    Raises TooLong, and whatever is wrong in lagc itself.
    """

    def ring(number: int, frame: types.FrameType | None) -> None:
        raise TooLong

    before = signal.signal(signal.SIGALRM, ring)
    signal.alarm(SECONDS)
    try:
        return _trial(text)
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def _trial(text: str) -> str:
    file = lagc.loads(text, "mutated.lag")
    faults = file.check()
    if faults:
        assert report(faults) and all(item["code"] for item in as_json(faults))
        assert all(0 <= f.span.start <= f.span.end <= len(text) for f in faults if f.span)
    try:
        run = file.compile(backend="numpy").simulate(1e-3, method="dopri5", step=2e-4, points=3)
    except Refused as refused:
        assert refused.faults
        return "refused"
    return "failed" if run.status == "failed" else "ran"
