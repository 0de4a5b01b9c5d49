"""simulate: from a system and a request to a solution."""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from time import perf_counter

from lagc.diagnostics.faults import Fault, Refused
from lagc.run.accuracy import MEANINGLESS, verified_run
from lagc.run.problem import (
    FAILED,
    INCONSISTENT,
    INTERRUPTED,
    MAX_STEPS,
    NOT_FINITE,
    OK,
    REDUNDANT,
    SINGULAR_MASS,
    STEP_UNDERFLOW,
    Options,
    System,
    Trajectory,
)
from lagc.run.request import Request
from lagc.run.solution import Cost, Energy, Solution
from lagc.run.start import Start, consistent_start

Progress = Callable[[float], None]
NEAR = 1e3  # radians or sizes of the mechanism, per size of a row's terms: it loses rank nearby
MOST_NAMED = 12  # conditions of a conflict
RTOL = 1e-9  # by hand, where nothing is said


def simulate(
    system: System, request: Request, compile_s: float = 0.0, progress: Progress | None = None
) -> Solution:
    """The motion that `request` asks for, with the parameters that `system` holds.

    `progress` is called with the time reached, now and then; KeyboardInterrupt raised in it, or
    in a run, ends the run with what was computed.  Raises Refused where the request makes no sense
    (LAG0604), or no start is consistent (LAG0610), or the start is not computable (LAG0611).
    """
    began = perf_counter()
    request = request.completed(system.interface.simulate)
    start = begin(system, request)
    times = request.grid()
    estimated: float | None = None
    horizon: float | None = None
    failed: Trajectory | None = None
    notes = list(start.notes)
    if request.by_hand:
        options = by_hand(request)
        trajectory = system.integrate(options, 0.0, start.x, times, progress)
        tried = [trajectory]
    else:
        assert request.accuracy is not None
        found = verified_run(system, start.x, times, request.accuracy, progress)
        trajectory, options, tried = found.trajectory, found.options, found.tried
        estimated, horizon, failed = found.estimated, found.horizon, found.failed
    status, message = verdict(system, trajectory, times[-1])
    asked = request.accuracy
    if status == "ok" and estimated is not None and asked is not None and estimated > asked:
        status, message, trajectory, estimated = _missed(trajectory, estimated, asked, horizon)
        if failed is not None:
            message += f"; with a finer tolerance, {verdict(system, failed, times[-1])[1]}"
    if trajectory.redundant_rows:
        notes.append(_redundant(system, trajectory))
    return Solution(
        system=system,
        times=trajectory.times, states=trajectory.states, status=status, message=message,
        method=options.method, rtol=0.0 if options.step else options.rtol,
        atol=0.0 if options.step else options.atol, step=options.step,
        asked=request.accuracy, estimated=estimated,
        position_drift=trajectory.position_drift, velocity_drift=trajectory.velocity_drift,
        energy=energy(system, trajectory), notes=tuple(notes),
        interrupted=trajectory.status == INTERRUPTED,
        cost=Cost(
            steps=sum(r.steps for r in tried), rejected=sum(r.rejected for r in tried),
            rhs=sum(r.rhs for r in tried), operations=system.interface.operations,
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
        raise Refused([Fault("LAG0611", f"the start value of {_state(system, i)} is not a finite number")])
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
        return Options(method=method, step=request.step)
    rtol = RTOL if request.rtol is None else request.rtol
    return Options(method=method, rtol=rtol, atol=rtol if request.atol is None else request.atol)


def verdict(system: System, trajectory: Trajectory, stop: float) -> tuple[str, str]:
    """("ok" or "failed", what happened, by name and time)."""
    status, t = trajectory.status, f"t = {trajectory.t:.6g} s"
    k = trajectory.culprit
    if status in (OK, REDUNDANT):
        return "ok", f"reached {t}"
    if status == INTERRUPTED:
        return "failed", f"interrupted at {t}"
    if status == SINGULAR_MASS:
        return "failed", f"at {t} the mass matrix is singular: nothing has inertia along {_speed(system, k)}"
    if status == INCONSISTENT:
        return "failed", f"at {t} the constraints contradict each other: {_row(system, k)}"
    if status == NOT_FINITE:
        when = f"after {t}" if trajectory.steps else "at the start"
        return "failed", f"{when} {_state(system, k)} or its rate is not a finite number"
    if status == STEP_UNDERFLOW:
        lost = losing_rank(system, trajectory.t, trajectory.x)
        why = f": {lost}" if lost else ": the motion has a singularity there, or is too stiff for this method"
        return "failed", f"at {t} the step became too small{why}"
    if status == MAX_STEPS:
        lost = losing_rank(system, trajectory.t, trajectory.x)
        tried = trajectory.steps + trajectory.rejected
        why = f": {lost}" if lost else ""
        return "failed", f"the limit of {tried} steps was reached at {t}, before {stop:g} s{why}"
    return "failed", f"the integration ended at {t} with status {status}"


def losing_rank(system: System, t: float, x: list[float]) -> str:
    """Which constraint all but depends on others at (t, x), in words; empty where none does.

    To change its residual by the size of its terms alone, the coordinates would have to move very far.
    """
    if system.nc == 0 or len(x) < system.nx:
        return ""
    status = system.assemble(t, x)
    if status in FAILED:
        return ""
    row, farthest = system.culprit, inf
    if status != REDUNDANT:
        reach = min(1.0, max(abs(a) for a in x[: system.nq])) or 1.0
        row, farthest = -1, NEAR * reach
        for i, scale in enumerate(system.scales(t, x)):
            r = [0.0] * (system.nv + system.nc)
            r[system.nv + i] = scale
            way = max(map(abs, system.solve(r)[: system.nv]))
            if way > farthest:
                row, farthest = i, way
    return f"near that posture {_row(system, row)} all but depends on others, or vanishes" if row >= 0 else ""


def energy(system: System, trajectory: Trajectory) -> Energy:
    """The balance between the first and the last recorded state."""
    if not trajectory.states:
        return Energy(0.0, 0.0, 0.0)
    first, last = trajectory.states[0], trajectory.states[-1]
    start = system.energies(trajectory.times[0], first)[2]
    end = system.energies(trajectory.times[-1], last)[2]
    return Energy(start, end, last[-1] - first[-1] if system.nz else 0.0)


def _missed(
    trajectory: Trajectory, estimated: float, accuracy: float, horizon: float | None
) -> tuple[str, str, Trajectory, float]:
    """What is said and returned where the accuracy asked was not reached, and its error.

    Where the end of the motion is known to less than a hundredth, no point of it beyond the
    horizon is an answer, and none is given.
    """
    if estimated < MEANINGLESS or horizon is None:
        message = (f"the accuracy {accuracy:g} cannot be reached in double precision here: "
                   f"the best is estimated at {estimated:.2g}")  # fmt: skip
        return "failed", message, trajectory, estimated
    kept = sum(1 for t in trajectory.times if t <= horizon)
    message = (f"the motion can be foretold to {accuracy:g} until t = {horizon:.6g} s only: beyond it, "
               "runs of different tolerance part (it is chaotic, or too sensitive)")  # fmt: skip
    times, states = trajectory.times[:kept], trajectory.states[:kept]
    cut = trajectory.changed(times=times, states=states, t=times[-1], x=states[-1])
    return "failed", message, cut, accuracy


def _redundant(system: System, trajectory: Trajectory) -> str:
    rows = ", ".join(_row(system, k) for k in trajectory.redundant_rows)
    several = len(trajectory.redundant_rows) > 1
    return (f"{rows} {'depend' if several else 'depends'} on other constraints: the motion is determined, "
            "the multipliers are the smallest ones possible")  # fmt: skip


def _state(system: System, k: int) -> str:
    interface = system.interface
    names = [*interface.q_names, *interface.v_names]
    if 0 <= k < len(names):
        return f"`{names[k]}`"
    return "the work of the given actions" if k == len(names) else "a state"


def _speed(system: System, k: int) -> str:
    names = system.interface.v_names
    return f"`{names[k]}`" if 0 <= k < len(names) else "some speed"


def _row(system: System, k: int) -> str:
    labels = system.interface.row_labels
    return f"constraint `{labels[k]}`" if 0 <= k < len(labels) else "a constraint"
