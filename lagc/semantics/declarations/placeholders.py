"""Placeholders: bodies, points and frames that each instance of a model gives, `Drag air(b = bob)`."""

from __future__ import annotations

from lagc.semantics.context import Context
from lagc.semantics.declarations.attributes import no_rates
from lagc.semantics.model import Body, Frame
from lagc.semantics.names.scope import (
    Entry,
    Indexed,
    Instance,
    Modifier,
    Value,
    expect,
    kind,
    vector_of,
    vector_value,
)
from lagc.semantics.refusals import Wrong
from lagc.semantics.units import M
from lagc.semantics.values.evaluate import evaluate_as
from lagc.semantics.values.members import element
from lagc.syntax import tree

KINDS = ("body", "point", "frame")


def placeholder_value(entry: Entry) -> Modifier:
    """Return the outermost argument that gives the placeholder its value.  Raises Wrong if there is none."""
    source = entry.source
    assert isinstance(source, tree.Placeholder)
    if source.kind not in KINDS:
        message = f"the {source.kind} `{entry.name}` needs a value"
        raise Wrong("LAG0210", message, entry.span, f"write `{source.kind} {entry.name} = ...;`")
    for modifier in entry.modifiers:
        if modifier.argument.value is not None:
            return modifier
        raise Wrong("LAG0210", f"`{entry.name}` needs a value", modifier.argument.span)
    inner = entry.environment.instance
    if inner.parent is not None:
        raise _not_given(inner, inner.parent)
    remedy = (
        f"write `{inner.declaration.name} name({entry.name} = ...)` in a model that has this {source.kind}"
    )
    remedy = f"give it here, `{source.kind} {entry.name} = ...;`, or {remedy}"
    raise Wrong("LAG0210", f"the {source.kind} `{entry.path}` is not given", entry.span, remedy)


def _not_given(inner: Instance, parent: Instance) -> Wrong:
    """The fault of an instance that lacks placeholders, at its own line, with all of them."""
    instance = parent.entries[inner.path[len(parent.path) : -1].partition("[")[0]]
    written, source = instance.declaration, instance.source
    assert isinstance(written, tree.Instance) and isinstance(source, tree.Declarator)
    missing = {e.span: e.source for e in inner.entries.values() if not e.modifiers}
    lacking = [(span, s) for span, s in missing.items() if isinstance(s, tree.Placeholder)]
    sizes = f"[{', '.join(map(_text, source.dimensions))}]" if source.dimensions else ""
    each = "each " if sizes else ""
    given = [_text(argument) for argument in source.arguments]
    given += [f"{each}{s.name} = {_candidate(parent, s.kind)}" for _, s in lacking]
    remedy = f"write `{'.'.join(written.type.path)} {source.name}{sizes}({', '.join(given)});`"
    lacks = " and ".join(f"the {s.kind} `{s.name}`" for _, s in lacking)
    related = tuple([(span, "declared here") for span, _ in lacking])
    return Wrong("LAG0210", f"`{instance.path}` is not given {lacks}", instance.span, remedy, related)


def _text(written: tree.Argument | tree.Expression) -> str:
    return written.span.text


def _candidate(parent: Instance, kind: str) -> str:
    """The only thing of the model that may be meant, or dots."""
    kinds = ("body", "point") if kind == "point" else (kind,)
    known = [e.name for e in parent.entries.values() if e.elements is None and _kind(e) in kinds]
    if not known and kind == "frame":
        return "world"
    return known[0] if len(known) == 1 else "..."


def _kind(entry: Entry) -> str:
    return entry.source.kind if isinstance(entry.source, tree.Placeholder) else entry.kind


def declare_placeholder(context: Context, entry: Entry) -> Value:
    """Return the body, point or frame that the instance gives.  Raises Wrong if it is of another kind."""
    modifier = placeholder_value(entry)
    source, written = entry.source, modifier.argument.value
    assert isinstance(source, tree.Placeholder) and written is not None
    value = evaluate_as(context, written, modifier.environment, M)
    if isinstance(value, Indexed) and modifier.index and not modifier.argument.each:
        index = tree.Index(written, (written,) * len(modifier.index), written.span)
        value = element(context, value, list(modifier.index), index)
    if source.kind == "point":
        vector, dimension = vector_of(value, written.span, "a point")
        expect(dimension, M, written.span, "a point")
        for node in vector:
            no_rates(context, node, written.span, "a point")
        return vector_value(vector, M)
    if not isinstance(value, Body if source.kind == "body" else Frame):
        message = f"`{entry.name}` of `{entry.environment.instance.declaration.name}` is a {source.kind}"
        related = ((entry.span, "declared here"),)
        raise Wrong("LAG0209", f"{message}; this is {kind(value)}", written.span, related=related)
    return value
