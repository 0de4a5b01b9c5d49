"""The sensitivities of a run, by the code that follows them.

A model with contacts is followed in the modes of its start, as equations, to the first event of a contact.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from lagc.base.records import replace
from lagc.compiler.loaded import Loaded
from lagc.diagnostics.faults import Fault, Refused
from lagc.mechanics.formulation.contacts import MODE_STICKS
from lagc.simulation.linearization.contact_modes import modes_of
from lagc.simulation.request import Request
from lagc.simulation.sensitivity.sensitivities import Direction, directions
from lagc.simulation.sensitivity.verified_sensitivities import sensitivities

if TYPE_CHECKING:
    from lagc.lowering.program import Interface
    from lagc.simulation.solution import Solution

Progress = Callable[[float], None]


def directions_of(loaded: Loaded, names: Sequence[str]) -> tuple[Direction, ...]:
    """Return the directions of these names.  Raises Refused for what has none, before a run."""
    own = loaded.artifact
    return directions(own.interface, names, own.unused, own.built_in)


def add_sensitivities(
    loaded: Loaded, run: Solution, request: Request, parameters: Sequence[float], progress: Progress | None
) -> None:
    """Add the sensitivities of `request` to `run`, which has these parameters and inputs."""
    # Without contacts the motion and its derivatives are those of the model itself.
    own = loaded.artifact
    complete, wanted = request.completed(own.interface.simulate), directions_of(loaded, request.sensitivity)
    if not own.interface.contacts:
        system = loaded.differentiated.model.bind(parameters)
        followed = loaded.sensitive(run.system.backend).bind(parameters)
        sensitivities(system, followed, run, complete, wanted, progress)
        return
    # With contacts the modes of the start are constraints and loads of another model, whose motion is the
    # same until the first contact event.
    modes = modes_of(own.interface, run.states[0])
    _refuse_sliding(own.interface, modes)
    system = loaded.in_contact_modes(modes)
    # Parameters and inputs may reach nothing in these modes: directions by them are zero.
    used = {f.name for f in (*system.interface.parameters, *system.interface.inputs)}
    fields = (*own.unused, *own.interface.parameters, *own.interface.inputs)
    unused = [field for field in fields if field.name not in used]
    wanted = directions(system.interface, request.sensitivity, unused, own.built_in)
    followed = loaded.sensitive(run.system.backend, modes)
    # Values by name, as the other model may have fewer parameters.
    known = _by_name(own.interface, parameters)
    until, reason = _first_event(run)
    count = sum(t < until for t in run.times)
    # The run up to that event, with its sensitivities; later times have none.
    short = replace(run, times=run.times[:count], states=run.states[:count])
    sensitivities(
        system.model.bind(_values(system.interface, known)),
        followed.bind(_values(followed.interface, known)), short, complete, wanted, progress,
    )  # fmt: skip
    found = short.sensitivities
    assert found is not None
    values = np.full((len(run.times), *found.values.shape[1:]), np.nan)
    values[:count] = found.values
    message = "; ".join(filter(None, [found.message if count else "", reason]))
    run.sensitivities = replace(
        found, times=run.times, states=run.states, values=values, message=message, _columns={}, _doubts={}
    )
    if message:
        run.message += f"; sensitivities: {message}"
        run.status = "failed" if run.status == "ok" else run.status
        run.interrupted = run.interrupted or found.interrupted


def _refuse_sliding(interface: Interface, modes: Sequence[int]) -> None:
    """Raise Refused (LAG0623) if a contact slides at the start."""
    for contact, mode in zip(interface.contacts, modes):
        if contact.slips and mode not in (0, MODE_STICKS):
            message = (
                f"sensitivities do not follow contacts that slide yet, as `{contact.name}` does at the start"
            )
            raise Refused([Fault("LAG0623", message, remedy="compare runs with values that differ a little")])


def _first_event(run: Solution) -> tuple[float, str]:
    """Return when a contact does something first, and what: infinite and "" if none does."""
    first = min((e for e in run.events if e.contact), key=lambda event: event.t, default=None)
    if first is None:
        return float("inf"), ""
    return first.t, f"they end at t = {first.t:.6g} s: {first.name}"


def _by_name(interface: Interface, values: Sequence[float]) -> dict[str, float]:
    return {f.name: value for f, value in zip((*interface.parameters, *interface.inputs), values)}


def _values(interface: Interface, known: dict[str, float]) -> list[float]:
    return [known[f.name] for f in (*interface.parameters, *interface.inputs)]
