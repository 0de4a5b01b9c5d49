"""A trajectory: the states at the times that were asked for."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from lagc.render.numpy.support.base import FIRST_LOOK, INTERRUPTED, MAX_STEPS, OK, Options, Trajectory
from lagc.render.numpy.support.integrate import Integrator
from lagc.render.numpy.support.problem import Problem

# -- what follows is part of generated modules --


def integrate(
    problem: Problem,
    options: Options,
    t0: float,
    x0: Sequence[float],
    times: Sequence[float],
    progress: Callable[[float], None] | None = None,
) -> Trajectory:
    """From (t0, x0), consistent, to times[-1] exactly; states at `times` (in order) by dense output.

    `progress` is called with the time after every step; KeyboardInterrupt ends the run with what
    was computed (INTERRUPTED).  ValueError where an option, a time or a parameter makes no sense.
    """
    problem.culprit = -1
    fallbacks: int = getattr(problem, "fallbacks", 0)
    run = Integrator(problem, options, t0, x0)
    result = Trajectory([], [], t0, run.x)

    def told(status: int) -> Trajectory:
        result.status = status
        result.t, result.x, result.culprit = run.t, run.x, run.culprit if status != OK else -1
        result.steps, result.rejected, result.rhs = run.steps, run.rejected, run.rhs
        result.step = run.t - run.t_old
        result.fallbacks = getattr(problem, "fallbacks", 0) - fallbacks
        result.redundant_rows = tuple(sorted(getattr(problem, "redundant_rows", ())))
        result.position_drift, result.velocity_drift = run.position_drift, run.velocity_drift
        return result

    try:
        return told(_record(run, times, result, told, progress))
    except KeyboardInterrupt:
        return told(INTERRUPTED)


def _record(
    run: Integrator,
    times: Sequence[float],
    result: Trajectory,
    told: Callable[[int], Trajectory],
    progress: Callable[[float], None] | None,
) -> int:
    done, n, look, watch = 0, len(times), FIRST_LOOK, run.options.watch
    t1 = times[-1] if n else run.t
    direction = 1.0 if t1 >= run.t else -1.0
    status = run.demand(t1)
    for before, t in zip((run.t, *times), times):
        if not (t - before) * direction >= 0.0:
            raise ValueError(f"the time {t!r} is not in order")
    if status != OK:
        return status
    run.enter()
    while True:
        while done < n and (times[done] - run.t) * direction <= 0.0:
            status, x = run.at_(times[done])
            if status != OK:
                return status
            result.times.append(times[done])
            result.states.append(x)
            done += 1
        if done == n:
            return OK
        status = run.step_(times[-1])
        if status != OK:
            return status
        if progress is not None:
            progress(run.t)
        if watch is not None and run.steps == look:
            look *= 2
            if watch(told(INTERRUPTED)):
                return MAX_STEPS
