"""Numbers without a unit: where they take the unit of their declaration, and remedies where they do not."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import TypeAlias

from lagc.diagnostics.faults import Fault
from lagc.diagnostics.suggest import in_hertz, is_many_radians, many_radians
from lagc.semantics.names.scope import expect
from lagc.semantics.refusals import Wrong
from lagc.semantics.units import NONE, Dimension, name_of, over, si_text
from lagc.syntax import tree


def is_bare(expression: tree.Expression, units: bool = False) -> bool:
    """Whether an expression consists of numbers without units, `-2`, `{1, 0}`, `2/5`; `units`: or with
    them."""
    stack = [expression]
    while stack:
        top = stack.pop()
        if isinstance(top, tree.Unary):
            stack.append(top.operand)
        elif isinstance(top, tree.Binary):
            stack += [top.left, top.right]
        elif isinstance(top, tree.Vector):
            stack += top.elements
        elif units and isinstance(top, tree.Quantity):
            continue
        elif not isinstance(top, tree.Number):
            return False
    return True


def unit_remedy(expression: tree.Expression, wanted: Dimension | None) -> str | None:
    """Return a remedy for a number without a unit where a quantity of dimension `wanted` is needed."""
    if wanted is None or wanted == NONE or not is_bare(expression):
        return None
    span = expression.span
    text, unit = span.source.text[span.start : span.end], si_text(wanted)
    if isinstance(expression, tree.Binary):
        return f"a number inside an expression has no unit: write `{text}*1 [{unit}]`"
    return f"a number inside an expression has no unit: write `{text} [{unit}]`"


def expect_of(
    expression: tree.Expression, dimension: Dimension | None, wanted: Dimension, what: str, named: str
) -> None:
    """Check the dimension as `expect`; the remedy names the number that may lack a unit.  Raises Wrong."""
    try:
        expect(dimension, wanted, expression.span, what, named)
    except Wrong as wrong:
        factor = None if dimension is None else _lone_factor(expression)
        if factor is None or dimension is None:
            raise
        missing = over(wanted, dimension)
        if isinstance(factor, tree.Name):
            remedy = f"declare `{factor.name}` with its type: `parameter {name_of(missing)} {factor.name}`"
        else:
            remedy = f"a unit may be missing: `{factor.text} [{si_text(missing)}]` gives {named}"
        fault = wrong.fault
        raise Wrong(fault.code, fault.message, fault.span, remedy, fault.related) from None


def _lone_factor(expression: tree.Expression) -> tree.Number | tree.Name | None:
    """Return the only number without a unit among the factors of a product, as in `9.81*m*x` (not `1/2*m`),
    or the only factor that the same file declares as `parameter Real`."""
    found: list[tree.Number] = []
    names: list[tree.Name] = []
    stack = [expression]
    while stack:
        top = stack.pop()
        if isinstance(top, tree.Number):
            found.append(top)
        elif isinstance(top, tree.Name) and re.search(
            rf"\bparameter\s+Real\s+{top.name}\b", top.span.source.text
        ):
            names.append(top)
        elif isinstance(top, tree.Unary):
            stack.append(top.operand)
        elif isinstance(top, tree.Vector):
            stack += [part for part in top.elements if not is_bare(part) or part.span.text != "0"]
        elif isinstance(top, tree.Binary) and top.op == "*":
            stack += [top.left, top.right]
        elif isinstance(top, tree.Binary) and top.op == "/" and not is_bare(top):
            stack.append(top.left)
    if len(found) == 1 and found[0] is not expression:
        return found[0]
    return names[0] if len(names) == 1 else None


Models: TypeAlias = Mapping[str, Sequence[tree.Declaration]]  # declarations of each model
_NAMED = (tree.ModelDeclaration, tree.Package)


def whole_radians(file: tree.Tree) -> list[Fault]:
    """Return warnings for angles with large whole numbers of radians written without a unit."""
    named = [(d.name, [*_own(d.body)]) for d in _within(file.declarations) if isinstance(d, _NAMED)]
    models = dict(named)  # by name; of equal names in several packages the last
    found: list[Fault] = []
    for own in (list(_own(file.declarations)), *(body for _, body in named)):
        many = [(name, fault) for d in own for name, value in _given(d) if (fault := _whole(name, value))]
        angles = _angles(own, models) if many else ()
        found += [fault for name, fault in many if name in angles]
    return found


def angular_hertz(file: tree.Tree) -> list[Fault]:
    """Return warnings for angular velocities, or rates of angles, in hertz."""
    named = [_own(d.body) for d in _within(file.declarations) if isinstance(d, _NAMED)]
    return [
        fault
        for own in (_own(file.declarations), *named)
        for d in own
        if isinstance(d, tree.Quantities) and d.type is not None
        for name, value in _turning(d, d.type.path)
        if (fault := _hertz(name, value))
    ]


def _turning(d: tree.Quantities, kind: tuple[str, ...]) -> Iterator[tuple[str, tree.Expression | None]]:
    """Yield the angular velocities that a declaration gives values to."""
    for declarator in d.declarators:
        if kind == ("AngularVelocity",):
            yield declarator.name, declarator.value
            yield from ((declarator.name, a.value) for a in declarator.arguments if a.name == "start")
        elif kind == ("Angle",):
            yield from (
                (f"der({declarator.name})", a.value) for a in declarator.arguments if a.name == "rate"
            )


def _hertz(name: str, value: tree.Expression | None) -> Fault | None:
    if not isinstance(value, tree.Quantity) or not value.unit.text.strip().endswith("Hz"):
        return None
    return in_hertz(name, f"for a frequency write `2*pi*{value.span.text}`", value.span)


def _angles(own: Sequence[tree.Declaration], models: Models) -> set[str]:
    """Return the names of angles among declarations, inherited ones included."""
    found: set[str] = set()
    seen: set[str] = set()
    left = [own]
    while left:
        for d in left.pop():
            if isinstance(d, tree.Quantities) and d.type is not None and d.type.path == ("Angle",):
                found.update([declarator.name for declarator in d.declarators])
            elif isinstance(d, tree.Extends) and d.path[-1] in models and d.path[-1] not in seen:
                seen.add(d.path[-1])
                left.append(models[d.path[-1]])
    return found


def _within(declarations: Sequence[tree.Declaration]) -> Iterator[tree.Declaration]:
    for d in declarations:
        yield d
        if isinstance(d, _NAMED):
            yield from _within(d.body)


def _own(declarations: Sequence[tree.Declaration]) -> Iterator[tree.Declaration]:
    """Yield the declarations of one block and of its effects, scenes and loops."""
    for d in declarations:
        yield d
        if isinstance(d, (tree.Effect, tree.Scene, tree.ForLoop)):
            yield from _own(d.body)


def _given(d: tree.Declaration) -> Iterator[tuple[str, tree.Expression | None]]:
    """Yield the names that a declaration gives values to."""
    if isinstance(d, tree.Start) and isinstance(d.target, tree.Name):
        yield d.target.name, d.value
    elif isinstance(d, tree.Quantities):
        for declarator in d.declarators:
            yield declarator.name, declarator.value
            yield from ((declarator.name, a.value) for a in declarator.arguments if a.name == "start")


def _whole(name: str, value: tree.Expression | None) -> Fault | None:
    number = value.operand if isinstance(value, tree.Unary) else value
    sign = "-" if isinstance(value, tree.Unary) and value.op == "-" else ""
    if not isinstance(number, tree.Number) or not is_many_radians(number.value):
        return None
    return many_radians(name, number.text, sign, number.span)
