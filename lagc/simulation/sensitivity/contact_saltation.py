"""The change of the sensitivities S of a motion where contacts act.

A gap closes, a force falls to zero, a slip ends, static friction no longer holds: each has an indicator g
that is zero at the event, whose time changes by dt = -(g_x S + g_theta)/(g_x f- + g_t).  The state before the
event changes by S + f- dt, that after it by S+ + f+ dt.  Without an impact both are the same.  An impact maps
the one on the other, x+ = R(x, theta, t), as long as the same contacts slip, stick and leave.
(R. I. Leine, H. Nijmeijer, Dynamics and Bifurcations of Non-Smooth Mechanical Systems, 2004, chapter 7.)

R is what contacts do in a run, the kernel `settle`.  R and g are differentiated by extrapolated differences.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import hypot, inf
from typing import Any

import numpy as np

from lagc.base.records import dataclass
from lagc.codegen.python.support.contacts import CLOSES, RESTS, SLIPS, STICKS, STRIKES
from lagc.mechanics.formulation.contacts import MODE_STICKS
from lagc.simulation.linearization.derivatives import TINY, Array
from lagc.simulation.sensitivity.differences import derivative_by_differences, size_of
from lagc.simulation.sensitivity.saltation import ALIKE, LOCATED, Stopped, common_shift
from lagc.simulation.sensitivity.sensitivities import CLEAR, Mode
from lagc.simulation.system import OK, REDUNDANT, Options

FARTHEST = (1e-2, 1e-3, 1e-4, 1e-6)  # of the sizes of states and parameter: displacements that are tried
DIFFERENCES = 5
NEAR = 1e-6  # of the size of a state: the displacement that shows the terms of an indicator
ROUNDED = 1e-13  # of the size of a state: round-off of the map of an impact, over its displacement
SAMPLED = 1e-2  # of the time since the last event: distance of the zero of a force from its event
SURE = 1e-9  # of the terms of a change: its error after which no shorter displacements are tried
EDGE = "the smallest change decides what contacts do"
TOUCHES, RELEASES, STOPS, BEGINS = "touches", "is released", "stops slipping", "slips"


@dataclass(frozen=True)
class ContactEvent:
    """An event at the time t: the acts of contacts by their indices, the whole states before and after it,
    and the time since the event before. `last_slip` and `first_slip` are states shortly before and
    after: a slip in space that ends or begins has the directions there."""

    t: float
    before: Sequence[float]
    after: Sequence[float]
    acts: Mapping[int, int]
    since: float
    last_slip: Sequence[float] = ()
    first_slip: Sequence[float] = ()


class ContactChanges:
    """The changes of S at events of contacts. `whole` is the model with contacts, `sizes` are the magnitudes
    of its states in the run."""

    def __init__(self, whole: Mode, sizes: Array):
        self.system, self.directions, self.sizes = whole.system, whole.directions, sizes
        self.module, self.n = whole.system.model.module, len(sizes)

    def cross(self, event: ContactEvent, now: Array) -> tuple[Array, Array, Array, Array]:
        """Return S after an event, the magnitudes of its terms, its error and its round-off. `now` is S
        before it. Raises Stopped if there is no derivative."""
        one = self._rates(event, event.before, event.last_slip)
        two = self._rates(event, event.after, event.first_slip)
        shift = self._shift(event, now, one)
        moved, doubts = now + np.outer(one, shift), np.zeros_like(now)
        units = [self._unit(k, moved[:, k]) for k in range(len(shift))]
        noise = ROUNDED * np.outer(self.sizes, 1.0 / np.array(units))
        terms = np.abs(now) + np.abs(np.outer(one, shift)) + np.abs(np.outer(two, shift))
        if {STRIKES, RESTS} & {*event.acts.values()}:
            settled = self._settled_by(event)
            for k in range(len(shift)):
                moved[:, k], doubts[:, k] = self._slope(event, k, moved[:, k], shift[k], settled)
        found = moved - np.outer(two, shift)
        # A direction on which the motion does not depend, as by a mass, stays without effect.
        idle = ~now.any(axis=0) & (np.abs(found) <= CLEAR * noise).all(axis=0)
        for array in (found, terms, doubts, noise):
            array[:, idle] = 0.0
        return found, terms, doubts, noise

    def initial_slips(self, t: float, x: Sequence[float], now: Array) -> ContactEvent:
        """Return the slips that begin at the initial state x, as an event. Raises Stopped if a direction
        gives them a speed: friction is opposite on both sides."""
        contacts, module = self.system.interface.contacts, self.module
        here, first = np.array(self.system.indicators(t, x)), len(x) - len(contacts)
        rows = {
            i: [module["slip_relation"](i) + k for k in range(contact.slips)]
            for i, contact in enumerate(contacts)
            if contact.slips and x[first + i] not in (0.0, MODE_STICKS)
        }
        acts = {
            i: SLIPS for i, own in rows.items() if (np.abs(here[own]) <= ROUNDED * self.sizes.max()).all()
        }
        event = ContactEvent(t, x, x, acts, inf)

        def slips(equations: Any, t: float, x: list[float]) -> Array:
            found = [0.0] * len(here)
            modes = self.system.modes(event.t, event.before)
            module["fn_indicators_on"](equations.p, t, x, modes, found)
            return np.array(found)[[row for i in acts for row in rows[i]]]

        moved = [self._slope(event, k, now[:, k], 0.0, slips)[0] for k in range(now.shape[1] if acts else 0)]
        lost = [k for k, own in enumerate(moved) if (np.abs(own) > ALIKE * np.abs(now[:, k]).max()).any()]
        if lost:
            name = contacts[min(acts)].name
            raise Stopped(f"`{name}` begins to slip: the derivatives differ on both sides", lost)
        return event

    def _rates(self, event: ContactEvent, x: Sequence[float], beside: Sequence[float]) -> Array:
        equations, rates = self._placed(self.system.equations(), event, x, beside), [0.0] * self.system.nx
        lam = [0.0] * self.system.nc
        status = self.module["rates_at"](equations.p, event.t, list(x), rates, lam, equations.work)
        if status not in (OK, REDUNDANT):
            raise Stopped("the motion is not determined")
        return np.array(rates[: self.n])

    def _placed(
        self, equations: Any, event: ContactEvent, x: Sequence[float], beside: Sequence[float]
    ) -> Any:
        """Set the modes of relations to those of the state x, and the directions of slips in space that end
        or begin to those of the state `beside`."""
        work, contacts = equations.work, self.system.interface.contacts
        work.modes[:], work.modes_fixed = self.system.modes(event.t, x), True
        for i, act in event.acts.items():
            if contacts[i].slips == 2 and act in (STICKS, SLIPS):
                first = self.module["slip_relation"](i)
                slip = self.system.indicators(event.t, [*beside, *x[len(beside) :]])[first : first + 2]
                length = hypot(*slip) or 1.0
                work.contacts.slip_axes[2 * i : 2 * i + 2] = [part / length for part in slip]
                work.contacts.slip_roundoff[i] = inf
        return equations

    def _shift(self, event: ContactEvent, now: Array, rates: Array) -> Array:
        """The change of the time of an event by directions."""
        watched = self._watched(event)
        places = [place for _, place, _ in watched]

        def values(equations: Any, t: float, x: list[float]) -> Array:
            return self._indicators(equations, t, x, event)[places]

        here = values(self.system.equations(), event.t, list(event.before))
        speed, _ = self._slope(event, None, rates, 1.0, values)
        # Only those at zero are causes; others follow them, as one that an impact opens. A force is located
        # less well, on the dense output of a step.
        away = np.abs(here) / np.maximum(np.abs(speed), TINY)
        causes = [j for j, (*_, sure) in enumerate(watched) if sure or away[j] <= LOCATED * event.since]
        if not causes and away.min() <= SAMPLED * event.since:
            causes = [int(away.argmin())]
        slopes = [self._slope(event, k, now[:, k], 0.0, values)[0] for k in range(now.shape[1])]
        by_x = np.array([self._near(event, i, values) for i in range(self.n)]).T
        terms, sizes = np.abs(by_x) @ np.abs(rates), np.abs(by_x) @ np.abs(now)
        moved = np.array(slopes).T
        sizes += np.abs(moved)
        own = [(watched[j][0], float(speed[j]), float(terms[j]), moved[j], sizes[j]) for j in causes]
        return common_shift(own)

    def _watched(self, event: ContactEvent) -> list[tuple[str, int, bool]]:
        """The causes that the contacts which acted may have had: the name of each, the relation of its
        indicator, and whether it is known to be one."""
        module, contacts, found = self.module, self.system.interface.contacts, list[tuple[str, int, bool]]()
        first = module["NMODE"] - module["NCON"]
        for i, act in event.acts.items():
            mode, name = event.before[len(event.before) - len(contacts) + i], contacts[i].name
            hits = mode == 0.0 and act in (STRIKES, RESTS, CLOSES)
            found.append((f"{name} {TOUCHES if mode == 0.0 else RELEASES}", first + i, hits))
            if mode and contacts[i].slips:
                said = BEGINS if mode == MODE_STICKS else STOPS
                found.append((f"{name} {said}", module["slip_relation"](i), False))
        return found

    def _indicators(self, equations: Any, t: float, x: list[float], event: ContactEvent) -> Array:
        """The indicators of all relations at (t, x), with contacts in their modes before the event."""
        work = self._placed(equations, event, event.before, event.last_slip).work
        self.module["fn_indicators_on"](equations.p, t, x, work.modes, work.events.indicators)
        self.module["indicate_forces"](equations.p, t, x, work)
        return np.array(work.events.indicators)

    def _settled_by(self, event: ContactEvent) -> Callable[[Any, float, list[float]], Array]:
        """The map of an impact."""
        first = self.system.nx - len(self.system.interface.contacts)

        def settled(equations: Any, t: float, x: list[float]) -> Array:
            # The displaced state is put on what holds before; this changes it by the square of its
            # displacement.
            module, work = self.module, equations.work
            module["seated"](equations.p, t, x, work)
            s = module["Integrator"](equations, Options(), t, x)
            module["enlarge_sizes"](x, s.sizes)
            module["widen_ranges"](x, s.lowest, s.highest)
            work.modes[:], work.modes_fixed = self.system.modes(event.t, event.before), True
            work.settling.go_on, work.settling.has_acted = True, False
            # Contacts that are hit, and those that rest, are those of the event.
            for i, act in event.acts.items():
                work.settling.hit[i] = int(event.before[first + i] == 0.0)
                s.touch_times[i], s.fall_heights[i] = t, inf if act == RESTS else 0.0
            status = module["settle"](equations.p, s, False, work)
            if status != OK or list(s.x[first:]) != list(event.after[first:]):
                raise ArithmeticError(EDGE)
            return np.array(s.x[: self.n])

        return settled

    def _slope(
        self, event: ContactEvent, k: int | None, change: Array, shift: float,
        values: Callable[[Any, float, list[float]], Array],
    ) -> tuple[Array, Array]:  # fmt: skip
        """The derivative of `values` before an event, and its error, if the state changes by `change`, time
        by `shift` and the parameter of direction k, if there is one, by 1."""
        place = None if k is None else self.directions[k].parameter
        parameters, before = list(self.system.parameters), np.array(event.before)
        unit = self._unit(k, change)

        def there(offset: float) -> Array:
            own, x = parameters[:], before.copy()
            if place is not None:
                own[place] += offset * unit
            x[: self.n] += offset * unit * change
            found = values(
                self.system.model.bind(own).equations(), event.t + offset * unit * shift, x.tolist()
            )
            return found / unit

        best: tuple[Array, Array] | None = None
        for farthest in FARTHEST:
            try:
                found, doubt = derivative_by_differences(there, farthest, DIFFERENCES)
            except ArithmeticError:
                continue
            if best is None or doubt.max(initial=0.0) < best[1].max(initial=0.0):
                best = found, doubt
            if (best[1] <= SURE * np.abs(best[0]).max(initial=0.0)).all():
                break
        if best is None:
            raise Stopped(EDGE, [] if k is None else [k])
        return best

    def _unit(self, k: int | None, change: Array) -> float:
        """The displacement that moves no state, and not the parameter of direction k, by more than its
        size."""
        reach = float(np.max(np.abs(change) / self.sizes, initial=0.0))
        if k is not None and self.directions[k].parameter is not None:
            reach = max(reach, 1.0 / size_of(self.system, self.directions[k]))
        return 1.0 / reach if reach > 0.0 else 1.0

    def _near(self, event: ContactEvent, i: int, values: Callable[[Any, float, list[float]], Array]) -> Array:
        """The derivative of `values` by a state, to a few digits."""
        found, step = list[Array](), NEAR * float(self.sizes[i])
        for side in (step, -step):
            x = list(event.before)
            x[i] += side
            found.append(values(self.system.equations(), event.t, x))
        difference: Array = (found[0] - found[1]) / (2.0 * step)
        return difference
