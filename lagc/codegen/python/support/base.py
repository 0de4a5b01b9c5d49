"""Options and results of the integrators, in generated Python modules and in runs of lagc."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf
from typing import Any

from lagc.kernels import METHODS
from lagc.kernels.language.statuses import INCONSISTENT, NOT_FINITE, OK, SINGULAR_MASS, TERMINATED

# -- what follows is part of generated modules --

MOST_EVENTS = 10_000
MOST_CORNERS = 1000
FIRST_LOOK = 1024  # accepted steps before the first call of `watch`; they double from call to call
FAILED = frozenset((SINGULAR_MASS, INCONSISTENT, NOT_FINITE))  # of one evaluation


class Options:
    """How to integrate one trajectory.

    `method`: one of METHODS.  `rtol`: relative to the largest magnitude so far in the scaling group of a
    state, or with `alone` of this state; `atol`: added for every state.  `step` > 0: fixed step size; rtol
    and atol are not used.
    `first_step`: 0 means chosen; `max_step`: 0 means no limit; `max_steps`: limit of accepted and rejected
    steps, 0 means none.  `watch`: called with the trajectory so far after 1024, 2048, 4096, ... accepted
    steps; if it returns True the run ends as at `max_steps`.  `report`: store events in the trajectory.
    `halves`: split the last step before an event or the last time in two.  `project`: False lets the
    constraints drift (for tests).
    """

    def __init__(
        self,
        method: str = "dop853",
        rtol: float = 1e-9,
        atol: float = 0.0,
        step: float = 0.0,
        first_step: float = 0.0,
        max_step: float = 0.0,
        max_steps: int = 100_000_000,
        project: bool = True,
        watch: Callable[[Trajectory], bool] | None = None,
        report: bool = False,
        halves: bool = False,
        alone: bool = False,
    ):
        self.method = method
        self.rtol, self.atol = rtol, atol
        self.step, self.first_step, self.max_step = step, first_step, max_step
        self.max_steps = max_steps
        self.project, self.watch, self.report, self.halves = project, watch, report, halves
        self.alone = alone

    def check(self) -> None:
        """Raise ValueError, with its name, for an option that is not valid."""
        if self.method not in METHODS:
            raise ValueError(f"the option method must be {' or '.join(METHODS)}, not {self.method!r}")
        if not self.max_steps >= 0:
            raise ValueError(f"the option max_steps must be 0 or more, not {self.max_steps!r}")
        for name in ("rtol", "atol", "step", "first_step", "max_step"):
            value = getattr(self, name)
            if not 0.0 <= value < inf:
                raise ValueError(f"the option {name} must be 0 or more and finite, not {value!r}")
            if name == "rtol" and not value < 1.0:
                raise ValueError(f"the option rtol must be below 1, not {value!r}")
            if name == "rtol" and value < 1e-15 and self.step == 0.0 == self.atol:
                raise ValueError(f"the option rtol must be 1e-15 at least where atol is 0, not {value!r}")


class Trajectory:
    """States at the requested times that were reached, with statistics.

    `status`: OK, or the reason of the end, at time `t` with state `x` and `culprit`.
    `step`: size of the last accepted step.
    `stiff`: tests that found the steps at the border of stability, one in 1000 steps.
    `position_drift`, `velocity_drift`: largest scaled constraint residuals over all steps.
    `fallbacks`: linear solves that used the rank-revealing factorization.
    `sizes`: largest magnitude in each scaling group, over all steps.
    `lowest`, `highest`: least and largest value of each state, over the ends of all steps.
    `events`: (time, relation) of changes of modes, and (time, number of relations + clause) of `when` clauses
    that acted, the first MOST_EVENTS, with the option `report`.
    `jumps`: times at which clauses changed the state.
    `corners`: the first MOST_CORNERS event times, with the states before and after.
    `changes`: number of events.
    If a clause ended the run, its time and state are the last of `times` and `states`.
    """

    def __init__(
        self,
        times: list[float],
        states: list[list[float]],
        t: float,
        x: list[float],
        status: int = OK,
        culprit: int = -1,
        steps: int = 0,
        rejected: int = 0,
        rhs: int = 0,
        stiff: int = 0,
        step: float = 0.0,
        fallbacks: int = 0,
        redundant_rows: tuple[int, ...] = (),
        shared_contacts: tuple[int, ...] = (),
        position_drift: float = 0.0,
        velocity_drift: float = 0.0,
        sizes: Sequence[float] = (),
        lowest: Sequence[float] = (),
        highest: Sequence[float] = (),
        events: Sequence[tuple[float, int]] = (),
        jumps: Sequence[float] = (),
        corners: Sequence[tuple[float, list[float], list[float]]] = (),
        changes: int = 0,
    ):
        # The slots of a trajectory; counters and estimates are those of the run's state.
        self.times, self.states = times, states
        self.t, self.x = t, x
        self.status, self.culprit = status, culprit
        self.steps, self.rejected, self.rhs, self.fallbacks = steps, rejected, rhs, fallbacks
        self.stiff = stiff
        self.step = step
        self.redundant_rows, self.shared_contacts = redundant_rows, shared_contacts
        self.position_drift, self.velocity_drift = position_drift, velocity_drift
        self.sizes, self.events, self.jumps = sizes, events, jumps
        self.lowest, self.highest = lowest, highest
        self.corners = corners
        self.changes = changes
        # A clause may end the run between two recorded times: its state is added.
        if status == TERMINATED and (not times or times[-1] != t):
            self.times, self.states = [*times, t], [*states, list(x)]

    def changed(self, **values: Any) -> Trajectory:
        """Return a copy with other values."""
        return Trajectory(**{**vars(self), **values})
