"""A consistent start: what nobody stated moves first, what was stated only where it has to."""

from __future__ import annotations

from math import inf

from lagc.render.numpy.support.base import INCONSISTENT, NOT_FINITE, OK
from lagc.render.numpy.support.startchoice import Choice
from lagc.render.numpy.support.startrows import DECLARED, FIXED, UNSTATED
from lagc.render.numpy.support.startsteps import CLOSE, NEAR, SPREADS

# -- what follows is part of generated modules --

TRACE = 1e-6  # of its size: a move that may be none; where rows are quadratic, rounding leaves its root


class Consistency(Choice):
    """The search for values of the unknowns near the guess that meet the conditions.

    Afterwards `y` is the best that was found, and `free` tells what might move; `culprit` is the row
    that misses most, or the unknown that is not finite; `rows`, of a failure, those of the part of the
    conditions that cannot be met.
    """

    culprit = -1

    def run(self) -> int:
        """OK, INCONSISTENT or NOT_FINITE."""
        for i in range(self.n):
            if not abs(self.home[i]) < inf:
                self.culprit = i
                return NOT_FINITE
        self.culprit = self.directionless()
        if self.culprit >= 0:
            return INCONSISTENT
        near = self.solve(0, 1) and self.strayed(self.y) <= NEAR
        status = OK if near else self.by_parts()
        if status == OK:
            self.calm()
        return status

    def calm(self) -> None:
        """Leave as guessed what went next to no way, if what is left meets the conditions as near by: steps
        leave traces in unknowns that they need not move."""
        y, free = self.y, self.free[:]
        trial, traces = y[:], False
        for i in range(self.n):
            if free[i] and self.used[i] and 0.0 < abs(y[i] - self.home[i]) <= TRACE * self.weights[i]:
                trial[i], self.free[i], traces = self.home[i], False, True
        if traces:
            trial = self.attempt(trial)
            same = self.worst(trial, self.rows)[0] <= CLOSE
            for a, b, weight in zip(trial, y, self.weights):
                same = same and abs(a - b) <= TRACE * weight
            if same:
                self.y = trial
        self.free = free

    def directionless(self) -> int:
        """The condition of a quaternion that is zero, or -1."""
        for i, k in enumerate(self.conditions.quaternions):
            if self.home[k : k + 4] == [0.0, 0.0, 0.0, 0.0]:
                return self.conditions.own + i
        return -1

    def by_parts(self) -> int:
        """Each part of the conditions that shares no unknown with the others by itself."""
        rows, reached = self.rows, self.y
        best, free = self.home[:], self.free
        owners = self.owners()
        for part in range(self.n + 1):
            own = [i for i, owner in zip(rows, owners) if owner == part]
            if own:
                self.confine(own)
                self.free = [a and b for a, b in zip(free, self.used)]
                self.y = reached
                met = self.worst(reached, own)[0] <= CLOSE and self.strayed(reached) <= NEAR
                if not met and not self.ladder():
                    self.culprit = self.worst(self.y, self.rows)[1]
                    return INCONSISTENT
                for j in range(self.n):
                    if self.used[j] and self.levels[j] < FIXED:
                        best[j], free[j] = self.y[j], self.free[j]
        self.y, self.free = best, free
        self.confine(rows)
        return OK

    def owners(self) -> list[int]:
        """A number for each row: the same for rows that share an unknown that may move."""
        owner = list(range(self.n))
        found = [-1] * len(self.rows)
        changed = True
        while changed:
            changed = False
            for k, i in enumerate(self.rows):
                columns = [j for j in self.columns(i) if self.levels[j] < FIXED]
                least = self.n
                for j in columns:
                    least = min(least, owner[j])
                for j in columns:
                    owner[j] = least
                changed = changed or found[k] != least
                found[k] = least
        return found

    def ladder(self) -> bool:
        """Level after level is let go until there is a start; then as much as possible is held again."""
        if self.solve(0, len(SPREADS)):
            return True
        top = DECLARED
        while top < FIXED:
            if self.release(top) and self.solve(0, len(SPREADS)):
                break
            top += 1
        if top == FIXED:
            return False
        self.other = self.begin
        while top > UNSTATED:
            if self.has(top):
                self.choose(top)
            top -= 1
        self.hold_little([i for i in range(self.n) if self.levels[i] > UNSTATED and not self.part[i]])
        return True

    def has(self, level: int) -> bool:
        """Whether a value of this part is stated at `level`."""
        return True in [self.used[i] and self.levels[i] == level for i in range(self.n)]

    def release(self, level: int) -> bool:
        """Let everything move that is stated at `level`; whether there is any."""
        for i in range(self.n):
            if self.levels[i] == level and self.used[i]:
                self.free[i] = True
        return self.has(level)
