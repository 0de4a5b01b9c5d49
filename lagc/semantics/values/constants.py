"""Constants and types that files and packages declare."""

from __future__ import annotations

from lagc.base.records import replace
from lagc.diagnostics.faults import Span
from lagc.diagnostics.suggest import did_you_mean, foreign, remedy_of_word
from lagc.semantics.context import Context
from lagc.semantics.names.namespace import Declared, Namespace
from lagc.semantics.names.scope import Environment, Instance, Value, expect, flat
from lagc.semantics.refusals import Wrong
from lagc.semantics.units import TYPES, QuantityType, UnknownUnit, quantity_type, si_text, unit
from lagc.semantics.values.evaluate import evaluate_as
from lagc.syntax import tree


def constant_of(
    context: Context, declared: tree.Quantities, space: Namespace, name: str, span: Span
) -> Value:
    """Return the value of a `constant` of a file or a package.  Raises Wrong."""
    declarator = next(d for d in declared.declarators if d.name == name)
    if declared.kind != "constant":
        raise Wrong(
            "LAG0221",
            f"`{name}` is a {declared.kind} outside of a model",
            span,
            related=((declarator.name_span, "declared here"),),
            remedy="declare it in a model, or as a `constant`",
        )
    if declared.type is None:
        message = f"`constant` needs a type and a name; there is only `{name}`"
        remedy = f"write `constant Real {declarator.span.text};`, or a type such as `Mass`"
        raise Wrong("LAG0133", message, declarator.name_span, remedy)
    if declarator.value is None:
        raise Wrong("LAG0210", f"the constant `{name}` has no value", declarator.name_span)
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


def packaged(context: Context, e: tree.Member, environment: Environment) -> Value | None:
    """Return the constant of a package, `lib.g`, or None if `e` is not such a path."""
    path = dotted(e)
    if path is None or _is_here(path[0], environment):
        return None
    declared = environment.space.lookup(path[0])
    if declared is None or not isinstance(declared[0], tree.Package):
        return None
    found, space = environment.space.find(path, e.span, "constant")
    return outside(context, found, space, path[-1], e.span)


def outside(context: Context, declared: Declared, space: Namespace, name: str, span: Span) -> Value:
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


def dotted(e: tree.Expression) -> tuple[str, ...] | None:
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


DEEPEST = 32  # chain of type definitions


def type_of(name: tree.TypeName | None, space: Namespace, depth: int = 0) -> QuantityType:
    """Return the quantity type of a declaration; a number if it has none.  Raises Wrong."""
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
    built_in = foreign("types").get(name.path[-1], name.path[-1])
    if declared is None and built_in in TYPES:
        message = f"there is no type `{'.'.join(name.path)}`"
        remedy = f"the types of quantities are built in: write `{built_in}`"
        raise Wrong("LAG0203", message, name.span, remedy)
    found, where = space.find(name.path, name.span, "type")
    if not isinstance(found, tree.TypeDeclaration):
        raise Wrong("LAG0203", f"`{'.'.join(name.path)}` is not a type of quantity", name.span)
    if depth > DEEPEST:
        message = f"the definition of the type `{found.name}` uses `{found.name}` itself"
        raise Wrong("LAG0205", message, found.name_span)
    return replace(type_of(found.definition, where, depth + 1), name=found.name)


def _real(written: tree.Unit) -> QuantityType:
    text = written.text.strip()
    try:
        meant = unit(text or "1")
    except UnknownUnit as unknown:
        from lagc.semantics.unit_spellings import unit_remedy  # where there is a fault

        size = f"the size of an array follows its name: `x[{text}]`" if text.isdigit() else unit_remedy(text)
        raise Wrong("LAG0304", unknown.reason, written.span, size) from None
    if meant.factor != 1.0:
        return quantity_type("Real", si_text(meant.dimension), text)
    return quantity_type("Real", "" if text == "1" else text)
