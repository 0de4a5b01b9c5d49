"""Sensitivities S of a motion with contacts: from event to event of these, and across them.

The motion is that of the model with contacts. Between two events S follows the model in which the contacts
that touch are equations, from the state after the one to the time of the other.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from lagc.diagnostics.faults import Refused
from lagc.simulation.error_measure import contacts_of
from lagc.simulation.linearization.derivatives import Array
from lagc.simulation.sensitivity.contact_saltation import ContactChanges, ContactEvent
from lagc.simulation.sensitivity.saltation import Stopped
from lagc.simulation.sensitivity.sensitivities import Mode
from lagc.simulation.sensitivity.variational_equations import (
    Followed,
    Groups,
    Progress,
    Tangents,
    Variation,
)
from lagc.simulation.system import INTERRUPTED, OK, TERMINATED, Options, Trajectory, event_names

ModeOf = Callable[[Sequence[float]], Mode]


class Passage:
    """The integration of S along a motion with contacts, as `Variation` for one without."""

    def __init__(
        self, whole: Mode, mode_of: ModeOf, kept: Sequence[int], start: Array, options: Options,
        displaced: bool, most: int,
    ):  # fmt: skip
        """`whole` is the model with contacts, `mode_of` returns that of a whole state, `kept` are the
        directions. S is `displaced` by the errors of its changes, so that a comparison shows these."""
        self.whole, self.mode_of, self.kept, self.start = whole, mode_of, list(kept), start
        self.options, self.displaced, self.most = options, displaced, most
        self.groups = Groups(whole.system.interface.kinds)

    def integrate(self, x0: Sequence[float], times: Sequence[float], progress: Progress | None) -> Followed:
        """Integrate the motion from the whole state `x0` again, and S with it."""
        asked = Options(**{**vars(self.options), "report": True})
        run = self.whole.followed.integrate(asked, times[0], x0, times, progress)
        s, shape = self.groups.begun(self.start), (len(times), *self.start.shape)
        found = Followed(np.full(shape, np.nan), s.sizes, s.sizes, np.zeros(len(times), dtype=int), 1)
        found.values[0] = self.start
        t, x = times[0], x0
        try:
            if run.status == INTERRUPTED:
                raise KeyboardInterrupt
            for event in self._events(run, times[0]):
                s = self._between(t, x, event.t, s, times, progress, found)
                if found.message:
                    break
                t, x = event.t, event.after
                s = self._across(event, s, run, found)
                for k in range(found.reached, len(times)):  # recorded is what is behind an event
                    if times[k] > t:
                        break
                    found.values[k], found.reached = s.now.T, k + 1
            if not found.message:
                s = self._between(t, x, None, s, times, progress, found)
                if run.status not in (OK, TERMINATED):
                    raise Stopped("the repeated motion fails there")
        except Stopped as reason:
            found.message, found.lost = f"at t = {t:.6g} s: {reason}", reason.lost
        except KeyboardInterrupt:
            found.message, found.interrupted = f"interrupted at t = {t:.6g} s", True
        found.end(self.groups, s)
        return found

    def _between(
        self, t: float, x: Sequence[float], end: float | None, s: Tangents, times: Sequence[float],
        progress: Progress | None, found: Followed,
    ) -> Tangents:  # fmt: skip
        """Return S at the time `end` of the next event, or at the last one, and record it before."""
        inside = [k for k in range(found.reached, len(times)) if end is None or times[k] < end]
        grid = [t, *(times[k] for k in inside), *([] if end is None else [end])]
        if grid[-1] <= t:
            return s
        try:
            mode = self.mode_of(x)
        except Refused as refused:
            raise Stopped(refused.faults[0].message) from None
        own, most = [mode.directions[k] for k in self.kept], self.most - found.steps - found.rejected
        along = Variation(mode.system, mode.followed, own, s.now.T, self.options, False, most)
        done = along.integrate(x, grid, progress, s)
        # Later records have at least the events so far behind them.
        reached, first = min(done.reached - 1, len(inside)), found.reached
        found.values[first : first + reached] = done.values[1 : 1 + reached]
        found.passed[first : first + len(inside)] += done.passed[1 : 1 + len(inside)]
        found.passed[first + len(inside) :] += done.passed[-1]
        found.reached = first + reached
        found.steps, found.rejected = found.steps + done.steps, found.rejected + done.rejected
        found.message, found.lost, found.interrupted = done.message, done.lost, done.interrupted
        return along.end

    def _across(self, event: ContactEvent, s: Tangents, run: Trajectory, found: Followed) -> Tangents:
        """Return S after an event."""
        system, names = self.whole.system, [c.name for c in self.whole.system.interface.contacts]
        n = len(self.start)
        for t, k in run.events:
            clause = k - len(system.interface.relations)
            if t == event.t and (clause < 0 or system.interface.whens[clause].states):
                other = event_names(system, k)[0]
                raise Stopped(f"`{names[min(event.acts)]}` and `{other}` happen at one time")
        sizes = np.array([run.sizes[kind] for kind in system.interface.kinds])
        own = [self.whole.directions[k] for k in self.kept]
        changes = ContactChanges(system, own, np.where(sizes > 0.0, sizes, 1.0)[:n])
        changed, terms, doubts = changes.beyond(event, s.now.T)
        found.passed[found.reached :] += 1
        return self.groups.changed(s, changed + doubts if self.displaced else changed, terms)

    def _events(self, run: Trajectory, begin: float) -> Iterator[ContactEvent]:
        """The events of contacts of a run."""
        acts: dict[float, dict[int, int]] = {}
        for t, contact, kind, *_ in contacts_of(run):
            acts.setdefault(t, {})[contact] = kind
        last = begin
        for t, own in acts.items():
            states = [x for time, *both in run.corners if time == t for x in both]
            name = self.whole.system.interface.contacts[min(own)].name
            if t == begin:
                raise Stopped(f"`{name}` acts at the start")
            if not states:
                raise Stopped(f"no more events are followed: `{name}`")
            yield ContactEvent(t, states[0], states[-1], own, t - last)
            last = t
