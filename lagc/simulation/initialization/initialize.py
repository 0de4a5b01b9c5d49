"""Find consistent initial conditions, and check that they determine the motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf, isfinite
from time import perf_counter
from typing import Any

from lagc.base.records import replace
from lagc.diagnostics.faults import Fault, Refused
from lagc.host.budgets import doing
from lagc.lowering.program import Contact
from lagc.simulation.initialization.result import Anchor, Start, unmet_lines
from lagc.simulation.request import Request, keep_limits
from lagc.simulation.system import (
    FAILED,
    INCONSISTENT,
    RUN,
    SINGULAR_MASS,
    UNSTATED,
    System,
    Trajectory,
    contradicting,
    contradiction,
    idle_actuator,
    more,
    speed_name,
    state_name,
)

PENETRATION = 1e-9  # of the size of a gap: a start that is beyond the bound by more is refused
PART = 1e-6  # of a coordinate, by which it is moved to see how gaps change
TOUCHES = 1e-13  # of the same: round-off of a gap
MOST_NAMED = 12  # conditions of a conflict


class NoStart(Refused):
    """There is no initial state. `anchors` are the parts of the model in the conflict, `x` is the state, `p`
    the parameters and inputs by name; `source_spans` finds their places in the text."""

    def __init__(self, fault: Fault, anchors: Sequence[Anchor], x: Sequence[float], system: System):
        super().__init__([fault])
        interface = system.interface
        self.anchors = tuple(anchors)
        self.x = dict(zip(system.interface.state_names, x))
        self.p = dict(zip([f.name for f in (*interface.parameters, *interface.inputs)], system.parameters))

    def __reduce__(self) -> tuple[Any, ...]:
        return Refused, (self.faults,)


def begin(system: System, request: Request) -> Start:
    """Return the consistent start. Raises NoStart with the conditions that cannot be met (LAG0610) or the
    start value that is not finite (LAG0611), and as `_energies` and `with_contact_modes`."""
    keep_limits(system)
    doing("finding the start")
    began = perf_counter()
    start = consistent_start(system, 0.0, request.starts, request.guesses)
    if start.unmet:
        anchors = [*(m.anchor for m in start.unmet), *start.anchors]
        raise NoStart(_conflict(start), anchors, start.x, system)
    for i, value in enumerate(start.x):
        if not isfinite(value):
            fault = Fault("LAG0611", f"the start value of {state_name(system, i)} is not a finite number")
            anchors = [("start", name) for name in system.interface.state_names[i : i + 1]]
            raise NoStart(fault, anchors, start.x, system)
    _energies(system, start.x)
    if system.interface.contacts:
        start = replace(start, x=with_contact_modes(system, 0.0, start.x), beyond=_beyond(system, start.x))
    return replace(start, seconds=perf_counter() - began)


def sizes_of_gaps(system: System, t: float, x: Sequence[float]) -> list[float]:
    """Return the size of each gap: the sum of its changes with each coordinate and speed, times this one, or
    else the size of the parameters of its unit."""
    gaps = system.gaps(t, x)
    found = [0.0] * len(gaps)
    for k in range(system.nq + system.nv):
        if x[k] != 0.0:
            moved = [*x[:k], x[k] * (1.0 + PART), *x[k + 1 :]]
            found = [size + abs(a - b) / PART for size, a, b in zip(found, system.gaps(t, moved), gaps)]
    fields = (*system.interface.parameters, *system.interface.inputs)
    for i, contact in enumerate(system.interface.contacts):
        if not found[i] > 0.0:
            values = [abs(v) for f, v in zip(fields, system.parameters) if f.unit == contact.unit]
            found[i] = max(values, default=0.0)
    return found


def with_contact_modes(system: System, t: float, x: Sequence[float]) -> list[float]:
    """Return x with the modes of the contacts that touch. Raises NoStart (LAG0624) if a gap is negative by
    more than round-off."""
    interface, found = system.interface, list(x)
    first = system.nx - len(interface.contacts)
    sizes = sizes_of_gaps(system, t, x)
    for i, (contact, gap, size) in enumerate(zip(interface.contacts, system.gaps(t, x), sizes)):
        if gap < -PENETRATION * size:
            message = f"the start is {_depth(contact, gap)}"
            fault = Fault("LAG0624", message, remedy="begin with a gap that is zero or positive")
            raise NoStart(fault, [("contact", contact.name)], x, system)
        found[first + i] = 1.0 if gap <= TOUCHES * size else 0.0
    return found


def _beyond(system: System, x: Sequence[float]) -> tuple[str, ...]:
    """Return a line for each bound that a start is beyond by more than round-off: it is put on the bound."""
    sizes = sizes_of_gaps(system, 0.0, x)
    given = zip(system.interface.contacts, system.gaps(0.0, x), sizes)
    return tuple([
        f"the start is {_depth(contact, gap)}, and is put on it"
        for contact, gap, size in given if gap < -TOUCHES * size
    ])  # fmt: skip


def _depth(contact: Contact, gap: float) -> str:
    return f"{f'{-gap:.6g} {contact.unit}'.rstrip()} beyond the bound `{contact.name}`"


def _energies(system: System, x: Sequence[float]) -> None:
    """Raise NoStart if an energy has no finite value (LAG0613) or a kinetic energy is negative (LAG0615)."""
    for name, value in zip(("kinetic", "potential", "total"), system.energies(0.0, x)):
        if not isfinite(value):
            fault = Fault("LAG0613", f"the {name} energy is not a finite number at the start")
            raise NoStart(fault, (), x, system)
    if system.interface.doubtful:
        from lagc.simulation.initialization.inertia_check import negative_speed  # where it is asked

        k = negative_speed(system, 0.0, x)
        if k is not None:
            message = f"the kinetic energy of motions along {speed_name(system, k)} is negative at the start"
            raise NoStart(Fault("LAG0615", message), [("speed", system.interface.v_names[k])], x, system)


def strange_outputs(system: System, x: Sequence[float]) -> list[int]:
    """The outputs, by index, that have no finite value at the start."""
    return [k for k, value in enumerate(system.outputs(0.0, x)) if not isfinite(value)]


def consistent_start(
    system: System,
    t: float = 0.0,
    given: Mapping[str, float] | None = None,
    guesses: Mapping[str, float] | None = None,
) -> Start:
    """Return the start of `system` at time `t`. The values of `given` (by name) count as stated by the run,
    those of `guesses` as not stated; both replace those of the model."""
    guess, levels = guess_and_levels(system, system.start(), given or {}, guesses or {})
    if not system.interface.needs_consistency:
        return Start(guess)
    from lagc.simulation.initialization.conflicts import search  # where there is something to search for

    return search(system, t, guess, levels)


def guess_and_levels(
    system: System, start: Sequence[float], given: Mapping[str, float], guesses: Mapping[str, float]
) -> tuple[list[float], list[int]]:
    """Return the guess of each state and the level of each unknown; the four parts of an orientation have one
    level."""
    guess, levels = list(start), list(system.interface.start_levels)
    for i, name in enumerate(system.interface.state_names):
        if name in given:
            guess[i], levels[i] = given[name], max(levels[i], RUN)
        elif name in guesses:
            guess[i] = guesses[name]
            whole = next((k for k in system.quaternions if k <= i < k + 4), None)
            for k in (i,) if whole is None else range(whole, whole + 4):
                levels[k] = UNSTATED
    interface = system.interface
    for i, variable in enumerate(interface.discretes, system.nx - len(interface.discretes)):
        guess[i] = given.get(variable.name, guess[i])
    return guess, levels


def demand(system: System, run: Trajectory) -> None:
    """Raises NoStart where the motion is not determined at the start of `run`: not even a step was tried."""
    failed = run.status in FAILED or idle_actuator(system, run.status, run.culprit)
    if failed and run.steps == run.rejected == 0:
        raise undetermined(system, run.status, run.culprit, run.x)


def undetermined(system: System, status: int, k: int, x: Sequence[float]) -> NoStart:
    """Explain the status of the equations at the start, one of FAILED or that of an actuator that cannot hold
    its constraint; k is its culprit."""
    interface = system.interface
    idle = idle_actuator(system, status, k)
    if idle is not None:
        message = (
            f"`{idle[1]}` cannot hold the constraint `{idle[0]}` at the start: it does not change the "
            "acceleration of the constraint there, or several actuators do so alike"
        )
        remedy = "let an actuator hold a quantity that it accelerates, or begin in another configuration"
        fault, anchors = Fault("LAG0625", message, remedy=remedy), [("row", idle[0])]
    elif status == SINGULAR_MASS:
        if not 0 <= k < system.nv:
            from lagc.simulation.initialization.inertia_check import weightless_speed  # where it is asked

            k = weightless_speed(system, 0.0, x)
        message = (
            f"the mass matrix is singular at the start: nothing has inertia along {speed_name(system, k)}"
        )
        fault, anchors = Fault("LAG0612", message), [("speed", name) for name in interface.v_names[k : k + 1]]
    elif status == INCONSISTENT:
        rows = contradicting(system, 0.0, x, k)
        message = contradiction(system, rows, " at the start")
        remedy = "remove or change one of them, or begin in another configuration"
        fault = Fault("LAG0614", message, remedy=remedy)
        anchors = [("row", interface.row_labels[i]) for i in rows]
    else:
        message = f"the rate of {state_name(system, k)} is not a finite number at the start"
        fault = Fault("LAG0613", message)
        anchors = [("state", name) for name in system.interface.state_names[k : k + 1]]
    return NoStart(fault, anchors, x, system)


def _conflict(start: Start) -> Fault:
    unmet, held = unmet_lines(start.unmet), list(start.held)
    named = f"{'; '.join(unmet[:MOST_NAMED])}{more(unmet, MOST_NAMED)}"
    alone = len(start.unmet) == 1
    what = "this condition" if alone else "these conditions together"
    message = f"no initial state was found that meets {what}: {named}"
    if held:
        verb = "is" if len(held) == 1 else "are"
        message += f", where {', '.join(held[:MOST_NAMED])}{more(held, MOST_NAMED)} {verb} held fixed"
    remedy = (
        f"remove or change {'it' if alone else 'one of them'}, or state initial values closer to a solution"
    )
    if any(not abs(one.amount) < inf for one in start.unmet):
        remedy = "state other values: where they are zero `norm` and `sqrt` have no slope, `log` no value"
    if held:
        remedy = f"do not fix {' or '.join(held[:MOST_NAMED])}"
    return Fault("LAG0610", message, remedy=remedy)
