"""What the arguments of an instance change within it, and the subscripts of arrays."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TypeAlias

from lagc.diagnostics.faults import Span
from lagc.semantics.names.scope import LARGEST, Environment, Modifier, Modifiers
from lagc.semantics.names.values import Wrong
from lagc.syntax import tree

# of models, by identity: what each extends, with what it gives there
Extended: TypeAlias = dict[int, list[tuple[tree.ModelDeclaration, Modifiers]]]


def modifiers_of(arguments: Iterable[tree.Argument], environment: Environment) -> Modifiers:
    """The arguments of an instance or of `extends`, by name.  Raises Wrong."""
    found: Modifiers = {}
    for argument in map(_named, arguments):
        if argument.name is None:
            raise Wrong("LAG0209", "the arguments of a model have names: `name = value`", argument.span)
        if argument.name in found:
            raise Wrong("LAG0209", f"`{argument.name}` is given twice", argument.span)
        found[argument.name] = [Modifier(argument, environment)]
    return found


def _named(argument: tree.Argument) -> tree.Argument:
    """`a(m = 5)` reads like a call; among the arguments of a model it modifies what is within `a`."""
    call = argument.value
    if argument.name is None and isinstance(call, tree.Call) and isinstance(call.function, tree.Name):
        name = call.function
        return tree.Argument(name.name, name.span, None, argument.span, argument.each, call.arguments)
    return argument


def outermost_first(model: tree.ModelDeclaration, extended: Extended) -> Iterator[tuple[str, Modifier]]:
    """What a model and all that it extends give to what they extend: what one gives goes before what those
    give that it extends, in one way or another; else the order is that in which they are written."""
    done: set[int] = set()
    order: list[int] = []  # the innermost first, what is written last before what is written first

    def visit(key: int) -> None:
        if key not in done:
            done.add(key)
            for base, _ in reversed(extended.get(key, [])):
                visit(id(base))
            order.append(key)

    visit(id(model))
    for key in reversed(order):
        for _, modifiers in extended.get(key, []):
            for name, given in modifiers.items():
                yield from ((name, modifier) for modifier in given)


def subscripts(sizes: list[int], span: Span) -> list[tuple[int, ...]]:
    """(1, 1), (1, 2) ... of an array.  Raises Wrong."""
    found: list[tuple[int, ...]] = [()]
    for size in sizes:
        if size < 0:
            raise Wrong("LAG0207", f"the size of an array is not negative, here it is {size}", span)
        if len(found) * size > LARGEST:
            raise Wrong("LAG0218", f"an array of more than {LARGEST} elements", span)
        found = [(*before, n) for before in found for n in range(1, size + 1)]
    return found
