"""Fixed steps that are too long: they lead to where the motion does not come, or not yet."""

from __future__ import annotations

from collections.abc import Sequence

from lagc.simulation.system import (
    INCONSISTENT,
    MAX_STEPS,
    OK,
    REDUNDANT,
    SINGULAR_MASS,
    Options,
    System,
    Trajectory,
    row_name,
    speed_name,
    state_name,
)
from lagc.simulation.verdict import sound, verdict

PATIENCE = 500  # steps of any length that show what the motion does
CREEPING = 1e-3  # of the mean step: steps so short that it ends there


def overstepped(system: System, step: float, start: Sequence[float], run: Trajectory, stop: float) -> str:
    """What is to be said of a run in fixed steps that failed: where the step that did leads, and what the
    motion does until its end, followed in steps that are chosen; nothing, where it has no rate before."""
    end = min(run.t + step, stop)
    true = system.integrate(Options(rtol=1e-6, max_steps=PATIENCE), 0.0, start, [0.0, end])
    creeps = true.status == MAX_STEPS and abs(true.step) * true.steps < CREEPING * true.t
    shorter = true.status == MAX_STEPS and not creeps and abs(true.step) < step
    told = f"that from t = {run.t:.6g} s leads to where {_fault(system, run)}"
    if true.status in (OK, REDUNDANT) or shorter:
        remedy = "ask for shorter ones, or for an accuracy"
        return f"steps of {step:g} s are too long: {told}, and the motion does not; {remedy}"
    if not sound(system, run):
        return ""
    ending = "the motion comes there, or they are too long"
    if true.status != MAX_STEPS or creeps:
        ending = f"in steps that are chosen, {verdict(system, true, end)[1]}"
    return f"of steps of {step:g} s {told}; {ending}"


def _fault(system: System, run: Trajectory) -> str:
    if run.status == INCONSISTENT:
        return f"{row_name(system, run.culprit)} contradicts others"
    if run.status == SINGULAR_MASS:
        return f"nothing has inertia along {speed_name(system, run.culprit)}"
    return f"{state_name(system, run.culprit)} or its rate is not a finite number"
