"""Vectors in the axes of frames, and their lengths.

A vector that is a sum of a frame's unit vectors with constant factors is recognized: these factors are its
components in the frame, and give its length, whatever the rotation.
"""

from collections.abc import Container, Sequence
from typing import TypeAlias

from lagc.diagnostics.faults import Span, Wrong
from lagc.semantics.context import LATE, MOVING, Context
from lagc.semantics.model import Frame
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import Matrix, Vector, matvec, norm, transpose

_MOST = 300  # limit on the parts of a vector
_ABOVE = 6  # limit on frames

_ROUNDING = 2.0**-48  # relative round-off

Terms: TypeAlias = dict[Node, Node]  # moving term -> constant factor
Row: TypeAlias = tuple[list[float], Node]  # coefficients and right-hand side


def is_constant(context: Context, nodes: Sequence[Node]) -> bool:
    """Return whether all nodes keep their values in every motion."""
    return not any([context.clock.mask(node) & (MOVING | LATE) for node in nodes])


def length_of(context: Context, vector: Vector) -> Node:
    if not is_constant(context, vector):
        for axes in _near(context, vector):
            own = _factors(context, axes, vector)
            if own is not None:
                return norm(own)
    return norm(vector)


def unit_vector(context: Context, vector: Vector, span: Span) -> Vector:
    """Return `vector` over its length.  Raises Wrong if the length is zero."""
    length = length_of(context, vector)
    if length.is_zero:
        raise Wrong("LAG0309", "the zero vector has no direction", span)
    return (vector[0] / length, vector[1] / length, vector[2] / length)


def in_frame(context: Context, frame: Frame, vector: Vector) -> Vector:
    """Return a world vector in the axes of a frame."""
    found = known_in_frame(context, frame, vector)
    if found is None:
        return matvec(transpose(frame.axes), vector)
    return found


def known_in_frame(context: Context, frame: Frame, vector: Vector) -> Vector | None:
    """Return the components if they follow from constant factors in the frame or a parent frame, else
    None."""
    turns: list[Matrix] = []
    axes = frame.axes
    above = 0 if is_constant(context, vector) else _ABOVE
    own = _standing(context, axes, vector)
    while own is None:
        if len(turns) == above or axes not in context.turns:
            return None
        axes, turn = context.turns[axes]
        turns.append(turn)
        own = _standing(context, axes, vector)
    for turn in reversed(turns):
        own = matvec(transpose(turn), own)
    context.components[frame.axes, vector] = own
    return own


def direction(context: Context, frame: Frame, vector: Vector, span: Span) -> tuple[Vector, Vector]:
    """Return the unit vector of `vector` in world axes and in the axes of `frame`.  Raises Wrong if it is
    zero."""
    unit = unit_vector(context, vector, span)
    own = None if is_constant(context, vector) else known_in_frame(context, frame, vector)
    if own is None:
        return unit, in_frame(context, frame, unit)
    if all([x.is_const for x in own]):
        largest = max([abs(x.value) for x in own])
        x, y, z = (_as_written(x.value / largest) if largest else 0.0 for x in own)
        graph = own[0].graph
        own = (graph.const(x), graph.const(y), graph.const(z))
    length = length_of(context, own if is_constant(context, own) else vector)
    own = (own[0] / length, own[1] / length, own[2] / length)
    context.components[frame.axes, unit] = own
    return unit, own


def _as_written(value: float) -> float:
    """Return the short decimal number that equals `value` up to round-off, or `value`."""
    short = float(f"{value:.12g}")
    return short if abs(short - value) <= _ROUNDING * abs(value) else value


def _standing(context: Context, axes: Matrix, vector: Vector) -> Vector | None:
    return context.components.get((axes, vector)) or _factors(context, axes, vector)


def _near(context: Context, vector: Vector) -> list[Matrix]:
    """Return the axes of frames whose components occur in `vector`, the latest first."""
    found: dict[Matrix, int] = {}
    stack, left = list(vector), _MOST
    while stack and left:
        left -= 1
        node = stack.pop()
        axes = context.clock.axes.get(node)
        if axes is not None:
            found[axes] = max(node.index, found.get(axes, 0))
        if node.op in ("add", "scale", "mul"):
            stack.extend(node.args)
    return sorted(found, key=found.__getitem__, reverse=True)[:_ABOVE]


def _factors(context: Context, axes: Matrix, vector: Vector) -> Vector | None:
    """Return the constant factors of the unit vectors (columns of `axes`) that add up to `vector`, or
    None."""
    columns = transpose(axes)
    one, zero = vector[0].graph.one, vector[0].graph.zero
    units: tuple[Vector, ...] = ((one, zero, zero), (zero, one, zero), (zero, zero, one))
    for column, unit in zip(columns, units):
        if vector == column:
            return unit
    if is_constant(context, columns[0] + columns[1] + columns[2]):
        return None
    whole = {
        x.args[0] if x.op == "scale" else x for row in axes for x in row if not is_constant(context, [x])
    }
    return _sought(context, axes, vector, whole) or _sought(context, axes, vector, ())


def _sought(context: Context, axes: Matrix, vector: Vector, whole: Container[Node]) -> Vector | None:
    """Return these factors; sums in `whole` are not split, so that their factors have no round-off."""
    left, zero = _MOST, vector[0].graph.zero
    rows: list[Row] = []
    for k in range(3):
        tables: list[Terms] = []
        for node in (*axes[k], vector[k]):
            terms, left = _moving_terms(context, node, whole, left)
            if left < 0:
                return None
            tables.append(terms)
        for base in dict.fromkeys(base for terms in tables for base in terms):
            *coefficients, right = (terms.get(base, zero) for terms in tables)
            if not all([c.is_const for c in coefficients]):
                return None
            rows.append(([c.value for c in coefficients], right))
    return _solve(rows)


def _moving_terms(context: Context, node: Node, whole: Container[Node], most: int) -> tuple[Terms, int]:
    """Return the terms of a sum, and the number of parts left of `most` (negative if exceeded)."""
    graph, terms = node.graph, Terms()
    stack = [(node, graph.one)]
    # A sum of products: the constant factors of each part are gathered apart from what moves.
    while stack and most >= 0:
        most -= 1
        part, factor = stack.pop()
        if is_constant(context, [part]):
            part, factor = graph.one, factor * part
        elif part in whole:
            pass
        elif part.op == "add":
            stack += [(a, factor) for a in part.args]
            continue
        elif part.op == "scale":
            stack.append((part.args[0], factor * part.value))
            continue
        elif part.op == "mul":
            pairs = list(zip(part.args, part.value))
            moving = [(base, e) for base, e in pairs if not is_constant(context, [base])]
            if len(moving) < len(pairs):
                factor = factor * graph.product([pair for pair in pairs if pair not in moving])
                stack.append((graph.product(moving), factor))
                continue
        terms[part] = terms.get(part, graph.zero) + factor
    return terms, most


def _solve(rows: list[Row]) -> Vector | None:
    """Return the x that solves `coefficients` x = right in all `rows`, by Gauss-Jordan elimination."""
    done: list[Row] = []
    for k in range(3):
        best = max(rows, key=lambda row: abs(row[0][k]), default=None)
        if best is None or best[0][k] == 0.0:
            return None
        rows = [row for row in rows if row is not best]
        pivot = best[0][k]
        first = [n / pivot for n in best[0]], best[1] / best[1].graph.const(pivot)
        done = [*(_without(row, k, first) for row in done), first]
        rows = [_without(row, k, first) for row in rows]
    if not all([right.is_zero for _, right in rows]):
        return None
    return (done[0][1], done[1][1], done[2][1])


def _without(row: Row, k: int, first: Row) -> Row:
    """Return `row` minus a multiple of `first`, so that its entry k is zero."""
    c = row[0][k]
    if c == 0.0:
        return row
    numbers = [_difference(a, c * b) for a, b in zip(row[0], first[0])]
    right, other = row[1], first[1] * c
    if right.is_const and other.is_const:
        return numbers, right.graph.const(_difference(right.value, other.value))
    return numbers, right - other


def _difference(a: float, b: float) -> float:
    """Return a - b, or zero if the difference is round-off."""
    return 0.0 if abs(a - b) <= _ROUNDING * abs(a) else a - b
