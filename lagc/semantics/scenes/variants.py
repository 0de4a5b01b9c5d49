"""All variants of a file that can be checked: its models, their scenes, and effects that no scene uses."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from lagc.base.records import dataclass, replace
from lagc.diagnostics.faults import Wrong
from lagc.semantics.names.namespace import Importer, Namespace
from lagc.semantics.names.scope import DEEPEST
from lagc.syntax import tree
from lagc.syntax.tree import Declaration, ModelDeclaration, Package, Scene, Tree


@dataclass(frozen=True, slots=True)
class Variant:
    """One choice of model, scene and effects; None leaves the choice to `resolve`."""

    model: str | None
    scene: str | None
    with_effects: tuple[str, ...] = ()
    without_effects: tuple[str, ...] = ()
    alone: tuple[str, ...] = ()  # effects of the scene that an unused effect does not need


def variants(file: tree.Tree, model: str | None = None, roots: Sequence[str] = ()) -> list[Variant]:
    """Return every scene of every model of the file (or of `model`), and each unused effect in the first
    scene. An unused effect comes with the effects it requires.  A model that other models extend or contain,
    or that has placeholders, is only checked within others, since it may be incomplete, unless it is the one
    that `choose_model` returns.  Names that cannot be found are skipped: `resolve` reports them."""
    importer = Importer(file.source, tuple(roots))
    space = Namespace(file.declarations, None, importer)
    models = list(_models(file.declarations, space, ""))
    main = next((d for _, d, where in reversed(models) if where is space), models[-1][1] if models else None)
    parts = set(_parts(file.declarations))
    found: list[Variant] = []
    for name, declaration, where in models:
        open_ = any(isinstance(d, tree.Placeholder) for d in declaration.body)
        whole = declaration is main or (declaration.name not in parts and not open_)
        if name == model or (model is None and whole):
            found += _of_model(name, declaration, where)
    return found or [Variant(model, None)]


def _parts(declarations: Sequence[tree.Declaration]) -> Iterator[str]:
    """Yield the names of the models that others extend or contain."""
    for d in declarations:
        if isinstance(d, tree.Extends):
            yield d.path[-1]
        elif isinstance(d, tree.Instance):
            yield d.type.path[-1]
        elif isinstance(d, tree.ModelDeclaration | tree.Package | tree.Effect):
            yield from _parts(d.body)


def _models(
    declarations: Sequence[tree.Declaration], space: Namespace, path: str
) -> Iterator[tuple[str, tree.ModelDeclaration, Namespace]]:
    """Yield the non-partial models of a file and its packages, with their full names."""
    for d in declarations:
        if isinstance(d, tree.ModelDeclaration) and not d.partial:
            yield path + d.name, d, space
        elif isinstance(d, tree.Package):
            yield from _models(d.body, space.importer.inside(d, space), f"{path}{d.name}.")


def _of_model(name: str, declaration: tree.ModelDeclaration, space: Namespace) -> Iterator[Variant]:
    scenes: dict[str, tree.Scene] = {}
    effects: dict[str, tree.Effect] = {}
    for inner in _declarations(declaration, space, 0, set()):
        if isinstance(inner, tree.Scene):
            scenes.setdefault(inner.name, inner)
        elif isinstance(inner, tree.Effect):
            effects.setdefault(inner.name, inner)
    yield from (Variant(name, scene) for scene in scenes or (None,))
    first = next(iter(scenes), None)
    used = {name.name for scene in scenes.values() for name in scene.uses}
    for effect in effects.values():
        if effect.name not in used:
            wanted = _required_effects(effect, effects)
            excluded = {e.name for w in wanted if w in effects for e in effects[w].excludes}
            excluded |= {n for n, e in effects.items() if any(x.name in wanted for x in e.excludes)}
            others = [n.name for n in scenes[first].uses] if first is not None else []
            alone = tuple(n for n in others if n not in wanted and n not in excluded)
            yield Variant(name, first, tuple(wanted), tuple(sorted(excluded - set(wanted))), alone)


def _required_effects(effect: tree.Effect, effects: dict[str, tree.Effect]) -> list[str]:
    wanted = [effect.name]
    for name in wanted:  # the list grows
        if name in effects:
            wanted += [r.name for r in effects[name].requires if r.name not in wanted]
    return wanted


def _declarations(
    declaration: tree.ModelDeclaration, space: Namespace, depth: int, seen: set[int]
) -> Iterator[tree.Declaration]:
    """Yield the declarations of a model, then inherited ones; models in `seen` are skipped."""
    if id(declaration) in seen:
        return
    seen.add(id(declaration))
    yield from declaration.body
    inner = space.importer.inside(declaration, space)
    for base in declaration.body:
        if isinstance(base, tree.Extends) and depth < DEEPEST:
            try:
                found, where = inner.find(base.path, base.path_span, "model")
            except Wrong:
                continue
            if isinstance(found, tree.ModelDeclaration):
                yield from _declarations(found, where, depth + 1, seen)


class ByScene:
    """A tree that is split by scenes once, so that checking n scenes does not look at each of them n
    times."""

    def __init__(self, tree: Tree):
        self.tree = tree
        self.body = _Body(tree.declarations)

    def only(self, name: str) -> Tree:
        """Return the tree without the other scenes of its models."""
        return replace(self.tree, declarations=self.body.only(name))


class _Body:
    def __init__(self, declarations: Sequence[Declaration]):
        self.others: list[Declaration] = []
        self.inner: dict[int, tuple[ModelDeclaration | Package, _Body]] = {}  # by position among the others
        self.scenes: dict[str, list[tuple[int, Scene]]] = {}  # with the number of others before it
        for d in declarations:
            if isinstance(d, Scene):
                self.scenes.setdefault(d.name, []).append((len(self.others), d))
                continue
            if isinstance(d, ModelDeclaration | Package):
                self.inner[len(self.others)] = d, _Body(d.body)
            self.others.append(d)

    def only(self, name: str) -> tuple[Declaration, ...]:
        kept = list(self.others)
        for k, (d, body) in self.inner.items():
            kept[k] = replace(d, body=body.only(name))
        for before, scene in reversed(self.scenes.get(name, [])):
            kept.insert(before, scene)
        return tuple(kept)
