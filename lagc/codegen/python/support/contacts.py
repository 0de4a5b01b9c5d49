"""Trajectories of models with contacts, in generated Python modules and in runs of lagc."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from lagc.codegen.python.support.base import Trajectory

if TYPE_CHECKING:
    from lagc.codegen.python.support.generated import NCON, NX

# -- what follows is part of generated modules --

STRIKES, RESTS, CLOSES, OPENS, STICKS, SLIPS = range(1, 7)  # kinds of events of contacts


class ContactTrajectory(Trajectory):
    """A trajectory with what its contacts did, `contacts`: time, contact, kind (STRIKES, RESTS after ever
    shorter bounces, CLOSES, OPENS, STICKS, SLIPS), impulse, loss of energy, and for a rest the time when
    bounces end. `penetration` is the depth beyond a bound of a run that ended there."""

    def __init__(
        self, contacts: Sequence[tuple[float, int, int, float, float, float]] = (), penetration: float = 0.0,
        **values: Any,
    ):  # fmt: skip
        super().__init__(**values)
        self.contacts, self.penetration = contacts, penetration

    def changed(self, **values: Any) -> ContactTrajectory:
        """Return a copy with other values."""
        return ContactTrajectory(**{**vars(self), **values})


def contact_events(state: Any) -> list[tuple[float, int, int, float, float, float]]:
    """Return what contacts did at the last event of a state."""
    return [
        (state.t, i, kind, state.contact_impulses[i], state.contact_losses[i], state.rest_times[i])
        for i, kind in enumerate(state.contact_kinds)
        if kind
    ]


def others_so_far(state: Any) -> int:
    """Return the number of events of contacts so far."""
    return int(state.settlements)


def other_events(state: Any) -> list[Any]:
    return contact_events(state)


def trajectory(state: Any, others: list[Any], **values: Any) -> ContactTrajectory:
    return ContactTrajectory(contacts=others, penetration=state.penetration, **values)


def other_inputs(work: Any) -> dict[str, Any]:
    """Return inputs of the outputs that only such models have."""
    return {"contact_forces": work.contacts.forces}


def is_plain(x: Any) -> Any:
    """Return which of many states have no contact that touches."""
    return (x[:, NX - NCON :] == 0.0).all(axis=1)
