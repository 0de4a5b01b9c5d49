"""Operators on values, with the dimensions of their results."""

from __future__ import annotations

import math
from collections.abc import Callable

from lagc.diagnostics.faults import Span
from lagc.semantics.context import Context
from lagc.semantics.model import Body
from lagc.semantics.names.scope import Array, Scalar, Truth, Value, kind, shape
from lagc.semantics.refusals import Wrong
from lagc.semantics.units import NONE, Dimension, describe, over, raised, times
from lagc.semantics.values.unit_hints import unit_remedy
from lagc.symbolic.graph import Node
from lagc.syntax import tree

LARGEST_EXPONENT = 1000  # of a quantity with a dimension

_COMPARISONS = {
    "<": ("lt", False),
    "<=": ("le", False),
    ">": ("lt", True),
    ">=": ("le", True),
    "==": ("eq", False),
    "<>": ("eq", False),
}


def binary(context: Context, e: tree.Binary, left: Value, right: Value) -> Value:
    """Return `left op right`.  Raises Wrong."""
    if e.op in ("and", "or"):
        return _connective(context, e, left, right)
    for value, side in ((left, e.left), (right, e.right)):
        if not isinstance(value, Scalar | Array):
            remedy = "write `position(...)` for its position" if isinstance(value, Body) else None
            raise Wrong(
                "LAG0307", f"`{e.op}` takes numbers and vectors; this is {kind(value)}", side.span, remedy
            )
    try:
        if e.op in _COMPARISONS:
            return _comparison(context, e, left, right)
        value = _ARITHMETIC[e.op](e, left, right)
    except (ZeroDivisionError, OverflowError):
        raise Wrong("LAG0309", _no_value(e), e.span) from None
    return _finite(value, e)


def negative(value: Value, span: Span) -> Value:
    if isinstance(value, Scalar):
        return Scalar(-value.node, value.dimension)
    if isinstance(value, Array):
        return Array(tuple([negative(x, span) for x in value.elements]))
    raise Wrong("LAG0307", f"`-` takes a number or a vector; this is {kind(value)}", span)


def select(context: Context, condition: Node, first: tuple[Value, Span], second: tuple[Value, Span]) -> Value:
    """Return `first` if the condition holds, else `second`; both have the same shape and dimension."""
    (a, a_span), (b, b_span) = first, second
    if isinstance(a, Truth) and isinstance(b, Truth):
        return Truth(context.graph.select(condition, a.node, b.node))

    def one(x: Scalar, y: Scalar) -> Scalar:
        return Scalar(
            context.graph.select(condition, x.node, y.node),
            _same(x, y, "the branches", b_span, a_span, b_span),
        )

    if not isinstance(a, Scalar | Array) or not isinstance(b, Scalar | Array):
        wrong, span = (a, a_span) if not isinstance(a, Scalar | Array) else (b, b_span)
        raise Wrong("LAG0307", f"the branches of `if` are numbers or vectors; this is {kind(wrong)}", span)
    return _elementwise(a, b, one, "the branches of `if`", b_span)


def _elementwise(a: Value, b: Value, one: Callable[[Scalar, Scalar], Scalar], what: str, span: Span) -> Value:
    if isinstance(a, Scalar) and isinstance(b, Scalar):
        return one(a, b)
    if isinstance(a, Array) and isinstance(b, Array) and len(a.elements) == len(b.elements):
        return Array(tuple([_elementwise(x, y, one, what, span) for x, y in zip(a.elements, b.elements)]))
    raise Wrong("LAG0306", f"{what} have different shapes: {_shape(a)} and {_shape(b)}", span)


def _shape(value: Value) -> str:
    sizes = shape(value)
    return f"an array of {' x '.join(str(n) for n in sizes)}" if sizes else "a number"


def _same(
    a: Scalar, b: Scalar, what: str, span: Span, a_span: Span, b_span: Span, remedy: str | None = None
) -> Dimension | None:
    if a.dimension is None:
        return b.dimension
    if b.dimension is None or a.dimension == b.dimension:
        return a.dimension
    message = f"{what} have different dimensions: {describe(a.dimension)} and {describe(b.dimension)}"
    raise Wrong(
        "LAG0301", message, span, remedy, ((a_span, describe(a.dimension)), (b_span, describe(b.dimension)))
    )


def _sides(e: tree.Binary, a: Scalar, b: Scalar, what: str) -> Dimension | None:
    """Return the common dimension of both sides of an operator.  Raises Wrong."""
    remedy = unit_remedy(e.left, b.dimension) or unit_remedy(e.right, a.dimension)
    return _same(a, b, what, e.op_span, e.left.span, e.right.span, remedy)


def _sum(e: tree.Binary, left: Value, right: Value) -> Value:
    what = "the two sides of `+`" if e.op == "+" else "the two sides of `-`"

    def one(a: Scalar, b: Scalar) -> Scalar:
        dimension = a.dimension if a.dimension == b.dimension else _sides(e, a, b, what)
        return Scalar(a.node + b.node if e.op == "+" else a.node - b.node, dimension)

    return _elementwise(left, right, one, what, e.op_span)


def _times(a: Scalar, b: Scalar) -> Scalar:
    if a.dimension is None or b.dimension is None:
        return Scalar(a.node * b.node, None)
    return Scalar(a.node * b.node, times(a.dimension, b.dimension))


def _over(a: Scalar, b: Scalar) -> Scalar:
    if b.node.is_zero:
        raise ZeroDivisionError
    return Scalar(a.node / b.node, None if a.dimension is None else over(a.dimension, b.dimension or NONE))


def _product(e: tree.Binary, left: Value, right: Value) -> Value:
    if isinstance(left, Scalar) and isinstance(right, Scalar):
        return _times(left, right)
    if isinstance(left, Scalar) and isinstance(right, Array):
        return Array(tuple([_product(e, left, x) for x in right.elements]))
    if isinstance(left, Array) and isinstance(right, Scalar):
        return Array(tuple([_product(e, x, right) for x in left.elements]))
    if isinstance(left, Array) and isinstance(right, Array) and _is_matrix(left):
        return Array(tuple([_row_times(e, row, right) for row in left.elements]))
    raise Wrong("LAG0306", "`*` does not multiply two vectors; write `dot(a, b)` or `cross(a, b)`", e.span)


def _is_matrix(value: Array) -> bool:
    return bool(value.elements) and isinstance(value.elements[0], Array)


def _row_times(e: tree.Binary, row: Value, right: Array) -> Value:
    if not isinstance(row, Array) or len(row.elements) != len(right.elements):
        message = "the number of columns of the matrix differs from the number of elements of the vector"
        raise Wrong("LAG0306", message, e.span)
    total: Value | None = None
    plus = tree.Binary("+", e.left, e.right, e.op_span, e.span)
    for x, y in zip(row.elements, right.elements):
        term = _product(e, x, y)
        total = term if total is None else _sum(plus, total, term)
    if total is None:
        raise Wrong("LAG0306", "an empty matrix has no product", e.span)
    return total


def _quotient(e: tree.Binary, left: Value, right: Value) -> Value:
    if not isinstance(right, Scalar):
        raise Wrong("LAG0306", "only a number can be a divisor", e.right.span)
    if isinstance(left, Array):
        return Array(tuple([_quotient(e, x, right) for x in left.elements]))
    assert isinstance(left, Scalar)
    return _over(left, right)


def _power(e: tree.Binary, left: Value, right: Value) -> Value:
    if not isinstance(left, Scalar) or not isinstance(right, Scalar):
        raise Wrong(
            "LAG0306",
            "`^` takes numbers",
            e.span,
            "write the square of a vector as `dot(a, a)` or `norm(a)^2`",
        )
    if right.dimension not in (None, NONE):
        message = f"an exponent must be a pure number; this is {describe(right.dimension)}"
        raise Wrong("LAG0305", message, e.right.span)
    dimension: Dimension | None = NONE
    if left.dimension not in (None, NONE):
        number = right.node.value
        if not right.node.is_const or not isinstance(number, float):
            raise Wrong(
                "LAG0305", f"the exponent of {describe(left.dimension)} must be a fixed number", e.right.span
            )
        dimension = raised(left.dimension, number) if abs(number) <= LARGEST_EXPONENT else None
        if dimension is None:
            raise Wrong("LAG0305", f"{describe(left.dimension)} has no power {number:g}", e.right.span)
    power = left.node**right.node
    return Scalar(power, None if left.dimension is None and power.is_zero else dimension)


_ARITHMETIC: dict[str, Callable[[tree.Binary, Value, Value], Value]] = {
    "+": _sum, "-": _sum, "*": _product, "/": _quotient, "^": _power,
}  # fmt: skip


def _comparison(context: Context, e: tree.Binary, left: Value, right: Value) -> Value:
    if not isinstance(left, Scalar) or not isinstance(right, Scalar):
        raise Wrong("LAG0306", f"`{e.op}` compares numbers", e.span)
    _sides(e, left, right, f"the two sides of `{e.op}`")
    op, swapped = _COMPARISONS[e.op]
    a, b = (right.node, left.node) if swapped else (left.node, right.node)
    node = context.graph.binary(op, a, b)
    return Truth(context.graph.logical_not(node) if e.op == "<>" else node)


def _connective(context: Context, e: tree.Binary, left: Value, right: Value) -> Value:
    for value, side in ((left, e.left), (right, e.right)):
        if not isinstance(value, Truth):
            raise Wrong("LAG0307", f"`{e.op}` takes conditions; this is {kind(value)}", side.span)
    assert isinstance(left, Truth) and isinstance(right, Truth)
    return Truth(context.graph.binary(e.op, left.node, right.node))


def _finite(value: Value, e: tree.Binary) -> Value:
    """Return `value`.  Raises Wrong if a constant part of it is not finite."""
    stack = [value]
    while stack:
        top = stack.pop()
        if isinstance(top, Array):
            stack.extend(top.elements)
        elif isinstance(top, Scalar) and top.node.op in ("const", "scale"):
            if not math.isfinite(top.node.value):
                raise Wrong("LAG0309", _no_value(e), e.span)
        elif (
            isinstance(top, Scalar)
            and e.op == "^"
            and all(a.is_const for a in top.node.args)
            and top.node.args
        ):
            raise Wrong("LAG0309", _no_value(e), e.span)
    return value


def _no_value(e: tree.Binary) -> str:
    if e.op == "/":
        return "this divides by zero"
    return f"the result of `{e.op}` is not finite"
