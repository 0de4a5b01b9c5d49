"""A trajectory in slices, between which it may be watched and interrupted."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from lagc.codegen.python.support.base import FIRST_LOOK, Options, Trajectory
from lagc.kernels.language.statuses import INTERRUPTED, INVALID, MAX_STEPS

# -- what follows is part of generated modules --

SLICE = 0.05  # s between two calls of `progress`
FIRST_BUDGET = 16  # steps of the first slice
OPTIONS = ("method", "max_steps", "rtol", "atol", "step", "first_step", "max_step")  # in the order of BAD_...


def refused(culprit: int) -> ValueError:
    """What INVALID says of options and times."""
    if 0 <= culprit < len(OPTIONS):
        return ValueError(f"the option {OPTIONS[culprit]} makes no sense here")
    return ValueError("the times are finite and in order, from that of the start on")


def recorded(
    state: Any,
    options: Options,
    record: Callable[[int, int], int],
    told: Callable[[int], Trajectory],
    progress: Callable[[float], None] | None,
    clock: Callable[[], float] | None = None,
) -> Trajectory:
    """What `told(status)` gives at the end of `record(steps, max_steps)`, which makes so many steps of a
    trajectory and knows its limit.  `state` has its t, steps, rejected, culprit.  KeyboardInterrupt ends it
    with what was recorded; ValueError where an option or the times make no sense.  With a `clock` of seconds
    slices become as long as SLICE lets them."""
    budget, look = FIRST_BUDGET, FIRST_LOOK
    status: int = INTERRUPTED
    try:
        while status == INTERRUPTED:
            limit = options.max_steps
            if limit > 0:
                limit -= state.steps + state.rejected
                if limit <= 0:
                    status = MAX_STEPS
                    break
            began = 0.0 if clock is None else clock()
            status = record(min(budget, look - state.steps), limit)
            if progress is not None:
                progress(state.t)
            if clock is not None and clock() - began < 0.5 * SLICE:
                budget *= 2
            if state.steps == look and status == INTERRUPTED:
                look *= 2
                if options.watch is not None and options.watch(told(INTERRUPTED)):
                    status = MAX_STEPS
    except KeyboardInterrupt:
        status = INTERRUPTED
    if status == INVALID:
        raise refused(state.culprit)
    return told(status)
