"""Derivatives of a compiled model at one state, as arrays, and those of accelerations and multipliers.

F(t, q, v, a, lam, p) = (M a - (tau - h + G^T lam); G a - gamma) = 0,      d(a, lam)/dy = -K^-1 dF/dy,

K = dF/d(a, lam) = [M, -G^T; G, 0].

Where modes change at a state, several branches meet, and forces may jump or have a kink.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from contextlib import suppress
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

from lagc.simulation.system import FAILED

if TYPE_CHECKING:
    from lagc.simulation.backends.python import NumpySystem

Array: TypeAlias = "np.ndarray[tuple[int, ...], np.dtype[np.float64]]"

ROUNDING = 1e-13  # relative to its terms: smaller values are round-off, and set to zero
LAST = 2.0**-50  # relative perturbation of a few rounding units
SHARE = 0.1  # of an entry: a change by more than this makes it round-off
FEW, ENOUGH = 3, 12  # such perturbations; one in three leaves round-off unchanged
TINY = 1e-60  # offset from a state at which a derivative has no value, such as that of norm(v) v at rest
DEPENDENT = 1e-11  # relative to the largest singular value: constraints that depend on each other


class _Perturbation:
    """Random perturbations of numbers by a few rounding units."""

    def __init__(self, seed: int) -> None:
        self.chance = random.Random(seed)

    def __call__(self, values: Sequence[float]) -> list[float]:
        return [value * (1.0 + self.chance.choice((-1, 1)) * LAST) for value in values]


class Point:
    """A compiled model with derivatives at (t, x), x = (q, v). Accelerations and multipliers are those given,
    or else those of the motion.  `clean`: entries that change by their own size under perturbations by
    rounding units are round-off, and set to 0.  `modes`: the branch, if it is not that of the state."""

    def __init__(
        self,
        system: NumpySystem,
        t: float,
        x: Sequence[float],
        a: Sequence[float] | None = None,
        lam: Sequence[float] | None = None,
        clean: bool = False,
        modes: Sequence[float] | None = None,
    ):
        self.system, self.t, self.x, self.modes = system, t, list(x), modes
        if a is None or lam is None:
            rates, own = self._rates_at(system, t, x)
            if rates is None:
                raise ArithmeticError(f"the motion is not determined at t = {t:g}")
            if clean:
                rates, own = (np.where(self._is_rounding(found, k), 0.0, found).tolist()
                              for k, found in enumerate((rates, own)))  # fmt: skip
            a, lam = rates[system.nq :] if a is None else a, own if lam is None else lam
        self.a, self.lam, self.clean = list(a), list(lam), clean
        self._groups: dict[str, Array] = {}
        self._motion: dict[str, Array] = {}

    def _rates_at(
        self, system: NumpySystem, t: float, x: Sequence[float]
    ) -> tuple[list[float] | None, list[float]]:
        """Return xdot (None if the motion is not determined) and the multipliers."""
        xdot, lam = [0.0] * system.nx, [0.0] * system.nc
        if self.modes is None:
            status = system.rhs(t, x, xdot, lam)
        else:
            status = system.rhs_on(self.modes, t, x, xdot, lam)
        return (None if status in FAILED else xdot), lam

    def _is_rounding(self, values: Sequence[float], which: int) -> Array:
        """Which of the rates (0) or multipliers (1) are round-off."""
        here = np.array(values)
        found = np.zeros(len(here), dtype=bool)
        for system, t, x in self._perturbed[:FEW]:
            rates, lam = self._rates_at(system, t, x)
            if rates is not None:
                there = np.array((rates, lam)[which][: len(here)])
                found |= np.abs(there - here) > SHARE * np.abs(here)
        return found

    @cached_property
    def stack(self) -> Array:
        """The values of all differentiated expressions."""
        return np.array(self.system.stack(self.t, self.x, self.a, self.lam, self.modes))

    def value(self, part: str) -> Array:
        """The values of one part of the stack."""
        rows = self.system.model.rows[part]
        return self.stack[rows.start : rows.stop]

    def by(self, group: str) -> Array:
        """The derivatives of the stack by a group of variables, with a and lam fixed."""
        if group not in self._groups:
            entries = self._entries(group)
            for k, other in enumerate(self.perturbed if self.clean else ()):
                if k >= FEW and not _doubtful(entries).any():
                    break
                changes = np.abs(other.by(group) - entries)
                entries = np.where(changes > SHARE * np.abs(entries), 0.0, entries)
            self._groups[group] = entries
        return self._groups[group]

    def _entries(self, group: str) -> Array:
        """The derivatives; an entry without a value has the common value of both sides, if they agree."""

        def at(side: float) -> Array:
            x = [value + side for value in self.x]
            found: Array = self.system.derivatives(group, self.t, x, self.a, self.lam, self.modes)
            return found

        entries = at(0.0)
        if not np.isfinite(entries).all():
            one, two = at(TINY), at(-TINY)
            size = float(max(np.abs(entries[np.isfinite(entries) & (entries != 0.0)]), default=1.0))
            alike = np.abs(one - two) <= ROUNDING * (np.abs(one) + size)
            both = rounded((one + two) / 2.0, size)
            entries = np.where(np.isfinite(entries) | ~alike, entries, both)
        return entries

    def rounding_rates(self) -> Array:
        """Which of the rates of q and v are round-off."""
        return self._is_rounding([*self.value("qdot"), *self.a], 0)

    @cached_property
    def _perturbed(self) -> list[tuple[NumpySystem, float, list[float]]]:
        """Systems, times and states perturbed by rounding units."""
        perturb, bind, p = _Perturbation(0), self.system.model.bind, self.system.parameters
        return [(bind(perturb(p)), perturb([self.t])[0], perturb(self.x)) for _ in range(ENOUGH)]

    @cached_property
    def perturbed(self) -> list[Point]:
        """This point with all numbers perturbed by rounding units."""
        perturb = _Perturbation(1)
        return [
            Point(s, t, x, perturb(self.a), perturb(self.lam), modes=self.modes)
            for s, t, x in self._perturbed
        ]

    def partial(self, part: str, group: str) -> Array:
        """The derivatives of one part of the stack, with a and lam fixed."""
        rows = self.system.model.rows[part]
        return self.by(group)[rows.start : rows.stop]

    def residual(self, group: str) -> Array:
        """dF/d(group), nv + nc rows."""
        return np.vstack(
            [self.partial("inertia", group) - self.partial("force", group), self.partial("row", group)]
        )

    @cached_property
    def scales(self) -> tuple[Array, Array]:
        """Scales that make K dimensionless: 1/sqrt(M_jj) for speeds, and for constraints the inverse length
        of the gradient in that metric."""
        nv, k = self.system.nv, self.residual("acceleration")
        mass = np.abs(np.diagonal(k)[:nv])
        known = mass[mass > 0.0]
        mass[mass == 0.0] = known.min() if known.size else 1.0
        speeds = 1.0 / np.sqrt(mass)
        lengths = np.sqrt(np.square(k[nv:, :nv] * speeds).sum(axis=1))
        return speeds, 1.0 / np.where(lengths > 0.0, lengths, 1.0)

    @cached_property
    def inverse(self) -> Array:
        """K^-1; with dependent constraints, that of the smallest multipliers."""
        return self.solved(np.eye(self.system.nv + self.system.nc))

    def solved(self, right: Array) -> Array:
        """K^-1 `right`, by the factors of the compiled model: for long chains they lose fewer digits than
        the condition of K suggests."""
        if self._factors is not None:
            found: Array = self.system.solved(self._factors, right)
            return found
        found = self._dense @ right
        return found + self._dense @ (right - self.residual("acceleration") @ found)

    @cached_property
    def _factors(self) -> list[float] | None:
        if self.system.interface.loading_rows:  # the factors are those without these loads
            return None
        return self.system.factors(self.t, self.x, self.modes)

    @cached_property
    def _dense(self) -> Array:
        """K^-1 from the dense matrix."""
        d, k = np.concatenate(self.scales), self.residual("acceleration")
        scaled = d[:, None] * k * d
        if not np.isfinite(scaled).all():
            raise ArithmeticError("the derivatives have no finite value there")
        found: Array = d[:, None] * pseudo_inverse(scaled, DEPENDENT) * d
        return found

    def motion(self, group: str) -> Array:
        """d(a, lam)/d(group) along the motion."""
        if group not in self._motion:
            self._motion[group] = -self.solved(self.residual(group))
        return self._motion[group]

    def sizes(self, group: str) -> Array:
        """The sums of magnitudes of the terms of d(a, lam)/d(group)."""
        found: Array = np.abs(self.inverse) @ self.parts(group)
        return found

    def unsure(self, group: str) -> Array:
        """The sizes that round-off of d(a, lam)/d(group) is relative to. For long chains they are far smaller
        than the sums of terms, as perturbations by rounding units show."""
        found, terms = np.abs(self.motion(group)), self.sizes(group)
        changes = np.zeros_like(found)
        for k, other in enumerate(self.perturbed):
            if k >= FEW and not ((SHARE * found > changes) & (found <= ROUNDING * terms)).any():
                break
            changes = np.maximum(changes, np.abs(other.motion(group) - self.motion(group)))
        return np.minimum(terms, found + changes / (SHARE * ROUNDING))

    def parts(self, group: str) -> Array:
        """The sums of magnitudes of the terms of dF/d(group)."""
        inertia, force, row = (np.abs(self.partial(part, group)) for part in ("inertia", "force", "row"))
        return np.vstack([inertia + force, row])

    def rate_sizes(self, group: str, of_motion: Array | None = None) -> Array:
        """The sizes of d(rate)/d(group), with those of d(a, lam)/d(group) from `sizes` or as given."""
        of_motion = self.sizes(group) if of_motion is None else of_motion
        return np.vstack([np.abs(self.partial("qdot", group)), of_motion[: self.system.nv]])

    def total(self, part: str, group: str) -> Array:
        """The derivatives of qdot, acceleration, multiplier, rate = (qdot, acceleration), indicator or
        output, along the motion."""
        nv = self.system.nv
        if part in ("acceleration", "multiplier"):
            return self.motion(group)[:nv] if part == "acceleration" else self.motion(group)[nv:]
        if part == "rate":
            return np.vstack([self.partial("qdot", group), self.motion(group)[:nv]])
        found = self.partial(part, group)
        if part == "output" or (part == "indicator" and self.system.interface.late_relations):
            found = found + self.partial(part, "acceleration") @ self.motion(group)
        return found


def _doubtful(entries: Array) -> Any:
    """Which entries may be round-off relative to the largest of their rows or columns; all of a single
    column."""
    sizes = np.abs(entries)
    return (sizes > 0.0) & ((sizes <= ROUNDING * largest_beside(entries)) | (entries.shape[1] == 1))


def largest_beside(entries: Array) -> Any:
    """The largest magnitude in the row or the column of each entry."""
    sizes = np.abs(entries)
    return np.maximum(sizes.max(axis=0, initial=0.0), sizes.max(axis=1, initial=0.0, keepdims=True))


def pseudo_inverse(table: Array, dependent: float) -> Any:
    """Return the pseudo-inverse, where singular values below the share `dependent` of the largest count as
    zero. A square matrix whose condition, by Frobenius norms, is small has its inverse, in a tenth of the
    time."""
    if table.shape[0] == table.shape[1]:
        with suppress(np.linalg.LinAlgError):
            found = np.linalg.inv(table)
            if np.linalg.norm(table) * np.linalg.norm(found) * dependent < 1.0:
                return found
    return np.linalg.pinv(table, rcond=dependent)


def rounded(found: Array, terms: Array | float) -> Array:
    """`found` with 0 for values that are round-off of their terms."""
    return np.where(np.abs(found) <= ROUNDING * terms, 0.0, found)


AT = 16.0  # times the round-off of an event indicator: it is at its crossing
BESIDE = 1e-6  # of the sizes of states: the distance of points on either side
JUMP = 1e-9  # of the terms of rates: smaller differences are none
ALIKE = 1e-12  # of entries: smaller differences are round-off


class Branch(NamedTuple):
    """The branch beyond one event indicator."""

    words: str
    modes: list[float]


def branches(point: Point, sizes: Array) -> tuple[list[float] | None, list[Branch]]:
    """The modes with all indicators that change at the state on their larger side, and the branch beyond each
    of them. None if no mode changes there.  `sizes` are those of states.  Indicators of time alone do not
    count."""
    system = point.system
    at = _changing(point)
    if not at:
        return None, []
    directions = {}
    for k in at:
        slope = point.partial("indicator", "state")[k] * sizes
        if slope.any():
            directions[k] = sizes * slope / np.abs(slope).max()
    if not directions:
        return None, []
    own = system.modes(point.t, point.x)

    def beyond(signs: dict[int, float]) -> list[float]:
        place = point.x + BESIDE * sum(signs[k] * direction for k, direction in directions.items())
        there = system.modes(point.t, place.tolist())
        return [there[k] if k in at else mode for k, mode in enumerate(own)]

    everywhere = dict.fromkeys(directions, 1.0)
    others = [Branch(system.interface.relations[k], beyond({**everywhere, k: -1.0})) for k in directions]
    return beyond(everywhere), others


def _changing(point: Point) -> list[int]:
    """The relations whose indicators are at their crossing, to round-off."""
    system, interface = point.system, point.system.interface
    if not interface.relations:
        return []
    sides, modes = point.value("indicator"), system.modes(point.t, point.x)
    rows, n = interface.stack["indicator"], len(interface.relations)
    doubt = np.zeros(n)
    for other in point.perturbed:
        there = other.system.stack(other.t, other.x, other.a, other.lam, modes)[rows.start : rows.stop]
        doubt = np.maximum(doubt, np.abs(np.array(there) - sides))
    edges = [0.0] * (2 * n)
    if any(interface.counted_relations):
        system.model.module["fn_edges_on"](modes, edges)
    found = []
    for k in range(interface.timed_relations, n):
        places = edges[2 * k : 2 * k + 2] if interface.counted_relations[k] else [0.0]
        if k in interface.noted and min(abs(sides[k] - place) for place in places) <= AT * doubt[k]:
            found.append(k)
    return found


def jumps(point: Point, one: Sequence[float], two: Sequence[float], far: Array) -> bool:
    """Whether rates differ between two branches; `far` are sizes of states."""
    found = []
    for modes in (one, two):
        rates, lam = [0.0] * point.system.nx, [0.0] * point.system.nc
        if point.system.rhs_on(modes, point.t, point.x, rates, lam) in FAILED:
            return True
        found.append(np.array(rates[: len(point.x)]))
    terms = point.rate_sizes("state") @ far + np.abs(found[0]) + np.abs(found[1])
    return bool((np.abs(found[0] - found[1]) > JUMP * terms).any())


def differing(one: Array, two: Array) -> list[tuple[int, ...]]:
    """The indices of entries that differ, the largest relative difference first."""
    sizes = np.abs(one) + np.abs(two)
    share = np.divide(np.abs(one - two), sizes, out=np.zeros_like(sizes), where=sizes > 0.0)
    places = [tuple(map(int, place)) for place in np.argwhere(share > ALIKE)]
    return sorted(places, key=lambda place: -share[place])
