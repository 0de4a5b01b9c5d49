"""A declared quantity with what was written about it: its values and its bounds."""

from __future__ import annotations

import math

from lagc.base.records import dataclass
from lagc.diagnostics.faults import Span
from lagc.semantics.context import Context
from lagc.semantics.declarations.attributes import elements, given_elements, given_scalar, written_value
from lagc.semantics.names.scope import Entry, Modifier, Scalar, subscripts
from lagc.semantics.types.refusals import Wrong
from lagc.semantics.types.types import QuantityType
from lagc.semantics.values.evaluate import evaluate
from lagc.symbolic.text import number as number_text
from lagc.syntax import tree


@dataclass(frozen=True, slots=True)
class Quantity:
    """A declaration of `Quantities` with what was written about it."""

    entry: Entry
    source: tree.Declarator
    type: QuantityType
    sizes: list[int]
    attributes: dict[str, Modifier]
    display: str

    def name(self, subscript: tuple[int, ...]) -> str:
        return self.entry.member(subscript)

    @property
    def description(self) -> str:
        return self.source.description or ""

    @property
    def subscripts(self) -> list[tuple[int, ...]]:
        return subscripts(self.sizes, self.source.span)


def values_of(context: Context, quantity: Quantity) -> list[Scalar | None]:
    """The value of each element; None where none is given."""
    entry, what = quantity.entry, f"`{quantity.entry.path}`"
    modifier = written_value(entry)
    overrides = [context.give(context.parameters, quantity.name(s)) for s in quantity.subscripts]
    whole = context.give(context.parameters, entry.path) if quantity.sizes else None
    if whole is not None:
        found: list[Scalar | None] = list(
            given_elements(context, whole, quantity.sizes, quantity.type.dimension, what)
        )
    elif modifier is None or (all(o is not None for o in overrides) and overrides):
        found = [None] * math.prod(quantity.sizes)
    else:
        found = list(elements(context, modifier, quantity.sizes, quantity.type.dimension, what))
    for k, given in enumerate(overrides):
        if given is not None:
            found[k] = given_scalar(
                context, given, quantity.type.dimension, f"`{quantity.name(quantity.subscripts[k])}`"
            )
    return found


def value_span(context: Context, quantity: Quantity, subscript: tuple[int, ...] = ()) -> Span:
    """Where the value that counts is written; the name where there is none."""
    for name in (quantity.name(subscript), quantity.entry.path):
        given = context.parameters.get(name)
        if given is not None:
            return quantity.entry.span if given.expression is None else given.expression.span
    modifier = written_value(quantity.entry)
    value = None if modifier is None else modifier.argument.value
    return quantity.entry.span if value is None else value.span


def bounds_of(context: Context, quantity: Quantity) -> tuple[float, float]:
    found = [-math.inf, math.inf]
    for k, name in enumerate(("min", "max")):
        modifier = quantity.attributes.get(name)
        if modifier is not None:
            scalar = elements(context, modifier, [], quantity.type.dimension, f"`{name}`")[0]
            if not scalar.node.is_const:
                raise Wrong("LAG0208", f"`{name}` is a fixed number", modifier.argument.span)
            found[k] = scalar.node.value
    return found[0], found[1]


def check_bounds(
    quantity: Quantity, name: str, value: float, bounds: tuple[float, float], span: Span, unit_text: str
) -> None:
    if not bounds[0] <= value <= bounds[1]:
        side, limit = (
            ("below its minimum", bounds[0]) if value < bounds[0] else ("above its maximum", bounds[1])
        )
        shown = f" [{unit_text}]" if unit_text else ""
        bound = quantity.attributes["min" if value < bounds[0] else "max"].argument.span
        raise Wrong(
            "LAG0308",
            f"`{name}` = {number_text(value)}{shown} is {side} {number_text(limit)}{shown}",
            span,
            related=((bound, "said here"),),
        )


def look_at_all(context: Context, entry: Entry, attributes: dict[str, Modifier]) -> None:
    """Report the faults of all that is written about a quantity."""
    value = written_value(entry)
    for modifier in [*attributes.values(), *([] if value is None else [value])]:
        if modifier.argument.value is not None:
            context.attempt(evaluate, context, modifier.argument.value, modifier.environment)
