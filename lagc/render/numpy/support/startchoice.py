"""The choice of the stated values that move, where not all of them can be kept."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

from lagc.render.numpy.support.startrows import ACCEPTED, ratio_of
from lagc.render.numpy.support.startsteps import BESIDE, NEAR, SPREADS, Approach
from lagc.render.numpy.support.starttable import NEGLIGIBLE, moves_of, pivot_on

# -- what follows is part of generated modules --

MOST_SETS = 128  # sets of columns whose linear prediction is looked at
EXCHANGES = 10  # of columns, where there are more sets
WIDE = 0.1  # weights: moves up to it are trusted to be linear
PREDICTED = 3  # sets that are tried
BENT = 0.05  # of what is missed: curvature up to which the first prediction that leads to a start is taken
UNMOVED = 1e-22  # squared, in weights
MOST_WORK = 200  # factorisations of a search that no prediction helps


class Choice(Approach):
    """Of stated values that contradict the conditions, as few as possible move, and as little."""

    other = 0  # the spread that led to a start where most was free
    rank = 0  # how many columns the linear conditions ask for

    def set(self, i: int, free: bool) -> None:
        """Let the value at i move or hold it, a quaternion as a whole."""
        self.free[i] = free
        j = i + 1
        while j < self.n and self.part[j]:
            self.free[j] = free
            j += 1

    def set_all(self, values: Sequence[int], free: bool) -> None:
        for i in values:
            self.set(i, free)

    def choose(self, level: int) -> None:
        """Of the values of `level`, which all move in the start `y`, let as few move as possible, and as
        little: those that linear prediction names, else by trying."""
        columns = [j for j in range(self.n) if self.levels[j] == level and self.used[j]]
        values = [j for j in columns if not self.part[j]]
        start = self.y
        moves = [self.move(i) for i in values]
        self.set_all(values, False)
        if not self.unmoved(values, max(moves), start):
            if not self.predicted(columns, values, start):
                self.searched(values, moves, start)
            self.hold_little(values)
        if not self.strayed(self.y) <= NEAR:
            self.solve(0, len(SPREADS))

    def unmoved(self, values: list[int], move: float, start: list[float]) -> bool:
        """Whether there is a start where none of the `values` that were released moves: looked for from
        beside the guess where one went far, else from where they led to."""
        if move <= WIDE * WIDE:
            return self.returned(values, start)
        if not self.solve(BESIDE + 1, len(SPREADS)):
            return False
        self.other = self.begin
        return True

    def returned(self, values: list[int], start: list[float]) -> bool:
        """Whether `values`, now held, need not have moved to `start`: rows that follow from others where all
        hold, and not elsewhere, may have moved them."""
        if self.lacking(start):
            return False
        y = start[:]
        for i in values:
            for j in range(self.n):
                if self.owner(j) == i:
                    y[j] = self.home[j]
        y = self.attempt(y)
        if not self.worst(y, self.rows)[0] <= ACCEPTED:
            return False
        self.y = y
        return True

    def predicted(self, columns: list[int], values: list[int], start: list[float]) -> bool:
        """Free those of `values` that the conditions, linear between the start and the point where the
        values are as given, ask to move; whether that led to a start."""
        beside = start[:]
        for j in columns:
            beside[j] = self.home[j]
        bend = self.bend(beside, start)
        slack = bend if bend < 0.1 else 0.1
        slack = slack if slack > NEGLIGIBLE else NEGLIGIBLE
        rank = len(self.table(start, beside, columns)[1])
        table, basis = self.table([0.5 * (a + b) for a, b in zip(start, beside)], beside, columns)
        if rank < len(basis):  # rows that follow from others where they hold, not elsewhere
            table, basis = self.table(start, beside, columns)
        best: list[int] = []
        y, least = start, (inf, inf)
        self.rank = len(basis)
        for picked, ways in self.candidates(table, basis, columns, slack):
            largest = _largest(ways)
            sure = False
            needed = [p for p, d in zip(picked, ways) if abs(d) > slack * largest]
            for chosen in (needed, picked) if len(needed) < len(picked) else (picked,):
                owners = [self.owner(columns[p]) for p in chosen]
                self.set_all(owners, True)
                led = self.attempts()
                self.set_all(owners, False)
                if led:
                    sure = chosen is needed or len(needed) == len(picked)
                    cost = self.moved(values)
                    if cost < least:
                        best, y, least = owners, self.y, cost
                    break
            if sure and bend <= BENT:
                break
        self.set_all(best, True)
        self.y = y
        return least[0] < inf

    def hold_little(self, values: list[int]) -> None:
        """Hold those of `values` that hardly moved, or did not, if there is a start without."""
        y = self.y
        for most in (WIDE * WIDE, UNMOVED):
            little = [i for i in values if self.free[i] and self.move(i) <= most]
            if little:
                self.set_all(little, False)
                if self.returned(little, y) or (most == UNMOVED and self.attempts()):
                    break
                self.set_all(little, True)
                self.y = y

    def owner(self, j: int) -> int:
        """The value that column j is of: the first part of a quaternion."""
        while self.part[j]:
            j -= 1
        return j

    def bend(self, y: list[float], to: list[float]) -> float:
        """How much the conditions bend from y to `to`, as a part of what is missed at y."""
        c, jacobian, sizes = self.evaluate(y)
        scales = self.scales(y, jacobian, sizes)
        missed, bent = 0.0, 0.0
        for i in self.rows:
            value = c[i]
            for k in range(self.conditions.ends[i - 1] if i > 0 else 0, self.conditions.ends[i]):
                j = self.conditions.columns[k]
                value += jacobian[k] * (to[j] - y[j])
            missed = max(missed, ratio_of(c[i], scales[i]))
            bent = max(bent, ratio_of(value, scales[i]))
        return bent / missed if missed > 0.0 else 0.0

    def candidates(
        self, table: list[list[float]], basis: list[int], columns: list[int], slack: float
    ) -> list[tuple[list[int], list[float]]]:
        """Sets of columns that can meet the conditions, as far as they are linear, with the moves: the few
        that move fewest values and least."""
        n, k = len(columns), len(basis)
        found: list[tuple[tuple[float, float], list[int], list[float]]] = []

        def enter(picked: list[int], moves: list[float]) -> None:
            cost = self.cost([columns[p] for p in picked], moves, slack)
            at = len(found)
            while at > 0 and cost < found[at - 1][0]:
                at -= 1
            found.insert(at, (cost, picked[:], moves))
            del found[PREDICTED:]

        if _subsets(n, k) > MOST_SETS:
            enter(basis, [row[n] for row in table])
            if self.exchanged(table, basis, columns, slack):
                enter(basis, [row[n] for row in table])
        else:
            picked = list(range(k))
            while True:
                moves = moves_of(table, picked)
                if len(moves) == k:
                    enter(picked, moves)
                if not _next(picked, n):
                    break
        return [(chosen, moves) for _, chosen, moves in found]

    def cost(self, columns: list[int], moves: Sequence[float], slack: float) -> tuple[float, float]:
        """How many values move, and the sum of the squares of the moves."""
        least = slack * _largest(moves)
        owners, total = set[int](), 0.0
        for j, d in zip(columns, moves):
            if abs(d) > least:
                owners.add(self.owner(j))
                total += d * d
        return float(len(owners)), total

    def exchanged(self, table: list[list[float]], basis: list[int], columns: list[int], slack: float) -> bool:
        """Improve the basis by exchanges of one column for another, while that helps and asks for no wide
        move, which the conditions would not be linear for; whether any did."""
        k, n = len(basis), len(columns)
        moves = [row[n] for row in table]
        now = self.cost([columns[p] for p in basis], moves, slack)
        bound, helped = _largest(moves), False
        bound = bound if bound > WIDE else WIDE
        for _ in range(EXCHANGES):
            best, out, into = now, -1, -1
            for p in range(n):
                for i in range(0 if p in basis else k):
                    if abs(table[i][p]) > 0.01:
                        way = table[i][n] / table[i][p]
                        trial = [moves[r] - table[r][p] * way if r != i else way for r in range(k)]
                        if _largest(trial) <= bound:
                            trying = [columns[b if r != i else p] for r, b in enumerate(basis)]
                            cost = self.cost(trying, trial, slack)
                            if cost < best:
                                best, out, into = cost, i, p
            if out < 0:
                break
            pivot_on(table, out, into)
            basis[out], now, helped = into, best, True
            moves = [row[n] for row in table]
        return helped

    def searched(self, values: list[int], moves: list[float], start: list[float]) -> None:
        """By trying sets, the smallest first, and then to hold one value after the other; what has not
        been tried when the work is done moves."""
        limit = self.work + MOST_WORK
        for count in range(0 if self.rank > 0 else 1, len(values) + 1):  # none was tried already
            if self.work > limit:
                break
            if self.fewest(values, count, limit):
                return
        kept = [i for i, move in zip(values, moves) if move > 0.0]
        self.set_all(kept, True)
        limit = self.work + MOST_WORK
        for k in sorted(range(len(values)), key=lambda k: moves[k]):
            if moves[k] > 0.0 and self.work <= limit:
                self.set(values[k], False)
                if not self.attempts():
                    self.set(values[k], True)
        if not self.solve(0, len(SPREADS)):
            self.set_all(values, True)
            self.y = start

    def fewest(self, values: list[int], count: int, limit: int) -> bool:
        """Let `count` of `values` move, those that have to move least; whether there are any."""
        picked = list(range(count))
        best: list[int] = []
        least, y = inf, self.y
        while self.work <= limit:
            chosen = [values[k] for k in picked]
            self.set_all(chosen, True)
            if self.attempts():
                total = self.moved(values)[1]
                if total < least:
                    best, least, y = chosen, total, self.y
            self.set_all(chosen, False)
            if not _next(picked, len(values)):
                break
        self.set_all(best, True)
        self.y = y
        return least < inf

    def moved(self, values: list[int]) -> tuple[float, float]:
        """How many of `values` have moved, and the sum of the squares of their ways."""
        count, total = 0.0, 0.0
        for i in values:
            move = self.move(i)
            if move > UNMOVED:
                count += 1.0
                total += move
        return count, total

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
        self.work += 1
        spreads = (0, BESIDE) if self.other in (0, BESIDE) else (0, BESIDE, self.other)
        return any(self.solve(k, k + 1) for k in spreads)


def _subsets(n: int, count: int) -> float:
    total = 1.0
    for k in range(count):
        total = total * (n - k) / (k + 1)
    return total


def _next(picked: list[int], n: int) -> bool:
    """The next set of as many of n, in place; False behind the last."""
    last = len(picked) - 1
    while last >= 0 and picked[last] == n - len(picked) + last:
        last -= 1
    if last < 0:
        return False
    picked[last] += 1
    for k in range(last + 1, len(picked)):
        picked[k] = picked[k - 1] + 1
    return True


def _largest(values: Sequence[float]) -> float:
    largest = 0.0
    for a in values:
        if abs(a) > largest:
            largest = abs(a)
    return largest
