"""Straight-line sparse factors of the matrix of the equations, along an `Elimination`, and solves with them.

A substitution of w_k = sum of c_u u changes the other entries to A_uj + c_u z_j with z = A_k. + A_kk c, and
those within the definition to A_uw + c_u z_w + A_uk c_w. There is no pivoting: errors show in `health` and in
the residual, which the caller checks.
"""

from collections.abc import Mapping, Sequence

from lagc.base.records import dataclass, field
from lagc.lowering.kkt.fill_ordering import Elimination, Entry, Step, Structure, entry
from lagc.lowering.scalar.value_numbering import Block


@dataclass(frozen=True)
class Factors:
    """References to L below the diagonal, 1/D, the smallest pivot ratio, the sizes of the pivots without
    subtraction, and the independent shares of guarded rows (0 if a row is left out)."""

    lower: Mapping[Entry, int]
    inverse: Mapping[int, int]
    health: int
    sizes: Mapping[int, int]
    own: Mapping[int, int] = field(default_factory=dict)


@dataclass(frozen=True)
class Guard:
    """References to the numbers that keep the factors of dependent rows finite. A row whose independent share
    is at most its limit is left out, with multiplier 0; others are damped by `share` of their size. A row
    that gives a pivot to a speed without inertia is never left out and is damped by `least`."""

    limits: Mapping[int, int]
    share: int
    least: int


@dataclass(frozen=True)
class Matrix:
    """References: the entries that are not zero, and the coefficients of definitions as (k, u)."""

    entries: Mapping[Entry, int]
    coefficients: Mapping[Entry, int]


class _Factoring:
    """The matrix during elimination, and the sizes of the diagonal terms that have the sign of the pivot: the
    mass of a speed and -sum of L_j^2 d_j over the rows j; for a row that sum over the speeds. `reduced` has
    the unknowns whose diagonal entry something was subtracted from."""

    def __init__(self, block: Block, plan: Elimination, matrix: Matrix, guard: Guard | None):
        self.block, self.structure, self.matrix, self.guard = block, plan.structure, matrix, guard
        self.current = {**matrix.entries, **_tie_rows(block, plan.structure, matrix)}
        rows = plan.structure.is_row
        self.sizes = {i: value for (i, j), value in matrix.entries.items() if i == j and not rows(i)}
        self.reduced: set[int] = set()
        self.lower: dict[Entry, int] = {}
        self.inverse: dict[int, int] = {}
        self.own: dict[int, int] = {}
        self.health = block.one

    def at(self, i: int, j: int) -> int:
        """Return an entry; zero if terms cancelled that the structure counts as present."""
        return self.current.get(entry(i, j), self.block.zero)

    def add(self, i: int, j: int, value: int) -> None:
        self.current[entry(i, j)] = self.block.add(self.at(i, j), value)

    def enlarge(self, k: int, value: int) -> None:
        self.sizes[k] = self.block.add(self.sizes.get(k, self.block.zero), value)

    @property
    def factors(self) -> Factors:
        return Factors(self.lower, self.inverse, self.health, self.sizes, self.own)

    def eliminate(self, step: Step) -> None:
        if step.definition:
            self.substitution(step)
        else:
            self.pivot(step)

    def pivot(self, step: Step) -> None:
        # 1/D_k once: a division is as long as four products, and all rows of the column share it.
        block, k = self.block, step.unknown
        pivot = self.at(k, k)
        if self.guard is not None and k in self.guard.limits:
            self.inverse[k] = self._guarded_inverse(self.guard, step, ~pivot)
        else:
            self.inverse[k] = block.div(block.one, pivot)
            self._watch(k, pivot)
        # L_ik = A_ik / D_k, and the rest of the matrix loses L_ik D_k L_jk. Only neighbours of k in the graph
        # of the matrix are touched.
        scaled = {i: self.at(i, k) for i in step.near}  # L D of this column
        for i in step.near:
            self.lower[(i, k)] = block.mul(scaled[i], self.inverse[k])
        row = self.structure.is_row
        # The diagonal of a row against a speed (and of a speed against a row) grows by such terms, which have
        # its sign; within the same kind they are subtracted. The pivot ratio d / (sum of its own terms)
        # measures how much was cancelled.
        for n, i in enumerate(step.near):
            for j in step.near[: n + 1]:
                share = ~block.mul(self.lower[(i, k)], scaled[j])
                self.add(i, j, share)
                if i == j and row(i) != row(k):
                    self.enlarge(i, share)
                elif i == j:
                    self.reduced.add(i)

    def _guarded_inverse(self, guard: Guard, step: Step, own: int) -> int:
        """Return the inverse pivot of a row; `own` is minus its pivot."""
        block, k = self.block, step.unknown
        # The size of a row is the sum of its terms before others were subtracted; `own` is what is
        # independent of the rows before.
        size = ~self.sizes.get(k, block.zero)
        # Speeds without inertia get their pivot from this row: it must stay, damped by the least share.
        if any(not self.structure.is_row(j) and block.is_zero(self.at(j, j)) for j in step.near):
            damped = block.add(own, block.mul(guard.least, size))
            self.own[k] = block.div(damped, size)
            return ~block.div(block.one, damped)
        # The decision is arithmetic, without branches: `lt` and `select` choose between 1/D and 0, and a
        # divisor that is not used is 1.
        kept = block.apply("lt", block.mul(guard.limits[k], size), own)
        part = block.div(own, block.apply("select", kept, size, block.one))
        self.own[k] = block.apply("select", kept, part, block.zero)
        damped = block.add(own, block.mul(guard.share, size))
        whole = block.div(block.one, block.apply("select", kept, damped, block.one))
        return ~block.apply("select", kept, whole, block.zero)

    def _watch(self, k: int, pivot: int) -> None:
        """Lower the health to the ratio of this pivot to its size: near zero for a speed without inertia and
        a redundant row, of the wrong sign if the matrix is indefinite."""
        # A pivot can have lost digits only if something was subtracted from it; the smallest ratio of all is
        # `health`.
        size = self.sizes.get(k)
        if size == pivot or k not in self.reduced:
            return
        ratio = ~self.block.one if size is None else self.block.div(pivot, size)
        first = self.health == self.block.one
        self.health = ratio if first else self.block.apply("min", self.health, ratio)

    def substitution(self, step: Step) -> None:
        """Eliminate a shared velocity w_k = sum of c_u u by its definition."""
        # The unknown k is sum of c_u u. Its row and column go to the unknowns u of its definition:
        # x^T A x with x_k = c . u adds c_u a_kj to A_uj, and c_u c_w a_kk to A_uw.
        block, k = self.block, step.unknown
        c = {u: self.matrix.coefficients[(k, u)] for u in step.definition}
        row = {j: self.at(k, j) for j in step.near}
        # z is row k, with a_kk c_u among its entries: so c_u z_w counts c_u a_kw and c_u c_w a_kk, and
        # c_w a_ku is the other half.
        z = dict(row)
        if step.massive:
            own = self.at(k, k)
            for u in step.definition:
                share = block.mul(own, c[u])
                z[u] = block.add(z[u], share) if u in z else share
        for n, u in enumerate(step.definition):
            for j in z:
                if j not in c:
                    self.add(u, j, block.mul(c[u], z[j]))
            for w in step.definition[: n + 1]:
                value = block.mul(c[u], z[w]) if w in z else block.zero
                if u in row:
                    value = block.add(value, block.mul(c[w], row[u]))
                if not block.is_zero(value):
                    self.add(u, w, value)
            # Sizes of pivots follow: c_u^2 times that of k, lessened where that is.
            if k in self.sizes:
                self.enlarge(u, block.mul(block.mul(c[u], c[u]), self.sizes[k]))
                if k in self.reduced:
                    self.reduced.add(u)


def _tie_rows(block: Block, structure: Structure, matrix: Matrix) -> dict[Entry, int]:
    """Return the entries of the rows sum of c_u u - w_k = 0 of kept velocities."""
    found: dict[Entry, int] = {}
    for k, row in structure.ties:
        found[row, k] = ~block.one
        found.update(((row, u), matrix.coefficients[k, u]) for u in structure.definitions[k])
    return found


def factor(block: Block, plan: Elimination, matrix: Matrix, guard: Guard | None = None) -> Factors:
    """Return L D L^T of the matrix, with substitutions. The pivot ratio of a speed is about d/M_kk; that of a
    multiplier is -d / sum(L_j^2 d_j) over the speeds j, near zero for a redundant row. A pivot of the wrong
    sign makes its ratio negative."""
    work = _Factoring(block, plan, matrix, guard)
    for step in plan.steps:
        work.eliminate(step)
    return work.factors


def substitute(
    block: Block, plan: Elimination, factors: Factors, matrix: Matrix, right: Sequence[int]
) -> list[int]:
    """Return the solution for a right-hand side, which is zero where it ends."""
    x = _padded(block, plan, right)
    for step in plan.steps:
        _forward(block, step, factors.lower, matrix, x)
    return _backward(block, plan, factors, matrix, x)


def factor_and_substitute(
    block: Block, plan: Elimination, matrix: Matrix, right: Sequence[int]
) -> tuple[Factors, list[int]]:
    """Return factors and solution, made step by step: work on the right-hand side goes on while a pivot is
    waited for."""
    work, x = _Factoring(block, plan, matrix, None), _padded(block, plan, right)
    for step in plan.steps:
        work.eliminate(step)
        _forward(block, step, work.lower, matrix, x)
    return work.factors, _backward(block, plan, work.factors, matrix, x)


def _padded(block: Block, plan: Elimination, right: Sequence[int]) -> list[int]:
    return [*right, *[block.zero] * (plan.structure.unknowns - len(right))]


def _forward(block: Block, step: Step, lower: Mapping[Entry, int], matrix: Matrix, x: list[int]) -> None:
    """Apply a step of the elimination to a right-hand side."""
    # A definition w_k = c . u passes a force on w_k to the u; a pivot is the usual forward substitution.
    k = step.unknown
    for u in step.definition:
        x[u] = block.add(x[u], block.mul(matrix.coefficients[(k, u)], x[k]))
    if not step.definition:
        for i in step.near:
            x[i] = block.sub(x[i], block.mul(lower[(i, k)], x[k]))


def _backward(block: Block, plan: Elimination, factors: Factors, matrix: Matrix, x: list[int]) -> list[int]:
    # Backwards each velocity by its definition, each pivot by D^-1 and L^T. Operands that are known last are
    # subtracted last, so that the chain of operations stays short.
    when = {step.unknown: n for n, step in enumerate(plan.steps)}
    for step in reversed(plan.steps):
        k = step.unknown
        if step.definition:
            x[k] = _combination(block, plan.structure, matrix, k, x)
            continue
        x[k] = block.mul(x[k], factors.inverse[k])
        for i in sorted(step.near, key=when.__getitem__, reverse=True):  # what is known last comes last
            x[k] = block.sub(x[k], block.mul(factors.lower[(i, k)], x[i]))
    return x


def _combination(block: Block, structure: Structure, matrix: Matrix, k: int, x: Sequence[int]) -> int:
    """Return a lifted velocity by its definition."""
    return _sum(block, [block.mul(matrix.coefficients[(k, u)], x[u]) for u in structure.definitions[k]])


def residual(
    block: Block, plan: Elimination, factors: Factors, matrix: Matrix, right: Sequence[int], x: Sequence[int]
) -> tuple[list[int], int]:
    """Return the residual of `x` for `right`, and its squared size relative to the right side. Sizes are in
    the norm of the inverse pivots, sum of r_k^2 / |D_k|, which is the energy of an impulse r. The terms M_kk
    a_k count for the right side, so that motions driven by constraints alone are not compared with round-off.
    Kept velocities and their definitions are checked if `x` contains them."""
    # y has x and all velocities by their definitions. A kept velocity is an unknown too: its definition
    # is a row of its own.
    structure = plan.structure
    ties = dict(structure.ties) if len(x) > plan.size else {}
    y = [*x[: plan.size], *[block.zero] * len(structure.definitions)]
    products: list[list[int]] = [[] for _ in range(structure.unknowns)]
    for k in sorted(structure.definitions):
        y[k] = _combination(block, structure, matrix, k, y)
        if k in ties:
            products[ties[k]] = [y[k], ~x[k]]
            y[k] = x[k]
    # products[i] are the terms of row i of the symmetric matrix times y.
    for (i, j), value in matrix.entries.items():
        products[i].append(block.mul(value, y[j]))
        if i != j:
            products[j].append(block.mul(value, y[i]))
    # From the last definition to the first: forces on a shared velocity are forces on its parts.
    for k in sorted(structure.definitions, reverse=True):  # a force on it is one on what it is made of
        if k in ties:
            force = x[ties[k]]
            products[k].append(~force)
        else:
            force = _sum(block, products[k])
            if k < len(right):
                force = block.sub(force, right[k])
        for u in structure.definitions[k]:
            products[u].append(block.mul(matrix.coefficients[(k, u)], force))
    # The residual of each row, and its size in the norm of the inverse pivots.
    right = [*right, *[block.zero] * (structure.unknowns - len(right))]
    watched = {*range(plan.size), *ties, *ties.values()}
    rest = {k: _remainder(block, right[k], products[k]) for k in watched}
    # r^T |D|^-1 r over the pivots: the energy that an impulse r would give. A row has a negative pivot.
    left = total = block.zero
    for step in plan.pivots:
        k = step.unknown
        if k not in watched:
            continue
        row = structure.is_row(k)
        weight = ~factors.inverse[k] if row else factors.inverse[k]
        left = block.add(left, block.mul(_square(block, rest[k]), weight))
        size = _square(block, right[k])
        # M_kk a_k counts for the right side.
        if k in factors.sizes and not row:
            size = block.add(size, _square(block, block.mul(factors.sizes[k], x[k])))
        total = block.add(total, block.mul(size, weight))
    return [rest[k] for k in range(plan.size)], block.div(left, block.add(block.const(1e-300), total))


def refine(
    block: Block, plan: Elimination, factors: Factors, matrix: Matrix, right: Sequence[int], x: Sequence[int]
) -> list[int]:
    """Return `x` after one step of iterative refinement, which reduces its relative residual to about its
    square."""
    rest, _ = residual(block, plan, factors, matrix, right, x)
    return [block.add(a, da) for a, da in zip(x, substitute(block, plan, factors, matrix, rest))]


def _sum(block: Block, terms: Sequence[int]) -> int:
    total = block.zero
    for term in terms:
        total = block.add(total, term)
    return total


def _remainder(block: Block, right: int, products: Sequence[int]) -> int:
    for product in products:
        right = block.sub(right, product)
    return right


def _square(block: Block, a: int) -> int:
    return block.mul(a, a)


def pair(block: Block, entries: Mapping[Entry, int], right: Sequence[int]) -> tuple[list[int], int]:
    """Return the unknowns of a positive definite 2 x 2 system and its pivot ratio by Cramer's rule, with one
    division instead of two dependent ones."""
    # [m k; k n] by Cramer's rule; the pivot ratio is det / (m n).
    m, k, n = entries[(0, 0)], entries[(1, 0)], entries[(1, 1)]
    whole = block.mul(m, n)
    determinant = block.sub(whole, block.mul(k, k))
    inverse = block.div(block.one, determinant)
    first = block.sub(block.mul(n, right[0]), block.mul(k, right[1]))
    second = block.sub(block.mul(m, right[1]), block.mul(k, right[0]))
    return [block.mul(inverse, first), block.mul(inverse, second)], block.div(determinant, whole)
