"""A consistent start: what nobody stated moves first, what was stated only where it has to.

The unknowns y are q, v, and the rates that were stated though declared speeds replace them.  The
conditions are phi = 0, psi = 0, the `initial` section, rate - value = 0 for those rates, and unit
quaternions.  Each unknown has a level, from UNSTATED (0) to FIXED.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import floor, inf, sqrt

from lagc.render.numpy.support.base import INCONSISTENT, NOT_FINITE, OK
from lagc.render.numpy.support.leastnorm import least_norm

# -- what follows is part of generated modules --

UNSTATED = 0
DECLARED = 1
SCENE = 2
RUN = 3
FIXED = 4
ACCEPTED = 1e-9  # scaled residual at which a start is taken, when it can be improved no more
CLOSE = 1e-13  # at which one is left as it is
EXACT = 1e-15  # at which the iteration ends
NEWTON_STEPS = 60
SHORTEST = 2.0**-14  # part of a step that is tried at last
SLIGHT = 2.0**-10  # of the weights: what every row is judged against, and how far stated values move
SPREADS = (0.0, 0.01, 0.1, 0.5, 1.0, 1.0, 2.0, 2.0)  # of the widths: how far from the guess attempts begin
BESIDE = 2  # the spread that leaves a singular guess well behind
NEAR = 8.0  # weights from the guess: a start farther off is not taken before others are sought
HOMEWARD = 20  # steps back towards the guess
TURN = 6.283185307179586
MOST_TRIALS = 2000  # sets of stated values of one level that are tried
FOLLOWING = (1e-11, 1e-5)  # of its length: the rest of a row that follows from others


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


class Consistency:
    """The search for values of the unknowns near the guess `x` that meet the conditions at time t.

    `levels` of q, v and the stated rates; `rows`: the conditions that count, all where None.
    Afterwards `y` is the best that was found; `culprit` the row that misses most, or the unknown that
    is not finite.
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
        self.rows = list(range(len(conditions.ends))) if rows is None else list(rows)
        self.levels = list(levels)
        self.part = [False] * self.n  # of a quaternion, behind its first
        for k in conditions.quaternions:
            self.levels[k] = max(self.levels[k : k + 4])
            for i in range(k + 1, k + 4):
                self.levels[i], self.part[i] = self.levels[k], True
        self.lengths(self.y)
        self.home = self.y[:]
        self.free = [level == UNSTATED for level in self.levels]
        self.positions = [i for i in self.rows if max(self.columns(i), default=0) < conditions.nq]
        self.motions = [i for i in self.rows if i not in self.positions]
        self.rows = [*self.positions, *self.motions]
        self.used = [False] * self.n
        for i in self.rows:
            for j in self.columns(i):
                self.used[j] = True
        self.culprit = -1
        self.ease = SLIGHT  # of stated values that move
        self.trials = 0
        self.begin = 0  # the spread that led to a start
        self.other = 0  # the one that did where most was free
        self.weights, self.widths = self.weigh()

    def columns(self, i: int) -> list[int]:
        ends = self.conditions.ends
        return self.conditions.columns[ends[i - 1] if i > 0 else 0 : ends[i]]

    def lengths(self, y: list[float]) -> None:
        """Unit length for the quaternions."""
        for k in self.conditions.quaternions:
            a, b, c, d = y[k : k + 4]
            length = sqrt(a * a + b * b + c * c + d * d)
            y[k : k + 4] = (
                [a / length, b / length, c / length, d / length] if length > 0.0 else [1.0, 0.0, 0.0, 0.0]
            )

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
        """The size of each unknown: its own; that of others of its unit; what changes its rows by the
        size of their terms; that of a parameter of its unit; 1.  And the size of the largest of its unit."""
        y, units = self.home, self.conditions.units
        _, jacobian, sizes = self.evaluate(y)
        common = [0.0] * len(self.largest)
        for i in range(self.n):
            common[units[i]] = max(common[units[i]], abs(y[i]))
        reach = [0.0] * self.n
        k = 0
        for i, end in enumerate(self.conditions.ends):
            while k < end:
                j, slope = self.conditions.columns[k], abs(jacobian[k])
                if 0.0 < slope < inf and 0.0 < sizes[i] < inf:
                    way = sizes[i] / slope
                    if reach[j] == 0.0 or way < reach[j]:
                        reach[j] = way
                k += 1
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

    def weight(self, i: int) -> float:
        """How far unknown i moves where others could move instead."""
        return self.weights[i] if self.levels[i] == UNSTATED else self.ease * self.weights[i]

    # -- the choice of what moves --

    def run(self) -> int:
        """OK, INCONSISTENT or NOT_FINITE."""
        for i in range(self.n):
            if not abs(self.home[i]) < inf:
                self.culprit = i
                return NOT_FINITE
        if self.solve(0, len(SPREADS)):
            return OK
        top = DECLARED
        while top < FIXED:
            if top in self.levels:
                self.release(top)
                if self.solve(0, len(SPREADS)):
                    break
            top += 1
        if top == FIXED:
            self.culprit = self.worst(self.y, self.rows)[1]
            return INCONSISTENT
        self.other = self.begin
        while top > UNSTATED:
            if top in self.levels:
                self.choose(top)
                self.solve(0, len(SPREADS))
            top -= 1
        return OK

    def release(self, level: int) -> None:
        """Let everything move that is stated at `level`."""
        for i in range(self.n):
            if self.levels[i] == level and self.used[i]:
                self.free[i] = True

    def set(self, i: int, free: bool) -> None:
        """Let the value at i move or hold it, a quaternion as a whole."""
        self.free[i] = free
        j = i + 1
        while j < self.n and self.part[j]:
            self.free[j] = free
            j += 1

    def choose(self, level: int) -> None:
        """Of the values of `level`, which all move, let as few move as possible, and as little."""
        values = [i for i in range(self.n) if self.levels[i] == level and self.used[i] and not self.part[i]]
        moves = [self.move(i) for i in values]
        for i in values:
            self.set(i, False)
        self.trials = 0
        for count in range(len(values) + 1):
            if self.trials + _subsets(len(values), count) > MOST_TRIALS:
                break
            if self.fewest(values, count):
                return
        for i in values:
            self.set(i, True)
        order = sorted(range(len(values)), key=lambda k: moves[k])
        for k in order:
            self.set(values[k], False)
            if not self.attempts():
                self.set(values[k], True)

    def fewest(self, values: list[int], count: int) -> bool:
        """Let `count` of `values` move, those that have to move least; whether there are any."""
        picked = list(range(count))
        best: list[int] = []
        least, found = inf, False
        while True:
            for k in picked:
                self.set(values[k], True)
            if self.attempts():
                total = 0.0
                for k in picked:
                    total += self.move(values[k])
                if total < least:
                    best, least, found = picked[:], total, True
            for k in picked:
                self.set(values[k], False)
            last = count - 1
            while last >= 0 and picked[last] == len(values) - count + last:
                last -= 1
            if last < 0:
                break
            picked[last] += 1
            for k in range(last + 1, count):
                picked[k] = picked[k - 1] + 1
        for k in best:
            self.set(values[k], True)
        return found

    def move(self, i: int) -> float:
        """The square of how far the value at i has moved, in proportion to its size."""
        total, j = 0.0, i
        while j == i or (j < self.n and self.part[j]):
            way = (self.y[j] - self.home[j]) / self.weights[j]
            total += way * way
            j += 1
        return total

    def attempts(self) -> bool:
        """Whether there is a start with what is free now, from the guess, beside it, or where one was
        found."""
        self.trials += 1
        spreads = (0, BESIDE) if self.other in (0, BESIDE) else (0, BESIDE, self.other)
        return any(self.solve(k, k + 1) for k in spreads)

    # -- the way to a start --

    def solve(self, first: int, end: int) -> bool:
        """Look for a start from the spreads first..end-1, what is free moving; `y` is the best found: the
        first that is near, else the nearest."""
        least, nearest, stated = inf, inf, False
        best = self.home[:]
        for i in range(self.n):
            stated = stated or (self.free[i] and self.levels[i] > UNSTATED)
        for k in range(first, end):
            for ease in (SLIGHT, 1.0) if stated else (SLIGHT,):
                self.ease = ease
                y = self.attempt(self.spread(k))
                self.ease = SLIGHT
                size = self.worst(y, self.rows)[0]
                if size <= ACCEPTED:
                    y = self.unwound(y)
                    y = self.nearer(y) if k > 0 or ease > SLIGHT else y
                    far = self.strayed(y)
                    if far < nearest:
                        best, least, nearest, self.begin = y, 0.0, far, k
                    break
                if size < least:
                    best, least = y, size
            if nearest <= NEAR or True not in self.free:
                break
        self.y = best
        return nearest < inf

    def spread(self, k: int) -> list[float]:
        """The guess, with what is free moved by up to SPREADS[k] of its width: a guess may be singular."""
        y = self.home[:]
        if SPREADS[k] > 0.0:
            state = 12345 + k
            for i in range(self.n):
                state = (1103515245 * state + 12345) % 2147483648
                if self.free[i] and self.used[i]:
                    y[i] += SPREADS[k] * self.widths[i] * (state / 1073741824.0 - 1.0)
            self.lengths(y)
        return y

    def attempt(self, y: list[float]) -> list[float]:
        """Positions first, then speeds; all together where that is not enough."""
        nq = self.conditions.nq
        y = self.improve(y, self.positions, [i for i in range(self.n) if self.free[i] and i < nq])
        if self.worst(y, self.positions)[0] <= ACCEPTED:
            y = self.improve(y, self.motions, [i for i in range(self.n) if self.free[i] and i >= nq])
            if not self.worst(y, self.rows)[0] <= ACCEPTED:
                y = self.improve(y, self.rows, [i for i in range(self.n) if self.free[i]])
        return y

    def scales(self, jacobian: list[float], sizes: list[float]) -> list[float]:
        """What the residual of each row is judged against."""
        found, k = [0.0] * len(sizes), 0
        for i, end in enumerate(self.conditions.ends):
            total = 0.0
            while k < end:
                total += abs(jacobian[k]) * self.weights[self.conditions.columns[k]]
                k += 1
            found[i] = sizes[i] + SLIGHT * total
        return found

    def worst(self, y: list[float], rows: list[int]) -> tuple[float, int]:
        """The largest scaled residual of `rows`, infinity where one is not a number, and its row."""
        c, jacobian, sizes = self.evaluate(y)
        scales = self.scales(jacobian, sizes)
        worst, row = 0.0, -1
        for i in rows:
            size = _ratio(c[i], scales[i])
            if not size <= worst:
                worst, row = size if size == size else inf, i
                if worst == inf:
                    break
        return worst, row

    def improve(self, y: list[float], rows: list[int], columns: list[int]) -> list[float]:
        """Gauss-Newton of least norm on `rows` in the unknowns `columns`, with steps that are halved
        until they help."""
        if not rows or not columns:
            return y
        c, jacobian, sizes = self.evaluate(y)
        scales = self.scales(jacobian, sizes)
        norm = _norm(c, scales, rows)
        if norm <= CLOSE:
            return y
        for _ in range(NEWTON_STEPS):
            if not EXACT < norm < inf:
                break
            matrix, found = self.matrix(jacobian, rows, columns), False
            for dependent in FOLLOWING:
                step = least_norm(matrix, [-c[i] for i in rows], dependent)
                if step == []:
                    break
                factor = self.longest(columns, step)
                least = 0.6 * factor if norm <= CLOSE else SHORTEST * factor
                while factor >= least:
                    trial = y[:]
                    for j, d in zip(columns, step):
                        trial[j] += factor * d * self.weight(j)
                    tc, tj, tz = self.evaluate(trial)
                    found = _norm(tc, scales, rows) < norm * (1.0 - 0.1 * factor)
                    if found:
                        break
                    factor *= 0.5
                if found:
                    break
            if not found:
                break
            y, c, jacobian, sizes = trial, tc, tj, tz
            scales = self.scales(jacobian, sizes)
            norm = _norm(c, scales, rows)
        return y

    def longest(self, columns: list[int], step: list[float]) -> float:
        """The part of a step that turns no angle by more than a radian."""
        factor = 1.0
        for j, d in zip(columns, step):
            turn = abs(d) * self.weight(j)
            if j in self.conditions.angles and turn * factor > 1.0:
                factor = 1.0 / turn
        return factor

    def matrix(self, jacobian: list[float], rows: list[int], columns: list[int]) -> list[list[float]]:
        """The derivatives of `rows` by `columns`, each times its weight."""
        place = {j: k for k, j in enumerate(columns)}
        ends, found = self.conditions.ends, []
        for i in rows:
            row = [0.0] * len(columns)
            for k in range(ends[i - 1] if i > 0 else 0, ends[i]):
                j = self.conditions.columns[k]
                if j in place:
                    row[place[j]] = jacobian[k] * self.weight(j)
            found.append(row)
        return found

    def nearer(self, y: list[float]) -> list[float]:
        """A start between `y` and the guess, as near to the guess as steps of least norm lead: of the
        positions alone, where speeds from their guess fit."""
        nq = self.conditions.nq
        rows, columns = self.positions, [i for i in range(self.n) if self.free[i] and i < nq]
        trial = self.attempt([*y[:nq], *self.home[nq:]])
        if self.worst(trial, self.rows)[0] <= ACCEPTED:
            y = trial
        else:
            rows, columns = self.rows, [i for i in range(self.n) if self.free[i]]
        far = self.distance(y)
        for _ in range(HOMEWARD if rows and columns else 0):
            c, jacobian, _ = self.evaluate(y)
            matrix = self.matrix(jacobian, rows, columns)
            right = []
            for i, row in zip(rows, matrix):
                value = -c[i]
                for a, j in zip(row, columns):
                    value += a * ((y[j] - self.home[j]) / self.weight(j))
                right.append(value)
            step = least_norm(matrix, right, FOLLOWING[0])
            if step == []:
                break
            trial = self.home[:]
            for j, d in zip(columns, step):
                trial[j] += d * self.weight(j)
            trial = self.attempt(trial)
            near = self.distance(trial)
            if not (near < far and self.worst(trial, self.rows)[0] <= ACCEPTED):
                break
            y, far = trial, near
        return y

    def distance(self, y: list[float]) -> float:
        """From the guess, in weights."""
        total = 0.0
        for i in range(self.n):
            way = (y[i] - self.home[i]) / self.weight(i)
            total += way * way
        return sqrt(total)

    def strayed(self, y: list[float]) -> float:
        """How far what nobody stated is from the guess, in weights."""
        total = 0.0
        for i in range(self.n):
            if self.levels[i] == UNSTATED:
                way = (y[i] - self.home[i]) / self.weights[i]
                total += way * way
        return sqrt(total)

    def unwound(self, y: list[float]) -> list[float]:
        """`y` with angles less than half a turn from their guess, where that is a start too."""
        trial, wound = y[:], False
        for i in self.conditions.angles:
            turns = float(floor((trial[i] - self.home[i]) / TURN + 0.5))
            if turns != 0.0:
                trial[i], wound = trial[i] - TURN * turns, True
        if wound:
            trial = self.attempt(trial)
            if self.worst(trial, self.rows)[0] <= ACCEPTED:
                return trial
        return y


def _subsets(n: int, count: int) -> float:
    total = 1.0
    for k in range(count):
        total = total * (n - k) / (k + 1)
    return total


def _ratio(value: float, scale: float) -> float:
    return 0.0 if value == 0.0 else abs(value) / scale if scale > 0.0 else inf


def _norm(c: list[float], scales: list[float], rows: list[int]) -> float:
    """Of the scaled residuals; infinity where one is not a number."""
    total = 0.0
    for i in rows:
        size = _ratio(c[i], scales[i])
        total += size * size
    return sqrt(total) if total == total else inf
