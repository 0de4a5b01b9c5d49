"""What a type name in a declaration means."""

from __future__ import annotations

from lagc.base.records import replace
from lagc.diagnostics.suggest import did_you_mean, foreign_type
from lagc.semantics.names.namespace import Namespace
from lagc.semantics.types.refusals import Wrong
from lagc.semantics.types.types import TYPES, QuantityType, quantity_type
from lagc.semantics.types.units import UnknownUnit, si_text, unit
from lagc.syntax import tree

DEEPEST = 32  # types that stand for types


def type_of(name: tree.TypeName | None, space: Namespace, depth: int = 0) -> QuantityType:
    """The quantity type that a declaration names; without one, a number.  Raises Wrong."""
    if name is None:
        return TYPES["Real"]
    if name.unit is not None:
        if name.path != ("Real",):
            raise Wrong("LAG0203", "a unit in brackets follows `Real` only", name.span, "write `Real[...]`")
        return _real(name.unit)
    declared = space.lookup(name.path[0])
    if declared is None and len(name.path) == 1:
        if name.path[0] in TYPES:
            return TYPES[name.path[0]]
        known = [*TYPES, *space.known()]
        remedy = foreign_type(name.path[0]) or did_you_mean(name.path[0], known)
        raise Wrong("LAG0203", f"there is no type `{name.path[0]}`", name.span, remedy)
    found, where = space.find(name.path, name.span, "type")
    if not isinstance(found, tree.TypeDeclaration):
        raise Wrong("LAG0203", f"`{'.'.join(name.path)}` is not a type of quantity", name.span)
    if depth > DEEPEST:
        raise Wrong("LAG0205", f"the type `{found.name}` is defined by itself", found.name_span)
    return replace(type_of(found.definition, where, depth + 1), name=found.name)


def _real(written: tree.Unit) -> QuantityType:
    text = written.text.strip()
    try:
        meant = unit(text or "1")
    except UnknownUnit as unknown:
        raise Wrong(
            "LAG0304",
            unknown.reason,
            written.span,
            remedy=unknown.remedy,
        ) from None
    if meant.factor != 1.0:
        return quantity_type("Real", si_text(meant.dimension), text)
    return quantity_type("Real", "" if text == "1" else text)
