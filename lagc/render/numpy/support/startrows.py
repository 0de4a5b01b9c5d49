"""The unknowns and conditions of a consistent start: their sizes, and how far a point is from a start.

The unknowns y are q, v, and the rates that were stated though declared speeds replace them.  The
conditions are phi = 0, psi = 0, the `initial` section, rate - value = 0 for those rates, and unit
quaternions.  Each unknown has a level, from UNSTATED (0) to FIXED.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf, sqrt

from lagc.render.numpy.support.quaternions import with_unit_length

# -- what follows is part of generated modules --

UNSTATED = 0
DECLARED = 1
SCENE = 2
RUN = 3
FIXED = 4
ACCEPTED = 1e-9  # scaled residual at which a start is taken, when it can be improved no more
LAST = 2.0**-50  # of a position: a change of its last places
SLIGHT = 2.0**-10  # of the weights: what every row is judged against, and how far stated values move


class Conditions:
    """The conditions of a consistent start.

    `evaluate(t, x)` gives c, J and sizes: residuals, derivatives row by row (row i ends at `ends[i]`, with
    `columns` of the unknowns), sizes of the terms.  `measures()`: the stated rates, and the largest
    parameter of each unit.  `units[i]` is the number of the unit of unknown i; `angles` are the
    coordinates that are angles.
    """

    def __init__(
        self,
        nq: int,
        nv: int,
        quaternions: Sequence[int],
        units: Sequence[int],
        angles: Sequence[int],
        ends: Sequence[int],
        columns: Sequence[int],
        evaluate: Callable[[float, Sequence[float]], tuple[list[float], list[float], list[float]]],
        measures: Callable[[], tuple[list[float], list[float]]],
    ):
        self.nq, self.nv, self.quaternions = nq, nv, quaternions
        self.units, self.angles = units, angles
        self.own = len(ends)
        self.ends, self.columns = list(ends), list(columns)
        for k in quaternions:
            self.ends.append(len(self.columns) + 4)
            self.columns += [k, k + 1, k + 2, k + 3]
        self.evaluate, self.measures = evaluate, measures


class Meeting:
    """Where conditions meet, near the guess `x` at time t.

    `levels` of q, v and the stated rates; `rows`: the conditions that count, all where None.
    """

    def __init__(
        self,
        conditions: Conditions,
        t: float,
        x: Sequence[float],
        levels: Sequence[int],
        rows: Sequence[int] | None = None,
    ):
        self.conditions, self.t = conditions, t
        self.rates, self.largest = conditions.measures()
        self.state = conditions.nq + conditions.nv
        self.y = [*x[: self.state], *self.rates]
        self.n = len(self.y)
        self.levels = list(levels)
        self.part = [False] * self.n  # of a quaternion, behind its first
        for k in conditions.quaternions:
            self.levels[k] = max(self.levels[k : k + 4])
            for i in range(k + 1, k + 4):
                self.levels[i], self.part[i] = self.levels[k], True
        with_unit_length(self.y, conditions.quaternions)
        self.home = self.y[:]
        self.free = [level == UNSTATED for level in self.levels]
        self.confine(list(range(len(conditions.ends))) if rows is None else rows)
        self.ease = SLIGHT  # of stated values that move
        self.weights, self.widths = self.weigh()

    def confine(self, rows: Sequence[int]) -> None:
        """Look at `rows`, conditions of positions first, and at the unknowns that they hold."""
        nq = self.conditions.nq
        self.settled: list[float] = []  # see `Alone`
        self.positions = [i for i in rows if max(self.columns(i), default=0) < nq]
        self.motions = [i for i in rows if i not in self.positions]
        self.rows = [*self.positions, *self.motions]
        self.used = [False] * self.n
        for i in self.rows:
            for j in self.columns(i):
                self.used[j] = True

    def columns(self, i: int) -> list[int]:
        ends = self.conditions.ends
        return self.conditions.columns[ends[i - 1] if i > 0 else 0 : ends[i]]

    def evaluate(self, y: list[float]) -> tuple[list[float], list[float], list[float]]:
        c, jacobian, sizes = self.conditions.evaluate(self.t, y[: self.state])
        first = self.conditions.own - len(self.rates)
        for k in range(len(self.rates)):
            c[first + k] -= y[self.state + k]
            sizes[first + k] += abs(y[self.state + k])
        for k in self.conditions.quaternions:
            a, b, e, d = y[k : k + 4]
            c.append(0.5 * (a * a + b * b + e * e + d * d - 1.0))
            sizes.append(1.0)
            jacobian += [a, b, e, d]
        return c, jacobian, sizes

    def weigh(self) -> tuple[list[float], list[float]]:
        """The size of each unknown: its own; that of others of its unit; what changes a row by the size of
        its terms, of the unknown of its unit that the row depends on most; that of a parameter of its unit;
        1.  And the size of the largest of its unit."""
        y, units = self.home, self.conditions.units
        _, jacobian, sizes = self.evaluate(y)
        self.terms = sizes  # of each condition at the guess
        blurred = self.blurred(y, jacobian, y)
        common = [0.0] * len(self.largest)
        for i in range(self.n):
            common[units[i]] = max(common[units[i]], abs(y[i]))
        reach = [0.0] * self.n
        k = 0
        for i, end in enumerate(self.conditions.ends):
            steepest = [0.0] * len(self.largest)
            while k < end:
                unit, slope = units[self.conditions.columns[k]], abs(jacobian[k])
                if steepest[unit] < slope < inf and not blurred[k]:
                    steepest[unit] = slope
                k += 1
            for j in self.columns(i) if 0.0 < sizes[i] < inf else ():
                slope = steepest[units[j]]
                if slope > 0.0 and (reach[j] == 0.0 or sizes[i] / slope < reach[j]):
                    reach[j] = sizes[i] / slope
        weights = [0.0] * self.n
        for i in range(self.n):
            weight = abs(y[i])
            if self.levels[i] == UNSTATED or weight == 0.0:
                weight = common[units[i]]
            if weight == 0.0:
                weight = reach[i]
            if weight == 0.0:
                weight = self.largest[units[i]]
            weights[i] = weight if 1e-290 < weight < 1e290 else 1.0
        widths = [max(weights[i], min(common[units[i]], 1e290)) for i in range(self.n)]
        for found in (weights, widths):
            for i in self.conditions.angles:
                found[i] = min(found[i], 1.0)
            for k in self.conditions.quaternions:
                found[k : k + 4] = [1.0, 1.0, 1.0, 1.0]
        return weights, widths

    def blurred(self, y: list[float], jacobian: list[float], sizes: list[float]) -> list[bool]:
        """Of each derivative at y, whether it is rounding: it changes by as much as it is where positions,
        of these `sizes`, change in their last places."""
        near = y[:]
        for i in range(self.conditions.nq):
            near[i] += (LAST if i % 2 == 0 else -LAST) * max(abs(y[i]), abs(sizes[i]))
        return [0.0 < abs(a) <= abs(b - a) for a, b in zip(jacobian, self.evaluate(near)[1])]

    def weight(self, i: int) -> float:
        """How far unknown i moves where others could move instead."""
        return self.weights[i] if self.levels[i] == UNSTATED else self.ease * self.weights[i]

    def scales(self, y: list[float], jacobian: list[float], sizes: list[float]) -> list[float]:
        """What the residual of each row at y is judged against: its terms, and what the weights change it
        by, but not beyond its terms at the guess, or those of unknowns that are there.  A large coefficient
        of what is zero so far excuses nothing.  Where speeds meet, positions are known to their widths."""
        found, k, columns = [0.0] * len(sizes), 0, self.conditions.columns
        for i, end in enumerate(self.conditions.ends):
            total, own, there, posture = 0.0, 0.0, 0.0, 0.0
            while k < end:
                j = columns[k]
                slope = abs(jacobian[k])
                if j < self.conditions.nq <= columns[end - 1]:
                    posture += slope * self.widths[j]
                total += slope * self.weights[j]
                own += slope * abs(y[j])
                if abs(y[j]) >= SLIGHT * self.weights[j]:
                    there += slope * abs(y[j])
                k += 1
            slight = SLIGHT * total
            known = self.terms[i] if self.terms[i] > 0.0 else there
            most = known + SLIGHT * (own + posture)
            found[i] = sizes[i] + (most if known > 0.0 and most < slight else slight)
        return found

    def worst(self, y: list[float], rows: list[int]) -> tuple[float, int]:
        """The largest scaled residual of `rows`, infinity where one is not a number, and its row."""
        c, jacobian, sizes = self.evaluate(y)
        scales = self.scales(y, jacobian, sizes)
        worst, row = 0.0, -1
        for i in rows:
            size = ratio_of(c[i], scales[i])
            if not size <= worst:
                worst, row = size if size == size else inf, i
                if worst == inf:
                    break
        return worst, row


def ratio_of(value: float, scale: float) -> float:
    return 0.0 if value == 0.0 else abs(value) / scale if 0.0 < scale < inf else inf


def norm_of(c: list[float], scales: list[float], rows: list[int]) -> float:
    """Of the scaled residuals; infinity where one is not a number."""
    total = 0.0
    for i in rows:
        size = ratio_of(c[i], scales[i])
        total += size * size
    return sqrt(total) if total == total else inf
