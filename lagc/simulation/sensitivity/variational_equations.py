"""Sensitivities S = dx/dtheta of a motion, along its steps.

S' = f_x S + f_theta,      S(0) = dx0/dtheta

The equations are integrated on the stages of each step of the motion by the same method, which gives the
derivative of the steps themselves (H. G. Bock, Numerical treatment of inverse problems in chemical reaction
kinetics, 1981; Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, section II.6).  The
error of S is estimated as that of the motion, and a step that is too long for S is repeated with a shorter
one.  After each step, S is projected onto the tangents of the constraints.  At an event whose time depends
on theta, S jumps by (f- - f+) dt/dtheta.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import cache
from importlib import import_module
from math import inf
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from lagc.base.records import dataclass
from lagc.simulation.linearization.derivatives import Array, Point
from lagc.simulation.sensitivity.saltation import Changes, Stopped, end_of_step
from lagc.simulation.sensitivity.sensitivities import FAINT, Direction
from lagc.simulation.system import OK, TERMINATED, Options

if TYPE_CHECKING:
    from lagc.simulation.backends.python import NumpySystem


@dataclass(frozen=True)
class Tableau:
    """A Runge-Kutta method, k_i = f(t + c_i h, x + h sum a_ij k_j), x1 = x + h sum b_i k_i."""

    order: int
    c: Array
    a: list[Array]
    b: Array
    error: list[Array]
    extra_c: Array
    extra_a: list[Array]
    dense: list[Array]

    @property
    def stages(self) -> int:
        return len(self.c)

    def error_of(self, table: Array, h: float) -> Array:
        """The error of a step, by entries; `table` has the rates at the stages and at the new state."""
        first, *others = (h * combined(row, table) for row in self.error)
        if not others:
            return np.abs(first)
        size = np.hypot(first, 0.1 * others[0])
        return np.divide(np.square(first), size, out=np.zeros_like(size), where=size > 0.0)

    def coefficients(self, old: Array, new: Array, table: Array, h: float) -> list[Array]:
        """The coefficients of dense output of a step; `table` includes its stages."""
        change, first, last = new - old, table[0], table[self.stages]
        curvature = h * first - change
        return [
            old,
            change,
            curvature,
            change - h * last - curvature,
            *(h * combined(row, table) for row in self.dense),
        ]


def within(coefficients: Sequence[Array], part: float) -> Array:
    """The dense output at this part of a step."""
    *lower, value = coefficients
    for j in range(len(lower) - 1, -1, -1):
        value = lower[j] + (part if j % 2 == 0 else 1.0 - part) * value
    return value


def combined(row: Array, table: Array) -> Array:
    """The sum of the rows of `table` with the weights `row`."""
    found: Array = np.tensordot(row, table[: len(row)], 1)
    return found


@cache
def tableau(method: str) -> Tableau:
    m: Any = import_module(f"lagc.kernels.integrators.tableaus.{method}")
    n = len(m.C)
    full = n + 1 + len(m.EXTRA_C)
    return Tableau(
        m.ORDER, _numbers(m.C), [_row(row, k) for k, row in enumerate(m.A)], _row(m.B, n),
        [_row(row, n + 1) for row in m.ERROR], _numbers(m.EXTRA_C),
        [_row(row, n + 1 + k) for k, row in enumerate(m.EXTRA_A)], [_row(row, full) for row in m.DENSE],
    )  # fmt: skip


def _numbers(texts: Sequence[str]) -> Array:
    return np.array([float(Fraction(text)) for text in texts])


def _row(entries: Mapping[int, str], length: int) -> Array:
    found = np.zeros(length)
    for place, text in entries.items():
        found[place - 1] = float(Fraction(text))
    return found


SHORTEST = 1e-12  # of the time of the run: a repeated step
PERTURBED = 9e-16  # relative perturbation of a state: four rounding units
FADING = 0.9  # from step to step, of the round-off estimate
STEEPEST = 20.0  # power of the time by which S leaves zero
SAME = 1e-6  # of the time of a run: difference of the ends of two integrations

Progress = Callable[[float], None]


@dataclass
class Followed:
    """S at the recorded times, (times, nq + nv, directions), NaN from `reached` on. `rounding` is the
    accumulated round-off and `terms` the largest terms at events, by scaling groups and directions; `passed`
    counts the events before each recorded time.  If directions are `lost`, the others could continue."""

    values: Array
    rounding: Array
    terms: Array
    passed: Array
    reached: int
    steps: int
    rejected: int
    evaluations: int  # of the derivatives
    message: str = ""
    interrupted: bool = False
    lost: Sequence[int] = ()


class Slopes(NamedTuple):
    """The coefficients of the equations of S at one point."""

    point: Point
    by_state: Array
    by_parameter: Array  # by direction

    def rates(self, own: Array) -> Array:
        found: Array = self.by_state @ own + self.by_parameter
        return found


class Variation:
    """The integration of S along a motion."""

    def __init__(
        self,
        system: NumpySystem,
        directions: Sequence[Direction],
        start: Array,
        options: Options,
        rests: bool,
        most: int,
    ):
        """`start` is S(0) by directions, `rests` tells that the motion stays at its initial state, and
        `most` limits the number of steps."""
        self.system, self.rests, self.start, self.most = system, rests, start, most
        self.options = Options(**vars(options))  # a copy, because the longest step changes
        self.by_p = [k for k, d in enumerate(directions) if d.parameter is not None]
        self.columns = [d.parameter for d in directions if d.parameter is not None]
        self.table, self.longest = tableau(options.method), options.max_step
        kinds = system.interface.kinds
        self.in_group = np.array([[kind == k for kind in kinds] for k in sorted(set(kinds))])
        self.group = np.argmax(self.in_group, axis=0)
        self.evaluations = 0

    def along(self, x0: Sequence[float], times: Sequence[float], progress: Progress | None) -> Followed:
        """Integrate the motion from `x0` again, and S with it."""
        s = self.system.model.module["Integrator"](self.system.equations(), self.options, times[0], list(x0))
        n, m = self.start.shape
        values, in_group = np.full((len(times), n, m), np.nan), np.zeros((len(self.in_group), m))
        found = Followed(values, in_group, in_group.copy(), np.zeros(len(times), dtype=int), 1, 0, 0, 0)
        self.sizes, self.faint = self._largest(self.start), np.zeros_like(found.rounding)
        self.pace = inf  # the longest step for S
        self.roundoff = np.zeros_like(self.sizes)  # what rounding of states changes its rates by
        found.values[0] = now = self.start
        self.last: Slopes | None = None  # at the begin of the next step
        modes = list(s.modes) if self.system.interface.relations else []
        whens = bool(self.system.interface.whens)
        changes = Changes(self.system, self.by_p, self.columns)
        try:
            if modes:
                at_start = Point(
                    self.system, times[0], list(x0), [0.0] * self.system.nv, [0.0] * self.system.nc
                )
                changes.refuse_at_start(at_start, now)
            while s.t < times[-1]:
                steps, old, jumps = s.steps, now, s.jumps if whens else 0
                status, now, table = self._step(s, now, times[-1], found)
                if status not in (OK, TERMINATED):
                    raise Stopped("the repeated motion fails there")
                if s.steps > steps:
                    found.steps += 1
                    self._record(s, old, now, table, times, found)
                if status == TERMINATED:
                    self._ended(s, now, times, found)
                    break
                if modes:
                    jumped = whens and s.jumps > jumps
                    before, modes = s.modes_old if s.steps > steps else modes, list(s.modes)
                    if jumped or modes != list(before):
                        self.last, (now, terms) = None, changes.beyond(s, now, before, jumped)
                        self._add_up(terms, found)
                        found.passed[found.reached :] += 1
                        if times[found.reached - 1] == s.t:  # the recorded state is the one after the event
                            found.values[found.reached - 1] = now
                            found.passed[found.reached - 1] += 1
                if self.rests:
                    s.x[:] = x0
                if progress is not None:
                    progress(s.t)
                if found.steps + found.rejected > self.most:
                    raise Stopped("they need far more steps than the motion")
        except Stopped as reason:
            found.message, found.lost = f"at t = {s.t:.6g} s: {reason}", reason.lost
        except ArithmeticError as error:
            found.message = f"at t = {s.t:.6g} s: {error}"
        except KeyboardInterrupt:
            found.message, found.interrupted = f"interrupted at t = {s.t:.6g} s", True
        found.evaluations = self.evaluations
        return found

    def _add_up(self, terms: Array, found: Followed) -> None:
        """Add the terms of S at an event to the sizes and the round-off."""
        largest = self._largest(terms)
        found.terms, self.sizes = np.maximum(found.terms, largest), np.maximum(self.sizes, largest)
        self.faint += FAINT * largest
        found.rounding += FAINT * largest

    # -- one step --

    def _step(self, s: Any, now: Array, stop: float, found: Followed) -> tuple[int, Array, Array]:
        """Make one step of the motion that is not too long for S; return the status, S after it, and its
        rates at the stages."""
        kept, grown, estimated = _kept(s), np.zeros_like(self.sizes), False
        while True:
            limit = min(self.longest or inf, self.pace)
            s.options.max_step = limit if limit < inf else 0.0
            steps = s.steps
            status = s.step(stop)
            if status not in (OK, TERMINATED) or s.steps == steps:
                return status, now, np.zeros(0)
            new, table, first, last = self._stages(s, now)
            h = s.h_old
            if not self.table.error or self.options.step > 0.0:
                break
            terms = h * np.maximum(self._terms(first, now), self._terms(last, new))
            errors = self.table.error_of(table, h)
            faint = FAINT * (terms + self._tied(last.point, new)) + h * self.roundoff
            faint += h * self._largest(np.abs(first.by_state) @ (self.faint + faint)[self.group])
            grown = np.maximum(grown, self._known(new, errors, terms))
            error = _norm(errors, (self._scale(np.maximum(terms, grown), new) + faint)[self.group])
            part = 0.9 * error ** (-1.0 / self.table.order) if error > 0.0 else inf
            if error <= 1.0:
                self.pace = h * min(max(part, 0.5), 5.0) if part < inf else inf
                self.sizes = np.maximum(np.maximum(self.sizes, grown), self._largest(new))
                self.faint += FAINT * terms
                found.rounding += faint
                break
            if not h > SHORTEST * stop:
                raise Stopped("its derivatives grow without bound")
            self.pace = h * (max(part, 0.1) if part == part else 0.1)
            if not estimated:
                estimated, self.roundoff = (
                    True,
                    np.maximum(FADING * self.roundoff, self._roundoff(s, first, now)),
                )
            found.rejected += 1
            _restore(s, kept)
        self.last = last
        return status, new, table

    def _scale(self, terms: Array, new: Array) -> Array:
        """The scale of errors: the largest value so far, or the change in the step; for groups that were
        zero, their new value."""
        sizes = np.maximum(self.sizes, terms)
        return self.options.rtol * np.where(sizes > 0.0, sizes, self._largest(new))

    def _known(self, new: Array, errors: Array, terms: Array) -> Array:
        """The size of S at the end of a step, by scaling groups, if S is known to a half and grows like a
        power of the time, as behind the kink of Hertz' contact, where no short step has a small relative
        error."""
        sizes = self._largest(new)
        return np.where((2.0 * self._largest(errors) < sizes) & (terms <= STEEPEST * sizes), sizes, 0.0)

    def _roundoff(self, s: Any, first: Slopes, now: Array) -> Array:
        """The round-off of the rates of S, from a perturbation of the states by rounding units."""
        x, modes = np.array(s.x_old), list(s.modes_old) if self.system.interface.relations else None
        perturb = np.where(np.arange(len(x)) % 2 == 0, 1.0 + PERTURBED, 1.0 - PERTURBED)
        beside = self._slopes(self._point(s.t_old, x * perturb, np.array(s.k[0]), modes))
        return self._largest(beside.rates(now) - first.rates(now))

    def _stages(self, s: Any, now: Array) -> tuple[Array, Array, Slopes, Slopes]:
        """Compute S at the end of the last step, on the constraints, its rates at the stages and there, and
        the coefficients at both ends."""
        rates, table, t, h, x = np.array(s.k), self.table, s.t_old, s.h_old, np.array(s.x_old)
        modes = list(s.modes_old) if self.system.interface.relations else None
        found = np.empty((table.stages + 1 + len(table.extra_c), *now.shape))
        first = self.last or self._slopes(self._point(t, x, rates[0], modes))
        found[0] = first.rates(now)
        for j in range(1, table.stages):
            at = x + h * combined(table.a[j], rates)
            own = now + h * combined(table.a[j], found)
            found[j] = self._slopes(self._point(t + table.c[j] * h, at, rates[j], modes)).rates(own)
        new = now + h * combined(table.b, found)
        there = self._point(s.t, np.array(end_of_step(s, self.system)), rates[table.stages], modes)
        new, last = self._tangent(there, new), self._slopes(there)
        found[table.stages] = last.rates(new)
        return new, found, first, last

    def _point(self, t: float, x: Array, rates: Array, modes: Sequence[float] | None) -> Point:
        self.evaluations += 1
        system = self.system
        if system.nc:
            return Point(system, t, x.tolist(), modes=modes)
        return Point(system, t, x.tolist(), rates[system.nq :].tolist(), [], modes=modes)

    def _slopes(self, point: Point) -> Slopes:
        by_state, by_parameter = point.total("rate", "state"), np.zeros(self.start.shape)
        if self.columns:
            by_parameter[:, self.by_p] = point.by_parameters()[:, self.columns]
        if not (np.isfinite(by_state).all() and np.isfinite(by_parameter).all()):
            raise Stopped("its derivatives have no finite value")
        return Slopes(point, by_state, by_parameter)

    def _terms(self, slopes: Slopes, own: Array) -> Array:
        """The sums of magnitudes of the terms of the rates of S, the largest of each scaling group."""
        table = slopes.point.reach("state")
        found = np.zeros_like(own)
        for mask in self.in_group:
            found += table[:, mask].max(axis=1)[:, None] * np.abs(own[mask]).sum(axis=0)
        if self.columns:
            found[:, self.by_p] += slopes.point.reach("parameter")[:, self.columns]
        return self._largest(found)

    def _tangent(self, point: Point, own: Array) -> Array:
        """Project S so that phi_q S_q + phi_theta = 0, and the same for psi, by the smallest change in the
        metric of the mass matrix; quaternions keep their length."""
        system = self.system
        nq, nv, nh, nc = system.nq, system.nv, system.nh, system.nc
        if not (nc or system.quaternions):
            return own
        own = own.copy()
        for k in system.quaternions:
            q = np.array(point.x[k : k + 4])
            own[k : k + 4] -= np.outer(q, q @ own[k : k + 4]) / (q @ q)
        if nc:
            rows, inverse = point.partial("condition", "state")[: nh + nc], point.inverse
            residual = np.zeros((nh + nc, own.shape[1]))
            if self.columns:
                residual[:, self.by_p] = point.partial("condition", "parameter")[: nh + nc, self.columns]
            phi = residual[:nh] + rows[:nh, :nq] @ own[:nq]
            own[:nq] -= point.partial("qdot", "state")[:, nq:] @ (inverse[:nv, nv : nv + nh] @ phi)
            psi = residual[nh:] + rows[nh:] @ own
            own[nq:] -= inverse[:nv, nv:] @ psi
        return own

    def _tied(self, point: Point, own: Array) -> Array:
        """The effect of the terms of these conditions on S, the largest of each scaling group."""
        system = self.system
        nq, nv, nh, nc = system.nq, system.nv, system.nh, system.nc
        if not nc:
            return np.zeros((len(self.in_group), own.shape[1]))
        terms = np.abs(point.partial("condition", "state")[: nh + nc]) @ np.abs(own)
        if self.columns:
            terms[:, self.by_p] += np.abs(point.partial("condition", "parameter")[: nh + nc, self.columns])
        back = np.abs(point.inverse[:nv, nv:])
        moves = np.abs(point.partial("qdot", "state")[:, nq:]) @ (back[:, :nh] @ terms[:nh])
        return self._largest(np.vstack([moves, back @ terms[nh:]]))

    # -- recorded times --

    def _record(
        self, s: Any, old: Array, new: Array, table: Array, times: Sequence[float], found: Followed
    ) -> None:
        """Record S at the times within the last step."""
        coefficients: list[Array] = []
        while found.reached < len(times) and times[found.reached] <= s.t:
            t = times[found.reached]
            value = new
            if t < s.t:
                _, x = s.at(t)
                coefficients = coefficients or self._coefficients(s, old, new, table)
                value = within(coefficients, (t - s.t_old) / s.h_old)
                if self.system.nc or self.system.quaternions:
                    fixed = [0.0] * self.system.nv, [0.0] * self.system.nc
                    value = self._tangent(Point(self.system, t, x, *fixed), value)
            found.values[found.reached] = value
            found.reached += 1

    def _ended(self, s: Any, now: Array, times: Sequence[float], found: Followed) -> None:
        """Record S at the end of a run that a `when` clause terminates."""
        if found.reached == len(times) - 1 and times[-1] - s.t <= SAME * s.t:
            found.values[-1] = now
            found.reached += 1
        if found.reached < len(times):
            raise Stopped("the repeated motion ends earlier")

    def _coefficients(self, s: Any, old: Array, new: Array, table: Array) -> list[Array]:
        """The coefficients of dense output of S, with the additional stages of that of the motion."""
        rates, own, h = np.array(s.k), self.table, s.h_old
        modes = list(s.modes_old) if self.system.interface.relations else None
        for j, (c, row) in enumerate(zip(own.extra_c, own.extra_a)):
            k = own.stages + 1 + j
            at = np.array(s.x_old) + h * combined(row, rates)
            point = self._point(s.t_old + c * h, at, rates[k], modes)
            table[k] = self._slopes(point).rates(old + h * combined(row, table))
        return own.coefficients(old, new, table, h)

    def _largest(self, values: Array) -> Array:
        """The largest magnitude of each scaling group, by directions."""
        sizes = np.abs(values)
        return np.array([sizes[mask].max(axis=0, initial=0.0) for mask in self.in_group])


def _norm(errors: Array, weights: Array) -> float:
    """The root mean square over the states, the largest of all directions; entries without a weight do not
    count."""
    parts = np.divide(errors, weights, out=np.zeros_like(errors), where=weights > 0.0)
    return float(np.sqrt(np.square(parts).mean(axis=0)).max(initial=0.0))


def _kept(s: Any) -> dict[str, Any]:
    """A copy of the whole integrator state."""
    names: tuple[str, ...] = vars(type(s).__base__)["__slots__"]
    return {name: _copied(getattr(s, name)) for name in names}


def _restore(s: Any, kept: dict[str, Any]) -> None:
    for name, value in kept.items():
        setattr(s, name, _copied(value))


def _copied(value: Any) -> Any:
    return [_copied(part) for part in value] if isinstance(value, list) else value
