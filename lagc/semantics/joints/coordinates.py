"""The coordinates of a joint, as declarations of an instance of their own: `knee.angle`."""

from __future__ import annotations

from lagc.semantics.joints.linkage import attributes_in, kind_of
from lagc.semantics.names.scope import Entry, Environment, Instance, Modifier
from lagc.semantics.refusals import Wrong
from lagc.syntax import tree


def coordinates_of(joint: Entry, instance: Instance) -> list[Entry]:
    """Return the entries of the coordinates that the joint brings if it is open.  Raises Wrong."""
    source = joint.source
    assert isinstance(source, tree.Construct)
    _, kind = kind_of(source)
    assert isinstance(source.value, tree.Call)
    given: dict[str, tuple[tree.Argument, ...]] = {}
    for argument in source.value.arguments:
        found = attributes_in(argument, kind)
        if found is not None:
            if found[0] in given:
                raise Wrong("LAG0209", f"`{found[0]}` is given twice", argument.span)
            given[found[0]] = found[1]
    inner = Instance(f"{joint.path}.", instance.declaration, instance, instance.depth + 1)
    span, environment = source.name_span, joint.environment
    for name, type_name in kind.coordinates.items():
        declarator = tree.Declarator(name, span, (), (), None, f"{name} of the joint `{joint.path}`", span)
        declaration = tree.Quantities(
            "coordinate", tree.TypeName((type_name,), None, span), (declarator,), (), span
        )
        place = Environment(inner, environment.space, environment.bindings)
        entry = Entry("coordinate", name, declaration, declarator, place, joint.effect)
        entry.modifiers = [
            Modifier(tree.Argument(name, span, None, span, False, given.get(name, ())), environment)
        ]
        inner.entries[name] = entry
    return list(inner.entries.values())
