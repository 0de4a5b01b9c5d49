"""simulate: from a system and a request to a solution."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter
from typing import Any

from lagc.diagnostics.faults import Fault, Refused
from lagc.run.accuracy import verified_run
from lagc.run.counted import Counted
from lagc.run.names import state_name
from lagc.run.problem import INTERRUPTED, Options, System, Trajectory
from lagc.run.request import Request
from lagc.run.rest import locked, resting, rests
from lagc.run.solution import Cost, Energy, Solution
from lagc.run.start import Start, consistent_start
from lagc.run.verdict import Verdict, judge, redundancy, verdict

Progress = Callable[[float], None]
MOST_NAMED = 12  # conditions of a conflict
RTOL = 1e-9  # by hand, where nothing is said
ROUNDING = 2.0**-49  # of a coordinate: to both sides, what several last places are
RESTS = ("it starts in an equilibrium, or so near one that last places of its numbers decide, and is left "
         "there; whether a small push would end that is not examined")  # fmt: skip
LOCKED = "the constraints leave no motion from there: it stays where it starts"


def simulate(
    system: System, request: Request, compile_s: float = 0.0, progress: Progress | None = None
) -> Solution:
    """The motion that `request` asks for, with the parameters that `system` holds.

    `progress` is called with the time reached, now and then; KeyboardInterrupt raised in it, or
    in a run, ends the run with what was computed.  Raises Refused where the request makes no sense
    (LAG0604), or no start is consistent (LAG0610), or the start is not computable (LAG0611).
    """
    began = perf_counter()
    counted: Any = Counted(system)
    request = request.completed(system.interface.simulate)
    start = begin(system, request)
    times = request.grid()
    notes = list(start.notes)
    if request.by_hand:
        options = by_hand(request)
        trajectory = system.integrate(options, 0.0, start.x, times, progress)
        tried = [trajectory]
        told = Verdict(*verdict(system, trajectory, times[-1]), trajectory, None)
    elif locked(system, start.x, times[0]):
        still = [*start.x[: system.nq], *[0.0] * (system.nx - system.nq)]
        trajectory, options = resting(still, times), Options()
        tried = [trajectory]
        told = Verdict(*verdict(system, trajectory, times[-1]), trajectory, ROUNDING)
        notes.append(LOCKED)
    elif len(times) > 1 and rests(counted, start.x, times):
        trajectory, options = resting(start.x, times), Options()
        tried = [trajectory]
        told = Verdict(*verdict(system, trajectory, times[-1]), trajectory, ROUNDING)
        notes.append(RESTS)
    else:
        assert request.accuracy is not None
        found = verified_run(counted, start.x, times, request.accuracy, progress)
        options, tried = found.options, found.tried
        told = judge(counted, found, request.accuracy, times[-1])
        trajectory = told.trajectory
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
        interrupted=trajectory.status == INTERRUPTED,
        cost=Cost(
            steps=sum(r.steps for r in tried), rejected=sum(r.rejected for r in tried),
            rhs=sum(r.rhs for r in tried) + counted.evaluations, operations=system.interface.operations,
            compile_s=compile_s, run_s=perf_counter() - began, integrations=len(tried),
        ),
    )  # fmt: skip


def begin(system: System, request: Request) -> Start:
    """The consistent start.  Raises Refused, naming the conditions that cannot be met."""
    start = consistent_start(system, 0.0, request.starts)
    if start.missed:
        raise Refused([_conflict(start)])
    if any(not abs(a) <= 1e300 for a in start.x):
        i = next(i for i, a in enumerate(start.x) if not abs(a) <= 1e300)
        raise Refused(
            [Fault("LAG0611", f"the start value of {state_name(system, i)} is not a finite number")]
        )
    return start


def _conflict(start: Start) -> Fault:
    missed, held = list(map(str, start.missed)), list(start.held)
    message = f"no start meets all conditions: {'; '.join(missed[:MOST_NAMED])}{_more(missed)}"
    if held:
        verb = "is" if len(held) == 1 else "are"
        message += f", where {', '.join(held[:MOST_NAMED])}{_more(held)} {verb} held fixed"
    remedy = "let one of these conditions go" if len(missed) > 1 else None
    if held:
        remedy = f"let one of {', '.join(held[:MOST_NAMED])} go" if len(held) > 1 else f"let {held[0]} go"
    return Fault("LAG0610", message, remedy=remedy)


def _more(parts: list[str]) -> str:
    return f" and {len(parts) - MOST_NAMED} more" if len(parts) > MOST_NAMED else ""


def by_hand(request: Request) -> Options:
    method = request.method or "dop853"
    if request.step is not None:
        return Options(method=method, step=request.step, max_steps=0)
    rtol = RTOL if request.rtol is None else request.rtol
    atol = 0.0 if request.atol is None else request.atol
    return Options(method=method, rtol=rtol, atol=atol, max_steps=0)


def energy(system: System, trajectory: Trajectory) -> Energy:
    """The balance between the first and the last recorded state."""
    if not trajectory.states:
        return Energy(0.0, 0.0, 0.0)
    first, last = trajectory.states[0], trajectory.states[-1]
    start = system.energies(trajectory.times[0], first)[2]
    end = system.energies(trajectory.times[-1], last)[2]
    return Energy(start, end, last[-1] - first[-1] if system.nz else 0.0)
