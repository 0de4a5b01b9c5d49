"""Runs with a check in lock step (`kernels/verification`), in slices between which they may be watched."""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from time import perf_counter
from typing import Any

from lagc.codegen.python.support.base import FIRST_LOOK, Options, Trajectory
from lagc.codegen.python.support.slices import FIRST_BUDGET, SLICE, invalid_call
from lagc.kernels.language.statuses import INTERRUPTED, INVALID, MAX_STEPS
from lagc.simulation.backends.event_log import EventLog
from lagc.simulation.system import Checked

Progress = Callable[[float], None]


def run_in_slices(
    call: Callable[[int], int], log: EventLog, attempts: Callable[[], int],
    result: Callable[[int], Trajectory], options: Options, progress: Progress | None,
) -> int:  # fmt: skip
    """Call `call(steps)` until the run ends, and return its status. `attempts()` is the number of attempts:
    events of an earlier one are forgotten.  KeyboardInterrupt in `progress` ends the run as INTERRUPTED, and
    `options.watch`, called with `result(INTERRUPTED)` after 1024, 2048, ... steps of an attempt, as
    MAX_STEPS. Raises ValueError if an option or the times are not valid."""
    state, budget, look, attempt = log.state, FIRST_BUDGET, FIRST_LOOK, 0
    status: int = INTERRUPTED
    try:
        while status == INTERRUPTED:
            began, seen = perf_counter(), log.seen()
            status = call(budget)
            if attempts() != attempt:
                attempt, look, seen = attempts(), FIRST_LOOK, (0, 0)
                log.begin()
            log.add(seen)
            if progress is not None:
                progress(state.t)
            if perf_counter() - began < 0.5 * SLICE:
                budget *= 2
            if state.steps >= look and status == INTERRUPTED:
                look *= 2
                if options.watch is not None and options.watch(result(INTERRUPTED)):
                    status = MAX_STEPS
    except KeyboardInterrupt:
        status = INTERRUPTED
    if status == INVALID:
        raise invalid_call(state.culprit)
    return status


def checked(trajectory: Trajectory, v: Any, report: Any, options: Any) -> Checked:
    """Return the result of a run, from the records of the kernels in C or in Python."""
    ended = trajectory.status not in (INTERRUPTED, MAX_STEPS)
    return Checked(
        trajectory=trajectory, errors=v.error[:], scales=v.scale[:], sizes=v.size[:],
        constant=v.constant[:], estimated=report.estimated if ended else inf,
        until=report.until, rtol=options.rtol, alone=bool(v.alone), attempts=report.attempts,
        rhs=report.rhs if ended else report.rhs + 2 * trajectory.rhs,
        work_error=getattr(v, "work_error", 0.0), time_error=getattr(v, "time_error", 0.0),
    )  # fmt: skip
