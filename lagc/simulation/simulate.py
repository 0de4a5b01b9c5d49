"""Run a simulation: from a system and a request to a solution."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from math import log
from time import perf_counter
from typing import Any

from lagc.base.records import dataclass
from lagc.base.text import FINEST
from lagc.codegen.python.support.contacts import CLOSES, OPENS, RESTS, SLIPS, STICKS, STRIKES
from lagc.diagnostics.faults import Refused
from lagc.kernels import DEFAULT_METHOD, IMPLICIT, SERIES
from lagc.lowering.program import Interface
from lagc.simulation.error_measure import contacts_of, last_bounces
from lagc.simulation.global_error.equilibrium_start import locked, rests, trajectory_at_rest
from lagc.simulation.global_error.verified_run import Verified, verified_run
from lagc.simulation.initialization.initialize import begin, demand, strange_outputs
from lagc.simulation.initialization.result import Start
from lagc.simulation.request import Request
from lagc.simulation.solution import Cost, Energy, Event, Solution
from lagc.simulation.supervision import LIMITED, LONG_RUN, TESTED
from lagc.simulation.system import (
    FAILED,
    INTERRUPTED,
    MAX_STEPS,
    REDUNDANT,
    Counted,
    Options,
    System,
    Trajectory,
    event_names,
    rates_at,
    work_of,
)
from lagc.simulation.verdict import (
    Verdict,
    fixed_step_verdict,
    redundancy,
    sharing,
    spaced_verdict,
    verdict,
    verified_verdict,
)

Progress = Callable[[float], None]
KINDS = {RESTS: "rests", CLOSES: "closes", OPENS: "opens", STICKS: "sticks", SLIPS: "slips"}
COARSEST_SERIES = 1e-7  # tolerance for which a Taylor series may take less work
LARGEST_SERIES = 600  # operations of a right-hand side
LEAST_GAIN = 1.2  # work of the usual method over that of a series
LANE = 0.5  # work of a term of a sum, in additions
OVERHEAD = 300.0, 500.0  # of a step of dop853, of a series
FEWER_AT_1E_5 = 0.65  # steps of dop853 over those of a series
SMOOTH = f"the motion is smooth and long: {SERIES[0]} takes"
FEWER = 0.2  # steps of an implicit run over those of the explicit one, at most
RTOL = 1e-9  # relative tolerance of a manual run without one
ROUNDING = 2.0**-49  # relative: round-off of a coordinate at rest, several rounding units
AT_REST = ("the initial state is an equilibrium, to round-off, and the system stays there; whether "
         "the equilibrium is stable was not examined")  # fmt: skip
LOCKED = "the constraints leave no motion from the initial state: the system stays there"


@dataclass
class _Done:
    """The outcome of the integrations: the verdict, the options of the run returned, the number of
    integrations and their evaluations, and notes."""

    verdict: Verdict
    options: Options
    integrations: int
    rhs: int
    notes: list[str]
    errors: tuple[float, ...] = ()
    scales: tuple[float, ...] = ()


def simulate(
    system: System, request: Request, compile_s: float = 0.0, progress: Progress | None = None,
    start: Start | None = None, spent: float = 0.0, stiff: Callable[[], System] | None = None,
    series: Callable[[], System] | None = None,
) -> Solution:  # fmt: skip
    """Return the motion that `request` asks for, with the parameters of `system`.

    `start` is the initial state if it is known already; `spent` the wall time in s that the run has taken
    so far.  `stiff` and `series` return the system with the implicit methods and with those by power series,
    if they may be taken.  `progress` is called with the time reached.  KeyboardInterrupt, raised in it or in
    a run, ends the run with the results so far.  Raises Refused (LAG0604) if the request is invalid, NoStart
    if there is no consistent initial state or no rate there."""
    began = perf_counter() - spent
    counted: Any = Counted(system)
    request = request.completed(system.interface.simulate)
    start = start or begin(system, request)
    times = request.grid()
    # The run, and the verdict on it.
    done = _integrate(counted, request, start, times, progress, stiff, series)
    result, options = done.verdict, done.options
    trajectory = result.trajectory
    # Notes: what the user would want to know of a run that is in order otherwise.
    notes = [*start.notes, *done.notes]
    for k in strange_outputs(system, start.x):
        notes.append(f"output `{system.interface.outputs[k].name}` has no finite initial value")
    notes += stability_note(trajectory)
    notes += rest_note(system, trajectory)
    # Forces that are one choice of many.
    open_reactions: tuple[str, ...] = ()
    if result.status == "ok" and (trajectory.redundant_rows or _depend(system, trajectory)):
        note, open_reactions = redundancy(system, trajectory)
        notes.append(note)
    if shared := tuple([system.interface.contacts[k].name for k in trajectory.shared_contacts]):
        notes.append(sharing(shared))
        open_reactions += shared
    return Solution(
        system=system,
        times=trajectory.times, states=trajectory.states, status=result.status, message=result.message,
        method=options.method, rtol=0.0 if options.step else options.rtol, alone=options.alone,
        atol=0.0 if options.step else options.atol, step=options.step,
        asked=request.accuracy, estimated=result.estimated, cut=result.cut,
        position_drift=trajectory.position_drift, velocity_drift=trajectory.velocity_drift,
        energy=energy(system, trajectory), notes=tuple(notes),
        warnings=system.interface.warnings,
        open_reactions=open_reactions, error_bars=done.errors, scale_values=done.scales,
        events=events_of(system, trajectory),
        corners=tuple(trajectory.corners), interrupted=trajectory.status == INTERRUPTED, end=times[-1],
        cost=Cost(
            steps=trajectory.steps, rejected=trajectory.rejected, rhs=done.rhs + counted.evaluations,
            operations=system.interface.operations, compile_s=compile_s, run_s=perf_counter() - began,
            start_s=start.seconds, integrations=done.integrations, alone=trajectory.rhs,
        ),
    )  # fmt: skip


def events_of(system: System, trajectory: Trajectory) -> tuple[Event, ...]:
    """The events of relations and clauses, and those of contacts, in the order of time. At one time clauses
    that change no state come last: they are no cause of another one."""
    found = [Event(t, name) for t, k in trajectory.events for name in event_names(system, k)]
    contacts = contacts_of(trajectory)
    for t, k, kind, impulse, loss, end in contacts:
        name = system.interface.contacts[k].name
        if kind in (STRIKES, RESTS):
            found.append(Event(t, f"{name}: impact", name, "impact", impulse, loss))
        if kind != STRIKES:
            said = KINDS[kind]
            found.append(Event(end if kind == RESTS else t, f"{name} {said}", name, said))
    idle = {name for when in system.interface.whens if not when.states for name in when.names}
    return tuple(sorted(found, key=lambda event: (event.t, event.name in idle)) if contacts else found)


def rest_note(system: System, run: Trajectory) -> list[str]:
    """A note if recorded times are among bounces that are not followed."""
    within = [t for t in run.times if any(begin < t < end for begin, end in last_bounces(run))]
    if not within:
        return []
    return [
        f"at t = {within[0]:.9g} s bounces lower than 1e-10 of a fall are not followed any more: "
        "speeds there have the error of such a bounce"
    ]


def stability_note(run: Trajectory) -> list[str]:
    """A note if stability, and not accuracy, limited the steps of a long run."""
    if not (run.steps >= LONG_RUN and run.stiff * TESTED >= LIMITED * run.steps):
        return []
    return [
        f"stability limited most of the {run.steps} steps, to about {abs(run.t) / run.steps:.1g} s: the "
        "equations are stiff, something decays or rings far faster than the motion. An explicit method takes "
        "no longer steps, also with a looser tolerance. The implicit method radau5 does where that decays "
        "(--method radau5); else take a softer spring, a larger mass, or a constraint in place of a very "
        "stiff spring"
    ]


def _depend(system: System, run: Trajectory) -> bool:
    """Whether constraints depend on each other where a system stays at rest."""
    if run.steps > 0 or system.nc == 0:
        return False
    return system.rhs(run.t, run.x, [0.0] * system.nx, [0.0] * system.nc) == REDUNDANT


def _integrate(
    system: Any, request: Request, start: Start, times: Sequence[float], progress: Progress | None,
    stiff: Callable[[], System] | None, series: Callable[[], System] | None,
) -> _Done:  # fmt: skip
    """Integrate from the initial state: with given tolerances, at rest, or to the accuracy asked."""
    x, end = start.x, times[-1]
    if request.by_hand:
        options = by_hand(request)
        run = system.integrate(options, 0.0, x, times, progress)
        if not options.step or (run.status in FAILED and rates_at(system, 0.0, x) is None):
            demand(system, run)  # a failure at the initial state itself, and not after a fixed step
        outcome = (
            fixed_step_verdict(system, run, options.step, end) if options.step else verdict(system, run, end)
        )
        return _Done(Verdict(*outcome, run, None), options, 1, run.rhs, [])
    scales = _scales(system, request)
    timed = system.interface.whens and system.interface.timed
    assert request.accuracy is not None
    rest = None if timed or system.interface.contacts else _state_of_rest(system, x, times)
    if rest is not None:
        run = trajectory_at_rest(rest[0], times)
        equilibrium = Verdict(*verdict(system, run, end), run, ROUNDING)
        equilibrium = spaced_verdict(system, equilibrium, request.accuracy, scales)
        return _Done(equilibrium, Options(), 1, run.rhs, [rest[1]])
    system, found, why = _chosen(system, x, times, request, progress, stiff, series)
    demand(system, found.trajectory)
    result = verified_verdict(system, found, request.accuracy, end)
    result = spaced_verdict(system, result, request.accuracy, scales)
    return _Done(result, found.options, 2 * found.attempts, found.rhs, [*why, *found.notes],
                 tuple(found.errors), tuple(found.scales))  # fmt: skip


def _chosen(
    system: Any, x: Sequence[float], times: Sequence[float], request: Request, progress: Progress | None,
    stiff: Callable[[], System] | None, series: Callable[[], System] | None,
) -> tuple[Any, Verified, list[str]]:  # fmt: skip
    """Return a verified run, its system, and a note if another method takes the place of the usual one: a
    Taylor series where the motion is long, smooth and exact enough that this takes less work."""
    from lagc.simulation.supervision import LongRun

    accuracy, interface = request.accuracy, system.interface
    assert accuracy is not None
    small = (
        interface.operations <= LARGEST_SERIES and interface.solve == "straight" and not interface.contacts
    )
    asked = series is not None and request.method is None
    given = (system, x, times, request, progress, stiff)
    try:
        return _verified(*given, LONG_RUN if asked and small else 0)
    except LongRun as long:
        steps = long.steps
    assert series is not None
    # Errors of an undamped motion add up over its steps.
    tolerance = accuracy if system.nz else max(accuracy / steps, FINEST)
    if tolerance > COARSEST_SERIES:
        return _verified(*given)
    with suppress(Refused):  # a function without a recurrence
        other = system.share_count(series().bind(system.parameters))
        gain = gain_of_series(other.interface, tolerance)
        if gain >= LEAST_GAIN:
            found = verified_run(other, **_terms(other, x, times, request, progress), method=SERIES[0])
            if found.estimated <= accuracy or found.trajectory.status == INTERRUPTED:
                note = f"{SMOOTH} {1.0 / gain:.2g} of the work of dop853 ({steps:.2g} steps at 1e-6)"
                return other, found, [note]
    return _verified(*given)


def gain_of_series(interface: Interface, tolerance: float) -> float:
    """Return the work of dop853 over that of a Taylor series for the same motion, by operations. A step of
    dop853 is proportional to the 1/8th power of the tolerance, those of a series hardly depend on it; at the
    same tolerance errors of a series are ten times smaller (measured over the library)."""
    from lagc.kernels.integrators.taylor import FALL

    _, lanes, squares, finish, rhs = interface.series
    order = 1.0 - log(tolerance) / FALL
    sums = LANE * (lanes + 0.5 * squares) * order * order / 2.0
    series = sums + finish * order + 2.0 * rhs + OVERHEAD[1]
    steps = FEWER_AT_1E_5 * float((1e-5 / tolerance) ** 0.125)
    return steps * (12.0 * rhs + OVERHEAD[0]) / series


def _scales(system: System, request: Request) -> dict[str, float]:
    """The scales of quantities that the model and the request give, by name."""
    return {**system.interface.scales, **request.scales}


def _terms(
    system: System, x: Sequence[float], times: Sequence[float], request: Request, progress: Progress | None
) -> dict[str, Any]:
    """The arguments of `verified_run` that a request determines."""
    return {
        "x0": x, "times": times, "accuracy": request.accuracy, "progress": progress,
        "max_step": request.max_step, "scales": _scales(system, request),
    }  # fmt: skip


def _verified(
    system: Any, x: Sequence[float], times: Sequence[float], request: Request, progress: Progress | None,
    stiff: Callable[[], System] | None, long: int = 0,
) -> tuple[Any, Verified, list[str]]:  # fmt: skip
    """Return a verified run, its system, and a note if it takes an implicit method because stability limits
    the steps of an explicit one, and it is long or misses the accuracy: where something is damped, and the
    implicit one takes far fewer steps."""
    assert request.accuracy is not None
    given = _terms(system, x, times, request, progress)
    if stiff is None or request.method is not None or not system.nz:
        return system, verified_run(system, **given, method=request.method or DEFAULT_METHOD, long=long), []
    from lagc.simulation.supervision import StabilityLimited, is_limited

    explicit = None
    try:
        explicit = verified_run(system, **given, most=-1, long=long)
        run = explicit.trajectory
        reached = explicit.estimated <= request.accuracy or run.status == INTERRUPTED
        if not is_limited(run) or reached or run.t == times[0]:
            return system, explicit, []
        most, step = FEWER * run.steps, abs(run.t - times[0]) / run.steps
    except StabilityLimited as limited:
        most, step = FEWER * limited.steps, limited.step
    other = system.share_count(stiff().bind(system.parameters))
    found = verified_run(other, **given, method=IMPLICIT[0], most=int(most))
    if found.estimated <= request.accuracy or (explicit is None and found.trajectory.status != MAX_STEPS):
        note = (f"the equations are stiff: stability limits an explicit method to steps of about {step:.1g} "
                f"s, and something is damped. The implicit method {IMPLICIT[0]} takes its place")  # fmt: skip
        return other, found, [note]
    return system, explicit or verified_run(system, **given), []


def _state_of_rest(system: System, x: list[float], times: Sequence[float]) -> tuple[list[float], str] | None:
    """Return the state in which the system stays and the reason, or None if it moves or cannot."""
    discrete = len(system.interface.discretes)
    if system.interface.servos and rates_at(system, times[0], x) is None:
        return None
    if locked(system, x, times[0]):
        return [*x[: system.nq], *[0.0] * (system.nv + system.nz), *x[system.nx - discrete :]], LOCKED
    if len(times) > 1 and rests(system, x, times):
        return x, AT_REST
    return None


def by_hand(request: Request) -> Options:
    """The options of a manual run: a fixed step, or tolerances."""
    method = request.method or DEFAULT_METHOD
    if request.step is not None:
        return Options(method=method, step=request.step, max_steps=0, report=True)
    rtol = RTOL if request.rtol is None else request.rtol
    atol = 0.0 if request.atol is None else request.atol
    longest = request.max_step or 0.0
    return Options(method=method, rtol=rtol, atol=atol, max_steps=0, max_step=longest, report=True)


def energy(system: System, trajectory: Trajectory) -> Energy:
    """The energy balance between the first and the last recorded state."""
    if not trajectory.states:
        return Energy(0.0, 0.0, 0.0)
    first, last = trajectory.states[0], trajectory.states[-1]
    start = system.energies(trajectory.times[0], first)[2]
    end = system.energies(trajectory.times[-1], last)[2]
    return Energy(start, end, work_of(system, last) - work_of(system, first))
