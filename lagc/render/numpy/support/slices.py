"""A trajectory in slices, between which it may be watched and interrupted."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter
from typing import Any

from lagc.render.numpy.support.base import FIRST_LOOK, INTERRUPTED, INVALID, MAX_STEPS, Options, Trajectory

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
) -> Trajectory:
    """What `told(status)` gives at the end of `record(steps, max_steps)`, which makes so many steps of a
    trajectory and knows its limit.  `state` has its t, steps, rejected, culprit.  KeyboardInterrupt ends it
    with what was recorded; ValueError where an option or the times make no sense."""
    budget, look, status = FIRST_BUDGET, FIRST_LOOK, INTERRUPTED
    try:
        while status == INTERRUPTED:
            limit = options.max_steps
            if limit > 0:
                limit -= state.steps + state.rejected
                if limit <= 0:
                    status = MAX_STEPS
                    break
            began = perf_counter()
            status = record(min(budget, look - state.steps), limit)
            if progress is not None:
                progress(state.t)
            if perf_counter() - began < 0.5 * SLICE:
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
