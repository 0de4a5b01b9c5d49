"""The functions that solve for accelerations and multipliers: rhs, assemble, factor, solve.

All follow one `Elimination` of the KKT matrix [M G^T; G 0], unknowns (a, -lam).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from lagc.expr.graph import Node
from lagc.expr.symbol import derived
from lagc.mechanics.equations import EquationsOfMotion, Row
from lagc.optimize.block import Block
from lagc.optimize.interface import place
from lagc.optimize.ldlt import (
    Elimination,
    Entry,
    Factors,
    eliminate,
    factor,
    pair,
    refine,
    residual,
    substitute,
)
from lagc.optimize.program import Function
from lagc.optimize.symbols import STATE, Places, cheapest, lower


def kkt_entries(equations: EquationsOfMotion) -> dict[Entry, Node]:
    """The lower triangle of the KKT matrix, structural zeros left out, by (row, column)."""
    found = {at: node for at, node in equations.mass_matrix.items() if not node.is_zero}
    n = len(equations.v)
    for k, row in enumerate(equations.rows):
        found.update(((n + k, j), node) for j, node in row.jacobian.items() if not node.is_zero)
    return dict(sorted(found.items()))


def order_of(equations: EquationsOfMotion, entries: Mapping[Entry, Node]) -> Elimination | None:
    return eliminate(len(equations.v), len(equations.rows), entries)


def applied_forces(equations: EquationsOfMotion) -> list[Node]:
    """r = tau - h."""
    graph = equations.graph
    return [graph.sub(tau, h) for tau, h in zip(equations.given_forces, equations.bias_forces)]


def rhs(places: Places, entries: Mapping[Entry, Node], plan: Elimination, work: bool) -> Function:
    """xdot = (qdot, a, power), lam, health."""
    equations = places.equations
    right = [*applied_forces(equations), *(row.gamma for row in equations.rows)]
    power = [equations.power] if work else []
    nodes = [*entries.values(), *right, *equations.qdot]
    return cheapest(places, nodes, lambda chosen: _rhs(places, entries, plan, chosen, power))


def _rhs(
    places: Places,
    entries: Mapping[Entry, Node],
    plan: Elimination,
    nodes: Sequence[Node],
    power: Sequence[Node],
) -> Function:
    equations, block = places.equations, Block()
    lowering, values = lower(places, block, nodes)
    matrix = dict(zip(entries, values))
    b = values[len(entries) : len(entries) + plan.size]
    qdot = values[len(entries) + plan.size :]
    if plan.size == 1:
        x, left, health = [block.div(b[0], matrix[0, 0])], block.zero, block.one
    elif plan.speeds == plan.size == 2 and len(matrix) == 3:
        (x, health), left = pair(block, matrix, b), block.zero
    else:
        factors = factor(block, plan, matrix)
        x, left, health = substitute(block, plan, factors, b), block.zero, factors.health
        if plan.multipliers:
            _, left = residual(block, plan, factors, matrix, b, x)
    a, lam = x[: plan.speeds], _signed(plan, x)[plan.speeds :]
    lowering.known.update(zip(equations.a, a))
    lowering.known.update(zip(equations.lam, lam))
    xdot = [*qdot, *a, *lowering(power)]
    _store_all(block, "xdot", xdot, [derived(name) for name in (*equations.q_names, *equations.v_names)])
    _store_all(block, "lam", lam, row_comments(equations.rows))
    _store_all(block, "health", [health, left])
    outputs = (("xdot", len(xdot)), ("lam", len(lam)), ("health", 2))
    return block.function("rhs", STATE, outputs, "right-hand side: qdot, accelerations, multipliers")


def work_size(plan: Elimination) -> int:
    """Doubles of w: the entries, L below its diagonal, 1/D."""
    return len(plan.entries) + len(plan.lower) + plan.size


def assemble(places: Places, entries: Mapping[Entry, Node], plan: Elimination) -> Function:
    def make(nodes: Sequence[Node]) -> Function:
        block = Block()
        _store_all(block, "w", lower(places, block, nodes)[1])
        return block.function("assemble", STATE, (("w", work_size(plan)),), "entries of [M G^T; G 0] into w")

    return cheapest(places, list(entries.values()), make)


def factorize(plan: Elimination) -> Function:
    """w: entries -> entries, L, 1/D."""
    block = Block()
    matrix = {at: block.load("w", k) for k, at in enumerate(plan.entries)}
    factors = factor(block, plan, matrix)
    at_lower = len(plan.entries)
    for k, entry in enumerate(plan.lower):
        block.store("w", at_lower + k, factors.lower[entry])
    for k in range(plan.size):
        block.store("w", at_lower + len(plan.lower) + k, factors.inverse[k])
    _store_all(block, "health", [factors.health, block.zero])
    outputs = (("w", work_size(plan)), ("health", 2))
    return block.function("factor", ("w",), outputs, "L D L^T of the matrix that `assemble` left in w")


def solver(plan: Elimination) -> Function:
    """M s1 - G^T s2 = r1, G s1 = r2 with the factors in w."""
    block = Block()
    right = [block.load("r", k) for k in range(plan.size)]
    x = substitute(block, plan, _kept(block, plan), right)
    _store_all(block, "s", _signed(plan, x))
    return block.function("solve", ("w", "r"), (("s", plan.size),), "M s1 - G^T s2 = r1, G s1 = r2")


def refiner(plan: Elimination) -> Function:
    """s: a solution that `solve` gave -> the same with one step of iterative refinement."""
    block = Block()
    entries = {at: block.load("w", k) for k, at in enumerate(plan.entries)}
    right = [block.load("r", k) for k in range(plan.size)]
    x = _signed(plan, [block.load("s", k) for k in range(plan.size)])
    found = refine(block, plan, _kept(block, plan), entries, right, x)
    _store_all(block, "s", _signed(plan, found))
    about = "one step of refinement of what solve gave"
    return block.function("refine", ("w", "r", "s"), (("s", plan.size),), about)


def _kept(block: Block, plan: Elimination) -> Factors:
    """The factors that `factor` left in w."""
    first = len(plan.entries)
    lower_part = {at: block.load("w", first + k) for k, at in enumerate(plan.lower)}
    inverse = {k: block.load("w", first + len(plan.lower) + k) for k in range(plan.size)}
    return Factors(lower_part, inverse, block.one)


def _signed(plan: Elimination, x: Sequence[int]) -> list[int]:
    """The multipliers for the unknowns that stand for them, or the other way round."""
    return [*x[: plan.speeds], *(~value for value in x[plan.speeds :])]


def row_comments(rows: Sequence[Row]) -> list[str]:
    """What each row is, and the source line it stands in."""
    return [f"{row.label}, {place(row.span)}" for row in rows]


def _store_all(block: Block, array: str, values: Sequence[int], comments: Sequence[str] = ()) -> None:
    for k, value in enumerate(values):
        block.store(array, k, value, comments[k] if k < len(comments) else "")
