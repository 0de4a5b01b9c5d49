"""Nodes of the syntax tree.

One method for each grammar rule (or its alias).  The parser calls it with the rule's children in order (None
for an optional one that is not written) and the span of the whole.
"""

import math
import re
from collections.abc import Callable
from typing import Any, TypeAlias, TypeVar

from lagc.base.records import replace
from lagc.diagnostics.faults import Fault, Source, Span
from lagc.syntax import tree
from lagc.syntax.lexer import Token
from lagc.syntax.places import FILE, arrange

_PARTS = (tree.Name, tree.Member, tree.Index, tree.Call)
MOST_PARTS = 100  # parts of one name, `a.b[1].c`
_TYPES_TOO = frozenset({"Force", "Torque"})  # also types of quantities, and not only like keywords

Children: TypeAlias = list[Any]
T = TypeVar("T")


def _first_child(self: object, c: Children, span: Span) -> Any:
    return c[0]


def _word(self: object, c: Children, span: Span) -> Any:
    return c[0].text


def _all_children(self: object, c: Children, span: Span) -> tuple[Any, ...]:
    return tuple(c)


def _node(kind: Callable[..., Any]) -> Callable[[object, Children, Span], Any]:
    """Return the method of a rule whose children are the fields of a node."""
    return lambda self, c, span: kind(*c, span)


class Requires:
    """`requires a, b;`, until its effect is built."""

    def __init__(self, names: tuple[tree.Name, ...], span: Span):
        self.names = names
        self.span = span


class Excludes(Requires):
    """`excludes a, b;`."""


class Builder:
    """Builds the tree of `source`; `faults` are those that the grammar does not find."""

    uses = unless = relation = _first_child
    quantity_kind = construct_kind = _word
    items = declarators = parameters = names = path = subscripts = _all_children
    statement, annotation = _node(tree.Statement), _node(tree.Annotation)
    requires, excludes = _node(Requires), _node(Excludes)
    start, simulate = _node(tree.Start), _node(tree.Simulate)

    def __init__(self, source: Source):
        self.source = source
        self.faults: list[Fault] = []
        # Number of parts of a name, by identity; the name is kept alive, as identities are reused.
        self._parts: dict[int, tuple[object, int]] = {}

    # -- files and what holds other declarations ---------------------------------------

    def file(self, c: Children, span: Span) -> tree.Tree:
        return tree.Tree(self.source, arrange(c, FILE, self.faults))

    def model(self, c: Children, span: Span) -> tree.ModelDeclaration:
        partial, name, description, items, _ = c
        body = arrange(items, "a model", self.faults)
        shown = self._text(description)
        return tree.ModelDeclaration(name.text, self._span(name), partial is not None, shown, body, span)

    def package(self, c: Children, span: Span) -> tree.Package:
        name, description, items, _ = c
        body = arrange(items, "a package", self.faults)
        return tree.Package(name.text, self._span(name), self._text(description), body, span)

    def effect(self, c: Children, span: Span) -> tree.Effect:
        name, description, items, _ = c
        requires = tuple(n for item in items if type(item) is Requires for n in item.names)
        excludes = tuple(n for item in items if isinstance(item, Excludes) for n in item.names)
        rest = [item for item in items if not isinstance(item, Requires | Excludes)]
        body = arrange(rest, "an effect", self.faults)
        shown = self._text(description)
        return tree.Effect(name.text, self._span(name), shown, requires, excludes, body, span)

    def scene(self, c: Children, span: Span) -> tree.Scene:
        name, description, uses = c
        return tree.Scene(name.text, self._span(name), self._text(description), uses or (), (), span)

    def scene_with_body(self, c: Children, span: Span) -> tree.Scene:
        name, description, uses, items, _ = c
        body = arrange(items, "a scene", self.faults)
        return tree.Scene(name.text, self._span(name), self._text(description), uses or (), body, span)

    def for_loop(self, c: Children, span: Span) -> tree.ForLoop:
        variable, values, items = c
        return tree.ForLoop(variable.text, values, items, span)

    def when(self, c: Children, span: Span) -> tree.When:
        condition, *statements = c
        return tree.When(condition, tuple(statements), span)

    # -- one line each --------------------------------------------------------------------

    def import_path(self, c: Children, span: Span) -> tree.Import:
        path = _names(c[0])
        return tree.Import(path, None, path[-1], False, span)

    def import_all(self, c: Children, span: Span) -> tree.Import:
        return tree.Import(_names(c[0]), None, None, True, span)

    def import_alias(self, c: Children, span: Span) -> tree.Import:
        return tree.Import(_names(c[1]), None, c[0].text, False, span)

    def import_file(self, c: Children, span: Span) -> tree.Import:
        return tree.Import((), self._text(c[0]), None, False, span)

    def extends(self, c: Children, span: Span) -> tree.Extends:
        path, arguments = c
        return tree.Extends(_names(path), self._span(path[0]).to(self._span(path[-1])), arguments or (), span)

    def type_declaration(self, c: Children, span: Span) -> tree.TypeDeclaration:
        name, definition, arguments, description = c
        return tree.TypeDeclaration(
            name.text, self._span(name), definition, self._text(description), span, arguments or ()
        )

    def quantities(self, c: Children, span: Span) -> tree.Quantities:
        kind, type_name, declarators, unless, description = c
        return tree.Quantities(
            kind, type_name, self._with_description(declarators, description), unless or (), span
        )

    def instance(self, c: Children, span: Span) -> tree.Instance:
        model, declarators, unless, description = c
        made = self._type_of(model)
        if any(declarator.value is not None for declarator in declarators):
            self.faults += _misspelt_keyword(made)
        return tree.Instance(made, self._with_description(declarators, description), unless or (), span)

    def declarator(self, c: Children, span: Span) -> tree.Declarator:
        name, dimensions, arguments, value, description = c
        shown = self._text(description)
        return tree.Declarator(
            name.text, self._span(name), dimensions or (), arguments or (), value, shown, span
        )

    def part(self, c: Children, span: Span) -> tree.Declarator:
        """`a.b[2].m`: names and subscripts in turn, then what follows any name."""
        *parts, dimensions, arguments, value, description = c
        within: tree.Expression = tree.Name(parts[0].text, self._span(parts[0]))
        for each in parts[1:]:
            if isinstance(each, Token):
                here = self._span(each)
                within = tree.Member(within, each.text, here, within.span.to(here))
            else:
                within = tree.Index(within, each, within.span.to(each[-1].span))
        if len(parts) > MOST_PARTS:
            self._too_many_parts(within.span)
        shown, name = self._text(description), parts[-1].text
        return tree.Declarator(
            name, within.span, dimensions or (), arguments or (), value, shown, span, within
        )

    def function(self, c: Children, span: Span) -> tree.FunctionDeclaration:
        name, parameters, body, description = c
        return tree.FunctionDeclaration(
            name.text, self._span(name), parameters or (), body, self._text(description), span
        )

    def parameter(self, c: Children, span: Span) -> tuple[tree.TypeName, str, Span]:
        return c[0], c[1].text, self._span(c[1])

    def construct(self, c: Children, span: Span) -> tree.Construct:
        kind, name, index, value, (unless, shown) = c
        return tree.Construct(kind, name.text, self._span(name), index or (), value, unless, shown, span)

    def placeholder(self, c: Children, span: Span) -> tree.Placeholder:
        kind, name, shown = c
        return tree.Placeholder(kind, name.text, self._span(name), self._text(shown), span)

    def force(self, c: Children, span: Span) -> tree.Load:
        name, index, value, body, *rest = c
        return replace(self._load("force", [name, index, value, *rest], span), body=body)

    def torque(self, c: Children, span: Span) -> tree.Load:
        return self._load("torque", c, span)

    def _load(self, kind: str, c: Children, span: Span) -> tree.Load:
        name, index, value, target, reaction, (unless, description) = c
        return tree.Load(
            kind, name.text, self._span(name), index or (), value, target, reaction, unless, description, span
        )

    def constraint(self, c: Children, span: Span) -> tree.Constraint:
        name, index, left, relation, right, arguments, (unless, description) = c
        if arguments is None:
            right, arguments = _options_apart(right, self.source)
        return tree.Constraint(
            name.text, self._span(name), index or (), left, relation.text, self._span(relation), right,
            arguments, unless, description, span,
        )  # fmt: skip

    def initial(self, c: Children, span: Span) -> tree.Initial:
        return tree.Initial((), (), span)

    def condition(self, c: Children, span: Span) -> tree.Initial:
        left, relation, right, unless = c
        return tree.Initial((tree.Condition(left, right, self._span(relation), span),), unless or (), span)

    # -- parts of declarations -------------------------------------------------------------

    def tail(self, c: Children, span: Span) -> tuple[tuple[tree.Name, ...], str | None]:
        return c[0] or (), self._text(c[1])

    def tail_reversed(self, c: Children, span: Span) -> tuple[tuple[tree.Name, ...], str | None]:
        return c[1], self._text(c[0])

    def place(self, c: Children, span: Span) -> tree.Name:
        """`cars[2].drag`, as paths of elements are written."""
        parts = (name.text + (element or "") for name, element in zip(c[::2], c[1::2]))
        return tree.Name(".".join(parts), span)

    def element(self, c: Children, span: Span) -> str:
        return f"[{','.join(number.text for number in c)}]"

    def type(self, c: Children, span: Span) -> tree.TypeName:
        path, unit = c
        return tree.TypeName(_names(path), None if unit is None else self._unit(unit), span)

    # -- helpers -----------------------------------------------------------------------------

    def _with_description(
        self, declarators: tuple[tree.Declarator, ...], description: Token | None
    ) -> tuple[tree.Declarator, ...]:
        """Return a description after `unless` is that of the last name."""
        if description is None:
            return declarators
        return (*declarators[:-1], replace(declarators[-1], description=self._text(description)))

    def _type_of(self, expression: tree.Expression) -> tree.TypeName:
        path: list[str] = []
        part = expression
        while isinstance(part, tree.Member):
            path.append(part.name)
            part = part.base
        if not isinstance(part, tree.Name):
            message = "a declaration begins with a keyword or the name of a model"
            self.faults.append(Fault("LAG0110", message, expression.span))
            return tree.TypeName(("?",), None, expression.span)
        path.append(part.name)
        return tree.TypeName(tuple(reversed(path)), None, expression.span)

    # -- expressions -------------------------------------------------------------------

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
        message = "what stands before the `=` of an argument is a name"
        remedy = "write `name = value`, or `==` to compare"
        self.faults.append(Fault("LAG0123", message, left.span, remedy=remedy))
        return tree.Argument(None, None, value or left, span)

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
        return None if token is None else text_between_quotes(token.text)

    def _part(self, node: T, base: tree.Expression) -> T:
        parts = 1 + (self._parts[id(base)][1] if id(base) in self._parts else 1)
        self._parts[id(node)] = node, parts
        if parts == MOST_PARTS + 1:
            self._too_many_parts(base.span)
        return node

    def _too_many_parts(self, span: Span) -> None:
        self.faults.append(Fault("LAG0106", f"this name has more than {MOST_PARTS} parts", span))


def _misspelt_keyword(made: tree.TypeName) -> list[Fault]:
    """Report `bod b = Particle(...);`, since an instance of a model has no value."""
    from lagc.diagnostics.suggest import closest, foreign, remedy_of_word
    from lagc.syntax.lalr_tables import tables

    word = made.path[-1]
    remedy = remedy_of_word("keywords", word)
    if remedy is not None:
        message = f"`{word}` is not a keyword of the language"
        return [Fault("LAG0118", message, made.span, remedy=remedy)]
    if word in ("Particle", "Solid"):
        message = f"the arguments of a `{word}` follow its name in parentheses"
        remedy = f"write `body b = {word}(...);`, or `{word} b(...);`"
        return [Fault("LAG0119", message, made.span, remedy=remedy)]
    if word in _TYPES_TOO or word in foreign("types"):
        return []
    keywords = tables().keywords
    near = word.lower() if word.lower() in keywords else closest(word, keywords)
    message = f"`{word}` is not a keyword, and an instance of a model has no value"
    return [Fault("LAG0119", message, made.span, remedy=f"did you mean `{near}`?")] if near else []


def _names(path: tuple[Token, ...]) -> tuple[str, ...]:
    return tuple(token.text for token in path)


def _options_apart(
    right: tree.Expression, source: Source
) -> tuple[tree.Expression, tuple[tree.Argument, ...]]:
    """Separate the options of `z >= 2*r (restitution = 0.8)`, which parse as arguments of `r`."""
    outer: list[tree.Binary | tree.Unary] = []
    last = right
    while isinstance(last, tree.Binary | tree.Unary):
        outer.append(last)
        last = last.right if isinstance(last, tree.Binary) else last.operand
    if not isinstance(last, tree.Call) or not last.arguments or any(a.name is None for a in last.arguments):
        return right, ()
    function = last.function
    if source.text[function.span.end] == "(" or last.span.start != function.span.start:
        return right, ()
    if any(node.span.end != last.span.end for node in outer):
        return right, ()
    kept: tree.Expression = function
    for node in reversed(outer):
        span = Span(source, node.span.start, function.span.end)
        if isinstance(node, tree.Binary):
            kept = replace(node, right=kept, span=span)
        else:
            kept = replace(node, operand=kept, span=span)
    return kept, last.arguments


def text_between_quotes(text: str) -> str:
    """Return the text between the quotes, with escapes replaced."""
    inner = text[1:-1]
    if "\\" not in inner:
        return inner
    signs = {"n": "\n", "t": "\t", "r": "\r"}
    return re.sub(r"\\(.?)", lambda found: signs.get(found[1], found[1]), inner, flags=re.DOTALL)
