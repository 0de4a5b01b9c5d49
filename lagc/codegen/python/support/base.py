"""Statuses, options and results of the integrators: in generated Python modules, and for runs of lagc."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf
from typing import Any

from lagc.kernels import METHODS
from lagc.kernels.language.statuses import INCONSISTENT, NOT_FINITE, OK, SINGULAR_MASS, TERMINATED

# -- what follows is part of generated modules --

MOST_EVENTS = 10_000
MOST_CORNERS = 1000
FIRST_LOOK = 1024  # accepted steps after which a run is looked at; then twice as many, and so on
FAILED = frozenset((SINGULAR_MASS, INCONSISTENT, NOT_FINITE))  # of one evaluation


class Options:
    """How to integrate one trajectory.

    `method`: one of METHODS.  `rtol` is relative to the largest magnitude so far of the states of
    the same kind, `atol` is added for all.  `step` > 0 asks for fixed steps (rtol, atol unused).
    `first_step` 0: chosen; `max_step` 0: no limit; `max_steps`, of one call: accepted and rejected, 0: no
    limit.  `watch` is asked after 1024, 2048, 4096, ... accepted steps, with the trajectory so far: where
    it says True, the run ends as at `max_steps`.  `report`: the changes of switches are in the trajectory's
    `events`.  `halves`: steps that end where switches change, or at the last time, are made in two.
    `project` False leaves the constraints to drift (for tests).
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
    ):
        self.method = method
        self.rtol, self.atol = rtol, atol
        self.step, self.first_step, self.max_step = step, first_step, max_step
        self.max_steps = max_steps
        self.project, self.watch, self.report, self.halves = project, watch, report, halves

    def check(self) -> None:
        """Raises ValueError, naming the option that makes no sense."""
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
    """States at the asked times (as many as were reached), and what it took.

    `status` OK, or what stopped it, at time `t` with state `x` (kept) and `culprit`.
    `step` is the size of the last accepted step.
    `position_drift`, `velocity_drift`: largest scaled residuals over the accepted steps.
    `fallbacks`: linear solves that needed the pivoted QR.
    `sizes`: the largest magnitude of the states of each kind, at the ends of all steps.
    `events`: (time, switch) of changes of switches, and (time, number of switches + clause) of clauses `when`
    that acted, the first MOST_EVENTS of them, where they were asked for; `jumps` their times at which states
    took new values; `corners`: the first MOST_CORNERS times of changes, with the states before and behind.
    Where a clause ended the run, its time and state are the last of `times`, `states`.
    `changes`: how often switches changed.
    `event_roundoff`: what the last place of the times at which switches changed is worth in each state, in all.
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
        step: float = 0.0,
        fallbacks: int = 0,
        redundant_rows: tuple[int, ...] = (),
        position_drift: float = 0.0,
        velocity_drift: float = 0.0,
        sizes: Sequence[float] = (),
        event_roundoff: Sequence[float] = (),
        events: Sequence[tuple[float, int]] = (),
        jumps: Sequence[float] = (),
        corners: Sequence[tuple[float, list[float], list[float]]] = (),
        changes: int = 0,
    ):
        self.times, self.states = times, states
        self.t, self.x = t, x
        self.status, self.culprit = status, culprit
        self.steps, self.rejected, self.rhs, self.fallbacks = steps, rejected, rhs, fallbacks
        self.step = step
        self.redundant_rows = redundant_rows
        self.position_drift, self.velocity_drift = position_drift, velocity_drift
        self.sizes, self.event_roundoff, self.events, self.jumps = sizes, event_roundoff, events, jumps
        self.corners = corners
        self.changes = changes
        if status == TERMINATED and (not times or times[-1] != t):
            self.times, self.states = [*times, t], [*states, list(x)]

    def changed(self, **values: Any) -> Trajectory:
        """This one with other values."""
        return Trajectory(**{**vars(self), **values})
