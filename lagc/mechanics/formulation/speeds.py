"""The choice of speeds: rates as functions of declared generalized speeds.

A declared speed u_k = A_k(t,q) . rates + b_k(t,q) replaces one rate; the other rates stay speeds. The choice
keeps the system solvable on a few states, and sparse. Small systems are solved by Cramer's rule (a rotated
pair of rates has the determinant cos^2 + sin^2 = 1 and needs no division), others by elimination.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from lagc.base.records import dataclass
from lagc.diagnostics.faults import Fault, Refused
from lagc.mechanics.numeric.samples import samples
from lagc.semantics.model import Model, Speed
from lagc.symbolic.derivative import gradient
from lagc.symbolic.evaluate import evaluate
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.walk import depends, substitute

_LARGEST_CRAMER = 4
_SMALL = 1e-9  # relative; a pivot that cancels is about 1e-16, one that does not about 1


@dataclass(frozen=True, slots=True)
class ChosenSpeeds:
    """`replaces[i]`: the declared speed in the place of rate i; `solved`: rate -> expression in v."""

    replaces: dict[int, Speed]
    solved: dict[Node, Node]


def choose_speeds(model: Model, rates: Sequence[Node]) -> ChosenSpeeds:
    """Solve the declared speeds for as many rates. Raises Refused: LAG0401 not affine in the rates, LAG0402
    dependent on each other, LAG0403 more speeds than rates."""
    declared = model.speeds
    if not declared:
        return ChosenSpeeds({}, {})
    graph = model.graph
    if len(declared) > len(rates):
        raise Refused([_too_many(declared, len(rates))])
    table = [gradient(graph, {s.expression: graph.one}, rates) for s in declared]
    rows = [{i: row[rate] for i, rate in enumerate(rates) if rate in row} for row in table]
    faults = [
        _not_affine(speed)
        for speed, row in zip(declared, rows)
        if depends(row.values(), [*rates, *(s.symbol for s in declared)])
    ]
    if faults:
        raise Refused(faults)
    at_rest = dict.fromkeys(rates, graph.zero)
    offsets = substitute(graph, [s.expression for s in declared], at_rest)
    pivots = _pivots(model, rows)
    held = set(pivots)
    right: list[Node] = []
    for speed, row, offset in zip(declared, rows, offsets):
        rest = graph.sum(node * rates[i] for i, node in row.items() if i not in held)
        right.append(speed.symbol - offset - rest)
    solution = solve_rows(graph, rows, right, pivots)
    return ChosenSpeeds(
        {i: declared[k] for k, i in enumerate(pivots)}, {rates[i]: solution[i] for i in pivots}
    )


def _pivots(model: Model, rows: Sequence[Mapping[int, Node]]) -> list[int]:
    """The rate that each speed replaces: independent on every sampled state, simplest first."""
    flat = [node for row in rows for node in row.values()]
    tables: list[list[dict[int, float]]] = []
    for sample in samples(model, 4):
        values = iter(evaluate(flat, sample))
        tables.append([{i: next(values) for i in row} for row in rows])
    users = {i: sum(i in row for row in rows) for row in rows for i in row}
    pivots: list[int] = []
    for k, row in enumerate(rows):
        candidates = [
            i
            for i in set().union(*(table[k] for table in tables))
            if i not in pivots and all(_is_pivot(table[k], i) for table in tables)
        ]
        if not candidates:
            raise Refused([_dependent(model.speeds[k], model.speeds[:k])])
        best = min(candidates, key=lambda i: (not _constant(row.get(i)), users.get(i, 0), i))
        pivots.append(best)
        for table in tables:
            _eliminate(table, k, best)
    return pivots


def _is_pivot(row: Mapping[int, float], i: int) -> bool:
    largest = max((abs(x) for x in row.values()), default=0.0)
    return i in row and abs(row[i]) > _SMALL * largest and abs(row[i]) > 0.0


def _constant(node: Node | None) -> bool:
    return node is not None and node.is_const


def _eliminate(table: list[dict[int, float]], k: int, pivot: int) -> None:
    for row in table[k + 1 :]:
        if pivot in row:
            size = max(abs(x) for x in row.values())
            factor = row[pivot] / table[k][pivot]
            for i, x in table[k].items():
                row[i] = row.get(i, 0.0) - factor * x
            for i in [i for i, x in row.items() if i == pivot or abs(x) <= _SMALL * size]:
                del row[i]


def solve_rows(
    graph: Graph, rows: Sequence[Mapping[int, Node]], right: Sequence[Node], pivots: Sequence[int]
) -> dict[int, Node]:
    """Solve rows x = right for the unknowns `pivots` (row k for pivots[k] after the rows before), ignoring
    other entries, block by block of rows that share none."""
    solution: dict[int, Node] = {}
    for block in _blocks(rows, pivots):
        columns = [pivots[k] for k in block]
        matrix = [[rows[k].get(i, graph.zero) for i in columns] for k in block]
        wanted = [right[k] for k in block]
        method = _cramer if len(block) <= _LARGEST_CRAMER else _gauss
        solution.update(zip(columns, method(graph, matrix, wanted)))
    return solution


def _blocks(rows: Sequence[Mapping[int, Node]], pivots: Sequence[int]) -> list[list[int]]:
    owner = {i: k for k, i in enumerate(pivots)}
    group = list(range(len(rows)))
    for k, row in enumerate(rows):
        for i in row:
            if i in owner and group[owner[i]] != group[k]:
                old, new = group[owner[i]], group[k]
                group = [new if g == old else g for g in group]
    return [[k for k in range(len(rows)) if group[k] == g] for g in sorted(set(group))]


def _cramer(graph: Graph, matrix: list[list[Node]], right: list[Node]) -> list[Node]:
    size = len(right)
    whole = determinant(graph, matrix)
    found: list[Node] = []
    for j in range(size):
        cofactors = [
            graph.scale((-1.0) ** (i + j), determinant(graph, _minor(matrix, i, j))) for i in range(size)
        ]
        found.append(graph.sum(graph.div(c, whole) * r for c, r in zip(cofactors, right)))
    return found


def determinant(graph: Graph, matrix: list[list[Node]]) -> Node:
    """By expansion along the first row; for sizes up to 4."""
    if not matrix:
        return graph.one
    return graph.sum(
        graph.scale((-1.0) ** j, x * determinant(graph, _minor(matrix, 0, j)))
        for j, x in enumerate(matrix[0])
        if not x.is_zero
    )


def _minor(matrix: list[list[Node]], i: int, j: int) -> list[list[Node]]:
    return [row[:j] + row[j + 1 :] for k, row in enumerate(matrix) if k != i]


def _gauss(graph: Graph, matrix: list[list[Node]], right: list[Node]) -> list[Node]:
    """Elimination along the diagonal, which `_pivots` has found to be free of zeros."""
    size = len(right)
    for k in range(size):
        for i in range(k + 1, size):
            if not matrix[i][k].is_zero:
                factor = matrix[i][k] / matrix[k][k]
                matrix[i] = [x - factor * y for x, y in zip(matrix[i], matrix[k])]
                right[i] = right[i] - factor * right[k]
    found = [graph.zero] * size
    for k in reversed(range(size)):
        known = graph.sum(matrix[k][j] * found[j] for j in range(k + 1, size))
        found[k] = (right[k] - known) / matrix[k][k]
    return found


def _names(speeds: Iterable[Speed]) -> str:
    return ", ".join(f"`{s.name}`" for s in speeds)


def _too_many(declared: Sequence[Speed], count: int) -> Fault:
    rates = f"{count} rate{'' if count == 1 else 's'}"
    return Fault(
        "LAG0403",
        f"{len(declared)} speeds are declared, but the coordinates have only {rates}",
        declared[count].span,
        remedy=f"remove {len(declared) - count} of {_names(declared)}",
    )


def _not_affine(speed: Speed) -> Fault:
    return Fault(
        "LAG0401",
        f"the speed `{speed.name}` is not linear in the rates of the coordinates",
        speed.span,
        remedy="write it as a sum of rates, each multiplied by something free of rates and speeds",
    )


def _dependent(speed: Speed, before: Sequence[Speed]) -> Fault:
    reason = f"follows from {_names(before)}" if before else "depends on no rate of a coordinate"
    return Fault(
        "LAG0402",
        f"the speed `{speed.name}` {reason}, so the rates cannot be found from the speeds",
        speed.span,
        tuple((s.span, "this speed") for s in before),
        remedy=f"remove `{speed.name}` or make it another combination of the rates",
    )
