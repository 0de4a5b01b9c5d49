"""Discrete variables, `discrete Real mode(start = 1);`, and the `when` clauses that change them."""

import re
from collections.abc import Callable, Iterable, Sequence

from lagc.base.records import dataclass, field
from lagc.diagnostics.faults import Source, Wrong
from lagc.diagnostics.suggest import did_you_mean, remedy_of_word
from lagc.semantics import model as objects
from lagc.semantics.context import BIT, LATE, MOVING, VELOCITY, Context, Given
from lagc.semantics.declarations.attributes import (
    BOOLEAN,
    Quantity,
    array_of,
    check_constant,
    elements,
    given_elements,
    given_scalar,
    own_part,
    written_value,
)
from lagc.semantics.names.scope import Environment, Scalar, Truth, Value, flat, kind, shape
from lagc.semantics.units import NONE, describe
from lagc.semantics.values.evaluate import each, evaluate, evaluate_as
from lagc.semantics.values.evaluate import whole as integral
from lagc.semantics.values.unit_hints import expect_of
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.walk import reachable, symbols
from lagc.syntax import tree

_TRUE = 0.5  # a truth value is stored as 0 or 1


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
            objects.Discrete(name, symbol, *quantity.units, start, boolean, *quantity.span_and_text)
        )
        found.append(_truth(graph, symbol) if boolean else Scalar(symbol, quantity.type.dimension))
    return array_of(found, quantity.sizes)


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
    values: list[Node | None] = [None] * len(quantity.subscripts)
    if modifier is not None and boolean:
        expression = modifier.argument.value
        assert expression is not None
        value = own_part(evaluate(context, expression, modifier.environment), modifier, quantity.sizes, what)
        values = [_number(context, value, expression, what)] * len(values)
    elif modifier is not None:
        scalars = elements(context, modifier, quantity.sizes, quantity.type.dimension, what)
        values = [scalar.node for scalar in scalars]
    if whole is not None and quantity.sizes and not boolean:
        outside = given_elements(context, whole, quantity.sizes, quantity.type.dimension, what)
        values = [scalar.node for scalar in outside]
    for k, subscript in enumerate(quantity.subscripts):
        # The declaration first, then a value for the whole array from outside, then those for its elements.
        given = whole if not quantity.sizes else context.give(context.starts, quantity.name(subscript))
        if given is not None:
            values[k] = _given_number(context, given, quantity, boolean, what)
    span = modifier.argument.span if modifier else entry.span
    starts = [node for node in values if node is not None]
    if len(starts) < len(values):
        example = "false" if boolean else "0"
        line = f"discrete {quantity.type.name} {entry.name}(start = {example});"
        raise Wrong("LAG0210", f"the discrete variable `{entry.path}` has no start", span, f"write `{line}`")
    for node in starts:
        check_constant(context, node, span, what)
        if quantity.type.name == "Integer" and node.is_const and isinstance(node.value, float):
            integral(node.value, span, what)
    return starts


def _given_number(context: Context, given: Given, quantity: Quantity, boolean: bool, what: str) -> Node:
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


_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
_USES = '`reinit(x, value)`, `terminate("why")`, `mark("name")`'


@dataclass(slots=True)
class _Found:
    """The actions of one clause."""

    changes: dict[Node, Node] = field(default_factory=dict)
    reasons: list[str] = field(default_factory=list)
    marks: list[str] = field(default_factory=list)


def when_clause(
    context: Context, written: tree.When, environment: Environment, effect: str | None
) -> objects.When:
    """Return the clause with its condition and actions.  Raises Wrong, or Poisoned after faults are
    reported."""

    def part(one: tree.When | tree.Statement) -> Node | None:
        if isinstance(one, tree.When):
            return _condition(context, one.condition, environment)
        return _action(one)(context, one, environment, found)

    found = _Found()
    parts: list[tree.When | tree.Statement] = [written, *written.statements]
    condition, *_ = each(context, part, parts)
    assert condition is not None
    words = _words(written.condition) + _where(environment)
    changes = tuple(found.changes.items())
    reason = found.reasons[0] if found.reasons else None
    return objects.When(words, condition, changes, reason, tuple(found.marks), written.span, effect)


def ending_clause(context: Context, until: str) -> tree.When:
    """Return the clause that ends a run when the condition `until` becomes true. Raises Refused if `until` is
    not an expression."""
    from lagc.syntax.parse import parse_expression

    source = Source("<until>", until, asked=True)
    context.importer.free.append(source)
    condition = parse_expression(source)
    span = condition.span
    reason = tree.Argument(None, None, tree.String(f"until {_words(condition)}", span), span)
    call = tree.Call(tree.Name("terminate", span), (reason,), span)
    return tree.When(condition, (tree.Statement(call, None, span),), span)


def _words(condition: tree.Expression) -> str:
    return " ".join(_COMMENT.sub(" ", condition.span.text).split())


def _where(environment: Environment) -> str:
    """Return the instance and the loop indices of a clause, as text."""
    path, values = environment.instance.path.rstrip("."), environment.bindings.items()
    found = [f"in {path}"] if path else []
    found += [f"{name} = {v.node.value:g}" for name, v in values if isinstance(v, Scalar) and v.node.is_const]
    return f" ({', '.join(found)})" if found else ""


def _condition(context: Context, written: tree.Expression, environment: Environment) -> Node:
    value = evaluate(context, written, environment)
    if not isinstance(value, Truth):
        raise Wrong("LAG0307", f"`when` needs a condition; this is {kind(value)}", written.span)
    mask = context.clock.mask
    moving = (MOVING | LATE) & ~BIT["discrete"]
    if any(node.op == "eq" and mask(node) & moving for node in reachable([value.node])):
        message = "`==` holds only for an instant, which is never detected"
        remedy = "write `<` or `>`: the time of the crossing is located"
        raise Wrong("LAG0227", message, written.span, remedy)
    return value.node


def _refuse_late(context: Context, node: Node, written: tree.Expression) -> None:
    if context.clock.mask(node) & LATE:
        message = (
            "a new value depends on an acceleration, a reaction or an energy of the run, which are only "
            "known after the equations are solved"
        )
        remedy = "compare it in the condition of the clause instead: `when reaction(c) > 5 [N] then ...`"
        raise Wrong("LAG0219", message, written.span, remedy)


Action = Callable[[Context, tree.Statement, Environment, _Found], None]


def _action(statement: tree.Statement) -> Action:
    action = statement.action
    if statement.value is not None or not isinstance(action, tree.Call):
        remedy = remedy_of_word("actions", action.span.text) or f"the actions are {_USES}"
        if statement.value is not None:
            value = re.sub(r"\bpre\((\w+)\)", r"\1", statement.value.span.text)
            remedy = f"write `reinit({action.span.text}, {value})`"
        raise Wrong("LAG0227", "a `when` clause contains actions, not equations", statement.span, remedy)
    name = action.function.name if isinstance(action.function, tree.Name) else action.function.span.text
    if name not in ACTIONS:
        remedy = remedy_of_word("actions", name) or did_you_mean(name, ACTIONS) or f"the actions are {_USES}"
        raise Wrong("LAG0227", f"`{name}` is not an action of `when`", action.function.span, remedy)
    return ACTIONS[name]


def _arguments(statement: tree.Statement, count: int, usage: str) -> list[tree.Expression]:
    action = statement.action
    assert isinstance(action, tree.Call)
    found = [a.value for a in action.arguments if a.name is None and a.value is not None and not a.arguments]
    if len(found) != count or len(action.arguments) != count:
        raise Wrong("LAG0227", "these arguments do not match the action", action.span, f"write `{usage}`")
    return found


def _text(statement: tree.Statement, usage: str) -> str:
    (argument,) = _arguments(statement, 1, usage)
    if not isinstance(argument, tree.String):
        raise Wrong("LAG0227", "this must be a text in double quotes", argument.span, f"write `{usage}`")
    words = " ".join(argument.value.split())
    if not words:
        raise Wrong("LAG0227", "this text is empty", argument.span, f"write `{usage}`")
    return words


def _terminate(context: Context, statement: tree.Statement, _: Environment, found: _Found) -> None:
    found.reasons.append(_text(statement, 'terminate("why")'))


def _mark(context: Context, statement: tree.Statement, _: Environment, found: _Found) -> None:
    found.marks.append(_text(statement, 'mark("name")'))


def _reinit(context: Context, statement: tree.Statement, environment: Environment, found: _Found) -> None:
    target, written = _arguments(statement, 2, "reinit(x, value)")
    value = evaluate(context, target, environment)
    if isinstance(value, objects.Orientation):
        remedy = f"set its angular velocity: `reinit({target.span.text}.rate, {{0, 0, 0}})`"
        raise Wrong("LAG0228", "`reinit` cannot set a whole orientation", target.span, remedy)
    # A condition is set by a condition, states by values of their shape and dimension.
    truth = truth_symbol(value)
    if truth is not None:
        new = evaluate(context, written, environment)
        if not isinstance(new, Truth):
            message = f"`{target.span.text}` is true or false; this is {kind(new)}"
            raise Wrong("LAG0307", message, written.span, f"write `reinit({target.span.text}, true)`")
        _refuse_late(context, new.node, written)
        _change(found, truth, number_of(context.graph, new), target)
        return
    states = [] if isinstance(value, Truth) else flat(value, target.span, "the first argument of `reinit`")
    kinds = ("coordinate", "rate", "speed", "discrete")
    if not states or any(s.node.op != "symbol" or s.node.record.kind not in kinds for s in states):
        message = "`reinit` sets a coordinate, its rate, a declared speed or a discrete variable"
        remedy = _not_a_state(target, states)
        raise Wrong("LAG0228", message, target.span, remedy)
    dimension = states[0].dimension or NONE
    new = evaluate_as(context, written, environment, dimension)
    values = flat(new, written.span, "a new value")
    if shape(new) != shape(value):
        raise Wrong("LAG0306", f"the new value must be {kind(value)}; this is {kind(new)}", written.span)
    for state, one in zip(states, values):
        expect_of(written, one.dimension, state.dimension or NONE, "the new value", describe(dimension))
        _refuse_late(context, one.node, written)
        _change(found, state.node, one.node, target)


def _change(found: _Found, state: Node, value: Node, target: tree.Expression) -> None:
    if state in found.changes:
        raise Wrong("LAG0228", "this state is set twice in the same clause", target.span)
    found.changes[state] = value


def _not_a_state(target: tree.Expression, states: list[Scalar]) -> str:
    """Return a remedy for a first argument that `reinit` cannot set."""
    kinds = {s.node.record.kind for s in states if s.node.op == "symbol"}
    if kinds and kinds <= {"parameter", "input"}:
        name = target.span.text
        return f"declare it as `discrete Real {name}(start = ...);`, with its type"
    return "write `reinit(x, ...)` or `reinit(der(x), ...)`"


ACTIONS: dict[str, Action] = {"reinit": _reinit, "terminate": _terminate, "mark": _mark}
