"""The functions that solve for accelerations and multipliers: rhs and watch, assemble, factor, solve.

All use one `Elimination` of the matrix of the equations, with the unknowns (a, -lam).
"""

from collections.abc import Iterator, Mapping, Sequence

from lagc.base.records import dataclass, replace
from lagc.lowering.interface import place
from lagc.lowering.kkt.articulated_body import ArticulatedBody, articulated_body, plain, with_summed_loads
from lagc.lowering.kkt.fill_ordering import Elimination, Structure, eliminate
from lagc.lowering.kkt.ldl import (
    Factors,
    Guard,
    Matrix,
    factor,
    factor_and_substitute,
    pair,
    refine,
    residual,
    substitute,
)
from lagc.lowering.kkt.prune import sources
from lagc.lowering.program import Function
from lagc.lowering.scalar.value_numbering import Block
from lagc.lowering.storage import Places, cheapest, lower
from lagc.mechanics.formulation.equations import EquationsOfMotion, Row
from lagc.symbolic.graph import Node
from lagc.symbolic.leaves import derived
from lagc.symbolic.walk import symbols


@dataclass(frozen=True)
class Solver:
    """The equations in one form, and how they are solved."""

    system: ArticulatedBody
    plan: Elimination

    @property
    def nodes(self) -> list[Node]:
        return [*self.system.entries.values(), *self.system.coefficients.values()]

    def matrix(self, values: Sequence[int]) -> Matrix:
        """Return the matrix for `values`, references to those of `nodes`."""
        n = len(self.system.entries)
        return Matrix(dict(zip(self.system.entries, values)), dict(zip(self.system.coefficients, values[n:])))


def rhs(places: Places, solver: Solver, work: bool) -> list[Function]:
    """Return xdot = (qdot, a, power), lam, health and, with multipliers, `watch`, which computes the relative
    residual of the solution from values stored in health."""
    equations = places.equations
    power = [equations.power] if work else []
    nodes = [*solver.nodes, *solver.system.right, *equations.qdot]
    return cheapest(places, nodes, lambda chosen: _rhs(places, solver, chosen, power))


def _rhs(places: Places, solver: Solver, nodes: Sequence[Node], power: Sequence[Node]) -> list[Function]:
    equations, plan, block = places.equations, solver.plan, Block()
    lowering, values = lower(places, block, nodes)
    first, last = len(solver.nodes), len(solver.nodes) + len(solver.system.right)
    matrix, b, qdot = solver.matrix(values[:first]), values[first:last], values[last:]
    # One unknown, or two speeds: closed forms, without loops over steps. Else factorization and solve at
    # once.
    if plan.structure.unknowns == 1:
        mass = matrix.entries[0, 0]
        x, left, health = [block.div(b[0], mass)], None, block.one
        # A force of zero divides by nothing: the pivot is still to be checked.
        if block.is_zero(x[0]):
            health = _with_inertia(block, plan, {0: block.div(block.one, mass)}, (), health)
    elif plan.structure.unknowns == plan.speeds == 2 and len(matrix.entries) == 3:
        (x, health), left = pair(block, matrix.entries, b), None
    else:
        factors, x = factor_and_substitute(block, plan, matrix, b)
        left = residual(block, plan, factors, matrix, b, x)[1] if plan.multipliers else None
        health = _with_inertia(block, plan, factors.inverse, x[: plan.size], factors.health)
    # Accelerations and multipliers are known to what follows: power, work, comments of the rows.
    found = _signed(plan, x)
    a, lam = found[: plan.speeds], found[plan.speeds :]
    lowering.known.update(zip(equations.a, a))
    lowering.known.update(zip(equations.lam, lam))
    xdot = [*qdot, *a, *lowering(power)]
    _store_all(block, "xdot", xdot, [derived(name) for name in equations.state_names])
    _store_all(block, "lam", lam, row_comments(equations.rows))
    _store_all(block, "health", [health, block.zero])
    made = [] if left is None else [_watch(places, block, left)]
    outputs = (("xdot", len(xdot)), ("lam", len(lam)), ("health", _health_length(block)))
    about = "right-hand side: qdot, accelerations, multipliers"
    return [block.function("rhs", places.state, outputs, about), *made]


def _watch(places: Places, block: Block, left: int) -> Function:
    """Return `left` as a separate function, health -> health, of values that `block` computes; they are
    stored behind its outputs."""
    other, found = block.split_off(left, "health", 2, len(places.constants))
    other.store("health", 1, found)
    outputs = (("health", _health_length(block)),)
    return other.function("watch", ("p", "health"), outputs, "what a solution leaves of its right-hand side")


def _health_length(block: Block) -> int:
    return sum(1 for store in block.stores if store.array == "health")


def _with_inertia(
    block: Block, plan: Elimination, inverses: Mapping[int, int], found: Sequence[int], health: int
) -> int:
    """Return `health`, not positive if the pivot of a speed is not, even if nothing was divided by it: a
    speed needs inertia without forces too."""
    # A pivot that the solve does not use is not computed there: its sign joins the health.
    used = block.needed_for([*found, health])
    for step in plan.pivots:
        inverse = block.unsigned(inverses[step.unknown])
        op, operands, _ = block.row(inverse)
        if op == "div" and not plan.structure.is_row(step.unknown) and inverse not in used:
            pivot = operands[1]
            if block.row(pivot)[0] != "const":
                sign = block.apply("sign", pivot if inverses[step.unknown] >= 0 else ~pivot)
                health = sign if health == block.one else block.apply("min", health, sign)
    return health


def work_size(solver: Solver, guarded: bool) -> int:
    """Return the number of doubles in w: entries and coefficients, L, 1/D; with guarded rows also their
    sizes, independent shares and limits, the damping share of rows, and that of rows that give a pivot to a
    speed without inertia."""
    factors = len(solver.nodes) + len(solver.plan.lower) + len(solver.plan.pivots)
    return factors + 3 * solver.plan.multipliers + 2 if guarded else factors


def assemble(places: Places, solver: Solver, guarded: bool) -> Function:
    def make(nodes: Sequence[Node]) -> list[Function]:
        block = Block()
        _store_all(block, "w", lower(places, block, nodes)[1])
        outputs = (("w", work_size(solver, guarded)),)
        return [block.function("assemble", places.state, outputs, "entries of [M G^T; G 0] into w")]

    (made,) = cheapest(places, solver.nodes, make)
    return made


def factorize(solver: Solver, guarded: bool) -> Function:
    """Return `factor`: it reads the entries in w and adds L and 1/D behind them."""
    # w holds, from its beginning: entries, L, 1/D; from its end backwards: damping shares, limits, shares and
    # sizes of rows.
    block, plan, length = Block(), solver.plan, work_size(solver, guarded)
    rows, behind = range(plan.speeds, plan.size), length - 2 - 3 * plan.multipliers
    guard = None
    if guarded:
        limits = {k: block.load("w", length - 2 - plan.size + k) for k in rows}
        guard = Guard(limits, block.load("w", length - 2), block.load("w", length - 1))
    factors = factor(block, plan, _assembled(block, solver), guard)
    at = len(solver.nodes)
    kept = [factors.lower[e] for e in plan.lower] + [factors.inverse[step.unknown] for step in plan.pivots]
    for k, value in enumerate(kept):
        block.store("w", at + k, value)
    health = factors.health
    if guarded:
        health = _with_inertia(block, plan, factors.inverse, (), health)
        found = [~factors.sizes.get(k, block.zero) for k in rows] + [factors.own[k] for k in rows]
        for k, value in enumerate(found, behind):
            block.store("w", k, value)
    _store_all(block, "health", [health, block.zero])
    outputs = (("w", length), ("health", 2))
    return block.function("factor", ("w",), outputs, "L D L^T of the matrix that `assemble` left in w")


def solve(solver: Solver) -> Function:
    """Return `solve`: M s1 - G^T s2 = r1, G s1 = r2 with the factors in w."""
    block, plan = Block(), solver.plan
    right = [block.load("r", k) for k in range(plan.size)]
    x = substitute(block, plan, _stored_factors(block, solver), _assembled(block, solver), right)
    _store_all(block, "s", _signed(plan, x))
    return block.function("solve", ("w", "r"), (("s", plan.size),), "M s1 - G^T s2 = r1, G s1 = r2")


def remainder(solver: Solver) -> Function:
    """Return the residual of a solution, whatever its factors."""
    block, plan = Block(), solver.plan
    right = [block.load("r", k) for k in range(plan.size)]
    x = _signed(plan, [block.load("s", k) for k in range(plan.size)])
    left, _ = residual(block, plan, _stored_factors(block, solver), _assembled(block, solver), right, x)
    _store_all(block, "e", left)
    return block.function("rest", ("w", "r", "s"), (("e", plan.size),), "what s leaves of r")


def refiner(solver: Solver) -> Function:
    """Return `refine`: one step of iterative refinement of s, a solution that `solve` gave."""
    block, plan = Block(), solver.plan
    right = [block.load("r", k) for k in range(plan.size)]
    x = _signed(plan, [block.load("s", k) for k in range(plan.size)])
    found = refine(block, plan, _stored_factors(block, solver), _assembled(block, solver), right, x)
    _store_all(block, "s", _signed(plan, found))
    about = "one step of refinement of what solve gave"
    return block.function("refine", ("w", "r", "s"), (("s", plan.size),), about)


def _assembled(block: Block, solver: Solver) -> Matrix:
    """Return the matrix that `assemble` left in w; its constants are numbers, not loads."""
    return solver.matrix([
        block.const(node.value) if node.is_const else block.load("w", k)
        for k, node in enumerate(solver.nodes)
    ])  # fmt: skip


def _stored_factors(block: Block, solver: Solver) -> Factors:
    """Return the factors that `factor` left in w."""
    plan, first = solver.plan, len(solver.nodes)
    lower_part = {at: block.load("w", first + k) for k, at in enumerate(plan.lower)}
    first += len(lower_part)
    inverse = {step.unknown: block.load("w", first + k) for k, step in enumerate(plan.pivots)}
    return Factors(lower_part, inverse, block.one, {})


def _signed(plan: Elimination, x: Sequence[int]) -> list[int]:
    """Return `x` with the multipliers in place of the unknowns -lam, or the other way round."""
    return [*x[: plan.speeds], *(~value for value in x[plan.speeds : plan.size])]


def row_comments(rows: Sequence[Row]) -> list[str]:
    """Return a comment for each row: its label and its source line."""
    return [f"{row.label}, {place(row.span)}" for row in rows]


def _store_all(block: Block, array: str, values: Sequence[int], comments: Sequence[str] = ()) -> None:
    for k, value in enumerate(values):
        block.store(array, k, value, comments[k] if k < len(comments) else "")


LARGEST = 3000  # operations of a straight solve; beyond, it is a loop
LARGEST_GROWING = 2_000_000  # the same where work grows with the model
LARGEST_SPARSE = 250_000  # the same beside a dense solve, a loop: C compilers take minutes for more
DENSE = 10  # times its operations a straight solve saves, where it is longer than LARGEST
SPARSE = 100  # operations for each unknown that are straight, however many unknowns
_MOST_SPEEDS = 20
_MOST_UNKNOWNS = 100  # speeds and multipliers: beyond, a dense solve is as long as some hundred straight ones
_WORTH = 0.8  # of the operations, at most, where bodies keep their velocities


def forms_matrix(equations: EquationsOfMotion) -> bool:
    """Return whether the mass matrix is formed although the equations may be solved without it."""
    if equations.rows:
        return len(equations.v) + len(equations.rows) <= _MOST_UNKNOWNS
    return len(equations.v) <= _MOST_SPEEDS


def solvers(equations: EquationsOfMotion) -> Iterator[Solver]:
    """Yield the forms of the equations that straight-line code can solve, each with its elimination."""
    for system in _forms(equations):
        plan = _plan(system)
        if plan is not None:
            yield Solver(system, plan)
            if system.structure.definitions and not forms_matrix(equations):
                return


def _plan(system: ArticulatedBody) -> Elimination | None:
    """Return the elimination with all shared velocities substituted, which loses no digits, or with those of
    bodies kept if that is much cheaper, as with many loops."""
    # Kept velocities of bodies keep the graph of the bodies, which pays with many loops. They lose digits, so
    # they are taken only where they save a fifth of the operations.
    structure, kept = system.structure, None
    most: float = _largest_solve(structure)
    if system.heavy and structure.multipliers:
        kept = eliminate(replace(structure, kept=system.heavy), most)
        most = most if kept is None else min(most, kept.flops / _WORTH)
    return eliminate(structure, most) or kept


def _largest_solve(structure: Structure) -> int:
    """Return the largest number of operations of a straight solve. A dense solve of n^3/3 operations is a
    loop of little code."""
    if structure.definitions:
        return LARGEST_GROWING
    dense = structure.size**3 // 3
    return max(LARGEST, SPARSE * structure.size, min(LARGEST_SPARSE, dense // DENSE))


def _forms(equations: EquationsOfMotion) -> Iterator[ArticulatedBody]:
    # Three forms: shared velocities as unknowns; the mass matrix with forces one by one; the same with forces
    # in one sweep. The shortest code wins.
    known = symbols(sources(equations))
    raised = articulated_body(equations)
    if raised is not None and _is_made_of(known, raised):
        yield raised
        if not (equations.rows or forms_matrix(equations)):
            return
    apart = plain(equations)
    yield apart
    one = with_summed_loads(equations, apart)
    if any(a is not b for a, b in zip(apart.right, one.right)) and _is_made_of(known, one):
        yield one


def _is_made_of(known: set[Node], system: ArticulatedBody) -> bool:
    """Return whether `system` reads only those symbols. Forces that cancel when they are summed may not
    cancel separately, and may need further parameters and coordinates."""
    return symbols([*system.entries.values(), *system.coefficients.values(), *system.right]) <= known
