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
    kept = tuple(sorted(set(entries)))
    near: list[set[int]] = [set() for _ in range(size)]
    for i, j in kept:
        if i != j:
            near[i].add(j)
            near[j].add(i)
    massive = [(k, k) in set(kept) for k in range(size)]
    left = set(range(size))
    order: list[int] = []
    lower: list[Entry] = []
    while left:
        pivot = _choose(left, near, massive, speeds)
        if pivot is None:
            return None
        left.discard(pivot)
        order.append(pivot)
        around = sorted(near[pivot])
        for i in around:
            lower.append((i, pivot))
            near[i].discard(pivot)
            near[i].update(around)
            near[i].discard(i)
            massive[i] = True
    return Elimination(speeds, multipliers, tuple(order), kept, tuple(lower))


def _choose(left: set[int], near: Sequence[set[int]], massive: Sequence[bool], speeds: int) -> int | None:
    best: int | None = None
    best_rank: tuple[int, int, int] | None = None
    for k in sorted(left):
        if not massive[k]:
            continue
        ready = 1
        if k >= speeds:
            if any(j < speeds and massive[j] for j in near[k]):
                continue
            ready = 0
        rank = (ready, len(near[k]), k)
        if best_rank is None or rank < best_rank:
            best, best_rank = k, rank
    return best


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

    The ratio of a speed's pivot is d/M_kk; that of a multiplier's, -d / sum(G_j^2/d_j), the size
    it would have without the rows eliminated before it: near zero for a redundant row.  A
    pivot of the wrong sign makes its ratio negative.
    """
    current = dict(entries)
    below: dict[int, list[int]] = {k: [] for k in plan.order}
    for i, k in plan.lower:
        below[k].append(i)
    lower: dict[Entry, int] = {}
    inverse: dict[int, int] = {}
    ratios: list[int] = []
    for k in plan.order:
        pivot = current[(k, k)]
        inverse[k] = block.div(block.one, pivot)
        ratio = _ratio(block, plan, entries, lower, inverse, k, pivot)
        if ratio is not None:
            ratios.append(ratio)
        scaled = {i: current[_entry(i, k)] for i in below[k]}  # L D of this column
        for i in below[k]:
            lower[(i, k)] = block.mul(scaled[i], inverse[k])
        for n, i in enumerate(below[k]):
            for j in below[k][: n + 1]:
                at = _entry(i, j)
                product = block.mul(lower[(i, k)], scaled[j])
                current[at] = block.sub(current.get(at, block.zero), product)
    health = block.one
    for ratio in ratios:
        health = ratio if health == block.one else block.apply("min", health, ratio)
    return Factors(lower, inverse, health)


def _ratio(
    block: Block,
    plan: Elimination,
    entries: Mapping[Entry, int],
    lower: Mapping[Entry, int],
    inverse: Mapping[int, int],
    k: int,
    pivot: int,
) -> int | None:
    """The pivot ratio of unknown k, None where it is 1 by construction."""
    if k < plan.speeds:
        scale = entries.get((k, k))
        return None if scale is None or scale == pivot else block.div(pivot, scale)
    if not any((k, c) in lower for c in range(plan.speeds, plan.size)):
        return None
    scale = block.zero
    for j in range(plan.speeds):
        entry = entries.get((k, j))
        if entry is not None and j in inverse:
            scale = block.add(scale, block.mul(block.mul(entry, inverse[j]), entry))
    return None if block.is_zero(scale) else block.div(~pivot, scale)


def substitute(block: Block, plan: Elimination, factors: Factors, right: Sequence[int]) -> list[int]:
    """x with L D L^T x = right."""
    x = list(right)
    below: dict[int, list[int]] = {k: [] for k in plan.order}
    for i, k in plan.lower:
        below[k].append(i)
    for k in plan.order:
        for i in below[k]:
            x[i] = block.sub(x[i], block.mul(factors.lower[(i, k)], x[k]))
    for k in reversed(plan.order):
        x[k] = block.mul(x[k], factors.inverse[k])
        for i in below[k]:
            x[k] = block.sub(x[k], block.mul(factors.lower[(i, k)], x[i]))
    return x


def solve(
    block: Block,
    plan: Elimination,
    factors: Factors,
    entries: Mapping[Entry, int],
    right: Sequence[int],
    refine: bool,
) -> tuple[list[int], int]:
    """The unknowns, and the scaled residual of the first solution (zero where not refined).
    With `refine`, one step of iterative refinement follows, which lowers that residual by about
    the same factor again.

    The residual is the largest of the rows of speeds over the largest size of one, |r| + |M_kk a_k|;
    then the same of the rows of multipliers, where G a counts with the accelerations that forces of
    that size would bring, so that what is at rest is not judged by rounding errors alone.
    """
    x = substitute(block, plan, factors, right)
    if not refine:
        return x, block.zero
    products: list[list[int]] = [[] for _ in range(plan.size)]
    for i, j in plan.entries:
        products[i].append(block.mul(entries[(i, j)], x[j]))
        if i != j:
            products[j].append(block.mul(entries[(i, j)], x[i]))
    residual = [_rest(block, right[k], products[k]) for k in range(plan.size)]
    sizes = [_size(block, [right[k], *_own(block, entries, x, k)]) for k in range(plan.speeds)]
    for k in range(plan.speeds, plan.size):
        parts = [right[k]]
        for j in range(plan.speeds):
            if (k, j) in entries:
                share = factors.lower.get((k, j))  # G_kj / d_j
                parts.append(products[k][len(parts) - 1] if share is None else block.mul(share, sizes[j]))
        sizes.append(_size(block, parts))
    shares = [
        block.div(_largest(block, [_abs(block, r) for r in residual[part]]), _positive(block, sizes[part]))
        for part in (slice(plan.speeds), slice(plan.speeds, None))
        if residual[part]
    ]
    correction = substitute(block, plan, factors, residual)
    return [block.add(x[k], correction[k]) for k in range(plan.size)], _largest(block, shares)


def _own(block: Block, entries: Mapping[Entry, int], x: Sequence[int], k: int) -> list[int]:
    """The diagonal's term of row k, if any."""
    return [block.mul(entries[(k, k)], x[k])] if (k, k) in entries else []


def _rest(block: Block, right: int, products: Sequence[int]) -> int:
    for product in products:
        right = block.sub(right, product)
    return right


def _size(block: Block, terms: Sequence[int]) -> int:
    """The sum of absolute values."""
    total = block.zero
    for term in terms:
        total = block.add(total, _abs(block, term))
    return total


def _largest(block: Block, values: Sequence[int]) -> int:
    """Of values that are not negative."""
    largest = block.zero
    for value in values:
        if not block.is_zero(value):
            largest = value if block.is_zero(largest) else block.apply("max", largest, value)
    return largest


def _positive(block: Block, sizes: Sequence[int]) -> int:
    return block.add(block.const(1e-300), _largest(block, sizes))


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


def _abs(block: Block, a: int) -> int:
    return a if block.is_zero(a) else block.abs(a)


def _entry(i: int, j: int) -> Entry:
    return (i, j) if i >= j else (j, i)
