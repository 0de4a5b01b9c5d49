"""Which motions some velocity rows leave in the long run, brackets included.

The motions that the rows allow are spanned by vector fields X_i(q, t).  Motions along Lie brackets
[X, Y] = dY.X - dX.Y can be made of them, so the positions that can be reached have the dimension
of the smallest set of fields that holds the X_i and their brackets; each missing dimension is a
relation (theorems of Frobenius and Chow; R. Montgomery, *A Tour of Subriemannian Geometries*,
2002, ch. 2).  The two wheels of an axle roll without slip, neither row is integrable, and yet the
angle of the axle is the difference of theirs.
"""

from __future__ import annotations

from collections.abc import Sequence

from lagc.mechanics.analysis.pfaffian_forms import Form
from lagc.mechanics.formulation.speeds import solve_rows
from lagc.mechanics.identities.zero_test import Truths
from lagc.mechanics.numeric.finite_field_linear import Echelon, Entries
from lagc.symbolic.derivative import tangent
from lagc.symbolic.finite_field import Point
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.walk import reachable

LARGEST = 16  # positions; the brackets of more become long
LONGEST = 10_000  # nodes of fields whose brackets are formed

Field = dict[Node, Node]


class TooLong(Exception):
    """Brackets are too long to be formed."""


def reachable_directions(
    graph: Graph, forms: Sequence[Form], where: Sequence[Node], point: Point, truths: Truths
) -> list[Entries]:
    """A basis, at `point`, of the directions of all motions that the forms leave: by place in `where`.

    Raises Undefined where something has no value at this point, TooLong where fields or brackets on the way
    are.
    """
    span = _Span(where, point, truths)
    fields = [x for x in _fields(graph, forms, where, point, truths) if span.grows(x)]
    latest = fields
    while latest and span.size < len(where):
        if len(reachable([node for x in latest for node in x.values()])) > LONGEST:
            raise TooLong
        brackets = (_bracket(graph, x, y) for x in fields for y in latest)
        latest = [z for z in brackets if span.grows(z)]
    return span.directions


def _fields(
    graph: Graph, forms: Sequence[Form], where: Sequence[Node], point: Point, truths: Truths
) -> list[Field]:
    """A field for each position that is free, the others solved for."""
    column = {x: k for k, x in enumerate(where)}
    rows: list[dict[int, Node]] = []
    reduced = Echelon()
    for form in forms:
        values = point.values(list(form.coefficients.values()), truths)
        if reduced.grows({column[x]: value for x, value in zip(form.coefficients, values)}):
            rows.append({column[x]: node for x, node in form.coefficients.items()})
    pivots = list(reduced.rows)
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
    """The directions met so far at a point."""

    def __init__(self, where: Sequence[Node], point: Point, truths: Truths):
        self._column = {x: k for k, x in enumerate(where)}
        self._point, self._truths = point, truths
        self._rows = Echelon()
        self.directions: list[Entries] = []

    @property
    def size(self) -> int:
        return len(self.directions)

    def grows(self, field: Field) -> bool:
        """Take the field's direction in; False where it is none that is new."""
        values = self._point.values(list(field.values()), self._truths)
        row = {self._column[x]: value for x, value in zip(field, values)}
        if not self._rows.grows(row):
            return False
        self.directions.append(row)
        return True
