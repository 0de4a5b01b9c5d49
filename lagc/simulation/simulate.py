"""simulate: from a system and a request to a solution."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from time import perf_counter
from typing import Any

from lagc.simulation.error_measure import Watched
from lagc.simulation.global_error.equilibrium_start import locked, resting, rests
from lagc.simulation.global_error.verified_run import verified_run
from lagc.simulation.initialization.initialize import begin, demand, strange_outputs
from lagc.simulation.initialization.result import Start
from lagc.simulation.request import Request
from lagc.simulation.solution import Cost, Energy, Event, Solution
from lagc.simulation.system import FAILED, INTERRUPTED, Counted, Options, System, Trajectory, event_names
from lagc.simulation.verdict import Verdict, judge, redundancy, verdict

Progress = Callable[[float], None]
RTOL = 1e-9  # by hand, where nothing is said
ROUNDING = 2.0**-49  # of a coordinate: to both sides, what several last places are
RESTS = ("it starts in an equilibrium, or so near one that last places of its numbers decide, and is left "
         "there; whether a small push would end that is not examined")  # fmt: skip
LOCKED = "the constraints leave no motion from there: it stays where it starts"


def simulate(
    system: System, request: Request, compile_s: float = 0.0, progress: Progress | None = None,
    start: Start | None = None, spent: float = 0.0,
) -> Solution:  # fmt: skip
    """The motion that `request` asks for, with the parameters that `system` holds.  `start`: where it was
    found before; `spent`: s of wall time that the run has taken by now.

    `progress` is called with the time reached, now and then; KeyboardInterrupt raised in it, or
    in a run, ends the run with what was computed.  Raises Refused where the request makes no sense
    (LAG0604), and NoStart where no start is consistent, or the motion is not determined there.
    """
    began = perf_counter() - spent
    counted: Any = Counted(system)
    request = request.completed(system.interface.simulate)
    start = start or begin(system, request)
    times = request.grid()
    notes = list(start.notes)
    if request.by_hand:
        options = by_hand(request)
        trajectory = system.integrate(options, 0.0, start.x, times, progress)
        tried = [trajectory]
        message = _overstepped(system, options, start.x, trajectory, times[-1])
        if not message:
            demand(system, trajectory)
        said = ("failed", message) if message else verdict(system, trajectory, times[-1])
        told = Verdict(*said, trajectory, None)
    elif not _awaits(system) and (rest := _rest(counted, start.x, times)) is not None:
        trajectory, options = resting(rest[0], times), Options()
        tried = [trajectory]
        told = Verdict(*verdict(system, trajectory, times[-1]), trajectory, ROUNDING)
        notes.append(rest[1])
    else:
        assert request.accuracy is not None
        watched = Watched(times)
        found = verified_run(counted, start.x, watched.times, request.accuracy, progress, request.max_step)
        options, tried = found.options, found.tried
        demand(system, tried[0])
        told = judge(counted, found, request.accuracy, times[-1])
        trajectory = watched.told(told.trajectory)
        if found.still:
            from lagc.simulation.global_error.noise_groups import told as still_told

            notes += still_told(system, trajectory, found.still)
    for k in strange_outputs(system, start.x):
        notes.append(f"output `{system.interface.outputs[k].name}` has no finite value at the start")
    if trajectory.redundant_rows and told.status == "ok":
        notes.append(redundancy(system, trajectory))
    return Solution(
        system=system,
        times=trajectory.times, states=trajectory.states, status=told.status, message=told.message,
        method=options.method, rtol=0.0 if options.step else options.rtol,
        atol=0.0 if options.step else options.atol, step=options.step,
        asked=request.accuracy, estimated=told.estimated,
        position_drift=trajectory.position_drift, velocity_drift=trajectory.velocity_drift,
        energy=energy(system, trajectory), notes=tuple(notes),
        events=tuple([Event(t, name) for t, k in trajectory.events for name in event_names(system, k)]),
        corners=tuple(trajectory.corners), interrupted=trajectory.status == INTERRUPTED, end=times[-1],
        cost=Cost(
            steps=sum(r.steps for r in tried), rejected=sum(r.rejected for r in tried),
            rhs=sum(r.rhs for r in tried) + counted.evaluations, operations=system.interface.operations,
            compile_s=compile_s, run_s=perf_counter() - began, start_s=start.seconds, integrations=len(tried),
        ),
    )  # fmt: skip


def _awaits(system: System) -> bool:
    """Whether something may be done at a time that is told."""
    return bool(system.interface.whens) and system.interface.timed


def _rest(system: System, x: list[float], times: Sequence[float]) -> tuple[list[float], str] | None:
    """The state in which it stays from the start x on, and why; None where it moves."""
    if locked(system, x, times[0]):
        return [*x[: system.nq], *[0.0] * (system.nx - system.nq)], LOCKED
    if len(times) > 1 and rests(system, x, times):
        return x, RESTS
    return None


def by_hand(request: Request) -> Options:
    method = request.method or "dop853"
    if request.step is not None:
        return Options(method=method, step=request.step, max_steps=0, report=True)
    rtol = RTOL if request.rtol is None else request.rtol
    atol = 0.0 if request.atol is None else request.atol
    longest = request.max_step or 0.0
    return Options(method=method, rtol=rtol, atol=atol, max_steps=0, max_step=longest, report=True)


def _overstepped(
    system: System, options: Options, start: Sequence[float], run: Trajectory, stop: float
) -> str:
    """Where a fixed step failed, what is to be said of it; else nothing."""
    if options.step == 0.0 or run.status not in FAILED:
        return ""
    from lagc.simulation.strides import overstepped  # where something failed

    return overstepped(system, options.step, start, run, stop)


def energy(system: System, trajectory: Trajectory) -> Energy:
    """The balance between the first and the last recorded state."""
    if not trajectory.states:
        return Energy(0.0, 0.0, 0.0)
    first, last = trajectory.states[0], trajectory.states[-1]
    start = system.energies(trajectory.times[0], first)[2]
    end = system.energies(trajectory.times[-1], last)[2]
    return Energy(start, end, last[-1] - first[-1] if system.nz else 0.0)
