"""Numbers without a unit: where they take one from what they are given to, and where they do not."""

from __future__ import annotations

from lagc.semantics.names.scope import expect
from lagc.semantics.types.refusals import Wrong
from lagc.semantics.types.units import NONE, Dimension, over, si_text
from lagc.syntax import tree


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


def expect_of(
    expression: tree.Expression, dimension: Dimension | None, wanted: Dimension, what: str, named: str
) -> None:
    """`expect`, with the number named that seems to lack its unit.  Raises Wrong."""
    try:
        expect(dimension, wanted, expression.span, what, named)
    except Wrong as wrong:
        number = _lone_factor(expression)
        if number is None or dimension is None:
            raise
        unit = si_text(over(wanted, dimension))
        remedy = f"is a unit missing? `{number.text} [{unit}]` makes it {named}"
        fault = wrong.fault
        raise Wrong(fault.code, fault.message, fault.span, remedy, fault.related) from None


def _lone_factor(expression: tree.Expression) -> tree.Number | None:
    """The one number without a unit that multiplies the rest of a product, `9.81*m*x`; not `1/2*m`."""
    found: list[tree.Number] = []
    stack = [expression]
    while stack:
        top = stack.pop()
        if isinstance(top, tree.Number):
            found.append(top)
        elif isinstance(top, tree.Unary):
            stack.append(top.operand)
        elif isinstance(top, tree.Binary) and top.op == "*":
            stack += [top.left, top.right]
        elif isinstance(top, tree.Binary) and top.op == "/" and not is_bare(top):
            stack.append(top.left)
    return found[0] if len(found) == 1 and found[0] is not expression else None
