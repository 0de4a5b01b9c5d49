"""Conditions in which one unknown is left: where its residual changes its sign, however far away."""

from __future__ import annotations

from lagc.render.numpy.support.startrows import ACCEPTED, UNSTATED, ratio_of
from lagc.render.numpy.support.starttable import Linear

# -- what follows is part of generated modules --

RUNGS = 12  # looked at on either side of 0, up and down from the size of an unknown
HALVINGS = 60  # of an interval

Place = tuple[float, float, float]  # a value of the unknown, the residual there, and its derivative


class Alone(Linear):
    """Unknowns that conditions of positions leave alone."""

    def met_alone(self) -> list[float]:
        """The guess, where unknowns that nobody stated meet, one after the other, the conditions of positions
        in which no other is left."""
        if not self.settled:
            self.settled = self.home[:]
            self.settle(self.settled)
        return self.settled[:]

    def settle(self, y: list[float]) -> None:
        left = [self.used[j] and self.levels[j] == UNSTATED for j in range(self.n)]
        changed = True
        while changed:
            changed = False
            for i in self.positions:
                alone = [j for j in self.columns(i) if left[j]]
                if len(alone) == 1:
                    left[alone[0]] = False
                    changed = True
                    self.meet(y, i, alone[0])

    def meet(self, y: list[float], i: int, j: int) -> None:
        """Move unknown j in `y` to where condition i holds, found upwards and downwards by turns."""
        c, jacobian, sizes = self.evaluate(y)
        if ratio_of(c[i], self.scales(y, jacobian, sizes)[i]) <= ACCEPTED:
            return
        home = y[j]
        size = abs(home) if home != 0.0 else self.weights[j]
        middle = 0 if home == 0.0 else RUNGS + 1 if home > 0.0 else -RUNGS - 1
        ends = [self.place(y, i, j, home)] * 2
        for k in range(1, 3 * RUNGS + 3):
            for side, number in enumerate((middle + k, middle - k)):
                if abs(number) <= 2 * RUNGS + 1:
                    there = self.place(y, i, j, _rung(number, size))
                    if self.root(y, i, j, ends[side], there):
                        return
                    ends[side] = there
        y[j] = home

    def root(self, y: list[float], i: int, j: int, a: Place, b: Place) -> bool:
        """Move `y` to where the condition holds between a and b, if it is found to."""
        for _ in range(HALVINGS):
            if _opposite(a, b):
                return self.halved(y, i, j, a, b)
            if not _hides(a, b):
                return False
            middle = self.place(y, i, j, 0.5 * (a[0] + b[0]))
            if _opposite(a, middle):
                return self.halved(y, i, j, a, middle) or self.halved(y, i, j, middle, b)
            if _hides(a, middle):
                b = middle
            else:
                a = middle
        return False

    def halved(self, y: list[float], i: int, j: int, a: Place, b: Place) -> bool:
        """Move `y` to where the residual changes its sign between a and b; False where it jumps there."""
        least = min(abs(a[1]), abs(b[1]))
        for _ in range(HALVINGS):
            middle = self.place(y, i, j, 0.5 * (a[0] + b[0]))
            if _opposite(a, middle):
                b = middle
            else:
                a = middle
        y[j], c = a[:2] if abs(a[1]) < abs(b[1]) else b[:2]
        return abs(c) <= least

    def place(self, y: list[float], i: int, j: int, value: float) -> Place:
        """Condition i where unknown j in `y` is at `value`."""
        y[j] = value
        c, jacobian, _ = self.evaluate(y)
        columns = self.columns(i)
        return value, c[i], jacobian[self.conditions.ends[i] - len(columns) + columns.index(j)]


def _rung(k: int, size: float) -> float:
    """Number k of a ladder that is 0 at 0, +-size at +-(RUNGS + 1), and ever wider away from there."""
    steps = abs(k) - RUNGS - 1
    value = size * 2.0 ** (steps * (abs(steps) + 1) // 2)
    return 0.0 if k == 0 else value if k > 0 else -value


def _opposite(a: Place, b: Place) -> bool:
    """Whether the residuals have opposite signs."""
    return a[1] < 0.0 <= b[1] or b[1] <= 0.0 < a[1]


def _falls(a: Place, b: Place) -> bool:
    """Whether the residual falls, in its absolute value, from a towards b."""
    return a[1] * (b[0] - a[0]) * a[2] < 0.0


def _hides(a: Place, b: Place) -> bool:
    """Whether residuals of the same sign may change it twice between: they fall from both sides, or from
    one to where they are larger."""
    one, other = abs(a[1]), abs(b[1])
    return _falls(b, a) or other > one if _falls(a, b) else _falls(b, a) and one > other
