"""[M G^T; G 0] solved whatever the rank of G: Cholesky of M, and pivoted
orthogonal factors of G in its metric.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf, sqrt

from lagc.render.numpy.support.base import INCONSISTENT, OK, REDUNDANT, SINGULAR_MASS

# -- what follows is part of generated modules --

SINGULAR = 1e-13  # pivot ratio of a mass matrix that is singular
# Share of a row that is independent of the others, below which it counts as dependent.  Where two
# branches of a mechanism cross, rounding rounds the corner between them within about 1e-8: the
# motion goes straight through only if the row is left out before.  Once rows are known to be
# dependent the limit is higher, as stages leave the constraints.
DEPENDENT = 1e-5
STILL_DEPENDENT = 1e-4
# Rows that depend on others on the constraints have a share of their own beside them, of the size
# of the way to the constraints.
MISSED = 30.0
MOST_DEPENDENT = 0.1
UNSTEADY = 100.0  # times the size of the steadiest row's gamma, each over the row's length
CONTRADICTION = 1e-3  # of the size of accelerations


class Fallback:
    """M = L L^T (`low`: its rows), L^-1 G^T = Q R diag(lengths) with columns in the order of `order`.

    Where M alone is singular, or very uneven, M + weight G^T G takes its place: the same solution, as
    G a is given.
    Rows order[rank:] depend on the others.  `b` holds Q by rows, r its factors: r[k][row].
    """

    def __init__(self, n: int, m: int):
        self.n, self.m = n, m
        self.low: list[list[float]] = []
        self.weight = 0.0
        self.g: list[float] = []
        self.b = [[0.0] * n for _ in range(m)]
        self.r = [[0.0] * m for _ in range(m)]
        self.lengths = [0.0] * m
        self.slight = [1.0] * m
        self.sizes = [0.0] * m
        self.order = list(range(m))
        self.rank = m
        self.culprit = -1

    def factor(
        self,
        mass: list[float],
        g: list[float],
        lost: bool,
        miss: float = 0.0,
        slight: Sequence[float] = (),
        gamma_sizes: Callable[[], list[float]] | None = None,
    ) -> int:
        """From M (packed lower rows) and G (by rows).  `lost`: rows were dependent before; `miss`:
        how far, scaled, the posture is from the constraints; `slight`: 1 for each row, less for one
        whose gradient all but vanishes, so that its direction says little; `gamma_sizes` finds what
        the terms of gamma add up to."""
        self.slight = list(slight) if slight else [1.0] * self.m
        least = STILL_DEPENDENT if lost else DEPENDENT
        if MISSED * miss > least:
            least = MISSED * miss if MISSED * miss < MOST_DEPENDENT else MOST_DEPENDENT
        self.g = g
        self.weight = 0.0
        self.sizes = [0.0] * self.m
        if self.m == 0:
            return OK if self._cholesky(mass) else SINGULAR_MASS
        if not lost and self._cholesky(mass):
            self._orthogonalise(least)
            if self.rank == self.m:
                return OK
        trace, squares = 0.0, 0.0
        for i in range(self.n):
            trace += mass[i * (i + 1) // 2 + i]
        for a in g:
            squares += a * a
        if squares > 0.0:
            self.weight = trace / squares if trace > 0.0 else 1.0 / squares
        if not self._cholesky(mass):
            return SINGULAR_MASS
        if gamma_sizes is not None:
            self.sizes = gamma_sizes()
        self._orthogonalise(least)
        if self.rank == self.m:
            return OK
        self.culprit = self.order[self.rank]
        return REDUNDANT

    def solve(self, r1: list[float], r2: list[float]) -> tuple[int, list[float], list[float]]:
        """(status, s1, s2) with M s1 - G^T s2 = r1, G s1 = r2; s2 as short as possible.

        A row that depends on others contradicts them where it misses r2 by more than a share of what r2
        is made of: of the accelerations, and of the terms of gamma, which are all that is left where its
        gradient vanishes."""
        n, m, rank, order, r, b, lengths = self.n, self.m, self.rank, self.order, self.r, self.b, self.lengths
        z = r1[:]
        if self.weight > 0.0:
            for i in range(m):
                factor = self.weight * r2[i]
                for j in range(n):
                    z[j] += factor * self.g[i * n + j]
        self._lower(z)
        size, longest = 0.0, 0.0
        for a in z:
            size += a * a
        w = [0.0] * m
        for k in range(rank):
            i = order[k]
            value = r2[i] / lengths[i]
            for j in range(k):
                value -= r[j][i] * w[j]
            w[k] = value / r[k][i]
            size += w[k] * w[k]
            if lengths[i] > longest:
                longest = lengths[i]
        size = longest * sqrt(size)
        status = OK if rank == m else REDUNDANT
        worst = CONTRADICTION
        for k in range(rank, m):
            i = order[k]
            value = 0.0
            for j in range(rank):
                value += r[j][i] * w[j]
            value = r2[i] - lengths[i] * value
            share = abs(value) / (abs(r2[i]) + size + self.sizes[i] + 1e-300)
            if share > worst:
                status, self.culprit, worst = INCONSISTENT, i, share
        for k in range(rank):
            q = b[order[k]]
            value = w[k]
            for j in range(n):
                value -= q[j] * z[j]
            w[k] = value
        for k in range(rank):
            q, value = b[order[k]], w[k]
            for j in range(n):
                z[j] += q[j] * value
        self._upper(z)
        return status, z, self._multipliers(w)

    def _cholesky(self, mass: list[float]) -> bool:
        low: list[list[float]] = []
        self.low = low
        for i in range(self.n):
            entries = mass[i * (i + 1) // 2 : i * (i + 1) // 2 + i + 1]
            if self.weight > 0.0:
                self._weigh(entries, i)
            row: list[float] = []
            for value, other in zip(entries, low):
                for a, b in zip(row, other):  # as far as `row` is known
                    value -= a * b
                row.append(value / other[-1])
            value = whole = entries[i]
            for a in row:
                value -= a * a
            if not value > SINGULAR * whole:
                self.culprit = i
                return False
            row.append(sqrt(value))
            low.append(row)
        return True

    def _weigh(self, entries: list[float], i: int) -> None:
        """Row i of M + weight G^T G."""
        n, g = self.n, self.g
        for j in range(i + 1):
            value = entries[j]
            for k in range(self.m):
                value += self.weight * g[k * n + i] * g[k * n + j]
            entries[j] = value

    def _lower(self, z: list[float]) -> None:
        """z = L^-1 z."""
        known: list[float] = []
        for value, row in zip(z, self.low):
            for a, b in zip(row, known):
                value -= a * b
            known.append(value / row[-1])
        z[:] = known

    def _upper(self, z: list[float]) -> None:
        """z = L^-T z."""
        for i in range(self.n - 1, -1, -1):
            row = self.low[i]
            value = z[i] / row[i]
            z[i] = value
            z[:i] = [a - b * value for a, b in zip(z, row[:i])]

    def _row(self, i: int) -> None:
        """Row i of G as a vector of length `slight` in the metric of M, and its length then."""
        n = self.n
        row = self.b[i]
        row[:] = self.g[i * n : (i + 1) * n]
        self._lower(row)
        length = sqrt(_square(row))
        if length > 0.0:
            length = length / self.slight[i]
        self.lengths[i] = length
        if length > 0.0:
            row[:] = [a / length for a in row]

    def _orthogonalise(self, dependent: float) -> None:
        """Modified Gram-Schmidt; each new vector is cleaned a second time.

        The next is the first row that is long enough, not the longest, so that it is always the
        same rows that are said to depend on those before.  Rows are passed by whose gamma is made of
        much larger terms for their length than that of others: near where a gradient vanishes, those
        that tell the same are better.
        """
        m, b, r, order = self.m, self.b, self.r, self.order
        squares = [0.0] * m
        for i in range(m):
            self._row(i)
            order[i] = i
        for k in range(m):
            longest = 0.0
            for j in range(k, m):
                squares[order[j]] = value = _square(b[order[j]])
                if value > longest:
                    longest = value
            if not longest > dependent * dependent:
                self.rank = k
                return
            steadiest = inf
            for i in order[k:]:
                if squares[i] >= 0.1 * longest and self.sizes[i] / self.lengths[i] < steadiest:
                    steadiest = self.sizes[i] / self.lengths[i]
            best = -1
            for j in range(k, m):
                i = order[j]
                if squares[i] < 0.1 * longest or self.sizes[i] / self.lengths[i] > UNSTEADY * steadiest:
                    continue
                if best < 0 or i < order[best]:
                    best = j
            order[k], order[best] = order[best], order[k]
            i = order[k]
            q = b[i]
            for j in range(k):
                r[j][i] += _remove(q, b[order[j]])
            length = sqrt(_square(q))
            r[k][i] = length
            q[:] = [a / length for a in q]
            for j in range(k + 1, m):
                r[k][order[j]] = _remove(b[order[j]], q)
        self.rank = m

    def _multipliers(self, c: list[float]) -> list[float]:
        """The shortest lam with B lam = Q c: free ones y minimise |base - T y|^2 + |y|^2."""
        m, rank, order, lengths = self.m, self.rank, self.order, self.lengths
        found = [0.0] * m
        self._triangle(c)
        for k in range(rank):
            found[order[k]] = c[k]
        free = m - rank
        if free == 0:
            return found
        table: list[list[float]] = []
        for f in range(free):
            i = order[rank + f]
            column = [self.r[k][i] * lengths[i] for k in range(rank)]
            self._triangle(column)
            table.append(column)
        normal = [[0.0] * free for _ in range(free)]
        y = [0.0] * free
        for f in range(free):
            for e in range(f + 1):
                value = 1.0 if e == f else 0.0
                for k in range(rank):
                    value += table[f][k] * table[e][k]
                for k in range(e):
                    value -= normal[f][k] * normal[e][k]
                normal[f][e] = value / normal[e][e] if e < f else sqrt(value)
            value = 0.0
            for k in range(rank):
                value += table[f][k] * c[k]
            for k in range(f):
                value -= normal[f][k] * y[k]
            y[f] = value / normal[f][f]
        for f in range(free - 1, -1, -1):
            value = y[f]
            for k in range(f + 1, free):
                value -= normal[k][f] * y[k]
            y[f] = value / normal[f][f]
            found[order[rank + f]] = y[f]
            for k in range(rank):
                found[order[k]] -= table[f][k] * y[f]
        return found

    def _triangle(self, c: list[float]) -> None:
        """c = diag(1/lengths) R^-1 c over the independent rows."""
        rank, order, r = self.rank, self.order, self.r
        for k in range(rank - 1, -1, -1):
            value = c[k]
            for j in range(k + 1, rank):
                value -= r[k][order[j]] * c[j]
            c[k] = value / r[k][order[k]]
        for k in range(rank):
            c[k] = c[k] / self.lengths[order[k]]


def _square(vector: list[float]) -> float:
    value = 0.0
    for a in vector:
        value += a * a
    return value


def _remove(vector: list[float], q: list[float]) -> float:
    """Take the part along q away; its size."""
    part = 0.0
    for a, b in zip(vector, q):
        part += a * b
    vector[:] = [a - part * b for a, b in zip(vector, q)]
    return part
