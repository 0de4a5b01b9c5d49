"""Evaluation of each kind of expression."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from lagc.diagnostics.faults import Span
from lagc.diagnostics.suggest import foreign_call, remedy_of_word
from lagc.semantics.context import Context
from lagc.semantics.names.scope import Array, Environment, Scalar, Text, Truth, Value, flat, kind, shape
from lagc.semantics.refusals import Poisoned, Wrong
from lagc.semantics.units import CONSTANTS, NONE, Dimension, S, UnknownUnit, describe, unit
from lagc.semantics.values.arithmetic import binary, negative, select
from lagc.semantics.values.calls import call, written
from lagc.semantics.values.constants import dotted, outside, packaged
from lagc.semantics.values.evaluate import all_values, each, evaluate, integer, integers
from lagc.semantics.values.members import element, member, part
from lagc.semantics.values.unit_hints import is_bare, unit_remedy
from lagc.symbolic.graph import Node
from lagc.syntax import tree


def _number(context: Context, e: tree.Number, environment: Environment) -> Value:
    if not math.isfinite(e.value):
        raise Wrong("LAG0309", f"the number {e.text} is too large", e.span)
    return Scalar(context.graph.const(e.value), None if e.value == 0 else NONE)


def _boolean(context: Context, e: tree.Boolean, environment: Environment) -> Value:
    return Truth(context.graph.const(1.0 if e.value else 0.0))


def _string(context: Context, e: tree.String, environment: Environment) -> Value:
    return Text(e.value)


def _quantity(
    context: Context, e: tree.Quantity, environment: Environment, wanted: Dimension | None = None
) -> Value:
    """Return the value of a number or a vector with a unit; `wanted` is the dimension of its place."""
    try:
        meant = unit(e.unit.text)
    except UnknownUnit as unknown:
        from lagc.semantics.unit_spellings import unit_remedy as spelled  # where there is a fault

        raise Wrong(
            "LAG0304",
            unknown.reason,
            e.unit.span,
            remedy=_AN_ELEMENT if _is_number(e, environment) else spelled(e.unit.text, wanted),
        ) from None
    value = evaluate(context, e.value, environment)

    def converted(value: Value) -> Value:
        if isinstance(value, Array):
            return Array(tuple([converted(x) for x in value.elements]))
        if isinstance(value, Scalar) and value.node.is_const and value.dimension in (None, NONE):
            number = meant.to_si(value.node.value)
            if not math.isfinite(number):
                raise Wrong("LAG0309", "the number is too large", e.span)
            return Scalar(context.graph.const(number), meant.dimension)
        raise Wrong("LAG0304", "a unit can only follow a number or a vector of numbers", e.unit.span)

    return converted(value)


def _is_number(e: tree.Quantity, environment: Environment) -> bool:
    """Whether the brackets after a vector contain a subscript instead of a unit."""
    return isinstance(e.value, tree.Vector | tree.Family) and _is_subscript(e.unit.text.strip(), environment)


def _is_subscript(text: str, environment: Environment) -> bool:
    """Whether a text is a number or a known name, even if it is also a unit."""
    return text.isdigit() or text in environment.bindings or text in environment.instance.entries


def _name(context: Context, e: tree.Name, environment: Environment) -> Value:
    found = find(context, e.name, environment, e.span)
    if found is not None:
        return found
    instance = environment.instance
    if e.name in instance.unused:
        raise Wrong(
            "LAG0214",
            f"`{e.name}` {instance.unused[e.name]}",
            e.span,
            remedy="move this into the same effect, or use that effect in the scene",
        )
    from lagc.semantics.names.undeclared import remedy, remedy_of_reaction  # where there is a fault

    function = written(e.name)
    if function is not None:
        line = remedy_of_reaction(e, instance) or f"write `{function}`"
        raise Wrong("LAG0201", f"`{e.name}` is a function", e.span, line)
    raise Wrong("LAG0201", f"`{e.name}` is not declared", e.span, remedy(context, e, environment))


def find(context: Context, name: str, environment: Environment, span: Span) -> Value | None:
    """Return the value of a name, or None if it is unknown.  Names of the user come first."""
    if name in environment.bindings:
        return environment.bindings[name]
    entry = environment.instance.entries.get(name)
    if entry is not None:
        return context.value(entry, span)
    if name in environment.instance.unused:
        return None
    declared = environment.space.lookup(name)
    if declared is not None:
        return outside(context, declared[0], declared[1], name, span)
    if name == "time":
        return Scalar(context.time, S)
    if name == "world":
        return context.world
    if name in CONSTANTS:
        return Scalar(context.graph.const(CONSTANTS[name]), NONE)
    return None


def _member(context: Context, e: tree.Member, environment: Environment) -> Value:
    constant = packaged(context, e, environment)
    if constant is not None:
        return constant
    path = dotted(e) or ("",)
    remedy = f"write `{path[-1]}`" if path[-1] in CONSTANTS else remedy_of_word("names", path[-1])
    remedy = remedy or foreign_call(path[-1])
    unused = path[0] in environment.instance.unused
    if remedy is not None and not unused and find(context, path[0], environment, e.span) is None:
        raise Wrong("LAG0201", f"`{'.'.join(path)}` is not declared", e.span, remedy)
    return member(context, evaluate(context, e.base, environment), e)


def _index(context: Context, e: tree.Index, environment: Environment) -> Value:
    base = evaluate(context, e.base, environment)
    if isinstance(base, Scalar):
        _no_unit(e, environment)
    if any(isinstance(i, tree.Range) for i in e.indices):
        wanted = [
            integers(context, i, environment)
            if isinstance(i, tree.Range)
            else integer(context, i, environment, "a subscript")
            for i in e.indices
        ]
        return part(context, base, wanted, e)
    numbers = [integer(context, i, environment, "a subscript") for i in e.indices]
    return element(context, base, numbers, e)


def _no_unit(e: tree.Index, environment: Environment) -> None:
    """Raise Wrong if a unit follows something that is not a number."""
    text = e.span.source.text[e.base.span.end : e.span.end].strip()
    if _is_subscript(text[1:-1].strip(), environment):
        return
    try:
        unit(text[1:-1])
    except UnknownUnit:
        return
    message = "a unit can only follow a number or a vector of numbers"
    raise Wrong("LAG0304", message, e.span, remedy=f"multiply by `1 {text}`")


def _range(context: Context, e: tree.Range, environment: Environment) -> Value:
    message = "a range is only allowed in a loop, `for i in 1:n`, or as a subscript, `x[1:n]`"
    raise Wrong("LAG0208", message, e.span)


def _unary(context: Context, e: tree.Unary, environment: Environment) -> Value:
    value = evaluate(context, e.operand, environment)
    if e.op == "not":
        if not isinstance(value, Truth):
            raise Wrong("LAG0307", f"`not` takes a condition; this is {kind(value)}", e.operand.span)
        return Truth(context.graph.logical_not(value.node))
    if e.op == "+":
        flat(value, e.operand.span, "the operand of `+`")
        return value
    return negative(value, e.operand.span)


def _binary(context: Context, e: tree.Binary, environment: Environment) -> Value:
    """Evaluate the left spine in a loop, because a sum of thousands of terms is a tree as deep."""
    spine = [e]
    while isinstance(spine[-1].left, tree.Binary):
        spine.append(spine[-1].left)
    value: Value | None = None
    failed = False
    for node in reversed(spine):
        jobs = [node.left, node.right] if node is spine[-1] else [node.right]
        try:
            sides = all_values(context, jobs, environment)
        except Poisoned:
            failed = True
            continue
        if not failed:
            left = sides[0] if value is None else value
            value = binary(context, node, left, sides[-1])
    if failed or value is None:
        raise Poisoned
    return value


def _conditional(context: Context, e: tree.Conditional, environment: Environment) -> Value:
    def truth_of(condition: tree.Expression) -> Node:
        truth = evaluate(context, condition, environment)
        if not isinstance(truth, Truth):
            raise Wrong("LAG0307", f"`if` takes a condition; this is {kind(truth)}", condition.span)
        return truth.node

    try:
        truths = each(context, truth_of, [condition for condition, _ in e.branches])
    except Poisoned:
        all_values(context, [*(branch for _, branch in e.branches), e.otherwise], environment)
        raise
    chosen: list[tuple[Node, tree.Expression]] = []  # branches that may be taken; others are not evaluated
    for truth, (_, branch) in zip(truths, e.branches):
        if not truth.is_const or truth.value:
            chosen.append((truth, branch))
        if truth.is_const and truth.value:
            break
    else:
        chosen.append((context.graph.one, e.otherwise))
    values = all_values(context, [branch for _, branch in chosen], environment)
    value, span = values[-1], chosen[-1][1].span
    for (truth, branch), branch_value in zip(reversed(chosen[:-1]), reversed(values[:-1])):
        value = select(context, truth, (branch_value, branch.span), (value, span))
    return value


def _vector(context: Context, e: tree.Vector, environment: Environment) -> Value:
    return _array(all_values(context, e.elements, environment), e.elements)


def _family(context: Context, e: tree.Family, environment: Environment) -> Value:
    def of(number: int) -> Value:
        context.grow(e.span)
        value = Scalar(context.graph.const(number), None if number == 0 else NONE)
        return evaluate(context, e.element, environment.bind({e.variable: value}))

    numbers = integers(context, e.range, environment)
    return _array(each(context, of, numbers), [e.element] * len(numbers))


def _array(elements: Sequence[Value], written: Sequence[tree.Expression]) -> Array:
    conditions = all([_of_conditions(value) for value in elements])
    for value, given in zip(elements, written):
        if not conditions:
            flat(value, given.span, "an element of a vector")
        if shape(value) != shape(elements[0]):
            raise Wrong("LAG0306", "the elements of an array must have the same shape", given.span)
    _one_dimension(elements, written)
    return Array(tuple(elements))


def _of_conditions(value: Value) -> bool:
    if isinstance(value, Array):
        return bool(value.elements) and all([_of_conditions(element) for element in value.elements])
    return isinstance(value, Truth)


def _one_dimension(elements: Sequence[Value], written: Sequence[tree.Expression]) -> None:
    """Raise Wrong at the first element of a vector with a different dimension."""
    first: tuple[Dimension, tree.Expression] | None = None
    for value, expression in zip(elements, written):
        if not isinstance(value, Scalar) or value.dimension is None:
            continue
        if first is None or (is_bare(first[1]) and not is_bare(expression)):
            first = (value.dimension, expression)
    for value, expression in zip(elements, written):
        if first is None or not isinstance(value, Scalar) or value.dimension in (None, first[0]):
            continue
        assert value.dimension is not None
        here, there = describe(value.dimension), describe(first[0])
        raise Wrong(
            "LAG0301",
            f"the elements have different dimensions: {there} and {here}",
            expression.span,
            unit_remedy(expression, first[0]),
            related=((first[1].span, there),),
        )


_AN_ELEMENT = "to take an element of a vector, put it in parentheses: `({3, 1, 2})[i]`"

EVALUATORS: dict[type, Callable[..., Value]] = {
    tree.Number: _number, tree.Boolean: _boolean, tree.String: _string, tree.Quantity: _quantity,
    tree.Name: _name, tree.Member: _member, tree.Index: _index, tree.Call: call, tree.Unary: _unary,
    tree.Binary: _binary, tree.Conditional: _conditional, tree.Vector: _vector, tree.Range: _range,
    tree.Family: _family,
}  # fmt: skip
