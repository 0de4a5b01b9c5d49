"""How many relations between positions some velocity rows bring, alone or in combination.

The motions that the rows allow are spanned by vector fields X_i(q, t).  Motions along Lie brackets
[X, Y] = dY.X - dX.Y can be made of them, so the positions that can be reached have the dimension
of the smallest set of fields that holds the X_i and their brackets; each missing dimension is a
relation (theorems of Frobenius and Chow; R. Montgomery, *A Tour of Subriemannian Geometries*,
2002, ch. 2).  The two wheels of an axle roll without slip, neither row is integrable, and yet the
angle of the axle is the difference of theirs.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from lagc.expr.derivative import tangent
from lagc.expr.evaluate import evaluate
from lagc.expr.graph import Graph, Node
from lagc.mechanics.forms import Form, places
from lagc.mechanics.speeds import solve_rows

_SMALL = 1e-7  # relative; what cancels leaves about 1e-13 after some brackets
_LARGEST = 16  # positions; the brackets of more become long

Field = dict[Node, Node]


def relations(graph: Graph, forms: Sequence[Form], state: Mapping[Node, float]) -> int | None:
    """The number of relations between positions that `forms` bring, at a generic state.

    None where it is not found: too many positions, or no values at that state.
    """
    where = places(forms)
    if len(where) > _LARGEST:
        return None
    spanned = _fields(graph, forms, where, state)
    if spanned is None:
        return None
    span = _Span(where, state)
    fields = [x for x in spanned if span.grows(x)]
    latest = fields
    while latest and span.size < len(where):
        brackets = (_bracket(graph, x, y) for x in fields for y in latest)
        latest = [z for z in brackets if span.grows(z)]
    return None if span.failed else len(where) - span.size


def _fields(
    graph: Graph, forms: Sequence[Form], where: Sequence[Node], state: Mapping[Node, float]
) -> list[Field] | None:
    """A field for each position that is free, the others solved for."""
    column = {x: k for k, x in enumerate(where)}
    rows: list[dict[int, Node]] = []
    pivots: list[int] = []
    reduced: list[dict[int, float]] = []
    for form in forms:
        values = evaluate(list(form.coefficients.values()), state)
        if not all(map(math.isfinite, values)):
            return None
        row = {column[x]: value for x, value in zip(form.coefficients, values)}
        size = max(map(abs, row.values()))
        for pivot, base in zip(pivots, reduced):
            factor = row.pop(pivot, 0.0) / base[pivot]
            for j, entry in base.items():
                if j != pivot and factor:
                    row[j] = row.get(j, 0.0) - factor * entry
        best = max(row, key=lambda j: abs(row[j]), default=None)
        if best is not None and abs(row[best]) > _SMALL * size:
            rows.append({column[x]: node for x, node in form.coefficients.items()})
            pivots.append(best)
            reduced.append(row)
    found: list[Field] = []
    for k, x in enumerate(where):
        if k not in pivots:
            right = [-row.get(k, graph.zero) for row in rows]
            solved = solve_rows(graph, rows, right, pivots)
            field = {where[j]: node for j, node in solved.items() if not node.is_zero}
            found.append({**field, x: graph.one})
    return found


def _bracket(graph: Graph, x: Field, y: Field) -> Field:
    """[x, y] = dy.x - dx.y"""
    ahead = dict(zip(y, tangent(graph, list(y.values()), x)))
    back = dict(zip(x, tangent(graph, list(x.values()), y)))
    zero = graph.zero
    found = {k: ahead.get(k, zero) - back.get(k, zero) for k in {**ahead, **back}}
    return {k: node for k, node in found.items() if not node.is_zero}


class _Span:
    """The directions met so far at a state, by reduction."""

    def __init__(self, where: Sequence[Node], state: Mapping[Node, float]):
        self.where, self.state = where, state
        self.rows: list[tuple[int, list[float]]] = []
        self.failed = False

    @property
    def size(self) -> int:
        return len(self.rows)

    def grows(self, field: Field) -> bool:
        """Take the field's direction in; False where it is none that is new."""
        values = dict(zip(field, evaluate(list(field.values()), self.state)))
        row = [values.get(x, 0.0) for x in self.where]
        size = max(map(abs, row), default=0.0)
        if not math.isfinite(size):
            self.failed = True
            return False
        for pivot, base in self.rows:
            factor = row[pivot] / base[pivot]
            row = [x - factor * y for x, y in zip(row, base)]
            row[pivot] = 0.0
        best = max(range(len(row)), key=lambda j: abs(row[j]), default=0)
        if not row or abs(row[best]) <= _SMALL * max(1.0, size):
            return False
        self.rows.append((best, row))
        return True
