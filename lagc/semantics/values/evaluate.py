"""Expressions of the model language to values; how, `expressions` says of each kind."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterable
from typing import Any, TypeVar

from lagc.diagnostics.faults import Span
from lagc.semantics.context import Context
from lagc.semantics.names.scope import Array, Environment, Scalar, Value, kind
from lagc.semantics.refusals import Poisoned, Wrong
from lagc.semantics.units import NONE, Dimension
from lagc.semantics.values.unit_hints import is_bare
from lagc.syntax import tree

T = TypeVar("T")
Item = TypeVar("Item")

LONGEST_RANGE = 100_000
BEYOND = 2**53  # a double that is this may have been written as another integer


def evaluate(context: Context, expression: tree.Expression, environment: Environment) -> Value:
    """The value of an expression.  Raises Wrong, or Poisoned where a fault has been reported."""
    return context.evaluators[type(expression)](context, expression, environment)


def evaluate_as(
    context: Context, expression: tree.Expression, environment: Environment, dimension: Dimension
) -> Value:
    """The value of a declaration or an argument of the given dimension: bare numbers are in its
    SI unit.  The dimension of anything else is left to the caller to check."""
    value = evaluate(context, expression, environment)
    return value if dimension == NONE else _dressed(value, dimension, is_bare(expression))


def _dressed(value: Value, dimension: Dimension, bare: bool) -> Value:
    if isinstance(value, Array):
        elements = [_dressed(e, dimension, bare) for e in value.elements]
        return value if all(map(operator.is_, elements, value.elements)) else Array(tuple(elements))
    if isinstance(value, Scalar) and value.dimension == NONE and (bare or value.bare):
        return Scalar(value.node, dimension)
    return value


def integer(context: Context, expression: tree.Expression, environment: Environment, what: str) -> int:
    """The value of an expression that is a structural integer.  Raises Wrong."""
    value = evaluate(context, expression, environment)
    if not isinstance(value, Scalar):
        raise Wrong("LAG0208", f"{what} must be an integer; this is {kind(value)}", expression.span)
    number = value.node.value
    if not value.node.is_const or not isinstance(number, float):
        raise Wrong(
            "LAG0208",
            f"{what} must be known when the model is compiled; this is not",
            expression.span,
            remedy="use integers, loop variables and `structural Integer` parameters",
        )
    if value.dimension not in (None, NONE):
        raise Wrong("LAG0208", f"{what} must be an integer; this is not", expression.span)
    return whole(number, expression.span, what)


def whole(number: float, span: Span, what: str) -> int:
    """Raises Wrong where the number is no integer, or may stand for another one than was written."""
    if number != math.floor(number):
        raise Wrong("LAG0208", f"{what} must be an integer; this is not", span)
    if abs(number) >= BEYOND:
        message = f"{what} must be an integer below 2^53 = {BEYOND}; larger ones are not exact"
        raise Wrong("LAG0208", message, span)
    return int(number)


def integers(context: Context, expression: tree.Expression, environment: Environment) -> list[int]:
    """The values of a loop's range `1:n`, `1:2:n`.  Raises Wrong."""
    if not isinstance(expression, tree.Range):
        raise Wrong("LAG0208", "a loop needs a range, such as `1:n`", expression.span)
    first = integer(context, expression.start, environment, "the start of a range")
    last = integer(context, expression.stop, environment, "the end of a range")
    step = (
        1
        if expression.step is None
        else integer(context, expression.step, environment, "the step of a range")
    )
    if step == 0:
        span = expression.step.span if expression.step else expression.span
        raise Wrong("LAG0208", "the step of a range must not be 0", span)
    found = range(first, last + (1 if step > 0 else -1), step)
    if (last - first) // step >= LONGEST_RANGE:
        raise Wrong("LAG0218", f"the range has more than {LONGEST_RANGE} values", expression.span)
    return list(found)


def each(context: Context, find_one: Callable[[Item], T], items: Iterable[Item]) -> list[T]:
    """`find_one` of all items; where any is at fault, the faults of all are reported first."""
    found: list[T] = []
    failed = False
    for item in items:
        try:
            found.append(find_one(item))
        except Wrong as wrong:
            context.report(wrong)
            failed = True
        except Poisoned:
            failed = True
    if failed:
        raise Poisoned
    return found


def both(context: Context, one: Callable[[], T], other: Callable[[], Item]) -> tuple[T, Item]:
    """What two jobs find; where any is at fault, the faults of both are reported first."""
    jobs: tuple[Callable[[], Any], ...] = one, other
    first, second = each(context, lambda job: job(), jobs)
    return first, second


def all_values(
    context: Context, expressions: Iterable[tree.Expression], environment: Environment
) -> list[Value]:
    """The values of all expressions, with the faults of all."""
    return each(context, lambda e: evaluate(context, e, environment), expressions)
