"""The conditions of a start made linear: what they ask of stated values."""

from __future__ import annotations

from math import inf

from lagc.render.numpy.support.startrows import Meeting

# -- what follows is part of generated modules --

NEGLIGIBLE = 1e-9  # of the largest slope of a row: a pivot that counts as zero


class Linear(Meeting):
    """The conditions, linear near a point."""

    work = 0  # factorisations so far

    def table(
        self, at: list[float], beside: list[float], columns: list[int]
    ) -> tuple[list[list[float]], list[int]]:
        """The conditions T d = r, linear with the slopes `at` a point, in the moves d (in weights) of
        `columns` from `beside`: what is free eliminated, and Gauss-Jordan on the columns of the basis.
        Rows of T with r behind, and the index of the column that each was solved for."""
        free = [j for j in range(self.n) if self.free[j] and self.used[j]]
        place = {j: k for k, j in enumerate([*free, *columns])}
        first, width = len(free), len(place)
        c, jacobian = self.evaluate(beside)[0], self.evaluate(at)[1]
        rows: list[list[float]] = []
        for i in self.rows:
            row, largest = [0.0] * (width + 1), 0.0
            for k in range(self.conditions.ends[i - 1] if i > 0 else 0, self.conditions.ends[i]):
                j = self.conditions.columns[k]
                if j in place:
                    value = jacobian[k] * self.weights[j]
                    row[place[j]] = value
                    if not abs(value) <= largest:
                        largest = abs(value)
            if 0.0 < largest < inf:
                row[width] = -c[i]
                rows.append([a / largest for a in row])
        self.work += 1
        for k in range(first):
            best, largest = -1, NEGLIGIBLE
            for i, row in enumerate(rows):
                if abs(row[k]) > largest:
                    best, largest = i, abs(row[k])
            if best >= 0:
                pivot = rows.pop(best)
                for row in rows:
                    if row[k] != 0.0:
                        part = row[k] / pivot[k]
                        for j in range(k, width + 1):
                            row[j] -= part * pivot[j]
        rows = [row[first:] for row in rows]
        return solved_rows(rows)


def pivot_on(rows: list[list[float]], i: int, k: int) -> None:
    """Solve row i for column k, and take it from the others."""
    scale = rows[i][k]
    pivot = rows[i] = [a / scale for a in rows[i]]
    for other, row in enumerate(rows):
        if other != i and row[k] != 0.0:
            part = row[k]
            rows[other] = [a - part * b for a, b in zip(row, pivot)]


def solved_rows(rows: list[list[float]]) -> tuple[list[list[float]], list[int]]:
    """Gauss-Jordan with complete pivoting: the rows that were solved for a column, and these columns."""
    solved: list[int] = []
    basis: list[int] = []
    while True:
        at, column, largest = -1, -1, NEGLIGIBLE
        for i, row in enumerate(rows):
            if i not in solved:
                for k in range(len(row) - 1):
                    if abs(row[k]) > largest:
                        at, column, largest = i, k, abs(row[k])
        if at < 0:
            break
        pivot_on(rows, at, column)
        solved.append(at)
        basis.append(column)
    return [rows[i] for i in solved], basis


def moves_of(table: list[list[float]], picked: list[int]) -> list[float]:
    """The moves of the `picked` columns alone that satisfy all rows; shorter where there are none."""
    k = len(picked)
    rows = [[*(row[p] for p in picked), row[-1]] for row in table]
    for i in range(k):
        best, largest = -1, NEGLIGIBLE
        for r in range(i, k):
            if abs(rows[r][i]) > largest:
                best, largest = r, abs(rows[r][i])
        if best < 0:
            return []
        rows[i], rows[best] = rows[best], rows[i]
        pivot_on(rows, i, i)
    return [row[k] for row in rows]
