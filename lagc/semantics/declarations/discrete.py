"""Discrete variables, which only `when` clauses change: `discrete Real mode(start = 1);`."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from lagc.semantics import model as objects
from lagc.semantics.context import Context, Given
from lagc.semantics.declarations.attributes import (
    Quantity,
    check_constant,
    elements,
    given_elements,
    given_scalar,
    own_part,
    shaped,
    written_value,
)
from lagc.semantics.names.scope import Scalar, Truth, Value, kind
from lagc.semantics.refusals import Wrong
from lagc.semantics.time_derivatives import BIT, VELOCITY
from lagc.semantics.units import NONE, QuantityType
from lagc.semantics.values.evaluate import evaluate
from lagc.semantics.values.evaluate import whole as integral
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.walk import symbols
from lagc.syntax import tree

BOOLEAN = QuantityType("Boolean", "", "", NONE)
_TRUE = 0.5  # a truth value is stored as 0 or 1


def is_boolean(declaration: tree.Quantities) -> bool:
    """Return whether it declares discrete truth values."""
    declared = declaration.type
    return declaration.kind == "discrete" and declared is not None and declared.path == ("Boolean",)


def declare_discrete(context: Context, quantity: Quantity) -> Value:
    """Declare discrete variables and return their values."""
    entry, graph = quantity.entry, context.graph
    boolean = quantity.type is BOOLEAN
    _no_value(quantity)
    found: list[Value] = []
    for subscript, start in zip(quantity.subscripts, _starts(context, quantity, boolean)):
        name = quantity.name(subscript)
        symbol = graph.symbol("discrete", name)
        context.clock.set_rate(symbol, graph.zero)
        entry.objects.append(
            objects.Discrete(
                name, symbol, quantity.type.unit, quantity.display, start, boolean, entry.span,
                quantity.description,
            )
        )  # fmt: skip
        found.append(_truth(graph, symbol) if boolean else Scalar(symbol, quantity.type.dimension))
    return shaped(found, quantity.sizes)


def _truth(graph: Graph, symbol: Node) -> Truth:
    return Truth(graph.binary("lt", graph.const(_TRUE), symbol))


def truth_symbol(value: Value) -> Node | None:
    """Return the symbol of a discrete truth value, or None for any other value."""
    if isinstance(value, Truth) and value.node.op == "lt":
        low, symbol = value.node.args
        if low.is_const and symbol.op == "symbol" and symbol.record.kind == "discrete":
            return symbol
    return None


def number_of(graph: Graph, truth: Truth) -> Node:
    """Return a condition as the number 1 or 0."""
    return graph.select(truth.node, graph.one, graph.zero)


def _no_value(quantity: Quantity) -> None:
    modifier = written_value(quantity.entry)
    if modifier is not None and modifier.argument.value is not None:
        span, entry = modifier.argument.value.span, quantity.entry
        line = f"discrete {quantity.type.name} {entry.name}(start = {span.text});"
        message = "a discrete variable has no value of its own: it keeps what a `when` clause gives it"
        raise Wrong("LAG0209", message, span, f"write `{line}` and change it by `reinit` in a `when` clause")


def _starts(context: Context, quantity: Quantity, boolean: bool) -> list[Node]:
    """Return the start value of each element."""
    entry = quantity.entry
    what, modifier = f"the start of `{entry.path}`", quantity.attributes.get("start")
    whole = context.give(context.starts, entry.path)
    found: list[Node | None] = [None] * len(quantity.subscripts)
    if modifier is not None and boolean:
        expression = modifier.argument.value
        assert expression is not None
        value = own_part(evaluate(context, expression, modifier.environment), modifier, quantity.sizes, what)
        found = [_number(context, value, expression, what)] * len(found)
    elif modifier is not None:
        scalars = elements(context, modifier, quantity.sizes, quantity.type.dimension, what)
        found = [scalar.node for scalar in scalars]
    if whole is not None and quantity.sizes and not boolean:
        outside = given_elements(context, whole, quantity.sizes, quantity.type.dimension, what)
        found = [scalar.node for scalar in outside]
    for k, subscript in enumerate(quantity.subscripts):
        given = whole if not quantity.sizes else context.give(context.starts, quantity.name(subscript))
        if given is not None:
            found[k] = _given(context, given, quantity, boolean, what)
    span = modifier.argument.span if modifier else entry.span
    starts = [node for node in found if node is not None]
    if len(starts) < len(found):
        example = "false" if boolean else "0"
        line = f"discrete {quantity.type.name} {entry.name}(start = {example});"
        raise Wrong("LAG0210", f"the discrete variable `{entry.path}` has no start", span, f"write `{line}`")
    for node in starts:
        check_constant(context, node, span, what)
        if quantity.type.name == "Integer" and node.is_const and isinstance(node.value, float):
            integral(node.value, span, what)
    return starts


def _given(context: Context, given: Given, quantity: Quantity, boolean: bool, what: str) -> Node:
    if boolean and given.expression is not None and given.environment is not None:
        value = evaluate(context, given.expression, given.environment)
        return _number(context, value, given.expression, what)
    return given_scalar(context, given, quantity.type.dimension, what).node


def _number(context: Context, value: Value, written: tree.Expression, what: str) -> Node:
    if not isinstance(value, Truth):
        message = f"{what} must be true or false; this is {kind(value)}"
        raise Wrong("LAG0307", message, written.span, "write `true` or `false`")
    return number_of(context.graph, value)


def refuse_in_constraints(
    context: Context,
    constraints: Sequence[objects.Constraint],
    conditions: Iterable[objects.InitialCondition],
    speeds: Iterable[objects.Speed],
) -> None:
    """Report constraints, initial equations and declared speeds that depend on a discrete variable."""
    places = [(f"the constraint `{c.name}`", node, c.span) for c in constraints for node in c.residuals]
    places += [("an initial equation", c.residual, c.span) for c in conditions]
    places += [(f"the speed `{u.name}`", u.expression, u.span) for u in speeds]
    for what, node, span in places:
        if context.clock.mask(node) & BIT["discrete"]:
            name = min(s.record.name for s in symbols([node]) if s.record.kind == "discrete")
            message = f"{what} depends on the discrete variable `{name}`, which jumps"
            remedy = f"let `{name}` act through a force, a law or a potential"
            if what.startswith("the constraint") and context.clock.mask(node) & VELOCITY:
                remedy += (
                    f", or hold its value in a coordinate without inertia: `coordinate Real {name}(start = "
                    f"...); constraint hold: der({name}) = 0;`"
                )
            context.report(Wrong("LAG0232", message, span, remedy))
