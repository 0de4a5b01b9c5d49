"""What the arguments of an instance change within it, and the subscripts of arrays."""

from __future__ import annotations

from collections.abc import Iterable

from lagc.diagnostics.faults import Span
from lagc.frontend import tree
from lagc.meaning.scope import LARGEST, Environment, Modifier, Modifiers
from lagc.meaning.values import Wrong


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
