"""Evaluation of each kind of expression; operators on values, with the dimensions of their results."""

import math
from collections.abc import Callable, Sequence

from lagc.diagnostics.faults import Poisoned, Span, Wrong
from lagc.diagnostics.suggest import foreign_call, remedy_of_word
from lagc.semantics.context import Context
from lagc.semantics.model import Body
from lagc.semantics.names.scope import Array, Environment, Scalar, Text, Truth, Value, flat, kind, shape
from lagc.semantics.units import (
    CONSTANTS,
    NONE,
    Dimension,
    S,
    UnknownUnit,
    describe,
    over,
    raised,
    times,
    unit,
)
from lagc.semantics.values.calls import call, constant_outside, dotted_path, package_constant, shortest_call
from lagc.semantics.values.evaluate import all_values, each, evaluate, integer, integers
from lagc.semantics.values.unit_hints import is_bare, unit_remedy
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

    def result_of(x: Scalar, y: Scalar) -> Scalar:
        return Scalar(
            context.graph.select(condition, x.node, y.node),
            _common_dimension(x, y, "the branches", b_span, a_span, b_span),
        )

    if not isinstance(a, Scalar | Array) or not isinstance(b, Scalar | Array):
        wrong, span = (a, a_span) if not isinstance(a, Scalar | Array) else (b, b_span)
        raise Wrong("LAG0307", f"the branches of `if` are numbers or vectors; this is {kind(wrong)}", span)
    return _elementwise(a, b, result_of, "the branches of `if`", b_span)


def _elementwise(a: Value, b: Value, one: Callable[[Scalar, Scalar], Scalar], what: str, span: Span) -> Value:
    if isinstance(a, Scalar) and isinstance(b, Scalar):
        return one(a, b)
    if isinstance(a, Array) and isinstance(b, Array) and len(a.elements) == len(b.elements):
        return Array(tuple([_elementwise(x, y, one, what, span) for x, y in zip(a.elements, b.elements)]))
    raise Wrong("LAG0306", f"{what} have different shapes: {_shape(a)} and {_shape(b)}", span)


def _shape(value: Value) -> str:
    sizes = shape(value)
    return f"an array of {' x '.join(str(n) for n in sizes)}" if sizes else "a number"


def _common_dimension(
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
    return _common_dimension(a, b, what, e.op_span, e.left.span, e.right.span, remedy)


def _sum(e: tree.Binary, left: Value, right: Value) -> Value:
    what = "the two sides of `+`" if e.op == "+" else "the two sides of `-`"

    def result_of(a: Scalar, b: Scalar) -> Scalar:
        dimension = a.dimension if a.dimension == b.dimension else _sides(e, a, b, what)
        return Scalar(a.node + b.node if e.op == "+" else a.node - b.node, dimension)

    return _elementwise(left, right, result_of, what, e.op_span)


def _times(a: Scalar, b: Scalar) -> Scalar:
    if a.dimension is None or b.dimension is None:
        return Scalar(a.node * b.node, None)
    return Scalar(a.node * b.node, times(a.dimension, b.dimension))


def _divide(a: Scalar, b: Scalar) -> Scalar:
    if b.node.is_zero:
        raise ZeroDivisionError
    if a.dimension is None or b.dimension is None:
        return Scalar(a.node / b.node, None)
    return Scalar(a.node / b.node, over(a.dimension, b.dimension))


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
    return _divide(left, right)


def _power(e: tree.Binary, left: Value, right: Value) -> Value:
    if not isinstance(left, Scalar) or not isinstance(right, Scalar):
        message = "`^` takes numbers"
        remedy = "write the square of a vector as `dot(a, a)` or `norm(a)^2`"
        raise Wrong("LAG0306", message, e.span, remedy)
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
    is_number = power.is_const and not power.is_zero  # as 0^0
    return Scalar(power, None if left.dimension is None and not is_number else dimension)


_ARITHMETIC: dict[str, Callable[[tree.Binary, Value, Value], Value]] = {
    "+": _sum, "-": _sum, "*": _product, "/": _quotient, "^": _power,
}  # fmt: skip


def _comparison(context: Context, e: tree.Binary, left: Value, right: Value) -> Value:
    if not isinstance(left, Scalar) or not isinstance(right, Scalar):
        raise Wrong("LAG0306", f"`{e.op}` compares numbers", e.span)
    _sides(e, left, right, f"the two sides of `{e.op}`")
    op, swapped = _COMPARISONS[e.op]
    # There is no `>` in the graph: a > b is b < a, so equal conditions become one node.
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
        # Powers of constants that have no real value, such as (-1)^0.5, stay powers in the graph: constants
        # left under a power are thus a fault.
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
        from lagc.semantics.values.unit_hints import spelling_remedy  # where there is a fault

        message = unknown.reason
        remedy = _AN_ELEMENT if _is_number(e, environment) else spelling_remedy(e.unit.text, wanted)
        raise Wrong("LAG0304", message, e.unit.span, remedy) from None
    value = evaluate(context, e.value, environment)

    # Units apply element by element, and only to literals: `x [m]` of a quantity x that has a dimension
    # already would be a cast.
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
    """Return whether the brackets after a vector contain a subscript instead of a unit."""
    return isinstance(e.value, tree.Vector | tree.Family) and _is_subscript(e.unit.text.strip(), environment)


def _is_subscript(text: str, environment: Environment) -> bool:
    """Return whether a text is a number or a known name, even if it is also a unit."""
    return text.isdigit() or text in environment.bindings or text in environment.instance.entries


def _name(context: Context, e: tree.Name, environment: Environment) -> Value:
    found = find(context, e.name, environment, e.span)
    if found is not None:
        return found
    instance = environment.instance
    # Names of effects that the scene leaves out exist, but have no value here.
    if e.name in instance.unused:
        line = "move this into the same effect, or use that effect in the scene"
        raise Wrong("LAG0214", f"`{e.name}` {instance.unused[e.name]}", e.span, line)
    from lagc.semantics.names.undeclared import remedy, remedy_of_reaction  # where there is a fault

    function = shortest_call(e.name)
    if function is not None:
        line = remedy_of_reaction(e, instance) or f"write `{function}`"
        raise Wrong("LAG0201", f"`{e.name}` is a function", e.span, line)
    raise Wrong("LAG0201", f"`{e.name}` is not declared", e.span, remedy(context, e, environment))


def find(context: Context, name: str, environment: Environment, span: Span) -> Value | None:
    """Return the value of a name, or None if it is unknown.  Names of the user come first."""
    # From the innermost scope out: loop variables, the model, constants of files and packages, words of the
    # language. A declaration can so reuse a word of the language.
    if name in environment.bindings:
        return environment.bindings[name]
    entry = environment.instance.entries.get(name)
    if entry is not None:
        return context.value(entry, span)
    if name in environment.instance.unused:
        return None
    declared = environment.space.lookup(name)
    if declared is not None:
        return constant_outside(context, declared[0], declared[1], name, span)
    if name == "time":
        return Scalar(context.time, S)
    if name == "world":
        return context.world
    if name in CONSTANTS:
        return Scalar(context.graph.const(CONSTANTS[name]), NONE)
    return None


def _member(context: Context, e: tree.Member, environment: Environment) -> Value:
    from lagc.semantics.values.members import member  # where there are some

    constant = package_constant(context, e, environment)
    if constant is not None:
        return constant
    path = dotted_path(e) or ("",)
    # The base may be a package of another language, `math.pi`. Only if its first name is unknown; a quantity
    # called `math` wins.
    remedy = f"write `{path[-1]}`" if path[-1] in CONSTANTS else remedy_of_word("names", path[-1])
    remedy = remedy or foreign_call(path[-1])
    unused = path[0] in environment.instance.unused
    if remedy is not None and not unused and find(context, path[0], environment, e.span) is None:
        raise Wrong("LAG0201", f"`{'.'.join(path)}` is not declared", e.span, remedy)
    return member(context, evaluate(context, e.base, environment), e)


def _index(context: Context, e: tree.Index, environment: Environment) -> Value:
    from lagc.semantics.values.members import element, part  # where there are some

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
    # `x[m]` of a scalar parses as a subscript. If the text is a unit and no known name, a unit was meant.
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
            # Both sides are evaluated even after a fault further left, so that all faults of a sum appear at
            # once.
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

    # Faults in conditions do not hide those of the values.
    try:
        truths = each(context, truth_of, [condition for condition, _ in e.branches])
    except Poisoned:
        all_values(context, [*(branch for _, branch in e.branches), e.otherwise], environment)
        raise
    # A branch that cannot be taken may divide by zero, or be of a size that does not exist: `if n > 1 then
    # x[2] else 0`.
    chosen: list[tuple[Node, tree.Expression]] = []  # branches that may be taken; others are not evaluated
    for truth, (_, branch) in zip(truths, e.branches):
        if not truth.is_const or truth.value:
            chosen.append((truth, branch))
        if truth.is_const and truth.value:
            break
    else:
        chosen.append((context.graph.one, e.otherwise))
    values = all_values(context, [branch for _, branch in chosen], environment)
    # Nested from the last branch to the first: if a then x else (if b then y else z).
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
    # The first element with a certain dimension gives it; a literal without a unit only if nothing else does,
    # as it is more likely what was forgotten.
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
        message = f"the elements have different dimensions: {there} and {here}"
        remedy = unit_remedy(expression, first[0])
        related = ((first[1].span, there),)
        raise Wrong("LAG0301", message, expression.span, remedy, related)


_AN_ELEMENT = "to take an element of a vector, put it in parentheses: `({3, 1, 2})[i]`"

EVALUATORS: dict[type, Callable[..., Value]] = {
    tree.Number: _number, tree.Boolean: _boolean, tree.String: _string, tree.Quantity: _quantity,
    tree.Name: _name, tree.Member: _member, tree.Index: _index, tree.Call: call, tree.Unary: _unary,
    tree.Binary: _binary, tree.Conditional: _conditional, tree.Vector: _vector, tree.Range: _range,
    tree.Family: _family,
}  # fmt: skip
