"""What is said of a run: whether it is good, and else what was found, where and why."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from sys import float_info
from typing import TYPE_CHECKING

from lagc.base.records import dataclass
from lagc.base.text import FINEST
from lagc.host.budgets import reached
from lagc.simulation.global_error.verified_run import MEANINGLESS, Verified
from lagc.simulation.system import (
    CHATTERING,
    INCONSISTENT,
    INTERRUPTED,
    MAX_STEPS,
    MISPLACED,
    NOT_FINITE,
    OK,
    REDUNDANT,
    SINGULAR_MASS,
    STEP_UNDERFLOW,
    TERMINATED,
    System,
    Trajectory,
    event_names,
    more,
    row_name,
    speed_name,
    state_name,
)

if TYPE_CHECKING:
    from lagc.lowering.program import Clause
    from lagc.simulation.global_error.energy_balance import Balance

SHORTEST = 2.3e-308  # s: smaller numbers have fewer digits
STEPS = 1e38  # that no run takes: an integration whose first step is that short gives up
SEVERAL = 10
LAST = 100.0 * float_info.epsilon  # relative: of less than that hardly any motion is told by doubles
MOST_NAMED = 4  # of a kind, in a message
UNKNOWN = "the cause is not known"


@dataclass(frozen=True, slots=True)
class Verdict:
    """`status` "ok", "terminated" or "failed"; the trajectory to return, which may be a part of what was
    computed, and the estimate of its error."""

    status: str
    message: str
    trajectory: Trajectory
    estimated: float | None


def judge(system: System, found: Verified, asked: float, stop: float) -> Verdict:
    """Of a run that was to meet the accuracy `asked`."""
    run, estimated = found.trajectory, found.estimated
    status, message = verdict(system, run, stop)
    if status == "failed":
        return Verdict(status, message, run, estimated)
    kept = _kept(system, run)
    if kept is not None:
        return Verdict("failed", _nearly(system, *kept), run, inf)  # what runs share is no estimate
    if estimated > asked:
        told = _missed(system, found, asked)
        if found.failed is not None:
            message = f"{told.message}; with a finer tolerance, {verdict(system, found.failed, stop)[1]}"
            return Verdict(told.status, message, told.trajectory, told.estimated)
        return told
    if found.balance is not None and not found.balance.holds:
        return Verdict("failed", _unbalanced(system, run, found.balance, asked), run, estimated)
    return Verdict(status, message, run, estimated)


def verdict(system: System, trajectory: Trajectory, stop: float) -> tuple[str, str]:
    """("ok", "terminated" or "failed", what happened, by name and time)."""
    status, t = trajectory.status, f"t = {trajectory.t:.6g} s"
    k = trajectory.culprit
    if status in (OK, REDUNDANT):
        return "ok", f"reached {t}"
    if status == INTERRUPTED:
        limit = reached()
        return "failed", f"interrupted at {t}" + (f": it took longer than {limit}" if limit else "")
    if status == TERMINATED:
        return "terminated", f"at {t}: {system.interface.whens[k].reason}"
    if status == MISPLACED:
        clause = system.interface.whens[k]
        return "failed", (f"at {t} the new values that `when {clause.words}` gives are not finite, or do not "
                          f"meet the constraints{_left_out(system, clause)}")  # fmt: skip
    if (status == CHATTERING and not system.interface.drives(k)) or _ever_sooner(trajectory):
        k = k if status == CHATTERING else trajectory.events[-1][1]
        what = event_names(system, k)[0]
        return "failed", (f"at {t} it comes to `{what}` again and again, within the last places of the time, "
                          "as bounces that are ever shorter do: end the run before, by a `when` with "
                          "`terminate`, and go on with what holds it there as a constraint")  # fmt: skip
    if status == CHATTERING:
        what = system.interface.switches[k]
        return "failed", (f"at {t} {what}, and what acts on either side drives it back, without end: a "
                          "force that jumps there would hold it, as dry friction does what sticks; a smooth "
                          "law, as tanh(v/v0) for sign(v), lets it pass")  # fmt: skip
    if status == SINGULAR_MASS:
        return (
            "failed",
            f"at {t} the mass matrix is singular: nothing has inertia along {speed_name(system, k)}",
        )
    if status == INCONSISTENT:
        from lagc.simulation.diagnosis.cause import bent

        own = _own_share(system, trajectory, [k])
        if own is not None:
            return "failed", f"at {t} {_nearly(system, *own)}"
        why = bent(system, trajectory, trajectory.t, trajectory.x)
        return "failed", f"at {t} {why or f'the constraints contradict each other: {row_name(system, k)}'}"
    if status != MAX_STEPS and trajectory.steps == 0 and 0.0 < stop < SHORTEST:
        return "failed", f"numbers are too coarse for a run of {stop:g} s: ask for a longer one"
    if status == NOT_FINITE and trajectory.steps == 0 and sound(system, trajectory):
        return "failed", f"the first steps towards {stop:g} s lead beyond all numbers: ask for a shorter run"
    if status == NOT_FINITE:
        when = f"after {t}" if trajectory.steps else "at the start"
        return "failed", f"{when} {state_name(system, k)} or its rate is not a finite number"
    from lagc.simulation.diagnosis.cause import cause  # where something failed

    if status == STEP_UNDERFLOW and trajectory.steps == trajectory.rejected == 0:
        much = f"the run to {stop:g} s would take more than {STEPS:g} steps"
        return "failed", f"{much}: ask for a shorter one, or longer steps"
    own = _own_share(system, trajectory, trajectory.redundant_rows)
    why = cause(system, trajectory, trajectory.t, trajectory.x) or UNKNOWN
    if own is not None:
        why = _nearly(system, *own)
    if status == STEP_UNDERFLOW:
        return "failed", f"at {t} the step became too small: {why}"
    if status == MAX_STEPS:
        tried = trajectory.steps + trajectory.rejected
        size = abs(trajectory.step)
        return "failed", (f"at {t}, after {tried} steps, the rest to {stop:g} s would take too many: they "
                          f"are {size:.1g} s long; {why}")  # fmt: skip
    return "failed", f"the integration ended at {t} with status {status}"


def _left_out(system: System, clause: Clause) -> str:
    """What constraints tie to the values that a clause gives, and it does not."""
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
    return f": it leaves {shown} as before, which {by} may tie to them"


def _ever_sooner(run: Trajectory) -> bool:
    """Whether a run of too many steps ended among jumps that no more than a step of it lies between."""
    last = run.jumps[-SEVERAL:]
    near = len(last) == SEVERAL and abs(run.t - last[0]) <= SEVERAL * SEVERAL * abs(run.step)
    return near and run.status in (MAX_STEPS, STEP_UNDERFLOW)


def sound(system: System, trajectory: Trajectory) -> bool:
    """Whether the motion has a rate where the run ended."""
    return system.rhs(trajectory.t, trajectory.x, [0.0] * system.nx, [0.0] * system.nc) in (OK, REDUNDANT)


def _missed(system: System, found: Verified, asked: float) -> Verdict:
    """What is said and returned where the accuracy asked was not reached, and its error.

    Where the end of the motion is known to less than a hundredth, no point of it beyond the
    horizon is an answer, and none is given.
    """
    run, estimated, horizon = found.trajectory, found.estimated, found.horizon
    if estimated < MEANINGLESS or horizon is None or found.beside is None:
        until = (
            f"; it is met until t = {horizon:.6g} s" if horizon is not None and horizon > run.times[0] else ""
        )
        if found.rounding > min(asked, 0.5 * estimated):
            why = f"rounding moves the motion by up to {found.rounding:.2g}, as {_why_rounding(found, asked)}"
        elif found.options.rtol <= 10.0 * FINEST:
            why = f"the best is estimated at {estimated:.2g}, at the finest tolerance"
        else:
            message = (
                f"the accuracy {asked:g} was not reached: the best is estimated at {estimated:.2g}{until}"
            )
            return Verdict("failed", message, run, estimated)
        if not until:
            until = f"; {estimated:.0e} or so can be, and more by the code of `lagc build --real quad`"
        message = f"the accuracy {asked:g} cannot be assured in double precision here: {why}{until}"
        return Verdict("failed", message, run, estimated)
    from lagc.simulation.diagnosis.cause import cause, growth

    kept = sum(1 for t in run.times if t <= horizon)
    times, states = run.times[:kept], run.states[:kept]
    tenfold, beyond = growth(system, run, found.beside, horizon), "runs of different tolerance part"
    if tenfold is not None:
        beyond += f"; differences grow tenfold every {tenfold:.2g} s (it is chaotic, or unstable)"
    elif found.rounding > 0.5 * estimated:
        beyond = f"rounding moves it by up to {found.rounding:.2g}, as {_why_rounding(found, asked)}"
    else:
        beyond += f"; {cause(system, run, run.times[kept - 1], run.states[kept - 1]) or UNKNOWN}"
    message = f"the motion can be foretold to {asked:g} until t = {horizon:.6g} s only: beyond it, {beyond}"
    events, corners = ([e for e in own if e[0] <= times[-1]] for own in (run.events, run.corners))
    cut = run.changed(times=times, states=states, t=times[-1], x=states[-1], events=events, corners=corners)
    return Verdict("failed", message, cut, asked)


def _why_rounding(found: Verified, asked: float) -> str:
    if found.rounding > 10.0 * found.drift:
        return f"differences grow {found.rounding / found.drift:.1g} times"
    if asked < LAST:
        return "doubles have 16 digits"
    return "the equations are ill-conditioned, or the motion is long"


def _unbalanced(system: System, run: Trajectory, out: Balance, asked: float) -> str:
    from lagc.simulation.global_error.energy_balance import leap

    found, why = leap(system, run), UNKNOWN
    if found is not None:
        why = f"the energy of the states changes by {found[1]:.3g} J at once at t = {found[0]:.6g} s"
    return (f"at t = {out.t:.6g} s the energy is out of balance by {out.imbalance:.2g} J, where errors of "
            f"{asked:g} in the states explain {out.explained:.2g} J at most: the motion is wrong, though "
            f"runs of different tolerance agree; {why}")  # fmt: skip


def _kept(system: System, run: Trajectory) -> tuple[int, float] | None:
    """`kept_share`, where a row was left out."""
    if not run.redundant_rows:
        return None
    from lagc.simulation.diagnosis.row_dependence import kept_share

    return kept_share(system, run)


def _own_share(system: System, run: Trajectory, rows: Sequence[int]) -> tuple[int, float] | None:
    """Of `rows`, one with a small share of its own where the run ended, and that share."""
    if min(rows, default=-1) < 0 or len(run.x) < system.nx:
        return None
    from lagc.simulation.diagnosis.row_dependence import own_share

    return own_share(system, run, rows, [(run.t, run.x)])


def _nearly(system: System, row: int, share: float) -> str:
    return (f"{row_name(system, row)} all but depends on others: a share of {share:.1g} of it is its own, "
            "and what that demands is not met; leave it out, or make it differ more")  # fmt: skip


def redundancy(system: System, trajectory: Trajectory) -> str:
    """A note on rows that were found to depend on others."""
    kept = _kept(system, trajectory)
    if kept is not None:
        return _nearly(system, *kept)
    from lagc.simulation.diagnosis.row_dependence import spare_rows

    spare = spare_rows(system, trajectory)
    rows, several = ", ".join(row_name(system, k) for k in spare), len(spare) > 1
    return (f"{rows} {'depend' if several else 'depends'} on other constraints: the motion is determined, "
            "the multipliers are the smallest ones possible")  # fmt: skip
