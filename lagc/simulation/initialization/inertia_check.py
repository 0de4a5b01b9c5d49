"""Speeds without kinetic energy, or with a negative one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import sqrt
from typing import Any, TypeAlias

from lagc.simulation.system import System, row_gradients

Form: TypeAlias = Callable[[Any], float]  # of speeds, in any sequence of numbers

MOST_TOGETHER = 60  # speeds whose mass matrix is computed
MOST_ALONE = 1000  # speeds whose own energies are
ROUNDOFF = 1e-9  # of the energy of a speed by itself
DEPENDENT = 1e-6  # singular value of a scaled constraint gradient over the largest


def negative_speed(system: System, t: float, x: Sequence[float]) -> int | None:
    """Return the index of a speed in a motion of negative kinetic energy at (t, x): the largest entry of an
    eigenvector of the mass matrix on the motions that the constraints allow. Prescribed motions of frames do
    not count."""
    nv = system.nv
    if nv > MOST_TOGETHER:
        return None
    import numpy as np

    form, rest = _form(system, t, x)
    units = np.eye(nv)
    own = np.array([form(unit) for unit in units])
    pairs = [[form(units[i] + units[j]) if i < j else 0.0 for j in range(nv)] for i in range(nv)]
    mass = np.triu(0.5 * (np.array(pairs) - own[:, None] - own), 1)
    mass += mass.T + np.diag(own)
    if not np.isfinite(mass).all():
        return None
    # Speeds in units of equal energy; the motions that are allowed are orthogonal to the gradients.
    sizes: Any = np.array(_sizes(own.tolist(), rest))
    gradients = np.array(row_gradients(system, t, x)).reshape(-1, nv) * sizes
    lengths = np.linalg.norm(gradients, axis=1)
    _, values, rows = np.linalg.svd(gradients[lengths > 0.0] / lengths[lengths > 0.0, None])
    allowed = rows[int((values > DEPENDENT).sum()) :].T
    energies, motions = np.linalg.eigh(allowed.T @ (mass * np.outer(sizes, sizes)) @ allowed)
    if not len(energies) or energies[0] >= -ROUNDOFF * max(1.0, abs(energies).max()):
        return None
    return int(abs(allowed @ motions[:, 0]).argmax())


def sizes_of_speeds(system: System, t: float, x: Sequence[float]) -> list[float]:
    """The size that gives each speed alone the same energy at (t, x); 1 for a speed without inertia."""
    form, rest = _form(system, t, x)
    return _sizes([form(_unit(k, system.nv)) for k in range(system.nv)], rest)


def weightless_speed(system: System, t: float, x: Sequence[float]) -> int:
    """The first speed, by index, that has no kinetic energy of its own at (t, x), or -1."""
    nv = system.nv
    if nv > MOST_ALONE:
        return -1
    form, rest = _form(system, t, x)
    return next((k for k in range(nv) if form(_unit(k, nv)) <= ROUNDOFF * abs(rest)), -1)


def _sizes(own: Sequence[float], rest: float) -> list[float]:
    return [1.0 / sqrt(abs(a)) if abs(a) > ROUNDOFF * abs(rest) else 1.0 for a in own]


def _form(system: System, t: float, x: Sequence[float]) -> tuple[Form, float]:
    """v^T M v at (t, x), and the energy of the frames' own motion."""
    nq, nv = system.nq, system.nv

    def energy(v: Any) -> float:
        return system.energies(t, [*x[:nq], *map(float, v), *x[nq + nv :]])[0]

    rest = energy([0.0] * nv)
    return lambda v: energy(v) + energy([-a for a in v]) - 2.0 * rest, rest


def _unit(k: int, n: int) -> list[float]:
    return [float(i == k) for i in range(n)]
