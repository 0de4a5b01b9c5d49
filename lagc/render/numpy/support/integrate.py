"""One step after the other: explicit Runge-Kutta methods with error control and projection.

Step control: Hairer, Norsett, Wanner 1993, sections II.4 and II.10 and the codes DOPRI5 and DOP853
there.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf, pow
from typing import Any, NamedTuple

from lagc.render.numpy.support.base import (
    FAILED,
    INTERRUPTED,
    MAX_STEPS,
    NOT_FINITE,
    OK,
    STEP_UNDERFLOW,
    Options,
)
from lagc.render.numpy.support.linear import not_finite
from lagc.render.numpy.support.listening import FADING, FORGOTTEN, LOST, listen, parts_norm
from lagc.render.numpy.support.problem import Problem
from lagc.render.numpy.support.projection import nudge, project
from lagc.render.numpy.support.sizes import departing, enlarge, first_step, sizes_of, weigh
from lagc.render.numpy.support.stages import (
    dop853_at,
    dop853_dense,
    dop853_error,
    dop853_parts,
    dop853_stages,
    dopri5_at,
    dopri5_dense,
    dopri5_error,
    dopri5_stages,
)

# -- what follows is part of generated modules --


class Method(NamedTuple):
    """The functions of one method, `rates` for a step and `extra` for dense output; see `Tableau`."""

    stages: Callable[..., tuple[int, list[float]]]
    error: Callable[..., float]
    dense: Callable[..., tuple[int, list[list[float]]]]
    at: Callable[[float, list[list[float]]], list[float]]
    rates: int
    extra: int
    order: int
    uses_new: bool  # whether the error needs the rate at the new state
    exponent: float
    beta: float
    shrink: float
    grow: float


_DOP853 = (dop853_stages, dop853_error, dop853_dense, dop853_at)
_DOPRI5 = (dopri5_stages, dopri5_error, dopri5_dense, dopri5_at)
METHODS = {
    "dop853": Method(*_DOP853, 12, 3, 8, False, 0.125, 0.0, 0.333, 6.0),
    "dopri5": Method(*_DOPRI5, 6, 0, 5, True, 0.17, 0.04, 0.2, 10.0),
}
SAFETY = 0.9
NOWHERE, STAGES, READY = 0, 1, 2  # where a rate, or the dense output, is to be found


class Integrator:
    """A state on its way.  `t`, `x`: now; `t_old`, `x_old`, `h_old`: the start and size of the last step.

    Between two calls of `step`, `advance` and `at` the caller may change `t`, `x` (also in place), the
    options but for the method, and parameters and inputs (`problem.p`, where it has them): the next step
    begins with what is there then, at the cost of one evaluation where t, x or p is another, and with the
    size of step that was found before.  One problem may serve several of these in turn.  A call raises
    ValueError, before anything is done, where an option, a time or a parameter makes no sense.
    """

    def __init__(self, problem: Problem, options: Options, t: float, x: Sequence[float]):
        options.check()
        if len(x) != problem.nx:
            raise ValueError(f"x has {len(x)} entries, not {problem.nx}")
        self.problem, self.options = problem, options
        self.method = METHODS[options.method]
        self.t, self.x = t, list(x)
        self.t_old, self.x_old, self.h_old = t, self.x, 0.0
        self.k = [[0.0] * len(self.x) for _ in range(self.method.rates + 1 + self.method.extra)]
        self.lam = [0.0] * problem.nc
        self.h = 0.0  # the next step, > 0; 0 before the first
        self.error_old = 1e-4
        self.grid, self.on_grid = t, 0  # fixed steps: t = grid + on_grid * step
        self.stride = 0.0  # fixed steps: the signed step of that grid
        self.called = True  # no step was made since the caller had the state
        self.rate = NOWHERE  # at (t, x): k[0], k[method.rates], or to be found
        self.dense = NOWHERE  # of the last step: r, k, or to be found
        self.t_seen, self.x_seen = t, self.x[:]  # where the last step ended
        self.p: list[float] | None = None  # of the last step
        self.lost = False
        self.memory: Any = problem if hasattr(problem, "lost") else None
        self.r: list[list[float]] = []
        self.steps = self.rejected = self.rhs = 0
        self.position_drift = self.velocity_drift = 0.0
        self.entered = 0  # steps and attempts before this call
        self.culprit = -1
        self.constrained = options.project and (problem.nc > 0 or len(problem.quaternions) > 0)
        self.shaken = getattr(problem, "shaken", None)
        self.tangents = getattr(problem, "tangents", None) if problem.nh > 0 else None
        self.sizes = sizes_of(problem.kinds, self.x)  # the largest so far
        self.reached = self.sizes  # the same with the state that is tried
        self.weights: list[float] = []
        self.longest = 0.0  # step that was tried at first
        self.departing = False  # this attempt at a step is not the first
        self.listening = False  # the error of the last step was judged with its rounding
        self.recalled = 0.0  # 1 where rounding made a step good, less the longer ago that is; 0: forgotten
        self.noise = [0.0] * (problem.nq + problem.nv)  # that rounding, of the rates
        self.play = self.noise  # rates that what projection leaves of coordinates is over a step

    def step(self, t1: float) -> int:
        """One accepted step towards `t1`, at most to it, and then exactly; a status."""
        status = self.demand(t1)
        if status != OK:
            return status
        self.enter()
        return self.leave(self.step_(t1))

    def advance(self, t1: float) -> int:
        """To `t1` exactly; a status.  A step that is short only to end there does not make the next
        one short."""
        status = self.demand(t1)
        if status != OK:
            return status
        self.enter()
        while status == OK and self.t != t1:
            status = self.step_(t1)
        return self.leave(status)

    def at(self, t: float) -> tuple[int, list[float]]:
        """A status and the state at `t` within the last step, which was made with the parameters of then.
        ValueError at any other time."""
        part = (t - self.t_old) / self.h_old if self.h_old != 0.0 else -1.0
        if not (t == self.t or -1e-9 <= part <= 1.0 + 1e-9):
            raise ValueError(f"the time {t!r} is not within the last step")
        self.enter()
        found = self.at_(t) if self.p is None else self._with(self.p, self.at_, t)
        if self.memory is not None:
            self.lost = self.memory.lost
        if found[0] == OK and not_finite(found[1]) >= 0:
            self.culprit = not_finite(found[1])
            return NOT_FINITE, found[1]
        return found

    def demand(self, t1: float) -> int:
        """What a call that goes to `t1` demands: OK, or NOT_FINITE; raises ValueError."""
        self.options.check()
        if not (abs(t1) < inf and abs(self.t) < inf):
            raise ValueError(f"a time is not finite: from {self.t!r} to {t1!r}")
        check = getattr(self.problem, "check", None)
        if check is not None:
            check()
        self.culprit = not_finite(self.x)
        return OK if self.culprit < 0 else NOT_FINITE

    def enter(self) -> None:
        """What a call finds: the problem as this state left it."""
        self.called = True
        self.entered = self.steps + self.rejected
        if self.memory is not None:
            self.memory.lost = self.lost

    def leave(self, status: int) -> int:
        """What a call leaves: where the last step ended."""
        if status not in (OK, INTERRUPTED):
            self.rate = NOWHERE
        if not self.called:
            self.t_seen, self.x_seen = self.t, self.x[:]
        if self.memory is not None:
            self.lost = self.memory.lost
        return status

    def changed(self) -> int:
        """What the caller has changed since the last step: 0 nothing, 1 parameters, 2 the state."""
        if self.h == 0.0 or self.t != self.t_seen or self.x != self.x_seen:
            return 2
        return int(self.rate == NOWHERE or getattr(self.problem, "p", None) != self.p)

    def step_(self, t1: float) -> int:
        method, options, t, x, k = self.method, self.options, self.t, self.x, self.k
        direction = 1.0 if t1 >= t else -1.0
        change = self.changed() if self.called else 0
        if self.dense == STAGES:
            self.dense = NOWHERE  # other stages take their place
        if change:
            status = self._evaluate(change == 2)
            if status in FAILED:
                return status
        elif self.rate == READY:
            k[0], k[method.rates] = k[method.rates], k[0]
        self.rate = STAGES
        if self.h == 0.0:
            self._choose(t1, direction)
        if options.step > 0.0 and self.stride != options.step * direction:  # the grid begins here
            self.stride, self.grid, self.on_grid = options.step * direction, t, 0
        self._forget()
        rest = abs(t1 - t)
        cause, rejected, heard = OK, 0, False
        size = self.h
        if options.max_step > 0.0 and size > options.max_step:
            size = options.max_step
        while True:
            if options.max_steps > 0 and self.steps + self.rejected - self.entered >= options.max_steps:
                if rejected:
                    self.h = size
                return self._stop(MAX_STEPS)
            lands = size * 1.01 >= rest
            if options.step > 0.0:
                t_new = self.grid + (self.on_grid + 1) * options.step * direction
                lands = (t_new - t1) * direction >= -1e-9 * options.step
                size = abs(t_new - t)
            if lands:
                size, t_new = rest, t1
                h = t1 - t
            else:
                h = size * direction
                if options.step == 0.0:
                    t_new = t + h
            if not rejected and size > self.longest:
                self.longest = size
            self.departing = rejected > 0
            if (rejected or not lands) and 0.1 * size <= 2.3e-16 * abs(t) + 1e-40 * rest:
                return self._stop(cause if cause != OK else STEP_UNDERFLOW)
            status, y = method.stages(self.problem, t, x, h, k, self.lam)
            self.rhs += method.rates - 1
            error = 0.0
            if status not in FAILED:
                self._weigh(h, y)
            if status not in FAILED and (method.uses_new or options.step > 0.0):
                status = self._arrive(t_new, y)
            if status not in FAILED and options.step == 0.0:
                error = method.error(h, self.weights, k)
                heard = error > 1.0 and (rejected > 0 or self.listening or self.recalled > 0.0)
                if heard:
                    error, y = self._reconsider(t_new, h, y, error, rejected)
                if error != error:
                    status = NOT_FINITE
                    self.problem.culprit = not_finite(y)
                elif error <= 1.0 and not method.uses_new:
                    status = self._arrive(t_new, y)
            if status in FAILED:
                if options.step > 0.0:
                    return self._stop(status)
                cause = status
                size *= 0.25
            elif error <= 1.0:
                break
            else:
                cause = OK
                factor = pow(error, method.exponent) / SAFETY
                size /= factor if factor < 1.0 / method.shrink else 1.0 / method.shrink
            rejected += 1
            self.rejected += 1
        if options.step > 0.0:
            self.grid, self.on_grid = (t1, 0) if lands else (self.grid, self.on_grid + 1)
        else:
            self.stride = 0.0
            self._adapt(size, error, lands, rejected > 0)
        if self.called:
            p = getattr(self.problem, "p", None)
            self.p = None if p is None else p[:]
            self.called = False
        self.steps += 1
        self.t_old, self.x_old, self.h_old = t, x, h
        self.t, self.x = t_new, y
        enlarge(self.problem.kinds, y, self.sizes)
        self.listening = heard
        self.rate, self.dense = READY, STAGES
        return OK

    def at_(self, t: float) -> tuple[int, list[float]]:
        if t == self.t or self.h_old == 0.0:
            return OK, self.x[:]
        if self.dense != READY:
            status = self._interpolate()
            if status in FAILED:
                return self._stop(status), []
            self.dense = READY
        x = self.method.at((t - self.t_old) / self.h_old, self.r)
        if self.constrained:
            status, _, _ = project(self.problem, t, x, self.sizes)
            if status in FAILED:
                return self._stop(status), []
        return OK, x

    def _stop(self, status: int) -> int:
        if status in FAILED:
            self.culprit = self.problem.culprit
        return status

    def _interpolate(self) -> int:
        """The coefficients of dense output of the last step, with its end, whatever the caller has
        changed since."""
        t, x = (self.t_seen, self.x_seen) if self.called else (self.t, self.x)
        if self.dense == NOWHERE:
            status = self._repeat(t, x)
            if status in FAILED:
                return status
        self.rhs += self.method.extra
        status, self.r = self.method.dense(
            self.problem, self.t_old, self.x_old, x, self.h_old, self.k, self.lam
        )
        return status

    def _repeat(self, t: float, x: list[float]) -> int:
        """The stages of the last step once more: those of an attempt that failed have taken their place."""
        method, problem, k = self.method, self.problem, self.k
        status = problem.rhs(self.t_old, self.x_old, k[0], self.lam)
        self.rate = NOWHERE
        self.rhs += method.rates + 1
        if status not in FAILED:
            status, _ = method.stages(problem, self.t_old, self.x_old, self.h_old, k, self.lam)
        if status not in FAILED:
            status = problem.rhs(t, x, k[method.rates], self.lam)
        return status

    def _evaluate(self, moved: bool) -> int:
        """The rate at (t, x), which is `moved` by the caller or the first."""
        if moved:
            self.stride, self.recalled = 0.0, 0.0
            enlarge(self.problem.kinds, self.x, self.sizes)
            if self.memory is not None:
                self.memory.lost = False
            inspect = getattr(self.problem, "inspect", None)
            if inspect is not None:
                inspect(self.t, self.x)
        status = self.problem.rhs(self.t, self.x, self.k[0], self.lam)
        self.rhs += 1
        return self._stop(status)

    def _choose(self, t1: float, direction: float) -> None:
        """The size of the first step."""
        options = self.options
        if options.step > 0.0:
            self.h = options.step
        elif options.first_step > 0.0:
            self.h = options.first_step
        else:
            largest = options.max_step if options.max_step > 0.0 else abs(t1 - self.t)
            self.rhs += 1
            self.h = first_step(self.problem, self.t, self.x, self.sizes, self.k, largest, direction,
                                options, self.method.order, self.lam)  # fmt: skip

    def _weigh(self, h: float, y: list[float]) -> None:
        """The sizes with `y`, and what errors of a step over h are measured in."""
        kinds = self.problem.kinds
        self.reached = self.sizes[:]
        enlarge(kinds, y, self.reached)
        sizes = self.reached
        if self.departing:
            moved = [b - a for a, b in zip(self.x, y)]
            sizes = departing(kinds, self.sizes, self.reached, self.options, moved, self.longest / abs(h))
        self.weights = weigh(kinds, sizes, self.options, h, y, [a + b for a, b in zip(self.noise, self.play)])

    def _forget(self) -> None:
        """Before a step: what is left of the rounding that was heard, after the step before."""
        left = 1.0 - (1.0 - FADING) * abs(self.h_old) / self.longest if self.longest > 0.0 else 0.0
        self.recalled *= left
        if self.recalled < FORGOTTEN:
            self.recalled = 0.0
        self.noise = [left * a if self.recalled > 0.0 else 0.0 for a in self.noise]
        self.play = [0.0] * len(self.noise)

    def _listen(self, h: float = 0.0) -> None:
        """Raise `noise` to what rounding may change in the rates k[0], or in all along a step over h."""
        if self.shaken is None:
            return
        t, x, p = self.shaken(self.t, self.x, self.rejected)
        rates = self.method.rates if h else 1
        self.rhs += rates
        self._with(p, listen, self.problem, self.method.stages if h else None, t, x, h, self.k[:rates],
                   self.noise)  # fmt: skip

    def _with(self, p: list[float], function: Callable[..., Any], *given: Any) -> Any:
        """What a function returns where the parameters are p."""
        problem: Any = self.problem
        now, problem.p = problem.p, p
        try:
            return function(*given)
        finally:
            problem.p = now

    def _arrive(self, t: float, y: list[float]) -> int:
        """Project the new state and evaluate there."""
        if self.constrained:
            status, position, velocity = project(self.problem, t, y, self.reached)
            if status in FAILED:
                return status
            if position > self.position_drift:
                self.position_drift = position
            if velocity > self.velocity_drift:
                self.velocity_drift = velocity
        self.rhs += 1
        return self.problem.rhs(t, y, self.k[self.method.rates], self.lam)

    def _reconsider(
        self, t: float, h: float, y: list[float], error: float, rejected: int
    ) -> tuple[float, list[float]]:
        """An error that rejects a step to t another time, or after steps that went by this, less what
        rounding contributes, and the state reached.  It is told at the start, and, where that tells too
        little, along the step."""
        if self.tangents is not None:
            nudged = self._all_but_dependent(h, y)
            if nudged:
                judged = self.options.project and not self.method.uses_new
                return self._second_look(t, h, y, error, nudged) if judged else (error, y)
        before = error
        if self.recalled == 0.0:
            self._listen()
            error = self._error(h, y)
        lost = rejected > 1 and error * self.options.rtol > LOST
        if error > 1.0 and (self.recalled > 0.0 or lost or (rejected > 2 and not rejected & (rejected - 1))):
            self._listen(h)
            error = self._error(h, y)
        if error <= 1.0 or error < 0.5 * before:
            self.recalled = 1.0
        return error, y

    def _error(self, h: float, y: list[float]) -> float:
        """That of the step over h to y, with the rounding that was heard."""
        self._weigh(h, y)
        return self.method.error(h, self.weights, self.k)

    def _all_but_dependent(self, h: float, y: list[float]) -> list[float]:
        """A state beside x that is not empty where rows are all but dependent within the way of the step
        over h to y that was tried, or a thousandth of the way that the coordinates have to where they are
        zero.  Coordinates of a kind that have moved by no more than what projection leaves are rounding."""
        nudged = nudge(self.problem, self.t, self.x, self.sizes)
        kinds = self.problem.kinds[: self.problem.nq] if nudged else ()
        moved = sizes_of(kinds, [b - a for a, b in zip(self.x, y)])
        left = sizes_of(kinds, [c - a for a, c in zip(self.x, nudged)])
        for i, kind in enumerate(kinds):
            if left[kind] > self.reached[kind]:
                self.play[i] = left[kind] / abs(h)
        for kind, (a, b, reach) in enumerate(zip(moved, left, self.reached)):
            if kind == 0 and reach > 1.0:
                reach = 1.0
            if b > reach:
                continue
            if b * a > 3e-15 * reach * reach or b > 1e-12 * reach:
                return nudged
        return []

    def _second_look(
        self, t: float, h: float, y: list[float], error: float, nudged: list[float]
    ) -> tuple[float, list[float]]:
        """There, a step of DOP853 to t, rejected because of `error`, once more from a state moved by what
        projection leaves: the error that counts, and the state reached.

        Where the error changes by it, it tells of rounding: near postures where rows are all but
        dependent their multipliers are little else, and no step would be small enough.  Then
        only what projection does not take from the error counts.
        """
        assert self.tangents is not None
        other = dop853_parts(self.k)
        self.rhs += 11
        status, z = dop853_stages(self.problem, self.t, nudged, h, self.k, self.lam)
        if status in FAILED:
            return error, z
        parts = dop853_parts(self.k)
        for row, new in zip(other, parts):
            row[:] = [a - b for a, b in zip(row, new)]
        change = parts_norm(other, self.weights, h)
        if not change > 0.1 * parts_norm(parts, self.weights, h):
            return error, z
        self.rhs += 11
        status, y = dop853_stages(self.problem, self.t, self.x, h, self.k, self.lam)  # the step as it was
        parts = dop853_parts(self.k)
        if not self.tangents(t, y, parts):
            return error, y
        return parts_norm(parts, self.weights, h), y

    def _adapt(self, size: float, error: float, lands: bool, rejected: bool) -> None:
        """The size of the next step."""
        method = self.method
        factor = pow(error, method.exponent)
        if method.beta > 0.0:
            factor /= pow(self.error_old, method.beta)
            self.error_old = error if error > 1e-4 else 1e-4
        factor /= SAFETY
        if factor > 1.0 / method.shrink:
            factor = 1.0 / method.shrink
        if factor < 1.0 / method.grow:
            factor = 1.0 / method.grow
        following = size / factor
        if rejected and following > size:
            following = size
        if lands and not rejected and following < self.h:
            following = self.h  # the step was short only to land
        self.h = following
