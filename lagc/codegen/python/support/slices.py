"""Integration in slices; between slices a run may be watched and interrupted."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from lagc.codegen.python.support.base import FIRST_LOOK, Options, Trajectory
from lagc.kernels.language.statuses import INTERRUPTED, INVALID, MAX_STEPS

# -- what follows is part of generated modules --

SLICE = 0.05  # s between two calls of `progress`
FIRST_BUDGET = 16  # steps of the first slice
OPTIONS = ("method", "max_steps", "rtol", "atol", "step", "first_step", "max_step")  # in the order of BAD_...


def invalid_call(culprit: int) -> ValueError:
    """Return the exception for a status INVALID of options or times."""
    if 0 <= culprit < len(OPTIONS):
        return ValueError(f"the option {OPTIONS[culprit]} is not valid here")
    return ValueError("the times must be finite and in order, from the initial time on")


def record_in_slices(
    state: Any,
    options: Options,
    record: Callable[[int, int], int],
    result: Callable[[int], Trajectory],
    progress: Callable[[float], None] | None,
    clock: Callable[[], float] | None = None,
) -> Trajectory:
    """Call `record(steps, max_steps)` until the trajectory ends, and return `result(status)`.

    `record` makes at most so many steps and returns a status; `state` has t, steps, rejected and culprit.
    KeyboardInterrupt ends the run with status INTERRUPTED.  With a `clock` in seconds, slices grow up to
    SLICE.  Raises ValueError if an option or the times are not valid."""
    budget, look = FIRST_BUDGET, FIRST_LOOK
    status: int = INTERRUPTED
    try:
        while status == INTERRUPTED:
            # Steps that are left of the limit; rejected ones count too.
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
            # A slice grows until it takes half of SLICE, so that progress costs nothing.
            if clock is not None and clock() - began < 0.5 * SLICE:
                budget *= 2
            # `watch` is called after 1024, 2048, ... accepted steps: a slice never goes beyond.
            if state.steps == look and status == INTERRUPTED:
                look *= 2
                if options.watch is not None and options.watch(result(INTERRUPTED)):
                    status = MAX_STEPS
    except KeyboardInterrupt:
        status = INTERRUPTED
    if status == INVALID:
        raise invalid_call(state.culprit)
    return result(status)
