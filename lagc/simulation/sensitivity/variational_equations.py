"""Sensitivities S = dx/dtheta of a motion, along its steps.

S' = f_x S + f_theta,      S(0) = dx0/dtheta

The kernels of `lagc/kernels/sensitivity` integrate S on the stages of each step of the motion and estimate
its error.  A step that is too long for S is repeated with a shorter one.  At an event whose time depends
on theta, S jumps by (f- - f+) dt/dtheta.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from lagc.base.records import dataclass
from lagc.simulation.linearization.derivatives import Array, Point
from lagc.simulation.sensitivity.followers import Follower, follower
from lagc.simulation.sensitivity.saltation import Changes, Stopped
from lagc.simulation.sensitivity.sensitivities import FAINT, Mode
from lagc.simulation.system import INTERRUPTED, OK, TERMINATED, Options

if TYPE_CHECKING:
    pass

SLICE = 8  # inverse share of the steps so far that are made between two calls of `progress`
REASONS = ("", "its derivatives have no finite value", "its derivatives grow without bound")
SAME = 1e-6  # of the time of a run: difference of the ends of two integrations

Progress = Callable[[float], None]


class Tangents(NamedTuple):
    """S `now` by directions and states, and by directions and scaling groups its largest magnitudes so far,
    `sizes`, and its round-off with the largest terms that cancelled behind it, `rounding`."""

    now: Array
    sizes: Array
    rounding: Array


class Groups:
    """The scaling groups of the states of a model."""

    def __init__(self, kinds: Sequence[int]):
        self.kinds = sorted(set(kinds))
        self.masks = np.array([[kind == k for kind in kinds] for k in range(max(kinds, default=0) + 1)])

    def begun(self, start: Array) -> Tangents:
        """S(0), which is given by states and directions."""
        sizes = self.largest(start.T)
        return Tangents(start.T, sizes, np.zeros((2 * len(sizes), sizes.shape[1])))

    def changed(self, s: Tangents, now: Array, terms: Array, noise: Array | float = 0.0) -> Tangents:
        """S after an event, whose terms have these magnitudes, and further round-off, by states and
        directions."""
        largest, own = self.largest(terms.T), self.largest(np.broadcast_to(noise, terms.shape).T)
        m = len(largest)
        more = np.vstack([s.rounding[:m] + FAINT * largest + own, np.maximum(s.rounding[m:], largest)])
        return Tangents(now.T, np.maximum(s.sizes, largest), more)

    def largest(self, values: Array) -> Array:
        """The largest magnitude in each direction, by scaling groups."""
        sizes = np.abs(values)
        found: Array = np.array([sizes[:, mask].max(axis=1, initial=0.0) for mask in self.masks]).T
        return found


@dataclass
class Followed:
    """S at the recorded times, (times, nq + nv, directions), NaN from `reached` on. `rounding` is the
    accumulated round-off and `terms` the largest terms that cancel at events and in constraints, by scaling
    groups and directions; `passed` counts the events before each recorded time.  If directions are `lost`,
    the others could continue."""

    values: Array
    rounding: Array
    terms: Array
    passed: Array
    reached: int
    steps: int = 0  # as many evaluations of the derivatives, with the rejected ones
    rejected: int = 0
    message: str = ""
    interrupted: bool = False
    lost: Sequence[int] = ()

    def end(self, groups: Groups, s: Tangents) -> None:
        """Take round-off and terms from the end of S."""
        m = len(s.now)
        self.rounding, self.terms = s.rounding[:m].T[groups.kinds], s.rounding[m:].T[groups.kinds]


class Variation:
    """The integration of S along a motion."""

    def __init__(self, mode: Mode, start: Array, options: Options, rests: bool, most: int):
        """`mode` is the code of the motion, `start` is S(0) by its directions, `rests` tells that the motion
        stays at its initial state, and `most` limits the number of steps."""
        self.system, self.followed = mode.system, mode.followed
        self.rests, self.start, self.most, self.options = rests, start, most, options
        self.by_p, _ = mode.parameters
        self.columns = [-1 if d.parameter is None else d.parameter for d in mode.directions]
        self.groups = Groups(mode.system.interface.kinds)

    def integrate(
        self, x0: Sequence[float], times: Sequence[float], progress: Progress | None,
        begun: Tangents | None = None,
    ) -> Followed:  # fmt: skip
        """Integrate the motion from `x0` again, and S with it, from S(0) or from what it was `begun` as."""
        (n, m), nothing, x0 = self.start.shape, np.zeros((0, 0)), x0[: len(self.start)]
        found = Followed(np.zeros((0, n, m)), nothing, nothing, np.zeros(len(times), dtype=int), 1)
        begun = begun or self.groups.begun(self.start)
        s = follower(self.followed, self.options, times, x0, self.columns, *begun)
        try:
            self._follow(s, list(x0), times, progress, found)
        except Stopped as reason:
            found.message, found.lost = f"at t = {s.s.t:.6g} s: {reason}", reason.lost
        except ArithmeticError as error:
            found.message = f"at t = {s.s.t:.6g} s: {error}"
        except KeyboardInterrupt:
            found.message, found.interrupted = f"interrupted at t = {s.s.t:.6g} s", True
        *own, values = s.arrays()
        self.end, self.last = Tangents(*[array.copy() for array in own]), list(s.s.x[:n])
        found.values = values.transpose(0, 2, 1)
        found.end(self.groups, self.end)
        found.reached = max(found.reached, s.reached)
        found.steps, found.rejected = s.w.steps, s.w.rejected
        return found

    def _follow(
        self, s: Follower, x0: list[float], times: Sequence[float], progress: Progress | None, found: Followed
    ) -> None:
        interface = self.system.interface
        changes = Changes(self.system, self.by_p, [k for k in self.columns if k >= 0])
        modes = list(s.relations()[0]) if interface.relations else []
        if modes:
            zero = [0.0] * self.system.nv, [0.0] * self.system.nc
            changes.refuse_at_start(Point(self.system, times[0], x0, *zero), self.start)
        budget, status = 1, int(INTERRUPTED)
        while status == INTERRUPTED:
            jumps = s.s.jumps if interface.whens else 0
            status = s.follow(budget)
            if s.w.reason > 0:
                raise Stopped(REASONS[s.w.reason])
            if status == TERMINATED:
                self._ended(s, times)
                break
            if status not in (OK, INTERRUPTED):
                raise Stopped("the repeated motion fails there")
            if modes:
                modes = self._event(
                    s, changes, modes, bool(interface.whens) and s.s.jumps > jumps, times, found
                )
            if self.rests:
                s.set_state(x0)
            if progress is not None:
                progress(s.s.t)
            if s.w.steps + s.w.rejected > self.most:
                raise Stopped("they need far more steps than the motion")
            budget = 1 if self.rests else max(s.w.steps // SLICE, 1)

    def _event(
        self, s: Follower, changes: Changes, modes: list[float], jumped: bool, times: Sequence[float],
        found: Followed,
    ) -> list[float]:  # fmt: skip
        """Change S at the end of the last step if there was an event; return the modes after it."""
        after, before, crossed, together = s.relations()
        before = before if s.w.stepped else modes
        if not jumped and after == before:
            return after
        *own, _ = s.arrays()
        causes = [k for k, own in enumerate(crossed) if own], together
        changed, terms = changes.beyond(s, own[0].T, before, after, causes, jumped)
        s.change(*self.groups.changed(Tangents(*own), changed, terms))
        reached = s.reached
        found.passed[reached:] += 1
        if times[reached - 1] == s.s.t:  # the recorded state is the one after the event
            s.record(reached - 1, changed.T)
            found.passed[reached - 1] += 1
        return after

    def _ended(self, s: Follower, times: Sequence[float]) -> None:
        """Record S at the end of a run that a `when` clause terminates."""
        reached = s.reached
        if reached == len(times) - 1 and times[-1] - s.s.t <= SAME * s.s.t:
            s.record(reached, s.arrays()[0])
            reached += 1
        if reached < len(times):
            raise Stopped("the repeated motion ends earlier")
