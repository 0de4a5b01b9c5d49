"""Nodes of the syntax tree for expressions."""

from __future__ import annotations

import math
from typing import Any, TypeAlias, TypeVar

from lagc.base.records import replace
from lagc.diagnostics.faults import Fault, Source, Span
from lagc.syntax import tree
from lagc.syntax.tokens import Token

_PARTS = (tree.Name, tree.Member, tree.Index, tree.Call)
MOST_PARTS = 100  # parts of one name, `a.b[1].c`

Children: TypeAlias = list[Any]
T = TypeVar("T")


class Expressions:
    """Builds the expressions of `source`; `faults` are those that the grammar does not find."""

    def __init__(self, source: Source):
        self.source = source
        self.faults: list[Fault] = []
        # Number of parts of a name, by identity; the name is kept alive, as identities are reused.
        self._parts: dict[int, tuple[object, int]] = {}

    def arguments(self, c: Children, span: Span) -> tuple[tree.Argument, ...]:
        return tuple(argument for argument in c if argument is not None)

    def argument(self, c: Children, span: Span) -> tree.Argument:
        each, left, value = c
        if value is None and each is None:
            return tree.Argument(None, None, left, span)
        if isinstance(left, tree.Name):
            return tree.Argument(left.name, left.span, value, span, each is not None)
        if isinstance(left, tree.Call) and isinstance(left.function, tree.Name):
            name = left.function
            return tree.Argument(name.name, name.span, value, span, each is not None, left.arguments)
        self.faults.append(
            Fault(
                "LAG0123",
                "what stands before the `=` of an argument is a name",
                left.span,
                remedy="write `name = value`, or `==` to compare",
            )
        )
        return tree.Argument(None, None, value or left, span)

    def subscripts(self, c: Children, span: Span) -> tuple[tree.Expression, ...]:
        return tuple(c)

    def range(self, c: Children, span: Span) -> tree.Range:
        first, second, third = c
        if third is None:
            return tree.Range(first, None, second, span)
        return tree.Range(first, second, third, span)

    def conditional(self, c: Children, span: Span) -> tree.Conditional:
        branches = tuple((c[i], c[i + 1]) for i in range(0, len(c) - 1, 2))
        return tree.Conditional(branches, c[-1], span)

    def binary(self, c: Children, span: Span) -> tree.Binary:
        left, op, right = c
        return tree.Binary(op.text, left, right, self._span(op), span)

    def unary(self, c: Children, span: Span) -> tree.Unary:
        return tree.Unary(c[0].text, c[1], span)

    def name(self, c: Children, span: Span) -> tree.Name:
        return tree.Name(c[0].text, span)

    def member(self, c: Children, span: Span) -> tree.Member:
        return self._part(tree.Member(c[0], c[1].text, self._span(c[1]), span), c[0])

    def index(self, c: Children, span: Span) -> tree.Index:
        base, indices = c
        if not isinstance(base, _PARTS) and isinstance(indices[0], tree.Name | tree.Binary):
            bracket = Span(self.source, indices[0].span.start - 1, span.end)
            if self.source.text[bracket.start - 1].isspace():
                message = "a unit follows a number, a vector in braces, or `Real`"
                self.faults.append(
                    Fault("LAG0121", message, bracket, remedy="write the unit inside the brackets")
                )
        return self._part(tree.Index(c[0], c[1], span), c[0])

    def call(self, c: Children, span: Span) -> tree.Call:
        return self._part(tree.Call(c[0], c[1], span), c[0])

    def call_of_family(self, c: Children, span: Span) -> tree.Call:
        function, family = c
        argument = tree.Argument(None, None, family, family.span)
        return self._part(tree.Call(function, (argument,), span), function)

    def parenthesised(self, c: Children, span: Span) -> tree.Expression:
        # The span includes the parentheses, so that the caret underlines them.
        inner: tree.Expression = c[0]
        node = replace(inner, span=span)
        if id(inner) in self._parts:
            self._parts[id(node)] = node, self._parts[id(inner)][1]
        return node

    def quantity(self, c: Children, span: Span) -> tree.Expression:
        value, unit = c
        return value if unit is None else tree.Quantity(value, self._unit(unit), span)

    def vector(self, c: Children, span: Span) -> tree.Vector:
        return tree.Vector(tuple(element for element in c if element is not None), span)

    def family(self, c: Children, span: Span) -> tree.Family:
        element, variable, values = c
        return tree.Family(element, variable.text, values, span)

    def family_in_braces(self, c: Children, span: Span) -> tree.Family:
        family: tree.Family = c[0]
        return replace(family, span=span)

    def number(self, c: Children, span: Span) -> tree.Number:
        text = c[0].text
        value = float(text)
        if math.isinf(value):
            message = "this number is too large: the largest is about 1.8e308"
            self.faults.append(Fault("LAG0105", message, span))
        return tree.Number(value, text, span)

    def string(self, c: Children, span: Span) -> tree.String:
        return tree.String(self._text(c[0]) or "", span)

    def boolean(self, c: Children, span: Span) -> tree.Boolean:
        return tree.Boolean(c[0].text == "true", span)

    # -- helpers -----------------------------------------------------------------------------

    def _span(self, token: Token) -> Span:
        return Span(self.source, token.start, token.end)

    def _unit(self, token: Token) -> tree.Unit:
        return tree.Unit(token.text[1:-1].strip(), self._span(token))

    def _text(self, token: Token | None) -> str | None:
        return None if token is None else unquoted(token.text)

    def _part(self, node: T, base: tree.Expression) -> T:
        parts = 1 + (self._parts[id(base)][1] if id(base) in self._parts else 1)
        self._parts[id(node)] = node, parts
        if parts == MOST_PARTS + 1:
            self._too_many_parts(base.span)
        return node

    def _too_many_parts(self, span: Span) -> None:
        self.faults.append(Fault("LAG0106", f"this name has more than {MOST_PARTS} parts", span))


def unquoted(text: str) -> str:
    """Return the text between the quotes, with escapes replaced."""
    inner = text[1:-1]
    if "\\" not in inner:
        return inner
    signs = {"n": "\n", "t": "\t", "r": "\r"}
    parts: list[str] = []
    escaped = False
    for character in inner:
        if escaped:
            parts.append(signs.get(character, character))
            escaped = False
        elif character == "\\":
            escaped = True
        else:
            parts.append(character)
    return "".join(parts)
