"""Placeholders: bodies, points and frames that each instance of a model gives, `Drag air(b = bob)`."""

from __future__ import annotations

from lagc.semantics.context import Context
from lagc.semantics.declarations.attributes import no_rates
from lagc.semantics.model import Body, Frame
from lagc.semantics.names.scope import Entry, Indexed, Modifier, Value, expect, kind, vector_of, vector_value
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
    owner, name = inner.declaration.name, inner.path.rstrip(".") or "name"
    remedy = f"write `{owner} {name}({entry.name} = ...)` in a model that has this {source.kind}"
    if not inner.path:
        remedy = f"give it here, `{source.kind} {entry.name} = ...;`, or {remedy}"
    raise Wrong("LAG0210", f"the {source.kind} `{entry.path}` is not given", entry.span, remedy)


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
