"""Evaluation of expressions of the model language; `expressions` implements each kind."""

import math
import operator
from collections.abc import Callable, Iterable
from typing import Any, TypeVar

from lagc.base.records import dataclass
from lagc.diagnostics.faults import Poisoned, Span, Wrong
from lagc.semantics.context import Context
from lagc.semantics.names.scope import Array, Environment, Scalar, Value, kind
from lagc.semantics.units import NONE, Dimension
from lagc.semantics.values.unit_hints import is_bare
from lagc.syntax import tree

T = TypeVar("T")
Item = TypeVar("Item")

LONGEST_RANGE = 100_000
BEYOND = 2**53  # from here on a double may stand for several integers


@dataclass(frozen=True, slots=True)
class Argument:
    """An argument of a call; `bare`: it consists of numbers without units."""

    value: Value
    span: Span
    bare: bool = False


def evaluate(context: Context, expression: tree.Expression, environment: Environment) -> Value:
    """Return the value of an expression.  Raises Wrong, or Poisoned if its fault is already reported."""
    return context.evaluators[type(expression)](context, expression, environment)


def evaluate_as(
    context: Context, expression: tree.Expression, environment: Environment, dimension: Dimension
) -> Value:
    """Return the value for a declaration or argument of this dimension; numbers without a unit are in SI. The
    caller checks the dimension of other values."""
    if isinstance(expression, tree.Quantity):
        return context.evaluators[tree.Quantity](context, expression, environment, dimension)
    value = evaluate(context, expression, environment)
    return value if dimension == NONE else _with_dimension(value, dimension, is_bare(expression))


def _with_dimension(value: Value, dimension: Dimension, bare: bool) -> Value:
    if isinstance(value, Array):
        elements = [_with_dimension(e, dimension, bare) for e in value.elements]
        return value if all(map(operator.is_, elements, value.elements)) else Array(tuple(elements))
    if isinstance(value, Scalar) and value.dimension == NONE and (bare or value.bare):
        return Scalar(value.node, dimension)
    return value


def integer(context: Context, expression: tree.Expression, environment: Environment, what: str) -> int:
    """Return the value of a structural integer.  Raises Wrong."""
    value = evaluate(context, expression, environment)
    if not isinstance(value, Scalar):
        raise Wrong("LAG0208", f"{what} must be an integer; this is {kind(value)}", expression.span)
    number = value.node.value
    if not value.node.is_const or not isinstance(number, float):
        message = f"{what} must be known when the model is compiled; this is not"
        remedy = "use integers, loop variables and `structural Integer` parameters"
        raise Wrong("LAG0208", message, expression.span, remedy)
    if value.dimension not in (None, NONE):
        raise Wrong("LAG0208", f"{what} must be an integer; this is not", expression.span)
    return whole(number, expression.span, what)


def whole(number: float, span: Span, what: str) -> int:
    """Return `number` as an integer.  Raises Wrong if it is not one, or is too large to be exact."""
    if number != math.floor(number):
        raise Wrong("LAG0208", f"{what} must be an integer; this is not", span)
    if abs(number) >= BEYOND:
        message = f"{what} must be an integer below 2^53 = {BEYOND}; larger ones are not exact"
        raise Wrong("LAG0208", message, span)
    return int(number)


def _range(expression: tree.Expression) -> str | None:
    """Return a remedy for `1..n` and `range(n)`."""
    first, dots, last = expression.span.text.partition("..")
    if dots:
        return f"write `{first}:{last}`"
    if isinstance(expression, tree.Call) and expression.function.span.text == "range":
        given = [argument.span.text for argument in expression.arguments]
        if 1 <= len(given) <= 2:
            last = given[0] if len(given) == 1 else f"{given[1]} - 1"
            return f"write `{given[0] if len(given) == 2 else 1}:{last}`, which includes its end"
    return f"write `1:{expression.span.text}`"


def integers(context: Context, expression: tree.Expression, environment: Environment) -> list[int]:
    """Return the values of a loop's range `1:n`, `1:2:n`.  Raises Wrong."""
    if not isinstance(expression, tree.Range):
        raise Wrong("LAG0208", "a loop needs a range, such as `1:n`", expression.span, _range(expression))
    first = integer(context, expression.start, environment, "the start of a range")
    last = integer(context, expression.stop, environment, "the end of a range")
    step = 1
    if expression.step is not None:
        step = integer(context, expression.step, environment, "the step of a range")
    if step == 0:
        span = expression.step.span if expression.step else expression.span
        raise Wrong("LAG0208", "the step of a range must not be 0", span)
    found = range(first, last + (1 if step > 0 else -1), step)
    if (last - first) // step >= LONGEST_RANGE:
        raise Wrong("LAG0218", f"the range has more than {LONGEST_RANGE} values", expression.span)
    return list(found)


def each(context: Context, find_one: Callable[[Item], T], items: Iterable[Item]) -> list[T]:
    """Return `find_one` of each item.  Raises Poisoned after the faults of all items are reported."""
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
    """Return the results of two jobs.  Raises Poisoned after the faults of both are reported."""
    jobs: tuple[Callable[[], Any], ...] = one, other
    first, second = each(context, lambda job: job(), jobs)
    return first, second


def all_values(
    context: Context, expressions: Iterable[tree.Expression], environment: Environment
) -> list[Value]:
    """Return the values of all expressions; the faults of all are reported."""
    return each(context, lambda e: evaluate(context, e, environment), expressions)
