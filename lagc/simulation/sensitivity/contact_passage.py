"""Sensitivities S of a motion with contacts: from event to event of these, and across them.

The motion is that of the model with contacts. Between two events S follows the model in which the contacts
that touch are equations, from the state after the one to the time of the other.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from math import sqrt

import numpy as np

from lagc.base.records import replace
from lagc.base.text import FINEST
from lagc.codegen.python.support.contacts import SLIPS, STICKS
from lagc.diagnostics.faults import Refused
from lagc.simulation.error_measure import contacts_of
from lagc.simulation.linearization.derivatives import Array, Point
from lagc.simulation.sensitivity.contact_saltation import ContactChanges, ContactEvent
from lagc.simulation.sensitivity.saltation import Stopped
from lagc.simulation.sensitivity.sensitivities import Mode
from lagc.simulation.sensitivity.variational_equations import Followed, Groups, Progress, Tangents, Variation
from lagc.simulation.system import INTERRUPTED, OK, TERMINATED, Options, Trajectory, event_names

ENDS = 0.1  # times the root of the tolerance, of the time of a run: before a stop in space
NEAR = 1e-3  # of the time since the last event: at most

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
        found = Followed(np.full(shape, np.nan), s.sizes, s.sizes, np.zeros(len(times), dtype=int), 0)
        t, x = times[0], x0
        try:
            if run.status == INTERRUPTED:
                raise KeyboardInterrupt
            t, x = self._from(self._changes(run).begun(t, x, self.start), times)
            # To each event, or to shortly before it and then to it by the rates there; and across it.
            for event in self._events(run, times[0]):
                before = self._distance(event, STICKS, ENDS * sqrt(self._tolerance), times)
                s, near = self._between(t, x, event.t - before, s, times, progress, found)
                if found.message:
                    break
                if before > 0.0:
                    s = self._further(event.t - before, x, near, s, before)
                t, x = self._from(event, times)
                s = self._across(replace(event, near=near, begun=x), s, run, found)
            if not found.message:
                s, _ = self._between(t, x, None, s, times, progress, found)
                if run.status not in (OK, TERMINATED):
                    raise Stopped("the repeated motion fails there")
        except Stopped as reason:
            found.message, found.lost = f"at t = {t:.6g} s: {reason}", reason.lost
        except ArithmeticError as error:
            found.message = f"at t = {t:.6g} s: {error}"
        except KeyboardInterrupt:
            found.message, found.interrupted = f"interrupted at t = {t:.6g} s", True
        found.end(self.groups, s)
        return found

    def _between(
        self, t: float, x: Sequence[float], end: float | None, s: Tangents, times: Sequence[float],
        progress: Progress | None, found: Followed,
    ) -> tuple[Tangents, Sequence[float]]:  # fmt: skip
        """Return S and the state at the time `end`, or at the last one, and record S up to there."""
        # A state that is recorded at the time of an event is the one behind it.
        if end is not None and end <= t:
            return s, x
        while found.reached < len(times) and times[found.reached] <= t:
            found.values[found.reached] = s.now.T
            found.reached += 1
        inside = [k for k in range(found.reached, len(times)) if end is None or times[k] < end]
        grid = [t, *(times[k] for k in inside), *([] if end is None else [end])]
        if grid[-1] == t:
            return s, x
        try:
            mode = self.mode_of(x).of(self.kept)
        except Refused as refused:
            raise Stopped(refused.faults[0].message) from None
        most = self.most - found.steps - found.rejected
        along = Variation(mode, s.now.T, self.options, False, most)
        done = along.integrate(x, grid, progress, s)
        # Later records have at least the events so far behind them.
        reached, first = min(done.reached - 1, len(inside)), found.reached
        found.values[first : first + reached] = done.values[1 : 1 + reached]
        found.passed[first : first + len(inside)] += done.passed[1 : 1 + len(inside)]
        found.passed[first + len(inside) :] += done.passed[-1]
        found.reached = first + reached
        found.steps, found.rejected = found.steps + done.steps, found.rejected + done.rejected
        found.message, found.lost, found.interrupted = done.message, done.lost, done.interrupted
        return along.end, along.last

    @property
    def _tolerance(self) -> float:
        return max(self.options.rtol, FINEST)

    def _distance(self, event: ContactEvent, act: int, share: float, times: Sequence[float]) -> float:
        """The time from an event at which a slip in space begins or ends, a share of that of the run: there
        its direction u/|u| is not known well."""
        contacts = self.whole.system.interface.contacts
        if not any(own == act and contacts[i].slips == 2 for i, own in event.acts.items()):
            return 0.0
        return min(share * (times[-1] - times[0]), NEAR * event.since)

    def _from(self, event: ContactEvent, times: Sequence[float]) -> tuple[float, Sequence[float]]:
        """The time and state from which S is followed after an event."""
        after = self._distance(event, SLIPS, self._tolerance, times)
        if not after:
            return event.t, event.after
        return event.t + after, self.whole.followed.integrate(
            self.options, event.t, event.after, [event.t + after]
        ).x

    def _further(
        self, t: float, x: Sequence[float], near: Sequence[float], s: Tangents, time: float
    ) -> Tangents:
        """S after a further time, to first order, in the modes of x."""
        mode = self.mode_of(x).of(self.kept)
        point, (columns, places) = Point(mode.system, t, near), mode.parameters
        rates = point.total("rate", "state") @ s.now.T
        rates[:, columns] += point.total("rate", "parameter")[:, places]
        return s._replace(now=s.now + time * rates.T)

    def _across(self, event: ContactEvent, s: Tangents, run: Trajectory, found: Followed) -> Tangents:
        """Return S after an event."""
        changed, terms, doubts, noise = self._changes(run).beyond(event, s.now.T)
        found.passed[found.reached :] += 1
        return self.groups.changed(s, changed + doubts if self.displaced else changed, terms, noise)

    def _changes(self, run: Trajectory) -> ContactChanges:
        sizes = np.array([run.sizes[kind] for kind in self.whole.system.interface.kinds])
        return ContactChanges(self.whole.of(self.kept), np.where(sizes > 0.0, sizes, 1.0))

    def _events(self, run: Trajectory, begin: float) -> Iterator[ContactEvent]:
        """The events of contacts of a run. Raises Stopped where something else happens at the same time."""
        interface = self.whole.system.interface
        acts: dict[float, dict[int, int]] = {}
        for t, contact, kind, *_ in contacts_of(run):
            acts.setdefault(t, {})[contact] = kind
        last = begin
        for t, own in acts.items():
            states = [x for time, *both in run.corners if time == t for x in both]
            name = interface.contacts[min(own)].name
            if not states:
                raise Stopped(f"events of contacts from here on are not stored: `{name}`")
            for time, k in run.events:
                clause = k - len(interface.relations)
                if time == t and (clause < 0 or interface.whens[clause].states):
                    raise Stopped(f"`{name}` and `{event_names(self.whole.system, k)[0]}` act at one time")
            yield ContactEvent(t, states[0], states[-1], own, t - last)
            last = t
