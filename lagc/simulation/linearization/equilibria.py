"""Equilibria of a constrained system: states at rest, and the constraint forces there.

qdot(q, v) = 0,    tau - h + G^T lam = 0,    phi(q) = 0,    psi(q, v) = 0

The unknowns are q, v and lam.  Gauss-Newton steps of least norm start from the initial state and from
random states around it.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from math import inf, pi
from typing import TYPE_CHECKING

import numpy as np

from lagc.base.records import dataclass
from lagc.simulation.linearization.derivatives import Array, Point, pseudo_inverse
from lagc.simulation.linearization.linear_model import size_of_states

if TYPE_CHECKING:
    from lagc.simulation.backends.python import NumpySystem

TRIES, FEWEST = 64, 4  # random states: the usual number and the smallest
MOST_WORK = 5e10  # operations of matrices; above it there are fewer tries
STEPS = 60
LATE = 12  # steps in which the step length must halve
HALVINGS = 10
CLOSE = 1e-12  # of the sizes: a last step
MET = 1e-9  # of the change of an equation by the sizes: a residual that is zero
DEPENDENT = 1e-10  # of the largest singular value: directions in which nothing changes
SAME = 1e-6  # of the sizes: two results are one equilibrium
MASSLESS = 1e-14  # of the inertia elsewhere: a motion without inertia, as at the cusp of a chart or curve
BETWEEN = (0.5, 0.236, 0.854)  # points of the line between two equilibria that are tested
ROUNDED = 1e-12  # of forces times sizes: energies that are 0


@dataclass(frozen=True)
class Equilibrium:
    """An equilibrium: `x` = (q, v), the multipliers, and the potential energy. `free` is the number of
    directions in which it is one of a family, by the linear equations.  `scale` is the scale of energies."""

    x: list[float]
    lam: list[float]
    energy: float
    free: int
    scale: float


def equilibria(
    system: NumpySystem, start: Sequence[float], t: float = 0.0, tries: int = TRIES, seed: int = 0
) -> list[Equilibrium]:
    """Return the equilibria found: first that from `start`, then the others by their potential energy. A
    family gives one result, the nearest to `start`, if energies tell families apart.  Raises ArithmeticError
    if all lie at singular states."""
    search = _Search(system, t)
    found: list[Equilibrium] = []
    first: list[Equilibrium] = []
    with np.errstate(all="ignore"):  # values that are not finite are detected
        for k, guess in enumerate(search.guesses(start, tries, seed)):
            reached = search.reach(guess)
            if reached is None:
                continue
            known = [i for i, other in enumerate(found) if search.is_same(reached, other)]
            if not known:
                found.append(reached)
                first += [reached] if k == 0 else []
            elif (
                search.far(reached, start) < search.far(found[known[0]], start)
                and found[known[0]] not in first
            ):
                found[known[0]] = reached
    kept = [e for e in first + sorted(found[len(first) :], key=lambda e: e.energy) if search.stays(e)]
    if found and not kept:
        raise ArithmeticError("some motion has no inertia at the equilibria found, as where coordinates or "
                              "a curve are singular: try other coordinates")  # fmt: skip
    return kept


def tries_for(system: NumpySystem, share: float = 1.0) -> int:
    """The number of random states: a share of the usual one, which is smaller for large systems, by the
    operations of their singular values (G. H. Golub, C. F. Van Loan, Matrix Computations, 4th ed., 2013,
    8.6.3)."""
    states = system.nq + system.nv
    rows, columns = states + system.nh + system.nc, states + system.nc
    most = MOST_WORK / (LATE * (4.0 * rows * columns**2 + 22.0 * columns**3))
    return max(FEWEST, int(share * min(TRIES, most)))


class _Search:
    """The search for equilibria at the time t."""

    def __init__(self, system: NumpySystem, t: float):
        self.system, self.t = system, t
        self.sizes = size_of_states(system)
        self.inertias: list[Array] = []  # along each speed, at the guesses

    def guesses(self, start: Sequence[float], tries: int, seed: int) -> Iterator[list[float]]:
        """The initial state at rest, then random states. Angles cover a whole turn.  Other coordinates are
        within twice their size around the initial value or its opposite; in every other state, within a tenth
        to a thousand times that."""
        system, chance = self.system, random.Random(seed)
        rest = [0.0] * system.nv
        yield [*start[: system.nq], *rest]
        angles, quaternions = set(system.interface.angles), system.interface.quaternions
        for k in range(tries):
            spread = 2.0 if k % 2 else 2.0 * 10.0 ** chance.uniform(-1.0, 3.0)
            q = [
                chance.uniform(-pi, pi) if i in angles
                else value * chance.uniform(-1.0, 1.0) + spread * size * chance.uniform(-1.0, 1.0)
                for i, (value, size) in enumerate(zip(start[: system.nq], self.sizes))
            ]  # fmt: skip
            for first in quaternions:
                part = [chance.gauss(0.0, 1.0) for _ in range(4)]
                q[first : first + 4] = [a / sum(b * b for b in part) ** 0.5 for a in part]
            yield [*q, *rest]

    def reach(self, guess: list[float]) -> Equilibrium | None:
        try:
            self.inertias.append(np.abs(np.diag(self._mass(guess))))
            return self._reached(np.array([*guess, *[0.0] * self.system.nc]))
        except (ArithmeticError, np.linalg.LinAlgError):
            return None

    def _reached(self, guess: Array) -> Equilibrium | None:
        z = self._solve(guess)
        if z is None:
            return None
        z = self._usual(self._rounded(z))
        n = self.system.nq + self.system.nv
        x, (_, table, columns, rows) = z[:n].tolist(), self._rows(z)
        _, sizes, right = np.linalg.svd(table * columns / rows[:, None])
        rank = int((sizes > DEPENDENT * sizes.max(initial=0.0)).sum())
        free = (right[rank:, :n] * columns[:n]).T
        moving = np.linalg.matrix_rank(free / self.sizes[:, None], tol=1e-6) if free.size else 0
        nq = self.system.nq
        scale = float(rows[nq:n].max(initial=0.0) * self.sizes[:nq].max(initial=0.0))
        return Equilibrium(x, z[n:].tolist(), self.system.energies(self.t, x)[1], int(moving), scale)

    def stays(self, one: Equilibrium) -> bool:
        """Whether all motions have inertia there: without inertia, no force need balance."""
        system = self.system
        n = system.nq + system.nv
        usual = np.nanmedian(self.inertias, axis=0)
        scale = np.sqrt(np.where(usual > 0.0, usual, 1.0))
        mass = self._mass(one.x) / np.outer(scale, scale)
        point = Point(system, self.t, one.x[:n], [0.0] * system.nv, one.lam)
        ties = point.partial("force", "acceleration")[:, system.nv :].T / scale
        _, lengths, right = np.linalg.svd(ties)
        free = right[int((lengths > DEPENDENT * lengths.max(initial=0.0)).sum()) :].T
        return not free.size or bool(np.linalg.eigvalsh(free.T @ mass @ free)[0] > MASSLESS)

    def _mass(self, x: Sequence[float]) -> Array:
        """The mass matrix M, (nv, nv)."""
        system = self.system
        point = Point(system, self.t, x[: system.nq + system.nv], [0.0] * system.nv, [0.0] * system.nc)
        found: Array = point.residual("acceleration")[: system.nv, : system.nv]
        return found

    def far(self, one: Equilibrium, start: Sequence[float]) -> float:
        """The distance of its coordinates from the start, relative to the sizes."""
        nq = self.system.nq
        return float(np.abs((np.array(one.x[:nq]) - start[:nq]) / self.sizes[:nq]).max(initial=0.0))

    def is_same(self, one: Equilibrium, other: Equilibrium) -> bool:
        """Whether two results are one equilibrium, or of one family. A family has the same energy throughout.
        If velocity constraints carry forces, the line between two members belongs to the family."""
        if not one.free or one.free != other.free:
            return bool((np.abs(np.array(one.x) - other.x) <= SAME * self.sizes).all())
        largest, scale = (max(a) for a in zip(*((abs(e.energy), e.scale) for e in (one, other))))
        if abs(one.energy - other.energy) <= SAME * largest + ROUNDED * scale:
            return True
        return self.system.nc > self.system.nh and all(self._between(one, other, share) for share in BETWEEN)

    def _between(self, one: Equilibrium, other: Equilibrium, share: float) -> bool:
        """Whether the point at this share of the way from one to the other is an equilibrium."""
        z = (1.0 - share) * np.array([*one.x, *one.lam]) + share * np.array([*other.x, *other.lam])
        for first in self.system.quaternions:
            z[first : first + 4] /= np.linalg.norm(z[first : first + 4]) or 1.0
        return self._balances(z)

    def _rounded(self, z: Array) -> Array:
        """Set values to 0 that are negligible beside the sizes, if the result is an equilibrium too. At
        singular constraints, steps end as far from it as a root of round-off."""
        n = self.system.nq + self.system.nv
        for close in (SAME, CLOSE):
            found = np.where(np.abs(z) <= close * np.concatenate([self.sizes, z[n:] * 0.0]), 0.0, z)
            if self._balances(found):
                return found
        return z

    def _balances(self, z: Array) -> bool:
        """Whether z is an equilibrium with some multipliers, which are stored in z."""
        try:
            self._balance(z)
            return self._is_met(z)
        except (ArithmeticError, np.linalg.LinAlgError):
            return False

    def _balance(self, z: Array) -> None:
        """Store the multipliers that leave the smallest forces in z."""
        n = self.system.nq + self.system.nv
        z[n:] = 0.0
        residual, table, columns, rows = self._rows(z)
        scaled = table[:, n:] * columns[n:] / rows[:, None]
        z[n:] = -columns[n:] * np.linalg.lstsq(scaled, residual / rows, rcond=DEPENDENT)[0]

    def _usual(self, z: Array) -> Array:
        """Reduce angles to within half a turn, if the result is an equilibrium too, and make the first part
        of quaternions positive."""
        interface, found = self.system.interface, z.copy()
        for first in interface.quaternions:
            part = found[first : first + 4]
            if part[np.flatnonzero(np.abs(part) > SAME)[0]] < 0.0:
                found[first : first + 4] = -part
        wound = [i for i in interface.angles if _turns(found[i])]
        if wound and self._is_met(_unwound(found, wound)):  # all together, or one by one below
            return _unwound(found, wound)
        for i in wound:
            turned = _unwound(found, [i])
            if self._is_met(turned):
                found = turned
        return found

    def _is_met(self, z: Array) -> bool:
        residual, _, _, rows = self._rows(z)
        return bool((np.abs(residual) <= MET * rows).all())

    def _solve(self, z: Array) -> Array | None:
        n = self.system.nq + self.system.nv
        self._balance(z)
        before = inf
        for k in range(STEPS):
            residual, table, columns, rows = self._rows(z)
            inverse = pseudo_inverse(table * columns / rows[:, None], DEPENDENT) / rows
            step = -inverse @ residual
            length = np.abs(step[:n]).max(initial=0.0)
            if k % LATE == LATE - 1:
                if not length < 0.5 * before:
                    break
                before = length
            most = max(1.0, np.abs(z[:n] / self.sizes).max(initial=0.0))
            z = self._damped_step(z, step, columns, inverse, min(1.0, most / length) if length else 1.0)
            if length <= CLOSE and self._is_met(z):
                return z
        return z if self._is_met(z) else None

    def _damped_step(self, z: Array, step: Array, columns: Array, inverse: Array, share: float) -> Array:
        """Step as far as the next step, with the same derivatives, becomes shorter (P. Deuflhard, Newton
        Methods for Nonlinear Problems, 2011, 3.3)."""
        moved = self._without_tiny_speeds(z + share * step * columns)
        for _ in range(HALVINGS):
            if np.linalg.norm(inverse @ self._residual(moved)) < np.linalg.norm(step):
                break
            share /= 2.0
            moved = self._without_tiny_speeds(z + share * step * columns)
        return moved

    def _without_tiny_speeds(self, z: Array) -> Array:
        """Set speeds to 0 that are negligible beside their sizes, because dry friction acts on the smallest
        ones."""
        speeds = slice(self.system.nq, self.system.nq + self.system.nv)
        z[speeds][np.abs(z[speeds]) <= CLOSE * self.sizes[speeds]] = 0.0
        return z

    def _rows(self, z: Array) -> tuple[Array, Array, Array, Array]:
        """The residuals, their derivatives, the sizes of the unknowns, and those of the equations."""
        system = self.system
        interface, nq, nv, nc = system.interface, system.nq, system.nv, system.nc
        n = nq + nv
        point = Point(system, self.t, z[:n].tolist(), [0.0] * nv, z[n:].tolist())
        own = interface.nh + nc
        residual = self._residual(z)
        quaternions = np.zeros((len(interface.quaternions), n + nc))
        for k, first in enumerate(interface.quaternions):
            quaternions[k, first : first + 4] = z[first : first + 4]
        by_state = [point.partial("qdot", "state"), point.partial("force", "state"),
                    point.partial("condition", "state")[:own]]  # fmt: skip
        table = np.vstack([np.hstack([np.vstack(by_state), np.zeros((n + own, nc))]), quaternions])
        table[nq:n, n:] = point.partial("force", "acceleration")[:, nv:]
        if not np.isfinite(table).all():
            raise ArithmeticError("not finite")
        columns = np.ones(n + nc)
        columns[:n] = self.sizes
        rows = np.abs(table[:, :n]) @ self.sizes
        rows[nq:n] += np.abs(system.stack(self.t, z[:n].tolist(), [0.0] * nv, [0.0] * nc)[self._forces])
        forces = np.abs(table[nq:n, n:]) / np.where(rows[nq:n] > 0.0, rows[nq:n], 1.0)[:, None]
        columns[n:] = 1.0 / np.where(forces.any(axis=0), forces.max(axis=0, initial=0.0), 1.0)
        rows += np.abs(table[:, n:]) @ columns[n:]
        reach = (np.abs(table[:nq, nq:n]) / self.sizes[:nq, None]).max(axis=0, initial=0.0)
        works = rows[nq:n] / np.where(reach > 0.0, reach, 1.0)  # work of a force along its speed
        rows[nq:n] *= np.maximum(1.0, DEPENDENT * works.max(initial=0.0) / np.where(works > 0.0, works, inf))
        return residual, table, columns, np.where(rows > 0.0, rows, 1.0)

    def _residual(self, z: Array) -> Array:
        """The residuals.  Raises ArithmeticError if a value is not finite."""
        system = self.system
        n, stack = system.nq + system.nv, system.interface.stack
        values = np.array(system.stack(self.t, z[:n].tolist(), [0.0] * system.nv, z[n:].tolist()))
        own = stack["condition"].start + system.nh + system.nc
        parts = [values[stack["qdot"].start : stack["qdot"].stop], values[self._forces]]
        parts.append(values[stack["condition"].start : own])
        squares = [z[first : first + 4] @ z[first : first + 4] for first in system.quaternions]
        residual = np.array([*np.concatenate(parts), *((square - 1.0) / 2.0 for square in squares)])
        if not np.isfinite(residual).all():
            raise ArithmeticError("not finite")
        return residual

    @property
    def _forces(self) -> slice:
        part = self.system.interface.stack["force"]
        return slice(part.start, part.stop)


def _turns(angle: float) -> int:
    return round((angle - SAME) / (2.0 * pi))


def _unwound(z: Array, angles: Sequence[int]) -> Array:
    """z without the whole turns of these angles."""
    found = z.copy()
    for i in angles:
        found[i] -= 2.0 * pi * _turns(z[i])
    return found
