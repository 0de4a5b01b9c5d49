"""Numbers without a unit: where they take one from what they are given to, and where they do not."""

from __future__ import annotations

from lagc.frontend import tree
from lagc.meaning.units import NONE, Dimension, si_text


def is_bare(expression: tree.Expression) -> bool:
    """Whether an expression is made of numbers without units alone: `-2`, `{1, 0}`, `2/5`."""
    stack = [expression]
    while stack:
        top = stack.pop()
        if isinstance(top, tree.Unary):
            stack.append(top.operand)
        elif isinstance(top, tree.Binary):
            stack += [top.left, top.right]
        elif isinstance(top, tree.Vector):
            stack += top.elements
        elif not isinstance(top, tree.Number):
            return False
    return True


def unit_remedy(expression: tree.Expression, wanted: Dimension | None) -> str | None:
    """What to write in place of a bare number where a quantity of dimension `wanted` is meant."""
    if wanted is None or wanted == NONE or not is_bare(expression):
        return None
    span = expression.span
    text, unit = span.source.text[span.start : span.end], si_text(wanted)
    if isinstance(expression, tree.Binary):
        return f"a bare number has no unit within an expression: write `{text}*1 [{unit}]`"
    return f"a bare number has no unit within an expression: write `{text} [{unit}]`"
