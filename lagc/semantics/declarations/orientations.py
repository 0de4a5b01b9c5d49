"""`coordinate Orientation o`: a unit quaternion whose speeds are the body rates."""

from __future__ import annotations

import math

from lagc.semantics.context import Context
from lagc.semantics.declarations.attributes import (
    attributes_of,
    check_constant,
    declared,
    from_outside,
    given_scalar,
    guess_instead,
    no_value,
    own_part,
    with_fixed,
)
from lagc.semantics.model import Orientation, Statement
from lagc.semantics.names.scope import Entry, Modifier, Value, expect, flat
from lagc.semantics.refusals import Wrong
from lagc.semantics.time_derivatives import set_quaternion_rate
from lagc.semantics.units import NONE, Dimension, S, over
from lagc.semantics.values.evaluate import evaluate_as
from lagc.symbolic.graph import Node
from lagc.syntax import tree

PARTS = "wxyz"
_SMALLEST = 1e-6  # least norm of an initial quaternion


def declare_orientation(context: Context, entry: Entry, source: tree.Declarator) -> Value:
    """Declare an orientation with the time derivatives q' = 1/2 q (0, rate) of its quaternion.  Raises
    Wrong."""
    if source.dimensions:
        remedy = "declare the orientation in a model, and an array of instances of that model"
        raise Wrong("LAG0221", "arrays of orientations are not supported", source.span, remedy)
    no_value(entry)
    attributes = attributes_of(context, entry, ("start", "guess", "rate", "fixed", "startFixed", "rateFixed"))
    graph, name = context.graph, entry.path
    w, x, y, z = (graph.symbol("coordinate", name, part) for part in PARTS)
    a, b, c = (graph.symbol("rate", name, axis) for axis in "xyz")
    set_quaternion_rate(context.clock, (w, x, y, z), (a, b, c))
    one, zero = graph.one, graph.zero
    start, start_stated = _numbers(
        context,
        entry,
        attributes,
        (one, zero, zero, zero),
        NONE,
        "start",
        [symbol.record.name for symbol in (w, x, y, z)],
    )
    turning, rate_stated = _numbers(
        context,
        entry,
        attributes,
        (zero, zero, zero),
        over(NONE, S),
        "rate",
        [rate.record.name for rate in (a, b, c)],
    )
    whole = [max(start_stated, key=lambda s: s.level)]  # one statement for all four components
    whole, rate_stated = with_fixed(context, attributes, [], whole, rate_stated)
    orientation = Orientation(
        name,
        (w, x, y, z),
        (a, b, c),
        _unit(context, entry, start),
        (turning[0], turning[1], turning[2]),
        whole[0],
        (rate_stated[0], rate_stated[1], rate_stated[2]),
        entry.span,
        source.description or "",
        entry.effect,
    )
    entry.objects.append(orientation)
    return orientation


def _numbers(
    context: Context,
    entry: Entry,
    attributes: dict[str, Modifier],
    default: tuple[Node, ...],
    dimension: Dimension,
    attribute: str,
    names: list[str],
) -> tuple[list[Node], list[Statement]]:
    """Return the initial value of each of `names`, and its statement.  Raises Wrong."""
    what = f"the {attribute} of `{entry.path}`"
    modifier = attributes.get(attribute)
    found, stated = list(default), [declared(entry, modifier)] * len(default)
    modifier = guess_instead(attributes, attribute) or modifier
    whole = context.give(context.starts, entry.path if attribute == "start" else f"{entry.path}.rate")
    if whole is not None and whole.expression is not None and whole.environment is not None:
        given = tree.Argument(None, None, whole.expression, whole.expression.span)
        modifier = Modifier(given, whole.environment)
        stated = [from_outside(entry, whole)] * len(default)
    if modifier is not None and modifier.argument.value is not None:
        expression = modifier.argument.value
        value = evaluate_as(context, expression, modifier.environment, dimension)
        scalars = flat(own_part(value, modifier, [len(default)], what), expression.span, what)
        if len(scalars) != len(default):
            written = "{w, x, y, z}" if len(default) == 4 else "{x, y, z}"
            raise Wrong("LAG0306", f"{what} has {len(default)} elements, {written}", expression.span)
        for scalar in scalars:
            expect(scalar.dimension, dimension, expression.span, what)
            check_constant(context, scalar.node, expression.span, what)
        found = [scalar.node for scalar in scalars]
    for k, name in enumerate(names):
        one = context.give(context.starts, name)
        if one is not None:
            found[k] = given_scalar(context, one, dimension, f"the start of `{name}`").node
            stated[k] = from_outside(entry, one)
    return found, stated


def _unit(context: Context, entry: Entry, start: list[Node]) -> tuple[Node, Node, Node, Node]:
    """Return the initial value as a unit quaternion.  Raises Wrong if its norm is zero."""
    w, x, y, z = start
    square = w * w + x * x + y * y + z * z
    if square.is_const:
        length = math.sqrt(square.value)
        if length < _SMALLEST:
            raise Wrong(
                "LAG0309",
                f"the initial value of `{entry.path}` is zero; a quaternion needs a norm above zero",
                entry.span,
            )
        if length == 1.0:
            return (w, x, y, z)
    norm = context.graph.sqrt(square)
    return (w / norm, x / norm, y / norm, z / norm)
