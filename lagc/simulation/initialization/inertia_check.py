"""Speeds without kinetic energy, or with a negative one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import sqrt
from typing import TypeAlias

from lagc.simulation.system import System, row_gradients

Form: TypeAlias = Callable[[Sequence[float]], float]


_MOST = 60  # speeds: beyond, no pairs are looked at
_MOST_ALONE = 1000
_ROUNDING = 1e-9  # of the energy of a speed by itself


def negative_speed(system: System, t: float, x: Sequence[float]) -> int | None:
    """Return the index of a speed in a motion of negative kinetic energy at (t, x), by a Cholesky
    factorization of the form on the motions that the constraints allow. Prescribed motions of frames do not
    count."""
    nv = system.nv
    if nv > _MOST:
        return None
    form, rest = _form(system, t, x)
    units = [_unit(k, nv) for k in range(nv)]
    sizes = _sizes(form, rest, units)
    basis: list[list[float]] = []
    rows = [[a * b for a, b in zip(row, sizes)] for row in row_gradients(system, t, x)]
    for row in rows:
        _extend(basis, row)
    bound = len(basis)
    for unit in units:
        _extend(basis, unit)
    directions = [[a * b for a, b in zip(direction, sizes)] for direction in basis[bound:]]
    found = _negative(directions, form)
    return None if found is None else max(range(nv), key=lambda j: abs(basis[bound + found][j]))


def sizes_of_speeds(system: System, t: float, x: Sequence[float]) -> list[float]:
    """The size that gives each speed alone the same energy at (t, x); 1 for a speed without inertia."""
    form, rest = _form(system, t, x)
    return _sizes(form, rest, [_unit(k, system.nv) for k in range(system.nv)])


def _sizes(form: Form, rest: float, units: Sequence[Sequence[float]]) -> list[float]:
    own = [abs(form(unit)) for unit in units]
    return [1.0 / sqrt(a) if a > _ROUNDING * abs(rest) else 1.0 for a in own]


def weightless_speed(system: System, t: float, x: Sequence[float]) -> int:
    """The first speed, by index, that has no kinetic energy of its own at (t, x), or -1."""
    nv = system.nv
    if nv > _MOST_ALONE:
        return -1
    form, rest = _form(system, t, x)
    return next((k for k in range(nv) if form(_unit(k, nv)) <= _ROUNDING * abs(rest)), -1)


def _form(system: System, t: float, x: Sequence[float]) -> tuple[Form, float]:
    """v^T M v at (t, x), and the energy of the frames' own motion."""
    nq, nv = system.nq, system.nv

    def energy(v: Sequence[float]) -> float:
        return system.energies(t, [*x[:nq], *v, *x[nq + nv :]])[0]

    rest = energy([0.0] * nv)
    return lambda v: energy(v) + energy([-a for a in v]) - 2.0 * rest, rest


def _unit(k: int, n: int) -> list[float]:
    return [float(i == k) for i in range(n)]


def _negative(directions: Sequence[Sequence[float]], form: Form) -> int | None:
    """The first direction along which, less what those before share of it, `form` is negative."""
    n, own = len(directions), [form(direction) for direction in directions]
    table = [[0.0] * n for _ in directions]
    for k in range(n):
        for i in range(k):
            both = form([a + b for a, b in zip(directions[k], directions[i])])
            table[k][i] = table[i][k] = 0.5 * (both - own[k] - own[i])
        table[k][k] = own[k]
    for k in range(n):
        pivot = table[k][k]
        if pivot < -_ROUNDING * max(abs(own[k]), 1.0):
            return k
        for i in range(k + 1, n) if pivot > _ROUNDING * max(abs(own[k]), 1.0) else ():
            part = table[i][k] / pivot
            table[i][k + 1 :] = [a - part * b for a, b in zip(table[i][k + 1 :], table[k][k + 1 :])]
    return None


def _extend(basis: list[list[float]], vector: Sequence[float]) -> None:
    """Add the direction of `vector` that `basis`, orthonormal, does not have, if there is one."""
    length = sqrt(sum(a * a for a in vector))
    rest = [a / length for a in vector] if length > 0.0 else []
    for _ in range(2):
        for other in basis if rest else ():
            part = sum(a * b for a, b in zip(rest, other))
            rest = [a - part * b for a, b in zip(rest, other)]
    length = sqrt(sum(a * a for a in rest))
    if length > 1e-6:
        basis.append([a / length for a in rest])
