"""The events of a run, read from the state of the kernels after each of them."""

from __future__ import annotations

from typing import Any

from lagc.codegen.python.support.base import MOST_CORNERS, MOST_EVENTS
from lagc.codegen.python.support.contacts import contact_events
from lagc.lowering.program import Interface


class EventLog:
    """The events of one trajectory; `state` is that of the kernels, in C or in Python. It is `open` for more
    if events are to be reported and there are not too many."""

    def __init__(self, interface: Interface, state: Any, report: bool):
        self.report = report and bool(interface.relations)
        self.relations, self.whens = len(interface.relations), len(interface.whens)
        self.noted, self.touching, self.state = interface.noted, bool(interface.contacts), state
        self.begin()

    def begin(self) -> None:
        """Forget the events: the trajectory begins again."""
        self.open = self.report
        self.events: list[tuple[float, int]] = []
        self.jumps: list[float] = []
        self.corners: list[tuple[float, list[float], list[float]]] = []
        self.contacts: list[tuple[float, int, int, float, float, float]] = []

    def seen(self) -> tuple[int, int]:
        """The numbers of events, and of impacts, before a call."""
        return (self.state.changes if self.relations else 0, self.state.settlements if self.touching else 0)

    def add(self, seen: tuple[int, int]) -> None:
        """Add the event of a call, if there was one."""
        state = self.state
        if not self.open or state.changes == seen[0]:
            return
        settled = self.touching and state.settlements > seen[1]
        self.events.extend((state.t, k) for k in self.noted if state.changed[k])
        if len(self.corners) < MOST_CORNERS:
            x = state.x[:]
            jumped = settled or (self.whens and state.jumps > len(self.jumps))
            self.corners.append((state.t, state.x_before_event[:] if jumped else x, x))
        if self.whens:
            self.events.extend((state.t, self.relations + k) for k in state.acted[: state.acts])
            self.jumps.extend([state.t] * (state.jumps - len(self.jumps)))
        if settled:
            self.contacts.extend(contact_events(state))
        self.open = max(len(self.events), len(self.contacts)) < MOST_EVENTS

    def known(self) -> dict[str, Any]:
        """The events as arguments of a trajectory."""
        found: dict[str, Any] = {"events": self.events, "jumps": self.jumps, "corners": self.corners}
        if self.touching:
            found.update(contacts=self.contacts, penetration=self.state.penetration)
        return found
