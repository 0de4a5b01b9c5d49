"""Trajectories of a generated module: state, steps, and integration to given times."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf
from typing import Any

from lagc.codegen.python.support.base import MOST_CORNERS, MOST_EVENTS, Options, Trajectory
from lagc.codegen.python.support.equations import Equations
from lagc.codegen.python.support.generated import (
    METHODS,
    NMODE,
    NOTED,
    NWHEN,
    NX,
    State,
    advance,
    begin,
    dense,
    record,
    step,
)  # fmt: skip
from lagc.codegen.python.support.plain import other_events, others_so_far, trajectory
from lagc.codegen.python.support.slices import invalid_call, record_in_slices
from lagc.kernels.language.statuses import INVALID, OK

# -- what follows is part of generated modules --


class KernelOptions:
    """Options, as the kernels read them."""

    max_steps: int
    report: bool

    def __init__(self, options: Options):
        for name, value in vars(options).items():
            setattr(self, name, value)
        self.method: int = METHODS[options.method]


class Integrator(State):
    """The state of a trajectory: `t` and `x`; `t_old`, `x_old` and `h_old` of the last step.

    Between calls of `step`, `advance` and `at` the caller may change `t`, `x` (also in place), the options,
    and inputs and parameters (`problem.p`; call `problem.bind()` after parameters).  The next step begins
    with these values, with the step size found before; it costs one more evaluation if t, x or p changed.
    One problem, `Equations`, may serve several trajectories in turn.  A call raises ValueError, and changes
    nothing, if an option, a time or a parameter is not valid.
    """

    def __init__(self, problem: Equations, options: Options, t: float, x: list[float]):
        options.check()
        if len(x) != NX:
            raise ValueError(f"x has {len(x)} entries, not {NX}")
        super().__init__()
        self.problem, self.options = problem, options
        begin(self, t, x)

    def step(self, t1: float) -> int:
        """Make one step towards `t1`, which it does not pass; return a status."""
        return self._checked(step(self.problem.p, self, t1, self._kernel_options(t1), self.problem.work))

    def advance(self, t1: float) -> int:
        """Integrate to `t1` exactly; return a status.  A step that is shortened to end there does not shorten
        the next one."""
        return self._checked(advance(self.problem.p, self, t1, self._kernel_options(t1), self.problem.work))

    def at(self, t: float) -> tuple[int, list[float]]:
        """Return a status and the state at `t`, a time of the last step, with the parameters of that step.
        Raises ValueError for any other time."""
        x = [0.0] * NX
        status = dense(self.problem.p, self, t, KernelOptions(self.options), x, self.problem.work)
        if status == INVALID:
            raise ValueError(f"the time {t!r} is not within the last step")
        return status, x

    def _kernel_options(self, t1: float) -> KernelOptions:
        """Return the options of a call to `t1`.  Raises ValueError if they are not valid."""
        self.options.check()
        self.problem.check()
        if not (abs(t1) < inf and abs(self.t) < inf):
            raise ValueError(f"a time is not finite: from {self.t!r} to {t1!r}")
        self.x = self.x[:]  # the caller may keep a reference to the old list
        return KernelOptions(self.options)

    def _checked(self, status: int) -> int:
        if status == INVALID:
            raise invalid_call(self.culprit)
        return status


class EventLog:
    """The events of a run, in order: with numbers, times of jumps, states on both sides, and others."""

    def __init__(self) -> None:
        self.events: list[tuple[float, int]] = []
        self.jumps: list[float] = []
        self.corners: list[Any] = []
        self.others: list[Any] = []

    def add(self, run: Integrator, is_other: bool) -> None:
        """Store the events that `run` has just been through."""
        self.events.extend((run.t, k) for k in NOTED if run.changed[k])
        if len(self.corners) < MOST_CORNERS:
            jumped = (NWHEN and run.jumps > len(self.jumps)) or is_other
            self.corners.append((run.t, run.x_before_event[:] if jumped else run.x[:], run.x[:]))
        if NWHEN:
            self.events.extend((run.t, NMODE + k) for k in run.acted[: run.acts])
            self.jumps.extend([run.t] * (run.jumps - len(self.jumps)))
        if is_other:
            self.others.extend(other_events(run))


def _integrate(
    problem: Equations,
    options: Options,
    t0: float,
    x0: list[float],
    times: Sequence[float],
    progress: Callable[[float], None] | None = None,
    clock: Callable[[], float] | None = None,
) -> Trajectory:
    """Integrate from the consistent state (t0, x0) to times[-1]; return a Trajectory with the states at
    `times`, which are in order.

    `progress` is called with the current time, with a `clock` in seconds about 20 times a second.
    KeyboardInterrupt ends the run with status INTERRUPTED.  Raises ValueError if an option, a time or a
    parameter is not valid.
    """
    # Records of the run beside the state: events with their times, jumps, and the corners of the motion.
    run = Integrator(problem, options, t0, x0)
    kernel_options, done = run._kernel_options(times[-1] if times else t0), [0]
    states = [[0.0] * NX for _ in times]
    work, fallbacks = problem.work, problem.work.fallbacks
    log = EventLog()

    # Each slice calls the kernel `record`, then stores the events that it ended at: a slice ends at the first
    # one with `report`.
    def record_steps(steps: int, max_steps: int) -> int:
        """Call the kernel `record`; an exception leaves everything as it was before."""
        names = ("t", "x", "t_old", "culprit", "steps", "rejected", "rhs", "position_drift", "velocity_drift")
        before, reached = [getattr(run, name) for name in names], done[0]
        run.x, kernel_options.max_steps = run.x[:], max_steps
        try:
            seen = run.changes if NMODE else 0
            before_others = others_so_far(run)
            status: int = record(problem.p, run, kernel_options, times, len(times), states, done, steps, work)
            if NMODE and kernel_options.report and run.changes > seen:
                log.add(run, others_so_far(run) > before_others)
                kernel_options.report = max(len(log.events), len(log.others)) < MOST_EVENTS
            return status
        except BaseException:
            for name, value in zip(names, before):
                setattr(run, name, value)
            done[0] = reached
            raise

    def result(status: int) -> Trajectory:
        return trajectory(
            run, log.others,
            times=list(times[: done[0]]), states=states[: done[0]], t=run.t, x=run.x[:], status=status,
            culprit=-1 if status == OK else run.culprit, steps=run.steps, rejected=run.rejected, rhs=run.rhs,
            stiff=run.stiff, step=run.t - run.t_old, fallbacks=work.fallbacks - fallbacks,
            redundant_rows=problem.redundant_rows, shared_contacts=problem.shared_contacts,
            position_drift=run.position_drift, velocity_drift=run.velocity_drift, sizes=run.sizes[:],
            lowest=run.lowest[:], highest=run.highest[:], events=log.events, jumps=log.jumps,
            corners=log.corners, changes=run.changes if NMODE else 0,
        )  # fmt: skip

    return record_in_slices(run, options, record_steps, result, progress, clock)
