"""Instances of models: every declaration under its full name, with the place it is read from.

Nothing is evaluated here but what decides which declarations there are: ranges of loops and
sizes of arrays of instances.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

from lagc.base.records import dataclass, field
from lagc.diagnostics.faults import Span
from lagc.semantics.names.namespace import Namespace
from lagc.syntax import tree

if TYPE_CHECKING:
    from lagc.semantics import model as nouns
    from lagc.semantics.names.values import Value

LARGEST = 200_000  # declarations, loops and arrays unrolled
DEEPEST = 64  # instances within instances


@dataclass(frozen=True, slots=True)
class Environment:
    """Where a name is looked up: bindings (loop variables, function arguments), then the
    instance, then the namespace."""

    instance: Instance
    space: Namespace
    bindings: dict[str, Value] = field(default_factory=dict)

    def bind(self, names: dict[str, Value]) -> Environment:
        return Environment(self.instance, self.space, {**self.bindings, **names})


@dataclass(frozen=True, slots=True)
class Modifier:
    """An argument that changes a declaration from outside, evaluated where it was written;
    `index` takes one element of it, for arrays of instances."""

    argument: tree.Argument
    environment: Environment
    index: tuple[int, ...] = ()


Modifiers: TypeAlias = dict[str, list[Modifier]]  # the first of a list wins

Source: TypeAlias = (
    tree.Declarator
    | tree.Construct
    | tree.Load
    | tree.Constraint
    | tree.FunctionDeclaration
    | tree.TypeDeclaration
    | tree.Effect
)


class Entry:
    """One name of an instance."""

    __slots__ = (
        "declaration", "effect", "elements", "environment", "kind", "modifiers", "name", "nouns", "parts",
        "path", "size", "source", "state", "subscript", "value",
    )  # fmt: skip

    def __init__(
        self, kind: str, name: str, declaration: tree.Declaration, source: Source,
        environment: Environment, effect: str | None,
    ):  # fmt: skip
        self.kind = kind
        self.name = name
        self.path = environment.instance.path + name
        self.declaration = declaration
        self.source = source
        self.environment = environment
        self.effect = effect
        self.modifiers: list[Modifier] = []
        self.elements: dict[tuple[int, ...], Entry] | None = None
        self.subscript: tuple[int, ...] = ()
        self.size: int | None = None  # rows of a constraint that is a vector
        self.state = "new"  # running, done, poisoned
        self.value: Value | None = None
        self.nouns: list[nouns.Noun] = []
        self.parts: dict[str, Value] = {}  # of a thing that has some: the strength `g` of gravity

    @property
    def span(self) -> Span:
        return self.source.name_span

    def member(self, subscript: tuple[int, ...]) -> str:
        """The full name of an element, or without a subscript of the whole."""
        return self.path + (f"[{','.join(str(n) for n in subscript)}]" if subscript else "")


Item: TypeAlias = "Entry | list[Item]"


class Instance:
    """A model with the declarations that the scene leaves of it."""

    def __init__(
        self, path: str, declaration: tree.ModelDeclaration, parent: Instance | None, depth: int = 0
    ):
        self.path = path  # "" or "a.b[2]."
        self.declaration = declaration
        self.parent = parent
        self.depth = depth
        self.entries: dict[str, Entry] = {}
        self.items: list[Item] = []  # in order of declaration
        self.effects: dict[str, tree.Effect] = {}
        self.unused: dict[str, str] = {}  # name of a declaration that is not there -> why
        self.conditions: list[tuple[tree.Condition, Environment]] = []

    def in_order(self) -> list[Entry]:
        """All entries, elements one by one, instances within at their place."""
        found: list[Entry] = []
        stack: list[Item] = [self.items]
        while stack:
            item = stack.pop()
            if isinstance(item, list):
                stack.extend(reversed(item))
            else:
                found.append(item)
        return found
