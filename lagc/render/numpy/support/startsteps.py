"""The way to a start: Gauss-Newton steps of least norm, from the guess or beside it."""

from __future__ import annotations

from math import floor, inf, sqrt

from lagc.render.numpy.support.leastnorm import least_norm
from lagc.render.numpy.support.quaternions import with_unit_length
from lagc.render.numpy.support.startalone import Alone
from lagc.render.numpy.support.startrows import ACCEPTED, FIXED, SLIGHT, UNSTATED, norm_of

# -- what follows is part of generated modules --

CLOSE = 1e-13  # at which one is left as it is
EXACT = 1e-15  # at which the iteration ends
NEWTON_STEPS = 60
LATE = 8  # steps in which what is missed halves, or the iteration ends
SHORTEST = 2.0**-14  # part of a step that is tried at last
OVERSHOT = 2.0  # of what was missed: a step that misses more is too long, whatever part it is
TINIEST = 1e-30  # part of a step, of such a one
SPREADS = (0.0, 0.01, 0.1, 0.5, 1.0, 1.0, 2.0, 2.0)  # of the widths: how far from the guess attempts begin
BESIDE = 2  # the spread that leaves a singular guess well behind
NEAR = 8.0  # weights from the guess: a start farther off is not taken before others are sought
ALIKE = 1.01  # what attempts from near the guess miss: they ended at the same place
HOMEWARD = 20  # steps back towards the guess
TURN = 6.283185307179586
FOLLOWING = (1e-11, 1e-5)  # of its length: the rest of a row that follows from others


class Approach(Alone):
    """Attempts to reach a start; `y` is the best that was found."""

    begin = 0  # the spread that led to a start

    def solve(self, first: int, end: int) -> bool:
        """Look for a start from the spreads first..end-1, what is free moving; `y` is the best found: the
        first that is near, else the nearest."""
        least, nearest, most, stated = inf, inf, 0.0, False
        self.y = self.home[:]
        if self.hopeless():
            return False
        best = self.home[:]
        for i in range(self.n):
            stated = stated or (self.free[i] and self.levels[i] > UNSTATED)
        for k in range(first, end):
            for ease in (SLIGHT, 1.0) if stated else (SLIGHT,):
                self.ease = ease
                y = self.attempt(self.spread(k, stated))
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
                most = max(most, size)
            if nearest <= NEAR or True not in self.free:
                break
            unmet = k == BESIDE and k + 1 < end and nearest == inf and self.met_alone() == self.home
            if unmet and (most <= ALIKE * least < inf or self.lacking(best)):
                break
        self.y = best
        return nearest < inf

    def hopeless(self) -> bool:
        """Whether a condition is missed that nothing free occurs in."""
        rows = [i for i in self.rows if True not in [self.free[j] for j in self.columns(i)]]
        return bool(rows) and not self.worst(self.home, rows)[0] <= ACCEPTED

    def lacking(self, y: list[float]) -> bool:
        """Whether, beside y, the conditions ask for more than what is free can give, but not more than
        what is stated could."""
        stated = [j for j in range(self.n) if self.used[j] and not self.free[j] and self.levels[j] < FIXED]
        return len(self.table(y, y, stated)[1]) > 0

    def spread(self, k: int, stated: bool) -> list[float]:
        """Beginning k: the guess, with what is free moved by up to SPREADS[k] of its width, for a guess may
        be singular.  In the second, and in every other where nothing `stated` moves, what is alone in a
        condition meets it instead."""
        y = self.met_alone() if k == 1 or (k % 2 == 1 and not stated) else self.home[:]
        if SPREADS[k] > 0.0:
            state = 12345 + k
            for i in range(self.n):
                state = (1103515245 * state + 12345) % 2147483648
                if self.free[i] and self.used[i] and y[i] == self.home[i]:
                    y[i] += SPREADS[k] * self.widths[i] * (state / 1073741824.0 - 1.0)
            with_unit_length(y, self.conditions.quaternions)
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

    def improve(self, y: list[float], rows: list[int], columns: list[int]) -> list[float]:
        """Gauss-Newton of least norm on `rows` in the unknowns `columns`, with steps that are halved
        until they help."""
        if not rows or not columns:
            return y
        c, jacobian, sizes = self.evaluate(y)
        scales = self.scales(y, jacobian, sizes)
        norm = norm_of(c, scales, rows)
        if norm <= CLOSE:
            return y
        left, longest = 1.0, 1.0
        speeds = columns[0] >= self.conditions.nq  # alone: what is rounding of positions stays so
        blurred = self.blurred(y, jacobian, self.weights) if speeds else [False] * len(jacobian)
        for n in range(NEWTON_STEPS):
            if not EXACT < norm < inf:
                break
            if n > 0 and n % LATE == 0:
                if longest == 1.0 and not left < 0.5:
                    break
                left = 1.0
            known = [0.0 if dim else a for a, dim in zip(jacobian, blurred)]
            matrix, found = self.matrix(known, rows, columns), False
            for dependent in FOLLOWING:
                self.work += 1
                step = least_norm(matrix, [-c[i] for i in rows], dependent)
                if step == []:
                    break
                longest = self.longest(columns, step)
                least = 0.6 * longest if norm <= CLOSE else SHORTEST * longest
                factor = 1.0  # whole turns are gone where all is linear
                size = inf
                while least > 0.0 and factor >= (least if size < OVERSHOT * norm else TINIEST):
                    trial = y[:]
                    for j, d in zip(columns, step):
                        trial[j] += factor * d * self.weight(j)
                    tc, tj, tz = self.evaluate(trial)
                    part = 0.1 * factor if factor <= longest else 0.999
                    size = norm_of(tc, scales, rows)
                    found = size < norm * (1.0 - part)
                    if found:
                        break
                    factor = 0.5 * factor if factor <= longest else longest
                if found:
                    break
            if not found:
                break
            left *= size / norm
            y, c, jacobian, sizes = trial, tc, tj, tz
            scales = self.scales(y, jacobian, sizes)
            norm = norm_of(c, scales, rows)
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
            self.work += 1
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
            if self.levels[i] == UNSTATED and self.used[i]:
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
