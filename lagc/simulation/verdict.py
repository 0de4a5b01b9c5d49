"""The result of a run in words: whether it is good, or else what happened, when, where and why."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf, tau
from sys import float_info
from typing import TYPE_CHECKING

from lagc.base.records import dataclass, replace
from lagc.host.budgets import reached
from lagc.simulation.error_measure import quantity_names, quantity_units
from lagc.simulation.global_error.energy_balance import Balance, balance
from lagc.simulation.global_error.verified_run import MEANINGLESS, ULP, Verified
from lagc.simulation.system import (
    CHATTERING,
    INCONSISTENT,
    INTERRUPTED,
    MAX_STEPS,
    MISPLACED,
    NOT_CONVERGED,
    NOT_FINITE,
    OK,
    PARADOX,
    PENETRATION,
    REDUNDANT,
    SINGULAR_MASS,
    STEP_UNDERFLOW,
    TERMINATED,
    Options,
    System,
    Trajectory,
    contradicting,
    contradiction,
    event_names,
    idle_actuator,
    more,
    rates_at,
    row_name,
    speed_name,
    state_name,
)

if TYPE_CHECKING:
    from lagc.lowering.program import Clause

SHORTEST = 2.3e-308  # s: smaller numbers have fewer digits
STEPS = 1e38  # steps that no run takes: the integration gives up if its first step is that short
SEVERAL = 10
FEWEST_DIGITS = 100.0 * float_info.epsilon  # relative: double precision hardly reaches this for any motion
MEETS = 1e-6  # of the size of the coordinates: gaps of contacts that touch
NOTABLE = 1e-3  # of the accuracy: a rounding unit that many steps may add up to it
MOST_NAMED = 4  # names of a kind in a message
ROUNDING = 2.0**-42  # relative: several rounding units
FINEST = 1e-13  # tolerance, below which round-off is a large part of the error
COMPARED = 200  # times at which two runs are compared for their growth
UNKNOWN = "the cause is not known"


@dataclass(frozen=True, slots=True)
class Verdict:
    """The result of a run. `status` is "ok", "terminated" or "failed"; `trajectory` is returned, and may be a
    part of the one computed; `estimated` is its relative global error, None if it was not verified. `cut`:
    the motion is not predictable beyond its end."""

    status: str
    message: str
    trajectory: Trajectory
    estimated: float | None
    cut: bool = False


def verified_verdict(system: System, found: Verified, asked: float, stop: float) -> Verdict:
    """The verdict on a verified run to `stop` that was asked for the accuracy `asked`."""
    run, estimated = found.trajectory, found.estimated
    status, message = verdict(system, run, stop)
    if status == "failed":
        found.errors = []  # they are those up to the failure, not up to the last recorded time
        return Verdict(status, message, run, estimated)
    kept = _kept_share(system, run)
    if kept is not None:  # an error that all runs share does not show in their differences
        return Verdict("failed", _nearly_dependent(system, *kept), run, inf)
    if estimated > asked:
        return _inaccurate(system, found, asked, stop)
    balanced = balance(system, run, found.scales, asked, found.work_error)
    if not balanced.holds:
        return Verdict("failed", _unbalanced(balanced, asked), run, estimated)
    return Verdict(status, message, run, estimated)


def spaced_verdict(system: System, found: Verdict, asked: float, scales: Mapping[str, float]) -> Verdict:
    """`found`, or failed if an angle is so large that the spacing of numbers there exceeds `asked` times its
    scale, and rates or outputs depend on it. `scales` are those that are given, by name; others are 1 rad.
    The message of a run that only misses its accuracy is replaced: this is the cause."""
    run, interface = found.trajectory, system.interface
    for i, name in enumerate(interface.q_names if run.states else ()):
        size = max(abs(x[i]) for x in run.states)
        least = ULP * size / scales.get(name, 1.0)
        turns = interface.state_units[i] == "rad" and size > tau
        if turns and least > asked and _depends(system, run, i):
            broken = found.status == "failed" and run.status not in (OK, REDUNDANT)
            before = f"{found.message}; " if broken else ""
            message = (f"{before}`{name}` is {size:g} rad, where the spacing of numbers is "
                       f"{ULP * size:.2g} rad: the accuracy {asked:g} cannot be reached in double precision. "
                       "Leave out whole turns")  # fmt: skip
            return replace(
                found, status="failed", message=message, estimated=max(found.estimated or 0.0, least)
            )
    return found


def _depends(system: System, run: Trajectory, i: int) -> bool:
    """Whether rates or outputs at the first state depend on coordinate i, by a turn of about a radian."""
    t, x, on = run.times[0], run.states[0], system.on(run.times[0], run.states[0])
    other = [*x[:i], x[i] + max(1.0, 4.0 * ULP * abs(x[i])), *x[i + 1 :]]
    values = [[*(rates_at(on, t, y) or ())] for y in (x, other)]
    if system.interface.outputs:
        columns = on.output_columns([t, t], [x, other])
        values = [[*rates, *(column[k] for column in columns)] for k, rates in enumerate(values)]
    return any(abs(a - b) > ROUNDING * (abs(a) + abs(b)) for a, b in zip(*values))


def verdict(system: System, trajectory: Trajectory, stop: float) -> tuple[str, str]:
    """Return the status ("ok", "terminated" or "failed") and the message of a run to `stop`."""
    status, t = trajectory.status, f"t = {trajectory.t:.6g} s"
    if status in (OK, REDUNDANT):
        return "ok", f"reached {t}"
    if status == INTERRUPTED:
        limit = reached()
        return "failed", f"interrupted at {t}" + (f": it took longer than {limit}" if limit else "")
    if status == TERMINATED:
        clause = system.interface.whens[trajectory.culprit]
        return "failed" if clause.fails else "terminated", f"at {t}: {clause.reason}"
    if status == PARADOX:
        return "failed", f"at {t} {_paradox(system, trajectory)}"
    if status == PENETRATION:
        return "failed", f"at {t} {_penetration(system, trajectory)}"
    if status in (MISPLACED, CHATTERING) or _accumulates(trajectory):
        return "failed", f"at {t} {_at_event(system, trajectory)}"
    if status == SINGULAR_MASS:
        speed = speed_name(system, trajectory.culprit)
        return "failed", f"at {t} the mass matrix is singular: nothing has inertia along {speed}"
    if status == INCONSISTENT:
        return "failed", f"at {t} {_inconsistent(system, trajectory)}"
    if status == NOT_CONVERGED:
        if "series" in system.interface.functions:
            return "failed", (f"at {t} constraint equations depend on each other, which a power series does "
                              "not follow: take dop853")  # fmt: skip
        return "failed", f"at {t} the equations of a step were not solved: ask for a shorter step"
    return "failed", _unfinished(system, trajectory, stop)


def fixed_step_verdict(system: System, trajectory: Trajectory, step: float, stop: float) -> tuple[str, str]:
    """`verdict` for a fixed step: if the solution failed at a state that a step reached, the step may be too
    long."""
    status, message = verdict(system, trajectory, stop)
    if status == "failed" and trajectory.status in (INCONSISTENT, SINGULAR_MASS, NOT_FINITE):
        message += (
            f"; the fixed step of {step:g} s may be too long: ask for a shorter one, or for an accuracy"
        )
    return status, message


def _at_event(system: System, run: Trajectory) -> str:
    """The message of a run that failed at an event."""
    k, interface = run.culprit, system.interface
    if run.status == MISPLACED:
        clause = interface.whens[k]
        return (f"the new values that `when {clause.words}` gives are not finite, or do not "
                f"meet the constraints{_left_out(system, clause)}")  # fmt: skip
    first = len(interface.relations) - len(interface.contacts)
    if run.status == CHATTERING and first <= k < len(interface.relations):
        return _endless(system, run, k - first)
    if run.status == CHATTERING and interface.drives(k) and not _accumulates(run):
        return (f"{interface.relations[k]}, and the forces on both sides drive the motion back to it: the "
                "state sticks there, as with dry friction. Write it in the constraint that bears the load, "
                "`constraint floor: z >= 0 [m] (friction = 0.3, at = b);`, or use a smooth law, such as "
                "tanh(v/v0) instead of sign(v)")  # fmt: skip
    what = event_names(system, k if run.status == CHATTERING else run.events[-1][1])[0]
    return (f"`{what}` occurs again and again in ever shorter intervals, as with bounces that accumulate: "
            "write the contact as a constraint in place of the clause, `constraint floor: z >= 0 [m] "
            "(restitution = 0.8);`, or end the run before by `terminate`")  # fmt: skip


def _paradox(system: System, run: Trajectory) -> str:
    """The message of a run in which laws of contacts, or loads of reactions, have no solution or several."""
    interface = system.interface
    names = [contact.name for contact in interface.contacts]
    row = run.culprit - len(names)
    at = ", ".join(f"{n} = {v:.6g}" for n, v in zip(interface.q_names[:MOST_NAMED], run.x))
    if row >= 0 and (interface.loading_rows or interface.pushed_contacts):
        idle = idle_actuator(system, run.status, run.culprit)
        if idle:
            return (f"`{idle[1]}` cannot hold the constraint `{idle[0]}` ({at}): it does not change the "
                    "acceleration of the constraint there, or several actuators do so alike")  # fmt: skip
        label = names[row - interface.nc] if row >= interface.nc else interface.row_labels[row]
        return (f"the loads that depend on `reaction({label})` leave it open ({at}): no value solves the "
                "equations, or several do, as in a mechanism that locks itself")  # fmt: skip
    name = names[run.culprit] if 0 <= run.culprit < len(names) else names[0]
    rough = (contact for contact in interface.contacts if contact.slips and not contact.normals)
    newton = any(not contact.poisson for contact in rough)
    impact = "; Newton's law of impact may also add energy there, `law = poisson` does not" if newton else ""
    return (f"the laws of contact have no solution, or several, where `{name}` touches ({at}): rigid "
            f"bodies do not decide how the motion goes on{impact}")  # fmt: skip


def _endless(system: System, run: Trajectory, k: int) -> str:
    """The message of a run in which contact k, perhaps with others that touch, acts without end."""
    contacts = system.interface.contacts
    size = max((abs(value) for x in (*run.states, run.x) for value in x[: system.nq]), default=0.0)
    near = [c.name for c, gap in zip(contacts, system.gaps(run.t, run.x)) if abs(gap) <= MEETS * size]
    names = list(dict.fromkeys((contacts[k].name, *near)))
    if len(names) == 1:
        return f"the contact `{names[0]}` opens and closes without end"
    shown = " and ".join([f"`{name}`" for name in names[:MOST_NAMED]])
    return (f"the contacts {shown} act on each other without end: perhaps their bounds meet, and leave no "
            "room to what is between them")  # fmt: skip


def _penetration(system: System, run: Trajectory) -> str:
    """The message of a run in which a bound or a clause has jumped over bodies."""
    contact = system.interface.contacts[run.culprit]
    depth = f"{getattr(run, 'penetration', 0.0):.6g} {contact.unit}".rstrip()
    resets = any(clause.states for clause in system.interface.whens)
    why = "by new values of a clause `when`, or since it jumped" if resets else "which jumped"
    remedy = "give values with a gap that is zero or positive, and " if resets else ""
    return (f"the motion is {depth} beyond the bound `{contact.name}`, {why}: {remedy}let the bound move in "
            "a finite time")  # fmt: skip


def _left_out(system: System, clause: Clause) -> str:
    """The states that constraints couple to the values that a clause sets, and that it does not set."""
    interface, given = system.interface, set(clause.states)
    ends, columns, left, rows = interface.condition_ends, interface.condition_columns, set[int](), list[int]()
    for k in range(interface.nh + interface.nc):
        row = set(columns[ends[k - 1] if k else 0 : ends[k]])
        tied = {i for i in row - given if k < interface.nh or i >= system.nq}
        if given & row and tied:
            left |= tied
            rows.append(k if k < interface.nh else k - interface.nh)
    if not left:
        return ""
    names = [state_name(system, i) for i in sorted(left)]
    ties = [row_name(system, k) for k in dict.fromkeys(rows)]
    shown, by = (", ".join(a[:MOST_NAMED]) + more(a, MOST_NAMED) for a in (names, ties))
    return f": it leaves {shown} unchanged, which {by} may couple to them"


def _accumulates(run: Trajectory) -> bool:
    """Whether a run with too many steps ended among jumps that are about one step apart."""
    last = run.jumps[-SEVERAL:]
    near = len(last) == SEVERAL and abs(run.t - last[0]) <= SEVERAL * SEVERAL * abs(run.step)
    return near and run.status in (MAX_STEPS, STEP_UNDERFLOW)


def _inconsistent(system: System, run: Trajectory) -> str:
    from lagc.simulation.diagnosis import kink

    share = _own_share(system, run, [run.culprit])
    if share is not None:
        return _nearly_dependent(system, *share)
    reason = kink(system, run, run.t, run.x)
    return reason or contradiction(system, contradicting(system, run.t, run.x, run.culprit))


def _unfinished(system: System, run: Trajectory, stop: float) -> str:
    """The message of a run whose step size or values left the range of numbers, or with too many steps."""
    status, t = run.status, f"t = {run.t:.6g} s"
    if status != MAX_STEPS and run.steps == 0 and 0.0 < stop < SHORTEST:
        return f"a run of {stop:g} s is too short for double precision: ask for a longer one"
    if status == NOT_FINITE and run.steps == 0 and rates_at(system, run.t, run.x) is not None:
        return f"the first steps towards {stop:g} s overflow: ask for a shorter run"
    if status == NOT_FINITE:
        when = f"after {t}" if run.steps else "at the start"
        return f"{when} {state_name(system, run.culprit)} or its rate is not a finite number"
    if status == STEP_UNDERFLOW and run.steps == run.rejected == 0:
        much = f"the run to {stop:g} s would take more than {STEPS:g} steps"
        return f"{much}: ask for a shorter one, or longer steps"
    from lagc.simulation.diagnosis import cause

    share = _own_share(system, run, run.redundant_rows)
    why = (
        _nearly_dependent(system, *share)
        if share is not None
        else cause(system, run, run.t, run.x) or UNKNOWN
    )
    if status == STEP_UNDERFLOW:
        return f"at {t} the step size became too small: {why}"
    if status == MAX_STEPS:
        return (f"at {t}, after {run.steps + run.rejected} steps of about {abs(run.step):.1g} s, the rest to "
                f"{stop:g} s would take too many steps: {why}")  # fmt: skip
    return f"the integration ended at {t} with status {status}"


def _inaccurate(system: System, found: Verified, asked: float, stop: float) -> Verdict:
    """The verdict if the accuracy `asked` was not reached. If the end of the motion is known to less than a
    hundredth, only the part up to the horizon is returned."""
    run, estimated, horizon = found.trajectory, found.estimated, found.horizon
    if found.limit[1] > max(asked, FEWEST_DIGITS):
        message = f"the accuracy {asked:g} cannot be reached in double precision: {_rounded(system, found)}"
        return Verdict("failed", message, run, estimated)
    if estimated >= MEANINGLESS:
        return _until_horizon(system, found, asked)
    until = "" if not run.times[0] < horizon < stop else f"; it is met until t = {horizon:.6g} s"
    hint = f". {_rounded(system, found)}" if found.limit[1] > max(NOTABLE * asked, FEWEST_DIGITS) else ""
    best = f"the best is estimated at {estimated:.2g}{_worst(system, found)}"
    if found.options.rtol > FINEST:
        return Verdict(
            "failed", f"the accuracy {asked:g} was not reached: {best}{until}{hint}", run, estimated
        )
    why = f"{best}, at the finest tolerance, where round-off decides"
    if not until:
        until = f"; about {estimated:.0e} can be reached, and more by the code of `lagc build --real quad`"
    message = f"the accuracy {asked:g} cannot be assured in double precision here: {why}{until}{hint}"
    return Verdict("failed", message, run, estimated)


def _rounded(system: System, found: Verified) -> str:
    """The quantity whose scale is closest to one rounding unit of its terms, and what to do."""
    k, share = found.limit
    name, unit = quantity_names(system.interface)[k], quantity_units(system.interface)[k]
    terms = share * found.scales[k] / ULP
    scale, size = (f"{value:.2g} {unit}".rstrip() for value in (found.scales[k], terms))
    return (f"`{name}` has the scale {scale} and terms of {size}, so that one rounding unit is {share:.1g} "
            "of its scale. Shift the origin so that the terms are small, or give the scale that matters: "
            f"`--scale '{name}={terms:.0g}'`")  # fmt: skip


def _worst(system: System, found: Verified) -> str:
    """The quantity with the largest error over its scale, or the times of events, in brackets."""
    shares = [error / scale if scale else 0.0 for error, scale in zip(found.errors, found.scales)]
    if found.time_error > max(shares, default=0.0):
        return " (the time of an event)"
    if not any(shares):
        return ""
    return f" (`{quantity_names(system.interface)[shares.index(max(shares))]}`)"


def _until_horizon(system: System, found: Verified, asked: float) -> Verdict:
    """The verdict on the part of a run up to the horizon, beyond which it is not known."""
    from lagc.simulation.diagnosis import cause

    run, horizon = found.trajectory, found.horizon
    kept = sum(1 for t in run.times if t <= horizon)
    times, states = run.times[:kept], run.states[:kept]
    tenfold, beyond = _tenfold_time(system, found), "runs of different steps differ"
    if tenfold is not None:
        beyond += f"; differences grow tenfold every {tenfold:.2g} s (it is chaotic, or unstable)"
    else:
        why = cause(system, run, run.t, run.x) or cause(system, run, times[-1], states[-1])
        rounds = "round-off" if found.options.rtol <= FINEST else UNKNOWN
        beyond += f"; {why or rounds}"
    message = f"the motion is predictable to {asked:g} only until t = {horizon:.6g} s: beyond it, {beyond}"
    events, corners = ([e for e in own if e[0] <= times[-1]] for own in (run.events, run.corners))
    cut = run.changed(times=times, states=states, t=times[-1], x=states[-1], events=events, corners=corners)
    found.errors = [min(error, asked * scale) for error, scale in zip(found.errors, found.scales)]
    return Verdict("failed", message, cut, asked, cut=True)


def _tenfold_time(system: System, found: Verified) -> float | None:
    """The time in which differences grow tenfold, from two more runs to where this one ended."""
    from lagc.simulation.diagnosis import tenfold_time

    run, own = found.trajectory, found.options
    times = [run.times[0] + (run.t - run.times[0]) * k / COMPARED for k in range(COMPARED + 1)]
    options = [
        Options(
            method=own.method, rtol=factor * own.rtol, alone=own.alone, max_step=own.max_step, max_steps=0
        )
        for factor in (1.0, 10.0)
    ]
    return tenfold_time(system, *(system.integrate(each, times[0], run.states[0], times) for each in options))


def _unbalanced(balance: Balance, asked: float) -> str:
    return (f"at t = {balance.t:.6g} s the energy is out of balance by {balance.imbalance:.2g} J, and errors "
            f"of {asked:g} in the states explain {balance.explained:.2g} J at most: the motion is wrong, "
            "although runs of different steps agree; perhaps the energy jumps, as at the cut of an "
            "angle")  # fmt: skip


def _kept_share(system: System, run: Trajectory) -> tuple[int, float] | None:
    """`kept_share`, if a constraint was left out as dependent."""
    if not run.redundant_rows:
        return None
    from lagc.simulation.diagnosis import kept_share

    return kept_share(system, run)


def _own_share(system: System, run: Trajectory, rows: Sequence[int]) -> tuple[int, float] | None:
    """The first of `rows` that nearly depends on others at the end of the run, and its own share."""
    if min(rows, default=-1) < 0 or len(run.x) < system.nx:
        return None
    from lagc.simulation.diagnosis import own_share

    return own_share(system, run, rows, [(run.t, run.x)])


def _nearly_dependent(system: System, row: int, share: float) -> str:
    return (f"{row_name(system, row)} nearly depends on others: a share of {share:.1g} of it is its own, "
            "and is not met; remove the constraint, or make it differ more")  # fmt: skip


def sharing(contacts: Sequence[str]) -> str:
    """A note on contacts that bear a load in many ways."""
    named = ", ".join([f"`{name}`" for name in contacts])
    return ("contacts bear a load in many ways: the motion is determined, but their forces are one choice of "
            f"many, the smallest: {named}")  # fmt: skip


def redundancy(system: System, trajectory: Trajectory) -> tuple[str, tuple[str, ...]]:
    """A note on the constraints that depend on others in a run, and those with reactions left open."""
    kept = _kept_share(system, trajectory)
    if kept is not None:
        return _nearly_dependent(system, *kept), ()
    from lagc.simulation.diagnosis import open_reactions

    rows = tuple([system.interface.row_labels[k] for k in open_reactions(system, trajectory)])
    named = ", ".join([f"`{label}`" for label in rows])
    return (f"constraints depend on each other: the motion is determined, but the equations leave these "
            f"reactions open, and the run shows one choice of many: {named}"), rows  # fmt: skip
