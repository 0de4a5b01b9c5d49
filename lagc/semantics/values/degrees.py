"""Numbers given to angles that were perhaps meant in degrees."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TypeAlias

from lagc.diagnostics.faults import Fault
from lagc.syntax import tree

Models: TypeAlias = Mapping[str, Sequence[tree.Declaration]]  # what is declared in each
_NAMED = (tree.ModelDeclaration, tree.Package)
_MANY = 10  # radians: more than a turn and a half, and in degrees a usual angle


def whole_radians(file: tree.Tree) -> list[Fault]:
    """Warnings: whole numbers of many radians, written without a unit, that a file gives to its angles."""
    named = [(d.name, [*_own(d.body)]) for d in _within(file.declarations) if isinstance(d, _NAMED)]
    models = dict(named)  # by what is extended: of models of one name in several packages the last
    found: list[Fault] = []
    for own in (list(_own(file.declarations)), *(body for _, body in named)):
        many = [(name, fault) for d in own for name, value in _given(d) if (fault := _whole(name, value))]
        angles = _angles(own, models) if many else ()
        found += [fault for name, fault in many if name in angles]
    return found


def _angles(own: Sequence[tree.Declaration], models: Models) -> set[str]:
    """The names of the angles among declarations and those of the models of the file that they extend."""
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
    """Those of one block, with what stands in its effects, scenes and loops."""
    for d in declarations:
        yield d
        if isinstance(d, (tree.Effect, tree.Scene, tree.ForLoop)):
            yield from _own(d.body)


def _given(d: tree.Declaration) -> Iterator[tuple[str, tree.Expression | None]]:
    """The names that a declaration gives values to."""
    if isinstance(d, tree.Start) and isinstance(d.target, tree.Name):
        yield d.target.name, d.value
    elif isinstance(d, tree.Quantities):
        for declarator in d.declarators:
            yield declarator.name, declarator.value
            yield from ((declarator.name, a.value) for a in declarator.arguments if a.name == "start")


def _whole(name: str, value: tree.Expression | None) -> Fault | None:
    number = value.operand if isinstance(value, tree.Unary) else value
    sign = "-" if isinstance(value, tree.Unary) and value.op == "-" else ""
    if not isinstance(number, tree.Number) or number.value < _MANY or not number.value.is_integer():
        return None
    return Fault(
        "LAG0618",
        f"`{name}` is {sign}{number.text} radians",
        number.span,
        remedy=f"if degrees are meant, write `{number.text} [deg]`, else `{number.text} [rad]`",
        severity="warning",
    )
