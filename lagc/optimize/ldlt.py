"""Straight-line sparse LDL^T of the mass matrix or of the KKT matrix.

Unknown n + c of [M G^T; G 0] (a, -lam) = (r, gamma) is minus the multiplier of row c, so that
the matrix is symmetric.  The order of elimination is fixed beforehand: the speed of least fill
first, a multiplier as soon as all speeds that it touches are gone (its pivot is then
-G M^-1 G^T < 0), a massless speed after the multipliers that touch it.  No pivoting: what goes
wrong shows in `health` and in the residual, which the caller watches.

G. Golub, C. Van Loan, *Matrix Computations*, 4.1; R. Vanderbei, *Symmetric quasidefinite
matrices*, SIAM J. Optim. 5 (1995), for the signs of the pivots.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from heapq import heapify, heappop, heappush

from lagc.optimize.block import Block
from lagc.records import dataclass

Entry = tuple[int, int]  # row, column; row >= column


@dataclass(frozen=True)
class Elimination:
    """What of the factorisation is known at compile time.

    `order`: unknowns as they are eliminated; `entries`: those of the matrix that are not
    structurally zero; `lower`: those of L below its unit diagonal, (row, column) as unknowns,
    the column eliminated first.
    """

    speeds: int
    multipliers: int
    order: tuple[int, ...]
    entries: tuple[Entry, ...]
    lower: tuple[Entry, ...]

    @property
    def size(self) -> int:
        return self.speeds + self.multipliers


def eliminate(speeds: int, multipliers: int, entries: Iterable[Entry]) -> Elimination | None:
    """Choose the order; None where no order without pivoting exists (a massless speed that no
    constraint gives a mass, a row that touches no speed)."""
    size = speeds + multipliers
    there = set(entries)
    kept = tuple(sorted(there))
    near: list[set[int]] = [set() for _ in range(size)]
    for i, j in kept:
        if i != j:
            near[i].add(j)
            near[j].add(i)
    massive = [(k, k) in there for k in range(size)]
    order: list[int] = []
    lower: list[Entry] = []
    heap = [rank for k in range(size) if (rank := _rank(k, near, massive, speeds)) is not None]
    heapify(heap)
    while heap:
        rank = heappop(heap)
        pivot = rank[-1]
        if rank != _rank(pivot, near, massive, speeds):
            continue  # it has another by now, or is gone
        massive[pivot] = False
        order.append(pivot)
        around = sorted(near[pivot])
        for i in around:
            lower.append((i, pivot))
            near[i].discard(pivot)
            near[i].update(around)
            near[i].discard(i)
            massive[i] = True
        for i in around:
            new = _rank(i, near, massive, speeds)
            if new is not None:
                heappush(heap, new)
    if len(order) < size:
        return None
    return Elimination(speeds, multipliers, tuple(order), kept, tuple(lower))


def _rank(
    k: int, near: Sequence[set[int]], massive: Sequence[bool], speeds: int
) -> tuple[int, int, int] | None:
    """How soon unknown k is eliminated; None where it cannot be now."""
    if not massive[k] or (k >= speeds and any(j < speeds and massive[j] for j in near[k])):
        return None
    return int(k < speeds), len(near[k]), k


def flops(plan: Elimination) -> int:
    """Operations of the factorisation and one solve, about."""
    column = [0] * plan.size
    for _, k in plan.lower:
        column[k] += 1
    return sum(c * (c + 1) + 5 * c + 2 for c in column)


@dataclass(frozen=True)
class Factors:
    """References: L below the diagonal, 1/D, and the smallest pivot ratio."""

    lower: Mapping[Entry, int]
    inverse: Mapping[int, int]
    health: int


def factor(block: Block, plan: Elimination, entries: Mapping[Entry, int]) -> Factors:
    """L D L^T of the matrix with these entries.

    The ratio of a speed's pivot is d/M_kk; that of a multiplier's, -d / sum(L_j^2 d_j) over the
    speeds j, the size it would have without the rows eliminated before it: near zero for a
    redundant row.  A pivot of the wrong sign makes its ratio negative.
    """
    current = dict(entries)
    below: dict[int, list[int]] = {k: [] for k in plan.order}
    for i, k in plan.lower:
        below[k].append(i)
    lower: dict[Entry, int] = {}
    inverse: dict[int, int] = {}
    sizes = [entries.get((k, k), block.zero) if k < plan.speeds else block.zero for k in range(plan.size)]
    health = block.one
    for k in plan.order:
        pivot = current[(k, k)]
        inverse[k] = block.div(block.one, pivot)
        size = sizes[k] if k < plan.speeds else ~sizes[k]
        if not block.is_zero(size) and size != pivot:
            ratio = block.div(pivot, size)
            health = ratio if health == block.one else block.apply("min", health, ratio)
        scaled = {i: current[_entry(i, k)] for i in below[k]}  # L D of this column
        for i in below[k]:
            lower[(i, k)] = block.mul(scaled[i], inverse[k])
        for n, i in enumerate(below[k]):
            for j in below[k][: n + 1]:
                at = _entry(i, j)
                product = block.mul(lower[(i, k)], scaled[j])
                current[at] = block.sub(current.get(at, block.zero), product)
                if i == j >= plan.speeds > k:
                    sizes[i] = block.add(sizes[i], product)
    return Factors(lower, inverse, health)


def substitute(block: Block, plan: Elimination, factors: Factors, right: Sequence[int]) -> list[int]:
    """x with L D L^T x = right."""
    x = list(right)
    below: dict[int, list[int]] = {k: [] for k in plan.order}
    for i, k in plan.lower:
        below[k].append(i)
    for k in plan.order:
        for i in below[k]:
            x[i] = block.sub(x[i], block.mul(factors.lower[(i, k)], x[k]))
    when = {k: n for n, k in enumerate(plan.order)}
    for k in reversed(plan.order):
        x[k] = block.mul(x[k], factors.inverse[k])
        for i in sorted(below[k], key=when.__getitem__, reverse=True):  # what is known last comes last
            x[k] = block.sub(x[k], block.mul(factors.lower[(i, k)], x[i]))
    return x


def residual(
    block: Block,
    plan: Elimination,
    factors: Factors,
    entries: Mapping[Entry, int],
    right: Sequence[int],
    x: Sequence[int],
) -> tuple[list[int], int]:
    """What `x` leaves of `right`, and the square of its size relative to that of the right side.

    Sizes are in the norm of the inverse pivots, sum of r_k^2 / |D_k|, in which forces and
    constraints are alike (it is the energy that an impulse r brings).  The terms M_kk a_k count for
    the right side, so that what is driven by constraints alone is not judged by rounding errors.
    """
    products: list[list[int]] = [[] for _ in range(plan.size)]
    for i, j in plan.entries:
        products[i].append(block.mul(entries[(i, j)], x[j]))
        if i != j:
            products[j].append(block.mul(entries[(i, j)], x[i]))
    rest = [_rest(block, right[k], products[k]) for k in range(plan.size)]
    left = total = block.zero
    for k in plan.order:
        weight = factors.inverse[k] if k < plan.speeds else ~factors.inverse[k]
        left = block.add(left, block.mul(_square(block, rest[k]), weight))
        size = _square(block, right[k])
        if (k, k) in entries:
            size = block.add(size, _square(block, block.mul(entries[(k, k)], x[k])))
        total = block.add(total, block.mul(size, weight))
    return rest, block.div(left, block.add(block.const(1e-300), total))


def refine(
    block: Block,
    plan: Elimination,
    factors: Factors,
    entries: Mapping[Entry, int],
    right: Sequence[int],
    x: Sequence[int],
) -> list[int]:
    """One step of iterative refinement of the solution `x`, which lowers its residual by about the
    factor that the residual is below the right side."""
    rest, _ = residual(block, plan, factors, entries, right, x)
    return [block.add(a, da) for a, da in zip(x, substitute(block, plan, factors, rest))]


def _rest(block: Block, right: int, products: Sequence[int]) -> int:
    for product in products:
        right = block.sub(right, product)
    return right


def _square(block: Block, a: int) -> int:
    return block.mul(a, a)


def pair(block: Block, entries: Mapping[Entry, int], right: Sequence[int]) -> tuple[list[int], int]:
    """The unknowns of a full positive definite 2 x 2 system, and its pivot ratio, by Cramer's rule:
    one division on the way, where factors need two, one after the other."""
    m, k, n = entries[(0, 0)], entries[(1, 0)], entries[(1, 1)]
    whole = block.mul(m, n)
    determinant = block.sub(whole, block.mul(k, k))
    inverse = block.div(block.one, determinant)
    first = block.sub(block.mul(n, right[0]), block.mul(k, right[1]))
    second = block.sub(block.mul(m, right[1]), block.mul(k, right[0]))
    return [block.mul(inverse, first), block.mul(inverse, second)], block.div(determinant, whole)


def _entry(i: int, j: int) -> Entry:
    return (i, j) if i >= j else (j, i)
