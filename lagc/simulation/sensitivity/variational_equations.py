"""What a motion changes by when parameters and starts do: S = dx/dtheta along its steps.

    S' = f_x S + f_theta,      S(0) = dx0/dtheta

on the stages of each step of the motion, by the same method: the derivative of the steps themselves (H. G.
Bock, Numerical treatment of inverse problems in chemical reaction kinetics, 1981; Hairer, Norsett, Wanner,
*Solving Ordinary Differential Equations I*, section II.6).  The error of S is estimated as that of the
motion is, and a step that is too long for S is made again, shorter.  After each, S is put back on the
tangents of the constraints.  Where a switch changes at a time that depends on theta S jumps, by
(f- - f+) dt/dtheta.
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
    """k_i = f(t + c_i h, x + h sum a_ij k_j), x1 = x + h sum b_i k_i.  Rows go over the stages, the rate at
    the new state and the stages of dense output, see `lagc.kernels.integrators.tableaus`."""

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
        """The error of a step, entry by entry; `table` are the rates at stages and new state."""
        first, *others = (h * combined(row, table) for row in self.error)
        if not others:
            return np.abs(first)
        size = np.hypot(first, 0.1 * others[0])
        return np.divide(np.square(first), size, out=np.zeros_like(size), where=size > 0.0)

    def coefficients(self, old: Array, new: Array, table: Array, h: float) -> list[Array]:
        """Of dense output of a step, `table` with the stages for it."""
        way, first, last = new - old, table[0], table[self.stages]
        bend = h * first - way
        return [old, way, bend, way - h * last - bend, *(h * combined(row, table) for row in self.dense)]


def within(coefficients: Sequence[Array], part: float) -> Array:
    """Dense output at this part of a step."""
    *lower, value = coefficients
    for j in range(len(lower) - 1, -1, -1):
        value = lower[j] + (part if j % 2 == 0 else 1.0 - part) * value
    return value


def combined(row: Array, table: Array) -> Array:
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


SHORTEST = 1e-12  # of the time of the run: of a step that is made again
SHAKEN = 9e-16  # of a state: four units of its last place
FADING = 0.9  # from step to step, of the rounding that was heard
STEEPEST = 20.0  # power of the time by which S departs from zero
SAME = 1e-6  # of the time of a run: where two of its integrations end

Progress = Callable[[float], None]


@dataclass
class Followed:
    """S at the recorded times, (times, nq + nv, directions), NaN behind `reached`; in each kind of states,
    by directions, `rounding`: what it may add up to, `terms`: the largest of what is added up at changes;
    `passed`: the changes so far at the recorded times.  Of the directions `lost`, where there are any, the
    others could go on."""

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
    """The equations of S at one place."""

    point: Point
    by_state: Array
    by_parameter: Array  # of each direction

    def rates(self, own: Array) -> Array:
        found: Array = self.by_state @ own + self.by_parameter
        return found


class Variation:
    def __init__(
        self,
        system: NumpySystem,
        directions: Sequence[Direction],
        start: Array,
        options: Options,
        rests: bool,
        most: int,
    ):
        """`start`: S(0), by the directions; `rests`: the motion stays where it starts; `most`: so many
        steps are made."""
        self.system, self.rests, self.start, self.most = system, rests, start, most
        self.options = Options(**vars(options))  # its own: the longest step changes
        self.by_p = [k for k, d in enumerate(directions) if d.parameter is not None]
        self.columns = [d.parameter for d in directions if d.parameter is not None]
        self.table, self.longest = tableau(options.method), options.max_step
        kinds = system.interface.kinds
        self.of_kind = np.array([[kind == k for kind in kinds] for k in sorted(set(kinds))])
        self.kind = np.argmax(self.of_kind, axis=0)
        self.evaluations = 0

    def along(self, x0: Sequence[float], times: Sequence[float], progress: Progress | None) -> Followed:
        s = self.system.model.module["Integrator"](self.system.equations(), self.options, times[0], list(x0))
        n, m = self.start.shape
        values, of_kind = np.full((len(times), n, m), np.nan), np.zeros((len(self.of_kind), m))
        found = Followed(values, of_kind, of_kind.copy(), np.zeros(len(times), dtype=int), 1, 0, 0, 0)
        self.sizes, self.faint = self._largest(self.start), np.zeros_like(found.rounding)
        self.pace = inf  # what S lets a step be
        self.heard = np.zeros_like(self.sizes)  # what rounding of states changes its rates by
        found.values[0] = now = self.start
        self.last: Slopes | None = None  # where the next step begins
        modes = list(s.modes) if self.system.interface.switches else []
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
                    raise Stopped("the motion could not be followed there once more")
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
                        if times[found.reached - 1] == s.t:  # what is recorded is behind all that is done
                            found.values[found.reached - 1] = now
                            found.passed[found.reached - 1] += 1
                if self.rests:
                    s.x[:] = x0
                if progress is not None:
                    progress(s.t)
                if found.steps + found.rejected > self.most:
                    raise Stopped("they ask for far more steps than the motion")
        except Stopped as reason:
            found.message, found.lost = f"at t = {s.t:.6g} s: {reason}", reason.lost
        except ArithmeticError as error:
            found.message = f"at t = {s.t:.6g} s: {error}"
        except KeyboardInterrupt:
            found.message, found.interrupted = f"interrupted at t = {s.t:.6g} s", True
        found.evaluations = self.evaluations
        return found

    def _add_up(self, terms: Array, found: Followed) -> None:
        """What the terms of S at a change bring to what it is judged by."""
        largest = self._largest(terms)
        found.terms, self.sizes = np.maximum(found.terms, largest), np.maximum(self.sizes, largest)
        self.faint += FAINT * largest
        found.rounding += FAINT * largest

    # -- one step --

    def _step(self, s: Any, now: Array, stop: float, found: Followed) -> tuple[int, Array, Array]:
        """One step of the motion that is not too long for S: S behind it, and its rates at the stages."""
        kept, grown, listened = _kept(s), np.zeros_like(self.sizes), False
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
            faint = FAINT * (terms + self._tied(last.point, new)) + h * self.heard
            faint += h * self._largest(np.abs(first.by_state) @ (self.faint + faint)[self.kind])
            grown = np.maximum(grown, self._known(new, errors, terms))
            error = _norm(errors, (self._scale(np.maximum(terms, grown), new) + faint)[self.kind])
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
            if not listened:
                listened, self.heard = True, np.maximum(FADING * self.heard, self._listen(s, first, now))
            found.rejected += 1
            _restore(s, kept)
        self.last = last
        return status, new, table

    def _scale(self, terms: Array, new: Array) -> Array:
        """What errors are judged by: the largest so far, or what the step changes that by; of what was zero,
        what it is then."""
        sizes = np.maximum(self.sizes, terms)
        return self.options.rtol * np.where(sizes > 0.0, sizes, self._largest(new))

    def _known(self, new: Array, errors: Array, terms: Array) -> Array:
        """How large S is at the end of a step, of each kind, where it is known to half of that and grows as
        a power does.  What departs from zero by one that no method follows, as behind the kink of Hertz'
        contact, is as wrong in every short step, by its own size then: it is judged by what it comes to."""
        sizes = self._largest(new)
        return np.where((2.0 * self._largest(errors) < sizes) & (terms <= STEEPEST * sizes), sizes, 0.0)

    def _listen(self, s: Any, first: Slopes, now: Array) -> Array:
        """What the rates of S change by with last places of the states: differences of what is large."""
        x, modes = np.array(s.x_old), list(s.modes_old) if self.system.interface.switches else None
        perturb = np.where(np.arange(len(x)) % 2 == 0, 1.0 + SHAKEN, 1.0 - SHAKEN)
        beside = self._slopes(self._point(s.t_old, x * perturb, np.array(s.k[0]), modes))
        return self._largest(beside.rates(now) - first.rates(now))

    def _stages(self, s: Any, now: Array) -> tuple[Array, Array, Slopes, Slopes]:
        """S behind the last step, on the constraints, and its rates at the stages and there; the equations of
        S where the step begins and ends."""
        rates, table, t, h, x = np.array(s.k), self.table, s.t_old, s.h_old, np.array(s.x_old)
        modes = list(s.modes_old) if self.system.interface.switches else None
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
        """What the terms of the rates of S add up to, the largest of each kind, with entries that cancel as
        large as others of the kind."""
        table = slopes.point.reach("state")
        found = np.zeros_like(own)
        for mask in self.of_kind:
            found += table[:, mask].max(axis=1)[:, None] * np.abs(own[mask]).sum(axis=0)
        if self.columns:
            found[:, self.by_p] += slopes.point.reach("parameter")[:, self.columns]
        return self._largest(found)

    def _tangent(self, point: Point, own: Array) -> Array:
        """S with phi_q S_q + phi_theta = 0, and the same of psi, by the shortest way in the metric of the
        mass matrix; of quaternions no change of length."""
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
            missed = np.zeros((nh + nc, own.shape[1]))
            if self.columns:
                missed[:, self.by_p] = point.partial("condition", "parameter")[: nh + nc, self.columns]
            phi = missed[:nh] + rows[:nh, :nq] @ own[:nq]
            own[:nq] -= point.partial("qdot", "state")[:, nq:] @ (inverse[:nv, nv : nv + nh] @ phi)
            psi = missed[nh:] + rows[nh:] @ own
            own[nq:] -= inverse[:nv, nv:] @ psi
        return own

    def _tied(self, point: Point, own: Array) -> Array:
        """What the terms of these conditions move S by, the largest of each kind."""
        system = self.system
        nq, nv, nh, nc = system.nq, system.nv, system.nh, system.nc
        if not nc:
            return np.zeros((len(self.of_kind), own.shape[1]))
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
        """S at the times of the last step."""
        coefficients: list[Array] = []
        while found.reached < len(times) and times[found.reached] <= s.t:
            t = times[found.reached]
            value = new
            if t < s.t:
                _, x = s.at(t)
                coefficients = coefficients or self._coefficients(s, old, new, table)
                value = within(coefficients, (t - s.t_old) / s.h_old)
                if self.system.nc or self.system.quaternions:
                    still = [0.0] * self.system.nv, [0.0] * self.system.nc
                    value = self._tangent(Point(self.system, t, x, *still), value)
            found.values[found.reached] = value
            found.reached += 1

    def _ended(self, s: Any, now: Array, times: Sequence[float], found: Followed) -> None:
        """S at the last time, where the run ends by itself, but for what its time is off by."""
        if found.reached == len(times) - 1 and times[-1] - s.t <= SAME * s.t:
            found.values[-1] = now
            found.reached += 1
        if found.reached < len(times):
            raise Stopped("the motion ends earlier once more")

    def _coefficients(self, s: Any, old: Array, new: Array, table: Array) -> list[Array]:
        """Of dense output of S, at the further stages that dense output of the motion has."""
        rates, own, h = np.array(s.k), self.table, s.h_old
        modes = list(s.modes_old) if self.system.interface.switches else None
        for j, (c, row) in enumerate(zip(own.extra_c, own.extra_a)):
            k = own.stages + 1 + j
            at = np.array(s.x_old) + h * combined(row, rates)
            point = self._point(s.t_old + c * h, at, rates[k], modes)
            table[k] = self._slopes(point).rates(old + h * combined(row, table))
        return own.coefficients(old, new, table, h)

    def _largest(self, values: Array) -> Array:
        """Of each kind of states, by directions."""
        sizes = np.abs(values)
        return np.array([sizes[mask].max(axis=0, initial=0.0) for mask in self.of_kind])


def _norm(errors: Array, weights: Array) -> float:
    """Root mean square over the states, the largest of all directions; what has no weight does not count."""
    parts = np.divide(errors, weights, out=np.zeros_like(errors), where=weights > 0.0)
    return float(np.sqrt(np.square(parts).mean(axis=0)).max(initial=0.0))


def _kept(s: Any) -> dict[str, Any]:
    """All of a state on its way."""
    names: tuple[str, ...] = vars(type(s).__base__)["__slots__"]
    return {name: _copied(getattr(s, name)) for name in names}


def _restore(s: Any, kept: dict[str, Any]) -> None:
    for name, value in kept.items():
        setattr(s, name, _copied(value))


def _copied(value: Any) -> Any:
    return [_copied(part) for part in value] if isinstance(value, list) else value
