"""Calls of built-in functions and of those of the model and its packages; constants and types of files."""

from collections.abc import Iterable
from functools import cache, partial

from lagc.base.records import replace
from lagc.diagnostics.faults import Poisoned, Span, Wrong
from lagc.diagnostics.suggest import (
    did_you_mean,
    foreign,
    foreign_call,
    keeps_argument,
    meant_argument,
    remedy_of_surplus,
    remedy_of_word,
)
from lagc.semantics.context import Context
from lagc.semantics.names.namespace import Declared, Namespace
from lagc.semantics.names.scope import Entry, Environment, Instance, Scalar, Value, expect, flat
from lagc.semantics.units import TYPES, QuantityType, UnknownUnit, quantity_type, si_text, unit
from lagc.semantics.values import functions
from lagc.semantics.values.evaluate import Argument, all_values, each, evaluate, evaluate_as
from lagc.semantics.values.functions import RESERVED, Builtin
from lagc.semantics.values.unit_hints import is_bare
from lagc.syntax import tree


def constant_of(
    context: Context, declared: tree.Quantities, space: Namespace, name: str, span: Span
) -> Value:
    """Return the value of a `constant` of a file or a package.  Raises Wrong."""
    declarator = next(d for d in declared.declarators if d.name == name)
    if declared.kind != "constant":
        message = f"`{name}` is a {declared.kind} outside of a model"
        remedy = "declare it in a model, or as a `constant`"
        related = ((declarator.name_span, "declared here"),)
        raise Wrong("LAG0221", message, span, remedy, related)
    if declared.type is None:
        message = f"`constant` needs a type and a name; there is only `{name}`"
        remedy = f"write `constant Real {declarator.span.text};`, or a type such as `Mass`"
        raise Wrong("LAG0133", message, declarator.name_span, remedy)
    if declarator.value is None:
        raise Wrong("LAG0210", f"the constant `{name}` has no value", declarator.name_span)
    # A constant is evaluated once, among the declarations of its own file.
    key = (id(declarator), "constant")
    if key in context.running:
        raise Wrong("LAG0205", f"`{name}` depends on itself", span)
    if key not in context.constants:
        context.running.add(key)
        try:
            meant = type_of(declared.type, space)
            value = evaluate_as(
                context, declarator.value, space_only(space, declarator.span), meant.dimension
            )
        finally:
            context.running.discard(key)
        for scalar in flat(value, declarator.value.span, "a constant"):
            expect(scalar.dimension, meant.dimension, declarator.value.span, f"`{name}`")
        context.constants[key] = value
    return context.constants[key]


def package_constant(context: Context, e: tree.Member, environment: Environment) -> Value | None:
    """Return the constant of a package, `lib.g`, or None if `e` is not such a path."""
    path = dotted_path(e)
    if path is None or _is_here(path[0], environment):
        return None
    declared = environment.space.lookup(path[0])
    if declared is None or not isinstance(declared[0], tree.Package):
        return None
    found, space = environment.space.find(path, e.span, "constant")
    return constant_outside(context, found, space, path[-1], e.span)


def constant_outside(context: Context, declared: Declared, space: Namespace, name: str, span: Span) -> Value:
    """Return the value of a constant of a file or a package.  Raises Wrong for anything else."""
    if isinstance(declared, tree.Quantities):
        return constant_of(context, declared, space, name, span)
    kinds = {
        tree.ModelDeclaration: "a model",
        tree.Package: "a package",
        tree.TypeDeclaration: "a type",
        tree.FunctionDeclaration: "a function",
    }
    raise Wrong("LAG0221", f"`{name}` is {kinds[type(declared)]}, not a value", span)


def _is_here(name: str, environment: Environment) -> bool:
    return name in environment.bindings or name in environment.instance.entries


def dotted_path(e: tree.Expression) -> tuple[str, ...] | None:
    """Return ("a", "b", "c") for `a.b.c`; None for anything else."""
    names: list[str] = []
    while isinstance(e, tree.Member):
        names.append(e.name)
        e = e.base
    if not isinstance(e, tree.Name):
        return None
    return (e.name, *reversed(names))


def space_only(space: Namespace, span: Span) -> Environment:
    """Return an environment that contains only the declarations of files and packages."""
    nowhere = tree.ModelDeclaration("", span, False, None, (), span)
    return Environment(Instance("", nowhere, None), space)


DEEPEST_TYPES = 32  # chain of type definitions


def type_of(name: tree.TypeName | None, space: Namespace, depth: int = 0) -> QuantityType:
    """Return the quantity type of a declaration; a number if it has none.  Raises Wrong."""
    # Types are looked up by scope: a unit in brackets, a built-in quantity, a type of the file or of an
    # import.
    if name is None:
        return TYPES["Real"]
    if name.unit is not None:
        if name.path != ("Real",):
            raise Wrong("LAG0203", "only `Real` takes a unit in brackets", name.span, "write `Real[...]`")
        return _real(name.unit)
    declared = space.lookup(name.path[0])
    if declared is None and len(name.path) == 1:
        if name.path[0] in TYPES:
            return TYPES[name.path[0]]
        known = [*TYPES, *space.known()]
        remedy = remedy_of_word("types", name.path[0]) or did_you_mean(name.path[0], known)
        raise Wrong("LAG0203", f"there is no type `{name.path[0]}`", name.span, remedy)
    # A built-in type in the spelling of another language is named in the remedy.
    built_in = foreign("types").get(name.path[-1], name.path[-1])
    if declared is None and built_in in TYPES:
        message = f"there is no type `{'.'.join(name.path)}`"
        remedy = f"the types of quantities are built in: write `{built_in}`"
        raise Wrong("LAG0203", message, name.span, remedy)
    found, where = space.find(name.path, name.span, "type")
    if not isinstance(found, tree.TypeDeclaration):
        raise Wrong("LAG0203", f"`{'.'.join(name.path)}` is not a type of quantity", name.span)
    if depth > DEEPEST_TYPES:
        message = f"the definition of the type `{found.name}` uses `{found.name}` itself"
        raise Wrong("LAG0205", message, found.name_span)
    return replace(type_of(found.definition, where, depth + 1), name=found.name)


def _real(written: tree.Unit) -> QuantityType:
    text = written.text.strip()
    try:
        meant = unit(text or "1")
    except UnknownUnit as unknown:
        from lagc.semantics.values.unit_hints import spelling_remedy  # where there is a fault

        size = (
            f"the size of an array follows its name: `x[{text}]`" if text.isdigit() else spelling_remedy(text)
        )
        raise Wrong("LAG0304", unknown.reason, written.span, size) from None
    if meant.factor != 1.0:
        return quantity_type("Real", si_text(meant.dimension), text)
    return quantity_type("Real", "" if text == "1" else text)


DEEPEST = 64  # nesting of calls
MOST_CALLS = 50_000  # calls of the user's functions in one model
LONGEST = 64  # arguments of one call


@cache
def builtins() -> dict[str, Builtin]:
    """Return the built-in functions by name."""
    from lagc.semantics.values import kinematics  # loaded for a name that is no function of numbers

    return {**functions.TABLE, **kinematics.TABLE, **functions.TABLES}


def _builtin(name: str) -> Builtin | None:
    return functions.TABLE.get(name) or builtins().get(name)


def shortest_call(name: str) -> str | None:
    """Return the shortest call of a built-in function, `velocity(of)`, or None."""
    builtin = _builtin(name)
    if builtin is None:
        return None
    return f"{name}({', '.join(builtin.parameters[: builtin.required])})"


def call(context: Context, e: tree.Call, environment: Environment) -> Value:
    """Return the value of a call.  Raises Wrong."""
    if len(e.arguments) > LONGEST:
        raise Wrong("LAG0209", f"the call has more than {LONGEST} arguments", e.span)
    try:
        called, arguments = _function_of(context, e, environment)
    except (Wrong, Poisoned):
        look_at_arguments(context, e, environment)
        raise
    if not isinstance(called, Builtin):
        return _inline(context, e, environment, *called, arguments)
    filled = iter(all_values(context, [a for a in arguments if a is not None], environment))
    given = [None if a is None else Argument(next(filled), a.span, is_bare(a)) for a in arguments]
    return _apply(context, called, e, given)


def _function_of(
    context: Context, e: tree.Call, environment: Environment
) -> tuple[Builtin | tuple[tree.FunctionDeclaration, Environment], list[tree.Expression | None]]:
    """Return the called function, and its arguments in the order of its parameters.  Raises Wrong,
    Poisoned."""
    own = _declared_function(context, e, environment)
    if own is not None:
        names = _parameters(own[0])
        return own, match(context, e, names, len(names), f"`{own[0].name}`")
    name = e.function.name if isinstance(e.function, tree.Name) else ""
    builtin = _builtin(name)
    if builtin is None:
        raise _unknown(name, e, environment)
    return builtin, match(context, e, builtin.parameters, builtin.required, f"`{name}`")


def look_at_arguments(context: Context, e: tree.Call, environment: Environment) -> None:
    """Report the faults in the arguments of a call that has a fault itself."""
    name = e.function.name if isinstance(e.function, tree.Name) else ""
    for k, argument in enumerate(e.arguments[:LONGEST]):
        if argument.value is not None and (_builtin(name) or keeps_argument(name, k)):
            context.attempt(evaluate, context, argument.value, environment)


def _apply(context: Context, builtin: Builtin, e: tree.Call, given: list[Argument | None]) -> Value:
    try:
        return builtin.apply(context, e.span, *given)
    except (ZeroDivisionError, OverflowError, ValueError):
        raise Wrong("LAG0309", "the value is not finite", e.span) from None


def match(
    context: Context, e: tree.Call, parameters: tuple[str, ...], required: int, who: str
) -> list[tree.Expression | None]:
    """Return the arguments of a call in the order of the parameters; None for one that is left out. A last
    parameter `*` takes all further arguments.  Raises Poisoned after all faults are reported."""
    by_name: dict[str, tree.Expression] = {}
    many: list[tree.Expression | None] = []
    wrong: list[Wrong] = []
    # All faults of the arguments are collected: too many, unknown or repeated names,
    allowed = LONGEST if parameters[-1:] == ("*",) else len(parameters)
    more = [argument for argument in e.arguments[allowed:] if argument.name is None]
    if more:
        remedy = remedy_of_surplus(who.strip("`"), [argument.span.text for argument in e.arguments])
        message = f"{who} takes {_count(parameters)}; more are given"
        remedy = remedy or (f"the arguments are ({', '.join(parameters)})" if parameters else None)
        wrong.append(Wrong("LAG0209", message, more[0].span, remedy))
    for position, argument in enumerate(e.arguments):
        if argument in more:
            continue
        try:
            name = _parameter(argument, position, parameters, who)
            if name in by_name:
                raise Wrong("LAG0209", f"the argument `{name}` is given twice", argument.span)
        except Wrong as one:
            wrong.append(one)
            continue
        assert argument.value is not None
        if name == "*":
            many.append(argument.value)
        else:
            by_name[name] = argument.value
    # and what is missing, unless a wrong name may be the missing one.
    missing = [p for p in parameters[:required] if p not in by_name and p != "*"]
    if not wrong and (missing or required > len(by_name) + len(many)):
        lacking = missing[0] if missing else "another"
        listed = ", ".join("..." if p == "*" else p for p in parameters)
        remedy = f"the arguments are ({listed})" if len(parameters) > 1 else None
        wrong.append(Wrong("LAG0210", f"{who} needs the argument `{lacking}`", e.span, remedy))
    for fault in wrong:
        context.report(fault)
    if wrong:
        raise Poisoned
    ordered = [by_name.get(p) for p in parameters if p != "*"]
    return [*ordered, *many]


def _parameter(argument: tree.Argument, position: int, parameters: tuple[str, ...], who: str) -> str:
    """Return the parameter of an argument.  Raises Wrong."""
    if argument.value is None or argument.arguments:
        raise Wrong("LAG0209", "this argument has no value", argument.span)
    if argument.name is None:
        if parameters and parameters[-1] == "*" and position >= len(parameters) - 1:
            return "*"
        return parameters[position]
    if argument.name not in parameters or argument.name == "*":
        known = [p for p in parameters if p != "*"]
        listed = f"it takes {', '.join(f'`{p}`' for p in known)}" if known else None
        message = f"{who} has no argument `{argument.name}`"
        remedy = meant_argument(argument.name, known) or listed
        raise Wrong("LAG0209", message, argument.name_span or argument.span, remedy)
    return argument.name


def _count(parameters: tuple[str, ...]) -> str:
    if not parameters:
        return "no argument"
    return f"{len(parameters)} argument{'' if len(parameters) == 1 else 's'}"


def _declared_function(
    context: Context, e: tree.Call, environment: Environment
) -> tuple[tree.FunctionDeclaration, Environment] | None:
    """Return the called function of the user and its environment, or None."""
    function = e.function
    path = dotted_path(function)
    if path is None:
        raise Wrong("LAG0201", "this is not a function", function.span)
    # A plain name: a function of the model, of the file or of an import; else a built-in one.
    if len(path) == 1:
        entry = environment.instance.entries.get(path[0])
        if entry is not None:
            if isinstance(entry.source, tree.FunctionDeclaration):
                return entry.source, entry.environment
            message = f"`{path[0]}` is a {entry.kind}, not a function"
            related = ((entry.span, "declared here"),)
            raise Wrong("LAG0221", message, function.span, related=related)
        declared = environment.space.lookup(path[0])
        if declared is None:
            return None
    elif path[0] in environment.instance.entries or path[0] in environment.bindings:
        raise Wrong("LAG0221", f"`{'.'.join(path)}` is not a function", function.span)
    # A path that leads nowhere: perhaps a built-in function, written as in a library of another language.
    if len(path) > 1 and environment.space.lookup(path[0]) is None:
        texts = [argument.span.text for argument in e.arguments]
        remedy = f"write `{path[-1]}`" if path[-1] in builtins() else foreign_call(path[-1], texts)
        remedy = remedy or did_you_mean(path[-1], builtins())
        raise Wrong("LAG0203", f"there is no function `{'.'.join(path)}`", function.span, remedy)
    found, space = environment.space.find(path, function.span, "function")
    if not isinstance(found, tree.FunctionDeclaration):
        if len(path) == 1 and path[0] in builtins():
            return None
        raise Wrong("LAG0221", f"`{'.'.join(path)}` is not a function", function.span)
    return found, space_only(space, found.span)


def _parameters(function: tree.FunctionDeclaration) -> tuple[str, ...]:
    """Return the names of the parameters.  Raises Wrong."""
    names = tuple(name for _, name, _ in function.parameters)
    for k, (_, name, span) in enumerate(function.parameters):
        if name in names[:k]:
            first = function.parameters[names.index(name)][2]
            raise Wrong("LAG0202", f"`{name}` is declared twice", span, related=((first, "first here"),))
    return names


def _inline(
    context: Context,
    e: tree.Call,
    environment: Environment,
    function: tree.FunctionDeclaration,
    scope: Environment,
    arguments: list[tree.Expression | None],
) -> Value:
    # Arguments are evaluated where the call is, the body where the function is declared.
    names = _parameters(function)
    types = [type_of(t, scope.space) for t, _, _ in function.parameters]
    written = [a for a in arguments if a is not None]  # all, since none is optional

    def value_of(pair: tuple[tree.Expression, QuantityType]) -> Value:
        return evaluate_as(context, pair[0], environment, pair[1].dimension)

    # The arguments have the dimensions of the declared parameters.
    values = each(context, value_of, list(zip(written, types)))
    for value, meant, argument, (_, name, span) in zip(values, types, written, function.parameters):
        for scalar in flat(value, argument.span, f"the argument `{name}`"):
            try:
                expect(scalar.dimension, meant.dimension, argument.span, f"the argument `{name}`")
            except Wrong as wrong:
                fault = wrong.fault
                raise Wrong(
                    fault.code, fault.message, fault.span, related=((span, "declared here"),)
                ) from None
    key = (scope.instance.path, id(function), tuple(values))
    # The body is evaluated with the values as bindings: the function is inlined.
    known = context.results.get(key)  # the same arguments give the same nodes
    if known is not None:
        return known
    context.called.add(id(function))
    _enter(context, e, function)
    try:
        inner = Environment(scope.instance, scope.space, dict(zip(names, values)))
        context.results[key] = evaluate(context, function.body, inner)
        return context.results[key]
    except Wrong as wrong:
        context.report(wrong)
        raise Poisoned from None
    finally:
        context.callers.pop()


def look_at_uncalled(context: Context, entries: Iterable[Entry]) -> None:
    """Report unknown names in functions that are never called. Other faults are not reported, because the
    kinds of the arguments are unknown."""
    for entry in entries:
        function = entry.source
        if not isinstance(function, tree.FunctionDeclaration) or id(function) in context.called:
            continue
        context.called.add(id(function))
        bindings: dict[str, Value] = {
            name: Scalar(context.graph.symbol("parameter", name), None) for _, name, _ in function.parameters
        }
        inner = Environment(entry.environment.instance, entry.environment.space, bindings)
        context.look(partial(evaluate, context, function.body, inner), ("LAG0201",))


def _enter(context: Context, e: tree.Call, function: tree.FunctionDeclaration) -> None:
    """Count one more nested call.  Raises Wrong if there are too many."""
    # Endless recursion would never return: calls are counted, and their nesting is limited.
    if context.all_calls > MOST_CALLS:
        raise Poisoned
    context.all_calls += 1
    context.callers.append(e.span)
    related = ((function.name_span, "declared here"),)
    if len(context.callers) > DEEPEST:
        context.callers.pop()
        context.all_calls = MOST_CALLS + 1  # stop further calls, which would not end either
        message = f"`{function.name}` calls itself, or functions are nested deeper than {DEEPEST}"
        raise Wrong("LAG0225", message, e.span, related=related)
    if context.all_calls > MOST_CALLS:
        context.callers.pop()
        message = f"the model calls functions more than {MOST_CALLS} times"
        raise Wrong("LAG0218", message, e.span, related=related)


def _unknown(name: str, e: tree.Call, environment: Environment) -> Wrong:
    span = e.function.span
    if name in RESERVED:
        return Wrong("LAG0220", f"`{name}` is not yet supported", span, foreign("calls")[name])
    if name in environment.instance.unused:
        return Wrong("LAG0214", f"`{name}` {environment.instance.unused[name]}", span)
    if name in ("Particle", "Solid", "Gravity"):
        message = f"`{name}` is only allowed as the whole value of a declaration"
        remedy = f"write `body b = {name}(...);`" if name != "Gravity" else "write `Gravity field;`"
        return Wrong("LAG0221", message, span, remedy)
    functions = [n for n, entry in environment.instance.entries.items() if entry.kind == "function"]
    meant = foreign_call(name, [argument.span.text for argument in e.arguments])
    meant = meant or did_you_mean(name, [*functions, *builtins(), *environment.space.known()])
    return Wrong("LAG0201", f"there is no function `{name}`", span, meant)
