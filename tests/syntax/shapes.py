"""Trees without their places, to compare what two texts say."""

from typing import Any

from lagc.base.records import names
from lagc.diagnostics.faults import Source, Span
from lagc.syntax.parse import parse


def shape(node: Any) -> Any:
    """Nested tuples of everything but spans and sources."""
    if isinstance(node, Span | Source):
        return None
    if isinstance(node, tuple):
        return tuple(shape(part) for part in node)
    if hasattr(node, "__match_args__"):
        return (type(node).__name__, *(shape(getattr(node, name)) for name in names(node)))
    return node


def meaning(text: str) -> Any:
    return shape(parse(Source("x", text)))
