"""Lagrange's equations of a random system by differences in 80 digits: no symbols, no rules.

Positions and axes are the only things taken from the system; velocities, momenta and
slopes are central differences with a step of 1e-14, whose error of 1e-28 is far below doubles.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import mpmath

from tests.mechanics.random_systems import (
    Functions,
    System,
    damping,
    loop_residuals,
    magnetic,
    poses,
    potential,
    rate_residuals,
    shapes,
    square,
)

mp = mpmath.mp.clone()
mp.dps = 80
STEP = mp.mpf(10) ** -14
F = Functions(mp.sin, mp.cos)
State = tuple[list[Any], list[Any], Any]


def slope(function: Callable[[Any], Any]) -> Any:
    """d(function(s))/ds at 0, for numbers and lists."""
    ahead, behind = function(STEP), function(-STEP)
    if isinstance(ahead, list):
        return [(a - b) / (2 * STEP) for a, b in zip(ahead, behind)]
    return (ahead - behind) / (2 * STEP)


class Oracle:
    """M, h, tau, G, gamma, E of a system at a state (q, v, t)."""

    def __init__(self, system: System, q: Sequence[float], v: Sequence[float], t: float) -> None:
        self.system = system
        self.q, self.v, self.t = [mp.mpf(x) for x in q], [mp.mpf(x) for x in v], mp.mpf(t)
        self.free = [i for i, link in enumerate(system.links) if link.joint == "free"]

    def qdot(self, q: Sequence[Any], v: Sequence[Any]) -> list[Any]:
        rates = iter(v)
        found = []
        for link, part in zip(self.system.links, shapes(self.system)):
            if link.joint != "free":
                found.append(next(rates))
                continue
            w, x, y, z = q[part]
            a, b, c = next(rates), next(rates), next(rates)
            found += [(-x * a - y * b - z * c) / 2, (w * a + y * c - z * b) / 2,
                      (w * b + z * a - x * c) / 2, (w * c + x * b - y * a) / 2]  # fmt: skip
        return found

    def moved(self, q: Sequence[Any], v: Sequence[Any], s: Any) -> list[Any]:
        return [x + s * d for x, d in zip(q, self.qdot(q, v))]

    def unit(self, j: int) -> list[Any]:
        return [mp.mpf(k == j) for k in range(len(self.v))]

    def velocities(self, q: Sequence[Any], v: Sequence[Any], t: Any) -> list[tuple[list[Any], list[Any]]]:
        """Velocity of the centre and angular velocity (world axes) of each link."""
        here = poses(self.system, q, t, F)
        ahead = poses(self.system, self.moved(q, v, STEP), t + STEP, F)
        behind = poses(self.system, self.moved(q, v, -STEP), t - STEP, F)
        found = []
        for (_, r), (p1, r1), (p0, r0) in zip(here, ahead, behind):
            u = [(a - b) / (2 * STEP) for a, b in zip(p1, p0)]
            rate = [[(a - b) / (2 * STEP) for a, b in zip(x, y)] for x, y in zip(r1, r0)]
            w = [sum(rate[i][k] * r[j][k] for k in range(3)) for i, j in ((2, 1), (0, 2), (1, 0))]
            found.append((u, w))
        return found

    def kinetic(self, q: Sequence[Any], v: Sequence[Any], t: Any) -> Any:
        total = mp.mpf(0)
        for link, (u, w), (_, r) in zip(
            self.system.links, self.velocities(q, v, t), poses(self.system, q, t, F)
        ):
            total += mp.mpf(link.mass) * square(u) / 2
            if link.inertia is not None:
                body = [sum(r[i][k] * w[i] for i in range(3)) for k in range(3)]
                total += sum(mp.mpf(c) * x * x for c, x in zip(link.inertia, body)) / 2
        return total

    def lagrangian(self, q: Sequence[Any], v: Sequence[Any], t: Any) -> Any:
        free = magnetic(self.system, q, v, t, F) if self.system.magnetic else 0
        return self.kinetic(q, v, t) + free

    def momentum(self, q: Sequence[Any], v: Sequence[Any], t: Any, j: int) -> Any:
        """dL/dv_j: L is a polynomial of degree 2 in v, so that a step of 1 is exact."""
        up = [x + d for x, d in zip(v, self.unit(j))]
        down = [x - d for x, d in zip(v, self.unit(j))]
        return (self.lagrangian(q, up, t) - self.lagrangian(q, down, t)) / 2

    def mass_matrix(self) -> list[list[Any]]:
        q, t, n = self.q, self.t, len(self.v)
        zero = [mp.mpf(0)] * n
        base = [self.momentum(q, zero, t, j) for j in range(n)]
        return [[self.momentum(q, self.unit(i), t, j) - base[j] for j in range(n)] for i in range(n)]

    def bias_forces(self) -> list[Any]:
        """d(p)/dt - dL/d(displacement), and w x p for body rates (Euler-Poincare)."""
        q, v, t, n = self.q, self.v, self.t, len(self.v)
        found = []
        for j in range(n):
            rate = slope(lambda s, j=j: self.momentum(self.moved(q, v, s), v, t + s, j))
            along = slope(lambda s, j=j: self.lagrangian(self.moved(q, self.unit(j), s), v, t))
            found.append(rate - along)
        if self.free:  # the first link
            p = [self.momentum(q, v, t, j) for j in range(3)]
            w = v[:3]
            for k in range(3):
                i, j = (k + 1) % 3, (k + 2) % 3
                found[k] += w[i] * p[j] - w[j] * p[i]
        return found

    def given_forces(self) -> list[Any]:
        s, q, v, t = self.system, self.q, self.v, self.t
        found = []
        speeds = self.velocities(q, v, t)
        for j in range(len(v)):
            unit = self.unit(j)
            force = -slope(lambda e, unit=unit: potential(s, self.moved(q, unit, e), t, F))
            partial = self.velocities(q, [a + b for a, b in zip(v, unit)], t)
            for i, k in s.drag:
                u = speeds[i][0]
                along = [a - b for a, b in zip(partial[i][0], u)]
                force -= sum(k * x * (1 + square(u)) * y for x, y in zip(u, along))
            for i, moment in s.torques:
                turning = [a - b for a, b in zip(partial[i][1], speeds[i][1])]
                parent = s.links[i].parent
                if parent >= 0:
                    back = [a - b for a, b in zip(partial[parent][1], speeds[parent][1])]
                    turning = [a - b for a, b in zip(turning, back)]
                force += sum(a * b for a, b in zip(moment, turning))
            if s.damping:
                force -= slope(lambda e, unit=unit: damping(s, q, [a + e * b for a, b in zip(v, unit)], t, F))
            found.append(force)
        return found

    def rates(self, q: list[Any], v: list[Any], t: Any) -> list[Any]:
        """Rates of the loops, then the velocity rows."""
        s = self.system
        loops = slope(lambda e: loop_residuals(s, self.moved(q, v, e), t + e, F))
        return [*loops, *rate_residuals(s, q, v, t, F)]

    def jacobian(self) -> list[list[Any]]:
        def along(unit: list[Any]) -> Any:
            return slope(lambda e: self.rates(self.q, [x + e * d for x, d in zip(self.v, unit)], self.t))

        columns = [along(self.unit(j)) for j in range(len(self.v))]
        return [list(row) for row in zip(*columns)]

    def gamma(self) -> list[Any]:
        q, v, t = self.q, self.v, self.t
        return [-x for x in slope(lambda e: self.rates(self.moved(q, v, e), v, t + e))]
