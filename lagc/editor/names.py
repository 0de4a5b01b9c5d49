"""Where each name of a text is declared and used, from the syntax tree alone: also while the text has faults.

Names of other files are found by the compiler's importer.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any, TypeAlias

from lagc.base.records import dataclass, field
from lagc.diagnostics.faults import Span, Wrong
from lagc.semantics.names.namespace import Importer, Namespace
from lagc.syntax import tree

DEEPEST = 16  # models that extend one another
Block: TypeAlias = tree.ModelDeclaration | tree.Package | tree.FunctionDeclaration | tree.ForLoop
Named: TypeAlias = (
    tree.Declarator | tree.ModelDeclaration | tree.Package | tree.Effect | tree.FunctionDeclaration
    | tree.Construct | tree.Load | tree.Placeholder | tree.Scene | tree.Constraint | tree.TypeDeclaration
)  # fmt: skip


@dataclass
class Names:
    """The names of one block. A look-up goes on in the models `bases` that it extends, then in `parent`."""

    parent: Names | None
    own: dict[str, Declared] = field(default_factory=dict)
    bases: list[tuple[str, ...]] = field(default_factory=list)
    inner: list[tuple[Span, Names]] = field(default_factory=list)
    variables: frozenset[str] = frozenset()  # of the loops around


@dataclass
class Declared:
    """A declaration: its `kind` is parameter, body, model, effect, argument, instance, ...; `type` is as
    written, or ""; `place` that of its name. `inside` are the names of a block."""

    name: str
    kind: str
    type: str
    place: Span
    span: Span
    description: str | None
    names: Names
    inside: Names | None = None


@dataclass(frozen=True)
class Use:
    span: Span
    target: Declared


def children(node: object) -> Iterator[object]:
    """Yield the nodes of a tree below a node or within a tuple."""
    if isinstance(node, tuple):
        for item in node:
            yield from children(item) if isinstance(item, tuple) else (item,)
    elif type(node).__module__ == tree.__name__:
        for name in type(node).__match_args__:  # type: ignore[attr-defined]
            value = getattr(node, name)
            if isinstance(value, tuple):
                yield from children(value)
            else:
                yield value


def nodes_at(node: object, offset: int) -> list[Any]:
    """Return the nodes below `node` that contain the character at an offset, the smallest first."""
    for child in children(node):
        span = getattr(child, "span", None)
        if span is not None and span.start <= offset < span.end:
            return [*nodes_at(child, offset), child]
    return []


class Index:
    """The names of one file."""

    def __init__(self, parsed: tree.Tree, roots: tuple[str, ...] = ()):
        self.tree, self.source, self.roots = parsed, parsed.source, roots
        self.top = Names(None)
        self.declared: list[Declared] = []
        self._blocks: dict[int, Names] = {}  # by identity of the node
        self._space: Namespace | None = None
        self._others: dict[str, Index] = {}
        self._gather(parsed.declarations, self.top)
        self.uses: list[Use] = []
        self._walk(parsed.declarations, self.top, frozenset())

    # -- declarations ------------------------------------------------------------------

    def _gather(self, body: tuple[tree.Declaration, ...], names: Names, loop: Names | None = None) -> None:
        """Enter the declarations of a block, or of a `loop` in it, whose declarations are those of the
        block."""
        for d in body:
            match d:
                case tree.ModelDeclaration() | tree.Package():
                    inside = self._block(d, names)
                    self._declare(
                        names, d, "package" if isinstance(d, tree.Package) else "model", inside=inside
                    )
                    self._gather(d.body, inside)
                case tree.Effect():  # its declarations are those of the model
                    self._declare(names, d, "effect")
                    self._gather(d.body, names, loop)
                case tree.Quantities(type=tree.TypeName() as written) | tree.Instance(type=written):
                    kind = d.kind if isinstance(d, tree.Quantities) else "instance"
                    for declarator in d.declarators:
                        self._declare(names, declarator, kind, written.span.text, d.span)
                case tree.FunctionDeclaration():
                    inside = self._block(d, names)
                    self._declare(names, d, "function", inside=inside)
                    for written, name, span in d.parameters:
                        self._add(Declared(name, "argument", written.span.text, span, d.span, None, inside))
                case tree.ForLoop():
                    inside = self._block(d, loop or names)
                    inside.variables |= {d.variable}
                    self._gather(d.body, names, inside)
                case tree.Extends():
                    names.bases.append(d.path)
                case tree.Construct(value=tree.Call() as call):
                    self._declare(names, d, d.kind, call.function.span.text)
                case tree.Construct() | tree.Load() | tree.Placeholder():
                    self._declare(names, d, d.kind)
                case tree.Scene() | tree.Constraint() | tree.TypeDeclaration():
                    self._declare(names, d, type(d).__name__.removesuffix("Declaration").lower())

    def _block(self, node: Block, names: Names) -> Names:
        inside = self._blocks[id(node)] = Names(names, variables=names.variables)
        names.inner.append((node.span, inside))
        return inside

    def _declare(self, names: Names, node: Named, kind: str, type: str = "", span: Span | None = None,
                 inside: Names | None = None) -> None:  # fmt: skip
        of = (node.name_span, span or node.span, node.description)
        self._add(Declared(node.name, kind, type, *of, names, inside))

    def _add(self, declared: Declared) -> None:
        declared.names.own.setdefault(declared.name, declared)  # of elements `P[1]`, `P[2]` the first
        self.declared.append(declared)

    # -- look-ups ----------------------------------------------------------------------

    def scope(self, offset: int) -> Names:
        """Return the names of the innermost block at an offset."""
        names = self.top
        while True:
            inner = [block for span, block in names.inner if span.start <= offset <= span.end]
            if not inner:
                return names
            names = inner[0]

    def lookup(self, path: tuple[str, ...], names: Names | None) -> Declared | None:
        """Return the declaration of `a` or `a.b.c`, or None."""
        found: Declared | None = None
        while names is not None and found is None:
            if path[0] in names.variables:
                return None
            found, names = self.member(names, path[0]), names.parent
        if found is None:
            return self._imported(path)
        for name in path[1:]:
            found = self.member(self.inside(found), name)
            if found is None:
                return None
        return found

    def member(self, names: Names | None, name: str) -> Declared | None:
        blocks = () if names is None else self.extended(names)
        return next((block.own[name] for block in blocks if name in block.own), None)

    def extended(self, names: Names, depth: int = 0) -> Iterator[Names]:
        """Yield a block and the models that it extends."""
        yield names
        for path in names.bases if depth < DEEPEST else ():
            base = self.lookup(path, names.parent)
            if base is not None and base.inside is not None:
                yield from self.extended(base.inside, depth + 1)

    def visible(self, names: Names | None) -> Iterator[Declared]:
        """Yield the declarations that a block can name, the nearest first."""
        while names is not None:
            for block in self.extended(names):
                yield from block.own.values()
            names = names.parent

    def inside(self, found: Declared | None) -> Names | None:
        """Return the names that may follow `found` and a `.`: of an instance those of its model."""
        if found is not None and found.kind == "instance":
            found = self.lookup(tuple(found.type.split(".")), found.names)
        return None if found is None else found.inside

    def _imported(self, path: tuple[str, ...]) -> Declared | None:
        """Return the declaration of another file."""
        if not any(isinstance(d, tree.Import) for d in self.tree.declarations):
            return None
        if self._space is None:
            self._space = Namespace(self.tree.declarations, None, Importer(self.source, self.roots))
        try:
            source = self._space.find(path, Span(self.source, 0, 0), "name")[0].span.source
        except Wrong:
            return None
        if source is self.source:
            return None
        if source.name not in self._others:
            from lagc.syntax.parse import parse_recovering

            self._others[source.name] = Index(parse_recovering(source)[0], self.roots)
        return next((d for d in self._others[source.name].declared if d.name == path[-1]), None)

    # -- uses --------------------------------------------------------------------------

    def _walk(self, value: object, names: Names, local: frozenset[str]) -> None:
        for node in children(value):
            self._look(node, names, local)

    def _look(self, node: object, names: Names, local: frozenset[str]) -> None:
        inner = self._blocks.get(id(node), names)
        match node:
            case tree.ForLoop() | tree.Family():
                local = local | {node.variable}
                inner = names
            case tree.Name() if node.name not in local and node.name.isidentifier():
                self._use(node.span, node.name, self.lookup((node.name,), names))
            case tree.Member():
                inside = self.inside(self.of(node.base, names, local))
                self._use(node.name_span, node.name, self.member(inside, node.name))
            case tree.TypeName():
                end = node.unit.span.start if node.unit is not None else node.span.end
                self._use(
                    Span(self.source, node.span.start, end), node.path[-1], self.lookup(node.path, names)
                )
            case tree.Extends():
                base = self.lookup(node.path, names.parent)
                self._use(node.path_span, node.path[-1], base)
                self._arguments(node.arguments, self.inside(base))
            case tree.Quantities(type=None):  # in a scene
                for d in node.declarators:
                    if d.within is None:
                        self._use(d.name_span, d.name, self.lookup((d.name,), names))
            case tree.Instance():
                model = self.inside(self.lookup(node.type.path, names))
                for d in node.declarators:
                    self._arguments(d.arguments, model)
        self._walk(node, inner, local)

    def _arguments(self, arguments: tuple[tree.Argument, ...], inside: Names | None) -> None:
        for a in arguments:
            if a.name is not None and a.name_span is not None:
                self._use(a.name_span, a.name, self.member(inside, a.name))

    def _use(self, span: Span, name: str, target: Declared | None) -> None:
        if target is not None:
            start = span.start + span.text.rfind(name)  # of a path `a.b.name` its last part
            self.uses.append(Use(Span(span.source, start, start + len(name)), target))

    def of(self, e: object, names: Names, local: frozenset[str] = frozenset()) -> Declared | None:
        """Return the declaration that an expression stands for."""
        match e:
            case tree.Name() if e.name not in local:
                return self.lookup((e.name,), names)
            case tree.Member():
                inside = self.inside(self.of(e.base, names, local))
                return self.member(inside, e.name)
            case tree.Index():
                return self.of(e.base, names, local)
        return None

    # -- at a place --------------------------------------------------------------------

    def at(self, offset: int) -> Use | None:
        """Return the name at an offset, with its declaration."""
        named = (*(Use(d.place, d) for d in self.declared), *self.uses)
        return next((use for use in named if use.span.start <= offset <= use.span.end), None)

    def references(self, target: Declared) -> list[Span]:
        """Return all places of this text that name a declaration, with the `end name` of a block."""
        first = target.names.own[target.name]
        found = [use.span for use in self.uses if use.target is first]
        if target.place.source is self.source:
            found += [d.place for d in self.declared if d.name == target.name and d.names is target.names]
            end = re.search(rf"\bend\s+({re.escape(target.name)})\s*;?\s*$", target.span.text)
            if end is not None and target.kind in ("model", "package", "effect", "scene"):
                start = target.span.start + end.start(1)
                found.append(Span(self.source, start, start + len(target.name)))
        return sorted(dict.fromkeys(found), key=lambda span: span.start)
