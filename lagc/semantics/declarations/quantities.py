"""Declarations of constants, parameters, inputs, coordinates, orientations, speeds and outputs."""

import math
from collections.abc import Callable

from lagc.diagnostics.faults import Poisoned, Wrong
from lagc.semantics import model as objects
from lagc.semantics.context import LATE, Context, set_quaternion_rate
from lagc.semantics.declarations.attributes import (
    BOOLEAN,
    Quantity,
    array_of,
    attributes_of,
    bounds_of,
    check_bounds,
    check_constant,
    elements,
    fixed_flags,
    fixed_if,
    from_outside,
    given_elements,
    given_scalar,
    guess_instead,
    keep_scale,
    look_at_all,
    no_value,
    own_part,
    statement_of,
    value_span,
    values_of,
    with_fixed,
    written_value,
)
from lagc.semantics.model import Orientation, Statement
from lagc.semantics.names.scope import (
    Entry,
    Modifier,
    Scalar,
    Text,
    Value,
    expect,
    flat,
    kind,
    shape,
    subscripts,
)
from lagc.semantics.units import NONE, Dimension, QuantityType, S, UnknownUnit, over, unit
from lagc.semantics.values.calls import type_of
from lagc.semantics.values.evaluate import evaluate, evaluate_as, integer, whole
from lagc.semantics.values.unit_hints import expect_of
from lagc.symbolic.graph import Node
from lagc.symbolic.leaves import derived
from lagc.syntax import tree

ATTRIBUTES = {
    "constant": (), "parameter": ("min", "max", "displayUnit"), "structural": ("min", "max"),
    "input": ("min", "max", "displayUnit"),
    "coordinate": ("start", "guess", "rate", "fixed", "startFixed", "rateFixed", "displayUnit", "scale"),
    "speed": ("start", "guess", "fixed", "displayUnit", "scale"),
    "discrete": ("start", "displayUnit"),
    "output": ("displayUnit", "scale"),
}  # fmt: skip

_SYMBOLS = ("parameter", "input", "coordinate", "speed")  # kinds that have a symbol
_SAID = {"structural": "structural parameter"}


def declare_quantity(context: Context, entry: Entry) -> Value:
    """Declare a quantity and return its value. After a fault the value is a placeholder symbol, so that
    declarations that use it are still checked. Raises Wrong, or Poisoned if there is no placeholder."""
    source, declaration = entry.source, entry.declaration
    assert isinstance(source, tree.Declarator) and isinstance(declaration, tree.Quantities)
    if (
        entry.kind == "coordinate"
        and declaration.type is not None
        and declaration.type.path == ("Orientation",)
    ):
        return declare_orientation(context, entry, source)
    # A fault in the type is reported; the declaration goes on with an unknown dimension.
    if declaration.type is None:
        from lagc.semantics.names.undeclared import without_type  # where there is a fault

        context.report(without_type(context, entry))
        return _stand_in(context, entry, [], None)
    if entry.name == "time":
        remedy = "choose another name: `time` is the time of the motion, and the first column of results"
        raise Wrong("LAG0202", "`time` is a name of the language", entry.span, remedy)
    try:
        truth = _is_boolean(declaration)
        meant: QuantityType | None = BOOLEAN if truth else type_of(declaration.type, entry.environment.space)
    except Wrong as wrong:
        context.report(wrong)
        meant = None
    if entry.kind == "structural" and meant and meant.name != "Integer" and declaration.type is not None:
        message = "a structural parameter must be an `Integer`"
        remedy = "write `structural Integer`, or `parameter` for a quantity"
        raise Wrong("LAG0221", message, declaration.type.span, remedy)
    # Sizes need the values of structural parameters only, so they are known before the quantity is.
    sizes = [integer(context, size, entry.environment, "a size") for size in source.dimensions]
    # The kinds share sizes, attributes and units; after a fault a symbol stands for the value.
    attributes = attributes_of(context, entry, ATTRIBUTES[entry.kind])
    try:
        if meant is not None:
            display = _display(context, meant, attributes)
            return _DECLARE[entry.kind](context, Quantity(entry, source, meant, sizes, attributes, display))
    except Wrong as wrong:
        context.report(wrong)
    except Poisoned:
        pass
    # Attributes of a quantity that could not be declared are still evaluated, for their own faults.
    look_at_all(context, entry, attributes)
    return _stand_in(context, entry, sizes, None if meant is None else meant.dimension)


def _stand_in(context: Context, entry: Entry, sizes: list[int], dimension: Dimension | None) -> Value:
    """Return placeholder symbols for a quantity with a fault.  Raises Poisoned if its kind has none."""
    if entry.kind not in _SYMBOLS:
        raise Poisoned
    graph, found = context.graph, []
    entry.objects.clear()
    for subscript in subscripts(sizes, entry.source.span):
        symbol = graph.symbol(entry.kind, entry.member(subscript))
        found.append(Scalar(symbol, dimension))
        top = symbol
        for _ in range({"coordinate": 2, "speed": 1}.get(entry.kind, 0)):
            context.clock.set_rate(top, graph.leaf(top.record.derivative))
            top = graph.leaf(top.record.derivative)
    return array_of(found, sizes)


def _display(context: Context, meant: QuantityType, attributes: dict[str, Modifier]) -> str:
    modifier = attributes.get("displayUnit")
    if modifier is None:
        return meant.display
    argument = modifier.argument
    assert argument.value is not None
    value = evaluate(context, argument.value, modifier.environment)
    if not isinstance(value, Text):
        message = f'`displayUnit` must be a text such as "deg"; this is {kind(value)}'
        raise Wrong("LAG0307", message, argument.value.span)
    try:
        dimension = unit(value.text).dimension
    except UnknownUnit as unknown:
        raise Wrong("LAG0304", unknown.reason, argument.value.span) from None
    expect(dimension, meant.dimension, argument.value.span, "the displayed quantity")
    return value.text


# -- the kinds -----------------------------------------------------------------------------------


def _constant(context: Context, quantity: Quantity) -> Value:
    """Declare constants and structural integers, whose values are known at compile time."""
    entry = quantity.entry
    bounds = bounds_of(context, quantity)
    values: list[Scalar] = []
    for subscript, scalar in zip(quantity.subscripts, values_of(context, quantity)):
        name = quantity.name(subscript)
        span = value_span(context, quantity, subscript)
        if scalar is None:
            message = f"the {_SAID.get(entry.kind, entry.kind)} `{name}` has no value"
            remedy = "write `= value`" + (" or set it with `-p`" if entry.kind == "structural" else "")
            raise Wrong("LAG0210", message, entry.span, remedy)
        check_constant(context, scalar.node, span, f"`{name}`")
        if entry.kind == "structural":
            number = scalar.node.value
            if not scalar.node.is_const or not isinstance(number, float):
                raise Wrong("LAG0208", f"the structural parameter `{name}` must be an integer", span)
            whole(number, span, f"the structural parameter `{name}`")
            check_bounds(quantity, name, number, bounds, span, "")
            context.built_in.append(name)
        values.append(scalar)
    return array_of(values, quantity.sizes)


def _parameter(context: Context, quantity: Quantity) -> Value:
    entry = quantity.entry
    bounds = bounds_of(context, quantity)
    values: list[Scalar] = []
    for subscript, scalar in zip(quantity.subscripts, values_of(context, quantity)):
        name = quantity.name(subscript)
        span = value_span(context, quantity, subscript)
        value: float | None = None
        if scalar is not None:
            check_constant(context, scalar.node, span, f"the parameter `{name}`")
            if not scalar.node.is_const:
                context.built_in.append(name)
                if bounds != (-math.inf, math.inf):
                    entry.objects.append(
                        objects.Limit(name, scalar.node, quantity.type.unit, *bounds, entry.span)
                    )
                values.append(Scalar(scalar.node, quantity.type.dimension))
                continue
            value = scalar.node.value
            assert value is not None
            if quantity.type.name == "Integer":
                whole(value, span, f"the parameter `{name}`")
            check_bounds(quantity, name, value, bounds, span, quantity.type.unit)
        # A parameter with a number can be set before each run; one that is computed from others is built
        # in, and its bounds are checked with them.
        symbol = context.graph.symbol("parameter", name)
        if name in context.released:  # an output asks for its reaction
            from lagc.semantics.joints import release_parameter

            entry.objects += release_parameter(context, entry, symbol, quantity.type.unit)
        is_integer = quantity.type.name == "Integer"
        parameter = objects.Parameter(
            name, symbol, *quantity.units, value, *bounds, *quantity.span_and_text, is_integer
        )
        entry.objects.append(parameter)
        values.append(Scalar(symbol, quantity.type.dimension))
    return array_of(values, quantity.sizes)


def _input(context: Context, quantity: Quantity) -> Value:
    entry = quantity.entry
    bounds = bounds_of(context, quantity)
    values: list[Scalar] = []
    for subscript, scalar in zip(quantity.subscripts, values_of(context, quantity)):
        name, unit = quantity.name(subscript), quantity.type.unit
        if scalar is not None and not scalar.node.is_const:
            output = _output_of_input(context, quantity, name, scalar.node)
            if name in context.taken or entry.path in context.taken or not entry.modifiers:
                entry.objects.append(output)  # else it is an expression of the model that contains this one
            values.append(Scalar(scalar.node, quantity.type.dimension))
            continue
        default = 0.0 if scalar is None else scalar.node.value
        check_bounds(quantity, name, default, bounds, value_span(context, quantity, subscript), unit)
        symbol = context.graph.symbol("input", name)
        entry.objects.append(objects.Input(name, symbol, unit, default, *bounds, *quantity.span_and_text))
        values.append(Scalar(symbol, quantity.type.dimension))
    return array_of(values, quantity.sizes)


def _output_of_input(context: Context, quantity: Quantity, name: str, node: Node) -> objects.Output:
    """Return the output that records an input given by an expression."""
    if context.clock.mask(node) & LATE:
        message = "an input must not depend on an acceleration or a reaction"
        raise Wrong("LAG0219", message, value_span(context, quantity))
    context.built_in.append(name)
    return objects.Output(name, node, *quantity.units, *quantity.span_and_text)


def starts(
    context: Context,
    quantity: Quantity,
    attribute: str,
    dimension: Dimension,
    name: Callable[[tuple[int, ...]], str],
) -> tuple[list[Node], list[objects.Statement]]:
    """Return the initial value (or rate) of each element, and its statement.  A `guess` states nothing."""
    modifier = quantity.attributes.get(attribute)
    guess = guess_instead(quantity.attributes, attribute)
    zero = Scalar(context.graph.zero, None)
    count = len(quantity.subscripts)
    what = f"the {attribute} of `{quantity.entry.path}`"
    # A guess gives the value and no statement. Values from outside state more than the declaration: those
    # of the whole array, then those of elements.
    stated = [statement_of(quantity.entry, modifier)] * count
    modifier = guess or modifier
    values = (
        [zero] * count if modifier is None else elements(context, modifier, quantity.sizes, dimension, what)
    )
    whole = context.give(context.starts, name(()))
    if whole is not None and quantity.sizes:
        values = list(given_elements(context, whole, quantity.sizes, dimension, what))
        stated = [from_outside(quantity.entry, whole)] * count
    for k, subscript in enumerate(quantity.subscripts):
        given = whole if not quantity.sizes else context.give(context.starts, name(subscript))
        if given is not None:
            values[k] = given_scalar(context, given, dimension, what)
            stated[k] = from_outside(quantity.entry, given)
    for scalar in values:
        span = modifier.argument.span if modifier else quantity.entry.span
        check_constant(context, scalar.node, span, what)
    return [scalar.node for scalar in values], stated


def _coordinate(context: Context, quantity: Quantity) -> Value:
    entry, graph = quantity.entry, context.graph
    no_value(entry)
    dimension = quantity.type.dimension
    keep_scale(context, quantity, map(quantity.name, quantity.subscripts))
    at_start, start_stated = starts(context, quantity, "start", dimension, quantity.name)
    rates, rate_stated = starts(
        context, quantity, "rate", over(dimension, S), lambda s: derived(quantity.name(s))
    )
    start_stated, rate_stated = with_fixed(
        context, quantity.attributes, quantity.sizes, start_stated, rate_stated
    )
    symbols: list[Scalar] = []
    for k, (subscript, start, rate) in enumerate(zip(quantity.subscripts, at_start, rates)):
        name = quantity.name(subscript)
        # The clock knows q' and q'': derivatives of all expressions follow from these.
        symbol = graph.symbol("coordinate", name)
        speed = graph.leaf(symbol.record.derivative)
        context.clock.set_rate(symbol, speed)
        context.clock.set_rate(speed, graph.leaf(speed.record.derivative))
        stated = start_stated[k], rate_stated[k]
        coordinate = objects.Coordinate(
            name, symbol, speed, *quantity.units, start, rate, *stated, *quantity.span_and_text, entry.effect
        )
        entry.objects.append(coordinate)
        symbols.append(Scalar(symbol, dimension))
    return array_of(symbols, quantity.sizes)


def _speed(context: Context, quantity: Quantity) -> Value:
    entry, graph = quantity.entry, context.graph
    modifier = written_value(entry)
    if modifier is None:
        message = f"the speed `{entry.path}` needs a value"
        remedy = "define it by rates: `= der(x) + ...`"
        raise Wrong("LAG0210", message, entry.span, remedy)
    values = elements(context, modifier, quantity.sizes, quantity.type.dimension, f"`{entry.path}`")
    at_start, stated = starts(context, quantity, "start", quantity.type.dimension, quantity.name)
    holds = fixed_flags(context, quantity.attributes, "fixed", quantity.sizes, len(values))
    keep_scale(context, quantity, map(quantity.name, quantity.subscripts))
    symbols: list[Scalar] = []
    for k, (subscript, scalar) in enumerate(zip(quantity.subscripts, values)):
        if context.clock.mask(scalar.node) & LATE:
            message = "a speed must not depend on an acceleration or a reaction"
            raise Wrong("LAG0219", message, value_span(context, quantity))
        name = quantity.name(subscript)
        symbol = graph.symbol("speed", name)
        context.clock.set_rate(symbol, graph.leaf(symbol.record.derivative))
        # Without a value of its own the start follows from the rates that define the speed.
        known = stated[k].level != objects.UNSTATED or "guess" in quantity.attributes
        initial = at_start[k] if known else None, fixed_if(stated[k], holds[k])
        entry.objects.append(
            objects.Speed(name, symbol, scalar.node, quantity.type.unit, *quantity.span_and_text, *initial)
        )
        symbols.append(Scalar(symbol, quantity.type.dimension))
    return array_of(symbols, quantity.sizes)


def _output(context: Context, quantity: Quantity) -> Value:
    entry = quantity.entry
    modifier = written_value(entry)
    if modifier is None or modifier.argument.value is None:
        rate = quantity.type.name in ("Velocity", "AngularVelocity")
        message = f"the output `{entry.path}` needs a value"
        raise Wrong(
            "LAG0210", message, entry.span, f"write `{entry.name} = {'der(x)' if rate else 'expression'}`"
        )
    expression = modifier.argument.value
    value = evaluate_as(context, expression, modifier.environment, quantity.type.dimension)
    scalars = flat(value, expression.span, f"`{entry.path}`")
    for scalar in scalars:
        expect_of(
            expression, scalar.dimension, quantity.type.dimension, f"`{entry.path}`", quantity.type.in_words
        )
    sizes = shape(value)
    if quantity.sizes and sizes != quantity.sizes:
        message = f"the value of `{entry.path}` has a different shape than its declaration"
        raise Wrong("LAG0306", message, expression.span)
    keep_scale(context, quantity, map(quantity.name, subscripts(sizes, entry.span)))
    for subscript, scalar in zip(subscripts(sizes, entry.span), scalars):
        name = quantity.name(subscript)
        entry.objects.append(objects.Output(name, scalar.node, *quantity.units, *quantity.span_and_text))
    return value


def _is_boolean(declaration: tree.Quantities) -> bool:
    """Return whether it declares discrete truth values."""
    declared = declaration.type
    return declaration.kind == "discrete" and declared is not None and declared.path == ("Boolean",)


def _discrete(context: Context, quantity: Quantity) -> Value:
    from lagc.semantics.declarations.events import declare_discrete  # where there are some

    return declare_discrete(context, quantity)


_DECLARE: dict[str, Callable[[Context, Quantity], Value]] = {
    "constant": _constant, "structural": _constant, "parameter": _parameter, "input": _input,
    "coordinate": _coordinate, "speed": _speed, "discrete": _discrete, "output": _output,
}  # fmt: skip


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
    names, rates = ([symbol.record.name for symbol in part] for part in ((w, x, y, z), (a, b, c)))
    identity, at_rest = (one, zero, zero, zero), (zero, zero, zero)
    start, start_stated = _numbers(context, entry, attributes, identity, NONE, "start", names)
    turning, rate_stated = _numbers(context, entry, attributes, at_rest, over(NONE, S), "rate", rates)
    whole = [max(start_stated, key=lambda s: s.level)]  # one statement for all four components
    whole, rate_stated = with_fixed(context, attributes, [], whole, rate_stated)
    rate = turning[0], turning[1], turning[2]
    initial = _unit(context, entry, start), rate, whole[0], (rate_stated[0], rate_stated[1], rate_stated[2])
    about = entry.span, source.description or "", entry.effect
    orientation = Orientation(name, (w, x, y, z), (a, b, c), *initial, *about)
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
    # Priority from weak to strong: default, the declaration, a guess instead, the scene as a whole, single
    # components.
    what = f"the {attribute} of `{entry.path}`"
    modifier = attributes.get(attribute)
    components, stated = list(default), [statement_of(entry, modifier)] * len(default)
    modifier = guess_instead(attributes, attribute) or modifier
    # The scene or the command may give all components at once,
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
        components = [scalar.node for scalar in scalars]
    # or single ones by name, which go first.
    for k, name in enumerate(names):
        one = context.give(context.starts, name)
        if one is not None:
            components[k] = given_scalar(context, one, dimension, f"the start of `{name}`").node
            stated[k] = from_outside(entry, one)
    return components, stated


def _unit(context: Context, entry: Entry, start: list[Node]) -> tuple[Node, Node, Node, Node]:
    """Return the initial value as a unit quaternion.  Raises Wrong if its norm is zero."""
    w, x, y, z = start
    square = w * w + x * x + y * y + z * z
    if square.is_const:
        length = math.sqrt(square.value)
        if length < _SMALLEST:
            message = f"the initial value of `{entry.path}` is zero; a quaternion needs a norm above zero"
            raise Wrong("LAG0309", message, entry.span)
        if length == 1.0:
            return (w, x, y, z)
    norm = context.graph.sqrt(square)
    return (w / norm, x / norm, y / norm, z / norm)
