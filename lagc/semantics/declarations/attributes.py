"""Attributes and values of declared quantities, from the declaration, modifiers, scenes and the command."""

import math
from collections.abc import Iterable, Sequence

from lagc.base.records import dataclass
from lagc.diagnostics.faults import Span, Wrong
from lagc.diagnostics.suggest import meant_argument
from lagc.semantics.context import LATE, MOVING, VELOCITY, Context, Given
from lagc.semantics.model import DECLARED, FIXED, RUN, SCENE, UNSTATED, Statement
from lagc.semantics.names.scope import (
    LONGEST_SHOWN,
    Array,
    Entry,
    Modifier,
    Scalar,
    Truth,
    Value,
    expect,
    flat,
    kind,
    shape,
    subscripts,
)
from lagc.semantics.units import NONE, Dimension, QuantityType, UnknownUnit, unit
from lagc.semantics.values.evaluate import evaluate, evaluate_as
from lagc.semantics.values.unit_hints import is_bare
from lagc.symbolic.graph import Node
from lagc.syntax import tree

BOOLEAN = QuantityType("Boolean", "", "", NONE)


def attributes_of(context: Context, entry: Entry, known: Sequence[str]) -> dict[str, Modifier]:
    """Return the attributes of a declaration; those of the outermost modifier win. Attributes that are not in
    `known` are reported."""
    source = entry.source
    assert isinstance(source, tree.Declarator)
    # Attributes from outside come first: the outermost modifier wins.
    own = [Modifier(a, entry.environment) for a in source.arguments]
    outer = [Modifier(a, m.environment, m.index) for m in entry.modifiers for a in m.argument.arguments]
    attributes: dict[str, Modifier] = {}
    first: dict[str | None, Span] = {}
    # A name that is given twice in one place is a fault; from outside it replaces.
    for modifier in own:
        argument = modifier.argument
        if argument.name in first:
            related = ((first[argument.name], "first here"),)
            context.report(
                Wrong("LAG0209", f"`{argument.name}` is given twice", argument.span, related=related)
            )
        first.setdefault(argument.name, argument.span)
    # The first of each name wins; every one is checked.
    for modifier in [*outer, *own]:
        argument = modifier.argument
        if argument.name is None:
            context.report(
                Wrong("LAG0209", "an attribute of a quantity needs a name: `start = 0`", argument.span)
            )
        elif argument.name not in known:
            span = argument.name_span or argument.span
            remedy = _unit_remedy(entry, argument)
            remedy = remedy or meant_argument(argument.name, known) or _has(entry.kind, known)
            wrong = Wrong("LAG0209", f"{_a(entry.kind)} has no `{argument.name}`", span, remedy)
            if argument.name == "unit":
                raise wrong  # the dimension is not known
            context.report(wrong)
        elif argument.value is None or argument.arguments:
            context.report(Wrong("LAG0210", f"`{argument.name}` needs a value", argument.span))
        else:
            attributes.setdefault(argument.name, modifier)
    return attributes


def _unit_remedy(entry: Entry, argument: tree.Argument) -> str | None:
    """Return a remedy for the attribute `unit` of Modelica."""
    if argument.name == "unit" and isinstance(argument.value, tree.String):
        from lagc.semantics.names.undeclared import type_of_unit  # where there is a fault

        name = type_of_unit(argument.value.value)
        return name and f"the type gives the unit: write `{entry.kind} {name} {entry.name}`"
    return None


_SAID = {"discrete": "discrete variable"}


def _a(kind_: str) -> str:
    kind_ = _SAID.get(kind_, kind_)
    return f"an {kind_}" if kind_[0] in "aeio" else f"a {kind_}"


def _has(kind_: str, known: Sequence[str]) -> str | None:
    return f"{_a(kind_)} has {', '.join(known)}" if known else None


def written_value(entry: Entry) -> Modifier | None:
    """Return the effective value: that of the outermost modifier, or else that of the declaration."""
    for modifier in entry.modifiers:
        if modifier.argument.value is not None:
            return modifier
    source = entry.source
    assert isinstance(source, tree.Declarator)
    if source.value is None:
        return None
    return Modifier(tree.Argument(None, None, source.value, source.value.span), entry.environment)


def no_value(entry: Entry) -> None:
    """Raise Wrong if a coordinate is given a value."""
    modifier = written_value(entry)
    if modifier is None or modifier.argument.value is None:
        return
    span, declaration = modifier.argument.value.span, entry.declaration
    assert isinstance(declaration, tree.Quantities)
    meant = "" if declaration.type is None else f"{declaration.type.span.text} "
    remedy = f"for an initial value write `{entry.name}(start = {span.text})`"
    if modifier.environment is entry.environment and not is_bare(modifier.argument.value, units=True):
        kind_ = "speed" if "der(" in span.text else "output"
        remedy = f"for a computed quantity write `{kind_} {meant}{entry.name} = {span.text};`"
    if len(span.text) > LONGEST_SHOWN or "\n" in span.text:
        remedy = "give an initial value: `(start = ...)`"
    raise Wrong("LAG0209", "a coordinate is an unknown and has no value", span, remedy)


def elements(
    context: Context, modifier: Modifier, sizes: list[int], dimension: Dimension, what: str
) -> list[Scalar]:
    """Return one scalar per element, from an array of that shape or from one value for all.  Raises Wrong."""
    expression = modifier.argument.value
    assert expression is not None
    value = evaluate_as(context, expression, modifier.environment, dimension)
    value = own_part(value, modifier, sizes, what)
    count = math.prod(sizes)
    if isinstance(value, Scalar):
        found = [value] * count
    elif not sizes:
        raise Wrong("LAG0306", f"{what} must be a number; this is {kind(value)}", expression.span)
    else:
        found = flat(value, expression.span, what)
        _as_many(value, sizes, expression.span, what)
    for scalar in found:
        expect(scalar.dimension, dimension, expression.span, what)
    return found


def own_part(value: Value, modifier: Modifier, sizes: list[int], what: str) -> Value:
    """Return the part of a value that belongs to the modifier's instance, if it has more dimensions than
    `sizes`."""
    if modifier.index and len(shape(value)) >= len(modifier.index) + len(sizes):
        for number in modifier.index:
            if not isinstance(value, Array) or not 1 <= number <= len(value.elements):
                assert modifier.argument.value is not None
                span = modifier.argument.value.span
                raise Wrong("LAG0306", f"{what} has fewer elements than the array of instances", span)
            value = value.elements[number - 1]
    return value


def _as_many(value: Value, sizes: list[int], span: Span, what: str) -> None:
    if shape(value) != sizes:
        shown = " x ".join(str(n) for n in sizes)
        raise Wrong("LAG0306", f"{what} needs {shown} elements; this has {math.prod(shape(value))}", span)


def array_of(scalars: Sequence[Value], sizes: list[int]) -> Value:
    """Return scalars (rows first) as a number or an array of shape `sizes`."""
    if not sizes:
        return scalars[0]
    step = len(scalars) // sizes[0] if sizes[0] else 0
    return Array(tuple([array_of(scalars[k * step : (k + 1) * step], sizes[1:]) for k in range(sizes[0])]))


def check_constant(context: Context, node: Node, span: Span, what: str) -> None:
    """Raise Wrong if `node` depends on anything but parameters."""
    if context.clock.mask(node) & (MOVING | LATE):
        raise Wrong("LAG0311", f"{what} must depend on parameters only; this depends on the motion", span)


def given_elements(
    context: Context, given: Given, sizes: list[int], dimension: Dimension, what: str
) -> list[Scalar]:
    """Return the scalars that a scene or the command gives to all elements.  Raises Wrong."""
    if given.expression is None or given.environment is None:
        return [given_scalar(context, given, dimension, what)] * math.prod(sizes)
    argument = tree.Argument(None, None, given.expression, given.expression.span)
    return elements(context, Modifier(argument, given.environment), sizes, dimension, what)


def given_scalar(context: Context, given: Given, dimension: Dimension, what: str) -> Scalar:
    """Return a scalar that a scene or the command gives.  Raises Wrong."""
    if given.expression is not None and given.environment is not None:
        value = evaluate_as(context, given.expression, given.environment, dimension)
        if not isinstance(value, Scalar):
            raise Wrong("LAG0306", f"{what} must be a number; this is {kind(value)}", given.expression.span)
        expect(value.dimension, dimension, given.expression.span, what)
        return value
    if given.points is not None:
        from lagc.semantics.values.tables import over_time

        return Scalar(over_time(context, given.points, given.owner), dimension)
    number = given.number
    if given.unit is not None:
        try:
            meant = unit(given.unit or "1")
        except UnknownUnit as unknown:
            raise Wrong("LAG0304", f"{what}: {unknown.reason}", None) from None
        expect(meant.dimension, dimension, given.span, what)
        number = meant.to_si(number)
    if not math.isfinite(number):
        raise Wrong("LAG0309", f"{what} is not finite", None)
    return Scalar(context.graph.const(number), dimension)


def statement_of(entry: Entry, modifier: Modifier | None) -> Statement:
    """Return the statement that a declaration makes with `modifier`; without one it states nothing."""
    if modifier is None:
        return Statement(UNSTATED, entry.span)
    return Statement(DECLARED, modifier.argument.span)


def guess_instead(attributes: dict[str, Modifier], attribute: str) -> Modifier | None:
    """Return the `guess` of an initial value that is not stated.  Raises Wrong if it is stated or fixed."""
    guess = attributes.get("guess") if attribute == "start" else None
    if guess is None:
        return None
    for other in ("start", "fixed", "startFixed"):
        if other in attributes:
            remedy = f"remove `{other}` to search near the guess, or `guess` to state the value"
            where = guess.argument.span
            raise Wrong("LAG0209", f"`guess` and `{other}` exclude each other", where, remedy)
    return guess


def from_outside(entry: Entry, given: Given) -> Statement:
    """Return the statement of a scene, or of the command if there is no place."""
    if given.span is None:
        return Statement(RUN, entry.span)
    return Statement(SCENE, given.span)


def with_fixed(
    context: Context,
    attributes: dict[str, Modifier],
    sizes: list[int],
    start: Sequence[Statement],
    rate: Sequence[Statement],
) -> tuple[list[Statement], list[Statement]]:
    """Return the statements on initial values and rates, fixed as the attributes say. `fixed` applies to the
    value and to a stated rate; `startFixed` and `rateFixed` override it."""
    names = ("fixed", "startFixed", "rateFixed")
    both, starts, _ = (fixed_flags(context, attributes, name, sizes, len(start)) for name in names)
    fixed_starts = [one if own is None else own for one, own in zip(both, starts)]
    both, _, rates = (fixed_flags(context, attributes, name, sizes, len(rate)) for name in names)
    turning = [
        one and stated.level != UNSTATED if own is None else own
        for one, own, stated in zip(both, rates, rate)
    ]
    return [*map(fixed_if, start, fixed_starts)], [*map(fixed_if, rate, turning)]


def fixed_if(stated: Statement, holds: bool | None) -> Statement:
    return Statement(FIXED, stated.span) if holds else stated


def fixed_flags(
    context: Context, attributes: dict[str, Modifier], name: str, sizes: list[int], count: int
) -> list[bool | None]:
    """Return the truth values of attribute `name` for `count` elements; None if the attribute is absent."""
    modifier = attributes.get(name)
    if modifier is None or modifier.argument.value is None:
        return [None] * count
    expression = modifier.argument.value
    value = own_part(evaluate(context, expression, modifier.environment), modifier, sizes, f"`{name}`")
    if isinstance(value, Array) and sizes:
        _as_many(value, sizes, expression.span, f"`{name}`")
        return [_constant_truth(truth, name, expression.span) for truth in _leaves(value)]
    return [_constant_truth(value, name, expression.span)] * count


def _constant_truth(value: Value, name: str, span: Span) -> bool:
    if not isinstance(value, Truth) or not value.node.is_const:
        raise Wrong("LAG0307", f"`{name}` must be true or false; this is {kind(value)}", span)
    return bool(value.node.value)


def _leaves(value: Value) -> list[Value]:
    if not isinstance(value, Array):
        return [value]
    return [leaf for element in value.elements for leaf in _leaves(element)]


def no_modifiers(entry: Entry) -> None:
    for modifier in entry.modifiers:
        message = f"the {entry.kind} `{entry.name}` cannot be changed from outside"
        remedy = "change the parameters in its declaration"
        raise Wrong("LAG0209", message, modifier.argument.span, remedy)


def no_rates(context: Context, node: Node, span: Span, what: str) -> None:
    """Raise Wrong if `node` depends on a rate or a speed."""
    if context.clock.mask(node) & VELOCITY:
        raise Wrong("LAG0313", f"{what} must not depend on a rate", span)


@dataclass(frozen=True, slots=True)
class Quantity:
    """A declared quantity with its type, array sizes and attributes."""

    entry: Entry
    source: tree.Declarator
    type: QuantityType
    sizes: list[int]
    attributes: dict[str, Modifier]
    display: str

    def name(self, subscript: tuple[int, ...]) -> str:
        return self.entry.member(subscript)

    @property
    def units(self) -> tuple[str, str]:
        """Return the SI unit, and the one that is displayed."""
        return self.type.unit, self.display

    @property
    def span_and_text(self) -> tuple[Span, str]:
        """Return the place and the description."""
        return self.entry.span, self.source.description or ""

    @property
    def subscripts(self) -> list[tuple[int, ...]]:
        return subscripts(self.sizes, self.source.span)


def values_of(context: Context, quantity: Quantity) -> list[Scalar | None]:
    """Return the value of each element; None if there is none."""
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
    """Return the place of the effective value, or that of the name if there is none."""
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
                raise Wrong("LAG0208", f"`{name}` must be a fixed number", modifier.argument.span)
            found[k] = scalar.node.value
    return found[0], found[1]


def keep_scale(context: Context, quantity: Quantity, names: Iterable[str]) -> None:
    """Keep the scale that a quantity is declared with, for each of its elements."""
    modifier = quantity.attributes.get("scale")
    if modifier is not None:
        scalar = elements(context, modifier, [], quantity.type.dimension, "`scale`")[0]
        if not scalar.node.is_const or not scalar.node.value > 0.0:
            remedy = "write the size to which the accuracy is relative: `scale = 0.1 [m]`"
            message = "`scale` must be a fixed positive number"
            raise Wrong("LAG0208", message, modifier.argument.span, remedy)
        context.scales.update(dict.fromkeys(names, scalar.node.value))


def check_bounds(
    quantity: Quantity, name: str, value: float, bounds: tuple[float, float], span: Span, unit_text: str
) -> None:
    if not bounds[0] <= value <= bounds[1]:
        from lagc.symbolic.expression_text import number as number_text  # where there is a fault

        side, limit = (
            ("below its minimum", bounds[0]) if value < bounds[0] else ("above its maximum", bounds[1])
        )
        shown = f" [{unit_text}]" if unit_text else ""
        bound = quantity.attributes["min" if value < bounds[0] else "max"].argument.span
        message = f"`{name}` = {number_text(value)}{shown} is {side} {number_text(limit)}{shown}"
        related = ((bound, "declared here"),)
        raise Wrong("LAG0308", message, span, related=related)


def look_at_all(context: Context, entry: Entry, attributes: dict[str, Modifier]) -> None:
    """Report the faults in all attributes and values of a quantity."""
    value = written_value(entry)
    for modifier in [*attributes.values(), *([] if value is None else [value])]:
        if modifier.argument.value is not None:
            context.attempt(evaluate, context, modifier.argument.value, modifier.environment)
